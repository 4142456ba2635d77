//! Adaptive integration of y' = f(t, y): explicit (DOP853, or RK4 over short spans) where it can be, implicit
//! (Radau IIA) where it must be.
//!
//! In: a first-order system, a start, a span, a tolerance. Out: y at the exact end of the span; for each step, on request,
//! the interpolant and where it passes a level. It must not know what y means.
mod controller;
mod dense;
mod dop853;
mod linear;
mod radau;
mod rk4;
mod root;
mod step;
mod stiffness;
mod system;

pub use controller::{IntegrationError, Integrator, Method, Statistics};
pub use dense::Dense;
pub use root::Direction;
pub use step::Step;
pub use system::System;

#[cfg(test)]
mod tests;
