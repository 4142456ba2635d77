//! What friction adds to the unknowns of its loop, foreseen from the last solutions within a step.
//!
//! In: times of a step, and what friction has added there. Out: what it adds at another time. A prediction is a start
//! for Newton's method: it changes a solution by rounding only. It holds within one step, so that rounding does not
//! depend on what came before the step. It must not know the equations.
use crate::numerics::dual::Number;

/// Unknowns of the loop for joints of one group.
pub const UNKNOWNS: usize = 3;

/// The last two solutions within a step, in memory A for what friction adds to all unknowns.
#[derive(Clone, Copy, Debug, Default)]
pub struct Prediction<A = [f64; UNKNOWNS]> {
    /// Whether a step is being made.
    in_step: bool,
    /// Number of solutions known, up to 2.
    known: usize,
    /// Their times [s], the last one first.
    times: [f64; 2],
    /// What friction has added to the unknowns.
    added: [A; 2],
}

impl<A> Prediction<A> {
    /// A step begins.
    pub fn begin(&mut self) {
        (self.in_step, self.known) = (true, 0);
    }

    /// No step is being made.
    pub fn end(&mut self) {
        (self.in_step, self.known) = (false, 0);
    }

    /// Whether a step is being made.
    pub fn is_in_step(&self) -> bool {
        self.in_step
    }

    /// Factor of the difference of the last two solutions at the time t [s], on the line through them; none if fewer
    /// are known.
    #[inline(always)]
    fn part(&self, t: f64) -> Option<f64> {
        let width = self.times[0] - self.times[1];
        (self.known == 2 && width != 0.0).then(|| (t - self.times[0]) / width)
    }

    /// A solution at the time t [s] becomes the last one; `shift` makes the one before of the present last one.
    #[inline(always)]
    fn shift(&mut self, t: f64, shift: impl FnOnce(&mut [A; 2])) {
        // Of two solutions at one time the later one counts.
        if self.known == 0 || t != self.times[0] {
            self.times[1] = self.times[0];
            shift(&mut self.added);
            self.known = (self.known + 1).min(2);
        }
        self.times[0] = t;
    }
}

impl Prediction {
    /// What friction adds at the time t [s].
    #[inline]
    pub fn at(&self, t: f64) -> [f64; UNKNOWNS] {
        let [last, before] = self.added;
        match self.part(t) {
            Some(part) => std::array::from_fn(|k| last[k] + part * (last[k] - before[k])),
            None if self.known > 0 => last,
            None => [0.0; UNKNOWNS],
        }
    }

    /// Friction has added this at the time t [s].
    #[inline]
    pub fn learn(&mut self, t: f64, added: [f64; UNKNOWNS]) {
        if self.in_step {
            self.shift(t, |added| added[1] = added[0]);
            self.added[0] = added;
        }
    }
}

impl Prediction<Vec<f64>> {
    /// No solution known, of so many unknowns.
    pub fn new(unknowns: usize) -> Self {
        Self { added: [vec![0.0; unknowns], vec![0.0; unknowns]], ..Self::default() }
    }

    /// Add to each unknown what friction adds at the time t [s].
    pub fn add_to<T: Number>(&self, t: f64, unknowns: &mut [T]) {
        let (part, [last, before]) = (self.part(t).unwrap_or(0.0), &self.added);
        if self.known > 0 {
            for ((unknown, last), before) in unknowns.iter_mut().zip(last).zip(before) {
                *unknown = *unknown + T::constant(last + part * (last - before));
            }
        }
    }

    /// At the time t [s] friction has made these unknowns of those `without` it.
    pub fn learn<T: Number>(&mut self, t: f64, unknowns: &[T], without: &[f64]) {
        if self.in_step {
            self.shift(t, |added| added.swap(0, 1));
            for ((added, unknown), without) in self.added[0].iter_mut().zip(unknowns).zip(without) {
                *added = unknown.value() - without;
            }
        }
    }
}
