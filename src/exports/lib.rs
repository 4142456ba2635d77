//! The shared library of every FMU of a mechanism without hydraulics.
//!
//! In: the functions of FMI 2.0 and 3.0. Out: a library that exports only these functions, by their C names. Must not
//! know: what they do.
#![allow(unsafe_code, non_snake_case, clippy::missing_safety_doc)]

use linkage_fmu::component::{ModelKind, PLAIN_MECHANISM};
pub use linkage_fmu::{fmi2, fmi3};

const KINDS: &[ModelKind] = &[PLAIN_MECHANISM];
fmi2::instantiation!(KINDS, unsafe(no_mangle));
fmi3::instantiation!(KINDS, unsafe(no_mangle));
