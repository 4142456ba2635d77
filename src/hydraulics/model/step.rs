//! Initialisation and steps of a model.
//!
//! In: parameters, inputs, the size of a step. Out: the state after it, warnings; a refusal that leaves all as it was.
//! It must not know outputs.
use super::warnings::{self, Warning};
use super::{Model, is_same_step, point};
use crate::circuit::{EVENTS, SLACK};
use crate::definition::{ABOVE_VACUUM, Mode, is_pressure};
use crate::error::HydraulicsError;
use crate::inputs::Input;
use crate::interface::Quantity;
use crate::state::{self, Blind, Foreseen, Setting, State, interrupted};
use crate::systems::{LENGTH, SPEED};
use foundation::format::Range;
use foundation::integrator::SHORTEST;
use foundation::variables::{Reference, Variables};

impl Model {
    /// Put the circuit at its start under the present parameters and inputs.
    ///
    /// # Errors
    /// The present parameters give no circuit, or the cylinder does not have the present length.
    pub fn initialize(&mut self) -> Result<(), HydraulicsError> {
        self.clear_motion();
        self.started()?;
        self.parameters.setting(&self.inputs).check_length(self.inputs.get(Input::Length), SLACK)
    }

    /// Advance by exactly `h` [s], > 0: by the foreseen motion, or by that of the inputs. The inputs keep their values
    /// at the end. On an error the state is what it was, but for [`HydraulicsError::Interrupted`]: the state and the
    /// inputs are then those at the time reached.
    ///
    /// # Errors
    /// Not initialised, h out of range, a length that the cylinder does not have, the integration stopped, an absolute
    /// pressure came to 0 in oil without air, or `solver.max_steps` was met.
    pub fn step(&mut self, h: f64) -> Result<(), HydraulicsError> {
        self.advance(h, false).map(|_| ())
    }

    /// [`Self::step`], but to the first event within it, if there is one, whose time since its beginning [s] is
    /// returned. The events are those of [`EVENTS`](crate::circuit::EVENTS), and the ends of the travel. In
    /// the mode `delayed` a step with preview has no events, as the mechanism has the force of the whole step already.
    ///
    /// # Errors
    /// As [`Self::step`].
    pub fn step_to_event(&mut self, h: f64) -> Result<Option<f64>, HydraulicsError> {
        self.advance(h, true)
    }

    /// The event to which the last step has led: its time since the beginning of the step [s], and its words.
    pub fn take_event(&mut self) -> Option<(f64, String)> {
        let (time, event) = self.cache.event.take()?;
        let words = EVENTS.get(event).copied().unwrap_or("the piston reaches an end of its travel");
        Some((time, words.to_owned()))
    }

    /// Whether a step can come to an event.
    pub fn has_events(&self) -> bool {
        true
    }

    /// The event to which a step has led is handled. No state jumps at an event of an actuator.
    pub fn handle_event(&mut self) {}

    fn advance(&mut self, h: f64, to_event: bool) -> Result<Option<f64>, HydraulicsError> {
        if !(h.is_finite() && h > 0.0) {
            return Err(HydraulicsError::StepSize { h });
        }
        let Self { original, parameters, inputs, state: Some(state), cache, warnings } = self else {
            return Err(HydraulicsError::NotInitialised);
        };
        // Some hosts set all connected inputs to 0 before the first step.
        if inputs.get(Input::Length) == 0.0 && !parameters.laws.has_length(0.0) {
            let (start, mut own) = (parameters.definition.actuator.length, *inputs);
            own.values[Input::Length as usize] = state.arrival.map_or(start, |[length, _]| length);
            check_inputs_at(&parameters.setting(&own), &original.variables, h, None)?;
            *inputs = own;
        }
        let setting = parameters.setting(inputs);
        let begin = inputs.get(Input::Length);
        let overrun = state.overrun(&setting);
        setting.check_length(begin, overrun)?;
        check_inputs_at(&setting, &original.variables, h, None)?;
        if h < SHORTEST {
            inputs.leave(h, None);
            cache.clear();
            return Ok(None);
        }
        let (read, announced) = (cache.read, parameters.horizon(inputs, state));
        let mode = parameters.definition.coupling.mode;
        let whole = h;
        cache.event = if to_event { first_event(&setting, state, mode, h, overrun, &original.variables) } else { None };
        let h = cache.event.map_or(h, |(time, _)| time);
        let is_announced = is_same_step(announced, h);
        let seen = if inputs.get(Input::Mass) > 0.0 {
            if !is_same_step(announced, whole) && !is_announced && inputs.get(Input::Horizon) > 0.0 {
                warnings.raise(Warning::Horizon, [announced, h]);
            }
            cache.foresee(parameters, inputs, state, h)
        } else {
            &Err(Blind::NoMass)
        };
        let before = state.circuit;
        let (mut predicted, mut lead) = (None, [0.0; 2]);
        // A step whose foresight is whole has the size of the step but for rounding.
        let reached_by = |foreseen: &Foreseen| if foreseen.is_whole() { h } else { foreseen.reached };
        let (reached, motion) = match seen {
            Ok(foreseen) if mode == Mode::Delayed => {
                predicted = state.predict(&setting, foreseen, h).ok();
                state.keep(foreseen);
                if let Some(predicted) = &predicted {
                    lead = state.lead(&setting, predicted, (&before, foreseen), h);
                    state.repay(&setting, predicted.motion[0], h);
                }
                let end = [foreseen.end[LENGTH], foreseen.end[SPEED]];
                (reached_by(foreseen), Some(predicted.map_or(end, |predicted| predicted.motion)))
            }
            Ok(foreseen) if mode == Mode::Preview => {
                state.keep(foreseen);
                (reached_by(foreseen), Some([foreseen.end[LENGTH], foreseen.end[SPEED]]))
            }
            seen => {
                if let Err(blind) = seen {
                    warnings::blind(warnings, *blind, inputs, h);
                    if *blind == Blind::Failed && mode != Mode::Follow {
                        // Found again for its text.
                        let failed = state.foresee(&setting, h).err().and_then(|(_, error)| error);
                        return Err(failed.unwrap_or(HydraulicsError::NotInitialised));
                    }
                }
                check_inputs_at(&setting, &original.variables, h, Some(overrun))?;
                let memory = state.driven.clone();
                // The motion foreseen begins with the same rates.
                let foreseen = seen.as_ref().ok().filter(|foreseen| !foreseen.course.met_end);
                let rates = foreseen.map(|foreseen| &foreseen.start_rates);
                let followed = state.follow(&setting, h, rates).inspect_err(|_| {
                    (state.circuit, state.driven) = (before, memory);
                });
                (followed?.0, None)
            }
        };
        warnings.count_step();
        if warnings.may_raise() {
            let begin = || point(parameters, state::dynamic(&before), inputs);
            warnings::watch(warnings, &setting, (state, &begin), h, read || mode != Mode::Follow);
        }
        let end = motion.map_or_else(|| inputs.length().at(reached), |[length, _]| length);
        // A host that is late has the force of the step that it makes.
        let is_known = is_announced || mode == Mode::Delayed;
        let keeps = mode == Mode::Preview && seen.is_ok();
        state.arrive(&setting, (reached, is_known, keeps), end, seen.as_ref().ok());
        if let (Some(last), Some(predicted)) = (&mut state.last, &predicted) {
            (last.speed, last.correction) = (predicted.motion[1], predicted.correction);
            last.expected_load = Some(predicted.load(h));
        }
        inputs.leave(reached, motion);
        cache.clear();
        if let Some(predicted) = predicted.filter(|_| reached == h) {
            let horizon = parameters.horizon(inputs, state);
            let seen = state.tell(&parameters.setting(inputs), &predicted, (h, lead), horizon);
            cache.foreseen = seen.map(|seen| (horizon, Ok(seen)));
        }
        if reached < h {
            cache.event = None;
            return Err(interrupted(&parameters.definition.solver, reached, h));
        }
        Ok(cache.event.map(|(time, _)| time))
    }
}

/// The first event within a step of size h and its time [s], by a motion of which nothing is kept; none if the motion
/// of the step is not found.
#[cold]
fn first_event(
    setting: &Setting<'_>,
    state: &State,
    mode: Mode,
    h: f64,
    overrun: f64,
    variables: &Variables<Quantity>,
) -> Option<(f64, usize)> {
    let watching = Setting { watches: true, ..*setting };
    if mode != Mode::Follow && setting.inputs.get(Input::Mass) > 0.0 {
        match state.foresee(&watching, h) {
            _ if mode == Mode::Delayed => return None,
            Ok(foreseen) => return foreseen.event.map(|event| (foreseen.reached, event)),
            Err((Blind::Failed, _)) => return None,
            Err(_) => {}
        }
    }
    check_inputs_at(setting, variables, h, Some(overrun)).ok()?;
    let mut trial = state.clone();
    let (reached, event) = trial.follow(&watching, h, None).ok()?;
    event.map(|event| (reached, event))
}

/// Refuse a step of size h at the end of which an input is out of range. `follows`: how far beyond the ends of the
/// cylinder a step that moves by the inputs may lead [m]; if it does not, length and speed are not those of the inputs
/// at its end.
fn check_inputs_at(
    setting: &Setting<'_>,
    variables: &Variables<Quantity>,
    h: f64,
    follows: Option<f64>,
) -> Result<(), HydraulicsError> {
    let (inputs, laws) = (setting.inputs, setting.laws);
    if inputs.ahead {
        // An input without derivatives keeps its value, which was in range.
        for input in Input::ALL.into_iter().filter(|input| inputs.changes(*input)) {
            let (value, rates) = inputs.end(input, h);
            let is_own = input == Input::Length || input == Input::Speed && follows.is_none();
            let range = match input {
                Input::Mass | Input::Horizon => Range::NonNegative,
                _ => Range::Finite,
            };
            let pressure = matches!(input, Input::Supply | Input::Tank);
            let name = |what: &str| {
                let name = variables.get(input as Reference).map_or("an input", |variable| &variable.name);
                [what, name, " at the end of the step"].concat()
            };
            if !is_own && !range.contains(value) || pressure && !is_pressure(value, laws.ambient()) {
                let allowed = if pressure { ABOVE_VACUUM.to_owned() } else { range.text() };
                return Err(HydraulicsError::Value { name: name(""), value, allowed });
            }
            if let Some(value) = rates.into_iter().find(|rate| !rate.is_finite()) {
                let name = name("a derivative of ");
                return Err(HydraulicsError::Value { name, value, allowed: Range::Finite.text() });
            }
        }
    }
    match follows {
        Some(beyond) if inputs.ahead || inputs.get(Input::Speed) != 0.0 => setting.check_way(h, beyond),
        _ => Ok(()),
    }
}
