//! Exceptions, and panics as exceptions.
//!
//! In: errors of all layers. Out: exceptions of `linkage_fmu._errors`, whose texts name arguments as Python has them.

use linkage_fmu::component::Refused;
use pyo3::prelude::*;
use std::fmt::Display;
use std::panic::{AssertUnwindSafe, catch_unwind};

// The classes are defined in Python, where their documentation is.
pyo3::import_exception!(linkage_fmu._errors, InputError);
pyo3::import_exception!(linkage_fmu._errors, InputTypeError);
pyo3::import_exception!(linkage_fmu._errors, SimulationError);
pyo3::import_exception!(linkage_fmu._errors, InternalError);

/// Options of the command line whose arguments in Python have other names.
const NAMES: [(&str, &str); 2] = [("--output-variables", "output"), ("--input-file", "input")];

/// A text with the names of arguments in place of options.
pub fn in_python(text: &str) -> String {
    let text = NAMES.iter().fold(text.to_owned(), |text, (option, name)| text.replace(option, name));
    let mut parts = text.split("--");
    let mut out = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let is_name = |c: char| c.is_ascii_lowercase() || c == '-';
        let end = part.find(|c| !is_name(c)).unwrap_or(part.len());
        out.push_str(&part[..end].replace('-', "_"));
        out.push_str(&part[end..]);
    }
    out
}

/// An argument that cannot be used.
#[cold]
pub fn input(error: impl Display) -> PyErr {
    InputError::new_err(in_python(&format!("{error:#}")))
}

/// A call that the model refuses in its present state.
#[cold]
pub fn refused(error: impl Display) -> PyErr {
    SimulationError::new_err(in_python(&format!("{error:#}")))
}

/// A value that the model refuses.
#[cold]
pub fn value(error: Refused) -> PyErr {
    input(error)
}

/// The answer of a function; a panic in it becomes an exception.
#[inline]
pub fn guarded<T>(body: impl FnOnce() -> PyResult<T>) -> PyResult<T> {
    catch_unwind(AssertUnwindSafe(body)).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        let text = text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("unknown reason");
        Err(InternalError::new_err(format!(
            "internal fault of the engine ({text}); please report it with the mechanism and the calls that led to it"
        )))
    })
}
