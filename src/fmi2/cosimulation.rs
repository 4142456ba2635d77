//! The functions of co-simulation (FMI 2.0.5, 4.2). The contract of the pointers is that of the module `fmi2`.

use super::types::{Boolean, Component, FALSE, Integer, Real, Status, Text};
use super::types::{DO_STEP_STATUS, LAST_SUCCESSFUL_TIME, PENDING_STATUS, TERMINATED};
use crate::fmi::array::output;
use crate::fmi::handle;
use crate::fmi::phase::{ALIVE, Function, Phase, STEP, STEPPED};
use crate::fmi::refusal::Refusal;
use std::ffi::c_int;

exported! {
    /// Advance by exactly `h` [s] from the present communication point `point` [s].
    ///
    /// Refused, without any change, for an `h` that is not finite and positive, for another point than the instance's
    /// own, and for a step past the stop time. Steps are synchronous. The last argument has no meaning here: any state
    /// can be restored.
    fn fmi2DoStep(point: Real, h: Real, _no_set_state_prior: Boolean) in STEP => |i| i.do_step(point, h);

    /// Always an error: no step is asynchronous, so that there is none to cancel.
    fn fmi2CancelStep() in ALIVE => |_i|
        Err(Refusal::error("no step is in progress; fmi2DoStep returns when its step is done"));

    /// `fmi2DoStepStatus`: how the last step ended.
    // SAFETY: `value` leads to memory for one value (4.2.3).
    fn fmi2GetStatus(kind: c_int, value: *mut Status) in STEPPED => |i| {
        let last = if i.phase == Phase::Failed { Status::Error } else { Status::Ok };
        answer(value, kind, DO_STEP_STATUS, last)
    };

    /// `fmi2LastSuccessfulTime`: end of the last successful step [s].
    // SAFETY: `value` leads to memory for one value (4.2.3).
    fn fmi2GetRealStatus(kind: c_int, value: *mut Real) in STEPPED => |i|
        answer(value, kind, LAST_SUCCESSFUL_TIME, i.time());

    /// No status is an Integer: always `fmi2Discard`.
    fn fmi2GetIntegerStatus(kind: c_int, _value: *mut Integer) in STEPPED => |_i| Err(no_such_status(kind));

    /// `fmi2Terminated`: always false, as no model asks for the end of the simulation.
    // SAFETY: `value` leads to memory for one value (4.2.3).
    fn fmi2GetBooleanStatus(kind: c_int, value: *mut Boolean) in STEPPED => |_i| answer(value, kind, TERMINATED, FALSE);

    /// `fmi2PendingStatus` has no answer, as no step is ever pending: always `fmi2Discard`.
    fn fmi2GetStringStatus(kind: c_int, _value: *mut Text) in STEPPED => |_i| Err(no_such_status(kind));
}

/// Write the answer to the status kind that the called function has.
///
/// # Safety
/// As for `array::output` of one element.
unsafe fn answer<T>(value: *mut T, kind: c_int, known: c_int, status: T) -> Result<(), Refusal> {
    // SAFETY: the caller's promise.
    let value = unsafe { output("value", value, 1) }?;
    if kind != known {
        return Err(no_such_status(kind));
    }
    value[0].write(status);
    Ok(())
}

/// Refusal of a status kind that the called function does not have.
fn no_such_status(kind: c_int) -> Refusal {
    match kind {
        DO_STEP_STATUS..=TERMINATED => {
            let name = ["fmi2DoStepStatus", "fmi2PendingStatus", "fmi2LastSuccessfulTime", "fmi2Terminated"];
            let hint = if kind == PENDING_STATUS { "; steps are never pending here" } else { "" };
            Refusal::discard(format!("no answer to {}{hint}", name[kind as usize]))
        }
        _ => Refusal::error(format!("the status kind is {kind}; it must be from 0 to 3")),
    }
}
