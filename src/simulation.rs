//! Simulation of a model from Rust: variables by name, steps, and runs that return a trace.
//!
//! In: the text of a definition, names and values, steps. Out: values by name, traces. Must not know: the inside of any
//! kind of model, FMI.
//!
//! ```no_run
//! use linkage_fmu::simulation::Simulation;
//!
//! let mut gear = Simulation::open(&std::fs::read_to_string("mechanism.json")?)?;
//! gear.set("actuator.force", 3e4)?;
//! gear.set("friction.enabled", true)?;
//! gear.initialize()?;
//! let trace = gear.run(0.13, 1e-3, &["crank.angle", "crank.speed"])?;
//! println!("{:?} {:?}", trace.times().last(), trace.column("crank.angle").and_then(|angles| angles.last()));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
mod ensemble;
mod trace;

use crate::mechanism::{Model, ModelError, TravelTime, allow_hydraulics};
use crate::variables::{Causality, Kind, Reference, Variability};
pub use ensemble::{Ensemble, Runs};
use std::fmt;
pub use trace::Trace;

/// Largest number of steps in a run.
const MOST_STEPS: f64 = 1e9;

/// A model with its time, read and set by the names of its variables.
#[derive(Clone, Debug)]
pub struct Simulation {
    model: Model,
    time: f64,
    /// Whether no parameter was set since the last initialisation.
    is_initialized: bool,
}

/// Error of a call. The simulation is unchanged. Exception: a run has stopped after its last complete step, or at the
/// time at which a step reached `solver.max_steps`.
#[derive(Clone, Debug, PartialEq)]
#[expect(missing_docs, reason = "the sentence of a variant names its fields")]
pub enum SimulationError {
    /// No variable has this name. `nearest`: the most similar names, the most similar first.
    Name { name: String, nearest: Vec<String> },
    /// The span or the longest step of a run [s] is not finite or not > 0, or the steps are too many.
    Span { span: f64, step: f64 },
    /// The number of start values is not a multiple of the number of inputs.
    Rows { values: usize, inputs: usize },
    /// The model returned an error.
    Model(ModelError),
    /// The model rejected a value.
    Refused(String),
}

impl fmt::Display for SimulationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Name { name, nearest } => {
                let nearest = nearest.join(", ");
                write!(
                    f,
                    "there is no variable \"{name}\": the most similar names are {nearest}; Simulation::names lists \
                     all names"
                )
            }
            Self::Span { span, step } => {
                write!(
                    f,
                    "a run of {span} s in steps of {step} s: the duration and the step must be finite and > 0, and a \
                     run has at most {MOST_STEPS:e} steps"
                )
            }
            Self::Rows { values, inputs } => {
                write!(f, "{values} start values for {inputs} inputs: give each run one value for each input")
            }
            Self::Model(error) => error.fmt(f),
            Self::Refused(why) => f.write_str(why),
        }
    }
}

impl std::error::Error for SimulationError {}

impl From<ModelError> for SimulationError {
    fn from(error: ModelError) -> Self {
        Self::Model(error)
    }
}

/// A value for [`Simulation::set`]: a number, a truth value or a text.
pub trait Settable {
    /// Sets the variable with this reference.
    ///
    /// # Errors
    /// The variable is of another kind or an output, or the value is out of range.
    fn set(self, model: &mut Model, reference: Reference) -> Result<(), ModelError>;

    /// The number, if the value is a number.
    fn number(&self) -> Option<f64> {
        None
    }
}

impl Settable for f64 {
    fn number(&self) -> Option<f64> {
        Some(*self)
    }

    fn set(self, model: &mut Model, reference: Reference) -> Result<(), ModelError> {
        model.set_real(reference, self)
    }
}

impl Settable for bool {
    fn set(self, model: &mut Model, reference: Reference) -> Result<(), ModelError> {
        model.set_boolean(reference, self)
    }
}

impl Settable for &str {
    fn set(self, model: &mut Model, reference: Reference) -> Result<(), ModelError> {
        model.set_text(reference, self)
    }
}

impl Simulation {
    /// A model from the text of its definition.
    ///
    /// # Errors
    /// The fault of the definition, or the reason why no model exists for it.
    pub fn open(definition: &str) -> Result<Self, SimulationError> {
        Ok(Self::from_model(Model::from_json(definition)?))
    }

    /// [`Self::open`], with the curve and the tables that other models of this text in this process have.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn sharing(definition: &str) -> Result<Self, SimulationError> {
        allow_hydraulics();
        Ok(Self::from_model(Model::shared(definition, None)?))
    }

    /// A simulation of this model, which starts at 0 s.
    pub fn from_model(model: Model) -> Self {
        Self { model, time: 0.0, is_initialized: false }
    }

    /// The model, for functions without a method here.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The model, for calls by reference. Steps made on it do not count in [`Self::time`].
    pub fn model_mut(&mut self) -> &mut Model {
        &mut self.model
    }

    /// Time since the start [s].
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Names of all variables, in the order of their references.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.model.variables().list().iter().map(|variable| variable.name.as_str())
    }

    /// Reference of the variable with this name, for calls to the model.
    ///
    /// # Errors
    /// No variable has this name.
    pub fn reference(&self, name: &str) -> Result<Reference, SimulationError> {
        self.model.variables().find(name).ok_or_else(|| {
            let nearest = self.model.variables().nearest(name).into_iter().map(str::to_owned).collect();
            SimulationError::Name { name: name.into(), nearest }
        })
    }

    /// Present value of a Real. NaN for an output that does not exist in the present state; [`Self::undefined`] returns
    /// the reason.
    ///
    /// # Errors
    /// No Real has this name, or the present parameters allow no start.
    pub fn get(&mut self, name: &str) -> Result<f64, SimulationError> {
        let reference = self.reference(name)?;
        Ok(self.model.real(reference)?)
    }

    /// Reason why a Real output has no value in the present state. None if it has one.
    ///
    /// # Errors
    /// No variable has this name.
    pub fn undefined(&mut self, name: &str) -> Result<Option<String>, SimulationError> {
        let reference = self.reference(name)?;
        Ok(self.model.undefined(reference))
    }

    /// Present value of a Boolean.
    ///
    /// # Errors
    /// No Boolean has this name, or the present parameters allow no start.
    pub fn boolean(&mut self, name: &str) -> Result<bool, SimulationError> {
        let reference = self.reference(name)?;
        Ok(self.model.boolean(reference)?)
    }

    /// Name of the present item of an Enumeration.
    ///
    /// # Errors
    /// No Enumeration has this name, or the present parameters allow no start.
    pub fn text(&mut self, name: &str) -> Result<&'static str, SimulationError> {
        let reference = self.reference(name)?;
        let item = self.model.item(reference)?;
        Ok(self.model.variables().get(reference).map_or("", |variable| variable.details.items[item]))
    }

    /// The time of the first impact on the stop with this flag, as a function of inputs that are sizes of loads. For
    /// many runs from the present start: see [`Model::travel_time`].
    ///
    /// # Errors
    /// No variable has one of these names.
    pub fn travel_time(
        &self,
        flag: &str,
        inputs: &[&str],
        samples: &[f64],
    ) -> Result<Option<TravelTime>, SimulationError> {
        let references = inputs.iter().map(|name| self.reference(name)).collect::<Result<Vec<_>, _>>()?;
        Ok(self.model.travel_time(self.reference(flag)?, &references, samples))
    }

    /// Sets an input or a parameter. During a run, a new value of a tunable parameter takes effect at once. Any other
    /// parameter ends the run: outputs then have their values at the start, and the next step needs
    /// [`Self::initialize`].
    ///
    /// # Errors
    /// No variable has this name, it is of another kind or an output, or the value is out of range.
    pub fn set(&mut self, name: &str, value: impl Settable) -> Result<(), SimulationError> {
        let reference = self.reference(name)?;
        let variable = self.model.variables().get(reference);
        if let (true, Some(number), Some(Variability::Tunable)) =
            (self.is_initialized, value.number(), variable.map(|variable| variable.variability))
        {
            self.model.check_real(reference, number)?;
            self.model.check_together(&[reference], &[number])?;
            return Ok(self.model.tune(&[reference], &[number])?);
        }
        value.set(&mut self.model, reference)?;
        let variable = self.model.variables().get(reference);
        self.is_initialized &= variable.is_none_or(|variable| variable.causality != Causality::Parameter);
        Ok(())
    }

    /// Sets a time derivative of a Real input, for the next step only: order 1 [unit/s] or 2 [unit/s2].
    ///
    /// # Errors
    /// No continuous input has this name, the order is not 1 or 2, or the value is not finite.
    pub fn set_derivative(&mut self, name: &str, order: i32, value: f64) -> Result<(), SimulationError> {
        let reference = self.reference(name)?;
        Ok(self.model.set_input_derivative(reference, order, value)?)
    }

    /// Time derivative of a Real output [unit/s]. NaN if it does not exist in the present state.
    ///
    /// # Errors
    /// No continuous output has this name.
    pub fn derivative(&mut self, name: &str) -> Result<f64, SimulationError> {
        let reference = self.reference(name)?;
        Ok(self.model.output_derivative(reference, 1)?)
    }

    /// Computes the start of the model for the present parameters and inputs, at time 0 s.
    ///
    /// # Errors
    /// The present parameters allow no model, or the start position cannot be reached.
    pub fn initialize(&mut self) -> Result<(), SimulationError> {
        self.model.initialize()?;
        (self.time, self.is_initialized) = (0.0, true);
        Ok(())
    }

    /// Advances by `h` [s] > 0 with the present inputs.
    ///
    /// # Errors
    /// The model is not initialised, `h` is out of range, or the model cannot continue. The state is then unchanged.
    /// [`ModelError::Interrupted`]: the step reached `solver.max_steps`. The next step continues from the reached state
    /// and [`Self::time`].
    pub fn step(&mut self, h: f64) -> Result<(), SimulationError> {
        if !self.is_initialized {
            return Err(ModelError::NotInitialised.into());
        }
        match self.model.step(h) {
            Ok(()) => self.time += h,
            Err(error) => {
                if let ModelError::Interrupted { time, .. } = error {
                    self.time += time;
                }
                return Err(error.into());
            }
        }
        Ok(())
    }

    /// Advances by `span` [s] in equal steps of at most `step` [s]. Records the named variables at the start and after
    /// every step. A Boolean is 1 for true, an Enumeration the number of its item. A Real is NaN if it does not exist.
    ///
    /// # Errors
    /// As [`Self::step`] and [`Self::get`]; a span or a step that is not finite or not > 0, or more than 1e9 steps.
    pub fn run(&mut self, span: f64, step: f64, names: &[&str]) -> Result<Trace, SimulationError> {
        if ![span, step].iter().all(|x| x.is_finite() && *x > 0.0) || span / step > MOST_STEPS {
            return Err(SimulationError::Span { span, step });
        }
        let references = names.iter().map(|name| self.reference(name)).collect::<Result<Vec<_>, _>>()?;
        let names = names.iter().map(|name| (*name).to_owned()).collect();
        // If `span` is a multiple of `step` except for rounding errors, no additional step is made.
        let count = ((span / step) * (1.0 - 1e-12)).ceil().max(1.0);
        let (start, h) = (self.time, span / count);
        let mut trace = Trace { names, times: Vec::new(), columns: vec![Vec::new(); references.len()] };
        self.record(&references, &mut trace)?;
        for k in 1..=count as u64 {
            self.step(h)?;
            self.time = start + span * (k as f64 / count);
            self.record(&references, &mut trace)?;
        }
        Ok(trace)
    }

    fn record(&mut self, references: &[Reference], trace: &mut Trace) -> Result<(), SimulationError> {
        trace.times.push(self.time);
        for (&reference, column) in references.iter().zip(&mut trace.columns) {
            column.push(match self.model.variables().get(reference).map(|variable| variable.kind) {
                Some(Kind::Boolean) => f64::from(u8::from(self.model.boolean(reference)?)),
                Some(Kind::Enumeration) => (self.model.item(reference)? + 1) as f64,
                _ => self.model.real(reference)?,
            });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::GEAR;

    fn gear() -> Simulation {
        Simulation::open(GEAR).unwrap()
    }

    #[test]
    fn every_kind_is_set_and_read_by_name() {
        let mut gear = gear();
        gear.set("actuator.force", 31e3).unwrap();
        gear.set("uplock.engage", true).unwrap();
        gear.set("solver.method", "rigid_fem").unwrap();
        assert_eq!(gear.get("actuator.force"), Ok(31e3));
        assert_eq!(gear.boolean("uplock.engage"), Ok(true));
        assert_eq!(gear.text("solver.method"), Ok("rigid_fem"));
        let error = gear.set("crank.angle", 1.0).unwrap_err();
        assert!(matches!(error, SimulationError::Model(ModelError::Output { .. })), "{error}");
    }

    #[test]
    fn an_unknown_name_suggests_the_nearest() {
        let error = gear().get("crank.angel").unwrap_err().to_string();
        assert!(error.contains("\"crank.angel\": the most similar names are crank.angle, "), "{error}");
        for (key, variable) in [("start.angle", "crank.start_angle"), ("bodies.leg.mass", "leg.mass")] {
            let error = gear().get(key).unwrap_err().to_string();
            assert!(error.contains(&format!("the most similar names are {variable}, ")), "{error}");
        }
    }

    #[test]
    fn a_run_is_its_steps() {
        let (mut whole, mut steps) = (gear(), gear());
        whole.initialize().unwrap();
        let trace = whole.run(0.1, 0.02, &["crank.angle", "extended"]).unwrap();
        assert_eq!(trace.names(), ["crank.angle", "extended"]);
        assert!(trace.times().iter().zip(0..).all(|(t, k)| (t - 0.02 * f64::from(k)).abs() < 1e-16));
        assert_eq!(trace.column("extended"), Some(&[1.0, 0.0, 0.0, 0.0, 0.0, 0.0][..]));
        assert_eq!(trace.column("crank.speed"), None);
        steps.initialize().unwrap();
        for angle in &trace.column("crank.angle").unwrap()[1..] {
            steps.step(0.02).unwrap();
            assert_eq!(steps.get("crank.angle"), Ok(*angle));
        }
        assert_eq!((whole.time(), steps.model().statistics()), (0.1, whole.model().statistics()));
        // A second run continues from the end of the first, in steps of at most the given size.
        let trace = whole.run(0.01, 0.004, &[]).unwrap();
        assert_eq!((trace.times().len(), trace.times()[3]), (4, 0.11));
    }

    #[test]
    fn derivatives_are_set_and_read_by_name() {
        let mut gear = gear();
        gear.initialize().unwrap();
        gear.set_derivative("actuator.force", 1, 1e6).unwrap();
        gear.step(1e-3).unwrap();
        assert_eq!(gear.get("actuator.force"), Ok(31e3));
        let (rate, speed) = (gear.derivative("crank.angle").unwrap(), gear.get("crank.speed").unwrap());
        assert!((rate - speed).abs() <= 1e-12 * speed.abs(), "{rate} {speed}");
    }

    #[test]
    fn a_parameter_ends_the_run_until_it_is_initialised() {
        let mut gear = Simulation::open(GEAR).unwrap();
        let refused = SimulationError::Model(ModelError::NotInitialised);
        assert_eq!(gear.step(1e-3), Err(refused.clone()));
        gear.initialize().unwrap();
        gear.step(1e-3).unwrap();
        gear.set("actuator.force", 2e4).unwrap();
        gear.step(1e-3).unwrap();
        gear.set("crank.mass", 20.0).unwrap();
        assert!((gear.get("crank.angle").unwrap() - 0.8).abs() < 1e-15);
        assert_eq!(gear.step(1e-3), Err(refused));
        gear.initialize().unwrap();
        assert_eq!((gear.time(), gear.step(1e-3)), (0.0, Ok(())));
        assert!(gear.run(1.0, 1e-300, &[]).is_err());
    }

    #[test]
    fn invalid_runs_are_rejected() {
        let mut gear = gear();
        gear.initialize().unwrap();
        for (span, step) in [(0.0, 1e-3), (0.1, f64::NAN), (f64::INFINITY, 1e-3), (0.1, -1.0)] {
            assert!(matches!(gear.run(span, step, &[]), Err(SimulationError::Span { .. })));
        }
        let error = gear.run(0.1, 0.1, &["solver.metod"]).unwrap_err().to_string();
        assert!(error.contains("solver.metod"), "{error}");
        assert_eq!(gear.time(), 0.0);
    }
}
