//! The functions of co-simulation (FMI 2.0.5, 4.2). The contract of their pointers is that of the module `fmi2`.

use super::array::output;
use super::guard::call;
use super::instance::no_such_status;
use super::phase;
use super::refusal::Refusal;
use super::types::{Boolean, Component, Integer, Real, Status, Text};
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
    // SAFETY: `value` is room for one value (4.2.3).
    unsafe { call(c, &phase::GET_STATUS, |i| answer(output("value", value, 1)?, i.status(kind)?)) }
}

/// `fmi2LastSuccessfulTime`: end of the last successful step [s].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealStatus(c: Component, kind: c_int, value: *mut Real) -> Status {
    // SAFETY: `value` is room for one value (4.2.3).
    unsafe { call(c, &phase::GET_REAL_STATUS, |i| answer(output("value", value, 1)?, i.real_status(kind)?)) }
}

/// No status is an Integer: always `fmi2Discard`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetIntegerStatus(c: Component, kind: c_int, _value: *mut Integer) -> Status {
    // SAFETY: the component is valid (2.1.5).
    unsafe { call(c, &phase::GET_INTEGER_STATUS, |_| Err(no_such_status(kind))) }
}

/// `fmi2Terminated`: always false.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBooleanStatus(c: Component, kind: c_int, value: *mut Boolean) -> Status {
    // SAFETY: `value` is room for one value (4.2.3).
    unsafe { call(c, &phase::GET_BOOLEAN_STATUS, |i| answer(output("value", value, 1)?, i.boolean_status(kind)?)) }
}

/// `fmi2PendingStatus` has no answer, as no step is ever pending: always `fmi2Discard`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetStringStatus(c: Component, kind: c_int, _value: *mut Text) -> Status {
    // SAFETY: the component is valid (2.1.5).
    unsafe { call(c, &phase::GET_STRING_STATUS, |_| Err(no_such_status(kind))) }
}

fn answer<T>(room: &mut [std::mem::MaybeUninit<T>], value: T) -> Result<(), Refusal> {
    room[0].write(value);
    Ok(())
}
