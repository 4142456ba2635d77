//! Memory of the integration between communication steps, with or without the energy lost as a component of the state.
//!
//! In: changes of the right-hand side. Out: the integrator and the step ahead for the next step. It must not know a mechanism.
use crate::integrator::{Integrator, Statistics};
use crate::mechanism::motion::step_ahead::Lookahead;

/// Memory of the integration.
#[expect(clippy::large_enum_variant, reason = "a step allocates nothing, so there is no box")]
#[derive(Clone, Copy, Debug)]
pub enum Memory {
    /// No power is lost: the state is (sigma, sigma_dot).
    Conservative(Integrator<2>),
    /// The energy lost is integrated too, and steps may go on beyond the present.
    WithDissipation(Integrator<3>, Lookahead<3>),
}

impl Default for Memory {
    fn default() -> Self {
        Self::Conservative(Integrator::default())
    }
}

impl Memory {
    /// Integrate the energy lost or not: it counts in steps with loads that the state decides or with inputs that
    /// change.
    pub fn set_dissipation(&mut self, with_dissipation: bool) {
        match self {
            Self::Conservative(i) if with_dissipation => {
                *self = Self::WithDissipation(i.with_components(), Lookahead::default())
            }
            Self::WithDissipation(i, _) if !with_dissipation => *self = Self::Conservative(i.with_components()),
            _ => {}
        }
    }

    /// Counts of the integration's work since the start.
    pub fn statistics(&self) -> Statistics {
        match self {
            Self::Conservative(i) => i.statistics(),
            Self::WithDissipation(i, _) => i.statistics(),
        }
    }

    /// Become the same as another one; copies no more than that one is.
    pub fn copy_from(&mut self, other: &Self) {
        match (self, other) {
            (Self::Conservative(own), Self::Conservative(other)) => own.copy_from(other),
            (Self::WithDissipation(own, own_ahead), Self::WithDissipation(other, other_ahead)) => {
                own.copy_from(other);
                own_ahead.copy_from(other_ahead);
            }
            (own, other) => *own = *other,
        }
    }

    /// Clear all but the statistics.
    pub fn restart(&mut self) {
        match self {
            Self::Conservative(i) => i.restart(),
            Self::WithDissipation(i, ahead) => {
                i.restart();
                ahead.invalidate();
            }
        }
    }

    /// sigma is counted from another revolution.
    pub fn recount(&mut self) {
        if let Self::WithDissipation(i, ahead) = self
            && ahead.step_ahead.take().is_some()
        {
            i.branch_off();
        }
    }

    /// The right-hand side has changed.
    pub fn refresh(&mut self) {
        match self {
            Self::Conservative(i) => i.refresh(),
            Self::WithDissipation(i, ahead) => {
                if ahead.invalidate() {
                    i.branch_off();
                }
                i.refresh();
            }
        }
    }
}
