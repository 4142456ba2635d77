//! The advance over one communication step: a hybrid system, integrated from event to event.
//!
//! In: an equation of motion, places of stops, contact, state. Out: state at the end of the span, contact, energy lost
//! in impacts. Events (impacts, bumpers, reversals, regimes of friction, pressures at which locks change) are found on
//! the interpolant of a step. Impacts and locks are then located on the integration itself. A step may extend beyond
//! the span (`step_ahead.rs`). Must not know: loads.
use crate::integrator::{Dense, IntegrationError, Integrator, Step, System};
use crate::mechanism::dynamics::equation::EquationOfMotion;
use crate::mechanism::dynamics::hydraulic::MOTION;
use crate::mechanism::loads::friction_loop::Locked;
use crate::mechanism::motion::contact::{Contact, Ends};
use crate::mechanism::motion::events::{Event, Found, REGIME_TOLERANCE, earliest_event, just_after};
use crate::mechanism::motion::step_ahead::{Lookahead, StepAhead};
use crate::mechanism::motion::witness::Witness;
use crate::mechanism::motion::work::Work;
use std::mem::take;
use transitions::Instant;

/// Why an advance ended early.
#[derive(Clone, Debug, PartialEq)]
pub enum Stopped {
    /// The integration stopped.
    Integration(IntegrationError),
    /// Friction and reactions have no common solution.
    Locked,
    /// The motion has come to the end of the curve on this side, where two ends of a load coincide.
    EndsMeet(usize),
    /// A chamber, A or B, of oil without air has come to absolute zero.
    Vacuum(usize),
    /// The integration stopped with a circuit, whose state the text describes.
    Stuck(IntegrationError, String),
    /// The length of the actuator with a circuit is not smooth along the motion.
    Length,
    /// A stop is met or lets go, or a lock is due: the advance pauses there, and can continue.
    Event(Progress),
    /// An internal step is done: the advance pauses there, and can continue.
    Pause(Progress),
    /// The allowed work was done. The state is that at the time reached, and the advance can continue.
    Budget(Progress),
}

impl From<Locked> for Stopped {
    fn from(_: Locked) -> Self {
        Self::Locked
    }
}

/// The advance of a motion over one span.
pub struct Advance<'a, 'e, const N: usize> {
    pub dynamics: &'a mut EquationOfMotion<'e>,
    pub integrator: &'a mut Integrator<N>,
    /// The step that goes on beyond the present, if one does.
    pub lookahead: &'a mut Lookahead<N>,
    /// The places of the stops. A lock that engages by force does so here within the span.
    pub ends: Ends<'a>,
    pub contact: &'a mut Contact,
    pub witness: &'a mut Witness,
    pub tolerance: f64,
    /// How far it has come: [`Progress::default`] at the start.
    pub progress: Progress,
}

/// How far an advance has come.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Progress {
    /// Time since the start of the span [s].
    pub t: f64,
    /// Energy lost in impacts [J].
    pub lost: f64,
    /// Work done, and allowed.
    pub work: Work,
    /// Whether bumpers in contact and regimes of friction are those of the state: not at the start, nor after it has
    /// jumped.
    is_settled: bool,
    /// Change of a regime or a sign at the very start of the last step. The law that follows is kept for the next step,
    /// to prevent chattering.
    held: Option<Event>,
    /// Whether a step may go on beyond the end of the span.
    may_pass: bool,
    /// Latest end of the next step [s], where one before went too far beyond a knot. A time in the past has no effect.
    limit: f64,
    /// Whether a step before was too coarse for its events, so that the next ones grow from one that was not.
    is_refining: bool,
    /// Attempts in a row that were too coarse.
    refinements: u32,
}

/// Part of the distance to the open end of a stretch that a step beyond the span may cover.
const BEFORE_END: f64 = 0.9;
/// How far beyond a knot a step may try to go, in distances from its start to the knot: its stages then lie on the way
/// to the knot, and its error estimate sees what is there, however narrow.
const BEYOND_KNOT: f64 = 1.1;
/// How far beyond the next change of a regime of friction a step may try to go, in times to the change at the present
/// rates: the rates change, and a step that ends before the change is in vain as well.
const BEYOND_CHANGE: f64 = 1.25;
/// Growth of a step after one that was made shorter because it was too coarse for its events.
const GROWTH: f64 = 3.0;

impl Progress {
    /// The start of an advance with this bound; see [`Work::most`].
    pub fn within(most: u64) -> Self {
        Self { work: Work::within(most), ..Self::default() }
    }
}

/// Where a step is to end.
#[derive(Clone, Copy, Debug)]
struct Aim {
    /// Latest end of the step [s].
    end: f64,
    /// Whether the step may end beyond the span.
    is_beyond: bool,
    /// Whether a kink or a limit is before the end that the span allows.
    is_cut: bool,
}

// What each step does, with the modules below, is inlined into `run`, so that the fields of the advance stay in
// registers; what happens at an event is not, as it stands at several places.
impl<'e, const N: usize> Advance<'_, 'e, N>
where
    EquationOfMotion<'e>: System<N>,
{
    /// Advance z = (sigma, sigma_dot, energy lost if N > 2, ...) by exactly `span` [s]; returns the energy lost in
    /// impacts [J].
    pub fn run(mut self, z: &mut [f64; N], span: f64) -> Result<f64, Stopped> {
        if let Some(place) = self.contact.take_arrival() {
            self.meet(place, z)?;
        }
        if self.resume(z, span)? {
            return Ok(0.0);
        }
        self.progress.may_pass = self.lookahead.may_pass();
        while self.progress.t < span {
            self.check(z)?;
            match self.instant(z, span)? {
                Instant::Held => break,
                Instant::Changed => {
                    self.progress.work.extra += 1;
                    continue;
                }
                Instant::Moves => {}
            }
            let aim = self.aim(z, span);
            let step = self.continuous_step(z, aim);
            let step = match &step {
                Ok(step) => step,
                Err(error) => {
                    self.give_up(*error, aim)?;
                    continue;
                }
            };
            let mut dense = None;
            let Some(found) = self.find_event(step, &mut dense) else { continue };
            let shorter = found.as_ref().and_then(|found| self.locate(step, found, dense.as_ref()));
            let (h, state) = match (&found, &shorter) {
                (_, Some(shorter)) => (shorter.h, shorter.end),
                (Some(found), None) => (found.part * step.h, found.state),
                (None, None) => (step.h, step.end),
            };
            if aim.is_beyond && step.t + h > span {
                let dense = dense.filter(|_| shorter.is_none());
                let kept = shorter.as_ref().unwrap_or(step);
                let Some(state) = self.keep_ahead((kept, dense), (h, state), found, span) else { continue };
                *z = state;
                break;
            }
            *z = state;
            self.progress.t += h;
            // Where a surface holds its body, each step is searched for events.
            if N == MOTION && dense.is_some() {
                self.keep_on_surface(z);
            }
            self.refine(dense.is_some(), h);
            self.transition(found.as_ref().zip(dense.as_ref()), z)?;
            if found.is_none() && step.reached && !aim.is_cut {
                break;
            }
            // A change of law that is kept for the next step must not be forgotten.
            if self.witness.pauses.at_steps && self.progress.held.is_none() {
                return Err(Stopped::Pause(self.progress));
            }
        }
        Ok(self.progress.lost)
    }

    /// Whether the advance may go on from the state z: the work is not spent, and no lock is to change.
    #[inline(always)]
    fn check(&self, z: &[f64; N]) -> Result<(), Stopped> {
        if self.progress.work.is_spent(self.integrator.attempts()) {
            return Err(Stopped::Budget(self.progress));
        }
        let is_due = |level| self.dynamics.level_of_network(level, z).is_some_and(|own| own.excess(z) >= 0.0);
        if (0..self.dynamics.levels::<N>()).any(is_due) { Err(Stopped::Event(self.progress)) } else { Ok(()) }
    }

    /// Where the step from the state z is to end.
    #[inline(always)]
    fn aim(&mut self, z: &[f64; N], span: f64) -> Aim {
        let t = self.progress.t;
        let change = self.beyond_next_change(z);
        let may_pass = self.progress.may_pass && self.integrator.outlasts(span - t) && change > span;
        let farthest = if may_pass { self.farthest(z, span) } else { span };
        let (is_beyond, end) = (farthest > span, farthest.max(span));
        let kink = self.dynamics.next_kink::<N>(t).min(self.latest(z)).min(change);
        let is_cut = kink < end;
        Aim { end: if is_cut { kink } else { end }, is_beyond, is_cut }
    }

    /// Latest end [s] of a step from the state z that extends beyond the span.
    #[inline(always)]
    fn farthest(&mut self, z: &[f64; N], span: f64) -> f64 {
        let end = Integrator::<N>::farthest(self.progress.t, span);
        if self.dynamics.whole.is_open() { end.min(self.open_end(z)) } else { end }
    }

    /// Time [s] at which the motion is a little before the open end of its stretch of the curve, at its present speed
    /// and a constant acceleration of the present size. A step beyond the span ends there: to make the next stretch
    /// takes about a millisecond, and the motion may never reach it.
    #[cold]
    fn open_end(&mut self, z: &[f64; N]) -> f64 {
        let t = self.progress.t;
        let acceleration = self.integrator.rates(self.dynamics, t, z)[1];
        let curve = self.dynamics.stretch_at(z[0]).0.curve();
        let is_forward = if z[1] == 0.0 { acceleration > 0.0 } else { z[1] > 0.0 };
        let distance = BEFORE_END * if is_forward { curve.range.1 - z[0] } else { z[0] - curve.range.0 };
        if !curve.is_open(usize::from(is_forward)) {
            return f64::INFINITY;
        }
        t + 2.0 * distance / (z[1].abs() + (z[1] * z[1] + 2.0 * acceleration.abs() * distance).sqrt())
    }

    /// The continuous step from the state z.
    #[inline(always)]
    fn continuous_step(&mut self, z: &[f64; N], aim: Aim) -> Result<Step<N>, IntegrationError> {
        let t = self.progress.t;
        if aim.is_beyond {
            self.integrator.step_beyond(self.dynamics, t, z, aim.end, self.tolerance)
        } else {
            self.integrator.step(self.dynamics, t, z, aim.end, self.tolerance)
        }
    }

    /// No step can be made: an error, unless the step was to go beyond the span, in vain.
    #[inline(always)]
    fn give_up(&mut self, error: IntegrationError, aim: Aim) -> Result<(), Stopped> {
        let is_locked = take(&mut self.dynamics.locked);
        match aim.is_beyond {
            // What is beyond the span is of no concern yet.
            true => self.stay_within(),
            false if is_locked => return Err(Stopped::Locked),
            false => return Err(Stopped::Integration(error)),
        }
        Ok(())
    }

    /// The earliest event in a step, if there is one; `dense` becomes the interpolant if that was needed. None if the
    /// step is to be made again, to an earlier end: it is too coarse for its events, or goes too far beyond a knot.
    #[inline(always)]
    fn find_event(&mut self, step: &Step<N>, dense: &mut Option<Dense<N>>) -> Option<Option<Found<N>>> {
        let around = (&self.ends, &*self.contact);
        let laws = (self.progress.held, self.tolerance);
        let found = earliest_event(self.dynamics, self.integrator, around, step, laws, dense);
        if let Some(limit) = self.too_coarse(step, dense.as_ref()) {
            self.progress.limit = limit;
            self.progress.is_refining = true;
            self.progress.refinements += 1;
            self.progress.work.extra += 1;
            self.integrator.take_back(self.dynamics, step, limit - step.t);
            return None;
        }
        self.progress.refinements = 0;
        if let Some(limit) = found.as_ref().and_then(|found| self.too_far(step, found)) {
            self.progress.limit = limit;
            self.progress.work.extra += 1;
            self.integrator.branch_off();
            return None;
        }
        Some(found)
    }

    /// Keep a step that extends beyond the span, and return the state at the end of the span; none if its interpolant
    /// is not exact, so that a step is to be made to the end of the span.
    #[inline(always)]
    fn keep_ahead(
        &mut self,
        (step, dense): (&Step<N>, Option<Dense<N>>),
        end: (f64, [f64; N]),
        found: Option<Found<N>>,
        span: f64,
    ) -> Option<[f64; N]> {
        let dense = dense.unwrap_or_else(|| self.integrator.dense(self.dynamics, step));
        let after = span - step.t;
        if !(self.is_exact(step, &dense) && self.dynamics.admits(&dense.at(after / step.h))) {
            self.stay_within();
            self.integrator.branch_off();
            return None;
        }
        let event = found.map(|found| found.event).filter(|event| *event != Event::Undefined);
        Some(self.lookahead.keep(StepAhead::new(dense, step.h, end, event), after))
    }

    /// After steps that were too coarse, the next ones grow from the present step of `h` [s] as long as an event is
    /// near.
    #[inline(always)]
    fn refine(&mut self, is_near: bool, h: f64) {
        if self.progress.is_refining {
            self.progress.is_refining = is_near;
            self.progress.limit = if is_near { self.progress.t + GROWTH * h } else { 0.0 };
        }
    }

    /// The transition at the end of a step or of its part up to an event on its interpolant, at the state z.
    #[inline(always)]
    fn transition(&mut self, found: Option<(&Found<N>, &Dense<N>)>, z: &mut [f64; N]) -> Result<(), Stopped> {
        self.progress.held = None;
        self.dynamics.set_state(z);
        match found {
            Some((found, dense)) => {
                let after = just_after(z, dense, found.part);
                self.apply_event(found.event, found.part <= REGIME_TOLERANCE, z, &after)
            }
            None => Ok(()),
        }
    }

    /// Go on from a step that went beyond the last span: read the state at the end of this span from it and return
    /// true, or go to the end of that step.
    #[inline(always)]
    fn resume(&mut self, z: &mut [f64; N], span: f64) -> Result<bool, Stopped> {
        let Some(ahead) = &mut self.lookahead.step_ahead else { return Ok(false) };
        if span < ahead.rest() {
            let state = ahead.read(span);
            if self.dynamics.admits(&state) {
                *z = state;
                return Ok(true);
            }
            // The interpolant is less exact than the step: go on from here.
            self.lookahead.invalidate();
            self.integrator.branch_off();
            return Ok(false);
        }
        *z = ahead.end_state();
        self.progress.t = ahead.rest();
        self.progress.is_settled = true;
        self.dynamics.mode.touching = self.contact.touching();
        let (middle, event, after) = (ahead.middle(), ahead.event, just_after(z, &ahead.dense, ahead.end / ahead.h));
        if let Some(state_loads) = self.dynamics.deciding::<N>() {
            self.dynamics.set_regimes(middle[0], middle[1]);
            if state_loads.switches() > 0 {
                self.dynamics.find_direction(middle[0], middle[1])?;
                self.dynamics.find_signs(self.progress.t, &middle)?;
            }
        }
        self.dynamics.time = self.progress.t;
        self.dynamics.set_state(z);
        self.lookahead.step_ahead = None;
        if let Some(event) = event {
            self.apply_event(event, false, z, &after)?;
        }
        Ok(false)
    }

    /// Time at which the step from the state z ends at the latest [s].
    #[inline(always)]
    fn latest(&mut self, z: &[f64; N]) -> f64 {
        // A limit that passed while the mechanism rested no longer holds.
        let limit =
            Some(take(&mut self.progress.limit)).filter(|limit| *limit > self.progress.t).unwrap_or(f64::INFINITY);
        if self.dynamics.whole.has_knots() { limit.min(self.beyond_next_knot(z)) } else { limit }
    }

    /// Time at which the motion is a little beyond the next knot at its present speed [s]; infinite without one.
    #[cold]
    fn beyond_next_knot(&self, z: &[f64; N]) -> f64 {
        match self.dynamics.whole.next_knot(z[0], z[1].signum()) {
            Some(knot) => self.progress.t + BEYOND_KNOT * ((knot - z[0]) / z[1]).abs(),
            None => f64::INFINITY,
        }
    }

    /// Time a little beyond the next change of a regime of friction at the present rates of the slip speeds [s];
    /// infinite without one. A step that goes farther is in vain there, and its error estimate contains what does not
    /// occur.
    #[inline(always)]
    fn beyond_next_change(&mut self, z: &[f64; N]) -> f64 {
        self.dynamics.scratch.evaluator.begin_step();
        match self.dynamics.deciding::<N>().filter(|own| !own.friction_joints.is_empty()) {
            Some(_) => self.beyond_next_regime(z),
            None => f64::INFINITY,
        }
    }

    #[inline(never)]
    fn beyond_next_regime(&mut self, z: &[f64; N]) -> f64 {
        let t = self.progress.t;
        let rates = self.integrator.rates(self.dynamics, t, z);
        let until = self.dynamics.until_regime_changes(z[0], [t, z[1], rates[1]]);
        self.integrator.shortened(BEYOND_CHANGE * until).map_or(f64::INFINITY, |h| t + h)
    }

    /// A step beyond the span was in vain: the next ones end with it.
    #[inline(always)]
    fn stay_within(&mut self) {
        self.lookahead.failed();
        self.progress.may_pass = false;
    }
}

mod impact;
mod location;
mod rest;
mod surface;
mod transitions;
