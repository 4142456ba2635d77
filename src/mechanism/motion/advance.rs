//! The advance over one communication step: a hybrid system, integrated from event to event.
//!
//! In: the dynamics, the ends of the travel, the contact there, a state. Out: the state at the exact end of the span,
//! the contact there, the energy lost in impacts. Events - impacts on stops, bumpers touched and left, reversals of
//! drives with an efficiency, changes of friction's regime - are found on the interpolant of a step; impacts are
//! polished on the integration itself. A step may go on beyond the span (`step_ahead.rs`). It must not know what moves.
use crate::integrator::{Dense, IntegrationError, Integrator, Step};
use crate::mechanism::loads::friction_loop::Locked;
use crate::mechanism::motion::contact::{Contact, Ends, outward};
use crate::mechanism::motion::dynamics::Dynamics;
use crate::mechanism::motion::events::{Event, Found, REGIME_TOLERANCE, earliest_event};
use crate::mechanism::motion::step_ahead::{Lookahead, StepAhead};
use crate::mechanism::motion::work::Work;
use crate::numerics::bracket::first_rise;

/// Why an advance ended early.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stopped {
    /// The integration stopped.
    Integration(IntegrationError),
    /// Friction and reactions have no common solution.
    Locked,
    /// The work allowed was done; the state is that at the time reached, and the advance can go on from it.
    Budget(Progress),
}

impl From<Locked> for Stopped {
    fn from(_: Locked) -> Self {
        Self::Locked
    }
}

/// Time of flight between two impacts below which they are one contact [s].
const SHORTEST_FLIGHT: f64 = 1e-10;
/// Height of a flight below which its positions are rounding, relative to sigma: four times the rounding that the search
/// for the impact assumes.
const LOWEST_FLIGHT: f64 = 64.0 * f64::EPSILON;

/// The advance of a motion over one span.
pub struct Advance<'a, D, const N: usize> {
    pub dynamics: &'a mut D,
    pub integrator: &'a mut Integrator<N>,
    /// The step that goes on beyond the present, if one does.
    pub lookahead: &'a mut Lookahead<N>,
    pub ends: &'a Ends,
    pub contact: &'a mut Contact,
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
    /// Friction joint that changed regime at the very start of a step. It keeps its regime for the next step, to
    /// prevent chattering.
    held_regime: Option<usize>,
    /// Whether a step may go on beyond the end of the span.
    may_pass: bool,
}

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

// All is inlined into `run`, so that no reference to the advance escapes and its fields stay in registers.
impl<D: Dynamics<N>, const N: usize> Advance<'_, D, N> {
    /// Advance z = (sigma, sigma_dot, energy lost if N = 3) by exactly `span` [s]; returns the energy lost in impacts
    /// [J].
    pub fn run(mut self, z: &mut [f64; N], span: f64) -> Result<f64, Stopped> {
        if self.resume(z, span)? {
            return Ok(0.0);
        }
        self.progress.may_pass = self.lookahead.may_pass();
        while self.progress.t < span {
            if self.progress.work.is_spent(self.integrator.attempts()) {
                return Err(Stopped::Budget(self.progress));
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
            let end = if beyond { f64::INFINITY } else { span };
            let step = self.integrator.step(self.dynamics, t, z, end, self.tolerance);
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
            let (mut dense, held_regime) = (None, self.progress.held_regime.take());
            let around = (self.ends, &*self.contact);
            let found = earliest_event(self.dynamics, self.integrator, around, step, held_regime, &mut dense);
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
                if !self.is_exact(kept, &dense) {
                    // To be made again, to the end of the span.
                    self.stay_within();
                    self.integrator.branch_off();
                    self.progress.held_regime = held_regime;
                    continue;
                }
                let event = found.map(|found| found.event).filter(|event| *event != Event::Undefined);
                *z = self.lookahead.keep(StepAhead::new(dense, kept.h, (h, state), event), span - t);
                break;
            }
            // Transition.
            *z = state;
            self.progress.t += h;
            match found {
                Some(Found { event, part, .. }) => self.apply_event(event, part <= REGIME_TOLERANCE, z)?,
                None if step.reached => break,
                None => {}
            }
        }
        Ok(self.progress.lost)
    }

    /// Go on from a step that went beyond the last span: read the state at the end of this span from it and return
    /// true, or go to the end of that step.
    #[inline(always)]
    fn resume(&mut self, z: &mut [f64; N], span: f64) -> Result<bool, Locked> {
        let Some(ahead) = &mut self.lookahead.step_ahead else { return Ok(false) };
        if span < ahead.rest() {
            *z = ahead.read(span);
            return Ok(true);
        }
        *z = ahead.end_state();
        self.progress.t = ahead.rest();
        self.progress.is_settled = true;
        self.dynamics.set_time(self.progress.t);
        self.dynamics.set_touching(self.contact.touching());
        let middle = ahead.middle();
        self.dynamics.set_regimes(middle[0], middle[1]);
        let event = ahead.event;
        self.lookahead.step_ahead = None;
        if let Some(event) = event {
            self.apply_event(event, false, z)?;
        }
        Ok(false)
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
    fn instant(&mut self, z: &mut [f64; N], span: f64) -> Result<Instant, Locked> {
        self.dynamics.set_time(self.progress.t);
        // Contact changes with a jump only, so a settled mechanism does not rest.
        if !self.progress.is_settled
            && let Some(side) = self.contact.at_rest()
        {
            return self.rest(side, z[0], span);
        }
        if let Some(side) = self.pushed_end(z) {
            self.impact(side, z)?;
            self.jumped();
            return Ok(Instant::Changed);
        }
        if !self.progress.is_settled {
            self.touch_bumpers(z)?;
            let leaves = |side: usize| z[1] * outward(side) < 0.0 && self.ends.is_at(side, z[0]);
            if let Some(side) = (0..2).find(|&side| leaves(side) && self.ends.is_rigid(side)) {
                self.progress.lost += self.end_bouncing(side, z)?;
                if self.contact.at_rest().is_some() {
                    return Ok(Instant::Changed);
                }
            }
            self.dynamics.set_touching(self.contact.touching());
            self.dynamics.set_regimes(z[0], z[1]);
            self.progress.is_settled = true;
        }
        if self.dynamics.has_reversals() && self.dynamics.find_direction(z[0], z[1])? == 0.0 {
            return self.wait_for_drives(z[0], span);
        }
        Ok(Instant::Moves)
    }

    /// At rest at an end: held by a lock, or by a stop until the loads no longer press the mechanism against it.
    #[inline(always)]
    fn rest(&mut self, side: usize, sigma: f64, span: f64) -> Result<Instant, Locked> {
        if self.contact.is_latched(side) {
            return Ok(Instant::Held);
        }
        if self.is_pressed(side, sigma)? {
            let pull = |dynamics: &mut D| Ok(-dynamics.free_acceleration(sigma, 0.0)? * outward(side));
            if !self.wait_until(span, pull)? {
                return Ok(Instant::Held);
            }
        }
        self.contact.released(side);
        self.jumped();
        // Between two stops at one place, what one lets go the other may hold.
        let other = 1 - side;
        if self.ends.is_at(other, sigma) && (self.ends.locked[other] || self.is_pressed(other, sigma)?) {
            self.contact.rests(other, self.ends.locked[other]);
        }
        Ok(Instant::Changed)
    }

    /// Held at rest by drives with an efficiency, until the loads overcome them in one direction.
    #[inline(always)]
    fn wait_for_drives(&mut self, sigma: f64, span: f64) -> Result<Instant, Locked> {
        let excess = |dynamics: &mut D| {
            let forward = dynamics.acceleration_from_rest(sigma, 1.0)?;
            Ok(forward.max(-dynamics.acceleration_from_rest(sigma, -1.0)?))
        };
        if !self.wait_until(span, excess)? {
            return Ok(Instant::Held);
        }
        self.jumped();
        Ok(Instant::Changed)
    }

    /// Go on in time, at rest, to where `excess`, <= 0 while the mechanism is held, becomes positive under inputs that
    /// change with time; false if it does not before the end of the span. At rest the excess is a parabola in time for
    /// every direction of the drives and without air; a passage there and back within a 64th of the time is not seen.
    #[inline(always)]
    fn wait_until(&mut self, span: f64, mut excess: impl FnMut(&mut D) -> Result<f64, Locked>) -> Result<bool, Locked> {
        const SAMPLES: usize = 64;
        const CLOSE: f64 = 1e-15;
        if !self.dynamics.inputs_change() {
            return Ok(false);
        }
        let from = self.progress.t;
        let time = |s: f64| from + (span - from) * s;
        let excess_at = |s: f64| {
            self.dynamics.set_time(time(s));
            excess(self.dynamics)
        };
        let Some(t) = first_rise(excess_at, SAMPLES, CLOSE)?.map(time).filter(|&t| t < span) else { return Ok(false) };
        self.progress.t = t;
        self.dynamics.set_time(t);
        Ok(true)
    }

    /// Whether the loads press a mechanism at rest at an end against a rigid stop.
    #[inline(always)]
    fn is_pressed(&mut self, side: usize, sigma: f64) -> Result<bool, Locked> {
        Ok(self.ends.is_rigid(side) && self.ends.is_pressed(side, self.dynamics.free_acceleration(sigma, 0.0)?))
    }

    /// Side on which the mechanism is at a rigid stop and moves outward.
    #[inline(always)]
    fn pushed_end(&self, z: &[f64; N]) -> Option<usize> {
        (0..2).find(|&side| {
            let moves = z[1] * outward(side) > 0.0;
            let is_at = |position: f64| (z[0] - position) * outward(side) >= 0.0;
            moves && self.ends.travel[side].is_some_and(|end| is_at(end.position)) && self.ends.is_rigid(side)
        })
    }

    /// A mechanism that sets out outward from the end where a bumper begins presses that bumper from the start.
    #[inline(always)]
    fn touch_bumpers(&mut self, z: &[f64; N]) -> Result<(), Locked> {
        for side in (0..2).filter(|&side| self.ends.is_at(side, z[0])) {
            if let (None, Some(bumper)) = (self.contact.touching()[side], self.ends.bumper(side)) {
                let outward = outward(side);
                let dynamics = &mut *self.dynamics;
                if z[1] * outward > 0.0 || (z[1] == 0.0 && dynamics.free_acceleration(z[0], 0.0)? * outward > 0.0) {
                    self.contact.touched(side, bumper);
                }
            }
        }
        Ok(())
    }

    /// Whether states may be taken from the interpolant of a step.
    #[inline(always)]
    fn is_exact(&mut self, step: &Step<N>, dense: &Dense<N>) -> bool {
        let Some([first, _]) = step.rates() else { return false };
        let scale = self.dynamics.scale(&step.start, first);
        step.interpolates() && dense.is_within(self.tolerance, &scale)
    }

    /// Locate an event: on the interpolant if that is exact, or by a step that ends there, which is returned; an end of
    /// the travel to the last digit.
    #[inline(always)]
    fn locate(&mut self, step: &Step<N>, found: &Found<N>, dense: Option<&Dense<N>>) -> Option<Step<N>> {
        let is_smooth = matches!(found.event, Event::Regime(_) | Event::Bumper(_) | Event::Reversal);
        if is_smooth && dense.is_some_and(|dense| self.is_exact(step, dense)) {
            self.integrator.branch_off();
            return None;
        }
        let mut shorter = self.integrator.retake(self.dynamics, step, found.part * step.h);
        self.progress.work.extra += 1;
        if let Event::End(side) = found.event {
            for _ in 1..6 {
                let miss = self.ends.travel[side].map_or(0.0, |end| end.position - shorter.end[0]);
                let correction = miss / shorter.end[1];
                let is_small = correction.abs() <= 1e-15 * (step.t + step.h)
                    || miss.abs() <= 4.0 * f64::EPSILON * shorter.end[0].abs();
                let next = shorter.h + correction;
                if is_small || !(next > 0.0 && next <= step.h && correction.abs() < 0.1 * step.h) {
                    break;
                }
                shorter = self.integrator.retake(self.dynamics, step, next);
                self.progress.work.extra += 1;
            }
        }
        Some(shorter)
    }

    /// The transition that an event at the state z causes. `at_once`: it came at the very start of its step.
    #[inline(always)]
    fn apply_event(&mut self, event: Event, at_once: bool, z: &mut [f64; N]) -> Result<(), Locked> {
        match event {
            Event::Undefined => self.integrator.refresh(),
            Event::Regime(joint) => {
                self.integrator.refresh();
                self.progress.work.regimes += 1;
                self.dynamics.change_regime(joint, z[0], z[1]);
                self.progress.held_regime = at_once.then_some(joint);
            }
            Event::Reversal => {
                self.jumped();
                self.progress.work.reversals += 1;
                z[1] = 0.0;
            }
            Event::Bumper(side) => {
                self.jumped();
                self.progress.work.bumpers += 1;
                match (self.contact.touching()[side], self.ends.bumper(side)) {
                    (None, Some(bumper)) => self.contact.touched(side, bumper),
                    _ => self.contact.released(side),
                }
            }
            Event::End(side) => {
                self.jumped();
                self.impact(side, z)?;
            }
        }
        Ok(())
    }

    /// The mechanism comes to an end of its travel: a lock catches it, it touches a bumper, bounces, or comes to rest.
    #[inline(always)]
    fn impact(&mut self, side: usize, z: &mut [f64; N]) -> Result<(), Locked> {
        let Some(end) = self.ends.travel[side] else { return Ok(()) };
        self.progress.work.impacts += 1;
        z[0] = end.position;
        let before = 0.5 * z[1] * z[1];
        let other = 1 - side;
        let restitution = self.ends.restitution(side);
        // Between two stops at one place there is no motion.
        let is_caught = restitution.is_some() && self.ends.is_at(other, end.position) && self.ends.is_rigid(other);
        if self.ends.locked[side] || is_caught {
            z[1] = 0.0;
            self.contact.rests(side, self.ends.locked[side]);
            self.progress.lost += before;
        } else if let Some(restitution) = restitution {
            // Newton's law of impact.
            z[1] *= -restitution;
            let after = 0.5 * z[1] * z[1];
            self.progress.lost += before - after + self.end_bouncing(side, z)?;
        } else if let (true, Some(bumper)) = (z[1] * outward(side) > 0.0, self.ends.bumper(side)) {
            self.contact.touched(side, bumper);
        }
        Ok(())
    }

    /// A mechanism that leaves a rigid stop against the loads comes to rest there if its flight would be too short or
    /// too low. Returns the energy lost by that [J].
    #[inline(always)]
    fn end_bouncing(&mut self, side: usize, z: &mut [f64; N]) -> Result<f64, Locked> {
        let speed = -z[1] * outward(side);
        if speed < 0.0 {
            return Ok(0.0);
        }
        let rests = speed == 0.0 || {
            let press = self.dynamics.free_acceleration(z[0], 0.0)? * outward(side);
            let fall = (self.dynamics.length() / press.abs()).sqrt();
            let shortest = SHORTEST_FLIGHT.max(0.1 * self.tolerance * fall);
            let (duration, height) = (2.0 * speed / press, 0.5 * speed * speed / press);
            press > 0.0 && (duration < shortest || height < LOWEST_FLIGHT * z[0].abs())
        };
        if !rests {
            return Ok(0.0);
        }
        z[1] = 0.0;
        self.contact.rests(side, self.ends.locked[side]);
        Ok(0.5 * speed * speed)
    }
}

#[cfg(test)]
mod tests;
