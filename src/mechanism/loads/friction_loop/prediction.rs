//! What friction adds to the unknowns of its loop, foreseen from the last solutions within a step.
//!
//! In: times of a step, and what friction has added there. Out: what it adds at another time. A prediction is a start
//! for Newton's method: it changes a solution by rounding only. It holds within one step, so that rounding does not
//! depend on what came before the step. It must not know the equations.

/// Unknowns of the loop for joints of one group.
pub const UNKNOWNS: usize = 3;

/// The last two solutions within a step.
#[derive(Clone, Copy, Debug, Default)]
pub struct Prediction {
    /// Whether a step is being made.
    in_step: bool,
    /// Number of solutions known, up to 2.
    known: usize,
    /// Their times [s], the last one first.
    times: [f64; 2],
    /// What friction has added to the unknowns.
    added: [[f64; UNKNOWNS]; 2],
}

impl Prediction {
    /// A step begins.
    pub fn begin(&mut self) {
        (self.in_step, self.known) = (true, 0);
    }

    /// No step is being made.
    pub fn end(&mut self) {
        (self.in_step, self.known) = (false, 0);
    }

    /// What friction adds at the time t [s]: on the line through the last two solutions.
    #[inline]
    pub fn at(&self, t: f64) -> [f64; UNKNOWNS] {
        let ([last, before], width) = (self.added, self.times[0] - self.times[1]);
        if self.known < 2 || width == 0.0 {
            return last_or_none(self.known, last);
        }
        let part = (t - self.times[0]) / width;
        std::array::from_fn(|k| last[k] + part * (last[k] - before[k]))
    }

    /// Friction has added this at the time t [s].
    #[inline]
    pub fn learn(&mut self, t: f64, added: [f64; UNKNOWNS]) {
        if !self.in_step {
            return;
        }
        // Of two solutions at one time the later one counts.
        if self.known == 0 || t != self.times[0] {
            (self.times[1], self.added[1]) = (self.times[0], self.added[0]);
            self.known = (self.known + 1).min(2);
        }
        (self.times[0], self.added[0]) = (t, added);
    }
}

fn last_or_none(known: usize, last: [f64; UNKNOWNS]) -> [f64; UNKNOWNS] {
    if known > 0 { last } else { [0.0; UNKNOWNS] }
}
