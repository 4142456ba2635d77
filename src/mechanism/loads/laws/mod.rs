//! Laws that size a load: force, slope, potential.
pub mod drag;
pub mod friction;
