//! Planar linkages with one degree of freedom as FMI 2.0 co-simulation FMUs.
pub mod chebyshev;
pub mod closure;
pub mod curve;
pub mod definition;
pub mod drag;
pub mod fmi2;
pub mod friction;
pub mod integrator;
pub mod linkage;
pub mod loading;
pub mod loads;
pub mod model;
pub mod number;
pub mod reactions;
pub mod reduced;
pub mod table;
pub mod variables;
