//! Changes between DOP853 and Radau.
//!
//! If stiffness limits DOP853, its steps cannot grow although h |lambda| is about 1 or more. The limit is near 6 at the
//! end of its interval of stability, and lower at tight tolerances, where the stiff components first affect its stages.
//! After several such steps, Radau is used. DOP853 is used again if several Radau steps are shorter than those of
//! DOP853 were. A change that did not save work doubles the number of steps before the next change. Trials therefore
//! stay a small part of the work.

use crate::codec::record::{Damaged, Record};

/// Number of limited steps before Radau is used.
const PATIENCE: u32 = 6;
/// A change that does not save work doubles the patience, up to this number.
const MOST_PATIENCE: u32 = 192;
/// Number of consecutive steps without limitation that reset the count.
const CLEARED_AFTER: u32 = 6;
/// h |lambda| from which stiffness can limit a step.
const HELD_BACK: f64 = 1.0;
/// A step that could grow by this factor was limited by the end of its span, not by stiffness.
const GROWING: f64 = 2.0;
/// Number of consecutive short steps before DOP853 is used again.
const SHORT_STEPS: u32 = 3;

/// Counters for the choice between the methods.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stiffness {
    /// Whether Radau is used.
    pub implicit: bool,
    /// With DOP853: number of limited steps. With Radau: number of consecutive short steps.
    hits: u32,
    /// Number of consecutive steps that were no hits.
    misses: u32,
    /// Number of consecutive changes that did not save work.
    failures: u32,
    /// Number of DOP853 steps that Radau has saved since the change.
    saved: f64,
    /// Size of the last explicit step that stiffness limited [s].
    explicit_h: f64,
}

impl Stiffness {
    /// Writes or reads all fields.
    ///
    /// # Errors
    /// A field that was read has a value that no choice can produce.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        record.flag("implicit", &mut self.implicit)?;
        record.small("hits", &mut self.hits)?;
        record.small("misses", &mut self.misses)?;
        record.small("failures", &mut self.failures)?;
        record.finite("saved steps", &mut self.saved)?;
        // Before the first limited step its size is 0, and Radau is not used.
        let blank = !self.implicit && self.hits == 0;
        let allowed = |h: f64| h.is_finite() && (h > 0.0 || (h == 0.0 && blank));
        record.number(
            "last explicit step",
            &mut self.explicit_h,
            allowed,
            "a finite number > 0, or 0 where no step was held back",
        )
    }

    /// Counts an accepted explicit step of size h with this h |lambda|, which could have grown by `grow`.
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

    /// Counts an explicit step with this h |lambda| that was taken back, because its interpolant was too coarse. The
    /// size h might be sufficient.
    pub fn too_coarse(&mut self, h: f64, h_lambda: f64) {
        if h_lambda > HELD_BACK {
            *self = Self { implicit: true, hits: 0, misses: 0, saved: 0.0, explicit_h: h, ..*self };
        }
    }

    /// Counts an accepted implicit step of size h. `lambda`: largest |eigenvalue|.
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
/// eighth power. The result is at most too large by the factor N^(1/8). Components need no scaling, because a trace
/// does not depend on their units. The result is too small if the largest eigenvalues are a complex pair with nearly
/// imaginary eighth powers. Such a pair is an oscillation, not stiffness.
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
    use crate::codec::writer::Writer;

    /// A recorded choice is read back unchanged, also after further steps.
    #[test]
    fn a_valid_choice_is_written_and_read_back() {
        for (implicit, hits, explicit_h) in [(false, 9, 0.0), (false, 0, 0.0), (false, 9, 5e-324), (true, 0, 5e-324)] {
            let written = |choice: &mut Stiffness| {
                let mut writer = Writer::default();
                choice.record(&mut Record::Write(&mut writer)).unwrap();
                writer.finish()
            };
            let mut choice = Stiffness { implicit, hits, explicit_h, ..Stiffness::default() };
            let bytes = written(&mut choice);
            let read = choice.record(&mut Record::Read(&bytes));
            assert_eq!(read.is_ok(), explicit_h > 0.0 || hits == 0, "{choice:?}");
            if read.is_ok() {
                (0..3).for_each(|_| choice.explicit_step(1.0, 0.5, 1.0));
                (0..3).for_each(|_| choice.implicit_step(1.0, 10.0));
                let bytes = written(&mut choice);
                choice.record(&mut Record::Read(&bytes)).unwrap();
            }
        }
    }
}
