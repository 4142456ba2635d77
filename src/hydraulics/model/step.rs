//! Initialisation and steps of a model.
//!
//! In: parameters, inputs, the size of a step. Out: the state after it, warnings; a refusal that leaves all as it was. It
//! must not know outputs.
use super::warnings::{self, Warning, Warnings};
use super::{Model, foreseen, point};
use crate::hydraulics::definition::{ABOVE_VACUUM, Mode, is_pressure};
use crate::hydraulics::error::HydraulicsError;
use crate::hydraulics::inputs::Input;
use crate::hydraulics::state::{Blind, Setting, interrupted};
use crate::hydraulics::systems::{LENGTH, SPEED};

impl Model {
    /// Put the circuit at its start under the present parameters and inputs.
    ///
    /// # Errors
    /// The present parameters give no circuit, or the cylinder does not have the present length.
    pub fn initialize(&mut self) -> Result<(), HydraulicsError> {
        self.state = None;
        self.cache.clear();
        self.warnings = Warnings::default();
        self.started()?;
        self.parameters.setting(&self.inputs).check_length(self.inputs.get(Input::Length))
    }

    /// Put the circuit at its start if it has no state yet.
    #[inline]
    pub(super) fn started(&mut self) -> Result<(), HydraulicsError> {
        if self.state.is_none() {
            self.parameters.actuator.check()?;
            self.state = Some(self.parameters.start(&self.inputs));
        }
        Ok(())
    }

    /// Advance by exactly `h` [s], > 0: by the foreseen motion, or by that of the inputs. The inputs keep their values
    /// at the end. On an error the state is what it was, but for [`HydraulicsError::Interrupted`]: the state and the
    /// inputs are then those at the time reached.
    ///
    /// # Errors
    /// Not initialised, h out of range, a length that the cylinder does not have, the integration stopped, an absolute
    /// pressure came to 0 in oil without air, or `solver.max_steps` was met.
    pub fn step(&mut self, h: f64) -> Result<(), HydraulicsError> {
        if !(h.is_finite() && h > 0.0) {
            return Err(HydraulicsError::StepSize { h });
        }
        let Self { parameters, inputs, state: Some(state), cache, warnings, .. } = self else {
            return Err(HydraulicsError::NotInitialised);
        };
        let setting = parameters.setting(inputs);
        let begin = inputs.get(Input::Length);
        setting.check_length(begin)?;
        let read = cache.read;
        let seen = if inputs.get(Input::Mass) > 0.0 {
            if inputs.get(Input::Horizon).to_bits() != h.to_bits() {
                warnings.raise(Warning::Horizon, [inputs.get(Input::Horizon), h]);
                cache.foreseen = None;
            }
            foreseen(parameters, inputs, state, cache, h)
        } else {
            &Err(Blind::NoMass)
        };
        let mode = parameters.actuator.coupling.mode;
        let mut next = *state;
        let (reached, motion) = match seen {
            Ok(foreseen) if mode == Mode::Preview => {
                next.keep(foreseen);
                (foreseen.reached, Some([foreseen.end[LENGTH], foreseen.end[SPEED]]))
            }
            blind => {
                if let Err(blind) = blind {
                    warnings::blind(warnings, *blind, inputs, h);
                    if *blind == Blind::Failed && mode == Mode::Preview {
                        // Found again for its text.
                        let failed = state.foresee(&setting, h).err().and_then(|(_, error)| error);
                        return Err(failed.unwrap_or(HydraulicsError::NotInitialised));
                    }
                }
                check_inputs_at(&setting, h)?;
                (next.follow(&setting, h)?, None)
            }
        };
        let end = motion.map_or_else(|| inputs.length().at(reached), |[length, _]| length);
        next.arrive(&setting, reached, end, seen.as_ref().ok());
        if warnings.may_raise() {
            let now = point(parameters, state, inputs);
            warnings::watch(warnings, &setting, (state, &now), h, read || mode == Mode::Preview);
        }
        *state = next;
        inputs.leave(reached, motion);
        cache.clear();
        if reached < h { Err(interrupted(&parameters.actuator.solver, reached, h)) } else { Ok(()) }
    }
}

/// Refuse a step of size h at the end of which an input is out of range.
fn check_inputs_at(setting: &Setting<'_>, h: f64) -> Result<(), HydraulicsError> {
    let (inputs, laws) = (setting.inputs, setting.laws);
    if !inputs.ahead && inputs.get(Input::Speed) == 0.0 {
        return Ok(());
    }
    for (input, name) in [(Input::Supply, "supply.pressure"), (Input::Tank, "tank.pressure")] {
        let value = inputs.polynomial(input).at(h);
        if !is_pressure(value, laws.ambient()) {
            let name = format!("{name} at the end of the step");
            return Err(HydraulicsError::Value { name, value, allowed: ABOVE_VACUUM.into() });
        }
    }
    for (input, name) in [(Input::Speed, "actuator.speed"), (Input::Command, "valve.command")] {
        let value = inputs.polynomial(input).at(h);
        if !value.is_finite() {
            let name = format!("{name} at the end of the step");
            return Err(HydraulicsError::Value { name, value, allowed: "finite".into() });
        }
    }
    setting.check_way(h)
}
