//! Event mode of an instance: transitions from step mode or continuous-time mode to event mode and back.
//!
//! In: calls in their phases. Out: a handled event, or a refusal that leaves the instance unchanged. Must not know:
//! what an event is.

use super::instance::Instance;
use super::phase::Phase;
use super::refusal::Refusal;

impl Instance {
    /// Enters event mode from step mode or continuous-time mode.
    pub fn enter_event_mode(&mut self) -> Result<(), Refusal> {
        if !self.usage.event_mode {
            return Err(Refusal::error(
                "this instance has no event mode (eventModeUsed was false); doStep handles the events within a step",
            ));
        }
        self.phase = Phase::Event;
        Ok(())
    }

    /// Handles the event at which the last step ended, if there is one. Returns whether the state jumped.
    pub fn update_discrete_states(&mut self) -> Result<bool, Refusal> {
        let (events, details) = (self.logger.has_events(), self.logger.has_details());
        self.component.listen(events, details);
        let has_jumped = self.component.handle_event(self.clock.time)?;
        self.awaits_event = false;
        if events || details {
            self.log_occurrences(self.clock.time);
        }
        Ok(has_jumped)
    }

    /// Changes from event mode to step mode.
    pub fn enter_step_mode(&mut self) -> Result<(), Refusal> {
        if self.usage.model_exchange {
            return Err(Refusal::error(
                "step mode belongs to co-simulation, but this instance was created for model exchange",
            ));
        }
        if self.awaits_event {
            return Err(self.event_first("step mode"));
        }
        self.phase = Phase::Step;
        Ok(())
    }

    /// The refusal of an action that is possible only after the event has been handled.
    #[cold]
    pub(super) fn event_first(&self, what: &str) -> Refusal {
        Refusal::error(format!(
            "the event at t = {} s must be handled before {what}: enter event mode and call updateDiscreteStates",
            self.clock.time
        ))
    }
}
