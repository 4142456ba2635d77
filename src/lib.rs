//! Planar linkages with one degree of freedom as FMI 2.0 co-simulation FMUs.
pub mod chebyshev;
pub mod closure;
pub mod curve;
pub mod definition;
pub mod fmi2;
pub mod integrator;
pub mod linkage;
pub mod loading;
pub mod loads;
pub mod model;
pub mod reactions;
pub mod reduced;
pub mod rigid_fem;
pub mod table;
pub mod variables;
