//! The extension `linkage_fmu._engine`: models, runs and tasks for the Python package.
//!
//! In: texts, names, numbers and buffers of Python. Out: the same types, or an exception of `linkage_fmu._errors`. The
//! extension converts data and computes nothing itself. It must not know how Python displays anything.

mod arguments;
mod errors;
mod many;
mod model;
mod names;
mod rows;
mod run;
mod simulation;
mod tasks;
mod travel;

use pyo3::prelude::*;

/// Engine, packer and studies of linkage-fmu; the classes of the package use it.
#[pymodule(name = "_engine")]
mod engine {
    /// Version of the package.
    #[pymodule_export]
    #[expect(non_upper_case_globals, reason = "the name that Python has for it")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
    #[pymodule_export]
    use crate::many::many;
    #[pymodule_export]
    use crate::model::Model;
    #[pymodule_export]
    use crate::names::Names;
    #[pymodule_export]
    use crate::rows::Plan;
    #[pymodule_export]
    use crate::simulation::{Simulation, State};
    #[pymodule_export]
    use crate::tasks::{check, folder, info, kind_of, main, optimise, package, panics, read, sweep, validate};
}
