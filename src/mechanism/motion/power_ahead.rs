//! The power that leaves the mechanism under a prescribed motion, over a time that goes on beyond the present.
//!
//! In: the power at nodes of a time. Out: the energy lost in each step within this time, for the cost of a polynomial.
//! It must not know how the power is found.
use crate::codec::record::{Damaged, Record};
use crate::numerics::kronrod::interpolant;

/// Part of the time by which its end may be missed by rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Power that leaves the mechanism, less that of the drive, over a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerAhead {
    /// Energy lost from the middle of the time to x = 2 u - 1, with u from 0 to 1 over the time [J]: coefficients of
    /// x, x^2 and so on.
    energy: [f64; 7],
    /// Length of the time [s].
    width: f64,
    /// Length of the next time beyond a step to be tried [s].
    pub next: f64,
    /// Time from its beginning to the present [s].
    pub now: f64,
    /// Whether the mechanism is at rest until its end.
    pub is_at_rest: bool,
}

impl PowerAhead {
    /// The power over a time of this width [s] that begins at present, from its values [W] at the nodes of
    /// `numerics/kronrod.rs`.
    pub fn new(power: &[f64; 7], width: f64, is_at_rest: bool) -> Self {
        let mut energy = interpolant(power);
        energy.iter_mut().zip(1..).for_each(|(c, order)| *c *= 0.5 * width / f64::from(order));
        Self { energy, width, next: 0.0, now: 0.0, is_at_rest }
    }

    /// Time from the present to its end [s], 0 at the end within rounding.
    #[inline]
    pub fn rest(&self) -> f64 {
        let rest = self.width - self.now;
        if rest > ROUNDING * self.width { rest } else { 0.0 }
    }

    /// Go on by a time [s], at most the rest; returns the energy lost in it [J].
    #[inline]
    pub fn read(&mut self, after: f64) -> f64 {
        let [now, lost] = self.after(after);
        self.now = now;
        lost
    }

    /// What [`Self::now`] is after a time [s], at most the rest, and the energy lost in this time [J].
    #[inline]
    pub fn after(&self, time: f64) -> [f64; 2] {
        // The sum may be beyond the end by rounding.
        let now = (self.now + time).min(self.width);
        [now, self.lost(now) - self.lost(self.now)]
    }

    /// Energy lost from the middle of the time to `now` [J].
    #[inline]
    fn lost(&self, now: f64) -> f64 {
        let x = 2.0 * (now / self.width) - 1.0;
        self.energy.iter().rev().fold(0.0, |sum, c| (sum + c) * x)
    }

    /// What a record is read into.
    pub fn blank() -> Self {
        Self { energy: [0.0; 7], width: 1.0, next: 0.0, now: 0.0, is_at_rest: false }
    }

    /// All fields, written or read.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        record.all_finite("predicted energy", &mut self.energy)?;
        record.positive("duration of the predicted power", &mut self.width)?;
        let allowed = |next: f64| next >= 0.0 && next.is_finite();
        record.number("next duration of the predicted power", &mut self.next, allowed, "a finite number >= 0")?;
        let (width, text) = (self.width, "within the duration of the predicted power");
        record.number("present time", &mut self.now, |now| 0.0 <= now && now <= width, text)?;
        record.flag("predicted rest", &mut self.is_at_rest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::kronrod::{NODES, means};

    #[test]
    fn the_energy_lost_in_parts_is_that_of_the_whole() {
        let power = NODES.map(|u| (2.0 * u).cos());
        let exact = |t: f64| 0.5 * 3.0 * (2.0 * t / 3.0).sin();
        let mut ahead = PowerAhead::new(&power, 3.0, false);
        let mut sum = 0.0;
        for k in 1..=10 {
            sum += ahead.read(0.3);
            assert!((sum - exact(0.3 * f64::from(k))).abs() < 1e-6, "{k} {sum}");
        }
        assert_eq!(ahead.rest(), 0.0);
        assert!((sum - 3.0 * means(&power)[0]).abs() < 1e-14);
    }
}
