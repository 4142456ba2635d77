//! The interpolant of one step, whatever the method.

/// Polynomial of degree 7 at most over one step, in the nested form of Hairer, Norsett, Wanner, Solving ODEs I (1993),
/// II.6, CONTD8: start + s (terms[0] + (1 - s) (terms[1] + s (terms[2] + (1 - s) (...)))), s = (time - t) / h.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dense<const N: usize> {
    pub(super) start: [f64; N],
    pub(super) end: [f64; N],
    pub(super) terms: [[f64; N]; TERMS],
}

/// Terms of the nested form: the degree.
pub(super) const TERMS: usize = 7;

impl<const N: usize> Dense<N> {
    pub(super) fn new(start: [f64; N], end: [f64; N], terms: [[f64; N]; TERMS]) -> Self {
        Self { start, end, terms }
    }

    /// State at the part s of the step, 0 <= s <= 1; beyond, its continuation.
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
