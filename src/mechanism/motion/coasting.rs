//! Long motions without losses: they are periodic, so that whole periods take no steps.
//!
//! In: a motion under loads that only the position decides, a span. Out: the state at the end of the span, and the
//! revolutions passed over. Under such loads the kinetic energy sigma_dot^2 / 2 follows from sigma, so a motion that
//! returns to a position in the same direction repeats itself: an oscillation between two dead points does, and a
//! rotation if no load does net work over a revolution. One period is integrated at a tight tolerance and its end
//! located to the last digit; then whole periods are passed over, and the state is exactly that at their start. It must
//! not know loads.
use crate::integrator::{Integrator, Step};
use crate::mechanism::dynamics::equation::EquationOfMotion;
use crate::mechanism::motion::advance::{Advance, Progress, Stopped};
use crate::mechanism::motion::contact::{Contact, Ends};
use crate::mechanism::motion::step_ahead::Lookahead;
use crate::mechanism::motion::witness::Witness;

/// Steps within one span before a period is looked for, and most steps of that search. A vain search doubles both.
const PATIENCE: u64 = 256;
/// Relative tolerance of the integration over the period, whose error counts once for every period passed over.
const TOLERANCE: f64 = 1e-13;
/// Relative difference of the speeds at both ends of a period that is due to the integration.
const SAME_SPEED: f64 = 1e-9;
/// Most periods passed over in one span; the phase is then still known to some 1e-4 of a period.
const MOST_PERIODS: f64 = 1e9;
/// Most corrections of the time at which a period ends: Newton's method from a linear guess within one step.
const CORRECTIONS: usize = 12;
/// Relative rounding of time and position at which the corrections end.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// A motion under loads that only the position decides.
pub struct Coasting<'a, 'e, P, L> {
    pub dynamics: &'a mut EquationOfMotion<'e>,
    pub integrator: &'a mut Integrator<2>,
    /// The step that goes on beyond the present, if one does.
    pub lookahead: &'a mut Lookahead<2>,
    pub ends: &'a Ends<'a>,
    pub contact: &'a mut Contact,
    pub witness: &'a mut Witness,
    pub tolerance: f64,
    /// Whether a sigma is beyond an end of an open curve.
    pub passes: P,
    /// The path of the motion; asked of after many steps only.
    pub path: L,
}

/// The curve along which a motion may come back to its position.
pub struct Path {
    /// Length of a closed curve.
    pub length: Option<f64>,
    /// Whether a load does net work over a revolution of a closed curve.
    pub does_work: bool,
}

/// Return of a motion to its position and speed.
struct Period {
    /// Time until the return [s].
    time: f64,
    /// Revolutions made until then.
    revolutions: f64,
}

impl<P: Fn(f64) -> bool, L: Fn() -> Path> Coasting<'_, '_, P, L> {
    /// Advance y = (sigma, sigma_dot) by exactly `span` [s], or until the integration has tried `most` steps since its
    /// start. Returns the energy lost in impacts [J]. Revolutions that sigma does not count are added to `passed`.
    ///
    /// # Errors
    /// [`Stopped`].
    #[inline(always)]
    pub fn run(&mut self, y: &mut [f64; 2], span: f64, most: u64, passed: &mut f64) -> Result<f64, Stopped> {
        let first = most.min(self.integrator.attempts() + PATIENCE);
        match self.advance(y, span, Progress::within(first)) {
            Ok(lost) => Ok(lost),
            Err(Stopped::Budget(progress)) if first < most => self.run_long(y, span, (progress, most), passed),
            ended => ended,
        }
    }

    /// Advance from the state and time in `progress`, up to the end of the span or of the work allowed there.
    #[inline(always)]
    fn advance(&mut self, y: &mut [f64; 2], span: f64, progress: Progress) -> Result<f64, Stopped> {
        let Self { dynamics, integrator, lookahead, ends, contact, witness, tolerance, .. } = self;
        let tolerance = *tolerance;
        if ends.travel.is_empty() && !lookahead.counts() && !witness.pauses.at_steps && !dynamics.whole.has_knots() {
            let most = progress.work.most.saturating_sub(progress.work.extra);
            let mut t = progress.t;
            let whole = integrator.advance_from(*dynamics, &mut t, y, span, tolerance, most);
            let is_whole = whole.map_err(Stopped::Integration)?;
            let mut reached = progress;
            reached.t = t;
            return if is_whole { Ok(0.0) } else { Err(Stopped::Budget(reached)) };
        }
        let ends = **ends;
        Advance { dynamics, integrator, lookahead, ends, contact, witness, tolerance, progress }.run(y, span)
    }

    /// [`Self::run`] after many steps: pass over whole periods if the motion has one.
    #[cold]
    fn run_long(
        &mut self,
        y: &mut [f64; 2],
        span: f64,
        (mut progress, most): (Progress, u64),
        passed: &mut f64,
    ) -> Result<f64, Stopped> {
        let (mut patience, mut speed) = (PATIENCE, 0.0);
        loop {
            // At the largest speed the return is located best.
            let is_rising = y[1].abs() > speed;
            speed = y[1].abs();
            if !is_rising {
                let rest = span - progress.t;
                let spent = self.integrator.attempts() + progress.work.extra;
                let effort = patience.min(most.saturating_sub(spent));
                if let Some(Period { time, revolutions }) = self.period(y, effort) {
                    let count = (rest / time).floor().min(MOST_PERIODS);
                    progress.t = span - (-count).mul_add(time, rest).max(0.0);
                    *passed += count * revolutions;
                    self.integrator.branch_off();
                    progress.work.most = most;
                    return self.advance(y, span, progress);
                }
                (patience, speed) = (2 * patience, 0.0);
            }
            let spent = self.integrator.attempts() + progress.work.extra;
            progress.work.most = most.min(spent + if is_rising { 1 } else { patience });
            match self.advance(y, span, progress) {
                Err(Stopped::Budget(later)) if later.work.most < most => progress = later,
                ended => return ended,
            }
        }
    }

    /// The period of a motion from this state, if it has one that takes at most so many steps and touches no end of the
    /// travel or of an open curve.
    fn period(&mut self, start: &[f64; 2], effort: u64) -> Option<Period> {
        let direction = start[1].signum();
        let Path { length, does_work } = (self.path)();
        let unlimited = self.ends.travel.is_empty();
        let revolution = length.filter(|_| unlimited && !does_work);
        let farthest = length.unwrap_or(f64::INFINITY);
        let returns = [Some((start[0], 0.0)), revolution.map(|length| (start[0] + direction * length, direction))];
        let limits = [0, 1].map(|side| self.ends.rigid(side));
        let mut integrator = Integrator::default();
        let (mut t, mut y) = (0.0, *start);
        let mut found = None;
        while start[1] != 0.0 && found.is_none() && integrator.attempts() < effort {
            let Ok(mut step) = integrator.step(self.dynamics, t, &y, f64::INFINITY, TOLERANCE) else { break };
            let way = (step.end[0] - step.start[0]).signum();
            let reduced = self.dynamics.whole;
            let knot = if reduced.has_knots() { reduced.next_knot(step.start[0], way) } else { None };
            let knot = knot.filter(|knot| (step.end[0] - knot) * way > 0.0);
            if let Some(knot) = knot {
                let Some(shorter) = self.arrive_at(&mut integrator, &step, knot) else { break };
                step = shorter;
            }
            let [low, high] = [step.start[0].min(step.end[0]), step.start[0].max(step.end[0])];
            let bulge = step.bulge(0);
            let (low, high) = (low - bulge, high + bulge);
            if limits[0].is_some_and(|end| low <= end) || limits[1].is_some_and(|end| high >= end) {
                break;
            }
            if (self.passes)(low) || (self.passes)(high) {
                break;
            }
            let is_passed = |target: f64| {
                let [before, after] = [step.start[0], step.end[0]].map(|sigma| (sigma - target) * direction);
                before < 0.0 && after >= 0.0 && step.end[1] * direction > 0.0
            };
            if let Some((target, revolutions)) = returns.into_iter().flatten().find(|(target, _)| is_passed(*target)) {
                let Some(last) = self.arrive_at(&mut integrator, &step, target) else { break };
                if (last.end[1] - start[1]).abs() <= SAME_SPEED * start[1].abs() {
                    found = Some(Period { time: t + last.h, revolutions });
                }
                break;
            }
            (t, y) = (t + step.h, step.end);
            if (y[0] - start[0]).abs() > farthest {
                // Spun by loads that do work, it is not soon to return.
                break;
            }
        }
        self.integrator.count(&integrator);
        found
    }

    /// The last step taken again, to end where sigma is `target`.
    fn arrive_at(&mut self, integrator: &mut Integrator<2>, step: &Step<2>, target: f64) -> Option<Step<2>> {
        let part = (target - step.start[0]) / (step.end[0] - step.start[0]);
        let mut last = integrator.retake(self.dynamics, step, part * step.h);
        for _ in 0..CORRECTIONS {
            let miss = target - last.end[0];
            let correction = miss / last.end[1];
            if miss.abs() <= ROUNDING * target.abs() || correction.abs() <= ROUNDING * (step.t + last.h) {
                return Some(last);
            }
            let h = (last.h + correction).min(step.h);
            if h.is_nan() || h <= 0.0 {
                return None;
            }
            last = integrator.retake(self.dynamics, step, h);
        }
        None
    }
}
