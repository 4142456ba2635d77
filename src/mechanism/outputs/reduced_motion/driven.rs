//! What outputs show of a prescribed motion: the state that the inputs prescribe now, and the force that the motion
//! takes.
//!
//! Inputs that are set at a communication point take effect in the state with the next step. Outputs show it at once,
//! by a copy of the state, so that reading them changes nothing. In: a state, inputs. Out: the copy, the size of the
//! drive's load with its derivatives. It must not know any law.
use super::ReducedMotion;
use crate::mechanism::dynamics::inputs::Inputs;
use crate::mechanism::dynamics::prescribed::Prescribed;
use crate::mechanism::error::ModelError;
use crate::mechanism::motion::state::State;
use crate::mechanism::motion::step_ahead::Outdated;
use crate::mechanism::outputs::evaluator::OutputError;
use crate::mechanism::outputs::view::{Reading, View};
use crate::mechanism::reduced::Reduced;
use crate::numerics::dual::Dual;

/// What outputs show of a prescribed motion.
#[derive(Clone, Debug)]
pub struct Driven {
    /// The state under the present inputs, if it is another one than after the last step.
    shown: State,
    is_shown: bool,
    /// Acceleration of the drive and its rate in time, if its motion is prescribed.
    demand: Option<[f64; 2]>,
}

impl Driven {
    pub fn new(state: &State) -> Self {
        Self { shown: state.clone(), is_shown: false, demand: None }
    }

    /// The state to be shown, if it is not that after the last step.
    pub fn shown(&self) -> Option<&State> {
        self.is_shown.then_some(&self.shown)
    }
}

impl<N: Reading> View<'_, N> {
    /// Whether the mechanism is where its motion is prescribed to be.
    ///
    /// # Errors
    /// [`OutputError::Motion`].
    #[cold]
    pub fn check_placed(&self) -> Result<(), OutputError> {
        match &self.loads.undriven {
            Some(error @ OutputError::Motion(_)) => Err(error.clone()),
            _ => Ok(()),
        }
    }
}

impl ReducedMotion {
    /// The state that outputs show.
    pub fn shown(&mut self, reduced: &Reduced, inputs: &Inputs) -> &State {
        self.sync(reduced, inputs);
        self.driven.as_deref().and_then(Driven::shown).unwrap_or(&self.state)
    }

    /// Take over the state that outputs show.
    pub fn adopt(&mut self, reduced: &Reduced, inputs: &Inputs) {
        self.shown(reduced, inputs);
        if let Some(shown) = self.driven.as_deref().and_then(Driven::shown) {
            self.state.copy_from(shown);
            self.state.memory.drop_outdated(Outdated::Count);
        }
    }

    /// Begin or end to follow what the inputs prescribe.
    ///
    /// # Errors
    /// As [`State::preview`]; nothing has changed.
    pub fn switch(&mut self, reduced: &Reduced, inputs: &Inputs) -> Result<(), ModelError> {
        match inputs.prescribes() {
            true => self.state.preview(reduced, inputs)?,
            false => self.state.release(reduced, inputs),
        }
        Ok(())
    }

    /// sigma_ddot that a prescribed motion demands.
    ///
    /// # Errors
    /// [`OutputError::Motion`].
    pub fn demanded(&mut self, reduced: &Reduced, inputs: &Inputs) -> Result<f64, OutputError> {
        let sigma_dot = self.shown(reduced, inputs).sigma_dot;
        self.plain_view(reduced, inputs).check_placed()?;
        let [slope, curvature] = self.slopes(reduced);
        let acceleration = self.driven.as_ref().and_then(|driven| driven.demand).map_or(f64::NAN, |[first, _]| first);
        Ok((acceleration - curvature * sigma_dot * sigma_dot) / slope)
    }

    /// S_sigma and S_sigma_sigma of the drive whose motion is prescribed, in the state that is shown.
    fn slopes(&self, reduced: &Reduced) -> [f64; 2] {
        let sigma = self.driven.as_deref().and_then(Driven::shown).unwrap_or(&self.state).sigma;
        let Some(drive) = &reduced.loading().motion else { return [f64::NAN; 2] };
        match reduced.at(sigma).displacement_around(drive.load, sigma) {
            Ok((table, position)) => [1, 2].map(|order| table.value(position, order)),
            Err(_) => [f64::NAN; 2],
        }
    }

    /// Find the state under the present inputs, and the force of the drive.
    pub(in crate::mechanism::outputs) fn settle(&mut self, reduced: &Reduced, inputs: &Inputs) {
        let (Some(driven), Some(drive)) = (&mut self.driven, &reduced.loading().motion) else { return };
        (driven.is_shown, driven.demand) = (false, None);
        self.loads.undriven = None;
        if !inputs.prescribes() {
            return;
        }
        if !self.state.applied.are_in_force(inputs) {
            driven.is_shown = true;
            driven.shown.copy_from(&self.state);
            if let Err(error) = driven.shown.preview(reduced, inputs) {
                self.loads.undriven = Some(OutputError::Motion(error.to_string()));
                return;
            }
        }
        let state = driven.shown().unwrap_or(&self.state);
        let Some(prescribed) = state.prescribed else { return };
        let motion = Prescribed::new(drive, inputs, prescribed.origin, prescribed.time.parts());
        let [_, _, acceleration, mut jerk] = motion.map_or([f64::NAN; 4], |motion| motion.at(0.0));
        if let Some(first) = drive.first_input {
            jerk = inputs.signal.first[first + 2];
        }
        driven.demand = Some([acceleration, jerk]);
        // What is found must not depend on the size before.
        self.set_drive(drive.load, 0.0);
        match self.plain_view(reduced, inputs).force_for(drive.load, acceleration) {
            Ok(force) if force.is_finite() => self.set_drive(drive.load, force),
            Ok(_) => self.loads.undriven = Some(OutputError::Dead(drive.load)),
            Err(error) => self.loads.undriven = Some(error),
        }
        self.cache.invalidate();
    }

    fn set_drive(&mut self, load: usize, size: f64) {
        if self.loads.set(load, size) {
            self.cache.scratch.panel_force.invalidate();
        }
    }

    /// Complete the direction of derivatives, in time or along inputs, by what a prescribed motion makes of it.
    pub(in crate::mechanism::outputs) fn drive_along(&mut self, reduced: &Reduced, inputs: &Inputs, in_time: bool) {
        let demand = self.driven.as_ref().and_then(|driven| driven.demand);
        let (Some([acceleration, jerk]), Some(drive)) = (demand, &reduced.loading().motion) else { return };
        let sigma_dot = self.driven.as_deref().and_then(Driven::shown).unwrap_or(&self.state).sigma_dot;
        let [slope, curvature] = self.slopes(reduced);
        let direction = self.direction(reduced, inputs);
        let [position_rate, speed_rate, rate] = match drive.first_input {
            _ if in_time => [slope * sigma_dot, acceleration, jerk],
            Some(first) => [0, 1, 2].map(|k| direction.rates[first + k]),
            None => [0.0; 3],
        };
        let along = position_rate / slope;
        direction.along = [along, (speed_rate - curvature * along * sigma_dot) / slope];
        direction.rates[drive.load] = 0.0;
        let s = direction.s;
        let force = self.sensitive_view(reduced, inputs).map(|mut view| {
            let demand = Dual { value: acceleration, slope: [rate * s.slope[0]] };
            view.force_for(drive.load, demand)
        });
        let rate = force.and_then(Result::ok).map_or(f64::NAN, |force| force.slope[0]);
        self.direction(reduced, inputs).rates[drive.load] = rate;
    }
}
