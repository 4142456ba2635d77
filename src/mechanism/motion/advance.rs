//! The advance over one communication step: a hybrid system, integrated from event to event.
//!
//! In: dynamics, places of stops, contact, state. Out: state at the end of the span, contact, energy lost in impacts.
//! Events (impacts, bumpers, reversals, regimes of friction, pressures at which locks change) are found on the
//! interpolant of a step. Impacts and locks are then located on the integration itself. A step may extend beyond the
//! span (`step_ahead.rs`). Must not know: what moves.
use crate::integrator::{IntegrationError, Integrator};
use crate::mechanism::dynamics::bumper_set::BumperSet;
use crate::mechanism::loads::friction_loop::Locked;
use crate::mechanism::motion::contact::{Contact, Ends, Place, outward};
use crate::mechanism::motion::dynamics::Dynamics;
use crate::mechanism::motion::events::{Event, Found, REGIME_TOLERANCE, earliest_event};
use crate::mechanism::motion::step_ahead::{Lookahead, StepAhead};
use crate::mechanism::motion::witness::{What, Witness};
use crate::mechanism::motion::work::Work;
use std::mem::take;

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
pub struct Advance<'a, D, const N: usize> {
    pub dynamics: &'a mut D,
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
    /// Change of a regime or a sign at the very start of a step. The law that follows is kept for the next step, to
    /// prevent chattering.
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

/// How far beyond a knot a step may try to go, in distances from its start to the knot: its stages then lie on the way
/// to the knot, and its error estimate sees what is there, however narrow.
const BEYOND_KNOT: f64 = 1.1;
/// Growth of a step after one that was made shorter because it was too coarse for its events.
const GROWTH: f64 = 3.0;

impl Progress {
    /// The start of an advance with this bound; see [`Work::most`].
    pub fn within(most: u64) -> Self {
        Self { work: Work::within(most), ..Self::default() }
    }
}

/// What follows from the state at one instant.
enum Instant {
    /// The mechanism is held at rest to the end of the span.
    Held,
    /// A transition that took no time, or a release: what follows is to be found anew.
    Changed,
    /// The mechanism moves.
    Moves,
}

// What each step does, with the modules below, is inlined into `run`, so that the fields of the advance stay in
// registers; what happens at an event is not, as it stands at several places.
impl<D: Dynamics<N>, const N: usize> Advance<'_, D, N> {
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
            if self.progress.work.is_spent(self.integrator.attempts()) {
                return Err(Stopped::Budget(self.progress));
            }
            if self.is_due(z) {
                return Err(Stopped::Event(self.progress));
            }
            match self.instant(z, span)? {
                Instant::Held => break,
                Instant::Changed => {
                    self.progress.work.extra += 1;
                    continue;
                }
                Instant::Moves => {}
            }
            // Continuous step.
            let t = self.progress.t;
            let beyond = self.progress.may_pass && self.integrator.outlasts(span - t);
            let end = if beyond { Integrator::<N>::farthest(t, span) } else { span };
            let kink = self.dynamics.next_kink(t).min(self.latest(z));
            let is_cut = kink < end;
            let end = if is_cut { kink } else { end };
            self.dynamics.begin_step();
            let step = if beyond {
                self.integrator.step_beyond(self.dynamics, t, z, end, self.tolerance)
            } else {
                self.integrator.step(self.dynamics, t, z, end, self.tolerance)
            };
            let step = match &step {
                Ok(step) => step,
                Err(_) if beyond => {
                    // What is beyond the span is of no concern yet.
                    self.stay_within();
                    self.dynamics.take_locked();
                    continue;
                }
                Err(_) if self.dynamics.take_locked() => return Err(Stopped::Locked),
                Err(error) => return Err(Stopped::Integration(*error)),
            };
            // Earliest event in it.
            let (mut dense, held) = (None, self.progress.held.take());
            let around = (&self.ends, &*self.contact);
            let laws = (held, self.tolerance);
            let found = earliest_event(self.dynamics, self.integrator, around, step, laws, &mut dense);
            if let Some(limit) = self.too_coarse(step, dense.as_ref()) {
                self.progress.limit = limit;
                self.progress.is_refining = true;
                self.progress.refinements += 1;
                self.progress.work.extra += 1;
                self.progress.held = held;
                self.integrator.take_back(self.dynamics, step, limit - t);
                continue;
            }
            self.progress.refinements = 0;
            if let Some(limit) = found.as_ref().and_then(|found| self.too_far(step, found)) {
                self.progress.limit = limit;
                self.progress.work.extra += 1;
                self.progress.held = held;
                self.integrator.branch_off();
                continue;
            }
            let shorter = found.as_ref().and_then(|found| self.locate(step, found, dense.as_ref()));
            let (h, state) = match (&found, &shorter) {
                (_, Some(shorter)) => (shorter.h, shorter.end),
                (Some(found), None) => (found.part * step.h, found.state),
                (None, None) => (step.h, step.end),
            };
            if beyond && t + h > span {
                let kept = shorter.as_ref().unwrap_or(step);
                let dense = dense.filter(|_| shorter.is_none());
                let dense = dense.unwrap_or_else(|| self.integrator.dense(self.dynamics, kept));
                if !(self.is_exact(kept, &dense) && self.dynamics.admits(&dense.at((span - t) / kept.h))) {
                    // To be made again, to the end of the span.
                    self.stay_within();
                    self.integrator.branch_off();
                    self.progress.held = held;
                    continue;
                }
                let event = found.map(|found| found.event).filter(|event| *event != Event::Undefined);
                *z = self.lookahead.keep(StepAhead::new(dense, kept.h, (h, state), event), span - t);
                break;
            }
            // Transition.
            *z = state;
            self.progress.t += h;
            if self.progress.is_refining {
                // Until no event is near.
                self.progress.is_refining = dense.is_some();
                self.progress.limit = if dense.is_some() { self.progress.t + GROWTH * h } else { 0.0 };
            }
            self.dynamics.set_state(z);
            match found {
                Some(Found { event, part, .. }) => self.apply_event(event, part <= REGIME_TOLERANCE, z)?,
                None if step.reached && !is_cut => break,
                None => {}
            }
            // A change of law that is kept for the next step must not be forgotten.
            if self.witness.pauses.at_steps && self.progress.held.is_none() {
                return Err(Stopped::Pause(self.progress));
            }
        }
        Ok(self.progress.lost)
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
        self.dynamics.set_touching(self.contact.touching());
        let (middle, event) = (ahead.middle(), ahead.event);
        self.dynamics.set_regimes(middle[0], middle[1]);
        if self.dynamics.switches() > 0 {
            self.dynamics.find_direction(middle[0], middle[1])?;
            self.dynamics.find_signs(self.progress.t, &middle)?;
        }
        self.dynamics.set_time(self.progress.t);
        self.dynamics.set_state(z);
        self.lookahead.step_ahead = None;
        if let Some(event) = event {
            self.apply_event(event, false, z)?;
        }
        Ok(false)
    }

    /// Time at which the step from the state z ends at the latest [s].
    #[inline(always)]
    fn latest(&mut self, z: &[f64; N]) -> f64 {
        // A limit that passed while the mechanism rested no longer holds.
        let limit =
            Some(take(&mut self.progress.limit)).filter(|limit| *limit > self.progress.t).unwrap_or(f64::INFINITY);
        if self.dynamics.has_knots() { limit.min(self.beyond_next_knot(z)) } else { limit }
    }

    /// Time at which the motion is a little beyond the next knot at its present speed [s]; infinite without one.
    #[cold]
    fn beyond_next_knot(&self, z: &[f64; N]) -> f64 {
        match self.dynamics.next_knot(z[0], z[1].signum()) {
            Some(knot) => self.progress.t + BEYOND_KNOT * ((knot - z[0]) / z[1]).abs(),
            None => f64::INFINITY,
        }
    }

    /// A step beyond the span was in vain: the next ones end with it.
    #[inline(always)]
    fn stay_within(&mut self) {
        self.lookahead.failed();
        self.progress.may_pass = false;
    }

    /// The state has jumped.
    #[inline(always)]
    fn jumped(&mut self) {
        self.integrator.restart();
        self.progress.is_settled = false;
    }

    /// What follows from the state before a step: rest, impacts, bumpers touched, the mode of friction and drives.
    #[inline(always)]
    fn instant(&mut self, z: &mut [f64; N], span: f64) -> Result<Instant, Stopped> {
        self.dynamics.set_time(self.progress.t);
        self.dynamics.set_state(z);
        // Contact changes with a jump only, so a settled mechanism does not rest.
        if !self.progress.is_settled
            && let Some(place) = self.contact.at_rest()
        {
            self.dynamics.set_touching(self.contact.touching());
            return self.rest(place, z, span);
        }
        if let Some(side) = self.pushed_end(z) {
            self.impact(Place::rigid(side), z)?;
            self.jumped();
            return Ok(Instant::Changed);
        }
        let settles = !self.progress.is_settled;
        if settles {
            self.touch_bumpers(z)?;
            let leaves = |side: usize| z[1] * outward(side) < 0.0 && self.ends.is_at_rigid(side, z[0]);
            if let Some(side) = (0..2).find(|&side| leaves(side)) {
                self.progress.lost += self.end_bouncing(side, z)?;
                if self.contact.at_rest().is_some() {
                    return Ok(Instant::Changed);
                }
            }
            self.dynamics.set_touching(self.contact.touching());
            self.dynamics.set_regimes(z[0], z[1]);
            self.progress.is_settled = true;
            if self.ends.locked.waiting.bumpers != BumperSet::EMPTY {
                self.engage_pressed(z);
            }
        }
        if self.dynamics.has_reversals() && self.dynamics.find_direction(z[0], z[1])? == 0.0 {
            return self.wait_at_rest(z, span);
        }
        if settles && self.dynamics.switches() > 0 {
            self.dynamics.find_signs(self.progress.t, z)?;
        }
        Ok(Instant::Moves)
    }

    /// Side on which the mechanism is at a rigid stop and moves outward.
    #[inline(always)]
    fn pushed_end(&self, z: &[f64; N]) -> Option<usize> {
        (0..2).find(|&side| {
            let moves = z[1] * outward(side) > 0.0;
            moves && (z[0] - self.ends.limits[side]) * outward(side) >= 0.0
        })
    }

    /// The transition that an event at the state z causes. `at_once`: it came at the very start of its step.
    #[inline(never)]
    fn apply_event(&mut self, event: Event, at_once: bool, z: &mut [f64; N]) -> Result<(), Stopped> {
        match event {
            Event::Undefined => self.integrator.refresh(),
            // The right-hand side is continuous there.
            Event::Border(_) | Event::Knot(_) => {}
            Event::Regime(joint) => {
                self.integrator.refresh();
                self.progress.work.regimes += 1;
                self.dynamics.set_time(self.progress.t);
                self.dynamics.change_regime(joint, z[0], z[1]);
                if let Some(regime) = self.dynamics.regime(joint) {
                    self.tell(What::Regime { joint, regime });
                }
                self.progress.held = at_once.then_some(event);
            }
            Event::Switch(switch) => {
                self.integrator.refresh();
                self.progress.work.signs += 1;
                self.dynamics.flip_sign(switch);
                self.progress.held = at_once.then_some(event);
            }
            Event::Reversal => {
                self.jumped();
                self.progress.work.reversals += 1;
                z[1] = 0.0;
                if !self.dynamics.sticks() {
                    self.tell(What::Reversal);
                } else if self.comes_to_stick(z)? && self.pauses() {
                    return Err(Stopped::Event(self.progress));
                }
            }
            Event::Bumper(bumper) => {
                self.jumped();
                self.progress.work.bumpers += 1;
                if self.contact.touching().contains(bumper) {
                    self.contact.let_go(bumper);
                    self.tell(What::Left { stop: self.ends.travel.bumpers[bumper].stop });
                } else {
                    self.touched(bumper);
                }
            }
            Event::Engages(bumper, _) => {
                self.engage(Place::of_bumper(0, bumper));
                if self.pauses() {
                    return Err(Stopped::Event(self.progress));
                }
            }
            Event::Stop(place) if self.pauses() && self.ends.travel.stop(place).is_some() => {
                z[0] = self.ends.position(place).unwrap_or(z[0]);
                self.contact.arrives(place);
                return Err(Stopped::Event(self.progress));
            }
            Event::Stop(place) => {
                self.jumped();
                self.impact(place, z)?;
            }
            Event::Level(level) => {
                if let Some(level) = self.dynamics.level(level, z) {
                    z[level.component] = level.value;
                }
                return Err(Stopped::Event(self.progress));
            }
        }
        Ok(())
    }

    /// Whether a lock is to change in the state z.
    #[inline(always)]
    fn is_due(&self, z: &[f64; N]) -> bool {
        (0..self.dynamics.levels()).any(|index| self.dynamics.level(index, z).is_some_and(|own| own.excess(z) >= 0.0))
    }

    /// Whether the advance pauses at an event now. At its very start it does not, so that each makes way.
    #[inline(always)]
    fn pauses(&self) -> bool {
        self.witness.pauses.at_events && self.progress.t > 0.0
    }

    /// What follows at the start of an advance where the one before has paused: the impact at this place.
    #[cold]
    #[inline(never)]
    fn meet(&mut self, place: Place, z: &mut [f64; N]) -> Result<(), Stopped> {
        self.dynamics.set_time(0.0);
        self.dynamics.set_state(z);
        self.dynamics.set_touching(self.contact.touching());
        self.jumped();
        self.impact(place, z)
    }

    /// Something happens now.
    #[inline(always)]
    fn tell(&mut self, what: What) {
        self.witness.tell(self.progress.t, what);
    }
}

mod impact;
mod location;
mod rest;
#[cfg(test)]
mod tests;
