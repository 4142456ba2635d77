//! Planar linkages with one degree of freedom as FMI 2.0 co-simulation FMUs.
pub mod chebyshev;
pub mod closure;
pub mod definition;
pub mod integrator;
pub mod linkage;
pub mod variables;
