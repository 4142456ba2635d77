//! The interpolant of one step.
use super::tableau::{D, EXTENDED, STAGES};

/// Polynomial of degree 7 over one step; Hairer, Norsett, Wanner, II.6, in the nested form of their CONTD8.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dense<const N: usize> {
    start: [f64; N],
    terms: [[f64; N]; 7],
}

impl<const N: usize> Dense<N> {
    pub(super) fn new(h: f64, start: [f64; N], end: [f64; N], k: &[[f64; N]; EXTENDED]) -> Self {
        let mut terms = [[0.0; N]; 7];
        for n in 0..N {
            let delta = end[n] - start[n];
            terms[0][n] = delta;
            terms[1][n] = h * k[0][n] - delta;
            terms[2][n] = 2.0 * delta - h * (k[STAGES][n] + k[0][n]);
            for (term, weights) in terms[3..].iter_mut().zip(&D) {
                term[n] = h * k.iter().zip(weights).map(|(stage, d)| d * stage[n]).sum::<f64>();
            }
        }
        Self { start, terms }
    }

    /// State at the part s of the step, 0 <= s <= 1.
    pub fn at(&self, s: f64) -> [f64; N] {
        std::array::from_fn(|n| {
            let mut sum = 0.0;
            for (i, term) in self.terms.iter().enumerate().rev() {
                sum = (sum + term[n]) * if i % 2 == 0 { s } else { 1.0 - s };
            }
            self.start[n] + sum
        })
    }

    /// First s in (0, 1] at which component n passes `level` in this direction.
    pub fn first_passage(&self, n: usize, level: f64, direction: f64, leaving: bool) -> Option<f64> {
        const SAMPLES: usize = 32;
        let beyond = |s: f64| (self.at(s)[n] - level) * direction;
        let mut free = !leaving;
        let mut last = 0.0;
        for i in 1..=SAMPLES {
            let s = i as f64 / SAMPLES as f64;
            if beyond(s) > 0.0 {
                if free {
                    let (mut a, mut b) = (last, s);
                    for _ in 0..60 {
                        let middle = 0.5 * (a + b);
                        if beyond(middle) > 0.0 { b = middle } else { a = middle }
                    }
                    return Some(b);
                }
            } else {
                free = true;
            }
            last = s;
        }
        None
    }
}
