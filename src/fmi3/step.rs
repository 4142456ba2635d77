//! The step of co-simulation (4.2). With intermediate updates, the step has parts, and the host's callback reads values
//! between the parts. The contract of the pointers is that of the module `fmi3`.

use super::types::{Boolean, Environment, FALSE, Instance as Component, IntermediateUpdateCallback, Status, TRUE};
use crate::fmi::array::output;
use crate::fmi::handle;
use crate::fmi::instance::{Instance, IntermediateUpdate, Parts};
use crate::fmi::phase::{Function, INSTANTIATED, INTERMEDIATE, Phase, STEP};
use crate::fmi::refusal::{Refusal, Verdict};
use std::rc::Rc;

/// Largest number of callbacks in one step. The limit ensures that a step ends.
const MOST_UPDATES: u64 = 100_000;

/// Advances by exactly `h` [s] from the present communication point `point` [s]. `*last` is the time reached.
/// `*terminate` is always false.
///
/// With event mode and early return, the step ends at the first event, such as contact with a stop. Then
/// `*event_needed` is true, the state is that before the impact, and the next call must be `fmi3EnterEventMode`.
///
/// With a callback for intermediate updates, the callback is called after each internal step. Then values can be read
/// but not set. The step ends where the callback requests it, if early return is allowed. A step that only evaluates
/// the interpolant of a longer step has no internal steps. After a failure, the state is that of the last internal
/// step.
///
/// Rejected without any change: an `h` that is not finite and positive, a `point` that is not the instance's time, a
/// step past the stop time. The flag `noSetFMUStatePriorToCurrentPoint` has no effect, because any state can be
/// restored.
///
/// `fmi3Discard`: the step reached `solver.max_steps` before its end. The state is that at `*last`, and values can be
/// read. To continue, restore an earlier state or reset the instance.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3DoStep(
    c: Component,
    point: f64,
    h: f64,
    _no_set_state_prior: Boolean,
    event_needed: *mut Boolean,
    terminate: *mut Boolean,
    early_return: *mut Boolean,
    last: *mut f64,
) -> Status {
    const FUNCTION: Function = Function::new("fmi3DoStep", STEP);
    let answers = Answers { event_needed, terminate, early_return, last };
    let mut parts = Parts::at_most(MOST_UPDATES);
    let step = |i: &mut Instance| {
        // SAFETY: each pointer points to memory for one value (4.2.2).
        unsafe {
            if !answers.are_valid() {
                return answers.refuse();
            }
            let stepped = i.do_step(point, h, &mut parts);
            match parts.goal {
                // Fast path: a step to its end.
                None => answers.write(false, false, i.clock.time),
                Some(goal) => _ = answers.write_end(i, true, goal),
            }
            stepped
        }
    };
    // SAFETY: the instance is valid (FMI 3.0.2, 2.2.1).
    let verdict = unsafe { handle::call(c, &FUNCTION, step) };
    if parts.pauses_left < MOST_UPDATES {
        // SAFETY: as above.
        return unsafe { continue_step(c, parts, answers) };
    }
    verdict.into()
}

/// The host's memory for the results of a step. It is passed by value, so that the fast path keeps the pointers in
/// registers.
#[derive(Clone, Copy)]
struct Answers {
    event_needed: *mut Boolean,
    terminate: *mut Boolean,
    early_return: *mut Boolean,
    last: *mut f64,
}

impl Answers {
    /// Whether no pointer is NULL or misaligned.
    #[inline]
    fn are_valid(self) -> bool {
        // The least address is tested: for single tests, the compiler makes twice as many instructions, for vectors.
        let least = self.event_needed.min(self.terminate).min(self.early_return).cast();
        !self.last.min(least).is_null() && self.last.is_aligned()
    }

    /// # Errors
    /// A pointer is NULL or misaligned.
    ///
    /// # Safety
    /// Each pointer that is valid points to memory for one value.
    #[cold]
    unsafe fn refuse(self) -> Result<(), Refusal> {
        // SAFETY: guaranteed by the caller.
        unsafe {
            output("eventHandlingNeeded", self.event_needed, 1)?;
            output("terminateSimulation", self.terminate, 1)?;
            output("earlyReturn", self.early_return, 1)?;
            output("lastSuccessfulTime", self.last, 1)?;
        }
        Ok(())
    }

    /// # Safety
    /// Each pointer points to memory for one value.
    #[inline]
    unsafe fn write(self, event_needed: bool, early_return: bool, last: f64) {
        // SAFETY: guaranteed by the caller.
        unsafe {
            self.event_needed.write(event_needed.into());
            self.terminate.write(FALSE);
            self.early_return.write(early_return.into());
            self.last.write(last);
        }
    }

    /// Writes the results of a step towards the time `goal` [s] that has paused before. Returns whether the step has
    /// paused after an internal step.
    ///
    /// # Safety
    /// As for [`Self::write`].
    #[cold]
    unsafe fn write_end(self, i: &Instance, is_done: bool, goal: f64) -> bool {
        let has_paused = is_done && i.phase == Phase::Intermediate;
        // SAFETY: guaranteed by the caller.
        unsafe {
            self.write(is_done && i.awaits_event, is_done && !has_paused && i.clock.time < goal, i.clock.time);
        }
        has_paused
    }
}

/// The parts of a step after the first part. The host's callback is called before each part.
///
/// # Safety
/// As for [`fmi3DoStep`]. The pointers in `answers` are checked.
#[cold]
unsafe fn continue_step(c: Component, mut parts: Parts, answers: Answers) -> Status {
    const FUNCTION: Function = Function::new("fmi3DoStep", INTERMEDIATE);
    let goal = parts.goal.unwrap_or_default();
    let (mut end, mut warned) = (goal, false);
    loop {
        let mut pause = None;
        let begin = |i: &mut Instance| {
            pause = i.update.clone().map(|update| (i.clock.time, update));
            Ok(())
        };
        // SAFETY: the instance is valid.
        let verdict = unsafe { handle::call(c, &FUNCTION, begin) };
        let Some((from, update)) = pause else { return verdict.into() };
        // SAFETY: the instance is valid, and no call uses it.
        let requested = unsafe { handle::call_back(c, || update(from)) };
        let mut has_paused = false;
        let part = |i: &mut Instance| {
            i.phase = Phase::Step;
            end = requested.map_or(end, |stop| end.min(stop.max(from)));
            // No part remains if the callback ended the step.
            let stepped = if end > from { i.do_step(from, end - from, &mut parts) } else { Ok(()) };
            let is_done = stepped.as_ref().map_or_else(|refusal| refusal.verdict == Verdict::Warning, |()| true);
            if is_done && i.phase == Phase::Step && !i.awaits_event {
                i.clock.time = end;
            }
            // SAFETY: the pointers in `answers` are checked.
            has_paused = unsafe { answers.write_end(i, is_done, goal) };
            stepped
        };
        // SAFETY: the instance is valid.
        let verdict = unsafe { handle::call(c, &FUNCTION, part) };
        warned |= verdict == Verdict::Warning;
        if !has_paused {
            return if warned && verdict == Verdict::Ok { Status::Warning } else { verdict.into() };
        }
    }
}

/// The host's callback after internal steps. The callback may end the step if `early_return` is allowed.
pub(super) fn intermediate_update(
    callback: IntermediateUpdateCallback,
    environment: Environment,
    early_return: bool,
) -> Rc<IntermediateUpdate> {
    Rc::new(move |time| {
        let (mut is_requested, mut stop) = (FALSE, time);
        // SAFETY: FMI 3.0.2, 4.2.2: the callback may be called in fmi3DoStep, with the host's environment. Both
        // pointers point to memory for one value.
        unsafe {
            callback(environment, time, FALSE, TRUE, TRUE, early_return.into(), &mut is_requested, &mut stop);
        }
        // NaN means the present time.
        (early_return && is_requested != FALSE).then_some(if stop.is_nan() { time } else { stop })
    })
}

/// Sets the callback of a new instance after internal steps.
///
/// # Safety
/// As for `handle::call`.
pub(super) unsafe fn set_update(c: Component, update: Rc<IntermediateUpdate>) {
    const FUNCTION: Function = Function::new("fmi3InstantiateCoSimulation", INSTANTIATED);
    // SAFETY: guaranteed by the caller.
    unsafe {
        handle::call(c, &FUNCTION, |i| {
            i.update = Some(update);
            Ok(())
        })
    };
}
