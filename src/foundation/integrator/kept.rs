//! A Jacobian that consecutive Radau steps share while Newton's method converges fast enough, with the factors of its
//! matrices.
//!
//! In: a Jacobian, step sizes. Out: factors of the matrices of Newton's method. Must not know: when to use them.
//! Source: Hairer, Wanner, Solving ODEs II (1996), IV.8.
use super::methods::radau::coefficients::{ALPHA, BETA, GAMMA};
use crate::codec::record::{Damaged, Record};
use crate::numerics::gauss::{Complex, Factors};

/// Relative difference of step sizes up to which steps share factors. It covers differences of rounded times. The rate
/// of convergence of Newton's method increases by at most this amount.
const SAME_SIZE: f64 = 1e-6;

/// A Jacobian df/dy with derived quantities.
#[derive(Clone, Debug)]
pub struct Kept<const N: usize> {
    jacobian: [[f64; N]; N],
    /// Number of leading components. Columns of the Jacobian after these are 0.
    pub leading: usize,
    /// The largest |eigenvalue| of the Jacobian [1/s].
    pub lambda: f64,
    /// Whether the next step may use the Jacobian, if the next step follows a Radau step.
    pub is_useful: bool,
    /// Step size of the factors [s]. 0: no factors were requested.
    h: f64,
    /// Whether the factors exist. They follow from the Jacobian and the step size, so they are not recorded.
    is_factored: bool,
    /// Factors of (gamma/h - J) of the leading components.
    pub real: Factors<f64, N>,
    /// Factors of ((alpha + i beta)/h - J) of the leading components.
    pub complex: Factors<Complex<f64>, N>,
}

impl<const N: usize> Default for Kept<N> {
    fn default() -> Self {
        Self {
            jacobian: [[0.0; N]; N],
            leading: 0,
            lambda: 0.0,
            is_useful: false,
            h: 0.0,
            is_factored: false,
            real: Factors::default(),
            complex: Factors::default(),
        }
    }
}

/// Equal if all data that determine the next steps are equal.
impl<const N: usize> PartialEq for Kept<N> {
    fn eq(&self, other: &Self) -> bool {
        let is_same = || self.h == other.h && self.leading == other.leading && self.rows().eq(other.rows());
        self.is_useful == other.is_useful && (!self.is_useful || is_same())
    }
}

impl<const N: usize> Kept<N> {
    /// Sets a Jacobian whose columns after the first `leading` are 0, with its largest |eigenvalue| [1/s].
    pub fn take(&mut self, jacobian: &[[f64; N]; N], leading: usize, lambda: f64) {
        self.jacobian.copy_from_slice(jacobian);
        (self.leading, self.lambda, self.h, self.is_factored) = (leading, lambda, 0.0, false);
    }

    /// Rows of the Jacobian, each in its leading columns.
    pub fn rows(&self) -> impl Iterator<Item = &[f64]> {
        self.jacobian.iter().map(|row| &row[..self.leading])
    }

    /// Computes the factors for a step of size h. None if a matrix is singular.
    pub fn factored(&mut self, h: f64) -> Option<&Self> {
        if (self.h - h).abs() > SAME_SIZE * h {
            (self.h, self.is_factored) = (h, false);
        }
        if !self.is_factored {
            let (jacobian, h, leading) = (&self.jacobian, self.h, self.leading);
            let shifted = |factor: f64, i: usize, j: usize| if i == j { factor / h } else { 0.0 } - jacobian[i][j];
            let imaginary = |i, j| if i == j { BETA / h } else { 0.0 };
            let complex = |i, j| Complex { re: shifted(ALPHA, i, j), im: imaginary(i, j) };
            self.is_factored =
                self.real.factor(leading, |i, j| shifted(GAMMA, i, j)) && self.complex.factor(leading, complex);
        }
        self.is_factored.then_some(self)
    }

    /// Copies `other`.
    pub fn copy_from(&mut self, other: &Self) {
        self.is_useful = other.is_useful;
        if !other.is_useful {
            return;
        }
        (self.leading, self.lambda, self.h) = (other.leading, other.lambda, other.h);
        for (own, other) in self.jacobian.iter_mut().zip(other.rows()) {
            own[..other.len()].copy_from_slice(other);
        }
        self.is_factored = other.is_factored;
        if other.is_factored {
            self.real.copy_from(&other.real);
            self.complex.copy_from(&other.complex);
        }
    }

    /// Writes or reads all fields.
    ///
    /// # Errors
    /// A field that was read has a value that no step can produce.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        record.flag("Jacobian in use", &mut self.is_useful)?;
        if self.is_useful {
            record.number("largest eigenvalue", &mut self.lambda, |x| x.is_finite() && x >= 0.0, "a number >= 0")?;
            record.positive("step size of the Jacobian", &mut self.h)?;
            record.place("columns of the Jacobian", &mut self.leading, N + 1)?;
            let leading = self.leading;
            self.jacobian.iter_mut().try_for_each(|row| record.all_finite("Jacobian", &mut row[..leading]))?;
        }
        if record.reads() {
            self.is_factored = false;
        }
        Ok(())
    }
}
