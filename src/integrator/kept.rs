//! A Jacobian that steps of Radau share as long as Newton's method converges well with it, with the factors of the last
//! step.
//!
//! In: a Jacobian, step sizes. Out: factors of the matrices of Newton's method. It must not know when to use them.
//! Source: Hairer, Wanner, Solving ODEs II (1996), IV.8.
use super::methods::radau::coefficients::{ALPHA, BETA, GAMMA};
use crate::codec::record::{Damaged, Record};
use crate::numerics::gauss::{Complex, Factors};

/// A Jacobian df/dy with what follows from it.
#[derive(Clone, Debug)]
pub struct Kept<const N: usize> {
    jacobian: [[f64; N]; N],
    /// Its largest |eigenvalue| [1/s].
    pub lambda: f64,
    /// Whether the next step may use it, if it follows a step of Radau.
    pub is_useful: bool,
    /// Of the last step. They follow from the Jacobian and the step size, so that no record needs them.
    factored: Option<Factored<N>>,
}

/// Factors of the matrices of Newton's method for a step of size h.
#[derive(Clone, Debug)]
pub struct Factored<const N: usize> {
    h: f64,
    pub real: Factors<f64, N>,
    pub complex: Factors<Complex<f64>, N>,
}

impl<const N: usize> Default for Kept<N> {
    fn default() -> Self {
        Self { jacobian: [[0.0; N]; N], lambda: 0.0, is_useful: false, factored: None }
    }
}

/// What decides how steps go on is the same.
impl<const N: usize> PartialEq for Kept<N> {
    fn eq(&self, other: &Self) -> bool {
        self.is_useful == other.is_useful && (!self.is_useful || self.jacobian == other.jacobian)
    }
}

impl<const N: usize> Kept<N> {
    /// Take a Jacobian with this largest |eigenvalue| [1/s].
    pub fn take(&mut self, jacobian: [[f64; N]; N], lambda: f64) {
        (self.jacobian, self.lambda, self.factored) = (jacobian, lambda, None);
    }

    /// Factors for a step of size h; none if a matrix is singular.
    pub fn factored(&mut self, h: f64, leading: usize) -> Option<&Factored<N>> {
        if self.factored.as_ref().is_none_or(|factored| factored.h != h) {
            self.factored = Factored::new(&self.jacobian, h, leading);
        }
        self.factored.as_ref()
    }

    /// Become the same as another one.
    pub fn copy_from(&mut self, other: &Self) {
        if other.is_useful {
            self.clone_from(other);
        } else {
            self.is_useful = false;
        }
    }

    /// All fields, written or read.
    ///
    /// # Errors
    /// A field is read that no step leaves.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        record.flag("Jacobian in use", &mut self.is_useful)?;
        if self.is_useful {
            self.factored = None;
            record.number("largest eigenvalue", &mut self.lambda, |x| x.is_finite() && x >= 0.0, ">= 0")?;
            self.jacobian.iter_mut().try_for_each(|row| record.all_finite("Jacobian", row))?;
        }
        Ok(())
    }
}

impl<const N: usize> Factored<N> {
    /// Of a Jacobian; none if a matrix is singular.
    pub fn new(jacobian: &[[f64; N]; N], h: f64, leading: usize) -> Option<Self> {
        let shifted = |factor: f64, i: usize, j: usize| if i == j { factor / h } else { 0.0 } - jacobian[i][j];
        let real = Factors::new(std::array::from_fn(|i| std::array::from_fn(|j| shifted(GAMMA, i, j))), leading)?;
        let entry = |i, j| Complex { re: shifted(ALPHA, i, j), im: if i == j { BETA / h } else { 0.0 } };
        let complex = Factors::new(std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j))), leading)?;
        Some(Self { h, real, complex })
    }
}
