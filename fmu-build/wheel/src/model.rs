//! A mechanism or a hydraulic model: its variables, its runs, and what it answers without time.
//!
//! In: a definition's text, names, times, signals. Out: rows as bytes of the layout that numpy reads, texts. A run has
//! the steps of `cargo fmu simulate`, so that both have the same values.

use crate::arguments::{self, names, number, optional, whole};
use crate::errors::{InputError, guarded, input, refused};
use crate::simulation::Simulation;
use fmu_build::run::column::{Column, columns};
use fmu_build::run::missing::Missing;
use fmu_build::run::signals::Signals;
use fmu_build::run::{self, Span, Watch};
use fmu_build::start_values::{self, find};
use fmu_build::view::{Data, Wanted};
use fmu_build::{check, view};
use linkage_fmu::component::{Component, Linearised, NoValue};
use linkage_fmu::variables::{Causality, Kind, Reference, Unit, Value};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::{PyByteArray, PyDict};
use std::sync::{Mutex, PoisonError};

/// Most bytes of a result.
const MOST_BYTES: f64 = 2e9;
/// Most parts of a travel.
const MOST_PARTS: i64 = 1_000_000;
/// Most positions of a travel at which a mechanism is linearised: each has some kB in Python.
const MOST_LINEARISED: i64 = 100_000;
/// Most rows for which memory is taken before a run.
const MOST_RESERVED: usize = 1 << 16;
/// Positions along a travel between two looks at Ctrl-C.
const POSITIONS_PER_LOOK: usize = 1 << 12;

/// Signals as Python gives them: times, and for each input its name and values.
type Columns = (Vec<f64>, Vec<(String, Vec<f64>)>);

/// Coordinate, inputs, outputs and holding drive of a linearisation; None and empty lists for the defaults.
type Asked<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>);
/// Rows of a run, its warnings, the error that ended it, and the time reached [s].
type Made<Rows> = PyResult<(Rows, Vec<String>, Option<String>, f64)>;

/// A model from its definition.
#[pyclass(frozen, module = "linkage_fmu._engine")]
pub struct Model {
    /// Name of the definition file of its kind.
    kind: &'static str,
    text: String,
    /// The model as the definition gives it; never changed.
    fresh: Mutex<Component>,
    /// A model that a run has left, reset: the next run finds its memory.
    used: Mutex<Option<Component>>,
}

/// What a run records, looked up once.
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
    /// Rows in the layout of numpy: doubles, and a byte for a Boolean.
    fn packed<'py>(&self, py: Python<'py>, rows: &[f64]) -> PyResult<Bound<'py, PyByteArray>> {
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

/// Warnings of a run, and the wish of the user to end it.
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

impl Model {
    /// A model of its own for a call.
    fn component(&self) -> Component {
        self.fresh.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// The model with these start values.
    fn started(&self, start_values: Option<&Bound<'_, PyAny>>) -> PyResult<Component> {
        Self::with(self.component(), start_values)
    }

    fn with(mut model: Component, start_values: Option<&Bound<'_, PyAny>>) -> PyResult<Component> {
        guarded(|| {
            if let Some(given) = start_values {
                let values = arguments::start_values(model.interface(), Some(given))?;
                start_values::apply_all(&mut model, values).map_err(input)?;
            }
            Ok(model)
        })
    }
}

#[pymethods]
impl Model {
    #[new]
    fn new(kind: &str, text: String) -> PyResult<Self> {
        guarded(|| {
            let fresh = Component::from_definition(kind, &text).map_err(input)?;
            Ok(Self { kind: fresh.definition_file(), text, fresh: Mutex::new(fresh), used: Mutex::new(None) })
        })
    }

    /// Name, description, stop time [s] and step [s] of the default experiment, and warnings.
    fn about(&self) -> (String, String, f64, f64, Vec<String>) {
        let model = self.component();
        let experiment = model.experiment();
        let warnings = model.warnings().iter().map(ToString::to_string).collect();
        let (name, description) = (model.name().to_owned(), model.description().to_owned());
        (name, description, experiment.stop_time, experiment.step_size, warnings)
    }

    /// For each variable: name, kind, causality, variability, unit, start value, items, description.
    fn variables<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let model = self.component();
        let one = |variable: &linkage_fmu::variables::Variable| {
            let dict = PyDict::new(py);
            dict.set_item("name", &variable.name)?;
            dict.set_item("kind", variable.kind.word())?;
            dict.set_item("causality", in_lower_case(variable.causality.word()))?;
            dict.set_item("variability", in_lower_case(variable.variability.word()))?;
            dict.set_item("unit", variable.unit.map_or("", Unit::name))?;
            let start = match &variable.start {
                Some(Value::Real(value)) => Some(value.into_bound_py_any(py)?),
                Some(Value::Boolean(value)) => Some(value.into_bound_py_any(py)?),
                Some(Value::Item(value)) => Some(value.into_bound_py_any(py)?),
                None => None,
            };
            dict.set_item("start", start)?;
            dict.set_item("items", variable.details.items.to_vec())?;
            dict.set_item("description", &variable.description)?;
            Ok(dict)
        };
        model.interface().list().iter().map(one).collect()
    }

    /// What a run records: these variables, or all outputs.
    #[pyo3(signature = (output = None))]
    fn plan(&self, output: Option<&Bound<'_, PyAny>>) -> PyResult<Plan> {
        let names = output.map_or(Ok(Vec::new()), |output| names("output", output))?;
        let model = self.component();
        let columns = columns(model.interface(), &names).map_err(input)?;
        let references = columns.iter().map(|column| find(model.interface(), &column.name));
        Ok(Plan { references: references.collect::<Result<_, _>>().map_err(input)?, columns })
    }

    /// A run: its rows as bytes, its warnings, the error that ended it, and the time reached [s].
    #[pyo3(signature = (plan, start, stop, interval, tolerance, start_values, signals, with_slopes))]
    #[expect(clippy::too_many_arguments, reason = "one function of Python calls it")]
    fn run<'py>(
        &self,
        py: Python<'py>,
        plan: &Plan,
        start: &Bound<'py, PyAny>,
        stop: Option<&Bound<'py, PyAny>>,
        interval: Option<&Bound<'py, PyAny>>,
        tolerance: Option<&Bound<'py, PyAny>>,
        start_values: Option<&Bound<'py, PyAny>>,
        signals: Option<Columns>,
        with_slopes: bool,
    ) -> Made<Bound<'py, PyByteArray>> {
        let (start, stop) = (number("start_time", start)?, optional("stop_time", stop)?);
        let (interval, tolerance) =
            (optional("output_interval", interval)?, optional("relative_tolerance", tolerance)?);
        let used = self.used.lock().unwrap_or_else(PoisonError::into_inner).take();
        let mut model = Self::with(used.unwrap_or_else(|| self.component()), start_values)?;
        let (rows, warnings, error, time) = py.detach(|| {
            guarded(|| {
                if let Some(tolerance) = tolerance {
                    model.set_tolerance(tolerance).map_err(|error| input(format!("relative_tolerance: {error}")))?;
                }
                let span = Span::new(model.experiment(), start, stop, interval).map_err(input)?;
                fits(&span, plan)?;
                let signals = match signals {
                    Some((times, columns)) => {
                        Signals::of_columns(model.interface(), times, columns, with_slopes).map_err(input)?
                    }
                    None => Signals::none(),
                }
                .within(&span);
                if with_slopes && model.input_order() == 0 {
                    return Err(input("set_input_derivatives: this model has no derivatives of inputs"));
                }
                let made = made(&mut model, &span, &signals, plan)?;
                model.reset();
                *self.used.lock().unwrap_or_else(PoisonError::into_inner) = Some(model);
                Ok(made)
            })
        })?;
        Ok((plan.packed(py, &rows)?, warnings, error, time))
    }

    /// Along the travel in `count` equal parts: values of the named variables, and their first and second rates for
    /// each unit of a parameter of the travel. Row by row: parameter, values, rates, second rates.
    #[pyo3(signature = (count, outputs, start_values))]
    fn travel<'py>(
        &self,
        py: Python<'py>,
        count: &Bound<'py, PyAny>,
        outputs: &Bound<'py, PyAny>,
        start_values: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyByteArray>> {
        let count = whole::<1, MOST_PARTS>("count", count)? as usize;
        let outputs = names("outputs", outputs)?;
        let bytes = (count + 1) as f64 * (1 + 3 * outputs.len()) as f64 * 8.0;
        if bytes > MOST_BYTES {
            return Err(InputError::new_err(format!(
                "count = {count}: {} outputs at {} positions need {:.1} GB, but a result has at most {:.1} GB; give a \
                 smaller count or fewer outputs",
                outputs.len(),
                count + 1,
                bytes / 1e9,
                MOST_BYTES / 1e9
            )));
        }
        let mut model = self.started(start_values)?;
        let values = py.detach(|| guarded(|| along(&mut model, count, &outputs)))?;
        packed(py, &values)
    }

    /// Linearised at the start or, with `count`, along the travel: names of coordinate, inputs and outputs, and the
    /// dictionaries of the positions.
    #[expect(clippy::type_complexity, reason = "one function of Python calls it")]
    fn linearise<'py>(
        &self,
        py: Python<'py>,
        asked: Asked<'py>,
        count: Option<&Bound<'py, PyAny>>,
        start_values: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<(String, Vec<String>, Vec<String>, Vec<Bound<'py, PyDict>>)> {
        let (coordinate, inputs, outputs, held_by) = asked;
        let count = count.map(|count| whole::<1, MOST_LINEARISED>("count", count)).transpose()?;
        let arguments = fmu_studies::linearise::Arguments {
            path: Default::default(),
            coordinate: optional_text("coordinate", coordinate)?,
            inputs: names("inputs", &inputs)?,
            outputs: names("outputs", &outputs)?,
            held_by: optional_text("held_by", held_by)?,
            count: 0,
            start_values: Vec::new(),
            output_file: None,
            plot: None,
        };
        let mut model = self.started(start_values)?;
        let (names, all) = py.detach(|| {
            guarded(|| {
                let what = fmu_studies::linearise::what(&model, &arguments).map_err(input)?;
                let name = |own: &Reference| model.interface().list()[*own as usize].name.clone();
                let named = |all: &[Reference]| all.iter().map(name).collect::<Vec<_>>();
                let names = (name(&what.coordinate), named(&what.inputs), named(&what.outputs));
                let all = match count {
                    Some(count) => model.linearise(&what, count as usize),
                    None => model.linearise_here(&what).map(|one| vec![one]),
                };
                Ok((names, all.map_err(refused)?))
            })
        })?;
        let (coordinate, inputs, outputs) = names;
        Ok((coordinate, inputs, outputs, all.iter().map(|at| dictionary(py, at)).collect::<PyResult<_>>()?))
    }

    /// A simulation with these start values, not initialised.
    #[pyo3(signature = (start_values))]
    fn simulation(&self, start_values: Option<&Bound<'_, PyAny>>) -> PyResult<Simulation> {
        guarded(|| Ok(Simulation::new(self.started(start_values)?)))
    }

    /// The page that moves the mechanism, which messages name so.
    fn page(
        &self,
        py: Python<'_>,
        shown: String,
        stop_time: Option<&Bound<'_, PyAny>>,
        start_values: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<String> {
        let stop_time = optional("stop_time", stop_time)?;
        let wanted = Wanted::new(stop_time, &[]).map_err(input)?;
        let wanted = wanted.with(arguments::start_values(self.component().interface(), start_values)?);
        py.detach(|| {
            guarded(|| {
                let checked = check::check(shown, self.kind, self.text.clone()).map_err(input)?;
                let data = Data::collect(&checked, &wanted).map_err(input)?;
                view::html(&data).map_err(refused)
            })
        })
    }
}

/// A word of the engine as modelDescription.xml has it.
fn in_lower_case(word: &str) -> String {
    word.chars().take(1).flat_map(char::to_lowercase).chain(word.chars().skip(1)).collect()
}

/// A text, or None.
fn optional_text(argument: &str, given: Bound<'_, PyAny>) -> PyResult<Option<String>> {
    if given.is_none() { Ok(None) } else { arguments::text(argument, &given).map(Some) }
}

/// Whether the result of a run has room.
///
/// # Errors
/// It would have too many rows.
fn fits(span: &Span, plan: &Plan) -> PyResult<()> {
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

/// Make a run: its rows, its warnings, why it ended early, and the time reached [s].
fn made(model: &mut Component, span: &Span, signals: &Signals, plan: &Plan) -> Made<Vec<f64>> {
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
    // A row that a refused value has cut short is left out.
    rows.truncate(rows.len() / width * width);
    Ok((rows, watch.lines, ended.err().map(|error| format!("{error:#}")), reached))
}

/// Numbers as the bytes that numpy reads.
fn packed<'py>(py: Python<'py>, values: &[f64]) -> PyResult<Bound<'py, PyByteArray>> {
    PyByteArray::new_with(py, 8 * values.len(), |bytes| {
        for (place, value) in bytes.as_chunks_mut::<8>().0.iter_mut().zip(values) {
            *place = value.to_ne_bytes();
        }
        Ok(())
    })
}

/// Name of the rate of a position.
fn rate_of(position: &str) -> Option<String> {
    let (owner, suffix) = position.rsplit_once('.')?;
    let rate = match suffix {
        "angle" | "position" | "length" => "speed",
        "x" => "velocity_x",
        "y" => "velocity_y",
        _ => return None,
    };
    Some(format!("{owner}.{rate}"))
}

/// Values of variables along the travel without time, then their rates, then the second rates of positions.
fn along(model: &mut Component, count: usize, names: &[String]) -> PyResult<Vec<f64>> {
    let found = names.iter().map(|name| find(model.interface(), name)).collect::<Result<Vec<_>, _>>();
    let references: Vec<Reference> = found.map_err(input)?;
    for (&reference, name) in references.iter().zip(names) {
        let variable = &model.interface().list()[reference as usize];
        if variable.causality != Causality::Output || variable.kind != Kind::Real {
            return Err(input(format!("{name} is not an output with a number; kinematics returns outputs only")));
        }
    }
    let rates: Vec<Option<Reference>> = names.iter().map(|name| model.interface().find(&rate_of(name)?)).collect();
    let Component::Mechanism(own) = model else {
        return Err(input("a hydraulic actuator without a mechanism has no travel"));
    };
    let travel = own.sweep(count).map_err(refused)?.sigma;
    own.serve_travel().map_err(refused)?;
    model.initialize().map_err(refused)?;
    let mut rows = Vec::with_capacity(travel.len() * (1 + 3 * names.len()));
    let no_value = |error: NoValue| match error {
        NoValue::AtState(why) => refused(why),
        NoValue::Refused(why) => refused(why),
    };
    for (position, &sigma) in travel.iter().enumerate() {
        if position % POSITIONS_PER_LOOK == POSITIONS_PER_LOOK - 1 {
            Python::attach(|py| py.check_signals())?;
        }
        rows.push(sigma);
        model.set_continuous_states([sigma, 0.0]).map_err(no_value)?;
        model.reals(&references, |value| rows.push(value)).map_err(refused)?;
        // With this speed, rates in time are those along the travel.
        model.set_continuous_states([sigma, 1.0]).map_err(no_value)?;
        for &reference in &references {
            rows.push(model.output_derivative(reference, 1).unwrap_or(f64::NAN));
        }
        for &rate in &rates {
            rows.push(rate.and_then(|rate| model.output_derivative(rate, 1).ok()).unwrap_or(f64::NAN));
        }
    }
    Ok(rows)
}

/// A linearisation for Python; a matrix is a list of rows.
fn dictionary<'py>(py: Python<'py>, at: &Linearised) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("position", at.coordinate)?;
    dict.set_item("acceleration", at.acceleration)?;
    dict.set_item("holding", at.holding)?;
    dict.set_item("eigenfrequency", at.eigenfrequency())?;
    dict.set_item("damping_ratio", at.damping_ratio)?;
    dict.set_item("eigenvalues", at.eigenvalues)?;
    dict.set_item("a", at.a)?;
    dict.set_item("b", [0, 1].map(|row| at.b.iter().map(|column| column[row]).collect::<Vec<_>>()))?;
    dict.set_item("c", at.c.clone())?;
    dict.set_item("d", at.d.clone())?;
    Ok(dict)
}
