//! Steps beyond the end of a communication step, for states that are read from an interpolant later on.
//!
//! In: inputs that have not changed for some communication steps, a step that goes on beyond the last of them. Out: the states
//! up to its end, at the cost of a polynomial each, for as long as nothing changes. What is decided at its end is decided when
//! the time has come. It must not know how steps are made.
use crate::codec::record::{Damaged, Record};
use crate::integrator::Dense;
use crate::mechanism::motion::events::Event;

/// Communication steps under unchanged inputs before a step may go on beyond one: as many as cost what is lost in vain if the
/// inputs change at once.
const CALM: u32 = 2;
/// Each step beyond that was in vain doubles this, up to so many.
const MOST_CALM: u32 = 128;

/// What must not change while an overshoot is read, besides the inputs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Conditions {
    /// Relative tolerance.
    pub tolerance: f64,
    /// Whether a lock is engaged at each end of the travel.
    pub locked: [bool; 2],
}

/// A step that goes on beyond the present.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepAhead<const N: usize> {
    /// Interpolant.
    pub dense: Dense<N>,
    /// Time that the interpolant is for [s].
    pub h: f64,
    /// Time from its start to the state `there`, at most h [s].
    pub end: f64,
    /// State at the end.
    pub there: [f64; N],
    /// What begins or ceases at the end.
    pub event: Option<Event>,
    /// Time from its start to the present, at most `end` [s].
    pub now: f64,
    /// What each component counts from: of those that start anew with a communication step, the value at present.
    pub from: [f64; N],
}

impl<const N: usize> StepAhead<N> {
    /// Time from now to the end [s].
    pub fn rest(&self) -> f64 {
        self.end - self.now
    }

    /// Go on to the time `after` from now, 0 < after < rest; returns the state there.
    pub fn read(&mut self, after: f64) -> [f64; N] {
        self.now += after;
        let state = self.dense.at(self.now / self.h);
        let counted = less(&state, &self.from);
        if let (Some(from), Some(now)) = (self.from.get_mut(2), state.get(2)) {
            *from = *now;
        }
        counted
    }

    /// State at the end.
    pub fn last(&self) -> [f64; N] {
        less(&self.there, &self.from)
    }

    /// State halfway from the start to the end.
    pub fn middle(&self) -> [f64; N] {
        self.dense.at(0.5 * self.end / self.h)
    }
}

impl<const N: usize> StepAhead<N> {
    /// To be read.
    fn blank() -> Self {
        let dense = Dense::blank();
        Self { dense, h: 1.0, end: 1.0, there: [0.0; N], event: None, now: 0.0, from: [0.0; N] }
    }

    /// All fields, written or read.
    fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        self.dense.record(record)?;
        record.positive("size of the step ahead", &mut self.h)?;
        let h = self.h;
        record.number("end of the step ahead", &mut self.end, |end| 0.0 < end && end <= h, "within the step")?;
        record.all_finite("end of the step ahead", &mut self.there)?;
        record.option("event ahead", &mut self.event, || Event::Reversal, |record, event| event.record(record))?;
        let end = self.end;
        record.number("present", &mut self.now, |now| 0.0 <= now && now <= end, "within the step ahead")?;
        record.all_finite("count", &mut self.from)
    }
}

fn less<const N: usize>(a: &[f64; N], b: &[f64; N]) -> [f64; N] {
    std::array::from_fn(|n| a[n] - b[n])
}

/// How long nothing has changed, and the step that goes on beyond the present, if one does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lookahead<const N: usize> {
    conditions: Conditions,
    /// Communication steps under these conditions and inputs, up to `enough`.
    calm: u32,
    /// How many of them allow a step beyond.
    enough: u32,
    /// The step.
    pub step_ahead: Option<StepAhead<N>>,
}

impl<const N: usize> Default for Lookahead<N> {
    fn default() -> Self {
        Self { conditions: Conditions::default(), calm: 0, enough: CALM, step_ahead: None }
    }
}

impl<const N: usize> Lookahead<N> {
    /// A communication step begins. Returns whether it begins at a state that was read, of a step that no longer holds.
    pub fn begin(&mut self, conditions: Conditions) -> bool {
        if conditions == self.conditions {
            return false;
        }
        self.conditions = conditions;
        self.forget()
    }

    /// The inputs have changed: nothing of the past holds on. Returns as [`Self::begin`].
    pub fn forget(&mut self) -> bool {
        self.calm = 0;
        self.step_ahead.take().is_some()
    }

    /// A communication step has ended.
    pub fn end(&mut self) {
        self.calm = self.enough.min(self.calm + 1);
    }

    /// Whether a step may go on beyond the end of a communication step.
    pub fn is_calm(&self) -> bool {
        self.calm >= self.enough
    }

    /// A step goes on beyond the present.
    pub fn keep(&mut self, step_ahead: StepAhead<N>) {
        (self.step_ahead, self.enough) = (Some(step_ahead), CALM);
    }

    /// A step beyond was in vain: it cannot be made, or its interpolant is not exact.
    pub fn failed(&mut self) {
        (self.calm, self.enough) = (0, MOST_CALM.min(2 * self.enough));
    }

    /// Become the same as another one; copies no more than that one has.
    #[inline]
    pub fn copy_from(&mut self, other: &Self) {
        (self.conditions, self.calm, self.enough) = (other.conditions, other.calm, other.enough);
        if self.step_ahead.is_some() || other.step_ahead.is_some() {
            self.step_ahead = other.step_ahead;
        }
    }

    /// All fields, written or read.
    ///
    /// # Errors
    /// A field is read that no integration leaves.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        let Conditions { tolerance, locked } = &mut self.conditions;
        record.finite("tolerance of the last step", tolerance)?;
        locked.iter_mut().try_for_each(|locked| record.flag("lock engaged", locked))?;
        record.small("steps without a change", &mut self.calm)?;
        record.small("steps without a change that are enough", &mut self.enough)?;
        record.option("step ahead", &mut self.step_ahead, StepAhead::blank, |record, step| step.record(record))
    }
}
