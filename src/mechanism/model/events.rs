//! The event at which a step has ended, for hosts that handle events.
//!
//! In: the state before an event. Out: the state after it. It must not know how a
//! step is made.
use super::{Formulation, Model, ModelError, Pauses};

impl Model {
    /// The impact at the stop, or the change of locks, to which [`Self::step_to_pause`] has led, at the time `point`
    /// [s] of the host; returns whether the state has jumped.
    ///
    /// # Errors
    /// Not initialised, or friction locks; the state is what it was.
    pub fn handle_event(&mut self, point: Option<f64>) -> Result<bool, ModelError> {
        if self.exchange.is_some() {
            return self.update_discrete_states(point);
        }
        self.follow_arrival(point)
    }

    /// What follows from the arrival at a stop, if the contact has one, and from pressures at which locks change;
    /// returns whether there is such an arrival.
    pub(super) fn follow_arrival(&mut self, point: Option<f64>) -> Result<bool, ModelError> {
        let (Some(state), Some(reduced)) = (&mut self.state, &self.reduced) else {
            return Err(ModelError::NotInitialised);
        };
        match state {
            Formulation::Reduced(motion) => {
                let arrives = motion.state.contact.arrival().is_some();
                if !(arrives || motion.state.is_lock_due(reduced)) {
                    return Ok(false);
                }
                motion.state.is_retuned = self.untuned.is_some();
                motion.state.witness.listens = self.told.listens;
                motion.state.witness.pauses = Pauses::default();
                let solver = &self.parameter_values.mechanism().solver;
                motion.step_from(point, reduced, &self.inputs, 0.0, solver)?;
                self.untuned = None;
                Ok(arrives)
            }
            _ => Ok(false),
        }
    }

    /// Whether a stop, a cylinder with its ends or a law of friction that sticks is declared, so that a step may come
    /// to an event.
    pub fn has_events(&self) -> bool {
        let mechanism = self.original.parameter_values.mechanism();
        !mechanism.stops.is_empty() || mechanism.has_hydraulics() || mechanism.sticks()
    }
}
