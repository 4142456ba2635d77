//! The shared library that goes into every FMU of a hydraulic actuator or a hydraulic system.
//!
//! In: the functions of FMI 2.0 and 3.0. Out: a library that exports these, by their names in C, and nothing else. It
//! must not know what they do.
#![allow(unsafe_code, non_snake_case, clippy::missing_safety_doc)]

use linkage_fmu::component::{HYDRAULIC_ACTUATOR, HYDRAULIC_SYSTEM, ModelKind};
pub use linkage_fmu::{fmi2, fmi3};

const KINDS: &[ModelKind] = &[HYDRAULIC_ACTUATOR, HYDRAULIC_SYSTEM];
fmi2::instantiation!(KINDS, unsafe(no_mangle));
fmi3::instantiation!(KINDS, unsafe(no_mangle));
