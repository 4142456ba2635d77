//! Places of stops, and sets of them: where a lock is engaged, or waits for the force of the stop.
//!
//! In: sides and bumpers. Out: which places are in a set. It must not know where they are.
use super::outward;
use crate::codec::record::{Damaged, Record};
use crate::mechanism::dynamics::bumper_set::BumperSet;

/// A place where a stop is first met.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// 0: the low side of sigma, 1: the high one.
    pub side: usize,
    /// Index of the bumper; none at the rigid stop that ends the travel. A byte keeps saved states small.
    bumper: Option<u8>,
}

/// A set of places.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Places {
    /// Whether the rigid stop of each side is in the set.
    pub rigid: [bool; 2],
    /// Bumpers in the set, each with its places on both sides.
    pub bumpers: BumperSet,
}

/// Places where a lock is engaged, and where one waits for the force of the stop.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EngagedLocks {
    /// Whether one is engaged at the rigid stop of each side.
    pub rigid: [bool; 2],
    /// Whether one engages at the rigid stop of each side as soon as the stop pushes harder than the lock asks.
    pub waiting_rigid: [bool; 2],
    /// Bumpers where one is engaged.
    pub bumpers: BumperSet,
    /// Bumpers where one engages as soon as the bumper pushes harder than the lock asks.
    pub waiting_bumpers: BumperSet,
}

impl Place {
    /// Place of the rigid stop of a side.
    #[inline]
    pub fn rigid(side: usize) -> Self {
        Self { side, bumper: None }
    }

    /// Place where a bumper begins.
    #[inline]
    pub fn of_bumper(side: usize, bumper: usize) -> Self {
        Self { side, bumper: Some(bumper as u8) }
    }

    /// Index of the bumper; none at the rigid stop that ends the travel.
    #[inline]
    pub fn bumper(self) -> Option<usize> {
        self.bumper.map(usize::from)
    }

    /// Sign of sigma_dot of a motion that comes to it from within the travel.
    #[inline]
    pub fn outward(self) -> f64 {
        outward(self.side)
    }

    /// The place, written or read.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        record.place("side of the travel", &mut self.side, 2)?;
        let mut bumper = self.bumper();
        record.option("bumper", &mut bumper, usize::default, |record, bumper| {
            record.place("bumper", bumper, BumperSet::CAPACITY)
        })?;
        self.bumper = bumper.map(|bumper| bumper as u8);
        Ok(())
    }
}

impl Places {
    /// Whether a place is in the set.
    #[inline]
    pub fn contains(self, place: Place) -> bool {
        match place.bumper() {
            None => self.rigid[place.side],
            Some(bumper) => self.bumpers.contains(bumper),
        }
    }

    /// The set with a place.
    #[must_use]
    pub fn with(mut self, place: Place) -> Self {
        match place.bumper() {
            None => self.rigid[place.side] = true,
            Some(bumper) => self.bumpers = self.bumpers.with(bumper),
        }
        self
    }

    /// The set, written or read.
    #[inline]
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        self.rigid.iter_mut().try_for_each(|has| record.flag("place of a lock", has))?;
        self.bumpers.record(record)
    }
}

impl EngagedLocks {
    /// With a lock at a place, engaged or waiting.
    #[must_use]
    pub fn with(mut self, place: Place, engaged: bool) -> Self {
        match engaged {
            true => Places { rigid: self.rigid, bumpers: self.bumpers } = self.engaged().with(place),
            false => {
                Places { rigid: self.waiting_rigid, bumpers: self.waiting_bumpers } = self.waiting().with(place);
            }
        }
        self
    }

    /// With the lock that waits at a place engaged.
    #[must_use]
    pub fn engaging(mut self, place: Place) -> Self {
        match place.bumper() {
            None => self.waiting_rigid[place.side] = false,
            Some(bumper) => self.waiting_bumpers = self.waiting_bumpers.without(bumper),
        }
        self.with(place, true)
    }

    /// Places where a lock is engaged.
    pub fn engaged(&self) -> Places {
        Places { rigid: self.rigid, bumpers: self.bumpers }
    }

    /// Places where a lock waits for the force of the stop.
    pub fn waiting(&self) -> Places {
        Places { rigid: self.waiting_rigid, bumpers: self.waiting_bumpers }
    }

    /// The places, written or read.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        self.rigid.iter_mut().try_for_each(|locked| record.flag("lock engaged", locked))?;
        self.bumpers.record(record)?;
        self.waiting_rigid.iter_mut().try_for_each(|waits| record.flag("lock that waits", waits))?;
        self.waiting_bumpers.record(record)
    }
}
