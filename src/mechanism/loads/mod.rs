//! Loads: forces and torques of unit size, and the laws that size them.
pub mod laws;
pub mod resolved;
pub mod unit_load;
