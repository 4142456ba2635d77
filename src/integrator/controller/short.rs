//! Spans that are short against the motion: by cheaper methods, or by a step that goes on beyond.
use super::{Begin, GROW_MOST, Integrator, SHORT_AGAIN, SHRINK_INFINITE};
use crate::integrator::pair::Outcome;
use crate::integrator::reach::reach;
use crate::integrator::step::{Stages, Step};
use crate::integrator::{Method, System, dopri5, rk4};

/// A span this many times shorter than the step that DOP853 would take may be one for RK4.
const SHORT: f64 = 4.0;
/// A span this many times shorter may be one for the pair of order 5.
const MIDDLE: f64 = 1.5;
/// A span this many times shorter than the next step may be one to go beyond: a step with its interpolant costs so many of
/// those that end at the span.
const BEYOND: f64 = 3.0;

impl<const N: usize> Integrator<N> {
    /// Whether a step should be let go on beyond the end of a span, as it would be cut much shorter than possible otherwise; only
    /// explicit ones, as the interpolants of others are less exact than they.
    pub fn outlasts(&self, span: f64) -> bool {
        !self.stiffness.implicit && self.proposal.is_some_and(|h| h > BEYOND * span)
    }

    /// The end of the span by one step of RK4, if it is short enough for that.
    #[inline]
    pub(super) fn short_step<S: System<N>>(
        &mut self,
        system: &mut S,
        y: &[f64; N],
        begin: &Begin<N>,
        tolerance: f64,
    ) -> Option<[f64; N]> {
        let &Begin { t, ref first, rest: h, ref scale, wish } = begin;
        if h > self.short || h * SHORT > wish || S::CAN_BE_STIFF && self.stiffness.implicit {
            return None;
        }
        let outcome = rk4::attempt(system, t, y, first, h, &self.carry);
        self.statistics.evaluations += rk4::EVALUATIONS;
        if let Err(reach) = rk4::judge(h, &outcome, scale, tolerance) {
            self.short = reach;
            self.statistics.rejected += 1;
            return None;
        }
        self.arrive::<S>(Method::Rk4, outcome.last, outcome.carry);
        self.statistics.short += 1;
        Some(outcome.end)
    }

    /// Go on from the end of a span, reached by a method whose step sizes are not controlled, where f is `last` and the sums
    /// have lost `carry`.
    #[inline]
    fn arrive<S: System<N>>(&mut self, method: Method, last: [f64; N], carry: [f64; N]) {
        (self.derivative, self.carry, self.last, self.method) = (Some(last), carry, None, method);
        if S::CAN_BE_STIFF {
            self.before = None;
        }
        self.statistics.accepted += 1;
    }

    /// A step to the end of the span by the pair of order 5, if the span is one step of DOP853 and short enough: half the
    /// evaluations. The Nystroem pair has few enough.
    #[inline]
    pub(super) fn middle_step<S: System<N>>(
        &mut self,
        system: &mut S,
        y: &[f64; N],
        begin: &Begin<N>,
        tolerance: f64,
    ) -> Option<Step<N>> {
        let &Begin { t, ref first, rest: h, ref scale, wish } = begin;
        if S::SECOND_ORDER || h > self.middle || h * MIDDLE > wish || S::CAN_BE_STIFF && self.stiffness.implicit {
            return None;
        }
        let carry = self.carry;
        let Outcome { stages, end, last, carry: lost } = dopri5::attempt(system, t, y, first, h, &carry);
        self.statistics.evaluations += dopri5::EVALUATIONS;
        let error = dopri5::error(&stages, h, scale, tolerance);
        let reach = h * if error.is_finite() { reach(error, dopri5::ERROR_POWER) } else { SHRINK_INFINITE };
        if error.is_nan() || error > 1.0 {
            self.middle = reach;
            self.statistics.rejected += 1;
            return None;
        }
        self.proposal = Some(wish.max(reach.min(GROW_MOST * h)));
        self.arrive::<S>(Method::Dopri5, last, lost);
        self.short *= SHORT_AGAIN;
        self.statistics.fifth += 1;
        Some(Step { t, h, reached: true, start: *y, end, carry, stages: Stages::Dopri5(stages) })
    }
}
