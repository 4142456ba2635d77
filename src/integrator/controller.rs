//! Step sizes and the choice of the method.
//!
//! Source: Hairer, Norsett, Wanner, Solving ODEs I (1993), II.4 (step-size control); Hairer, Wanner, Solving ODEs II (1996),
//! IV.2 (detecting stiffness), IV.8 (Radau, step sizes).
mod short;

use super::linear::largest_eigenvalue;
use super::pair::{Dop853, Outcome, Pair, Rkn86};
use super::radau::{Before, Start};
use super::reach::reach;
use super::starting::starting_step;
use super::step::{Stages, Step, Trial};
use super::stiffness::Stiffness;
use super::{Dense, IntegrationError, Method, Statistics, System, dop853, dopri5, radau, rk4, rkn86};
use crate::codec::record::{Damaged, Record};

/// Limits of the step-size control as in DOP853; its safety factor is 0.9, at which the retraction at tolerance 1e-12 takes
/// a quarter more evaluations, in rejected steps.
const SAFETY: f64 = 0.8;
const SHRINK_MOST: f64 = 1.0 / 3.0;
const GROW_MOST: f64 = 6.0;
/// Shrinking where the error is not finite.
const SHRINK_INFINITE: f64 = 0.1;
/// Shrinking where Newton's method does not converge.
const SHRINK_UNSOLVED: f64 = 0.25;
/// What each step of a dearer method adds to the spans at which RK4 and the pair of order 5 are tried again.
const SHORT_AGAIN: f64 = 1.01;
/// A step that could have been so many times as large tells nothing of how the error grows.
const LARGEST_REACH: f64 = 10.0;
/// A step below this part of the span cannot be told from round-off in time; of a span longer than [`LONG`], of that: whoever
/// asks for a very long span counts on rest.
const SMALLEST: f64 = 1e-14;
const LONG: f64 = 1e3;

/// What a step starts with.
struct Begin<const N: usize> {
    /// Start since the start of the span [s].
    t: f64,
    /// f at the start.
    first: [f64; N],
    /// Time to the end of the span [s].
    rest: f64,
    /// Sizes of the components.
    scale: [f64; N],
    /// Step size that the error control proposes [s].
    wish: f64,
}

/// Memory of the integration between spans: proposed step size, last derivative, compensation of the sums, and what the
/// choice of the method goes by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Integrator<const N: usize> {
    /// Step size that the error control proposes next [s]; none before the first step.
    proposal: Option<f64>,
    /// Derivative at the present point, while it is valid.
    derivative: Option<[f64; N]>,
    /// What the last sums lost to rounding, component by component.
    carry: [f64; N],
    stiffness: Stiffness,
    /// Span up to which one step of RK4 has met its share of the tolerance, as far as is known [s].
    short: f64,
    /// The same for the pair of order 5 [s].
    middle: f64,
    /// Size [s] of the last step, and by which factor it could just have been larger, if it was explicit and that is known.
    last: Option<(f64, f64)>,
    /// The last step, if it was one of Radau.
    before: Option<Before<N>>,
    method: Method,
    statistics: Statistics,
}

impl<const N: usize> Default for Integrator<N> {
    fn default() -> Self {
        Self {
            proposal: None,
            derivative: None,
            carry: [0.0; N],
            stiffness: Stiffness::default(),
            short: f64::INFINITY,
            middle: f64::INFINITY,
            last: None,
            before: None,
            method: Method::default(),
            statistics: Statistics::default(),
        }
    }
}

impl<const N: usize> Integrator<N> {
    /// Work done so far.
    pub fn statistics(&self) -> Statistics {
        self.statistics
    }

    /// All fields, written or read.
    ///
    /// # Errors
    /// A field is read that no integration leaves.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        record.option("proposed step", &mut self.proposal, || 0.0, |record, h| record.positive("proposed step", h))?;
        let blank = || [0.0; N];
        record.option("derivative", &mut self.derivative, blank, |record, f| record.all_finite("derivative", f))?;
        record.all_finite("compensation", &mut self.carry)?;
        self.stiffness.record(record)?;
        record.number("longest short step", &mut self.short, |h| h > 0.0, "a number > 0")?;
        record.number("longest step of order 5", &mut self.middle, |h| h > 0.0, "a number > 0")?;
        record.option(
            "last explicit step",
            &mut self.last,
            || (0.0, 0.0),
            |record, (h, error)| {
                record.positive("size of the last step", h)?;
                record.positive("error of the last step", error)
            },
        )?;
        record.option("last implicit step", &mut self.before, Before::blank, |record, before| before.record(record))?;
        self.method.record(record)?;
        self.statistics.record(record)
    }

    /// Become the same as another one: as by assignment, but the stages of an implicit step, more than all the rest, are
    /// copied only if there are some.
    #[inline]
    pub fn copy_from(&mut self, other: &Self) {
        let Self { proposal, derivative, carry, stiffness, short, middle, last, before, method, statistics } = self;
        (*proposal, *derivative, *carry, *stiffness) = (other.proposal, other.derivative, other.carry, other.stiffness);
        (*short, *middle, *last, *method, *statistics) =
            (other.short, other.middle, other.last, other.method, other.statistics);
        if before.is_some() || other.before.is_some() {
            *before = other.before;
        }
    }

    /// The method of the last step.
    pub fn method(&self) -> Method {
        self.method
    }

    /// The right-hand side has changed (new inputs): forget the last derivative, keep the step size.
    pub fn refresh(&mut self) {
        self.derivative = None;
        self.last = None;
    }

    /// Go on from a state on the interpolant of the last step.
    pub fn branch_off(&mut self) {
        self.refresh();
        self.carry = [0.0; N];
    }

    /// The state or the right-hand side has jumped: forget everything but the statistics.
    pub fn restart(&mut self) {
        *self = Self { statistics: self.statistics, method: self.method, ..Self::default() };
    }

    /// The same memory for a system with another number of components: step sizes and statistics are kept.
    pub fn with_components<const M: usize>(&self) -> Integrator<M> {
        Integrator {
            proposal: self.proposal,
            short: self.short,
            middle: self.middle,
            method: self.method,
            statistics: self.statistics,
            ..Integrator::default()
        }
    }

    /// Advance `y` by exactly `span` > 0 [s].
    ///
    /// # Errors
    /// [`IntegrationError::StepTooSmall`]; `y` and the memory are then those of the last accepted step.
    pub fn advance<S: System<N>>(
        &mut self,
        system: &mut S,
        y: &mut [f64; N],
        span: f64,
        tolerance: f64,
    ) -> Result<(), IntegrationError> {
        let mut t = 0.0;
        while t < span {
            let begin = self.begin(system, t, y, span, tolerance);
            if let Some(end) = self.short_step(system, y, &begin, tolerance) {
                *y = end;
                break;
            }
            if let Some(step) = self.middle_step(system, y, &begin, tolerance) {
                *y = step.end;
                break;
            }
            let step = self.long_step(system, y, &begin, span, tolerance)?;
            *y = step.end;
            t += step.h;
            if step.reached {
                break;
            }
        }
        Ok(())
    }

    /// One accepted step from (t, y) towards `end`, not past it; the step that reaches it ends there exactly.
    ///
    /// # Errors
    /// [`IntegrationError::StepTooSmall`].
    pub fn step<S: System<N>>(
        &mut self,
        system: &mut S,
        t: f64,
        y: &[f64; N],
        end: f64,
        tolerance: f64,
    ) -> Result<Step<N>, IntegrationError> {
        let begin = self.begin(system, t, y, end, tolerance);
        let carry = self.carry;
        if let Some(end) = self.short_step(system, y, &begin, tolerance) {
            let first = begin.first;
            let stages = Stages::Rk4(rk4::Slopes { first, last: self.derivative.unwrap_or(first) });
            return Ok(Step { t, h: begin.rest, reached: true, start: *y, end, carry, stages });
        }
        if let Some(step) = self.middle_step(system, y, &begin, tolerance) {
            return Ok(step);
        }
        self.long_step(system, y, &begin, end, tolerance)
    }

    /// What a step from (t, y) towards `end` starts with.
    #[inline(always)]
    fn begin<S: System<N>>(&mut self, system: &mut S, t: f64, y: &[f64; N], end: f64, tolerance: f64) -> Begin<N> {
        let first = match self.derivative {
            Some(f) => f,
            None => self.evaluate(system, t, y),
        };
        let rest = end - t;
        let scale = system.scale(y, &first);
        let wish = match self.proposal {
            Some(h) => h,
            None => starting_step(system, (t, y, &first), &scale, rest, tolerance, &mut self.statistics),
        };
        Begin { t, first, rest, scale, wish }
    }

    /// One accepted step of an explicit pair or of Radau.
    fn long_step<S: System<N>>(
        &mut self,
        system: &mut S,
        y: &[f64; N],
        begin: &Begin<N>,
        end: f64,
        tolerance: f64,
    ) -> Result<Step<N>, IntegrationError> {
        if begin.wish.is_nan() || begin.wish <= 0.0 {
            // Rates so large that the first step vanishes.
            return Err(IntegrationError::StepTooSmall { t: begin.t, step: begin.wish });
        }
        if S::CAN_BE_STIFF && self.stiffness.implicit {
            return self.implicit_step(system, y, begin, end, tolerance);
        }
        if S::SECOND_ORDER {
            self.explicit_step::<Rkn86, S>(system, y, begin, end, tolerance)
        } else {
            self.explicit_step::<Dop853, S>(system, y, begin, end, tolerance)
        }
    }

    /// [`Self::long_step`] by an explicit pair.
    #[inline]
    fn explicit_step<P: Pair<N>, S: System<N>>(
        &mut self,
        system: &mut S,
        y: &[f64; N],
        begin: &Begin<N>,
        end: f64,
        tolerance: f64,
    ) -> Result<Step<N>, IntegrationError> {
        let &Begin { t, ref first, rest, ref scale, mut wish } = begin;
        let mut grow_most = GROW_MOST;
        loop {
            let h = fitted(wish, rest);
            self.statistics.evaluations += P::EVALUATIONS;
            let outcome = P::attempt(system, t, y, first, h, &self.carry);
            let error = P::error(&outcome.stages, h, scale, tolerance);
            if error <= 1.0 {
                let mut grow = grow_most;
                self.short *= SHORT_AGAIN;
                self.middle *= SHORT_AGAIN;
                if S::CAN_BE_STIFF {
                    self.before = None;
                }
                // A step cut short by the end of the span is often so much shorter that no growth comes to the wish.
                if S::CAN_BE_STIFF || h >= wish || h * grow_most > wish {
                    let reach = reach(error, P::ERROR_POWER);
                    if S::CAN_BE_STIFF {
                        self.stiffness.explicit_step(h, P::stiffness(y, &outcome, h, scale), SAFETY * reach);
                    }
                    grow = (SAFETY * self.foreseen(h, reach)).clamp(SHRINK_MOST, grow_most);
                } else {
                    self.last = None;
                }
                let Outcome { stages, end, last, carry: lost } = outcome;
                let carry = std::mem::replace(&mut self.carry, lost);
                self.accept(P::METHOD, &last, h, wish, grow);
                return Ok(Step { t, h, reached: h == rest, start: *y, end, carry, stages: P::stages(stages) });
            }
            let grow = SAFETY * reach(error, P::ERROR_POWER);
            grow_most = 1.0;
            wish = self.reject(t, h, if error.is_finite() { grow.max(SHRINK_MOST) } else { SHRINK_INFINITE }, end)?;
        }
    }

    /// Growth at which the next step would just be good, after one of size h that could have grown by `reach`. Where the
    /// error per step has been growing, it is taken to go on so: Solving ODEs II (1996), IV.8, eq. (8.25).
    fn foreseen(&mut self, h: f64, reach: f64) -> f64 {
        let reach = reach.min(LARGEST_REACH);
        let last = self.last.replace((h, reach));
        last.map_or(reach, |(h_before, before)| reach.min(reach * (reach * (h / (h_before * before)))))
    }

    /// [`Self::long_step`] by Radau.
    fn implicit_step<S: System<N>>(
        &mut self,
        system: &mut S,
        y: &[f64; N],
        begin: &Begin<N>,
        end: f64,
        tolerance: f64,
    ) -> Result<Step<N>, IntegrationError> {
        let &Begin { t, ref first, rest, ref scale, mut wish } = begin;
        let jacobian = system.jacobian(t, y);
        self.statistics.jacobians += 1;
        self.last = None;
        let (carry, before) = (self.carry, self.before);
        let start =
            Start { t, y, first, jacobian: &jacobian, carry: &carry, before: before.as_ref(), scale, tolerance };
        let mut grow_most = GROW_MOST;
        loop {
            let h = fitted(wish, rest);
            let Some((mut trial, error)) = radau::attempt(system, &start, h, &mut self.statistics) else {
                grow_most = 1.0;
                wish = self.reject(t, h, SHRINK_UNSOLVED, end)?;
                continue;
            };
            let grow = SAFETY * reach(error, radau::ERROR_POWER);
            if error <= 1.0 {
                self.stiffness.implicit_step(h, largest_eigenvalue(&jacobian));
                self.statistics.implicit += 1;
                if let Stages::Radau(stages) = &trial.step.stages {
                    self.before = Some(Before::new(&trial.step, stages));
                }
                trial.step.reached = h == rest;
                self.carry = trial.carry;
                self.accept(Method::Radau, &trial.last, h, wish, grow.clamp(SHRINK_MOST, grow_most));
                return Ok(trial.step);
            }
            grow_most = 1.0;
            wish =
                self.reject(t, h, if error.is_finite() { grow.max(SHRINK_INFINITE) } else { SHRINK_INFINITE }, end)?;
        }
    }

    /// The step of exactly size h [s], 0 < h <= step.h, from the start of `step`, by its method and without error control;
    /// `step` is the last one made. The integration goes on from its end: as it is, or after [`Self::refresh`] or
    /// [`Self::restart`].
    pub fn retake<S: System<N>>(&mut self, system: &mut S, step: &Step<N>, h: f64) -> Step<N> {
        let trial = match &step.stages {
            Stages::Dop853(slopes) => {
                self.statistics.evaluations += dop853::tableau::STAGES as u64;
                let outcome = dop853::attempt(system, step.t, &step.start, &slopes[0], h, &step.carry);
                Trial::explicit::<Dop853>(step.t, &step.start, h, &step.carry, outcome)
            }
            Stages::Rkn86(accelerations) => {
                self.statistics.evaluations += rkn86::EVALUATIONS;
                let mut first = step.start;
                (first[0], first[1]) = (step.start[1], accelerations[0]);
                let outcome = rkn86::attempt(system, step.t, &step.start, &first, h, &step.carry);
                Trial::explicit::<Rkn86>(step.t, &step.start, h, &step.carry, outcome)
            }
            Stages::Dopri5(slopes) => {
                self.statistics.evaluations += dopri5::EVALUATIONS;
                let Outcome { stages, end, last, carry } =
                    dopri5::attempt(system, step.t, &step.start, &slopes[0], h, &step.carry);
                Trial { step: Step { h, reached: false, end, stages: Stages::Dopri5(stages), ..*step }, carry, last }
            }
            Stages::Rk4(slopes) => {
                self.statistics.evaluations += rk4::EVALUATIONS;
                let rk4::Outcome { end, carry, last, .. } =
                    rk4::attempt(system, step.t, &step.start, &slopes.first, h, &step.carry);
                let stages = Stages::Rk4(rk4::Slopes { first: slopes.first, last });
                Trial { step: Step { h, reached: false, end, stages, ..*step }, carry, last }
            }
            Stages::Radau(stages) => radau::shorten(system, step, stages, h, &mut self.statistics),
        };
        if let Stages::Radau(stages) = &trial.step.stages {
            self.before = Some(Before::new(&trial.step, stages));
        }
        self.derivative = Some(trial.last);
        self.carry = trial.carry;
        trial.step
    }

    /// [`Step::dense`], its evaluations counted.
    pub fn dense<S: System<N>>(&mut self, system: &mut S, step: &Step<N>) -> Dense<N> {
        self.statistics.evaluations += step.dense_evaluations();
        step.dense(system)
    }

    /// Go on from the end of a step of size h, where f is `last`, which was wished to have the size `wish` and could grow
    /// by `grow`.
    #[inline]
    fn accept(&mut self, method: Method, last: &[f64; N], h: f64, wish: f64, grow: f64) {
        // A step cut short by the end of the span says little about the size that is possible.
        self.proposal = Some(if h < wish { (h * grow).max(wish) } else { h * grow });
        self.derivative = Some(*last);
        self.method = method;
        self.statistics.accepted += 1;
        self.statistics.nystroem += u64::from(method == Method::Rkn86);
    }

    /// The next size to try after one that was too large.
    fn reject(&mut self, t: f64, h: f64, shrink: f64, end: f64) -> Result<f64, IntegrationError> {
        self.statistics.rejected += 1;
        let wish = h * shrink;
        let smallest = SMALLEST * end.abs().min(LONG);
        if wish < smallest { Err(IntegrationError::StepTooSmall { t, step: wish }) } else { Ok(wish) }
    }

    fn evaluate<S: System<N>>(&mut self, system: &mut S, t: f64, y: &[f64; N]) -> [f64; N] {
        self.statistics.evaluations += 1;
        system.derivative(t, y)
    }
}

/// Fit the rest of the span: one step if it nearly reaches, two equal ones rather than a long and a tiny one.
fn fitted(wish: f64, rest: f64) -> f64 {
    if wish * 1.01 >= rest {
        rest
    } else if wish * 2.0 > rest {
        0.5 * rest
    } else {
        wish
    }
}
