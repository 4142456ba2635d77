//! What an integration has done: by which method, how much.

use crate::codec::record::{Damaged, Record};

/// A method of integration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Explicit Runge-Kutta of order 8, Dormand and Prince.
    #[default]
    Dop853,
    /// Explicit Runge-Kutta of order 4, the classical one.
    Rk4,
    /// Implicit Runge-Kutta of order 5, Radau IIA.
    Radau,
    /// Explicit Runge-Kutta-Nystroem of order 8, Dormand, El-Mikkawy and Prince.
    Rkn86,
    /// Explicit Runge-Kutta of order 5, Dormand and Prince.
    Dopri5,
}

impl Method {
    const ALL: [Self; 5] = [Self::Dop853, Self::Rk4, Self::Radau, Self::Rkn86, Self::Dopri5];

    /// Written or read.
    ///
    /// # Errors
    /// There is no such method.
    pub(super) fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        let mut place = *self as u8;
        record.choice("method", &mut place, Self::ALL.len())?;
        *self = Self::ALL[usize::from(place)];
        Ok(())
    }
}

/// Work done so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// Right-hand-side evaluations.
    pub evaluations: u64,
    /// Accepted steps of all methods.
    pub accepted: u64,
    /// Rejected steps of all methods.
    pub rejected: u64,
    /// Jacobians.
    pub jacobians: u64,
    /// Iterations of Newton's method.
    pub newton_iterations: u64,
    /// Accepted steps of Radau IIA.
    pub implicit: u64,
    /// Accepted steps of RK4.
    pub short: u64,
    /// Accepted steps of the Nystroem pair.
    pub nystroem: u64,
    /// Accepted steps of the pair of order 5; those of DOP853 are the rest.
    pub fifth: u64,
}

impl Statistics {
    /// All fields, written or read.
    ///
    /// # Errors
    /// A count near overflow is read.
    pub(super) fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        let Self { evaluations, accepted, rejected, jacobians, newton_iterations, implicit, short, nystroem, fifth } =
            self;
        for count in [evaluations, accepted, rejected, jacobians, newton_iterations, implicit, short, nystroem, fifth] {
            record.count("statistics", count)?;
        }
        Ok(())
    }
}
