//! Model exchange: the functions of a component for the solver of a host.
//!
//! In: trial states of the solver. Out: derivatives, event indicators, pending transitions. Must not know: any law.
use super::{Component, MOST_STATES, NoValue, Refused};
use crate::mechanism;
use crate::variables::{ContinuousTime, Reference};

impl Component {
    /// The variables that a host's solver integrates. None if the model is for co-simulation only.
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

    /// References of the event indicators, which are consecutive.
    pub fn indicators(&self) -> std::ops::Range<Reference> {
        match self {
            Self::Mechanism(model) => model.indicators(),
            Self::Hydraulic(_) => 0..0,
        }
    }

    /// Prepares the component for model exchange.
    ///
    /// # Errors
    /// The model is for co-simulation only.
    pub fn serve_exchange(&mut self) -> Result<(), Refused> {
        Ok(self.exchange_model()?.serve_exchange()?)
    }

    /// The model, if its kind supports model exchange.
    fn exchange_model(&mut self) -> Result<&mut mechanism::Model, Refused> {
        match self {
            Self::Mechanism(model) => Ok(model),
            Self::Hydraulic(_) => Err(Refused(
                "model exchange is not available for a hydraulic actuator without a mechanism; use co-simulation"
                    .to_owned(),
            )),
        }
    }

    /// The continuous states: [`Self::state_count`] numbers, then zeros. Error: the present parameters allow no start.
    pub fn continuous_states(&mut self) -> Result<[f64; MOST_STATES], Refused> {
        Ok(self.exchange_model()?.continuous_states()?)
    }

    /// Nominal values of the continuous states. Error: as [`Self::continuous_states`].
    pub fn nominals(&mut self) -> Result<[f64; MOST_STATES], Refused> {
        Ok(self.exchange_model()?.nominals()?)
    }

    /// Sets trial states of the host's solver: position, speed, then states of controllers. Those that are not given
    /// keep their values.
    ///
    /// # Errors
    /// A state that is not finite, or a position that the mechanism does not have. Nothing has changed.
    pub fn set_continuous_states(&mut self, states: &[f64]) -> Result<(), NoValue> {
        Ok(self.exchange_model().map_err(NoValue::Refused)?.set_continuous_states(states)?)
    }

    /// Time derivatives of the continuous states.
    ///
    /// # Errors
    /// The derivatives do not exist in this state.
    pub fn derivatives(&mut self) -> Result<[f64; MOST_STATES], NoValue> {
        Ok(self.exchange_model().map_err(NoValue::Refused)?.derivatives()?)
    }

    /// Sets the time [s] for values in model exchange.
    pub fn set_time(&mut self, time: f64) {
        if let Self::Mechanism(model) = self {
            model.set_time(time);
        }
    }

    /// Time [s] of the next event that is known in advance, in model exchange.
    pub fn next_event(&self) -> Option<f64> {
        match self {
            Self::Mechanism(model) => model.next_event(),
            Self::Hydraulic(_) => None,
        }
    }

    /// Ends a step of the host's solver. Returns whether the host must enter event mode. Error: not initialised.
    pub fn completed_step(&mut self) -> Result<bool, Refused> {
        Ok(self.exchange_model()?.completed_step()?)
    }
}
