//! Initialisation and steps of a model.
//!
//! In: parameters, inputs, the size of a step. Out: the state after it, warnings; a refusal that leaves all as it was.
//! It must not know outputs.
use super::Model;
use crate::circuit::SLACK;
use crate::definition::{ABOVE_VACUUM, is_pressure};
use crate::error::HydraulicsError;
use crate::events::nearness;
use crate::network::definition::Mode;
use crate::network::inputs::range;
use crate::network::layout::{Input, Part};
use crate::state::interrupted;
use foundation::format::Range;
use foundation::integrator::SHORTEST;
use foundation::variables::Reference;

/// Relative difference of two steps that rounding of times explains.
const SAME_STEP: f64 = 1e-9;

impl Model {
    /// Put the network at its start under the present parameters and inputs.
    ///
    /// # Errors
    /// The present parameters give no network, or a cylinder does not have its present length.
    pub fn initialize(&mut self) -> Result<(), HydraulicsError> {
        self.clear_motion();
        self.started()?;
        self.parameters.setting(&self.inputs).check_lengths(0.0, &self.cache.foreseen.motions, |_| SLACK)
    }

    /// Advance by exactly `h` [s], > 0: by the foreseen motion, or by that of the inputs. The inputs keep their values
    /// at the end. On an error the state is what it was, but for [`HydraulicsError::Interrupted`]: the state and the
    /// inputs are then those at the time reached.
    ///
    /// # Errors
    /// Not initialised, h out of range, a length that a cylinder does not have, the integration stopped, or
    /// `solver.max_steps` was met.
    pub fn step(&mut self, h: f64) -> Result<(), HydraulicsError> {
        self.advance(h, false).map(|_| ())
    }

    /// [`Self::step`], but to the first event within it, if there is one, whose time since its beginning [s] is
    /// returned. Locks do not release or engage within the step; [`Self::handle_event`] does that.
    ///
    /// # Errors
    /// As [`Self::step`].
    pub fn step_to_event(&mut self, h: f64) -> Result<Option<f64>, HydraulicsError> {
        self.advance(h, true)
    }

    /// The event to which a step has led is handled: locks release or engage.
    pub fn handle_event(&mut self) {
        let Self { parameters, state: Some(state), .. } = self else { return };
        state.switch_locks(&parameters.laws, nearness(parameters.definition.solver.tolerance));
    }

    /// The event to which the last step has led: its time since the beginning of the step [s], and its words.
    pub fn take_event(&mut self) -> Option<(f64, String)> {
        let (time, event) = self.cache.event.take()?;
        Some((time, self.parameters.laws.event_words(event, &self.parameters.definition)))
    }

    /// Whether a step can come to an event.
    pub fn has_events(&self) -> bool {
        self.parameters.laws.has_events()
    }

    fn advance(&mut self, h: f64, to_event: bool) -> Result<Option<f64>, HydraulicsError> {
        if !(h.is_finite() && h > 0.0) {
            return Err(HydraulicsError::StepSize { h });
        }
        self.check_inputs_at(h)?;
        let Self { parameters, inputs, state: Some(state), cache, warnings, .. } = self else {
            return Err(HydraulicsError::NotInitialised);
        };
        let (setting, layout) = (parameters.setting(inputs), &parameters.laws.layout);
        state.check_lengths(&setting, 0.0, &cache.foreseen.motions)?;
        if h < SHORTEST {
            let y = state.y.clone();
            inputs.leave(layout, h, &y);
            cache.clear();
            return Ok(None);
        }
        let moves = (0..layout.cylinders).any(|index| setting.get(index, Part::Mass) > 0.0);
        let follows = parameters.definition.coupling.mode == Mode::Follow;
        let whole = h;
        cache.event = None;
        if to_event {
            cache.is_foreseen = false;
            cache.event = state.first_event(&setting, (h, follows), &mut cache.foreseen);
        }
        let h = cache.event.map_or(h, |(time, _)| time);
        // A step that fails leaves no trace.
        let warned = *warnings;
        let mut predicted = None;
        if moves || !follows {
            let said = inputs.values[layout.horizon()];
            let is_said = |h: f64| (said - h).abs() <= SAME_STEP * h;
            if moves && said > 0.0 && !is_said(h) && !is_said(whole) {
                warnings.horizon(said, h);
            }
            let foreseen = cache.foresee(&setting, state, h);
            warnings.foreseen(&setting, foreseen);
            // The mechanisms had another force if an event has ended the step that was announced.
            let is_known = h == whole || is_said(h);
            predicted = foreseen.error.is_none().then(|| foreseen.predicted(&setting, is_known));
        }
        let reached = if follows {
            cache.is_foreseen = false;
            state.follow(&setting, h, &mut cache.foreseen).inspect_err(|_| *warnings = warned)?
        } else {
            let foreseen = &mut cache.foreseen;
            if let Some(error) = foreseen.error.take() {
                (cache.is_foreseen, *warnings) = (false, warned);
                return Err(error);
            }
            state.check_lengths(&setting, h, &foreseen.motions).inspect_err(|_| *warnings = warned)?;
            state.keep(&setting, foreseen)
        };
        warnings.watch(&setting, state, h);
        state.arrive(&setting, reached, predicted.as_ref().filter(|_| reached == h), !to_event);
        inputs.leave(layout, reached, &state.y);
        cache.clear();
        if reached < h {
            Err(interrupted(&parameters.definition.solver, reached, h))
        } else {
            Ok(cache.event.map(|(time, _)| time))
        }
    }

    /// Refuse a step of size h at the end of which an input is out of range.
    fn check_inputs_at(&self, h: f64) -> Result<(), HydraulicsError> {
        let (inputs, laws) = (&self.inputs, &self.parameters.laws);
        if !inputs.ahead {
            // An input without derivatives keeps its value, which was in range.
            return Ok(());
        }
        for index in (0..inputs.values.len()).filter(|index| inputs.changes(*index)) {
            let (value, rates) = inputs.end(index, h);
            let input = laws.layout.input(index);
            let name = |what: &str| [what, &self.name_of(index as Reference), " at the end of the step"].concat();
            let is_reservoir = matches!(input, Input::Reservoir(_));
            let is_allowed = match input {
                Input::Reservoir(_) => is_pressure(value, laws.ambient()),
                Input::Cylinder(_, Part::Length) => true,
                input => range(input).contains(value),
            };
            if !is_allowed {
                let allowed = if is_reservoir { ABOVE_VACUUM.to_owned() } else { range(input).text() };
                return Err(HydraulicsError::Value { name: name(""), value, allowed });
            }
            if let Some(value) = rates.into_iter().find(|rate| !rate.is_finite()) {
                let name = name("a derivative of ");
                return Err(HydraulicsError::Value { name, value, allowed: Range::Finite.text() });
            }
        }
        Ok(())
    }
}
