//! Time since the start, summed over steps.
//!
//! In: sizes of steps. Out: their sum. It must not know what moves.
use crate::codec::record::{Damaged, Record};

/// Time since the start, summed in two parts so that many short steps do not lose it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Elapsed {
    /// The sum [s].
    pub now: f64,
    /// What the sum has lost to rounding [s].
    lost: f64,
}

impl Elapsed {
    /// This time [s] to the last digit.
    pub fn at(now: f64) -> Self {
        Self { now, lost: 0.0 }
    }

    /// The sum and what it has lost to rounding [s].
    pub fn parts(&self) -> [f64; 2] {
        [self.now, self.lost]
    }

    /// `h` [s] have gone by.
    #[inline]
    pub fn pass(&mut self, h: f64) {
        let delta = h + self.lost;
        let sum = self.now + delta;
        *self = Self { now: sum, lost: delta - (sum - self.now) };
    }

    /// Both parts, written or read.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        record.finite("time", &mut self.now)?;
        record.finite("time", &mut self.lost)
    }
}
