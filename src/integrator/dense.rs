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
}
