//! Rows of a run.
//!
//! In: a model with its start values, times of the rows, signals, the variables to record. Out: rows as bytes in the
//! layout for numpy. A run has the steps of `cargo fmu simulate`, so that both have the same values.

use crate::errors::{InputError, input};
use fmu_build::run::column::{Column, columns};
use fmu_build::run::missing::Missing;
use fmu_build::run::signals::Signals;
use fmu_build::run::{self, Span, Watch};
use fmu_build::start_values::find;
use linkage_fmu::component::Component;
use linkage_fmu::variables::{Reference, Unit};
use pyo3::prelude::*;
use pyo3::types::PyByteArray;

/// Largest number of bytes of a result.
pub const MOST_BYTES: f64 = 2e9;
/// Largest number of rows for which memory is reserved before a run.
const MOST_RESERVED: usize = 1 << 16;

/// Rows of a run, its warnings, the error that ended it, and the time reached [s].
pub type Made<Rows> = PyResult<(Rows, Vec<String>, Option<String>, f64)>;

/// Variables that a run records, looked up once.
#[pyclass(frozen, module = "linkage_fmu._engine")]
pub struct Plan {
    columns: Vec<Column>,
    references: Vec<Reference>,
}

#[pymethods]
impl Plan {
    /// Names and units of the variables, and whether each is a Boolean.
    fn layout(&self) -> Vec<(String, &'static str, bool)> {
        let one = |own: &Column| (own.name.clone(), own.unit.map_or("1", Unit::name), own.is_boolean);
        self.columns.iter().map(one).collect()
    }
}

impl Plan {
    /// Look up these variables of a model. All outputs if there are none.
    ///
    /// # Errors
    /// A name is no numeric variable, or is duplicate.
    pub fn of(model: &Component, names: &[String]) -> PyResult<Self> {
        let columns = columns(model.interface(), names).map_err(input)?;
        let references = columns.iter().map(|column| find(model.interface(), &column.name));
        Ok(Self { references: references.collect::<Result<_, _>>().map_err(input)?, columns })
    }

    /// The variables, in their order.
    pub fn references(&self) -> &[Reference] {
        &self.references
    }

    /// Rows in the layout of numpy: doubles, and a byte for a Boolean.
    pub fn packed<'py>(&self, py: Python<'py>, rows: &[f64]) -> PyResult<Bound<'py, PyByteArray>> {
        if !self.columns.iter().any(|column| column.is_boolean) {
            return packed(py, rows);
        }
        let mut out = Vec::with_capacity(rows.len() * 8);
        for row in rows.chunks_exact(1 + self.columns.len()) {
            out.extend_from_slice(&row[0].to_ne_bytes());
            for (column, value) in self.columns.iter().zip(&row[1..]) {
                match column.is_boolean {
                    true => out.push(u8::from(*value != 0.0)),
                    false => out.extend_from_slice(&value.to_ne_bytes()),
                }
            }
        }
        Ok(PyByteArray::new(py, &out))
    }
}

/// Warnings of a run, and the user's request to end it.
#[derive(Default)]
struct Observer {
    lines: Vec<String>,
    interrupted: Option<PyErr>,
}

impl Watch for Observer {
    fn look(&mut self, _: f64) -> bool {
        self.interrupted = Python::attach(|py| py.check_signals()).err();
        self.interrupted.is_some()
    }

    fn warn(&mut self, line: &str) {
        self.lines.push(line.trim_start_matches("warning: ").to_owned());
    }
}

/// Check that the result of a run fits into the memory.
///
/// # Errors
/// The result would have too many rows.
pub fn fits(span: &Span, plan: &Plan) -> PyResult<()> {
    let rows = ((span.stop - span.start) / span.interval).ceil() + 1.0;
    let columns = 1 + plan.columns.len();
    let bytes = rows * columns as f64 * 8.0;
    if bytes <= MOST_BYTES {
        return Ok(());
    }
    Err(InputError::new_err(format!(
        "output_interval = {:?} s: {rows:.0} rows of {columns} columns need {:.1} GB, but a result has at most {:.1} \
         GB; give a larger output_interval or fewer names in output, or write the rows to a file by the command \
         linkage-fmu simulate",
        span.interval,
        bytes / 1e9,
        MOST_BYTES / 1e9
    )))
}

/// Make a run. Returns its rows, its warnings, the reason of an early end, and the time reached [s].
pub fn made(model: &mut Component, span: &Span, signals: &Signals, plan: &Plan) -> Made<Vec<f64>> {
    let Plan { columns, references } = plan;
    let width = 1 + columns.len();
    let expected = ((span.stop - span.start) / span.interval) as usize + 2;
    let mut rows: Vec<f64> = Vec::with_capacity(expected.min(MOST_RESERVED) * width);
    let (mut missing, mut reached) = (Missing::new(columns.len()), span.start);
    let are_reals = !columns.iter().any(|column| column.is_boolean);
    let mut record = |model: &mut Component, time: f64| {
        let start = rows.len();
        rows.push(time);
        if are_reals {
            model.reals(references, |value| rows.push(value))?;
        } else {
            for (column, &reference) in columns.iter().zip(references) {
                rows.push(match column.is_boolean {
                    true => f64::from(u8::from(model.boolean(reference)?)),
                    false => model.real(reference)?,
                });
            }
        }
        reached = time;
        missing.see(&rows[start..], |index| model.undefined(references[index]));
        Ok(())
    };
    let mut watch = Observer::default();
    let ended = run::run(model, span, signals, &mut record, &mut watch);
    if let Some(interrupted) = watch.interrupted {
        return Err(interrupted);
    }
    let names: Vec<&str> = columns.iter().map(|column| &*column.name).collect();
    watch.lines.extend(missing.lines(&names));
    // An incomplete row after a rejected value is removed.
    rows.truncate(rows.len() / width * width);
    Ok((rows, watch.lines, ended.err().map(|error| format!("{error:#}")), reached))
}

/// Numbers as bytes for numpy.
pub fn packed<'py>(py: Python<'py>, values: &[f64]) -> PyResult<Bound<'py, PyByteArray>> {
    PyByteArray::new_with(py, 8 * values.len(), |bytes| {
        for (place, value) in bytes.as_chunks_mut::<8>().0.iter_mut().zip(values) {
            *place = value.to_ne_bytes();
        }
        Ok(())
    })
}
