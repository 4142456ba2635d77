//! The method of the next step, and spans that are short against the motion.
use super::inverse_root::inverse_root;
use super::memory::{Begin, Integrator};
use super::sizes::{GROW_MOST, LONGEST, SHRINK_INFINITE};
use crate::integrator::pair::{Outcome, Pair};
use crate::integrator::{Method, System};

/// Least ratio of the proposed step of the pair of order 8 to a span for RK4.
const RK4_BELOW: f64 = 4.0;
/// The same for DOPRI5.
const DOPRI5_BELOW: f64 = 1.5;
/// Least ratio of the proposed step to a span that a step may go beyond: a step with its interpolant costs about as
/// many short steps.
const BEYOND: f64 = 3.0;
/// Largest ratio of a step that goes beyond a span to that span: its cost then counts for nothing, and where nothing
/// acts steps would grow without bound.
const FARTHEST: f64 = 1e4;

impl<const N: usize> Integrator<N> {
    /// Method of the next step, with `span` [s] to go and a step size `wish` [s] that the error control proposes; the
    /// first that suits:
    /// - Radau IIA while stiffness holds explicit steps back.
    /// - RK4 over spans at least 4 times shorter than the proposed step, up to the longest that met its share of the
    ///   tolerance: 4 evaluations instead of 8 or 12.
    /// - RKN8(6) where the force does not depend on the speed: 8 evaluations instead of 12, little more than DOPRI5.
    /// - DOPRI5 over spans at least 1.5 times shorter, likewise: 6 evaluations instead of 12.
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

    /// Whether a step should be let go on beyond the end of a span, as it would be cut much shorter than possible
    /// otherwise; only explicit ones, as the interpolants of others are less exact than they.
    pub fn outlasts(&self, span: f64) -> bool {
        !self.stiffness.implicit && self.proposal.is_some_and(|h| h > BEYOND * span)
    }

    /// Where a step from t that goes on beyond the end of a span ends at the latest.
    pub fn farthest(t: f64, end: f64) -> f64 {
        t + FARTHEST * (end - t)
    }

    /// Whether a step of a cheap pair over the whole span errs no more than its share; if it does, that shortens the
    /// longest span of the pair.
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
            // At least a part of the span, and more than 0: the pair is tried again after some steps of dearer ones.
            let shorter = if error.is_finite() { longest().clamp(SHRINK_INFINITE * h, h) } else { SHRINK_INFINITE * h };
            self.longest_span[P::METHOD as usize] = shorter.max(f64::MIN_POSITIVE);
            self.statistics.rejected += 1;
            return false;
        }
        if P::METHOD == Method::Dopri5 {
            // Its spans are little shorter than the wish, which its error can lengthen.
            self.proposal = Some(wish.max(longest().min(GROW_MOST * h)).min(LONGEST));
        }
        self.last = None;
        self.after_explicit::<P, S>();
        true
    }
}
