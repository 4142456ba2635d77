//! Adaptive integration of y' = f(t, y) by five one-step methods. Explicit where possible: RK4 over very short spans, a
//! Nystroem pair for forces that do not depend on the speed, DOPRI5 over short spans, else DOP853. Implicit (Radau IIA)
//! where the system is stiff.
//!
//! In: a first-order system, a start, a span, a tolerance. Out: y at the exact end of the span; for each step, on
//! request, the interpolant and where it passes a level. It must not know what y means.
mod control;
mod dense;
mod kept;
mod methods;
mod pair;
mod root;
mod statistics;
mod step;
mod system;

pub use control::Integrator;
pub use dense::Dense;
pub use root::Direction;
pub use statistics::{Method, Statistics};
pub use step::Step;
pub use system::{IntegrationError, System, differences};

/// Span [s] below which no state changes by more than rounding: far below any time in nature. Powers of a shorter span
/// underflow.
pub const SHORTEST: f64 = 1e-50;

#[cfg(test)]
mod tests;
