//! Adaptive integration of y' = f(t, y): explicit where it can be (a Nystroem pair for forces that do not depend on the speed,
//! else DOP853, or Dormand and Prince's pair of order 5 over spans that are short for it; RK4 over very short spans), implicit
//! (Radau IIA) where it must be.
//!
//! In: a first-order system, a start, a span, a tolerance. Out: y at the exact end of the span; for each step, on request,
//! the interpolant and where it passes a level. It must not know what y means.
mod controller;
mod dense;
mod dop853;
mod dopri5;
mod error;
mod linear;
mod pair;
mod radau;
mod reach;
mod rk4;
mod rkn86;
mod root;
mod starting;
mod step;
mod stiffness;
mod system;
mod work;

pub use controller::Integrator;
pub use dense::Dense;
pub use error::IntegrationError;
pub use root::Direction;
pub use step::Step;
pub use system::System;
pub use work::{Method, Statistics};

#[cfg(test)]
mod tests;
