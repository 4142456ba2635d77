//! Passages of the levels at which locks change.
//!
//! In: a step, its interpolant. Out: whether a level may be passed within the step, and where the first one is. It must
//! not know what a level stands for.
use super::towards;
use crate::integrator::{Dense, Step};
use crate::mechanism::motion::dynamics::Dynamics;

/// Whether a level may be passed within a step.
#[inline]
pub fn may_pass_level<D: Dynamics<N>, const N: usize>(dynamics: &D, step: &Step<N>) -> bool {
    (0..dynamics.levels()).filter_map(|index| dynamics.level(index, &step.start)).any(|level| {
        let [start, end] = [&step.start, &step.end].map(|z| level.excess(z));
        end >= 0.0 || start.max(end) + step.bulge(level.component) > 0.0
    })
}

/// The part of a step after which the first level is passed, and the index of this level.
pub fn first_level<D: Dynamics<N>, const N: usize>(dynamics: &D, dense: &Dense<N>) -> Option<(f64, usize)> {
    let start = dense.at(0.0);
    let passage = |index: usize| {
        let level = dynamics.level(index, &start)?;
        Some((dense.first_passage(level.component, level.value, towards(level.sign), false)?, index))
    };
    (0..dynamics.levels()).filter_map(passage).min_by(|one, other| one.0.total_cmp(&other.0))
}
