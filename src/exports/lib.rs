//! The shared library that goes into every FMU.
//!
//! In: the functions of FMI 2.0 and 3.0. Out: a library that exports these, by their names in C, and nothing else. It
//! must not know what they do.

pub use linkage_fmu::{fmi2, fmi3};
