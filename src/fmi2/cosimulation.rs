//! The functions of co-simulation (FMI 2.0.5, 4.2). The contract of their pointers is that of the module `fmi2`.

use super::types::{Boolean, Component, FALSE, Integer, Real, Status, Text};
use super::types::{DO_STEP_STATUS, LAST_SUCCESSFUL_TIME, PENDING_STATUS, TERMINATED};
use super::{call, phase};
use crate::fmi::array::output;
use crate::fmi::instance::Instance;
use crate::fmi::phase::Phase;
use crate::fmi::refusal::Refusal;
use std::ffi::c_int;

/// Advance by exactly `h` [s] from the present communication point `point` [s].
///
/// Refused, nothing has changed, for an `h` that is not finite and positive, another point than the instance's own, and
/// a step past the stop time. Steps are synchronous. The last argument has no meaning here: any state can be restored.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DoStep(c: Component, point: Real, h: Real, _no_set_state_prior: Boolean) -> Status {
    // SAFETY: the component is valid (2.1.5).
    unsafe { call(c, &phase::DO_STEP, |i| i.do_step(point, h)) }
}

/// Always an error: no step is asynchronous, so that there is none to cancel.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2CancelStep(c: Component) -> Status {
    let refusal = || Refusal::error("no step is in progress; fmi2DoStep returns when its step is done");
    // SAFETY: the component is valid (2.1.5).
    unsafe { call(c, &phase::CANCEL_STEP, |_| Err(refusal())) }
}

/// `fmi2DoStepStatus`: how the last step ended.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetStatus(c: Component, kind: c_int, value: *mut Status) -> Status {
    let last = |i: &Instance| if i.phase == Phase::Failed { Status::Error } else { Status::Ok };
    // SAFETY: `value` leads to memory for one value (4.2.3).
    unsafe { call(c, &phase::GET_STATUS, |i| answer(value, kind, DO_STEP_STATUS, last(i))) }
}

/// `fmi2LastSuccessfulTime`: end of the last successful step [s].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealStatus(c: Component, kind: c_int, value: *mut Real) -> Status {
    // SAFETY: `value` leads to memory for one value (4.2.3).
    unsafe { call(c, &phase::GET_REAL_STATUS, |i| answer(value, kind, LAST_SUCCESSFUL_TIME, i.time())) }
}

/// No status is an Integer: always `fmi2Discard`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetIntegerStatus(c: Component, kind: c_int, _value: *mut Integer) -> Status {
    // SAFETY: the component is valid (2.1.5).
    unsafe { call(c, &phase::GET_INTEGER_STATUS, |_| Err(no_such_status(kind))) }
}

/// `fmi2Terminated`: always false, as no model asks for the end of the simulation.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBooleanStatus(c: Component, kind: c_int, value: *mut Boolean) -> Status {
    // SAFETY: `value` leads to memory for one value (4.2.3).
    unsafe { call(c, &phase::GET_BOOLEAN_STATUS, |_| answer(value, kind, TERMINATED, FALSE)) }
}

/// `fmi2PendingStatus` has no answer, as no step is ever pending: always `fmi2Discard`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetStringStatus(c: Component, kind: c_int, _value: *mut Text) -> Status {
    // SAFETY: the component is valid (2.1.5).
    unsafe { call(c, &phase::GET_STRING_STATUS, |_| Err(no_such_status(kind))) }
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
