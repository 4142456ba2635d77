//! The exported functions of FMI 2.0.5 for model exchange (3.2). The contract of the pointers is that of the module
//! `fmi2`.

use super::types::{Boolean, Component, EventInfo, Status};
use crate::fmi::array::{input, output};
use crate::fmi::phase::{CONTINUOUS, EVENT, Function};
use crate::fmi::{exported_exchange, handle};

exported_exchange! {
    fmi2EnterContinuousTimeMode, fmi2CompletedIntegratorStep, fmi2SetTime, fmi2SetContinuousStates, fmi2GetDerivatives,
    fmi2GetEventIndicators, fmi2GetContinuousStates, fmi2GetNominalsOfContinuousStates;

    /// Changes from continuous-time mode to event mode.
    fn fmi2EnterEventMode() in CONTINUOUS => |i| i.enter_event_mode();

    /// Applies the pending transitions: impacts, bumpers, locks, rest and release. One call is enough. The next kink of
    /// a prescribed motion is returned as the next event time.
    // SAFETY: `info` points to memory for the struct (3.2.2).
    fn fmi2NewDiscreteStates(info: *mut EventInfo) in EVENT => |i| {
        let info = output("eventInfo", info, 1)?;
        let values_changed = i.update_discrete_states()?.into();
        let next = i.component.next_event();
        let (next_event_time_defined, next_event_time) = (next.is_some().into(), next.unwrap_or_default());
        info[0].write(EventInfo { values_changed, next_event_time_defined, next_event_time, ..EventInfo::default() });
        Ok(())
    };
}
