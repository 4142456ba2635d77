//! Passages of the places of stops.
//!
//! In: a step, its interpolant, places with the contact there. Out: whether a place may be passed within the step, and
//! where. It must not know what a stop does.
use super::towards;
use crate::integrator::{Dense, Step};
use crate::mechanism::motion::contact::{Contact, Ends, Place, outward};

/// sigma over a step, as far as it decides whether a place may be passed.
pub(super) struct Near {
    start: f64,
    end: f64,
    bulge: f64,
}

impl Near {
    #[inline]
    pub fn new<const N: usize>(step: &Step<N>) -> Self {
        Self { start: step.start[0], end: step.end[0], bulge: step.bulge(0) }
    }

    /// How far the start of the step is beyond a position.
    #[inline]
    fn beyond(&self, position: f64, side: usize) -> f64 {
        (self.start - position) * outward(side)
    }

    /// Whether a position may be passed or is behind the mechanism.
    #[inline]
    fn may_pass(&self, position: f64, side: usize) -> bool {
        let (start, end) = (self.beyond(position, side), (self.end - position) * outward(side));
        end >= 0.0 || start.max(end) + self.bulge > 0.0
    }

    /// Whether any place may be passed or is behind the mechanism.
    #[inline(always)]
    pub fn any(&self, ends: &Ends, bumpers: usize) -> bool {
        let is_near = |position: Option<f64>, side: usize| position.is_some_and(|p| self.may_pass(p, side));
        self.may_pass(ends.limits[0], 0)
            || self.may_pass(ends.limits[1], 1)
            || (0..bumpers).any(|k| is_near(ends.bumper(0, k), 0) || is_near(ends.bumper(1, k), 1))
    }

    /// Whether a place may be passed or is behind the mechanism.
    #[inline]
    pub fn may_pass_place(&self, ends: &Ends, place: Place) -> bool {
        let position = match place.bumper() {
            None => Some(ends.limits[place.side]),
            Some(bumper) => ends.bumper(place.side, bumper),
        };
        position.is_some_and(|position| self.may_pass(position, place.side))
    }

    /// Whether the mechanism starts behind a place of a bumper, or at it.
    #[inline]
    pub fn is_behind(&self, ends: &Ends, bumper: usize) -> bool {
        (0..2).any(|side| {
            let is_behind = |p: f64| self.may_pass(p, side) && self.beyond(p, side) >= 0.0;
            ends.bumper(side, bumper).is_some_and(is_behind)
        })
    }

    /// Part of a step after which a mechanism that comes back from beyond a place is there, if a lock is engaged there.
    pub fn caught<const N: usize>(&self, ends: &Ends, place: Place, dense: &Dense<N>) -> Option<f64> {
        let position = ends.position(place)?;
        let comes_back = ends.is_locked(place) && self.beyond(position, place.side) > 0.0;
        if comes_back { dense.first_passage(0, position, towards(-place.outward()), false) } else { None }
    }

    /// Part of a step after which a mechanism meets a stop from within, or a lock at its place catches it. A bumper is
    /// met at its place, where a lock may catch the mechanism, unless it touches.
    pub fn passage<const N: usize>(
        &self,
        (ends, contact): (&Ends, &Contact),
        place: Place,
        dense: &Dense<N>,
    ) -> Option<f64> {
        let position = ends.position(place)?;
        let leaving = self.beyond(position, place.side) >= 0.0;
        let touches = place.bumper().is_some_and(|bumper| contact.touching().contains(bumper));
        let meets = || dense.first_passage(0, position, towards(place.outward()), leaving);
        let met = if touches { None } else { meets() };
        [met, self.caught(ends, place, dense)].into_iter().flatten().reduce(f64::min)
    }
}
