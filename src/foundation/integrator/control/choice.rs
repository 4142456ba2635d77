//! The method of the next step, and spans that are short compared with the motion.
use super::inverse_root::inverse_root;
use super::memory::{Begin, Integrator};
use super::sizes::{GROW_MOST, LONGEST, SHRINK_INFINITE};
use crate::integrator::pair::{Outcome, Pair};
use crate::integrator::{Method, System};

/// Smallest ratio of the proposed step of the pair of order 8 to a span for RK4.
const RK4_BELOW: f64 = 4.0;
/// Smallest such ratio for DOPRI5.
const DOPRI5_BELOW: f64 = 1.5;
/// Smallest ratio of the proposed step to a span for a step beyond the span. A step with its interpolant costs about as
/// much as this number of short steps.
const BEYOND: f64 = 3.0;
/// Largest ratio of a step beyond a span to that span. With this ratio, the cost of a step is negligible. Without a
/// limit, steps would grow without bound where no force acts.
const FARTHEST: f64 = 1e4;

impl<const N: usize> Integrator<N> {
    /// Method of the next step, for the remaining `span` [s] and the step size `wish` [s] proposed by the error
    /// control. The first method of the list that is applicable:
    /// - Radau IIA while stiffness limits explicit steps.
    /// - RK4 over spans at least 4 times shorter than the proposed step, up to the longest span that met its share of
    ///   the tolerance: 4 evaluations instead of 8 or 12.
    /// - RKN8(6) if the force does not depend on the speed: 8 evaluations instead of 12, little more than DOPRI5.
    /// - DOPRI5 over spans at least 1.5 times shorter, with the same condition: 6 evaluations instead of 12.
    /// - DOP853.
    #[inline]
    pub(super) fn choose<S: System<N>>(&self, span: f64, wish: f64) -> Method {
        let suits = |method: Method, ratio: f64| span < self.longest_span[method as usize] && ratio * span <= wish;
        if S::CAN_BE_STIFF && self.stiffness.implicit {
            Method::Radau
        } else if suits(Method::Rk4, RK4_BELOW) {
            Method::Rk4
        } else if S::SECOND_ORDER {
            Method::Rkn86
        } else if suits(Method::Dopri5, DOPRI5_BELOW) {
            Method::Dopri5
        } else {
            Method::Dop853
        }
    }

    /// Whether a step should extend beyond the end of a span, because it would otherwise be much shorter than possible.
    /// Only for explicit steps, because the interpolant of an implicit step is less accurate than the step.
    pub fn outlasts(&self, span: f64) -> bool {
        !self.stiffness.implicit && self.proposal.is_some_and(|h| h > BEYOND * span)
    }

    /// Size of the next step [s], which may be shortened to `wanted` [s]: not so much that RK4 would be chosen, whose
    /// interpolant is less accurate than the step. None if the step is not to be shortened.
    pub fn shortened(&self, wanted: f64) -> Option<f64> {
        let proposal = self.proposal.filter(|_| !self.stiffness.implicit)?;
        Some(wanted.max(proposal * (1.01 / RK4_BELOW))).filter(|h| *h < proposal)
    }

    /// Latest end of a step from t that extends beyond the end of a span.
    pub fn farthest(t: f64, end: f64) -> f64 {
        t + FARTHEST * (end - t)
    }

    /// Whether the error of a step of a cheap pair over the whole span is within its share of the tolerance. If not,
    /// the longest span of the pair is reduced.
    #[inline]
    pub(super) fn is_good<P: Pair<N>, S: System<N>>(
        &mut self,
        system: &mut S,
        begin: &Begin<N>,
        outcome: &Outcome<P, N>,
        tolerance: f64,
    ) -> bool {
        let &Begin { rest: h, ref scale, wish, .. } = begin;
        self.statistics.evaluations += P::EVALUATIONS;
        let error = outcome.stages.error::<S>(h, scale, tolerance);
        let longest = || h * inverse_root(error, P::ERROR_POWER);
        if error.is_nan() || error > 1.0 || !system.admits(&outcome.end) {
            // At least a part of the span, and more than 0: the pair is tried again after some steps of more expensive
            // methods.
            let shorter = if error.is_finite() { longest().clamp(SHRINK_INFINITE * h, h) } else { SHRINK_INFINITE * h };
            self.longest_span[P::METHOD as usize] = shorter.max(f64::MIN_POSITIVE);
            self.statistics.rejected += 1;
            return false;
        }
        if P::METHOD == Method::Dopri5 {
            // Spans for DOPRI5 are little shorter than the proposed step, which the error of DOPRI5 can lengthen.
            self.proposal = Some(wish.max(longest().min(GROW_MOST * h)).min(LONGEST));
        }
        self.last = None;
        self.after_explicit::<P, S>();
        true
    }
}
