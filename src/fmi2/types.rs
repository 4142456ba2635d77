//! The C types of FMI 2.0.5 (`fmi2TypesPlatform.h`, `fmi2FunctionTypes.h`).
//!
//! In: nothing. Out: the layout that both sides of the boundary share. An enumeration that the host passes in arrives
//! as a plain integer and is checked where it is used: an unknown number in a Rust enum would be undefined behaviour.

use crate::fmi::refusal::Verdict;
use std::ffi::{c_char, c_int, c_uint, c_void};

/// `fmi2Component`: an instance, opaque to the host.
pub type Component = *mut c_void;
/// `fmi2ComponentEnvironment`: a pointer of the host's, handed back to it with every message.
pub type Environment = *mut c_void;
/// `fmi2FMUstate`: a saved state, opaque to the host.
pub type FmuState = *mut c_void;
/// `fmi2ValueReference`.
pub type ValueReference = c_uint;
/// `fmi2Real`.
pub type Real = f64;
/// `fmi2Integer`.
pub type Integer = c_int;
/// `fmi2Boolean`: 0 is false; any other number is taken for true, as in C.
pub type Boolean = c_int;
/// `fmi2String`: text that ends with a zero byte, UTF-8.
pub type Text = *const c_char;
/// `fmi2Byte`.
pub type Byte = c_char;

/// `fmi2False`.
pub const FALSE: Boolean = 0;
/// `fmi2True`.
pub const TRUE: Boolean = 1;

/// `fmi2Type` of model exchange, as the host passes it.
pub const MODEL_EXCHANGE: c_int = 0;
/// `fmi2Type` of co-simulation, as the host passes it.
pub const CO_SIMULATION: c_int = 1;

/// `fmi2StatusKind`, as the host passes it: the status of the last `fmi2DoStep`.
pub const DO_STEP_STATUS: c_int = 0;
/// `fmi2StatusKind`, as the host passes it: why a step is pending.
pub const PENDING_STATUS: c_int = 1;
/// `fmi2StatusKind`, as the host passes it: end of the last successful step [s].
pub const LAST_SUCCESSFUL_TIME: c_int = 2;
/// `fmi2StatusKind`, as the host passes it: whether the FMU wants the simulation to end.
pub const TERMINATED: c_int = 3;

/// `fmi2EventInfo`: what an event has changed. By default nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct EventInfo {
    /// Whether the discrete states need another update.
    pub new_discrete_states_needed: Boolean,
    /// Whether the simulation is to end.
    pub terminate_simulation: Boolean,
    /// Whether the scales of the continuous states have changed.
    pub nominals_changed: Boolean,
    /// Whether the continuous states have changed.
    pub values_changed: Boolean,
    /// Whether the next event is known before its time.
    pub next_event_time_defined: Boolean,
    /// Its time [s].
    pub next_event_time: Real,
}

/// `fmi2Status`: the answer to a call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub enum Status {
    /// All well.
    Ok,
    /// Done, with something to be said about it.
    Warning,
    /// Not available; the instance can go on.
    Discard,
    /// Refused or failed; a message says why.
    Error,
    /// This instance is beyond repair.
    Fatal,
    /// An asynchronous step is running; never answered here.
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

/// `fmi2CallbackLogger`: printf-style, hence variadic. It returns: an exception that leaves it ends the process, with
/// Rust's message that it cannot catch foreign exceptions. After a `longjmp` out of it the instance is lost: each later
/// call on the instance returns an error, and its memory stays allocated.
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
    /// Never called: memory does not cross the boundary.
    pub allocate_memory: Option<unsafe extern "C" fn(count: usize, size: usize) -> *mut c_void>,
    /// Never called: memory does not cross the boundary.
    pub free_memory: Option<unsafe extern "C" fn(memory: *mut c_void)>,
    /// Never called: every step is synchronous.
    pub step_finished: Option<unsafe extern "C" fn(environment: Environment, status: Status)>,
    /// First argument of `logger`.
    pub environment: Environment,
}
