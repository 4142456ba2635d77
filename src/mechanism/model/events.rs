//! Steps that end at an event, and the event itself, for hosts that handle events.
//!
//! In: a step, a request to handle the event at its end. Out: the states before and after the event. It must not know how a
//! step is made.
use super::{Formulation, Model, ModelError, Reached};

impl Model {
    /// [`Self::step_from`], but only to where a stop is met or lets go, if that comes first. The state is then that
    /// before the impact, which follows with [`Self::handle_event`] or the next step.
    ///
    /// # Errors
    /// As [`Self::step`].
    pub fn step_to_event(&mut self, point: Option<f64>, h: f64) -> Result<Reached, ModelError> {
        self.advance(point, h, true)
    }

    /// The impact at the stop to which [`Self::step_to_event`] has led, at the time `point` [s] of the host; returns
    /// whether the state has jumped.
    ///
    /// # Errors
    /// Not initialised, or friction locks; the state is what it was.
    pub fn handle_event(&mut self, point: Option<f64>) -> Result<bool, ModelError> {
        let (Some(state), Some(reduced)) = (&mut self.state, &self.reduced) else {
            return Err(ModelError::NotInitialised);
        };
        match state {
            Formulation::Reduced(motion) if motion.state.contact.arrival().is_some() => {
                motion.state.witness.listens = self.told.listens;
                motion.state.witness.pauses = false;
                let solver = &self.parameter_values.mechanism().solver;
                motion.step_from(point, reduced, &self.inputs, 0.0, solver).map(|_| true)
            }
            _ => Ok(false),
        }
    }

    /// Whether a stop is declared, so that a step may come to an event.
    pub fn has_events(&self) -> bool {
        !self.original.parameter_values.mechanism().stops.is_empty()
    }
}
