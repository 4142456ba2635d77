//! Model exchange: what the solver of a host asks of a component.
//!
//! In: states that the solver tries. Out: derivatives, event indicators, what is due. It must not know any law.
use super::{Component, MOST_STATES, NoValue, Refused};
use crate::mechanism;
use crate::variables::{ContinuousTime, Reference};

impl Component {
    /// The variables that a host's solver integrates; none if the model is for co-simulation only.
    pub fn continuous_time(&self) -> Option<ContinuousTime> {
        match self {
            Self::Mechanism(model) => model.continuous_time(),
            Self::Hydraulic(_) => None,
        }
    }

    /// Number of the continuous states; 0 if the model is for co-simulation only.
    pub fn state_count(&self) -> usize {
        match self {
            Self::Mechanism(model) => model.state_count(),
            Self::Hydraulic(_) => 0,
        }
    }

    /// References of the event indicators, which are declared one after the other.
    pub fn indicators(&self) -> std::ops::Range<Reference> {
        match self {
            Self::Mechanism(model) => model.indicators(),
            Self::Hydraulic(_) => 0..0,
        }
    }

    /// Serve model exchange from now on.
    ///
    /// # Errors
    /// The model is for co-simulation only.
    pub fn serve_exchange(&mut self) -> Result<(), Refused> {
        Ok(self.exchanged()?.serve_exchange()?)
    }

    /// The model, of the kind that serves model exchange.
    fn exchanged(&mut self) -> Result<&mut mechanism::Model, Refused> {
        match self {
            Self::Mechanism(model) => Ok(model),
            Self::Hydraulic(_) => Err(Refused(
                "model exchange is not available for a hydraulic actuator without a mechanism; use co-simulation"
                    .to_owned(),
            )),
        }
    }

    /// The continuous states: [`Self::state_count`] numbers, then zeros. Refused: the present parameters give no start.
    pub fn continuous_states(&mut self) -> Result<[f64; MOST_STATES], Refused> {
        Ok(self.exchanged()?.continuous_states()?)
    }

    /// Scales of the continuous states. Refused: as [`Self::continuous_states`].
    pub fn nominals(&mut self) -> Result<[f64; MOST_STATES], Refused> {
        Ok(self.exchanged()?.nominals()?)
    }

    /// Take the states that the host's solver tries: position, speed, then integral parts. Integral parts that are not
    /// given stay.
    ///
    /// # Errors
    /// A state that is not finite, or at which there is no mechanism; nothing has changed.
    pub fn set_continuous_states(&mut self, states: &[f64]) -> Result<(), NoValue> {
        Ok(self.exchanged().map_err(NoValue::Refused)?.set_continuous_states(states)?)
    }

    /// Time derivatives of the continuous states.
    ///
    /// # Errors
    /// There are none at this state.
    pub fn derivatives(&mut self) -> Result<[f64; MOST_STATES], NoValue> {
        Ok(self.exchanged().map_err(NoValue::Refused)?.derivatives()?)
    }

    /// The time at which values are asked for in model exchange [s].
    pub fn set_time(&mut self, time: f64) {
        if let Self::Mechanism(model) = self {
            model.set_time(time);
        }
    }

    /// The next event that is known before, in model exchange [s].
    pub fn next_event(&self) -> Option<f64> {
        match self {
            Self::Mechanism(model) => model.next_event(),
            Self::Hydraulic(_) => None,
        }
    }

    /// A step of the host's solver is complete: whether event mode is to be entered. Refused: not initialised.
    pub fn completed_step(&mut self) -> Result<bool, Refused> {
        Ok(self.exchanged()?.completed_step()?)
    }
}
