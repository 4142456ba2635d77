//! Work of an integration, by method.

use crate::codec::record::{Damaged, Record};

/// An integration method. The methods that try to reach the end of a span in one cheap step are the first, in the order
/// of their cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Explicit Runge-Kutta of order 4, the classical one.
    Rk4,
    /// Explicit Runge-Kutta of order 5, Dormand and Prince.
    Dopri5,
    /// Explicit Runge-Kutta of order 8, Dormand and Prince.
    #[default]
    Dop853,
    /// Explicit Runge-Kutta-Nystroem of order 8, Dormand, El-Mikkawy and Prince.
    Rkn86,
    /// Implicit Runge-Kutta of order 5, Radau IIA.
    Radau,
}

impl Method {
    /// All methods, in the order of the arrays by method.
    pub const ALL: [Self; 5] = [Self::Rk4, Self::Dopri5, Self::Dop853, Self::Rkn86, Self::Radau];

    /// Name in the literature.
    pub fn name(self) -> &'static str {
        ["RK4", "DOPRI5", "DOP853", "RKN8(6)", "Radau IIA"][self as usize]
    }

    /// Writes or reads the method.
    ///
    /// # Errors
    /// The method that was read does not exist.
    pub(super) fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        let mut index = *self as u8;
        record.choice("method", &mut index, Self::ALL.len())?;
        *self = Self::ALL[usize::from(index)];
        Ok(())
    }
}

/// Work done so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// Evaluations of the right-hand side.
    pub evaluations: u64,
    /// Accepted steps of all methods. The rigid-link formulation counts steps of Newmark's method here.
    pub accepted: u64,
    /// Rejected steps.
    pub rejected: u64,
    /// Jacobians.
    pub jacobians: u64,
    /// Iterations of Newton's method.
    pub newton_iterations: u64,
    /// Accepted steps by method, in the order of [`Method::ALL`].
    pub by_method: [u64; Method::ALL.len()],
}

impl Statistics {
    /// Accepted steps by this method.
    pub fn accepted_by(&self, method: Method) -> u64 {
        self.by_method[method as usize]
    }

    /// Counts an accepted step.
    #[inline]
    pub(super) fn accept(&mut self, method: Method) {
        self.accepted += 1;
        self.by_method[method as usize] += 1;
    }

    /// Adds the work of another integration.
    pub(super) fn add(&mut self, other: &Self) {
        let Self { evaluations, accepted, rejected, jacobians, newton_iterations, by_method } = other;
        self.evaluations += evaluations;
        (self.accepted, self.rejected) = (self.accepted + accepted, self.rejected + rejected);
        (self.jacobians, self.newton_iterations) =
            (self.jacobians + jacobians, self.newton_iterations + newton_iterations);
        self.by_method.iter_mut().zip(by_method).for_each(|(own, other)| *own += other);
    }

    /// Writes or reads all fields.
    ///
    /// # Errors
    /// A counter that was read is near overflow.
    pub(super) fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        let Self { evaluations, accepted, rejected, jacobians, newton_iterations, by_method } = self;
        let counts = [evaluations, accepted, rejected, jacobians, newton_iterations];
        counts.into_iter().chain(by_method).try_for_each(|count| record.count("statistics", count))
    }
}
