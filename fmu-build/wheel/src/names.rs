//! Lists of variables that are looked up once, and buffers of their values.
//!
//! In: names, arrays. Out: references, numbers. Arrays of doubles are read and written in place.

use crate::arguments;
use crate::errors::{InputError, input};
use fmu_build::start_values::find;
use linkage_fmu::component::Component;
use linkage_fmu::variables::{Causality, Kind, Reference};
use pyo3::buffer::PyBuffer;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyList, PySlice};

/// Names of variables that `Simulation.prepare` has looked up. A `Names` object can be used in all simulations of one
/// mechanism.
#[pyclass(frozen, module = "linkage_fmu")]
pub struct Names {
    /// Names in the given order.
    names: Vec<String>,
    /// References of the variables.
    pub references: Vec<Reference>,
    /// Kinds of the variables.
    pub kinds: Vec<Kind>,
    /// Whether all are Reals.
    pub are_reals: bool,
    /// Whether all are numeric inputs, which are set without further checks.
    pub are_inputs: bool,
    /// Hash of the interface to which the references belong.
    identity: u64,
}

impl Names {
    /// Look up the names.
    ///
    /// # Errors
    /// The argument contains no names; a name is duplicate; a name is unknown, and the message contains similar names.
    pub fn of(model: &Component, argument: &str, names: &Bound<'_, PyAny>) -> PyResult<Self> {
        let names = arguments::names(argument, names)?;
        let interface = model.interface();
        let found = names.iter().map(|name| find(interface, name)).collect::<Result<Vec<_>, _>>();
        let references = found.map_err(input)?;
        let variable = |reference: &Reference| &interface.list()[*reference as usize];
        let kinds: Vec<Kind> = references.iter().map(|reference| variable(reference).kind).collect();
        let are_reals = kinds.iter().all(|kind| *kind == Kind::Real);
        let are_inputs = are_reals && references.iter().all(|own| variable(own).causality == Causality::Input);
        Ok(Self { names, references, kinds, are_reals, are_inputs, identity: model.identity()[0] })
    }

    /// Check that the names belong to a mechanism with these variables.
    ///
    /// # Errors
    /// The names belong to another mechanism.
    pub fn belong_to(&self, model: &Component) -> PyResult<()> {
        if self.identity == model.identity()[0] {
            return Ok(());
        }
        Err(InputError::new_err(
            "these names were prepared for a mechanism with other variables; call prepare on this simulation",
        ))
    }
}

#[pymethods]
impl Names {
    fn __len__(&self) -> usize {
        self.names.len()
    }

    fn __getitem__<'py>(&self, index: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        if !index.is_instance_of::<PySlice>() && index.extract::<isize>().is_err() {
            return Err(arguments::wrong("index", index, "a whole number or a slice"));
        }
        PyList::new(index.py(), &self.names)?.as_any().get_item(index)
    }

    fn __repr__(&self) -> String {
        format!("Names({:?})", self.names)
    }
}

/// Call `take` with the numbers in an array of doubles or a list of numbers, as many as there are names. None for any
/// other object, for which [`crate::arguments::values`] returns the error.
#[inline]
pub fn with_numbers<T>(
    values: &Bound<'_, PyAny>,
    count: usize,
    take: impl FnOnce(&[f64]) -> PyResult<T>,
) -> Option<PyResult<T>> {
    if let Ok(buffer) = PyBuffer::<f64>::get(values) {
        if buffer.dimensions() != 1 || buffer.item_count() != count {
            return None;
        }
        let mut few = [0.0; 16];
        if count <= few.len() {
            let few = &mut few[..count];
            return Some(buffer.copy_to_slice(values.py(), few).and_then(|()| take(few)));
        }
        return Some(buffer.to_vec(values.py()).and_then(|all| take(&all)));
    }
    None
}

/// A new array of numpy with these numbers.
///
/// # Errors
/// numpy is not installed.
pub fn array<'py>(py: Python<'py>, values: &[f64]) -> PyResult<Bound<'py, PyAny>> {
    static EMPTY: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let array = EMPTY.import(py, "numpy", "empty")?.call1((values.len(),))?;
    write(&array, values)?;
    Ok(array)
}

/// Write numbers into an array of doubles.
///
/// # Errors
/// The object is no writable array with this length.
pub fn write(array: &Bound<'_, PyAny>, values: &[f64]) -> PyResult<()> {
    let buffer = PyBuffer::<f64>::get(array).ok();
    let fits = |buffer: &PyBuffer<f64>| buffer.dimensions() == 1 && buffer.item_count() == values.len();
    match buffer.filter(fits).filter(|buffer| !buffer.readonly()) {
        Some(buffer) => buffer.copy_from_slice(array.py(), values),
        None => Err(InputError::new_err(format!(
            "out must be a writable array with {} numbers of type float64",
            values.len()
        ))),
    }
}
