//! The C types of FMI 3.0.2 (`fmi3PlatformTypes.h`, `fmi3FunctionTypes.h`).
//!
//! In: nothing. Out: the memory layout that host and FMU share. A Boolean from the host is a byte, and every byte
//! except 0 is true, because another number in a Rust `bool` would be undefined behaviour.

use crate::fmi::refusal::Verdict;
use std::ffi::{c_char, c_int, c_uint, c_void};

/// `fmi3Instance`: an instance, opaque to the host.
pub type Instance = *mut c_void;
/// `fmi3InstanceEnvironment`: a pointer of the host, which is passed back to the host with every message.
pub type Environment = *mut c_void;
/// `fmi3FMUState`: a saved state, opaque to the host.
pub type FmuState = *mut c_void;
/// `fmi3ValueReference`.
pub type ValueReference = c_uint;
/// `fmi3Boolean`: a C `bool`.
pub type Boolean = u8;
/// `fmi3String`: zero-terminated text, UTF-8.
pub type Text = *const c_char;
/// `fmi3Binary`.
pub type Binary = *const u8;
/// `fmi3Clock`: a C `bool`.
pub type Clock = u8;
/// `fmi3IntervalQualifier` and `fmi3DependencyKind`, as plain integers.
pub type Enumeration = c_int;

/// `fmi3Dependent`: the kind of a dependency without further properties.
pub const DEPENDENT: Enumeration = 5;

/// `fmi3False`.
pub const FALSE: Boolean = 0;
/// `fmi3True`.
pub const TRUE: Boolean = 1;

/// `fmi3Status`: status of a call.
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

/// `fmi3LogMessageCallback`. For exceptions and `longjmp`, see `fmi2CallbackLogger`.
pub type LogMessage =
    unsafe extern "C-unwind" fn(environment: Environment, status: Status, category: Text, message: Text);

/// `fmi3IntermediateUpdateCallback`. The callback must return. An exception that leaves the callback ends the process,
/// with Rust's message about a panic in a function that cannot unwind. After a `longjmp` out of the callback, the
/// instance can only be read. Each other call returns an error, and the memory of the instance stays allocated.
pub type IntermediateUpdateCallback = unsafe extern "C-unwind" fn(
    environment: Environment,
    time: f64,
    set_requested: Boolean,
    get_allowed: Boolean,
    step_finished: Boolean,
    can_return_early: Boolean,
    return_requested: *mut Boolean,
    return_time: *mut f64,
);
