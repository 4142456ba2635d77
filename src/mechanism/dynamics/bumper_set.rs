//! A set of bumpers, such as those that push.
//!
//! In: indices of bumpers. Out: which are in the set. It must not know what a bumper does.
use crate::codec::record::{Damaged, Record};

/// A set of bumpers by their indices among those of the state loads, each below [`BumperSet::CAPACITY`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BumperSet(u64);

impl BumperSet {
    /// Most bumpers of a mechanism that may be enabled.
    pub const CAPACITY: usize = u64::BITS as usize;

    /// No bumpers.
    pub const EMPTY: Self = Self(0);

    /// The set of the bumpers below `count` for which this holds.
    pub fn of(count: usize, mut holds: impl FnMut(usize) -> bool) -> Self {
        (0..count).filter(|&bumper| holds(bumper)).fold(Self::EMPTY, Self::with)
    }

    #[inline]
    pub fn contains(self, bumper: usize) -> bool {
        self.0 >> bumper & 1 != 0
    }

    /// The set with this bumper.
    #[inline]
    #[must_use]
    pub fn with(self, bumper: usize) -> Self {
        Self(self.0 | 1 << bumper)
    }

    /// The set without this bumper.
    #[inline]
    #[must_use]
    pub fn without(self, bumper: usize) -> Self {
        Self(self.0 & !(1 << bumper))
    }

    /// The bumpers in one of the sets, or in both.
    #[inline]
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// The bumpers in both sets.
    #[must_use]
    pub fn intersection(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }

    /// Whether every bumper of the set is below `count`.
    pub fn is_below(self, count: usize) -> bool {
        self.0.checked_shr(count as u32).unwrap_or(0) == 0
    }

    /// The set, written or read.
    ///
    /// # Errors
    /// The record has ended.
    #[inline]
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        record.word(&mut self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_set_holds_what_was_put_in() {
        let set = BumperSet::default().with(0).with(63).with(5).without(0);
        assert_eq!(set, BumperSet::of(64, |k| k == 5 || k == 63));
        assert!(set.contains(63) && set.contains(5) && !set.contains(0));
        assert!(set.is_below(64) && !set.is_below(63) && BumperSet::default().is_below(0));
    }
}
