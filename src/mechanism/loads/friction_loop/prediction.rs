//! What friction adds to the unknowns of its loop, foreseen from the last solutions within a step.
//!
//! In: times of a step, and what friction has added there. Out: what it adds at another time. A prediction is a start
//! for Newton's method: it changes a solution by rounding only. It holds within one step, so that rounding does not
//! depend on what came before the step. It must not know the equations.

/// The last two solutions within a step, in memory A for what friction adds to each unknown.
#[derive(Clone, Copy, Debug, Default)]
pub struct Prediction<A> {
    /// Whether a step is being made.
    in_step: bool,
    /// Number of solutions known, up to 2.
    known: usize,
    /// Their times [s], the last one first.
    times: [f64; 2],
    /// What friction has added to the unknowns.
    added: [A; 2],
}

impl<A: AsRef<[f64]> + AsMut<[f64]>> Prediction<A> {
    /// No solution known, with this memory.
    pub fn new(memory: A) -> Self
    where
        A: Clone,
    {
        Self { in_step: false, known: 0, times: [0.0; 2], added: [memory.clone(), memory] }
    }

    /// A step begins.
    pub fn begin(&mut self) {
        (self.in_step, self.known) = (true, 0);
    }

    /// No step is being made.
    pub fn end(&mut self) {
        (self.in_step, self.known) = (false, 0);
    }

    /// What friction adds to an unknown at the time t [s]: on the line through the last two solutions.
    #[inline(always)]
    pub fn at(&self, t: f64) -> impl Fn(usize) -> f64 {
        let ([last, before], width) = (self.added.each_ref().map(A::as_ref), self.times[0] - self.times[1]);
        let part = if self.known < 2 || width == 0.0 { 0.0 } else { (t - self.times[0]) / width };
        let is_known = self.known > 0;
        move |k| if is_known { last[k] + part * (last[k] - before[k]) } else { 0.0 }
    }

    /// Friction has added this at the time t [s].
    #[inline(always)]
    pub fn learn(&mut self, t: f64, added: impl Iterator<Item = f64>) {
        if !self.in_step {
            return;
        }
        // Of two solutions at one time the later one counts.
        if self.known == 0 || t != self.times[0] {
            self.times[1] = self.times[0];
            self.added.swap(0, 1);
            self.known = (self.known + 1).min(2);
        }
        self.times[0] = t;
        self.added[0].as_mut().iter_mut().zip(added).for_each(|(own, added)| *own = added);
    }
}
