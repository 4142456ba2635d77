//! The functions that model exchange and co-simulation share (FMI 2.0.5, 2.1): life cycle, logging, values. The
//! contract of the pointers is that of the module `fmi2`.

use super::types::{Boolean, CO_SIMULATION, CallbackFunctions, Component, FALSE, Integer, MODEL_EXCHANGE, Real};
use super::types::{Status, Text, ValueReference};
use crate::fmi::array::{input, output, text};
use crate::fmi::logger::{Logger, Sink};
use crate::fmi::phase::{ALIVE, FAILED, Function, INITIALIZATION, INSTANTIATED, SETTABLE, STEP};
use crate::fmi::refusal::{Refusal, Verdict};
use crate::fmi::{handle, resources};
use crate::variables::Kind;
use std::ffi::{CStr, c_int};

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

exported! {
    /// Switch log categories; none given means all. Unknown ones are refused.
    // SAFETY: `categories` has `count` strings (2.1.5).
    fn fmi2SetDebugLogging(on: Boolean, count: usize, categories: *const Text) in ALIVE => |i| {
        let categories = input("categories", categories, count)?;
        i.logger.set_debug_logging(on != FALSE, categories.iter().map(|&name| text(name)))
    };

    /// Start time, stop time and tolerance. Without it the start time is 0 and there is no stop time; that is accepted,
    /// as the reference FMUs do, with a warning in the log.
    fn fmi2SetupExperiment(
        tolerance_defined: Boolean, tolerance: Real, start: Real, stop_defined: Boolean, stop: Real
    ) in INSTANTIATED => |i| {
        let tolerance = (tolerance_defined != FALSE).then_some(tolerance);
        i.setup_experiment(tolerance, start, (stop_defined != FALSE).then_some(stop))
    };

    /// From here on outputs have values.
    fn fmi2EnterInitializationMode() in INSTANTIATED => |i| {
        if !i.is_set_up() {
            let message = "fmi2EnterInitializationMode: no fmi2SetupExperiment before; startTime is 0, no stopTime";
            i.logger.log(Verdict::Warning, message);
        }
        i.enter_initialization_mode();
        Ok(())
    };

    /// Close the loops and start. After a refusal, initialization mode goes on.
    fn fmi2ExitInitializationMode() in INITIALIZATION => |i| i.exit_initialization_mode();

    /// End of the simulation; values can still be read.
    fn fmi2Terminate() in STEP | FAILED => |i| {
        i.terminate();
        Ok(())
    };

    /// Back to a fresh instance; the log categories stay.
    fn fmi2Reset() in ALIVE => |i| {
        i.reset();
        Ok(())
    };

    /// Read Reals. On an error the array may be filled in part.
    // SAFETY: both arrays have `count` elements (2.1.7).
    fn fmi2GetReal(vr: *const ValueReference, count: usize, value: *mut Real) in ALIVE => |i|
        i.get_real(input("vr", vr, count)?, output("value", value, count)?);

    /// Read Integers: there are none, so that only the empty list can be read.
    // SAFETY: both arrays have `count` elements (2.1.7).
    fn fmi2GetInteger(vr: *const ValueReference, count: usize, value: *mut Integer) in ALIVE => |i| {
        output("value", value, count)?;
        i.get_none(input("vr", vr, count)?, Kind::Integer)
    };

    /// Read Booleans, each 0 or 1. On an error the array may be filled in part.
    // SAFETY: both arrays have `count` elements (2.1.7).
    fn fmi2GetBoolean(vr: *const ValueReference, count: usize, value: *mut Boolean) in ALIVE => |i|
        i.get_boolean(input("vr", vr, count)?, output("value", value, count)?);

    /// Read Strings; they live until the next call of this function or the end of the instance. On an error the array
    /// may be filled in part.
    // SAFETY: both arrays have `count` elements (2.1.7).
    fn fmi2GetString(vr: *const ValueReference, count: usize, value: *mut Text) in ALIVE => |i|
        i.get_string(input("vr", vr, count)?, output("value", value, count)?);

    /// Set Real inputs and parameters, all or none.
    // SAFETY: both arrays have `count` elements (2.1.7).
    fn fmi2SetReal(vr: *const ValueReference, count: usize, value: *const Real) in SETTABLE => |i|
        i.set_real(input("vr", vr, count)?, input("value", value, count)?);

    /// Set Integers: there are none, so that only the empty list can be set.
    // SAFETY: both arrays have `count` elements (2.1.7).
    fn fmi2SetInteger(vr: *const ValueReference, count: usize, value: *const Integer) in SETTABLE => |i| {
        input("value", value, count)?;
        i.set_none(input("vr", vr, count)?, Kind::Integer)
    };

    /// Set Boolean inputs and parameters, all or none; any number but 0 is true.
    // SAFETY: both arrays have `count` elements (2.1.7).
    fn fmi2SetBoolean(vr: *const ValueReference, count: usize, value: *const Boolean) in SETTABLE => |i| {
        let values = input("value", value, count)?.iter().map(|&value| value != FALSE);
        i.set_boolean(input("vr", vr, count)?, values)
    };

    /// Set String parameters, all or none; the texts are copied.
    // SAFETY: both arrays have `count` elements, each a string or NULL (2.1.7).
    fn fmi2SetString(vr: *const ValueReference, count: usize, value: *const Text) in SETTABLE => |i| {
        let texts: Vec<_> = input("value", value, count)?.iter().map(|&value| text(value)).collect();
        i.set_string(input("vr", vr, count)?, &texts)
    };
}
