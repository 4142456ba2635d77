//! The shared library of every FMU with hydraulics: a hydraulic actuator, a hydraulic system, or a mechanism with
//! hydraulic drives.
//!
//! In: the functions of FMI 2.0 and 3.0. Out: a library that exports only these functions, by their C names. Must not
//! know: what they do.
#![allow(unsafe_code, non_snake_case, clippy::missing_safety_doc)]

use linkage_fmu::component::{KINDS, ModelKind};
pub use linkage_fmu::{fmi2, fmi3};

const ALL: &[ModelKind] = &KINDS;
fmi2::instantiation!(ALL, unsafe(no_mangle));
fmi3::instantiation!(ALL, unsafe(no_mangle));
