//! The equation of motion along the curve.
pub mod bumper_set;
pub mod controlled;
pub mod equation;
pub mod hydraulic;
pub mod inputs;
pub mod inverse;
mod kinks;
pub mod network;
pub mod panel_force;
pub mod ports;
pub mod prescribed;
pub mod state_loads;
mod surface;
pub mod switches;

pub use state_loads::is_still;
