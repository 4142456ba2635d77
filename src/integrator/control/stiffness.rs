//! When DOP853 gives way to Radau, and Radau to DOP853.
//!
//! DOP853 held back by stiffness cannot lengthen its steps though h |lambda| is about 1 or more: near 6 at the end of
//! its interval of stability, less at tight tolerances, where the stiff components spoil its stages first. Once it has
//! been so for a few steps Radau takes over. It gives back when, for a few, its steps are shorter than those of DOP853
//! were. A change that did not pay doubles the number of steps before the next one, so that trials stay a small part of
//! the work.

use crate::codec::record::{Damaged, Record};

/// Steps held back before Radau takes over.
const PATIENCE: u32 = 6;
/// A change that does not pay doubles the patience, up to this.
const MOST_PATIENCE: u32 = 192;
/// Steps in a row not held back that clear the count.
const CLEARED_AFTER: u32 = 6;
/// h |lambda| from which a step can be held back.
const HELD_BACK: f64 = 1.0;
/// A step that could grow by this was not held back, but cut short by the end of its span.
const GROWING: f64 = 2.0;
/// Short steps in a row before DOP853 takes over.
const SHORT_STEPS: u32 = 3;

/// Counts of the choice between the methods.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stiffness {
    /// Whether Radau is at work.
    pub implicit: bool,
    /// Explicit: steps held back. Implicit: short steps in a row.
    hits: u32,
    /// Steps in a row that were no hits.
    misses: u32,
    /// Changes in a row that have not paid.
    failures: u32,
    /// Steps of DOP853 that Radau has saved since it took over.
    saved: f64,
    /// Size of the last explicit step that was held back [s].
    explicit_h: f64,
}

impl Stiffness {
    /// All fields, written or read.
    ///
    /// # Errors
    /// A field is read that no choice leaves.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        record.flag("implicit", &mut self.implicit)?;
        record.small("hits", &mut self.hits)?;
        record.small("misses", &mut self.misses)?;
        record.small("failures", &mut self.failures)?;
        record.finite("saved steps", &mut self.saved)?;
        // Without a step that was held back there is no size of one, and Radau does not take over.
        let blank = !self.implicit && self.hits == 0;
        let allowed = |h: f64| h.is_finite() && (h > 0.0 || (h == 0.0 && blank));
        record.number(
            "last explicit step",
            &mut self.explicit_h,
            allowed,
            "a finite number > 0, or 0 where no step was held back",
        )
    }

    /// An explicit step of size h at this h |lambda|, that could have grown by `grow`, has been accepted.
    pub fn explicit_step(&mut self, h: f64, h_lambda: f64, grow: f64) {
        if h_lambda > HELD_BACK && grow < GROWING {
            (self.hits, self.misses, self.explicit_h) = (self.hits + 1, 0, h);
        } else {
            self.misses += 1;
            if self.misses >= CLEARED_AFTER {
                self.hits = 0;
            }
        }
        if self.hits >= self.patience() {
            *self = Self { implicit: true, hits: 0, misses: 0, saved: 0.0, ..*self };
        }
    }

    /// An explicit step at this h |lambda| has been taken back, as its interpolant was too coarse; one of the size h
    /// might not be.
    pub fn too_coarse(&mut self, h: f64, h_lambda: f64) {
        if h_lambda > HELD_BACK {
            *self = Self { implicit: true, hits: 0, misses: 0, saved: 0.0, explicit_h: h, ..*self };
        }
    }

    /// An implicit step of size h where |lambda| is the largest eigenvalue has been accepted.
    pub fn implicit_step(&mut self, h: f64, lambda: f64) {
        self.saved = (self.saved + h / self.explicit_h - 1.0).min(f64::MAX);
        if h * lambda >= HELD_BACK.max(self.explicit_h * lambda) {
            self.hits = 0;
            return;
        }
        self.hits += 1;
        if self.hits >= SHORT_STEPS {
            let failures = if self.saved >= f64::from(self.patience()) { 0 } else { self.failures + 1 };
            *self = Self { failures, ..Self::default() };
        }
    }

    fn patience(&self) -> u32 {
        (PATIENCE << self.failures.min(16)).min(MOST_PATIENCE)
    }
}

/// The largest |eigenvalue| of a real matrix whose columns after the first `leading` are 0, from the trace of its
/// eighth power: at most the factor N^(1/8) too large. It needs no scaling of the components, as a trace does not
/// depend on their units. Too small where the largest are a complex pair whose eighth powers are nearly imaginary:
/// oscillation, which is not stiffness.
pub fn largest_eigenvalue<const N: usize>(a: &[[f64; N]; N], leading: usize) -> f64 {
    let fourth = square(&square(a, leading), leading);
    let trace: f64 = (0..leading).map(|i| (0..leading).map(|j| fourth[i][j] * fourth[j][i]).sum::<f64>()).sum();
    trace.abs().sqrt().sqrt().sqrt()
}

/// Square of the leading part of a matrix.
#[inline]
fn square<const N: usize>(m: &[[f64; N]; N], leading: usize) -> [[f64; N]; N] {
    let mut square = [[0.0; N]; N];
    for (i, row) in square.iter_mut().enumerate().take(leading) {
        for (j, entry) in row.iter_mut().enumerate().take(leading) {
            *entry = (0..leading).map(|k| m[i][k] * m[k][j]).sum();
        }
    }
    square
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is written of a choice is read back, whatever its fields were when it was read first.
    #[test]
    fn a_choice_that_is_taken_is_written_and_read_back() {
        for (implicit, hits, explicit_h) in [(false, 9, 0.0), (false, 0, 0.0), (false, 9, 5e-324), (true, 0, 5e-324)] {
            let mut bytes = Vec::new();
            let mut choice = Stiffness { implicit, hits, explicit_h, ..Stiffness::default() };
            choice.record(&mut Record::Write(&mut bytes)).unwrap();
            let read = choice.record(&mut Record::Read(&bytes));
            assert_eq!(read.is_ok(), explicit_h > 0.0 || hits == 0, "{choice:?}");
            if read.is_ok() {
                (0..3).for_each(|_| choice.explicit_step(1.0, 0.5, 1.0));
                (0..3).for_each(|_| choice.implicit_step(1.0, 10.0));
                bytes.clear();
                choice.record(&mut Record::Write(&mut bytes)).unwrap();
                choice.record(&mut Record::Read(&bytes)).unwrap();
            }
        }
    }
}
