//! The model of a network: present parameters, inputs and state, and its outputs on demand.
//!
//! In: a definition's text, values set by the host, steps. Out: values by reference, warnings. It must not know FMI's
//! life cycle.
mod cache;
mod derivatives;
mod parameters;
mod step;
mod warnings;

use super::definition::{HydraulicSystem, MOST_CYLINDERS, Mode};
use super::inputs::{Inputs, range};
use super::interface::{self, Quantity};
use super::laws::Drive;
use super::layout::{Input, Layout, Part};
use super::outputs::{Ahead, Output, Present, ahead, blind};
use super::state::State;
use super::system::Motion;
use crate::format::{About, DefinitionError, Experiment};
use crate::hydraulics::definition::{ABOVE_VACUUM, is_pressure};
use crate::hydraulics::error::HydraulicsError;
use crate::inspection::Finding;
use crate::integrator::Statistics;
use crate::variables::{Reference, Terminal, Value, Variables};
use cache::Cache;
pub use parameters::{Original, Parameters};
use std::sync::Arc;
pub use warnings::Warnings;

/// One hydraulic system with its parameters, inputs and state.
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

impl Model {
    /// Model of the definition in a JSON text.
    ///
    /// # Errors
    /// What is wrong with the definition.
    pub fn from_json(text: &str) -> Result<Self, HydraulicsError> {
        Self::new(HydraulicSystem::from_json(text)?)
    }

    /// Model of a checked definition.
    ///
    /// # Errors
    /// Two variables of one name.
    pub fn new(system: HydraulicSystem) -> Result<Self, HydraulicsError> {
        let (list, quantities) = interface::variables(&system);
        let start = |input: &Quantity, start: Option<&Value>| match (input, start) {
            (Quantity::Input(_), Some(Value::Real(start))) => Some(*start),
            _ => None,
        };
        let values = quantities.iter().zip(&list).filter_map(|(quantity, one)| start(quantity, one.start.as_ref()));
        let inputs = Inputs::new(values.collect());
        let variables = Variables::new(&system.name, list, quantities)
            .map_err(|twice| DefinitionError::key(twice.0, "two variables have this name; rename an element"))?;
        let mut ranges = Vec::new();
        system.clone().parameters(&mut |parameter, _| ranges.push((parameter.range, parameter.role)));
        let parameters = Arc::new(Parameters::new(system));
        let cache = Cache::new(&parameters.laws.layout);
        let original =
            Arc::new(Original { parameters: Arc::clone(&parameters), variables, ranges, inputs: inputs.clone() });
        Ok(Self { original, parameters, inputs, state: None, cache, warnings: Warnings::default() })
    }

    /// Name of the system, the FMU's modelName and modelIdentifier.
    pub fn name(&self) -> &str {
        &self.original.parameters.system.name
    }

    /// Author, copyright and licence.
    pub fn about(&self) -> &About {
        &self.original.parameters.system.about
    }

    /// One-line description of the system.
    pub fn description(&self) -> &str {
        &self.original.parameters.system.description
    }

    /// Default experiment.
    pub fn experiment(&self) -> Experiment {
        self.original.parameters.system.experiment
    }

    /// The variables that the host sees.
    pub fn variables(&self) -> &Variables<Quantity> {
        &self.original.variables
    }

    /// What the definition gives reason to warn of, for logs.
    pub fn warnings(&self) -> Vec<Finding> {
        self.original.parameters.system.warnings()
    }

    /// The variables of the connections with what the cylinders move.
    pub fn terminals(&self) -> Vec<Terminal> {
        interface::terminals(&self.original.parameters.system, self.variables())
    }

    /// On what initial values depend: unknown, so that a host takes them to depend on everything.
    ///
    /// # Errors
    /// None.
    pub fn initial_dependencies(&self) -> Result<Option<Vec<Vec<Reference>>>, HydraulicsError> {
        Ok(None)
    }

    /// The next step of the host [s]: as it says, else as the last one, at first that of the default experiment.
    fn horizon(&self) -> f64 {
        let said = self.inputs.values[self.parameters.laws.layout.horizon()];
        let last = self.state.as_ref().map_or(0.0, |state| state.last_step);
        let first = self.original.parameters.system.experiment.step_size;
        if said > 0.0 {
            said
        } else if last > 0.0 {
            last
        } else {
            first
        }
    }

    /// Present value of a Real. Computed when first read in a state. NaN for an output beyond the range of numbers.
    ///
    /// # Errors
    /// No Real has this reference, or the present parameters give no network.
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
        let h = self.horizon();
        let Self { parameters, inputs, state: Some(state), cache, warnings, .. } = self else {
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

    /// Whether [`Self::set_real`] would accept this value; changes nothing.
    ///
    /// # Errors
    /// No Real has this reference, it is an output, or the value is out of range.
    pub fn check_real(&self, reference: Reference, value: f64) -> Result<(), HydraulicsError> {
        let refuse = |allowed: String| Err(HydraulicsError::Value { name: self.name_of(reference), value, allowed });
        let range = match self.original.variables.quantity(reference) {
            Some(Quantity::Parameter(index)) => self.original.ranges[index].0,
            Some(Quantity::Input(index)) => {
                let input = self.parameters.laws.layout.input(index);
                if let Input::Reservoir(_) = input {
                    let ambient = self.parameters.laws.ambient();
                    let allowed = || format!("{ABOVE_VACUUM}; fluid.ambient_pressure is {ambient} Pa");
                    return if is_pressure(value, ambient) { Ok(()) } else { refuse(allowed()) };
                }
                range(input)
            }
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
                    self.cache.clear();
                }
            }
            Some(Quantity::Parameter(index)) if self.parameters.values[index].to_bits() != value.to_bits() => {
                self.set_parameter(index, value);
                self.state = None;
            }
            _ => {}
        }
        Ok(())
    }

    fn set_parameter(&mut self, index: usize, value: f64) {
        let parameters = Arc::make_mut(&mut self.parameters);
        parameters.values[index] = value;
        parameters.update();
        self.cache.clear();
    }

    /// Whether a lock is engaged.
    ///
    /// # Errors
    /// No Boolean has this reference, or the present parameters give no network.
    pub fn boolean(&mut self, reference: Reference) -> Result<bool, HydraulicsError> {
        let Some(Quantity::Lock(index)) = self.original.variables.quantity(reference) else {
            return Err(self.no_such(reference, "Boolean"));
        };
        self.started()?;
        self.state.as_ref().map(|state| state.locks[index]).ok_or(HydraulicsError::NotInitialised)
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
    /// No Boolean can be set.
    pub fn check_boolean(&self, reference: Reference, _value: bool) -> Result<(), HydraulicsError> {
        match self.original.variables.quantity(reference) {
            Some(Quantity::Lock(_)) => Err(HydraulicsError::Output { name: self.name_of(reference) }),
            _ => Err(self.no_such(reference, "Boolean")),
        }
    }

    /// Set a Boolean.
    ///
    /// # Errors
    /// No Boolean can be set.
    pub fn set_boolean(&mut self, reference: Reference, value: bool) -> Result<(), HydraulicsError> {
        self.check_boolean(reference, value)
    }

    /// Present item of an Enumeration, by its index from 0 on.
    ///
    /// # Errors
    /// No Enumeration has this reference.
    pub fn item(&mut self, reference: Reference) -> Result<usize, HydraulicsError> {
        match self.original.variables.quantity(reference) {
            Some(Quantity::Mode) => Ok(self.parameters.system.coupling.mode as usize),
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
                self.set_parameter(index, value);
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
        if self.parameters.system.coupling.mode != mode {
            Arc::make_mut(&mut self.parameters).system.coupling.mode = mode;
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
        if self.warnings.any() { self.warnings.take(&self.parameters) } else { None }
    }

    /// Back to what [`Self::from_json`] gave.
    pub fn reset(&mut self) {
        self.parameters = Arc::clone(&self.original.parameters);
        self.inputs.copy_from(&self.original.inputs);
        self.state = None;
        self.cache.clear();
        self.warnings = Warnings::default();
    }

    /// Right-hand-side evaluations and accepted and rejected integration steps since initialisation.
    pub fn statistics(&self) -> Statistics {
        self.state.as_ref().map_or(Statistics::default(), State::statistics)
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

/// Length and speed of each cylinder by its inputs.
fn motion<T: Copy>(layout: &Layout, of: impl Fn(usize) -> T, none: T) -> [[T; 2]; MOST_CYLINDERS] {
    std::array::from_fn(|index| match index < layout.cylinders {
        true => [Part::Length, Part::Speed].map(|part| of(layout.of_cylinder(index, part))),
        false => [none; 2],
    })
}
