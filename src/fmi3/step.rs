//! The step of co-simulation (4.2), in parts between which the host's callback for intermediate updates reads values. The
//! contract of the pointers is that of the module `fmi3`.

use super::types::{Boolean, Environment, FALSE, Instance as Component, IntermediateUpdateCallback, Status, TRUE};
use crate::fmi::array::output;
use crate::fmi::handle;
use crate::fmi::instance::{Instance, IntermediateUpdate};
use crate::fmi::phase::{Function, INSTANTIATED, INTERMEDIATE, Phase, STEP};
use crate::fmi::refusal::Verdict;
use std::rc::Rc;

/// Most internal steps of one step that are told, so that a step ends.
const MOST_UPDATES: u64 = 100_000;

/// Advance by exactly `h` [s] from the present communication point `point` [s]. `*last` is the time reached; the end of the
/// simulation is never asked for.
///
/// With event mode and early return the step ends where a stop is met or lets go, if that comes first: then `*event_needed`
/// is true, the state is that before the impact, and the next call is [`fmi3EnterEventMode`].
///
/// With a callback for intermediate updates the step tells each of its internal steps within it, after which values can be
/// read and none set, and ends where the callback asks for it, if early return is allowed. Steps that are read from a
/// longer one have no internal steps. After a failure the state is then that of the last internal step.
///
/// Refused, without any change, for an `h` that is not finite and positive, for another point than the instance's own, and
/// for a step past the stop time. The flag `noSetFMUStatePriorToCurrentPoint` has no meaning here: any state can be
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
    const BEGIN: Function = Function::new("fmi3DoStep", STEP);
    const GO_ON: Function = Function::new("fmi3DoStep", INTERMEDIATE);
    let (mut pauses_left, mut end, mut warned) = (MOST_UPDATES, point + h, false);
    // Time of the present part of the step, and what is left of it [s].
    let (mut from, mut rest) = (point, h);
    let mut asked: Option<std::thread::Result<Option<f64>>> = None;
    let mut function = &BEGIN;
    loop {
        let mut update = None;
        let part = |i: &mut Instance| {
            // SAFETY: each pointer leads to memory for one value (4.2.2).
            let (flags, last) = unsafe {
                let event_needed = output("eventHandlingNeeded", event_needed, 1)?;
                let terminate = output("terminateSimulation", terminate, 1)?;
                let early_return = output("earlyReturn", early_return, 1)?;
                ([event_needed, terminate, early_return], output("lastSuccessfulTime", last, 1)?)
            };
            if let Some(asked) = asked.take() {
                i.phase = Phase::Step;
                // What the callback has thrown makes the instance unusable.
                let stop = asked.unwrap_or_else(|payload| std::panic::resume_unwind(payload));
                end = stop.map_or(end, |stop| end.min(stop.max(from)));
                rest = end - from;
            }
            let stepped = if rest > 0.0 || function.is_legal_in(Phase::Step) {
                i.do_step(from, rest, &mut pauses_left)
            } else {
                Ok(())
            };
            let is_done = stepped.as_ref().map_or_else(|refusal| refusal.verdict == Verdict::Warning, |()| true);
            if is_done && i.phase == Phase::Intermediate {
                (from, update) = (i.clock.time, i.update.clone());
            } else if is_done && !i.awaits_event && from != point {
                i.clock.time = end;
            }
            let is_early = is_done && i.phase != Phase::Intermediate && i.clock.time < point + h;
            let values = [is_done && i.awaits_event, false, is_early];
            flags.into_iter().zip(values).for_each(|(flag, value)| _ = flag[0].write(value.into()));
            last[0].write(i.clock.time);
            stepped
        };
        // SAFETY: the instance is valid (FMI 3.0.2, 2.2.1).
        let verdict = unsafe { handle::call(c, function, part) };
        warned |= verdict == Verdict::Warning;
        let Some(update) = update else {
            return if warned && verdict == Verdict::Ok { Status::Warning } else { verdict.into() };
        };
        // SAFETY: the instance is valid, and no call is at work on it.
        asked = Some(unsafe { handle::call_back(c, || update(from)) });
        function = &GO_ON;
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
        // SAFETY: FMI 3.0.2, 4.2.2: the callback may be called within fmi3DoStep, with its own environment. Both pointers
        // lead to memory for one value.
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
