//! The exported functions of FMI 3.0.2 for features that this FMU does not have: other interface types, clocks,
//! configuration mode, types of no variable. Each function returns an error with the reason.

use super::VERSION;
use super::functions::{same_length, sink};
use super::types::{
    Binary, Boolean, Clock, Enumeration, Environment, FALSE, Instance as Component, LogMessage, Status, Text,
    ValueReference,
};
use crate::fmi::access::none_of_type;
use crate::fmi::array::{input, output, text};
use crate::fmi::logger::Logger;
use crate::fmi::phase::{ALIVE, Function, SETTABLE};
use crate::fmi::refusal::Refusal;
use crate::fmi::usage::Usage;
use crate::fmi::{exported, handle};
use std::ffi::c_void;

/// Always NULL, with a message: this FMU is for co-simulation and model exchange.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateScheduledExecution(
    name: Text,
    _token: Text,
    _resource_path: Text,
    _visible: Boolean,
    logging_on: Boolean,
    environment: Environment,
    log_message: Option<LogMessage>,
    _clock_update: *const c_void,
    _lock_preemption: *const c_void,
    _unlock_preemption: *const c_void,
) -> Component {
    // SAFETY: strings belong to the host and are valid during the call (2.2.6).
    unsafe { refuse_instance("fmi3InstantiateScheduledExecution", name, logging_on, environment, log_message) }
}

/// Returns NULL, with a message.
///
/// # Safety
/// As for `array::text`.
unsafe fn refuse_instance(
    function: &str,
    name: Text,
    logging_on: Boolean,
    environment: Environment,
    log_message: Option<LogMessage>,
) -> Component {
    // SAFETY: guaranteed by the caller.
    let name = unsafe { text(name) }.unwrap_or_default();
    let logger = Logger::new(sink(environment, log_message), logging_on != FALSE);
    handle::instantiate(VERSION, function, name, logger, Usage::default(), || {
        Err(Refusal::error(
            "this FMU does not support scheduled execution; use fmi3InstantiateCoSimulation or \
             fmi3InstantiateModelExchange",
        ))
    })
}

/// Getters and setters for types that no variable has. Only the empty list is accepted.
macro_rules! absent_types {
    ($($name:literal $get:ident $set:ident $type:ty;)*) => {
        exported! {
            $(
                /// Reads variables of a type that no variable has. Only the empty list is accepted.
                // SAFETY: the counts are the numbers of elements of the arrays (2.2.6).
                fn $get(vr: *const ValueReference, count: usize, value: *mut $type, values: usize) in ALIVE => |i| {
                    output("values", value, values)?;
                    same_length(count, values)?;
                    none_of_type(i, input("valueReferences", vr, count)?, $name)
                };
                /// Sets variables of a type that no variable has. Only the empty list is accepted.
                // SAFETY: the counts are the numbers of elements of the arrays (2.2.6).
                fn $set(vr: *const ValueReference, count: usize, value: *const $type,
                    values: usize) in SETTABLE => |i| {
                    input("values", value, values)?;
                    same_length(count, values)?;
                    none_of_type(i, input("valueReferences", vr, count)?, $name)
                };
            )*
        }
    };
}

pub(super) mod types_of_no_variable {
    use super::*;

    absent_types! {
        "Float32" fmi3GetFloat32 fmi3SetFloat32 f32;
        "Int8" fmi3GetInt8 fmi3SetInt8 i8;
        "UInt8" fmi3GetUInt8 fmi3SetUInt8 u8;
        "Int16" fmi3GetInt16 fmi3SetInt16 i16;
        "UInt16" fmi3GetUInt16 fmi3SetUInt16 u16;
        "Int32" fmi3GetInt32 fmi3SetInt32 i32;
        "UInt32" fmi3GetUInt32 fmi3SetUInt32 u32;
        "UInt64" fmi3GetUInt64 fmi3SetUInt64 u64;
    }
}
pub use types_of_no_variable::*;

exported! {
    // Binary variables and clocks (2.2.6): there are none.
    fn fmi3GetBinary(
        _vr: *const ValueReference, count: usize, _sizes: *mut usize, _values: *mut Binary, _value_count: usize
    ) in ALIVE => |_i| none(count, "binary variable");
    fn fmi3SetBinary(
        _vr: *const ValueReference, count: usize, _sizes: *const usize, _values: *const Binary, _value_count: usize
    ) in SETTABLE => |_i| none(count, "binary variable");
    fn fmi3GetClock(_vr: *const ValueReference, count: usize, _values: *mut Clock) in ALIVE => |_i| none(count,
        "clock");
    fn fmi3SetClock(_vr: *const ValueReference, count: usize, _values: *const Clock) in SETTABLE => |_i|
        none(count, "clock");
    fn fmi3GetIntervalDecimal(
        _vr: *const ValueReference, count: usize, _intervals: *mut f64, _qualifiers: *mut Enumeration
    ) in ALIVE => |_i| none(count, "clock");
    fn fmi3GetIntervalFraction(
        _vr: *const ValueReference, count: usize, _counters: *mut u64, _resolutions: *mut u64,
        _qualifiers: *mut Enumeration
    ) in ALIVE => |_i| none(count, "clock");
    fn fmi3GetShiftDecimal(_vr: *const ValueReference, count: usize, _shifts: *mut f64) in ALIVE => |_i|
        none(count, "clock");
    fn fmi3GetShiftFraction(
        _vr: *const ValueReference, count: usize, _counters: *mut u64, _resolutions: *mut u64
    ) in ALIVE => |_i| none(count, "clock");
    fn fmi3SetIntervalDecimal(_vr: *const ValueReference, count: usize, _intervals: *const f64) in ALIVE => |_i|
        none(count, "clock");
    fn fmi3SetIntervalFraction(
        _vr: *const ValueReference, count: usize, _counters: *const u64, _resolutions: *const u64
    ) in ALIVE => |_i| none(count, "clock");
    fn fmi3SetShiftDecimal(_vr: *const ValueReference, count: usize, _shifts: *const f64) in ALIVE => |_i|
        none(count, "clock");
    fn fmi3SetShiftFraction(
        _vr: *const ValueReference, count: usize, _counters: *const u64, _resolutions: *const u64
    ) in ALIVE => |_i| none(count, "clock");
    fn fmi3ActivateModelPartition(_clock: ValueReference, _time: f64) in ALIVE => |_i| none(1, "clock");

    // Configuration mode (2.3.3): there are no structural parameters.
    fn fmi3EnterConfigurationMode() in ALIVE => |_i|
        Err(Refusal::error("this FMU has no structural parameter, so it has no configuration mode"));
    fn fmi3ExitConfigurationMode() in ALIVE => |_i|
        Err(Refusal::error("this FMU has no structural parameter, so it has no configuration mode"));

}

/// Refusal of variables that do not exist. An empty list is accepted.
fn none(count: usize, what: &str) -> Result<(), Refusal> {
    if count == 0 { Ok(()) } else { Err(Refusal::error(format!("this FMU has no {what}"))) }
}
