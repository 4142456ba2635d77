//! The interpolant of one step of any method.

use crate::codec::record::{Damaged, Record};

/// Limit of [`Dense::off()`] in units of the tolerance. The stages are of lower order than the end. In smooth motions
/// they deviate from the interpolant by about 10 tolerances if its error is half a tolerance. In a step with a much
/// faster damped component, the error of the interpolant is as large as this deviation.
const OFF: f64 = 30.0;

/// Polynomial of degree 7 at most over one step, in the nested form of Hairer, Norsett, Wanner, Solving ODEs I (1993),
/// II.6, CONTD8: start + s (terms[0] + (1 - s) (terms[1] + s (terms[2] + (1 - s) (...)))), s = (time - t) / h.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dense<const N: usize> {
    pub(super) start: [f64; N],
    pub(super) end: [f64; N],
    pub(super) terms: [[f64; N]; TERMS],
    /// Estimated deviation of each component of the motion from the interpolant. For DOP853 and RKN8(6), from stages
    /// within the step; for the other methods, the error estimate of the step.
    pub(super) off: [f64; N],
}

/// Number of terms of the nested form, which is the degree.
pub(super) const TERMS: usize = 7;

impl<const N: usize> Dense<N> {
    pub(super) fn new(start: [f64; N], end: [f64; N], terms: [[f64; N]; TERMS], off: impl Fn(usize) -> f64) -> Self {
        Self { start, end, terms, off: std::array::from_fn(|n| off(n).abs()) }
    }

    /// Whether [`Self::off()`] of all components is as small as in smooth motions.
    pub fn is_within(&self, tolerance: f64, scale: &[f64; N]) -> bool {
        self.off.iter().zip(scale).all(|(off, scale)| *off <= OFF * tolerance * scale)
    }

    /// Estimated deviation of component n of the motion from the interpolant.
    pub fn off(&self, n: usize) -> f64 {
        self.off[n]
    }

    /// An interpolant for [`Self::record`] to fill.
    pub fn blank() -> Self {
        Self::new([0.0; N], [0.0; N], [[0.0; N]; TERMS], |_| 0.0)
    }

    /// Writes or reads all fields except `off`.
    ///
    /// # Errors
    /// A number that was read is not finite.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        record.all_finite("interpolant", &mut self.start)?;
        record.all_finite("interpolant", &mut self.end)?;
        record.all_finite("interpolant", self.terms.as_flattened_mut())
    }

    /// State at the part s of the step, 0 <= s <= 1. Other s give the extrapolation.
    pub fn at(&self, s: f64) -> [f64; N] {
        std::array::from_fn(|n| self.component(n, s))
    }

    /// Component n of [`Self::at`].
    #[inline]
    pub fn component(&self, n: usize, s: f64) -> f64 {
        let mut sum = 0.0;
        for (i, term) in self.terms.iter().enumerate().rev() {
            sum = (sum + term[n]) * if i % 2 == 0 { s } else { 1.0 - s };
        }
        self.start[n] + sum
    }
}

/// The first three terms of the interpolant of one component, Hermite's cubic, from values and rates at both ends:
/// II.6, eq. (6.7).
#[inline]
pub(super) fn hermite(h: f64, [start, end]: [f64; 2], [first, last]: [f64; 2]) -> [f64; 3] {
    let delta = end - start;
    [delta, h * first - delta, 2.0 * delta - h * (first + last)]
}
