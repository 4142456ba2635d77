//! Planar linkages with one degree of freedom as FMI 2.0 co-simulation FMUs.
pub mod codec;
pub mod component;
pub mod fmi;
pub mod fmi2;
pub mod format;
pub mod integrator;
pub mod mechanism;
pub mod numerics;
pub mod simulation;
pub mod variables;
