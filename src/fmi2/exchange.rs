//! The functions of model exchange (FMI 2.0.5, 3.2): exported, as hosts look them up, and refused. The contract of the
//! pointers is that of the module `fmi2`.

use super::types::{Boolean, Component, EventInfo, Real, Status};
use crate::fmi::handle;
use crate::fmi::phase::{ALIVE, Function};
use crate::fmi::refusal::Refusal;

fn refused() -> Result<(), Refusal> {
    Err(Refusal::error("a function of model exchange; this FMU is for co-simulation, use fmi2DoStep"))
}

exported! {
    /// Not supported.
    fn fmi2EnterEventMode() in ALIVE => |_i| refused();
    /// Not supported.
    fn fmi2NewDiscreteStates(_info: *mut EventInfo) in ALIVE => |_i| refused();
    /// Not supported.
    fn fmi2EnterContinuousTimeMode() in ALIVE => |_i| refused();
    /// Not supported.
    fn fmi2CompletedIntegratorStep(
        _no_set_state_prior: Boolean, _enter_event_mode: *mut Boolean, _terminate: *mut Boolean
    ) in ALIVE => |_i| refused();
    /// Not supported.
    fn fmi2SetTime(_time: Real) in ALIVE => |_i| refused();
    /// Not supported.
    fn fmi2SetContinuousStates(_x: *const Real, _count: usize) in ALIVE => |_i| refused();
    /// Not supported.
    fn fmi2GetDerivatives(_derivatives: *mut Real, _count: usize) in ALIVE => |_i| refused();
    /// Not supported.
    fn fmi2GetEventIndicators(_indicators: *mut Real, _count: usize) in ALIVE => |_i| refused();
    /// Not supported.
    fn fmi2GetContinuousStates(_x: *mut Real, _count: usize) in ALIVE => |_i| refused();
    /// Not supported.
    fn fmi2GetNominalsOfContinuousStates(_nominals: *mut Real, _count: usize) in ALIVE => |_i| refused();
}
