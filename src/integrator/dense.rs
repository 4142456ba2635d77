//! The interpolant of one step, whatever the method.

use crate::codec::record::{Damaged, Record};

/// Stages within a step, of a lower order than its end, are off its interpolant by some ten times the tolerance where
/// that errs by half of it; where a motion is damped that is much faster than the step, the interpolant errs as much as
/// they.
const OFF: f64 = 30.0;

/// Polynomial of degree 7 at most over one step, in the nested form of Hairer, Norsett, Wanner, Solving ODEs I (1993),
/// II.6, CONTD8: start + s (terms[0] + (1 - s) (terms[1] + s (terms[2] + (1 - s) (...)))), s = (time - t) / h.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dense<const N: usize> {
    pub(super) start: [f64; N],
    pub(super) end: [f64; N],
    pub(super) terms: [[f64; N]; TERMS],
    /// How far each component of the motion may be off it: of DOP853 and RKN8(6) by stages within the step, of the
    /// others by the error estimate of the step.
    pub(super) off: [f64; N],
}

/// Terms of the nested form: the degree.
pub(super) const TERMS: usize = 7;

impl<const N: usize> Dense<N> {
    pub(super) fn new(start: [f64; N], end: [f64; N], terms: [[f64; N]; TERMS], off: impl Fn(usize) -> f64) -> Self {
        Self { start, end, terms, off: std::array::from_fn(|n| off(n).abs()) }
    }

    /// Whether the motion is no further off it than smooth motions are.
    pub fn is_within(&self, tolerance: f64, scale: &[f64; N]) -> bool {
        self.off.iter().zip(scale).all(|(off, scale)| *off <= OFF * tolerance * scale)
    }

    /// How far component n of the motion may be off it.
    pub fn off(&self, n: usize) -> f64 {
        self.off[n]
    }

    /// To be read.
    pub fn blank() -> Self {
        Self::new([0.0; N], [0.0; N], [[0.0; N]; TERMS], |_| 0.0)
    }

    /// All fields, written or read.
    ///
    /// # Errors
    /// A number is read that is not finite.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        record.all_finite("interpolant", &mut self.start)?;
        record.all_finite("interpolant", &mut self.end)?;
        self.terms.iter_mut().try_for_each(|term| record.all_finite("interpolant", term))
    }

    /// State at the part s of the step, 0 <= s <= 1; beyond, its continuation.
    pub fn at(&self, s: f64) -> [f64; N] {
        std::array::from_fn(|n| self.component(n, s))
    }

    /// One component of that.
    #[inline]
    pub fn component(&self, n: usize, s: f64) -> f64 {
        let mut sum = 0.0;
        for (i, term) in self.terms.iter().enumerate().rev() {
            sum = (sum + term[n]) * if i % 2 == 0 { s } else { 1.0 - s };
        }
        self.start[n] + sum
    }
}

/// The first three terms of one component's interpolant, Hermite's cubic, from its values and rates at both ends: II.6,
/// eq. (6.7).
#[inline]
pub(super) fn hermite(h: f64, [start, end]: [f64; 2], [first, last]: [f64; 2]) -> [f64; 3] {
    let delta = end - start;
    [delta, h * first - delta, 2.0 * delta - h * (first + last)]
}
