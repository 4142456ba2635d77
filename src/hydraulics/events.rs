//! The first event within a step of an integration.
//!
//! In: guards, numbers that change their sign at events; a step. Out: the part of the step up to its first event. It
//! must not know what a guard stands for.
use foundation::integrator::{Dense, Step};

/// Part of the size of a guard within which it is at its event.
const NEAR: f64 = 1e-6;
/// Most halvings that find an event.
const HALVINGS: usize = 60;

/// A guard at one instant.
#[derive(Clone, Copy, Debug)]
pub struct Guard {
    value: f64,
    near: f64,
    /// Whether its event is due for as long as the value is positive; else at a change of the sign.
    is_due: bool,
}

/// How near a guard must be to its event to be at it, as a part of its size, for a tolerance of the integration.
pub fn nearness(tolerance: f64) -> f64 {
    NEAR.max(10.0 * tolerance)
}

impl Guard {
    /// Of an event that does not exist.
    pub const NONE: Self = Self { value: 1.0, near: 0.0, is_due: false };

    /// Of an event where a number passes a level. `size`: of the number, for its rounding.
    pub fn of(number: f64, level: f64, size: f64, tolerance: f64) -> Self {
        Self { value: number - level, near: nearness(tolerance) * size.abs(), is_due: false }
    }

    /// Of an event that is due for as long as a value is positive.
    pub fn due(value: f64, size: f64, tolerance: f64) -> Self {
        Self { value, near: nearness(tolerance) * size.abs(), is_due: true }
    }

    /// Whether this guard at the start of a step and another one at its end have an event between them. An event at the
    /// start is none of the step.
    fn passes(self, end: Self) -> bool {
        if self.is_due {
            return self.value < -self.near && end.value >= -end.near || end.value > end.near;
        }
        self.value.abs() > self.near && (self.value * end.value <= 0.0 || end.value.abs() <= end.near)
    }
}

/// The first of `count` events within a step, by its index, and the part of the step up to it. `guard`: the guard of an
/// index at a time and a state.
#[cold]
pub fn first<const N: usize>(
    count: usize,
    step: &Step<N>,
    guard: &dyn Fn(usize, f64, &[f64; N]) -> Guard,
    dense: impl FnOnce() -> Dense<N>,
) -> Option<(usize, f64)> {
    let ends = |index| [guard(index, step.t, &step.start), guard(index, step.t + step.h, &step.end)];
    let has_passed = |index: &usize| {
        let [start, end] = ends(*index);
        start.passes(end)
    };
    let candidates = || (0..count).filter(has_passed);
    candidates().next()?;
    let dense = dense();
    let part = |index: usize| {
        let [start, end] = ends(index);
        if start.value * end.value >= 0.0 {
            return 1.0;
        }
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            let value = guard(index, step.t + middle * step.h, &dense.at(middle)).value;
            if value * end.value >= 0.0 { high = middle } else { low = middle }
        }
        high
    };
    candidates().map(|index| (index, part(index))).min_by(|one, other| one.1.total_cmp(&other.1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_event_is_a_change_of_sign_away_from_the_start() {
        let guard = |value| Guard::of(value, 0.0, 1.0, 1e-9);
        assert!(guard(-1.0).passes(guard(2.0)) && guard(1.0).passes(guard(0.0)) && guard(1.0).passes(guard(1e-7)));
        assert!(!guard(1e-7).passes(guard(-2.0)) && !guard(0.0).passes(guard(2.0)) && !guard(2.0).passes(guard(1.0)));
        assert!(!Guard::NONE.passes(Guard::NONE));
    }

    #[test]
    fn an_event_that_is_due_waits_for_its_handling() {
        let guard = |value| Guard::due(value, 1.0, 1e-9);
        assert!(guard(-1.0).passes(guard(2.0)) && guard(1.0).passes(guard(2.0)) && guard(0.0).passes(guard(2.0)));
        assert!(!guard(2.0).passes(guard(-1.0)) && !guard(0.0).passes(guard(1e-7)));
    }
}
