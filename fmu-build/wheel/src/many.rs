//! Many runs of a model from Python.
//!
//! In: names, start values for each run, a stop time. Out: the outputs of each run at the stop time, as numbers that
//! numpy reads, and the reasons of missing values.

use crate::arguments::{optional, whole};
use crate::errors::{detached, input, value};
use crate::model::Model;
use crate::rows::{Plan, packed};
use fmu_build::start_values::find;
use linkage_fmu::simulation::Ensemble;
use pyo3::prelude::*;
use pyo3::types::PyByteArray;
use std::thread::available_parallelism;

/// Values of the outputs for each run, and for each run with a NaN its number and the reason.
type Made<'py> = (Bound<'py, PyByteArray>, Vec<(usize, String)>);

/// Largest number of threads.
const MOST_THREADS: i64 = 1024;

/// Make runs with these start values. `rows` contains a double for each name, run by run. The outputs are those of the
/// plan at the stop time.
#[pyfunction]
#[pyo3(signature = (model, names, rows, stop_time, plan, start_values, threads))]
#[expect(clippy::too_many_arguments, reason = "one function of Python calls it")]
pub fn many<'py>(
    py: Python<'py>,
    model: &Model,
    names: Vec<String>,
    rows: &[u8],
    stop_time: Option<&Bound<'py, PyAny>>,
    plan: &Plan,
    start_values: Option<&Bound<'py, PyAny>>,
    threads: Option<&Bound<'py, PyAny>>,
) -> PyResult<Made<'py>> {
    let stop_time = optional("stop_time", stop_time)?;
    let threads = match threads {
        Some(threads) => whole::<1, MOST_THREADS>("threads", threads)? as usize,
        None => available_parallelism().map_or(1, usize::from),
    };
    let model = model.started(start_values)?;
    let stop_time = stop_time.unwrap_or(model.experiment().stop_time);
    if !(stop_time >= 0.0 && stop_time.is_finite()) {
        return Err(input(format!("stop_time = {stop_time:?} s: must be finite and not negative")));
    }
    let number = |bytes: &[u8; 8]| f64::from_ne_bytes(*bytes);
    let rows: Vec<f64> = rows.as_chunks().0.iter().map(number).collect();
    let mut interrupted = None;
    let runs = detached(py, || {
        let find = |name: &String| find(model.interface(), name);
        let varied: Vec<_> = names.iter().map(find).collect::<Result<_, _>>().map_err(input)?;
        let ensemble = Ensemble { model: &model, varied: &varied, outputs: plan.references(), stop_time };
        let watch = |_| {
            interrupted = Python::attach(|py| py.check_signals()).err();
            interrupted.is_some()
        };
        ensemble.run(&rows, threads, watch).map_err(value)
    })?;
    match interrupted {
        Some(interrupted) => Err(interrupted),
        None => Ok((packed(py, &runs.values)?, runs.remarks)),
    }
}
