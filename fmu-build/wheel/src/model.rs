//! A mechanism or a hydraulic model: its variables, its runs, and its functions without time.
//!
//! In: the text of a definition, names, times, signals. Out: rows as bytes in the layout for numpy, texts.

use crate::arguments::{self, names, number, optional, truth, whole};
use crate::errors::{InputError, detached, guarded, input, refused};
use crate::rows::{MOST_BYTES, Made, Plan, fits, made, packed};
use crate::simulation::Simulation;
use crate::travel::{along, dictionary};
use fmu_build::documentation::Picture;
use fmu_build::drawing::{Colours, to_svg};
use fmu_build::run::Span;
use fmu_build::run::signals::Signals;
use fmu_build::start_values;
use fmu_build::view::{Data, Wanted};
use fmu_build::{check, view};
use linkage_fmu::component::Component;
use linkage_fmu::variables::{Reference, Unit, Value};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::{PyByteArray, PyDict};
use std::sync::{Mutex, PoisonError};

/// Largest number of parts of a travel.
const MOST_PARTS: i64 = 1_000_000;
/// Largest number of positions of a travel at which a mechanism is linearised: each position needs some kB in Python.
const MOST_LINEARISED: i64 = 100_000;

/// Signals from Python: times, and for each input its name and values.
type Columns = (Vec<f64>, Vec<(String, Vec<f64>)>);

/// Coordinate, inputs, outputs and holding drive of a linearisation. None and empty lists stand for the defaults.
type Asked<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>);

/// A model from its definition.
#[pyclass(frozen, module = "linkage_fmu._engine")]
pub struct Model {
    /// Name of the definition file of its kind.
    kind: &'static str,
    text: String,
    /// The model of the definition. It is never changed.
    fresh: Mutex<Component>,
    /// A model of a previous run after a reset, whose memory the next run uses.
    used: Mutex<Option<Component>>,
}

impl Model {
    /// A separate model for a call.
    fn component(&self) -> Component {
        self.fresh.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// The model with these start values.
    pub fn started(&self, start_values: Option<&Bound<'_, PyAny>>) -> PyResult<Component> {
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

    /// Variables that a run records: these variables, or all outputs.
    #[pyo3(signature = (output = None))]
    fn plan(&self, output: Option<&Bound<'_, PyAny>>) -> PyResult<Plan> {
        let names = output.map_or(Ok(Vec::new()), |output| names("output", output))?;
        let model = self.component();
        Plan::of(&model, &names)
    }

    /// A run. Returns its rows as bytes, its warnings, the error that ended it, and the time reached [s].
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
        with_slopes: &Bound<'py, PyAny>,
    ) -> Made<Bound<'py, PyByteArray>> {
        let with_slopes = truth("set_input_derivatives", with_slopes)?;
        let (start, stop) = (number("start_time", start)?, optional("stop_time", stop)?);
        let (interval, tolerance) =
            (optional("output_interval", interval)?, optional("relative_tolerance", tolerance)?);
        let used = self.used.lock().unwrap_or_else(PoisonError::into_inner).take();
        let mut model = Self::with(used.unwrap_or_else(|| self.component()), start_values)?;
        let (rows, warnings, error, time) = detached(py, || {
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
        })?;
        Ok((plan.packed(py, &rows)?, warnings, error, time))
    }

    /// Values of the named variables along the travel in `count` equal parts, and their first and second rates with
    /// respect to the parameter of the travel. Row by row: parameter, values, rates, second rates.
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
        let values = detached(py, || along(&mut model, count, &outputs))?;
        packed(py, &values)
    }

    /// Linearise at the start or, with `count`, along the travel. Returns the names of coordinate, inputs and outputs,
    /// and the dictionaries of the positions.
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
        let (names, all) = detached(py, || {
            let what = fmu_studies::linearise::what(&model, &arguments).map_err(input)?;
            let name = |own: &Reference| model.interface().list()[*own as usize].name.clone();
            let named = |all: &[Reference]| all.iter().map(name).collect::<Vec<_>>();
            let names = (name(&what.coordinate), named(&what.inputs), named(&what.outputs));
            let all = match count {
                Some(count) => model.linearise(&what, count as usize),
                None => model.linearise_here(&what).map(|one| vec![one]),
            };
            Ok((names, all.map_err(refused)?))
        })?;
        let (coordinate, inputs, outputs) = names;
        Ok((coordinate, inputs, outputs, all.iter().map(|at| dictionary(py, at)).collect::<PyResult<_>>()?))
    }

    /// A simulation with these start values, not initialised.
    #[pyo3(signature = (start_values))]
    fn simulation(&self, start_values: Option<&Bound<'_, PyAny>>) -> PyResult<Simulation> {
        guarded(|| Ok(Simulation::new(self.started(start_values)?)))
    }

    /// The drawing of the model at its start, as SVG.
    fn picture(&self) -> PyResult<String> {
        guarded(|| {
            let model = self.component();
            let [_, narrow] = Picture::new(&model, &self.text).map_err(refused)?.of_the_page();
            to_svg(&narrow, Colours::Own, model.name()).map_err(refused)
        })
    }

    /// The page with the moving mechanism. Messages use its name.
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
        detached(py, || {
            let checked = check::check(shown, self.kind, self.text.clone()).map_err(input)?;
            let data = Data::collect(&checked, &wanted).map_err(input)?;
            view::html(&data).map_err(refused)
        })
    }
}

/// A word of the engine in the form of modelDescription.xml.
fn in_lower_case(word: &str) -> String {
    word.chars().take(1).flat_map(char::to_lowercase).chain(word.chars().skip(1)).collect()
}

/// A text, or None.
fn optional_text(argument: &str, given: Bound<'_, PyAny>) -> PyResult<Option<String>> {
    if given.is_none() { Ok(None) } else { arguments::text(argument, &given).map(Some) }
}
