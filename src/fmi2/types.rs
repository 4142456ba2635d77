//! The C types of FMI 2.0.5 (`fmi2TypesPlatform.h`, `fmi2FunctionTypes.h`).
//!
//! In: nothing. Out: the memory layout that host and FMU share. An enumeration from the host has an integer type and is
//! checked where it is used. An unknown number in a Rust enum would be undefined behaviour.

use crate::fmi::refusal::Verdict;
use std::ffi::{c_char, c_int, c_uint, c_void};

/// `fmi2Component`: an instance, opaque to the host.
pub type Component = *mut c_void;
/// `fmi2ComponentEnvironment`: a pointer of the host, which is passed back to the host with every message.
pub type Environment = *mut c_void;
/// `fmi2FMUstate`: a saved state, opaque to the host.
pub type FmuState = *mut c_void;
/// `fmi2ValueReference`.
pub type ValueReference = c_uint;
/// `fmi2Real`.
pub type Real = f64;
/// `fmi2Integer`.
pub type Integer = c_int;
/// `fmi2Boolean`: 0 is false. Any other number is true, as in C.
pub type Boolean = c_int;
/// `fmi2String`: zero-terminated text, UTF-8.
pub type Text = *const c_char;
/// `fmi2Byte`.
pub type Byte = c_char;

/// `fmi2False`.
pub const FALSE: Boolean = 0;
/// `fmi2True`.
pub const TRUE: Boolean = 1;

/// `fmi2Type` of model exchange.
pub const MODEL_EXCHANGE: c_int = 0;
/// `fmi2Type` of co-simulation.
pub const CO_SIMULATION: c_int = 1;

/// `fmi2StatusKind`: the status of the last `fmi2DoStep`.
pub const DO_STEP_STATUS: c_int = 0;
/// `fmi2StatusKind`: the reason why a step is pending.
pub const PENDING_STATUS: c_int = 1;
/// `fmi2StatusKind`: end of the last successful step [s].
pub const LAST_SUCCESSFUL_TIME: c_int = 2;
/// `fmi2StatusKind`: whether the FMU requests the end of the simulation.
pub const TERMINATED: c_int = 3;

/// `fmi2EventInfo`: the changes that an event has made. The default is no change.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct EventInfo {
    /// Whether the discrete states need another update.
    pub new_discrete_states_needed: Boolean,
    /// Whether the simulation is to end.
    pub terminate_simulation: Boolean,
    /// Whether the nominal values of the continuous states have changed.
    pub nominals_changed: Boolean,
    /// Whether the continuous states have changed.
    pub values_changed: Boolean,
    /// Whether the time of the next event is known.
    pub next_event_time_defined: Boolean,
    /// Time of the next event [s].
    pub next_event_time: Real,
}

/// `fmi2Status`: status of a call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub enum Status {
    /// The call succeeded.
    Ok,
    /// The call succeeded. A message states something unusual.
    Warning,
    /// The result does not exist, or the step ended early. The instance can continue.
    Discard,
    /// The call is wrong or failed. A message states the reason.
    Error,
    /// The instance cannot be used any more.
    Fatal,
    /// An asynchronous step is running. Never returned by this FMU.
    Pending,
}

impl Status {
    /// # Errors
    /// Any other status.
    pub(super) fn ok(self) -> Result<(), Self> {
        if self == Self::Ok { Ok(()) } else { Err(self) }
    }
}

impl From<Verdict> for Status {
    #[inline]
    fn from(verdict: Verdict) -> Self {
        match verdict {
            Verdict::Ok => Status::Ok,
            Verdict::Warning => Status::Warning,
            Verdict::Discard => Status::Discard,
            Verdict::Error => Status::Error,
            Verdict::Fatal => Status::Fatal,
        }
    }
}

/// `fmi2CallbackLogger`: printf-style, therefore variadic. The callback must return. An exception that leaves the
/// callback ends the process, with Rust's message about foreign exceptions. After a `longjmp` out of the callback, each
/// call on the instance returns an error, and the memory of the instance stays allocated.
pub type LoggerCallback = unsafe extern "C-unwind" fn(
    environment: Environment,
    instance_name: Text,
    status: Status,
    category: Text,
    message: Text,
    ...
);

/// `fmi2CallbackFunctions`: any member may be NULL.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct CallbackFunctions {
    /// Receives the messages.
    pub logger: Option<LoggerCallback>,
    /// Never called: host and FMU do not exchange memory.
    pub allocate_memory: Option<unsafe extern "C" fn(count: usize, size: usize) -> *mut c_void>,
    /// Never called: host and FMU do not exchange memory.
    pub free_memory: Option<unsafe extern "C" fn(memory: *mut c_void)>,
    /// Never called: every step is synchronous.
    pub step_finished: Option<unsafe extern "C" fn(environment: Environment, status: Status)>,
    /// First argument of `logger`.
    pub environment: Environment,
}
