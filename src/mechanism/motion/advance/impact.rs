//! Impacts within an advance: what happens at the place of a rigid stop, of a bumper and of a lock.
//!
//! In: a state at such a place. Out: the state, the contact and the energy lost after the impact. It must not know what
//! moves.
use super::{Advance, Stopped};
use crate::integrator::System;
use crate::mechanism::dynamics::bumper_set::BumperSet;
use crate::mechanism::dynamics::equation::EquationOfMotion;
use crate::mechanism::loads::friction_loop::Locked;
use crate::mechanism::motion::contact::{EngagedLocks, Place, outward};
use crate::mechanism::motion::impacts::Impact;
use crate::mechanism::motion::witness::What;

/// Time of flight between two impacts below which they are one contact [s].
const SHORTEST_FLIGHT: f64 = 1e-10;
/// Height of a flight below which its positions are rounding, relative to sigma: four times the rounding that the
/// search for the impact assumes.
const LOWEST_FLIGHT: f64 = 64.0 * f64::EPSILON;

impl<'e, const N: usize> Advance<'_, 'e, N>
where
    EquationOfMotion<'e>: System<N>,
{
    /// Number of bumpers; a motion of two components has none.
    #[inline(always)]
    fn bumpers(&self) -> usize {
        self.dynamics.deciding::<N>().map_or(0, |_| self.ends.bumpers())
    }

    /// A mechanism that sets out outward from the place where a bumper begins presses that bumper from the start.
    #[inline(always)]
    pub(super) fn touch_bumpers(&mut self, z: &[f64; N]) -> Result<(), Locked> {
        let ends = self.ends;
        for bumper in 0..self.bumpers() {
            for side in (0..2).filter(|&side| ends.bumper(side, bumper) == Some(z[0])) {
                if self.contact.touching().contains(bumper) {
                    continue;
                }
                let (outward, dynamics) = (outward(side), &mut *self.dynamics);
                if z[1] * outward > 0.0 || (z[1] == 0.0 && dynamics.free_acceleration(z[0], 0.0)? * outward > 0.0) {
                    self.touched(bumper);
                }
            }
        }
        Ok(())
    }

    /// The speed has jumped: of the bumpers behind which the mechanism is, those push that would not pull. One at whose
    /// place it is exactly does not.
    #[inline(always)]
    fn pressed_bumpers(&mut self, sigma: f64, sigma_dot: f64) -> BumperSet {
        let (bumpers, ends, dynamics) = (self.bumpers(), &self.ends, &mut *self.dynamics);
        BumperSet::of(bumpers, |bumper| {
            let is_behind = |side: usize| ends.bumper(side, bumper).is_some_and(|p| (sigma - p) * outward(side) > 0.0);
            (is_behind(0) || is_behind(1)) && {
                let (beyond, push) = dynamics.bumper_push(bumper, sigma, sigma_dot);
                beyond > 0.0 && push > 0.0
            }
        })
    }

    /// The mechanism comes to the place of a stop, and of all that are at that place: a lock catches it, it touches
    /// bumpers, bounces, or comes to rest.
    #[inline(never)]
    pub(super) fn impact(&mut self, place: Place, z: &mut [f64; N]) -> Result<(), Stopped> {
        let Some(position) = self.ends.position(place) else { return Ok(()) };
        if place.bumper().is_none() && self.ends.travel.rigid[place.side].is_none() {
            return Err(Stopped::EndsMeet(place.side));
        }
        self.progress.work.impacts += 1;
        z[0] = position;
        let before = 0.5 * z[1] * z[1];
        let is_rigid = |place: Place| place.bumper().is_none();
        // Between two rigid stops at one place there is no motion.
        let is_caught = is_rigid(place) && self.ends.is_at_rigid(1 - place.side, position);
        let latch = if self.ends.is_locked(place) { Some(place) } else { self.lock_at(position) };
        if latch.is_some() || is_caught {
            self.meets(place, [z[1], 0.0]);
            z[1] = 0.0;
            self.rests(latch.unwrap_or(place), latch.is_some());
            self.speed_has_jumped(z);
            self.progress.lost += before;
        } else if is_rigid(place) {
            // Newton's law of impact.
            let speed = z[1];
            z[1] *= -self.ends.travel.rigid[place.side].map_or(0.0, |end| end.restitution);
            self.meets(place, [speed, z[1]]);
            let after = 0.5 * z[1] * z[1];
            self.speed_has_jumped(z);
            self.progress.lost += before - after + self.end_bouncing(place.side, z)?;
        } else {
            for bumper in 0..self.bumpers() {
                let is_met =
                    |side: usize| z[1] * outward(side) > 0.0 && self.ends.bumper(side, bumper) == Some(position);
                if let Some(side) = (0..2).find(|&side| is_met(side)) {
                    self.meets(Place::of_bumper(side, bumper), [z[1], 0.0]);
                    self.touched(bumper);
                }
            }
        }
        Ok(())
    }

    /// A place exactly at sigma where a lock is engaged.
    #[inline(always)]
    fn lock_at(&self, sigma: f64) -> Option<Place> {
        if self.ends.locked == EngagedLocks::default() {
            return None;
        }
        self.ends.at(sigma).find(|place| self.ends.is_locked(*place))
    }

    /// Bumpers push or not as they do at the new speed.
    #[inline(always)]
    fn speed_has_jumped(&mut self, z: &[f64; N]) {
        if self.bumpers() > 0 {
            let touching = self.pressed_bumpers(z[0], z[1]);
            if self.witness.listens.events {
                self.tell_bumpers(touching);
            }
            self.contact.set_touching(touching);
            self.dynamics.mode.touching = touching;
        }
    }

    /// A mechanism that leaves a rigid stop against the loads comes to rest there if its flight would be too short or
    /// too low. Returns the energy lost by that [J].
    #[inline(never)]
    pub(super) fn end_bouncing(&mut self, side: usize, z: &mut [f64; N]) -> Result<f64, Locked> {
        let speed = -z[1] * outward(side);
        if speed < 0.0 {
            return Ok(0.0);
        }
        let rests = speed == 0.0 || {
            if self.bumpers() > 0 {
                let at_rest = self.pressed_bumpers(z[0], 0.0);
                self.dynamics.mode.touching = at_rest;
            }
            let press = self.dynamics.free_acceleration(z[0], 0.0)? * outward(side);
            self.dynamics.mode.touching = self.contact.touching();
            let fall = (self.dynamics.reduced.scale() / press.abs()).sqrt();
            let shortest = SHORTEST_FLIGHT.max(0.1 * self.tolerance * fall);
            let (duration, height) = (2.0 * speed / press, 0.5 * speed * speed / press);
            press > 0.0 && (duration < shortest || height < LOWEST_FLIGHT * z[0].abs())
        };
        if !rests {
            return Ok(0.0);
        }
        z[1] = 0.0;
        let place = Place::rigid(side);
        self.rests(place, self.ends.is_locked(place));
        self.speed_has_jumped(z);
        Ok(0.5 * speed * speed)
    }

    /// The mechanism meets the stop of a place from within, with sigma_dot before and after; a bumper is taken to end
    /// the motion.
    #[inline(always)]
    fn meets(&mut self, place: Place, [before, after]: [f64; 2]) {
        if let Some((stop, slope)) = self.ends.travel.stop(place) {
            let impact = Impact { slope, before, after };
            if impact.comes_from_within(place.side) {
                self.witness.impact(self.progress.t, (stop, place.bumper().is_none()), impact);
            }
        }
    }

    /// The mechanism has come to rest at a place.
    #[inline(always)]
    pub(super) fn rests(&mut self, place: Place, locked: bool) {
        self.contact.rests(place, locked && self.ends.is_fast(place));
        if let Some((stop, _)) = self.ends.travel.stop(place) {
            self.tell(if locked { What::Caught { stop } } else { What::Rests { stop } });
        }
    }

    /// A lock that waits at a place engages, by the force of the stop there.
    #[cold]
    pub(super) fn engage(&mut self, place: Place) {
        self.contact.engages(place);
        self.ends.locked = self.ends.locked.engaging(place);
        self.contact.locks_set(&self.ends);
        if let Some((stop, _)) = self.ends.travel.stop(place) {
            self.tell(What::Engages { stop });
        }
    }

    /// Locks that wait at bumpers engage which push harder than the locks ask from the start, as by their dampers.
    #[inline(always)]
    pub(super) fn engage_pressed(&mut self, z: &[f64; N]) {
        let pressed = self.contact.touching().intersection(self.ends.locked.waiting_bumpers);
        if pressed != BumperSet::EMPTY {
            self.engage_those(pressed, z);
        }
    }

    #[cold]
    #[inline(never)]
    fn engage_those(&mut self, pressed: BumperSet, z: &[f64; N]) {
        for bumper in (0..self.bumpers()).filter(|bumper| pressed.contains(*bumper)) {
            let place = Place::of_bumper(0, bumper);
            let (_, push) = self.dynamics.bumper_push(bumper, z[0], z[1]);
            if push > self.ends.engages_at(place) {
                self.engage(place);
            }
        }
    }

    /// A bumper begins to push.
    #[inline(always)]
    pub(super) fn touched(&mut self, bumper: usize) {
        self.contact.touched(bumper);
        self.tell(What::Touched { stop: self.ends.travel.bumpers[bumper].stop });
    }

    /// These bumpers push from now on.
    fn tell_bumpers(&mut self, touching: BumperSet) {
        for bumper in 0..self.bumpers() {
            let (before, after) = (self.contact.touching().contains(bumper), touching.contains(bumper));
            let stop = self.ends.travel.bumpers[bumper].stop;
            if before != after {
                self.tell(if after { What::Touched { stop } } else { What::Left { stop } });
            }
        }
    }
}
