//! Adaptive integration of y' = f(t, y) by five one-step methods. RK4 is used over very short spans, a Nystroem pair
//! for forces that do not depend on the speed, DOPRI5 over short spans, otherwise DOP853. Radau IIA, which is implicit,
//! is used where the system is stiff.
//!
//! In: a first-order system, a start, a span, a tolerance. Out: y at the exact end of the span; for each step, on
//! request, the interpolant and its passages of a level. Must not know: what y means.
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

/// Span [s] in which no state changes by more than its rounding error. The span is far below any time in nature. Powers
/// of a shorter span underflow.
pub const SHORTEST: f64 = 1e-50;

#[cfg(test)]
mod tests;
