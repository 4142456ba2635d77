//! Passages of the levels at which locks change.
//!
//! In: a step, its interpolant. Out: whether a level may be passed within the step, and where. It must not know what a
//! level stands for.
use super::towards;
use crate::integrator::{Dense, Step};
use crate::mechanism::dynamics::equation::EquationOfMotion;
use crate::mechanism::dynamics::network::NETWORKED;

impl EquationOfMotion<'_> {
    /// Number of levels of components of the state at which locks change.
    #[inline(always)]
    pub fn levels<const N: usize>(&self) -> usize {
        if N == NETWORKED { self.pressure_locks() } else { 0 }
    }
}

/// Whether a level may be passed within a step.
#[inline]
pub fn may_pass_level<const N: usize>(dynamics: &EquationOfMotion<'_>, level: usize, step: &Step<N>) -> bool {
    dynamics.level_of_network(level, &step.start).is_some_and(|level| {
        let [start, end] = [&step.start, &step.end].map(|z| level.excess(z));
        end >= 0.0 || start.max(end) + step.bulge(level.component) > 0.0
    })
}

/// The part of a step after which a level is passed.
pub fn passage_of_level<const N: usize>(
    dynamics: &EquationOfMotion<'_>,
    level: usize,
    dense: &Dense<N>,
) -> Option<f64> {
    let level = dynamics.level_of_network(level, &dense.at(0.0))?;
    dense.first_passage(level.component, level.value, towards(level.sign), false)
}
