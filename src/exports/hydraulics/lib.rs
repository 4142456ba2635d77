//! The shared library that goes into every FMU with hydraulics: of a hydraulic actuator, a hydraulic system, or a
//! mechanism that hydraulics drive.
//!
//! In: the functions of FMI 2.0 and 3.0. Out: a library that exports these, by their names in C, and nothing else. It
//! must not know what they do.
#![allow(unsafe_code, non_snake_case, clippy::missing_safety_doc)]

use linkage_fmu::component::{KINDS, ModelKind};
pub use linkage_fmu::{fmi2, fmi3};

const ALL: &[ModelKind] = &KINDS;
fmi2::instantiation!(ALL, unsafe(no_mangle));
fmi3::instantiation!(ALL, unsafe(no_mangle));
