//! The features of FMI that a host uses, and the phases that an instance has for them.

use super::phase::Phase;
use super::refusal::Refusal;
use super::saved::Saved;

/// Features that the host requests when it creates an instance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Usage {
    /// Event mode between steps.
    pub event_mode: bool,
    /// Steps that end at an event or where the host requests it.
    pub early_return: bool,
    /// A callback after each internal step.
    pub intermediate_update: bool,
    /// Derivatives for the host's solver, instead of steps.
    pub model_exchange: bool,
}

impl Usage {
    /// Whether an instance of this usage can be in a phase.
    pub(super) fn has(self, phase: Phase) -> bool {
        match phase {
            Phase::Event => self.event_mode,
            Phase::Continuous => self.model_exchange,
            Phase::Step | Phase::Failed | Phase::Interrupted => !self.model_exchange,
            _ => true,
        }
    }
}

/// The refusal of a saved state whose phase this instance does not have.
#[cold]
pub(super) fn no_such_phase(saved: &Saved) -> Refusal {
    Refusal::error(format!(
        "the state was saved in the phase '{}'{}, but this instance does not have this phase; restore the state into \
         an instance with the same settings",
        saved.phase.name(),
        if saved.awaits_event { " with an unhandled event" } else { "" }
    ))
}
