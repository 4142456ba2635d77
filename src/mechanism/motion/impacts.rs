//! Impacts on each stop since the start: their number, and time and impulse of the last one.
//!
//! In: impacts of a step. Out: the record that outputs and saved states hold. It must not know how an impact is found.
use crate::codec::record::{Damaged, Record};
use crate::mechanism::motion::contact::outward;

/// Impacts of a mechanism on a stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impacts {
    /// Number of impacts. From 2^53 on it stays.
    pub count: f64,
    /// Time of the last one [s]; [`Self::BEFORE_FIRST`] if there is none yet.
    pub time: f64,
    /// Magnitude of the impulse of the last one [N.s, or kg.m2/s of a stop of an angle].
    pub impulse: f64,
}

impl Default for Impacts {
    fn default() -> Self {
        Self { count: 0.0, time: Self::BEFORE_FIRST, impulse: 0.0 }
    }
}

impl Impacts {
    /// Time before the first impact [s]: no time of an experiment that starts at 0.
    pub const BEFORE_FIRST: f64 = -1.0;

    /// Add `later` impacts, whose time counts from `point` [s].
    pub fn add(&mut self, later: &Self, point: f64) {
        *self = Self { count: self.count + later.count, time: point + later.time, impulse: later.impulse };
    }

    /// All fields, written or read.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        let is_count = |count: f64| count >= 0.0 && count.fract() == 0.0;
        record.number("number of impacts", &mut self.count, is_count, "a whole number, at least 0")?;
        record.finite("time of the last impact", &mut self.time)?;
        record.number("impulse of the last impact", &mut self.impulse, |impulse| impulse >= 0.0, "at least 0")
    }
}

/// An impact: sigma_dot jumps where the displacement S of a stop's load changes by `slope` for each unit of sigma.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impact {
    /// dS / d sigma.
    pub slope: f64,
    /// sigma_dot before the impact.
    pub before: f64,
    /// sigma_dot after the impact.
    pub after: f64,
}

impl Impact {
    /// A motion to a place on this side that the stop ends.
    pub fn comes_from_within(&self, side: usize) -> bool {
        self.before * outward(side) > 0.0
    }

    /// Speed S_dot before the impact [rad/s or m/s].
    pub fn speed(&self) -> f64 {
        self.slope * self.before
    }

    /// Magnitude of the impulse along S: sigma has the unit mass, so that it is |change of sigma_dot| / |dS / d sigma|.
    /// At a dead centre of S no finite impulse stops the mechanism: the largest number stands for it.
    pub fn impulse(&self) -> f64 {
        match (self.after - self.before).abs() {
            0.0 => 0.0,
            change => (change / self.slope.abs()).min(f64::MAX),
        }
    }
}
