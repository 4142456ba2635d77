//! The C interface of FMI 2.0.5: every exported function, 1 to 4 lines over a safe core.
//!
//! In: the host's calls. Out: statuses and values. The core is `instance`; `phase` and `access` say what is legal when,
//! `guard` turns pointers into instances and panics into `fmi2Fatal`, `array` turns pointers into slices. This is the
//! only room with `unsafe` in it, and the only one that knows the words of the standard. It knows nothing of mechanics.
//!
//! Co-simulation is complete but for what the XML does not declare; functions of model exchange are there because hosts
//! load them, log why they cannot serve, and return `fmi2Error`.
//!
//! # Safety
//! All functions share one contract, the standard's own. A component is NULL or comes from [`fmi2Instantiate`], has not
//! been freed, and is used by one thread at a time (2.1.5). An array argument has as many elements as its count says,
//! and a string ends with a zero byte (2.1.4, 2.1.7). A NULL is answered with `fmi2Error`, wherever it stands, except
//! as an empty array.
#![allow(unsafe_code, non_snake_case, clippy::missing_safety_doc)]

mod access;
mod array;
mod clock;
mod cosimulation;
mod derivatives;
mod exchange;
mod guard;
pub mod host;
mod instance;
mod location;
pub mod logger;
mod phase;
mod refusal;
mod saved;
mod state;
pub mod types;

pub use cosimulation::*;
pub use derivatives::*;
pub use exchange::*;
pub use state::*;

use crate::variables::Kind;
use array::{input, output, text};
use guard::call;
use std::ffi::c_int;
use types::{Boolean, CallbackFunctions, Component, FALSE, Integer, Real, Status, Text, ValueReference};

/// Always `"default"`: the types of `fmi2TypesPlatform.h`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetTypesPlatform() -> Text {
    c"default".as_ptr()
}

/// Always `"2.0"`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetVersion() -> Text {
    c"2.0".as_ptr()
}

/// Switch log categories; none given means all. Unknown ones are refused.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetDebugLogging(
    c: Component,
    on: Boolean,
    count: usize,
    categories: *const Text,
) -> Status {
    // SAFETY: `categories` has `count` strings (2.1.5).
    unsafe {
        call(c, &phase::SET_DEBUG_LOGGING, |i| {
            let categories = input("categories", categories, count)?;
            i.logger.set_debug_logging(on != FALSE, categories.iter().map(|&name| text(name)))
        })
    }
}

/// New instance, from `mechanism.json` in the resources folder; NULL, with a message, if anything is amiss.
///
/// A NULL or empty location means the folder `resources` of the FMU that this library lies in. The callbacks are copied;
/// each may be NULL. `visible` has no meaning here.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Instantiate(
    name: Text,
    fmu_type: c_int,
    guid: Text,
    location: Text,
    functions: *const CallbackFunctions,
    _visible: Boolean,
    logging_on: Boolean,
) -> Component {
    // SAFETY: strings and callbacks are the host's, for the duration of the call (2.1.5).
    unsafe {
        let (guid, location) = (text(guid), text(location));
        guard::instantiate(functions, name, logging_on != FALSE, || instance::load(fmu_type, guid, location))
    }
}

/// End of an instance; does nothing for NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeInstance(c: Component) {
    // SAFETY: the component is not used again (2.1.5).
    unsafe { guard::free(c) }
}

/// Start time, stop time and tolerance. Without it the start time is 0 and there is no stop time; that is accepted, as
/// the reference FMUs do, with a warning in the log.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetupExperiment(
    c: Component,
    tolerance_defined: Boolean,
    tolerance: Real,
    start: Real,
    stop_defined: Boolean,
    stop: Real,
) -> Status {
    let tolerance = (tolerance_defined != FALSE).then_some(tolerance);
    let stop = (stop_defined != FALSE).then_some(stop);
    // SAFETY: the component is valid (2.1.5).
    unsafe { call(c, &phase::SETUP_EXPERIMENT, |i| i.setup_experiment(tolerance, start, stop)) }
}

/// From here on outputs have values.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2EnterInitializationMode(c: Component) -> Status {
    // SAFETY: the component is valid (2.1.5).
    unsafe { call(c, &phase::ENTER_INITIALIZATION_MODE, |i| i.enter_initialization_mode()) }
}

/// Close the loops and start. Refused, initialization mode goes on.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2ExitInitializationMode(c: Component) -> Status {
    // SAFETY: the component is valid (2.1.5).
    unsafe { call(c, &phase::EXIT_INITIALIZATION_MODE, |i| i.exit_initialization_mode()) }
}

/// End of the simulation; values can still be read.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Terminate(c: Component) -> Status {
    // SAFETY: the component is valid (2.1.5).
    unsafe { call(c, &phase::TERMINATE, |i| i.terminate()) }
}

/// Back to a fresh instance; the log categories stay.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Reset(c: Component) -> Status {
    // SAFETY: the component is valid (2.1.5).
    unsafe { call(c, &phase::RESET, |i| i.reset()) }
}

/// Read Reals. On an error the array may be filled in part.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetReal(
    c: Component,
    vr: *const ValueReference,
    count: usize,
    value: *mut Real,
) -> Status {
    // SAFETY: both arrays have `count` elements (2.1.7).
    unsafe { call(c, &phase::GET_REAL, |i| i.get_real(input("vr", vr, count)?, output("value", value, count)?)) }
}

/// Read Integers: there are none, so that only the empty list can be read.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetInteger(
    c: Component,
    vr: *const ValueReference,
    count: usize,
    value: *mut Integer,
) -> Status {
    // SAFETY: both arrays have `count` elements (2.1.7).
    unsafe {
        call(c, &phase::GET_INTEGER, |i| {
            output("value", value, count)?;
            i.get_none(input("vr", vr, count)?, Kind::Integer)
        })
    }
}

/// Read Booleans, each 0 or 1. On an error the array may be filled in part.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBoolean(
    c: Component,
    vr: *const ValueReference,
    count: usize,
    value: *mut Boolean,
) -> Status {
    // SAFETY: both arrays have `count` elements (2.1.7).
    unsafe { call(c, &phase::GET_BOOLEAN, |i| i.get_boolean(input("vr", vr, count)?, output("value", value, count)?)) }
}

/// Read Strings; they live until the next call of this function or the end of the instance. On an error the array may be
/// filled in part.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetString(
    c: Component,
    vr: *const ValueReference,
    count: usize,
    value: *mut Text,
) -> Status {
    // SAFETY: both arrays have `count` elements (2.1.7).
    unsafe { call(c, &phase::GET_STRING, |i| i.get_string(input("vr", vr, count)?, output("value", value, count)?)) }
}

/// Set Real inputs and parameters, all or none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetReal(
    c: Component,
    vr: *const ValueReference,
    count: usize,
    value: *const Real,
) -> Status {
    // SAFETY: both arrays have `count` elements (2.1.7).
    unsafe { call(c, &phase::SET_REAL, |i| i.set_real(input("vr", vr, count)?, input("value", value, count)?)) }
}

/// Set Integers: there are none, so that only the empty list can be set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetInteger(
    c: Component,
    vr: *const ValueReference,
    count: usize,
    value: *const Integer,
) -> Status {
    // SAFETY: both arrays have `count` elements (2.1.7).
    unsafe {
        call(c, &phase::SET_INTEGER, |i| {
            input("value", value, count)?;
            i.set_none(input("vr", vr, count)?, Kind::Integer)
        })
    }
}

/// Set Boolean inputs and parameters, all or none; any number but 0 is true.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetBoolean(
    c: Component,
    vr: *const ValueReference,
    count: usize,
    value: *const Boolean,
) -> Status {
    // SAFETY: both arrays have `count` elements (2.1.7).
    unsafe { call(c, &phase::SET_BOOLEAN, |i| i.set_boolean(input("vr", vr, count)?, input("value", value, count)?)) }
}

/// Set String parameters, all or none; the texts are copied.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetString(
    c: Component,
    vr: *const ValueReference,
    count: usize,
    value: *const Text,
) -> Status {
    // SAFETY: both arrays have `count` elements, each a string or NULL (2.1.7).
    unsafe {
        call(c, &phase::SET_STRING, |i| {
            let texts: Vec<_> = input("value", value, count)?.iter().map(|&value| text(value)).collect();
            i.set_string(input("vr", vr, count)?, &texts)
        })
    }
}
