//! Passages of borders in the space of states, at which the right-hand side is less smooth than elsewhere: ends of gaps
//! of the table of friction, kinks of the laws that size loads, borders of hydraulic laws.
//!
//! In: two states of a step, its interpolant. Out: how far a state is beyond a border, where it is passed. It must not
//! know what follows.
use super::REGIME_TOLERANCE;
use crate::integrator::{Dense, Step};
use crate::mechanism::dynamics::equation::EquationOfMotion;
use crate::mechanism::dynamics::hydraulic::{BORDERS, DRIVEN};
use crate::mechanism::dynamics::network::NETWORKED;
use crate::mechanism::reduced::StateLoads;
use crate::numerics::bracket::false_position;
use std::ops::Range;

impl EquationOfMotion<'_> {
    /// Number of borders.
    #[inline(always)]
    pub fn borders<const N: usize>(&self) -> usize {
        let own = self.deciding::<N>().map_or(0, StateLoads::borders);
        match &self.network {
            Some(network) if N == NETWORKED => own + network.borders(),
            _ if N == DRIVEN => own + BORDERS,
            _ => own,
        }
    }

    /// Borders none of which is passed between two states (t, z) of a step, as bounds show. It may be others, too.
    #[inline]
    pub fn distant_borders<const N: usize>(&self, states: [(f64, &[f64; N]); 2]) -> Range<usize> {
        match self.deciding::<N>().filter(|state_loads| state_loads.edges > 0) {
            Some(state_loads) if self.faces_alike(states.map(|(t, z)| [t, z[0], z[1]])) => {
                let gaps = state_loads.gap_borders();
                gaps..gaps + state_loads.edges
            }
            _ => 0..0,
        }
    }

    /// Whether a border is a kink of the law that sizes a load.
    pub fn is_kink(&self, border: usize) -> bool {
        let is_kink = |own: &StateLoads| border.checked_sub(own.gap_borders()).is_some_and(|k| k < own.kinks.len());
        self.state_loads.is_some_and(is_kink)
    }

    /// How far a state is beyond a border at the time t of the span [s]; 0 where there is none.
    pub fn beyond_border<const N: usize>(&self, border: usize, t: f64, z: &[f64; N]) -> f64 {
        let gaps = self.deciding::<N>().map_or(0, StateLoads::gap_borders);
        let Some(border) = border.checked_sub(gaps) else {
            let (reduced, state_loads) = self.stretch_at(z[0]);
            return state_loads.map_or(0.0, |state_loads| state_loads.beyond_gap(border, z[0], reduced.period()));
        };
        let kinks = self.deciding::<N>().map_or(&[][..], |state_loads| &state_loads.kinks);
        if let Some(kink) = kinks.get(border) {
            return self.beyond_kink(kink, [t, z[0], z[1]]);
        }
        let border = border - kinks.len();
        if N == NETWORKED {
            return self.beyond_border_of_network(border, z).unwrap_or(0.0);
        }
        z.first_chunk().and_then(|z| self.beyond_border_of_circuit(border, z)).unwrap_or(0.0)
    }
}

/// Whether a border is passed between the ends of a step.
pub(super) fn passes_border<const N: usize>(dynamics: &EquationOfMotion<'_>, border: usize, step: &Step<N>) -> bool {
    let both = [(step.t, &step.start), (step.t + step.h, &step.end)];
    let [before, after] = both.map(|(t, z)| dynamics.beyond_border(border, t, z));
    before * after < 0.0
}

/// Part of a step after which a border is passed, if it is between the ends: where a state is at it, or else located as
/// a change of regime.
#[cold]
pub(super) fn passage_of_border<const N: usize>(
    dynamics: &EquationOfMotion<'_>,
    border: usize,
    step: &Step<N>,
    dense: &Dense<N>,
) -> Option<f64> {
    let beyond = |part: f64| dynamics.beyond_border(border, step.t + part * step.h, &dense.at(part));
    if !passes_border(dynamics, border, step) {
        return None;
    }
    let [before, after] = [0.0, 1.0].map(beyond);
    let mut there = None;
    let excess = |part: f64| {
        if there.is_none() {
            match beyond(part) * after.signum() {
                0.0 => there = Some(part),
                excess => return excess,
            }
        }
        1.0
    };
    let passed = false_position(excess, (0.0, before * after.signum()), (1.0, after.abs()), REGIME_TOLERANCE);
    there.or(Some(passed))
}
