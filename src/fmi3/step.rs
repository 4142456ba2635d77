//! The step of co-simulation (4.2), in parts between which the host's callback for intermediate updates reads values.
//! The contract of the pointers is that of the module `fmi3`.

use super::types::{Boolean, Environment, FALSE, Instance as Component, IntermediateUpdateCallback, Status, TRUE};
use crate::fmi::array::output;
use crate::fmi::handle;
use crate::fmi::instance::{Instance, IntermediateUpdate};
use crate::fmi::phase::{Function, INSTANTIATED, INTERMEDIATE, Phase, STEP};
use crate::fmi::refusal::{Refusal, Verdict};
use std::rc::Rc;

/// Most internal steps of one step that are told, so that a step ends.
const MOST_UPDATES: u64 = 100_000;

/// Advance by exactly `h` [s] from the present communication point `point` [s]. `*last` is the time reached; the end of
/// the simulation is never asked for.
///
/// With event mode and early return the step ends where a stop is met or lets go, if that comes first: then
/// `*event_needed` is true, the state is that before the impact, and the next call is `fmi3EnterEventMode`.
///
/// With a callback for intermediate updates the step tells each of its internal steps within it, after which values can
/// be read and none set, and ends where the callback asks for it, if early return is allowed. Steps that are read from
/// a longer one have no internal steps. After a failure the state is then that of the last internal step.
///
/// Refused, without any change, for an `h` that is not finite and positive, for another point than the instance's own,
/// and for a step past the stop time. The flag `noSetFMUStatePriorToCurrentPoint` has no meaning here: any state can be
/// restored.
///
/// `fmi3Discard`: the step met `solver.max_steps` after a part of it. The state is that at `*last`, where values can be
/// read; to go on, a state saved before is restored or the instance reset.
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
    let (mut pauses_left, mut has_paused) = (MOST_UPDATES, false);
    let step = |i: &mut Instance| {
        // SAFETY: each pointer leads to memory for one value (4.2.2).
        unsafe {
            answers.check()?;
            let stepped = i.do_step(point, h, &mut pauses_left);
            // The usual end of a step costs about as little as in FMI 2.0.
            if stepped.is_ok() && i.phase == Phase::Step {
                answers.write(i.awaits_event, i.clock.time < point + h, i.clock.time);
            } else {
                has_paused = answers.tell(i, is_done(&stepped), point + h);
            }
            stepped
        }
    };
    // SAFETY: the instance is valid (FMI 3.0.2, 2.2.1).
    let verdict = unsafe { handle::call(c, &FUNCTION, step) };
    if has_paused {
        // SAFETY: as above.
        return unsafe { go_on(c, point + h, pauses_left, &answers) };
    }
    verdict.into()
}

/// Where the host wants to be told how a step has ended.
struct Answers {
    event_needed: *mut Boolean,
    terminate: *mut Boolean,
    early_return: *mut Boolean,
    last: *mut f64,
}

impl Answers {
    /// # Errors
    /// A pointer is NULL or misaligned.
    ///
    /// # Safety
    /// Each pointer that is valid leads to memory for one value.
    #[inline]
    unsafe fn check(&self) -> Result<(), Refusal> {
        // SAFETY: the caller's promise.
        unsafe {
            output("eventHandlingNeeded", self.event_needed, 1)?;
            output("terminateSimulation", self.terminate, 1)?;
            output("earlyReturn", self.early_return, 1)?;
            output("lastSuccessfulTime", self.last, 1)?;
        }
        Ok(())
    }

    /// # Safety
    /// As for [`Self::check`], which they have passed.
    #[inline]
    unsafe fn write(&self, event_needed: bool, early_return: bool, last: f64) {
        // SAFETY: the caller's promise.
        unsafe {
            self.event_needed.write(event_needed.into());
            self.terminate.write(FALSE);
            self.early_return.write(early_return.into());
            self.last.write(last);
        }
    }

    /// Tell how a step has ended that was to reach the time `end` [s]; whether it has paused after an internal step.
    ///
    /// # Safety
    /// As for [`Self::write`].
    #[cold]
    unsafe fn tell(&self, i: &Instance, is_done: bool, end: f64) -> bool {
        let has_paused = is_done && i.phase == Phase::Intermediate;
        // SAFETY: the caller's promise.
        unsafe {
            self.write(is_done && i.awaits_event, is_done && !has_paused && i.clock.time < end, i.clock.time);
        }
        has_paused
    }
}

/// Whether a step was made, if with a warning.
fn is_done(stepped: &Result<(), Refusal>) -> bool {
    stepped.as_ref().map_or_else(|refusal| refusal.verdict == Verdict::Warning, |()| true)
}

/// The parts of a step after the first one, each after a call of the host's callback, until `goal` [s].
///
/// # Safety
/// As for [`fmi3DoStep`]; the answers are checked.
#[cold]
unsafe fn go_on(c: Component, goal: f64, mut pauses_left: u64, answers: &Answers) -> Status {
    const FUNCTION: Function = Function::new("fmi3DoStep", INTERMEDIATE);
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
        // SAFETY: the instance is valid, and no call is at work on it.
        let asked = unsafe { handle::call_back(c, || update(from)) };
        let mut has_paused = false;
        let part = |i: &mut Instance| {
            i.phase = Phase::Step;
            end = asked.map_or(end, |stop| end.min(stop.max(from)));
            // Nothing is left where the callback has ended the step.
            let stepped = if end > from { i.do_step(from, end - from, &mut pauses_left) } else { Ok(()) };
            let is_done = is_done(&stepped);
            if is_done && i.phase == Phase::Step && !i.awaits_event {
                i.clock.time = end;
            }
            // SAFETY: the answers are checked.
            has_paused = unsafe { answers.tell(i, is_done, goal) };
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

/// The host's callback after internal steps. It may ask for the end of the step if `early_return` is allowed.
pub(super) fn intermediate_update(
    callback: IntermediateUpdateCallback,
    environment: Environment,
    early_return: bool,
) -> Rc<IntermediateUpdate> {
    Rc::new(move |time| {
        let (mut is_asked, mut stop) = (FALSE, time);
        // SAFETY: FMI 3.0.2, 4.2.2: the callback may be called within fmi3DoStep, with its own environment. Both
        // pointers lead to memory for one value.
        unsafe {
            callback(environment, time, FALSE, TRUE, TRUE, early_return.into(), &mut is_asked, &mut stop);
        }
        // A time that is no number is now.
        (early_return && is_asked != FALSE).then_some(if stop.is_nan() { time } else { stop })
    })
}

/// Let a new instance call the host back after internal steps.
///
/// # Safety
/// As for `handle::call`.
pub(super) unsafe fn set_update(c: Component, update: Rc<IntermediateUpdate>) {
    const FUNCTION: Function = Function::new("fmi3InstantiateCoSimulation", INSTANTIATED);
    // SAFETY: the caller's promise.
    unsafe {
        handle::call(c, &FUNCTION, |i| {
            i.update = Some(update);
            Ok(())
        })
    };
}
