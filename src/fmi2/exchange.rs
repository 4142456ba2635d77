//! The functions of model exchange (FMI 2.0.5, 3.2): exported, as hosts look them up, and refused. The contract of the
//! pointers is that of the module `fmi2`.

use super::guard::call;
use super::phase::{self, Function};
use super::refusal::Refusal;
use super::types::{Boolean, Component, EventInfo, Real, Status};

/// # Safety
/// As for `guard::call`.
unsafe fn refuse(c: Component, function: &Function) -> Status {
    let refusal = || Refusal::error("a function of model exchange; this FMU is for co-simulation, use fmi2DoStep");
    // SAFETY: the caller's promise.
    unsafe { call(c, function, |_| Err(refusal())) }
}

/// Not supported.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2EnterEventMode(c: Component) -> Status {
    // SAFETY: the component is valid (2.1.5).
    unsafe { refuse(c, &phase::ENTER_EVENT_MODE) }
}

/// Not supported.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2NewDiscreteStates(c: Component, _info: *mut EventInfo) -> Status {
    // SAFETY: the component is valid (2.1.5).
    unsafe { refuse(c, &phase::NEW_DISCRETE_STATES) }
}

/// Not supported.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2EnterContinuousTimeMode(c: Component) -> Status {
    // SAFETY: the component is valid (2.1.5).
    unsafe { refuse(c, &phase::ENTER_CONTINUOUS_TIME_MODE) }
}

/// Not supported.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2CompletedIntegratorStep(
    c: Component,
    _no_set_state_prior: Boolean,
    _enter_event_mode: *mut Boolean,
    _terminate: *mut Boolean,
) -> Status {
    // SAFETY: the component is valid (2.1.5).
    unsafe { refuse(c, &phase::COMPLETED_INTEGRATOR_STEP) }
}

/// Not supported.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetTime(c: Component, _time: Real) -> Status {
    // SAFETY: the component is valid (2.1.5).
    unsafe { refuse(c, &phase::SET_TIME) }
}

/// Not supported.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetContinuousStates(c: Component, _x: *const Real, _count: usize) -> Status {
    // SAFETY: the component is valid (2.1.5).
    unsafe { refuse(c, &phase::SET_CONTINUOUS_STATES) }
}

/// Not supported.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetDerivatives(c: Component, _derivatives: *mut Real, _count: usize) -> Status {
    // SAFETY: the component is valid (2.1.5).
    unsafe { refuse(c, &phase::GET_DERIVATIVES) }
}

/// Not supported.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetEventIndicators(c: Component, _indicators: *mut Real, _count: usize) -> Status {
    // SAFETY: the component is valid (2.1.5).
    unsafe { refuse(c, &phase::GET_EVENT_INDICATORS) }
}

/// Not supported.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetContinuousStates(c: Component, _x: *mut Real, _count: usize) -> Status {
    // SAFETY: the component is valid (2.1.5).
    unsafe { refuse(c, &phase::GET_CONTINUOUS_STATES) }
}

/// Not supported.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetNominalsOfContinuousStates(
    c: Component,
    _nominals: *mut Real,
    _count: usize,
) -> Status {
    // SAFETY: the component is valid (2.1.5).
    unsafe { refuse(c, &phase::GET_NOMINALS_OF_CONTINUOUS_STATES) }
}
