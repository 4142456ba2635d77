//! The equation of motion along the curve.
pub mod bumper_set;
pub mod equation;
pub mod hydraulic;
pub mod inputs;
pub mod panel_force;
pub mod state_loads;
pub mod switches;
