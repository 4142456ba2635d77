//! The places where a mechanism meets its stops, and the contact there: small state machines.
//!
//! Going out from the start, on each side of it a mechanism may meet any number of bumpers and, behind them, one rigid
//! stop, which ends the travel. At one place at most it rests:
//!
//! | from | to | transition |
//! |---|---|---|
//! | | Free, Resting | [`Contact::at_start`]: a start at rest exactly where a stop is met rests there |
//! | Free | Resting | [`Contact::rests`]: an impact or the end of bouncing, without a lock engaged there |
//! | Free | Latched | [`Contact::rests`]: the same with a lock engaged, which catches the mechanism |
//! | Resting | Latched | [`Contact::locks_set`]: a lock is engaged |
//! | Latched | Resting | [`Contact::locks_set`]: the last lock is disengaged |
//! | Resting | Free | [`Contact::released`]: the loads draw it off a rigid stop, beyond the release force of a lock |
//! | Free | Resting, Latched | [`Contact::rests`]: of two stops at one place the other holds what the first let go |
//! | Resting | Latched | [`Contact::engages`], [`Contact::locks_set`]: the loads press a lock to engage |
//! | Free | Arrived | [`Contact::arrives`]: an advance that pauses at events has come to a stop |
//! | Arrived | Free | [`Contact::take_arrival`]: it follows, as of a mechanism that is free |
//!
//! Each bumper for itself, whether the mechanism rests or not:
//!
//! | from | to | transition |
//! |---|---|---|
//! | Clear | Touching | [`Contact::touched`]: the bumper begins to push |
//! | Touching | Clear | [`Contact::let_go`]: the bumper would pull |
//! | either | either | [`Contact::set_touching`]: the speed has jumped, so that other bumpers push |
//!
//! In: positions found at the start (`travel.rs`), locks, what happens at a place. Out: what a stop does to a motion
//! that comes to it, the state of contact. It must not know time, forces or what causes a transition.
mod places;

use crate::codec::record::{Damaged, Record};
use crate::mechanism::dynamics::bumper_set::BumperSet;
pub use places::{EngagedLocks, Place, Places};
use std::iter;

/// The rigid stop that ends the travel on one side.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RigidEnd {
    /// sigma, counted on over whole revolutions.
    pub position: f64,
    /// Index of its stop.
    pub stop: usize,
    /// Speed after an impact over the speed before [1].
    pub restitution: f64,
    /// Derivative along sigma of the stop's displacement.
    pub slope: f64,
}

/// Where a bumper is first met.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BumperPlaces {
    /// Index of its stop.
    pub stop: usize,
    /// sigma at the low and at the high side, counted on over whole revolutions; none where the bumper is not met
    /// before the rigid stop.
    pub positions: [Option<f64>; 2],
    /// Derivative along sigma of the stop's displacement at each of these.
    pub slopes: [f64; 2],
    /// Push above which the lock of this bumper engages [N or N.m]; none without such a lock.
    pub engages: Option<f64>,
}

/// Where the stops are first met, going out from the start. It does not change during a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Travel {
    /// Rigid stop that ends the travel at the low and at the high side of sigma, if one does.
    pub rigid: [Option<RigidEnd>; 2],
    /// Bumpers, in the order of the state loads.
    pub bumpers: Vec<BumperPlaces>,
    /// sigma at the low and at the high side where two ends of a drive, a spring or a stop coincide: unless a rigid
    /// stop is met before, the motion cannot go on there.
    pub ends_meet: [Option<f64>; 2],
    /// Generalised force up to which the lock at the rigid stop of each side holds; None for a lock that holds against
    /// any load, and where there is none.
    pub grips: [Option<f64>; 2],
    /// Generalised force of the rigid stop of each side above which the lock there engages; none without such a lock.
    pub engages: [Option<f64>; 2],
    /// Side and index of each stop at the very place of a rigid stop that acts, so that it never acts itself.
    pub beside: Vec<(usize, usize)>,
}

/// The places of the stops during a step.
#[derive(Clone, Copy, Debug)]
pub struct Ends<'a> {
    pub travel: &'a Travel,
    /// Length of the whole revolutions before sigma = 0.
    shift: f64,
    /// sigma at the end of the travel on each side; infinite where there is none.
    pub limits: [f64; 2],
    pub locked: EngagedLocks,
}

/// Sign of sigma_dot of a motion that comes to a stop on this side.
#[inline]
pub fn outward(side: usize) -> f64 {
    if side == 0 { -1.0 } else { 1.0 }
}

impl Travel {
    /// Whether no stop is ever met.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.end(0).is_none() && self.end(1).is_none() && self.bumpers.is_empty()
    }

    /// sigma at the end of the travel on a side, if it has one.
    #[inline]
    pub fn end(&self, side: usize) -> Option<f64> {
        self.rigid[side].map(|end| end.position).or(self.ends_meet[side])
    }

    /// sigma at a place, counted on over whole revolutions.
    #[inline]
    pub fn position(&self, place: Place) -> Option<f64> {
        match place.bumper() {
            None => self.end(place.side),
            Some(bumper) => self.bumpers.get(bumper)?.positions[place.side],
        }
    }

    /// Index of the stop at a place, and the derivative along sigma of its displacement there.
    #[inline]
    pub fn stop(&self, place: Place) -> Option<(usize, f64)> {
        match place.bumper() {
            None => self.rigid[place.side].map(|end| (end.stop, end.slope)),
            Some(bumper) => self.bumpers.get(bumper).map(|bumper| (bumper.stop, bumper.slopes[place.side])),
        }
    }

    /// Index of each stop that ends the travel or stands beside such a one, and whether it must be rigid.
    pub fn stops(&self) -> impl Iterator<Item = (usize, bool)> {
        let rigid = self.rigid.iter().flatten().map(|end| (end.stop, true));
        rigid.chain(self.beside.iter().map(|(_, stop)| (*stop, false)))
    }

    /// All places: rigid stops first, each with its position, counted on over whole revolutions.
    pub fn places(&self) -> impl Iterator<Item = (Place, f64)> {
        let rigid = [0, 1].map(Place::rigid).into_iter();
        let bumpers = (0..self.bumpers.len()).flat_map(|k| [0, 1].map(|side| Place::of_bumper(side, k)));
        rigid.chain(bumpers).filter_map(|place| Some((place, self.position(place)?)))
    }

    /// Whether a lock of this stop acts at a place.
    pub fn holds(&self, place: Place, stop: usize) -> bool {
        match place.bumper() {
            Some(bumper) => self.bumpers[bumper].stop == stop,
            None => {
                self.rigid[place.side].is_some_and(|end| end.stop == stop) || self.beside.contains(&(place.side, stop))
            }
        }
    }
}

impl<'a> Ends<'a> {
    /// The places in the frame of sigma, before which there are whole revolutions of the length `shift`.
    #[inline(always)]
    pub fn new(travel: &'a Travel, shift: f64, locked: EngagedLocks) -> Self {
        let limit = |side: usize| travel.end(side).map_or(outward(side) * f64::INFINITY, |end| end - shift);
        Self { travel, shift, limits: [limit(0), limit(1)], locked }
    }

    /// sigma at a place.
    #[inline]
    pub fn position(&self, place: Place) -> Option<f64> {
        self.travel.position(place).map(|position| position - self.shift)
    }

    /// sigma at the end of the travel on a side.
    #[inline]
    pub fn rigid(&self, side: usize) -> Option<f64> {
        Some(self.limits[side]).filter(|limit| limit.is_finite())
    }

    /// sigma where a bumper is first met on a side.
    #[inline]
    pub fn bumper(&self, side: usize, bumper: usize) -> Option<f64> {
        self.travel.bumpers[bumper].positions[side].map(|position| position - self.shift)
    }

    /// Number of bumpers.
    #[inline]
    pub fn bumpers(&self) -> usize {
        self.travel.bumpers.len()
    }

    /// Whether sigma is exactly at the rigid stop of a side.
    #[inline]
    pub fn is_at_rigid(&self, side: usize, sigma: f64) -> bool {
        self.limits[side] == sigma
    }

    /// Whether a lock is engaged at a place.
    #[inline]
    pub fn is_locked(&self, place: Place) -> bool {
        match place.bumper() {
            None => self.locked.rigid[place.side],
            Some(bumper) => self.locked.bumpers.contains(bumper),
        }
    }

    /// Whether a lock is engaged at a place that holds against any load.
    #[inline]
    pub fn is_fast(&self, place: Place) -> bool {
        self.is_locked(place) && !(place.bumper().is_none() && self.travel.grips[place.side].is_some())
    }

    /// Generalised force up to which an engaged lock with a release force holds at a place; 0 without such a lock.
    #[inline]
    pub fn grip(&self, place: Place) -> f64 {
        match place.bumper() {
            None if self.locked.rigid[place.side] => self.travel.grips[place.side].unwrap_or(0.0),
            _ => 0.0,
        }
    }

    /// Force of the stop above which a lock that waits at a place engages, generalised at a rigid stop [N or N.m at a
    /// bumper]; infinite where none waits.
    #[inline]
    pub fn engages_at(&self, place: Place) -> f64 {
        let least = match place.bumper() {
            None => self.travel.engages[place.side],
            Some(bumper) => self.travel.bumpers[bumper].engages,
        };
        least.filter(|_| self.locked.waiting().contains(place)).unwrap_or(f64::INFINITY)
    }

    /// All places that are exactly at sigma, rigid stops first.
    pub fn at(&self, sigma: f64) -> impl Iterator<Item = Place> + use<'a> {
        let shift = self.shift;
        self.travel.places().filter(move |(_, position)| position - shift == sigma).map(|(place, _)| place)
    }

    /// Whether a mechanism at rest at a place stays there without a lock that holds against any load: a rigid stop
    /// holds it, or a lock does whose release force `acceleration`, sigma_ddot without both, does not exceed.
    #[inline]
    pub fn is_held(&self, place: Place, acceleration: f64) -> bool {
        place.bumper().is_none() && acceleration * place.outward() >= -self.grip(place)
    }

    /// Whether a mechanism at rest at a place stays there without a lock: the stop is rigid, and `acceleration`,
    /// sigma_ddot without the stop, does not point away from it.
    #[inline]
    pub fn is_pressed(&self, place: Place, acceleration: f64) -> bool {
        place.bumper().is_none() && acceleration * place.outward() >= 0.0
    }
}

/// What holds a mechanism at rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Holder {
    /// A rigid stop, against which the loads press the mechanism.
    Stop,
    /// The locks at the place.
    Lock,
}

/// Rest at a place.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Rest {
    place: Place,
    /// Whether a lock is engaged there that holds against any load; else a rigid stop holds the mechanism as long as
    /// the loads press it on, or a lock up to its release force.
    latched: bool,
}

/// State of contact: where the mechanism rests, if it does, and which bumpers push.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Contact {
    rest: Option<Rest>,
    /// Place of a stop that the motion has come to, where the impact is still to take place.
    arrival: Option<Place>,
    touching: BumperSet,
    /// Places where a lock has engaged by the force of the stop, and its input has not released it since.
    engaged: Places,
    /// In model exchange, of the driven surface that can hold its body: sign of the slip since the last event, 0 while
    /// it holds, and its speed then [m/s].
    surface: Option<[f64; 2]>,
}

impl Contact {
    /// At rest at a place, or at none.
    pub fn at_start(resting: Option<Place>) -> Self {
        Self { rest: resting.map(|place| Rest { place, latched: false }), ..Self::default() }
    }

    /// Place at which the mechanism rests.
    #[inline]
    pub fn at_rest(&self) -> Option<Place> {
        self.rest.map(|rest| rest.place)
    }

    /// Whether a lock holds the mechanism.
    #[inline]
    pub fn is_latched(&self) -> bool {
        self.rest.is_some_and(|rest| rest.latched)
    }

    /// Bumpers that push.
    #[inline]
    pub fn touching(&self) -> BumperSet {
        self.touching
    }

    /// Places where a lock has engaged by the force of the stop.
    #[inline]
    pub fn engaged(&self) -> Places {
        self.engaged
    }

    /// In model exchange: sign of the slip on a driven surface, 0 while it holds its body, and its speed [m/s].
    #[inline]
    pub fn surface(&self) -> Option<[f64; 2]> {
        self.surface
    }

    /// In model exchange: what [`Self::surface`] is from now on.
    pub fn set_surface(&mut self, surface: [f64; 2]) {
        self.surface = Some(surface);
    }

    /// The lock at a place has engaged by the force of the stop.
    pub fn engages(&mut self, place: Place) {
        self.engaged = self.engaged.with(place);
    }

    /// The contact of a mechanism that moves freely, with the locks that have engaged.
    #[must_use]
    pub fn freed(&self) -> Self {
        Self { engaged: self.engaged, ..Self::default() }
    }

    /// Locks are engaged or not at each place: where the mechanism rests, an engaged lock latches.
    #[inline]
    pub fn locks_set(&mut self, ends: &Ends) {
        self.forget_released(ends.locked);
        if let Some(rest) = &mut self.rest {
            rest.latched = ends.is_fast(rest.place);
        }
    }

    /// Locks that had engaged by the force of their stops, and that are no longer engaged, are to wait again.
    #[inline]
    pub fn forget_released(&mut self, locked: EngagedLocks) {
        if self.engaged != Places::default() {
            let Places { rigid, bumpers } = locked.engaged();
            self.engaged.rigid = [0, 1].map(|side| self.engaged.rigid[side] && rigid[side]);
            self.engaged.bumpers = self.engaged.bumpers.intersection(bumpers);
        }
    }

    /// The mechanism has come to rest at a place.
    pub fn rests(&mut self, place: Place, locked: bool) {
        self.rest = Some(Rest { place, latched: locked });
    }

    /// The motion has come to a place, where what the stop does is still to follow.
    pub fn arrives(&mut self, place: Place) {
        self.arrival = Some(place);
    }

    /// Place that the motion has come to, where what the stop does is still to follow.
    #[inline]
    pub fn arrival(&self) -> Option<Place> {
        self.arrival
    }

    /// [`Self::arrival`], which follows now.
    #[inline]
    pub fn take_arrival(&mut self) -> Option<Place> {
        self.arrival.take()
    }

    /// Nothing holds the mechanism any longer.
    pub fn released(&mut self) {
        self.rest = None;
    }

    /// A bumper begins to push.
    pub fn touched(&mut self, bumper: usize) {
        self.touching = self.touching.with(bumper);
    }

    /// A bumper ceases to push.
    pub fn let_go(&mut self, bumper: usize) {
        self.touching = self.touching.without(bumper);
    }

    /// These bumpers push, and no others.
    pub fn set_touching(&mut self, touching: BumperSet) {
        self.touching = touching;
    }

    /// What holds the mechanism at rest, and where, with locks as they are in `ends`. `acceleration` is sigma_ddot
    /// without rigid stops and locks. A stop comes first: a lock carries what no stop can. Of several places at the
    /// position of rest each may hold, so that two rigid stops of opposite sides hold against any load.
    pub fn holder(self, ends: &Ends, acceleration: f64) -> Option<(Place, Holder)> {
        let place = self.at_rest()?;
        let others = || ends.position(place).into_iter().flat_map(|sigma| ends.at(sigma));
        let all = || iter::once(place).chain(others());
        let pressed = all().find(|place| ends.is_pressed(*place, acceleration)).map(|place| (place, Holder::Stop));
        let locks =
            |place: &Place| ends.is_fast(*place) || ends.grip(*place) > 0.0 && ends.is_held(*place, acceleration);
        pressed.or_else(|| Some((all().find(locks)?, Holder::Lock)))
    }

    /// The state, written or read.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        record.option("rest", &mut self.rest, Rest::default, |record, rest| {
            rest.place.record(record)?;
            record.flag("latched", &mut rest.latched)
        })?;
        record.option("arrival at a stop", &mut self.arrival, Place::default, |record, place| place.record(record))?;
        self.touching.record(record)?;
        self.engaged.record(record)?;
        record.option("slip on a surface", &mut self.surface, Default::default, |record, surface| {
            record.all_finite("slip on a surface", surface)
        })
    }
}

#[cfg(test)]
mod tests;
