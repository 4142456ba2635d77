//! The model of a network: present parameters, inputs and state, and its outputs on demand.
//!
//! In: a definition's text, values set by the host, steps. Out: values by reference, warnings. It must not know FMI's
//! life cycle.
mod cache;
mod derivatives;
mod step;
mod warnings;

use super::definition::{HydraulicSystem, MOST_CYLINDERS, Mode};
use super::inputs::{Inputs, range};
use super::interface::{self, Quantity};
use super::laws::{Drive, Laws};
use super::layout::{Input, Layout, Part};
use super::outputs::{Ahead, Output, Present, ahead, blind};
use super::state::{Setting, State};
use super::system::Motion;
use crate::common::{self, Kind};
use crate::definition::check_pressure;
use crate::error::HydraulicsError;
use cache::Cache;
use foundation::codec::record::{Damaged, Record};
use foundation::format::{About, DefinitionError, Experiment, Range, Visit};
use foundation::inspection::Finding;
use foundation::integrator::Statistics;
use foundation::variables::{Reference, Terminal, Variable};
use warnings::Warnings;

/// The kind of a hydraulic system.
#[derive(Clone, Debug, PartialEq)]
pub struct Network;
/// One hydraulic system with its parameters, inputs and state.
pub type Model = common::Model<Network>;
/// A definition with the values of its parameters, and the laws that follow from them.
pub type Parameters = common::Parameters<Network>;

impl Parameters {
    pub fn setting<'a>(&'a self, inputs: &'a Inputs) -> Setting<'a> {
        let HydraulicSystem { solver, cylinders, .. } = &self.definition;
        Setting { laws: &self.laws, solver, inputs, cylinders }
    }
}

impl Model {
    /// Model of the definition in a JSON text.
    ///
    /// # Errors
    /// What is wrong with the definition.
    pub fn from_json(text: &str) -> Result<Self, HydraulicsError> {
        Self::new(HydraulicSystem::from_json(text)?)
    }

    /// What the definition gives reason to warn of, for logs.
    pub fn warnings(&self) -> Vec<Finding> {
        self.original.parameters.definition.warnings()
    }

    /// The variables of the connections with what the cylinders move.
    pub fn terminals(&self) -> Vec<Terminal> {
        interface::terminals(&self.original.parameters.definition, self.variables())
    }

    /// On what initial values depend: unknown, so that a host takes them to depend on everything.
    ///
    /// # Errors
    /// None.
    pub fn initial_dependencies(&self) -> Result<Option<Vec<Vec<Reference>>>, HydraulicsError> {
        Ok(None)
    }

    /// The next step of the host [s]: as it says, else as the last one, at first that of the default experiment.
    fn next_step(&self) -> f64 {
        let said = self.inputs.values[self.parameters.laws.layout.horizon()];
        let last = self.state.as_ref().map_or(0.0, |state| state.last_step);
        let first = self.original.parameters.definition.experiment.step_size;
        if said > 0.0 {
            said
        } else if last > 0.0 {
            last
        } else {
            first
        }
    }

    /// Right-hand-side evaluations and accepted and rejected integration steps since initialisation.
    pub fn statistics(&self) -> Statistics {
        self.state.as_ref().map_or(Statistics::default(), State::statistics)
    }
}

impl Kind for Network {
    const NAME: &'static str = "hydraulic system";
    const VERSION: u32 = 3;
    const MODES: &'static [&'static str] = &Mode::WORDS;
    type Definition = HydraulicSystem;
    type Laws = Laws;
    type Inputs = Inputs;
    type Output = Output;
    type State = State;
    type Cache = Cache;
    type Warnings = Warnings;

    fn about(system: &HydraulicSystem) -> (&str, &About, &str, Experiment) {
        (&system.name, &system.about, &system.description, system.experiment)
    }

    fn parameters(system: &mut HydraulicSystem, visit: &mut Visit) {
        system.parameters(visit);
    }

    fn mode(system: &HydraulicSystem) -> usize {
        system.coupling.mode as usize
    }

    fn set_mode(system: &mut HydraulicSystem, mode: usize) {
        system.coupling.mode = Mode::ALL[mode];
    }

    fn laws(system: &HydraulicSystem) -> Laws {
        Laws::new(system)
    }

    fn variables(system: &HydraulicSystem) -> (Vec<Variable>, Vec<Quantity>) {
        interface::variables(system)
    }

    fn cache(laws: &Laws) -> Cache {
        Cache::new(&laws.layout)
    }

    fn clear(cache: &mut Cache) {
        cache.clear();
    }

    fn check(system: &HydraulicSystem) -> Result<(), DefinitionError> {
        system.check()
    }

    fn check_ports(model: &Model) -> Result<(), HydraulicsError> {
        let laws = &model.parameters.laws;
        for (index, value) in model.inputs.values.iter().enumerate().take(laws.layout.reservoirs) {
            check_pressure(&model.name_of(index as Reference), *value, laws.ambient())?;
        }
        Ok(())
    }

    fn start(parameters: &Parameters, inputs: &Inputs) -> State {
        State::at_start(&parameters.laws, &parameters.definition, inputs)
    }

    fn range(laws: &Laws, input: usize) -> Option<Range> {
        match laws.layout.input(input) {
            Input::Reservoir(_) => None,
            input => Some(range(input)),
        }
    }

    fn ambient(laws: &Laws) -> f64 {
        laws.ambient()
    }

    fn input_changed(model: &mut Model, _input: usize) {
        model.cache.clear();
    }

    fn output(model: &mut Model, output: Output) -> Result<f64, HydraulicsError> {
        let h = model.next_step();
        let Model { parameters, inputs, state: Some(state), cache, warnings, .. } = model else {
            return Err(HydraulicsError::NotInitialised);
        };
        let (laws, setting) = (&parameters.laws, parameters.setting(inputs));
        let Output::Preview(cylinder, what) = output else {
            if !cache.is_present {
                let layout = &laws.layout;
                let (y, u) = (state.y.iter().copied(), inputs.values[..layout.flow_inputs()].iter().copied());
                let new = Present::new(laws, y, u, motion(layout, |input| inputs.values[input], 0.0));
                match &mut cache.present {
                    Some(present) => **present = new,
                    none => *none = Some(Box::new(new)),
                }
                cache.is_present = true;
            }
            let value = cache.present.as_ref().and_then(|present| present.output(laws, output, state.start_volume));
            return Ok(value.unwrap_or(f64::NAN));
        };
        let foreseen = cache.foresee(&setting, state, h);
        warnings.foreseen(&setting, foreseen);
        let get = |part| setting.get(cylinder, part);
        let chamber = laws.layout.chamber(cylinder);
        let pressures = [state.y[chamber], state.y[chamber + 1]];
        let (motion, given) = ([get(Part::Length), get(Part::Speed)], get(Part::Acceleration));
        let force = laws.cylinders[cylinder].laws.force(pressures, motion[1]);
        let is_last = matches!(what, Ahead::Acceleration | Ahead::ForceMean);
        let motions = if is_last { &foreseen.end_motions } else { &foreseen.motions };
        let drive = match motions[cylinder] {
            Motion::Own(drive) => drive,
            Motion::Given(_) => Drive::Given(motion),
        };
        if foreseen.reached == h {
            return Ok(ahead(laws, (cylinder, &drive), (force, motion, given), &foreseen.end, h, what));
        }
        // Where no motion was found, the present force and the motion of the inputs.
        Ok(blind(what, force, motion, given, h))
    }

    fn lock(state: &State, lock: usize) -> bool {
        state.locks[lock]
    }

    fn take_warning(model: &mut Model) -> Option<String> {
        if model.warnings.any() { model.warnings.take(&model.parameters) } else { None }
    }

    fn horizon(laws: &Laws) -> usize {
        laws.layout.horizon()
    }

    fn copy_state(state: &mut State, other: &State) {
        state.copy_from(other);
    }

    fn record_state(laws: &Laws, state: &mut State, record: &mut Record) -> Result<(), Damaged> {
        state.record(record)?;
        if laws.has_pressures(&state.y) {
            return Ok(());
        }
        Err(Damaged("a saved absolute pressure is not above 0".to_owned()))
    }

    fn record_warnings(warnings: &mut Warnings, record: &mut Record) -> Result<(), Damaged> {
        warnings.record(record)
    }
}

/// Length and speed of each cylinder by its inputs.
fn motion<T: Copy>(layout: &Layout, of: impl Fn(usize) -> T, none: T) -> [[T; 2]; MOST_CYLINDERS] {
    std::array::from_fn(|index| match index < layout.cylinders {
        true => [Part::Length, Part::Speed].map(|part| of(layout.of_cylinder(index, part))),
        false => [none; 2],
    })
}
