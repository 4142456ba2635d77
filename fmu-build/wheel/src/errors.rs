//! Exceptions, also for panics.
//!
//! In: errors of all layers. Out: exceptions of `linkage_fmu._errors`, whose texts use the names of arguments in
//! Python.

use linkage_fmu::component::Refused;
use pyo3::prelude::*;
use std::fmt::Display;
use std::panic::{AssertUnwindSafe, catch_unwind};

// The classes are defined in Python, together with their documentation.
pyo3::import_exception!(linkage_fmu._errors, InputError);
pyo3::import_exception!(linkage_fmu._errors, InputTypeError);
pyo3::import_exception!(linkage_fmu._errors, SimulationError);
pyo3::import_exception!(linkage_fmu._errors, InternalError);

/// Options of the command line whose arguments have other names in Python.
const NAMES: [(&str, &str); 2] = [("--output-variables", "output"), ("--input-file", "input")];

/// First words of remedies by options that have no argument in Python. The remedies end with the clause.
const OPTIONS_ONLY: [&str; 2] = [", or give a library with --binary", "; or add --available"];

/// A text with the names of arguments instead of options.
pub fn in_python(text: &str) -> String {
    let mut text = NAMES.iter().fold(text.to_owned(), |text, (option, name)| text.replace(option, name));
    for remedy in OPTIONS_ONLY {
        while let Some(start) = text.find(remedy) {
            let rest = &text[start + remedy.len()..];
            let end = rest.find([';', '\n']).unwrap_or(rest.len());
            text.replace_range(start..start + remedy.len() + end, "");
        }
    }
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

/// A call that the model rejects in its present state.
#[cold]
pub fn refused(error: impl Display) -> PyErr {
    SimulationError::new_err(in_python(&format!("{error:#}")))
}

/// A value that the model rejects.
#[cold]
pub fn value(error: Refused) -> PyErr {
    input(error)
}

/// The result of a function. A panic becomes an exception.
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

/// The result of a function that runs while other threads may use Python. A panic becomes an exception.
pub fn detached<T: Send>(py: Python<'_>, body: impl FnOnce() -> PyResult<T> + Send) -> PyResult<T> {
    py.detach(|| guarded(body))
}
