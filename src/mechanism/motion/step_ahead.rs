//! Steps beyond the end of a communication step, from whose interpolant later communication steps read their states.
//!
//! In: inputs that have not changed for some communication steps, a step that continues beyond the last of them. Out:
//! the states up to the end of that step, each for the cost of a polynomial, as long as nothing changes. An event at
//! its end takes place when that time has come. It must not know how steps are made.
use crate::codec::record::{Damaged, Record};
use crate::integrator::Dense;
use crate::mechanism::motion::contact::EngagedLocks;
use crate::mechanism::motion::events::Event;

/// Communication steps with unchanged inputs after which an internal step may run past the communication point. Two,
/// because a wasted step costs about as much as two short ones.
const FEWEST_UNCHANGED: u32 = 2;
/// Each wasted step doubles that number, up to this one.
const MOST_UNCHANGED: u32 = 128;

/// What is another one than in the last step of an integration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outdated {
    /// The state, by a jump: of the memory the statistics remain.
    State,
    /// The right-hand side.
    Law,
    /// The revolution from which sigma is counted.
    Count,
}

/// A step that goes on beyond the present.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepAhead<const N: usize> {
    pub dense: Dense<N>,
    /// Time from the start to the end of the interpolant [s].
    pub h: f64,
    /// Time from the start of the interpolant to `end_state`, at most h [s].
    pub end: f64,
    pub end_state: [f64; N],
    pub event: Option<Event>,
    /// Time from the start of the interpolant to the present, at most `end` [s].
    pub now: f64,
    /// Subtracted from every state. The energy lost counts from the present communication step, so its value at
    /// present.
    pub origin: [f64; N],
}

impl<const N: usize> StepAhead<N> {
    /// A step with this interpolant over the time `h`, that ends with an event or none.
    pub fn new(dense: Dense<N>, h: f64, (end, end_state): (f64, [f64; N]), event: Option<Event>) -> Self {
        Self { dense, h, end, end_state, event, now: 0.0, origin: [0.0; N] }
    }

    /// Time from now to the end [s].
    pub fn rest(&self) -> f64 {
        self.end - self.now
    }

    /// Go on to the time `after` from now, 0 < after < rest; returns the state there.
    #[inline]
    pub fn read(&mut self, after: f64) -> [f64; N] {
        // The sum may be beyond the end by rounding.
        self.now = (self.now + after).min(self.end);
        let state = self.dense.at(self.now / self.h);
        let counted = difference(&state, &self.origin);
        if let (Some(origin), Some(lost)) = (self.origin.get_mut(2), state.get(2)) {
            *origin = *lost;
        }
        counted
    }

    /// State at the end.
    pub fn end_state(&self) -> [f64; N] {
        difference(&self.end_state, &self.origin)
    }

    /// State halfway from the start to the end.
    pub fn middle(&self) -> [f64; N] {
        self.dense.at(0.5 * self.end / self.h)
    }

    fn blank() -> Self {
        Self::new(Dense::blank(), 1.0, (1.0, [0.0; N]), None)
    }

    /// All fields, written or read.
    fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        self.dense.record(record)?;
        record.positive("size of the present integration step", &mut self.h)?;
        let h = self.h;
        record.number("end of the integration step", &mut self.end, |end| 0.0 < end && end <= h, "within the step")?;
        record.all_finite("state at the end of the integration step", &mut self.end_state)?;
        record.option("next event", &mut self.event, || Event::Reversal, |record, event| event.record(record))?;
        let (end, text) = (self.end, "within the integration step");
        record.number("present time", &mut self.now, |now| 0.0 <= now && now <= end, text)?;
        record.all_finite("state at the start of the integration step", &mut self.origin)
    }
}

fn difference<const N: usize>(a: &[f64; N], b: &[f64; N]) -> [f64; N] {
    std::array::from_fn(|n| a[n] - b[n])
}

/// How long tolerance, locks and inputs have not changed, and the step that goes on beyond the present, if one does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lookahead<const N: usize> {
    /// Relative tolerance.
    tolerance: f64,
    /// Places where a lock is engaged.
    locked: EngagedLocks,
    /// Communication steps with this tolerance, these locks and unchanged inputs, up to `required_steps`.
    unchanged_steps: u32,
    /// How many of them allow a step beyond the communication point.
    required_steps: u32,
    pub step_ahead: Option<StepAhead<N>>,
}

impl<const N: usize> Default for Lookahead<N> {
    fn default() -> Self {
        Self {
            tolerance: 0.0,
            locked: EngagedLocks::default(),
            unchanged_steps: 0,
            required_steps: FEWEST_UNCHANGED,
            step_ahead: None,
        }
    }
}

impl<const N: usize> Lookahead<N> {
    /// Forget everything, as before the first step.
    pub fn begin_anew(&mut self) {
        *self = Self::default();
    }

    /// A communication step begins. Returns whether the present state was read from a step ahead that no longer holds.
    pub fn begin(&mut self, tolerance: f64, locked: EngagedLocks) -> bool {
        if (tolerance, locked) == (self.tolerance, self.locked) {
            return false;
        }
        (self.tolerance, self.locked) = (tolerance, locked);
        self.invalidate()
    }

    /// The inputs have changed: a step ahead no longer holds. Returns as [`Self::begin`].
    pub fn invalidate(&mut self) -> bool {
        self.unchanged_steps = 0;
        self.step_ahead.take().is_some()
    }

    /// A communication step has ended.
    pub fn end(&mut self) {
        self.unchanged_steps = self.required_steps.min(self.unchanged_steps + 1);
    }

    /// State at the end of a communication step of `h` [s] with this tolerance and the same inputs, so with the same
    /// locks, if a step ahead extends beyond it.
    #[inline(always)]
    pub fn read_within(&mut self, h: f64, tolerance: f64) -> Option<[f64; N]> {
        if tolerance != self.tolerance {
            return None;
        }
        let state = self.step_ahead.as_mut().filter(|ahead| h < ahead.rest())?.read(h);
        self.end();
        Some(state)
    }

    /// Whether a step may go on beyond the end of a communication step.
    pub fn may_pass(&self) -> bool {
        self.unchanged_steps >= self.required_steps
    }

    /// Whether a step may go on beyond the end of a communication step, or one does.
    #[inline]
    pub fn counts(&self) -> bool {
        self.may_pass() || self.step_ahead.is_some()
    }

    /// A step goes on beyond the present; returns the state at the time `after` from its start.
    pub fn keep(&mut self, step_ahead: StepAhead<N>, after: f64) -> [f64; N] {
        self.required_steps = FEWEST_UNCHANGED;
        self.step_ahead.insert(step_ahead).read(after)
    }

    /// A step beyond was wasted: it cannot be made, or its interpolant is not exact.
    pub fn failed(&mut self) {
        (self.unchanged_steps, self.required_steps) = (0, MOST_UNCHANGED.min(2 * self.required_steps));
    }

    /// Become the same as another one; copies no more than that one has.
    #[inline]
    pub fn copy_from(&mut self, other: &Self) {
        (self.tolerance, self.locked) = (other.tolerance, other.locked);
        (self.unchanged_steps, self.required_steps) = (other.unchanged_steps, other.required_steps);
        if self.step_ahead.is_some() || other.step_ahead.is_some() {
            self.step_ahead = other.step_ahead;
        }
    }

    /// All fields, written or read.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        record.finite("tolerance of the last step", &mut self.tolerance)?;
        self.locked.record(record)?;
        record.small("unchanged steps", &mut self.unchanged_steps)?;
        record.small("required unchanged steps", &mut self.required_steps)?;
        record.option("integration step", &mut self.step_ahead, StepAhead::blank, |record, step| step.record(record))
    }
}
