//! The model of a hydraulic actuator: present parameters, inputs and state, and its outputs on demand.
//!
//! In: a definition's text, values set by the host, steps. Out: values by reference, warnings. It must not know FMI's
//! life cycle.
mod derivatives;
mod parameters;
mod step;
mod warnings;

use super::circuit::{DYNAMIC, ENERGY, Point, SUPPLY};
use super::definition::{ABOVE_VACUUM, HydraulicActuator, Mode, is_pressure};
use super::error::HydraulicsError;
use super::inputs::{INPUTS, Input, Inputs};
use super::interface::{self, Quantity};
use super::outputs::{Output, Present, stable_step};
use super::state::{Blind, Foreseen, Preview, SAME_STEP, State, dynamic};
use crate::format::{About, DefinitionError, Experiment, Range};
use crate::integrator::Statistics;
use crate::variables::{Reference, Terminal, Variables};
pub use derivatives::{INPUT_ORDER, OUTPUT_ORDER};
pub(super) use parameters::{Original, Parameters};
use std::sync::Arc;
pub(super) use warnings::Warnings;

/// One hydraulic actuator with its parameters, inputs and state.
#[derive(Clone, Debug)]
pub struct Model {
    /// As read; [`Self::reset`] returns to it.
    pub(super) original: Arc<Original>,
    /// The present parameters; shared with the snapshots that were taken under them.
    pub(super) parameters: Arc<Parameters>,
    pub(super) inputs: Inputs,
    pub(super) state: Option<State>,
    /// What the present state and inputs give, while they are the present ones.
    pub(super) cache: Cache,
    pub(super) warnings: Warnings,
}

/// Whether two steps [s] are the same but for rounding.
pub(super) fn is_same_step(one: f64, two: f64) -> bool {
    (one - two).abs() <= SAME_STEP * two
}

/// Results for the present state and inputs.
#[derive(Clone, Debug, Default)]
pub(super) struct Cache {
    present: Option<Present<f64>>,
    /// Over a step of this size [s].
    foreseen: Option<(f64, Result<Foreseen, Blind>)>,
    /// What it tells.
    preview: Option<Preview<f64>>,
    /// Whether the host has read the foreseen motion since the last step.
    read: bool,
    /// The event to which the last step has led, and its time in the step [s].
    event: Option<(f64, usize)>,
}

impl Cache {
    /// The state, the parameters or all inputs have changed.
    pub fn clear(&mut self) {
        self.forget_foresight();
        (self.present, self.read) = (None, false);
    }

    /// The motion over the next step is another one.
    pub fn forget_foresight(&mut self) {
        (self.foreseen, self.preview) = (None, None);
    }

    /// The motion foreseen over a step of size h [s] from the present state and inputs.
    pub fn foresee(
        &mut self,
        parameters: &Parameters,
        inputs: &Inputs,
        state: &State,
        h: f64,
    ) -> &Result<Foreseen, Blind> {
        // A failure too belongs to its step.
        if self.foreseen.as_ref().is_some_and(|(of, _)| !is_same_step(*of, h)) {
            self.forget_foresight();
        }
        let see = || (h, state.foresee(&parameters.setting(inputs), h).map_err(|(blind, _)| blind));
        &self.foreseen.get_or_insert_with(see).1
    }
}

impl Model {
    /// Model of the definition in a JSON text.
    ///
    /// # Errors
    /// What is wrong with the definition.
    pub fn from_json(text: &str) -> Result<Self, HydraulicsError> {
        Self::new(HydraulicActuator::from_json(text)?)
    }

    /// Model of a checked definition.
    ///
    /// # Errors
    /// Two variables of one name.
    pub fn new(actuator: HydraulicActuator) -> Result<Self, HydraulicsError> {
        let (list, quantities) = interface::variables(&actuator);
        let variables = Variables::new(&actuator.name, list, quantities)
            .map_err(|twice| DefinitionError::key(twice.0, "two variables have this name"))?;
        let mut ranges = Vec::new();
        actuator.clone().parameters(&mut |parameter, _| ranges.push((parameter.range, parameter.role)));
        let inputs = Inputs::new(interface::starts(&actuator));
        let parameters = Arc::new(Parameters::new(actuator));
        let original = Arc::new(Original { parameters: Arc::clone(&parameters), variables, ranges, inputs });
        let (cache, warnings) = (Cache::default(), Warnings::default());
        Ok(Self { original, parameters, inputs, state: None, cache, warnings })
    }

    /// Name of the actuator, the FMU's modelName and modelIdentifier.
    pub fn name(&self) -> &str {
        &self.original.parameters.actuator.name
    }

    /// Author, copyright and licence.
    pub fn about(&self) -> &About {
        &self.original.parameters.actuator.about
    }

    /// One-line description of the actuator.
    pub fn description(&self) -> &str {
        &self.original.parameters.actuator.description
    }

    /// Default experiment.
    pub fn experiment(&self) -> Experiment {
        self.original.parameters.actuator.experiment
    }

    /// The variables that the host sees.
    pub fn variables(&self) -> &Variables<Quantity> {
        &self.original.variables
    }

    /// The variables of the connection with what the actuator moves.
    pub fn terminals(&self) -> Vec<Terminal> {
        interface::terminals(self.variables())
    }

    /// For each variable, if it is an output: the inputs and parameters on which its initial value depends, ascending.
    ///
    /// # Errors
    /// None.
    pub fn initial_dependencies(&self) -> Result<Option<Vec<Vec<Reference>>>, HydraulicsError> {
        Ok(Some(interface::initial_dependencies(self.variables())))
    }

    /// Present value of a Real. Computed when first read in a state. NaN for an output beyond the range of numbers.
    ///
    /// # Errors
    /// No Real has this reference, or the present parameters give no circuit.
    #[inline]
    pub fn real(&mut self, reference: Reference) -> Result<f64, HydraulicsError> {
        match self.original.variables.quantity(reference) {
            Some(Quantity::Parameter(index)) => Ok(self.parameters.values[index]),
            Some(Quantity::Input(index)) => Ok(self.inputs.values[index]),
            Some(Quantity::Output(output)) => {
                let value = self.output(output)?;
                Ok(if value.is_finite() { value } else { f64::NAN })
            }
            _ => Err(self.no_such(reference, "Real")),
        }
    }

    fn output(&mut self, output: Output) -> Result<f64, HydraulicsError> {
        self.started()?;
        let Self { parameters, inputs, state: Some(state), cache, warnings, .. } = self else {
            return Err(HydraulicsError::NotInitialised);
        };
        if let (true, Some(told)) = (output.is_foreseen(), &state.told) {
            return Ok(output.foreseen(&told.preview).unwrap_or(f64::NAN));
        }
        if output.is_foreseen() {
            if cache.preview.is_none() {
                let h = parameters.horizon(inputs, state);
                cache.read = true;
                let foreseen = cache.foresee(parameters, inputs, state, h);
                if let Err(blind) = foreseen {
                    warnings::blind(warnings, *blind, inputs, h);
                }
                cache.preview = Some(preview(parameters, inputs, state, foreseen.as_ref().ok(), h));
            }
            return Ok(cache.preview.and_then(|preview| output.foreseen(&preview)).unwrap_or(f64::NAN));
        }
        if output == Output::StableStep {
            return Ok(stable_step(
                &parameters.laws,
                &point(parameters, dynamic(&state.circuit), inputs),
                inputs.get(Input::Mass),
            ));
        }
        let present = cache.present.get_or_insert_with(|| {
            let energies = std::array::from_fn(|index| state.circuit[ENERGY + index]);
            let (setting, load) = (parameters.setting(inputs), inputs.get(Input::Load));
            let end_force = |force| state.end_force(&setting, load, force);
            Present::new(&parameters.laws, point(parameters, dynamic(&state.circuit), inputs), energies, end_force)
        });
        Ok(present.output(&parameters.laws, output).unwrap_or(f64::NAN))
    }

    /// Whether [`Self::set_real`] would accept this value; changes nothing.
    ///
    /// # Errors
    /// No Real has this reference, it is an output, or the value is out of range.
    pub fn check_real(&self, reference: Reference, value: f64) -> Result<(), HydraulicsError> {
        let refuse = |allowed: String| Err(HydraulicsError::Value { name: self.name_of(reference), value, allowed });
        let range = match self.original.variables.quantity(reference) {
            Some(Quantity::Parameter(index)) => self.original.ranges[index].0,
            Some(Quantity::Input(index)) => match Input::ALL[index] {
                Input::Supply | Input::Tank => {
                    let ambient = self.parameters.laws.ambient();
                    let allowed = || format!("{ABOVE_VACUUM}; fluid.ambient_pressure is {ambient} Pa");
                    return if is_pressure(value, ambient) { Ok(()) } else { refuse(allowed()) };
                }
                Input::Mass | Input::Horizon => Range::NonNegative,
                _ => Range::Finite,
            },
            Some(Quantity::Output(_)) => return Err(HydraulicsError::Output { name: self.name_of(reference) }),
            _ => return Err(self.no_such(reference, "Real")),
        };
        if range.contains(value) { Ok(()) } else { refuse(range.text()) }
    }

    /// Set an input or a parameter. After a step, a parameter takes effect with the next initialisation only.
    ///
    /// # Errors
    /// As [`Self::check_real`].
    pub fn set_real(&mut self, reference: Reference, value: f64) -> Result<(), HydraulicsError> {
        self.check_real(reference, value)?;
        match self.original.variables.quantity(reference) {
            Some(Quantity::Input(index)) => {
                let same = self.inputs.values[index].to_bits() == value.to_bits();
                self.inputs.set(index, value);
                if !same {
                    // Before the first step the input is the start of an accumulator.
                    let fills = Input::ALL[index] == Input::Supply && self.parameters.laws.supply_unit().is_some();
                    if let Some(state) = self.state.as_mut().filter(|state| fills && state.arrival.is_none()) {
                        state.circuit[SUPPLY] = value;
                    }
                    (self.cache.present, self.cache.preview) = (None, None);
                    let told = self.state.as_ref().is_some_and(|state| state.told.is_some());
                    if Input::ALL[index].changes_foresight(told) {
                        self.cache.forget_foresight();
                    }
                }
            }
            Some(Quantity::Parameter(index)) if self.parameters.values[index].to_bits() != value.to_bits() => {
                let parameters = Arc::make_mut(&mut self.parameters);
                parameters.values[index] = value;
                parameters.update();
                self.state = None;
                self.cache.clear();
            }
            _ => {}
        }
        Ok(())
    }

    /// Present value of a Boolean.
    ///
    /// # Errors
    /// There is none.
    pub fn boolean(&mut self, reference: Reference) -> Result<bool, HydraulicsError> {
        Err(self.no_such(reference, "Boolean"))
    }

    /// Whether several Reals may be set together: always, if each may be set.
    ///
    /// # Errors
    /// None.
    pub fn check_together(&self, _references: &[Reference], _values: &[f64]) -> Result<(), HydraulicsError> {
        Ok(())
    }

    /// [`Self::set_real`] of one of several values.
    ///
    /// # Errors
    /// As [`Self::set_real`].
    pub fn take_real(&mut self, reference: Reference, value: f64) -> Result<(), HydraulicsError> {
        self.set_real(reference, value)
    }

    /// Whether [`Self::set_boolean`] would accept this value.
    ///
    /// # Errors
    /// There is no Boolean.
    pub fn check_boolean(&self, reference: Reference, _value: bool) -> Result<(), HydraulicsError> {
        Err(self.no_such(reference, "Boolean"))
    }

    /// Set a Boolean.
    ///
    /// # Errors
    /// There is none.
    pub fn set_boolean(&mut self, reference: Reference, value: bool) -> Result<(), HydraulicsError> {
        self.check_boolean(reference, value)
    }

    /// Present item of an Enumeration, by its index from 0 on.
    ///
    /// # Errors
    /// No Enumeration has this reference.
    pub fn item(&mut self, reference: Reference) -> Result<usize, HydraulicsError> {
        match self.original.variables.quantity(reference) {
            Some(Quantity::Mode) => Ok(self.parameters.actuator.coupling.mode as usize),
            _ => Err(self.no_such(reference, "Enumeration")),
        }
    }

    /// Give tunable parameters these values, which [`Self::check_real`] accepts, and leave the motion as it is. Only
    /// numbers of the integration are tunable.
    ///
    /// # Errors
    /// None.
    pub fn tune(&mut self, references: &[Reference], values: &[f64]) -> Result<(), HydraulicsError> {
        for (&reference, &value) in references.iter().zip(values) {
            if let Some(Quantity::Parameter(index)) = self.original.variables.quantity(reference)
                && self.parameters.values[index].to_bits() != value.to_bits()
            {
                let parameters = Arc::make_mut(&mut self.parameters);
                parameters.values[index] = value;
                parameters.update();
                self.cache.clear();
            }
        }
        Ok(())
    }

    /// Whether [`Self::set_text`] would accept this value; changes nothing.
    ///
    /// # Errors
    /// No Enumeration has this reference, or the text is none of its words.
    pub fn check_text(&self, reference: Reference, value: &str) -> Result<(), HydraulicsError> {
        self.mode_of(reference, value).map(|_| ())
    }

    /// Set an Enumeration by the name of an item. After a step, it takes effect with the next initialisation only.
    ///
    /// # Errors
    /// As [`Self::check_text`].
    pub fn set_text(&mut self, reference: Reference, value: &str) -> Result<(), HydraulicsError> {
        let mode = self.mode_of(reference, value)?;
        if self.parameters.actuator.coupling.mode != mode {
            Arc::make_mut(&mut self.parameters).actuator.coupling.mode = mode;
            self.state = None;
            self.cache.clear();
        }
        Ok(())
    }

    fn mode_of(&self, reference: Reference, value: &str) -> Result<Mode, HydraulicsError> {
        match self.original.variables.quantity(reference) {
            Some(Quantity::Mode) => Mode::of_word(value).ok_or_else(|| {
                let words = Mode::ALL.map(|mode| format!("\"{}\"", mode.word()));
                let name = self.name_of(reference);
                HydraulicsError::Text { name, value: value.into(), allowed: words.join(" or ") }
            }),
            _ => Err(self.no_such(reference, "Enumeration")),
        }
    }

    /// Override the relative tolerance of the integration; the same as setting solver.tolerance.
    ///
    /// # Errors
    /// The tolerance is out of range.
    pub fn set_tolerance(&mut self, tolerance: f64) -> Result<(), HydraulicsError> {
        match self.original.variables.find("solver.tolerance") {
            Some(reference) => self.set_real(reference, tolerance),
            None => Ok(()),
        }
    }

    /// A warning that came up since the last call; None if there is none.
    #[inline]
    pub fn take_warning(&mut self) -> Option<String> {
        if self.warnings.any() { self.warnings.take() } else { None }
    }

    /// Back to what [`Self::from_json`] gave.
    pub fn reset(&mut self) {
        self.parameters = Arc::clone(&self.original.parameters);
        self.inputs = self.original.inputs;
        self.state = None;
        self.cache.clear();
        self.warnings = Warnings::default();
    }

    /// Right-hand-side evaluations and accepted and rejected integration steps since initialisation.
    pub fn statistics(&self) -> Statistics {
        let Some(state) = &self.state else { return Statistics::default() };
        let mut all = state.driven.clone();
        all.count(&state.coupled.with_components());
        all.statistics()
    }

    /// Why an output has no value in the present state; None if it has one.
    #[cold]
    pub fn undefined(&mut self, reference: Reference) -> Option<String> {
        let Some(Quantity::Output(output)) = self.original.variables.quantity(reference) else { return None };
        let value = self.output(output).ok()?;
        let text = "the value exceeds the largest number, 1.8e308; check the values of inputs and parameters";
        (!value.is_finite()).then(|| text.to_owned())
    }

    /// Name of a variable; empty if there is none.
    pub(super) fn name_of(&self, reference: Reference) -> String {
        self.original.variables.get(reference).map_or_else(String::new, |v| v.name.clone())
    }

    fn no_such(&self, reference: Reference, kind: &'static str) -> HydraulicsError {
        let list = self.original.variables.list();
        let own = list.get(reference as usize).map(|variable| (variable.name.clone(), variable.kind.word()));
        HydraulicsError::Reference { reference, own, kind, count: list.len() }
    }
}

/// The point of the laws at the present inputs, and at these components of the state.
pub(super) fn point(parameters: &Parameters, state: [f64; DYNAMIC], inputs: &Inputs) -> Point<f64> {
    let motion = [Input::Length, Input::Speed].map(|input| inputs.get(input));
    // The command acts on the acceleration of the spool alone, which is no output.
    parameters.laws.point(state, motion, [inputs.get(Input::Supply), inputs.get(Input::Tank), 0.0])
}

/// What the foreseen motion tells.
fn preview(
    parameters: &Parameters,
    inputs: &Inputs,
    state: &State,
    foreseen: Option<&Foreseen>,
    h: f64,
) -> Preview<f64> {
    let (laws, speed) = (&parameters.laws, inputs.get(Input::Speed));
    match foreseen {
        Some(seen @ Foreseen { element, start, end, start_force, course, h, .. }) if seen.is_whole() => {
            Preview::new(laws, element, (*start_force, *start), (end, *course), *h)
        }
        _ => {
            let force = laws.force(state.pressures(), speed);
            let [length, acceleration] = [Input::Length, Input::Acceleration].map(|input| inputs.get(input));
            let start = state.start_acceleration(&parameters.setting(inputs), |input| inputs.get(input), force);
            Preview::blind(force, [length, speed, acceleration], start.unwrap_or(acceleration), h)
        }
    }
}

/// Number of inputs, whose references are their indices.
pub(super) const INPUT_COUNT: usize = INPUTS;
