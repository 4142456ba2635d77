//! The C interface of FMI 2.0.5: every exported function, 1 to 4 lines over the version-free half in `fmi`.
//!
//! In: the host's calls. Out: statuses and values. `phase` is the table of what is legal when, `types` has the C types.
//! It must not know any kind of model.
//!
//! Co-simulation is complete but for what the XML does not declare. Functions of model exchange are exported because
//! hosts look them up; they log why they cannot serve, and return `fmi2Error`.
//!
//! # Safety
//! All functions share one contract, the standard's own. A component is NULL or comes from [`fmi2Instantiate`], has not
//! been freed, and is used by one thread at a time (2.1.5). An array argument has as many elements as its count says,
//! and a string ends with a zero byte (2.1.4, 2.1.7). A NULL is answered with `fmi2Error`, wherever it stands, except
//! as an empty array.
#![allow(unsafe_code, non_snake_case, clippy::missing_safety_doc)]

mod cosimulation;
mod derivatives;
mod exchange;
mod phase;
mod state;
pub mod types;

pub use cosimulation::*;
pub use derivatives::*;
pub use exchange::*;
pub use state::*;

use crate::fmi::array::{input, output, text};
use crate::fmi::handle;
use crate::fmi::instance::Instance;
use crate::fmi::logger::{Logger, Sink};
use crate::fmi::phase::Function;
use crate::fmi::refusal::{Refusal, Verdict};
use crate::fmi::resources;
use crate::variables::Kind;
use std::ffi::{CStr, c_int};
use types::{Boolean, CO_SIMULATION, CallbackFunctions, Component, FALSE, Integer, MODEL_EXCHANGE, Real};
use types::{Status, Text, ValueReference};

/// Do `work` on the instance if the function is legal in its phase.
///
/// # Safety
/// As for [`handle::call`].
#[inline]
unsafe fn call(c: Component, function: &Function, work: impl FnOnce(&mut Instance) -> Result<(), Refusal>) -> Status {
    // SAFETY: the caller's promise.
    unsafe { handle::call(c, function, work) }.into()
}

/// The host's printf-style logger for an instance of this name. The callback is copied, as the host's struct may live
/// on its stack.
fn sink(functions: &CallbackFunctions, instance_name: &CStr) -> Option<Sink> {
    let (callback, environment, name) = (functions.logger?, functions.environment, instance_name.to_owned());
    Some(Box::new(move |verdict, category, message| {
        // SAFETY: FMI 2.0.5, 2.1.5: the host's logger may be called from within any FMI function, with its own
        // environment and printf-style arguments; "%s" takes one string. All strings outlive the call.
        unsafe {
            callback(environment, name.as_ptr(), verdict.into(), category.as_ptr(), c"%s".as_ptr(), message.as_ptr());
        }
    }))
}

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

/// New instance, from the definition file in the resources folder; NULL, with a message, if anything is amiss.
///
/// A NULL or empty location means the folder `resources` of the FMU that this library lies in. The callbacks are
/// copied; each may be NULL. `visible` has no meaning here.
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
        if functions.is_null() || !functions.is_aligned() {
            return std::ptr::null_mut();
        }
        let (name, guid, location) = (text(name).unwrap_or_default(), text(guid), text(location));
        let logger = Logger::new(sink(&functions.read(), name), logging_on != FALSE);
        handle::instantiate("fmi2Instantiate", name, logger, || match fmu_type {
            CO_SIMULATION => resources::load("fmuGUID", guid, location),
            MODEL_EXCHANGE => Err(Refusal::error("fmuType is fmi2ModelExchange; this FMU is for co-simulation only")),
            other => Err(Refusal::error(format!("fmuType is {other}; it must be 1 (fmi2CoSimulation)"))),
        })
    }
}

/// End of an instance; does nothing for NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeInstance(c: Component) {
    // SAFETY: the component is not used again (2.1.5).
    unsafe { handle::free(c) }
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
    unsafe {
        call(c, &phase::ENTER_INITIALIZATION_MODE, |i| {
            if !i.is_set_up() {
                let message = "fmi2EnterInitializationMode: no fmi2SetupExperiment before; startTime is 0, no stopTime";
                i.logger.log(Verdict::Warning, message);
            }
            i.enter_initialization_mode();
            Ok(())
        })
    }
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
    unsafe {
        call(c, &phase::TERMINATE, |i| {
            i.terminate();
            Ok(())
        })
    }
}

/// Back to a fresh instance; the log categories stay.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Reset(c: Component) -> Status {
    // SAFETY: the component is valid (2.1.5).
    unsafe {
        call(c, &phase::RESET, |i| {
            i.reset();
            Ok(())
        })
    }
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

/// Read Strings; they live until the next call of this function or the end of the instance. On an error the array may
/// be filled in part.
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
    unsafe {
        call(c, &phase::SET_BOOLEAN, |i| {
            let values = input("value", value, count)?.iter().map(|&value| value != FALSE);
            i.set_boolean(input("vr", vr, count)?, values)
        })
    }
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
