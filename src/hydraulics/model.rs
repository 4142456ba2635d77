//! The model of a hydraulic actuator: present parameters, inputs and state, and its outputs on demand.
//!
//! In: a definition's text, values set by the host, steps. Out: values by reference, warnings. It must not know FMI's
//! life cycle.
mod derivatives;
mod parameters;
mod step;
mod warnings;

use super::circuit::{DYNAMIC, ENERGY, Equations, Point, SUPPLY};
use super::common::{self, Kind};
use super::definition::{HydraulicActuator, Mode, check_pressure};
use super::error::HydraulicsError;
use super::inputs::{Input, Inputs};
use super::interface::{self, Quantity};
use super::outputs::{Output, Present, stable_step};
use super::state::{Blind, Foreseen, Preview, SAME_STEP, State, dynamic};
use foundation::codec::record::{Damaged, Record};
use foundation::format::{About, DefinitionError, Experiment, Range, Visit};
use foundation::integrator::Statistics;
use foundation::variables::{Reference, Terminal, Variable};
use warnings::Warnings;

/// The kind of a hydraulic actuator alone.
#[derive(Clone, Debug, PartialEq)]
pub struct OneActuator;
/// One hydraulic actuator with its parameters, inputs and state.
pub type Model = common::Model<OneActuator>;
/// All values that decide how a hydraulic actuator continues.
pub type Snapshot = common::Snapshot<OneActuator>;
/// A definition with the values of its parameters, and the laws that follow from them.
pub type Parameters = common::Parameters<OneActuator>;

/// Whether two steps [s] are the same but for rounding.
pub(super) fn is_same_step(one: f64, two: f64) -> bool {
    (one - two).abs() <= SAME_STEP * two
}

/// Results for the present state and inputs.
#[derive(Clone, Debug, Default)]
pub struct Cache {
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

    /// Right-hand-side evaluations and accepted and rejected integration steps since initialisation.
    pub fn statistics(&self) -> Statistics {
        let Some(state) = &self.state else { return Statistics::default() };
        let mut all = state.driven.clone();
        all.count(&state.coupled.with_components());
        all.statistics()
    }
}

impl Kind for OneActuator {
    const NAME: &'static str = "hydraulic actuator";
    const VERSION: u32 = 6;
    const MODES: &'static [&'static str] = &Mode::WORDS;
    type Definition = HydraulicActuator;
    type Laws = Equations;
    type Inputs = Inputs;
    type Output = Output;
    type State = State;
    type Cache = Cache;
    type Warnings = Warnings;

    fn about(actuator: &HydraulicActuator) -> (&str, &About, &str, Experiment) {
        (&actuator.name, &actuator.about, &actuator.description, actuator.experiment)
    }

    fn parameters(actuator: &mut HydraulicActuator, visit: &mut Visit) {
        actuator.parameters(visit);
    }

    fn mode(actuator: &HydraulicActuator) -> usize {
        actuator.coupling.mode as usize
    }

    fn set_mode(actuator: &mut HydraulicActuator, mode: usize) {
        actuator.coupling.mode = Mode::ALL[mode];
    }

    fn laws(actuator: &HydraulicActuator) -> Equations {
        Equations::new(&actuator.circuit)
    }

    fn variables(actuator: &HydraulicActuator) -> (Vec<Variable>, Vec<Quantity>) {
        interface::variables(actuator)
    }

    fn cache(_laws: &Equations) -> Cache {
        Cache::default()
    }

    fn clear(cache: &mut Cache) {
        cache.clear();
    }

    fn check(actuator: &HydraulicActuator) -> Result<(), DefinitionError> {
        actuator.check()
    }

    fn check_ports(model: &Model) -> Result<(), HydraulicsError> {
        for (name, input) in [("supply.pressure", Input::Supply), ("tank.pressure", Input::Tank)] {
            check_pressure(name, model.inputs.get(input), model.parameters.laws.ambient())?;
        }
        Ok(())
    }

    fn start(parameters: &Parameters, inputs: &Inputs) -> State {
        State::at_start(&parameters.laws, &parameters.definition.circuit, inputs.get(Input::Supply))
    }

    fn range(_laws: &Equations, input: usize) -> Option<Range> {
        match Input::ALL[input] {
            Input::Supply | Input::Tank => None,
            Input::Mass | Input::Horizon => Some(Range::NonNegative),
            _ => Some(Range::Finite),
        }
    }

    fn ambient(laws: &Equations) -> f64 {
        laws.ambient()
    }

    fn input_changed(model: &mut Model, input: usize) {
        let input = Input::ALL[input];
        // Before the first step the input is the start of an accumulator.
        let fills = input == Input::Supply && model.parameters.laws.supply_unit().is_some();
        if let Some(state) = model.state.as_mut().filter(|state| fills && state.arrival.is_none()) {
            state.circuit[SUPPLY] = model.inputs.get(input);
        }
        (model.cache.present, model.cache.preview) = (None, None);
        if input.changes_foresight(model.state.as_ref().is_some_and(|state| state.told.is_some())) {
            model.cache.forget_foresight();
        }
    }

    fn output(model: &mut Model, output: Output) -> Result<f64, HydraulicsError> {
        let Model { parameters, inputs, state: Some(state), cache, warnings, .. } = model else {
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

    fn take_warning(model: &mut Model) -> Option<String> {
        if model.warnings.any() { model.warnings.take() } else { None }
    }

    fn horizon(_laws: &Equations) -> usize {
        Input::Horizon as usize
    }

    fn copy_state(state: &mut State, other: &State) {
        state.clone_from(other);
    }

    fn record_state(_laws: &Equations, state: &mut State, record: &mut Record) -> Result<(), Damaged> {
        state.record(record)
    }

    fn record_warnings(warnings: &mut Warnings, record: &mut Record) -> Result<(), Damaged> {
        warnings.record(record)
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
