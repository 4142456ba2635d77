//! Planar linkages with one degree of freedom as FMI 2.0 co-simulation FMUs.
pub mod chebyshev;
pub mod integrator;
