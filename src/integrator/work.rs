//! What an integration has done: by which method, how much.

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
    /// Accepted steps of RK4; those of DOP853 are the rest.
    pub short: u64,
}
