//! Loads: forces and torques of unit size, the laws of their sizes, and the friction loop.
pub mod friction_loop;
pub mod laws;
pub mod resolved;
pub mod unit_load;
