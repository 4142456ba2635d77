//! Laws of loads: force, slope, potential, limits of smoothness. They must not know the linkage.
pub mod control;
pub mod drag;
pub mod friction;
pub mod gas;
pub mod profile;
pub mod spring;
pub mod stop;
