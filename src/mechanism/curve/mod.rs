//! The curve of closed positions, traced once and parametrised by its length in the kinetic metric.
//!
//! In: an assembled linkage. Out: for every sigma the configuration with two derivatives. It must not know loads or
//! time.
//!
//! sigma [kg^(1/2) m] is the arc length for which the kinetic energy is T = sigma_dot^2 / 2: the reduced inertia of
//! [CK16] is 1 everywhere, its derivative 0, and a motion without loads is sigma = sigma_0 + sigma_dot t exactly. A
//! toggle is a regular point of the curve. Where branches cross, the curve goes straight on.
mod base;
mod bridge;
mod configuration;
mod course;
mod crossings;
mod error;
mod evaluate;
mod extrapolation;
mod fields;
mod grid;
mod kinetic;
mod misses;
mod near;
mod panel;
mod part;
mod singular;
mod stretch;
mod trace;
mod tracer;
mod travel;

pub use configuration::{Configuration, Scratch};
pub use error::{CurveError, cure};
pub use evaluate::{Curve, Ends};
pub use misses::{Near, NearMiss};
pub use near::{Candidate, REPORTED, is_same};
pub use singular::{Place, Singular};
pub use stretch::STRETCHES;
pub use tracer::NEAR_CROSSING;

#[cfg(test)]
mod tests;
