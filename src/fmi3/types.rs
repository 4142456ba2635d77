//! The C types of FMI 3.0.2 (`fmi3PlatformTypes.h`, `fmi3FunctionTypes.h`).
//!
//! In: nothing. Out: the layout that both sides of the boundary share. A Boolean of the host's arrives as a byte and is
//! taken for true unless it is 0: another number in a Rust `bool` would be undefined behaviour.

use crate::fmi::refusal::Verdict;
use std::ffi::{c_char, c_int, c_uint, c_void};

/// `fmi3Instance`: an instance, opaque to the host.
pub type Instance = *mut c_void;
/// `fmi3InstanceEnvironment`: a pointer of the host's, handed back to it with every message.
pub type Environment = *mut c_void;
/// `fmi3FMUState`: a saved state, opaque to the host.
pub type FmuState = *mut c_void;
/// `fmi3ValueReference`.
pub type ValueReference = c_uint;
/// `fmi3Boolean`: a C `bool`.
pub type Boolean = u8;
/// `fmi3String`: text that ends with a zero byte, UTF-8.
pub type Text = *const c_char;
/// `fmi3Binary`.
pub type Binary = *const u8;
/// `fmi3Clock`: a C `bool`.
pub type Clock = u8;
/// `fmi3IntervalQualifier` and `fmi3DependencyKind`, as plain integers.
pub type Enumeration = c_int;

/// `fmi3Dependent`: the kind of a dependency of which nothing more is told.
pub const DEPENDENT: Enumeration = 5;

/// `fmi3False`.
pub const FALSE: Boolean = 0;
/// `fmi3True`.
pub const TRUE: Boolean = 1;

/// `fmi3Status`: the answer to a call.
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

/// `fmi3LogMessageCallback`. It returns, as `fmi2CallbackLogger` does: see there for exceptions and `longjmp`.
pub type LogMessage =
    unsafe extern "C-unwind" fn(environment: Environment, status: Status, category: Text, message: Text);

/// `fmi3IntermediateUpdateCallback`. It returns: an exception that leaves it ends the process, with Rust's message of a
/// panic in a function that cannot unwind. After a `longjmp` out of it the instance can only be read: each other call
/// on the instance returns an error, and its memory stays allocated.
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
