//! The exported functions of FMI 2.0.5: life cycle, logging, values, states, derivatives (2.1) and co-simulation
//! (4.2). The contract of the pointers is that of the module `fmi2`.

use super::VERSION;
use super::types::{
    Boolean, Byte, CO_SIMULATION, CallbackFunctions, Component, DO_STEP_STATUS, FALSE, FmuState, Integer,
    LAST_SUCCESSFUL_TIME, MODEL_EXCHANGE, PENDING_STATUS, Real, Status, TERMINATED, Text, ValueReference,
};
use crate::component::ModelKind;
use crate::fmi::access::none_of_type;
use crate::fmi::array::{input, output, text};
use crate::fmi::exchange::served;
use crate::fmi::instance::Parts;
use crate::fmi::logger::{Logger, Sink};
use crate::fmi::phase::{
    ALIVE, CONTINUOUS, EVENT, FAILED, FATAL, Function, INITIALIZATION, INSTANTIATED, Phase, SETTABLE, STEP, STEPPED,
};
use crate::fmi::refusal::Refusal;
use crate::fmi::usage::Usage;
use crate::fmi::{exported, handle, resources, state_handle};
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

/// `fmi2Instantiate`: a new instance of one of the `kinds` in the library, from the definition file in the resources
/// folder. Returns NULL, with a message, if anything is wrong.
///
/// A NULL or empty location means the folder `resources` of the FMU that contains this library. The callbacks are
/// copied. Each callback may be NULL.
pub unsafe fn instantiate(
    kinds: &[ModelKind],
    name: Text,
    fmu_type: c_int,
    guid: Text,
    location: Text,
    functions: *const CallbackFunctions,
    logging_on: Boolean,
) -> Component {
    // SAFETY: strings and callbacks belong to the host and are valid during the call (2.1.5).
    unsafe {
        if functions.is_null() || !functions.is_aligned() {
            return std::ptr::null_mut();
        }
        let (name, guid, location) = (text(name).unwrap_or_default(), text(guid), text(location));
        let logger = Logger::new(sink(&functions.read(), name), logging_on != FALSE);
        let usage = if fmu_type == MODEL_EXCHANGE { Usage::MODEL_EXCHANGE } else { Usage::default() };
        handle::instantiate(VERSION, "fmi2Instantiate", name, logger, usage, || match fmu_type {
            CO_SIMULATION => resources::load(kinds, "fmuGUID", guid, location),
            MODEL_EXCHANGE => served(resources::load(kinds, "fmuGUID", guid, location)?),
            other => {
                let allowed = "fmuType must be 0 (fmi2ModelExchange) or 1 (fmi2CoSimulation)";
                Err(Refusal::error(format!("fmuType is {other}; {allowed}")))
            }
        })
    }
}

/// Frees an instance. Does nothing for NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeInstance(c: Component) {
    // SAFETY: the component is not used again (2.1.5).
    unsafe { handle::free(c) }
}

/// The host's printf-style logger for an instance of this name. The callback is copied, because the host's struct may
/// be on the stack.
fn sink(functions: &CallbackFunctions, instance_name: &CStr) -> Option<Sink> {
    let (callback, environment, name) = (functions.logger?, functions.environment, instance_name.to_owned());
    Some(Box::new(move |verdict, category, message| {
        // SAFETY: FMI 2.0.5, 2.1.5: the host's logger may be called in any FMI function, with the host's environment
        // and printf-style arguments. "%s" needs one string. All strings are valid during the call.
        unsafe {
            callback(environment, name.as_ptr(), verdict.into(), category.as_ptr(), c"%s".as_ptr(), message.as_ptr());
        }
    }))
}

exported! {
    /// Switches log categories. An empty list means all categories. Unknown categories are rejected.
    // SAFETY: `categories` has `count` strings (2.1.5).
    fn fmi2SetDebugLogging(on: Boolean, count: usize, categories: *const Text) in ALIVE => |i| {
        let categories = input("categories", categories, count)?;
        i.logger.set_debug_logging(on != FALSE, categories.iter().map(|&name| text(name)))
    };

    /// Sets start time, stop time and tolerance. Without this call the start time is 0 and there is no stop time, with
    /// a warning in the log, as in the reference FMUs.
    fn fmi2SetupExperiment(
        tolerance_defined: Boolean, tolerance: Real, start: Real, stop_defined: Boolean, stop: Real
    ) in INSTANTIATED => |i| {
        let tolerance = (tolerance_defined != FALSE).then_some(tolerance);
        i.setup_experiment(tolerance, start, (stop_defined != FALSE).then_some(stop))
    };

    /// From this call on, outputs have values. They are computed when one is read, or when the mode ends.
    fn fmi2EnterInitializationMode() in INSTANTIATED => |i| {
        if !i.set_up {
            let message = "fmi2EnterInitializationMode: fmi2SetupExperiment was not called; startTime is 0 and \
                           there is no stopTime";
            i.logger.remark(message);
        }
        i.phase = Phase::Initialization;
        Ok(())
    };

    /// Solves the loop equations and computes the initial state. After an error the instance stays in initialization
    /// mode.
    fn fmi2ExitInitializationMode() in INITIALIZATION => |i| i.exit_initialization_mode();

    /// Ends the simulation. Values can still be read.
    fn fmi2Terminate() in STEP | EVENT | CONTINUOUS | FAILED => |i| {
        i.terminate();
        Ok(())
    };

    /// Returns to the state after instantiation, except for the log categories.
    fn fmi2Reset() in ALIVE => |i| {
        i.reset();
        Ok(())
    };

    /// Reads Reals. An output that has no value in this state is NaN. The other values are returned, and the status is
    /// `fmi2Warning`. After an error, the array may be partly filled.
    // SAFETY: both arrays have `count` elements (2.1.7).
    fn fmi2GetReal(vr: *const ValueReference, count: usize, value: *mut Real) in ALIVE => often |i|
        i.get_real(input("vr", vr, count)?, output("value", value, count)?);

    /// Reads Enumerations, each as the number of its item. There are no Integers. After an error, the array may be
    /// partly filled.
    // SAFETY: both arrays have `count` elements (2.1.7).
    fn fmi2GetInteger(vr: *const ValueReference, count: usize, value: *mut Integer) in ALIVE => |i|
        i.get_enumeration(input("vr", vr, count)?, output("value", value, count)?);

    /// Reads Booleans, each 0 or 1. After an error, the array may be partly filled.
    // SAFETY: both arrays have `count` elements (2.1.7).
    fn fmi2GetBoolean(vr: *const ValueReference, count: usize, value: *mut Boolean) in ALIVE => |i|
        i.get_boolean(input("vr", vr, count)?, output("value", value, count)?);

    /// Reads Strings. There are no Strings, so only the empty list is accepted.
    // SAFETY: both arrays have `count` elements (2.1.7).
    fn fmi2GetString(vr: *const ValueReference, count: usize, value: *mut Text) in ALIVE => |i| {
        output("value", value, count)?;
        none_of_type(i, input("vr", vr, count)?, "String")
    };

    /// Sets Real inputs and parameters. After an error, no value has changed.
    // SAFETY: both arrays have `count` elements (2.1.7).
    fn fmi2SetReal(vr: *const ValueReference, count: usize, value: *const Real) in SETTABLE => often |i|
        i.set_real(input("vr", vr, count)?, input("value", value, count)?);

    /// Sets Enumerations by the numbers of their items. After an error, no value has changed.
    // SAFETY: both arrays have `count` elements (2.1.7).
    fn fmi2SetInteger(vr: *const ValueReference, count: usize, value: *const Integer) in SETTABLE => |i| {
        let values = input("value", value, count)?.iter().map(|&number| i64::from(number));
        i.set_enumeration(input("vr", vr, count)?, values)
    };

    /// Sets Boolean inputs and parameters. Any number except 0 is true. After an error, no value has changed.
    // SAFETY: both arrays have `count` elements (2.1.7).
    fn fmi2SetBoolean(vr: *const ValueReference, count: usize, value: *const Boolean) in SETTABLE => |i| {
        let values = input("value", value, count)?.iter().map(|&value| value != FALSE);
        i.set_boolean(input("vr", vr, count)?, values)
    };

    /// Sets Strings. There are no Strings, so only the empty list is accepted.
    // SAFETY: both arrays have `count` elements (2.1.7).
    fn fmi2SetString(vr: *const ValueReference, count: usize, value: *const Text) in SETTABLE => |i| {
        input("value", value, count)?;
        none_of_type(i, input("vr", vr, count)?, "String")
    };

    /// Saves all data that determine how the simulation continues. An existing state at `*state` is overwritten.
    // SAFETY: `state` points to a pointer, which is NULL or points to a state (2.1.8).
    fn fmi2GetFMUstate(state: *mut FmuState) in ALIVE => |i| state_handle::save(i, state);

    /// Restores a saved state, with the phase in which it was saved.
    // SAFETY: `state` is NULL or points to a state (2.1.8).
    fn fmi2SetFMUstate(state: FmuState) in ALIVE => |i| state_handle::restore(i, state);

    /// Frees a state and sets `*state` to NULL. Does nothing for NULL and for a pointer to NULL. Also legal after a
    /// fatal fault, because the host must free its states.
    // SAFETY: `state` is NULL or points to a pointer, which is NULL or points to a state (2.1.8).
    fn fmi2FreeFMUstate(state: *mut FmuState) in ALIVE | FATAL => |i| state_handle::free(i, state);

    /// Number of bytes that [`fmi2SerializeFMUstate`] writes.
    // SAFETY: `state` is NULL or points to a state, `size` points to memory for a number (2.1.8).
    fn fmi2SerializedFMUstateSize(state: FmuState, size: *mut usize) in ALIVE => |i| {
        output("size", size, 1)?[0].write(state_handle::serialized_size(i, state)?);
        Ok(())
    };

    /// Writes the state as bytes that any process on any machine can read. `size` is the result of
    /// [`fmi2SerializedFMUstateSize`].
    // SAFETY: `state` is NULL or points to a state, `bytes` points to memory for `size` bytes (2.1.8).
    fn fmi2SerializeFMUstate(state: FmuState, bytes: *mut Byte, size: usize) in ALIVE => |i|
        state_handle::serialize_to(i, state, bytes.cast(), size);

    /// Creates a state from bytes of [`fmi2SerializeFMUstate`], in this process or another. The previous value of
    /// `*state` is not read.
    // SAFETY: `bytes` has `size` bytes, `state` points to memory for a pointer (2.1.8).
    fn fmi2DeSerializeFMUstate(bytes: *const Byte, size: usize, state: *mut FmuState) in ALIVE => |i|
        state_handle::deserialize(i, input("serializedState", bytes.cast::<u8>(), size)?, state);

    /// For each unknown, the sum over the knowns of partial derivative times `known_rates`, exact, at the present
    /// state.
    ///
    /// An unknown is a continuous output, a known is a continuous input. An unknown whose derivative does not exist in
    /// this state gets NaN, with `fmi2Warning`. With `solver.method` = "rigid_fem" the call returns an error. After an
    /// error, the array may be partly filled.
    // SAFETY: two arrays have `unknown_count` elements, two have `known_count` (2.1.9).
    fn fmi2GetDirectionalDerivative(
        unknowns: *const ValueReference, unknown_count: usize, knowns: *const ValueReference, known_count: usize,
        known_rates: *const Real, unknown_rates: *mut Real
    ) in INITIALIZATION | EVENT | CONTINUOUS | STEPPED => |i| {
        let unknowns = input("vUnknown_ref", unknowns, unknown_count)?;
        let knowns = input("vKnown_ref", knowns, known_count)?;
        let seeds = input("dvKnown", known_rates, known_count)?;
        i.directional_derivative(unknowns, knowns, seeds, output("dvUnknown", unknown_rates, unknown_count)?)
    };

    /// Sets derivatives of order 1 and 2 of continuous inputs. The input is u(t) = u_0 + u_1 t + u_2 t^2 / 2, with the
    /// time t from the present communication point. After an error, no derivative has changed.
    ///
    /// The default is 0. The derivatives refer to the start of a step (4.2.1) and are valid for one step. At the end of
    /// the step the inputs are u(h), which `fmi2GetReal` then returns, and stay constant. `fmi2SetReal` sets u_0,
    /// before or after this function. With `solver.method` = "rigid_fem" the call returns an error.
    // SAFETY: all arrays have `count` elements (4.2.1).
    fn fmi2SetRealInputDerivatives(
        vr: *const ValueReference, count: usize, order: *const Integer, value: *const Real
    ) in SETTABLE => often |i| {
        let (vr, order) = (input("vr", vr, count)?, input("order", order, count)?);
        i.set_input_derivatives(vr, order, input("value", value, count)?)
    };

    /// First time derivatives of continuous outputs, exact, at the present communication point. The inputs change with
    /// the derivatives that are set for the next step. After a step, until an input is set, the inputs change with the
    /// derivatives at the end of the step.
    ///
    /// A derivative that does not exist in this state is NaN, with `fmi2Warning`. With `solver.method` = "rigid_fem"
    /// the call returns an error. After an error, the array may be partly filled.
    // SAFETY: all arrays have `count` elements (4.2.1).
    fn fmi2GetRealOutputDerivatives(
        vr: *const ValueReference, count: usize, order: *const Integer, value: *mut Real
    ) in INITIALIZATION | STEPPED => |i| {
        let (vr, order) = (input("vr", vr, count)?, input("order", order, count)?);
        i.output_derivatives(vr, order, output("value", value, count)?)
    };

    /// Advances by exactly `h` [s] from the present communication point `point` [s].
    ///
    /// Rejected without any change: an `h` that is not finite and positive, a `point` that is not the instance's time,
    /// a step past the stop time. Steps are synchronous. The last argument has no effect, because any state can be
    /// restored.
    ///
    /// `fmi2Discard`: the step reached `solver.max_steps` before its end (4.2.2). The state is that at
    /// `fmi2LastSuccessfulTime`, and values can be read. To continue, restore an earlier state or reset the instance.
    fn fmi2DoStep(point: Real, h: Real, _no_set_state_prior: Boolean) in STEP => often |i|
        i.do_step(point, h, &mut Parts::at_most(0));

    /// Always an error: steps are synchronous, so there is no step to cancel.
    fn fmi2CancelStep() in ALIVE => |_i|
        Err(Refusal::error("no step is in progress; fmi2DoStep returns when its step is complete"));

    /// `fmi2DoStepStatus`: how the last step ended.
    // SAFETY: `value` points to memory for one value (4.2.3).
    fn fmi2GetStatus(kind: c_int, value: *mut Status) in STEPPED => |i| {
        let last = match i.phase {
            Phase::Failed => Status::Error,
            Phase::Interrupted => Status::Discard,
            _ => Status::Ok,
        };
        answer(value, kind, DO_STEP_STATUS, last)
    };

    /// `fmi2LastSuccessfulTime`: end of the last successful step, or the time that an interrupted step has reached [s].
    // SAFETY: `value` points to memory for one value (4.2.3).
    fn fmi2GetRealStatus(kind: c_int, value: *mut Real) in STEPPED => |i|
        answer(value, kind, LAST_SUCCESSFUL_TIME, i.clock.time);

    /// Always `fmi2Discard`: no status is an Integer.
    fn fmi2GetIntegerStatus(kind: c_int, _value: *mut Integer) in STEPPED => |_i| Err(no_such_status(kind));

    /// `fmi2Terminated`: always false, because no model ends the simulation.
    // SAFETY: `value` points to memory for one value (4.2.3).
    fn fmi2GetBooleanStatus(kind: c_int, value: *mut Boolean) in STEPPED => |_i| answer(value, kind, TERMINATED, FALSE);

    /// Always `fmi2Discard`: no step is ever pending, so `fmi2PendingStatus` has no value.
    fn fmi2GetStringStatus(kind: c_int, _value: *mut Text) in STEPPED => |_i| Err(no_such_status(kind));
}

/// Writes the status if `kind` is the kind of status that the called function returns.
///
/// # Safety
/// As for `array::output` of one element.
unsafe fn answer<T>(value: *mut T, kind: c_int, known: c_int, status: T) -> Result<(), Refusal> {
    // SAFETY: guaranteed by the caller.
    let value = unsafe { output("value", value, 1) }?;
    if kind != known {
        return Err(no_such_status(kind));
    }
    value[0].write(status);
    Ok(())
}

/// Refusal of a status kind that the called function does not return.
fn no_such_status(kind: c_int) -> Refusal {
    match kind {
        DO_STEP_STATUS..=TERMINATED => {
            let name = ["fmi2DoStepStatus", "fmi2PendingStatus", "fmi2LastSuccessfulTime", "fmi2Terminated"];
            let hint = if kind == PENDING_STATUS { "; steps are never pending in this FMU" } else { "" };
            Refusal::discard(format!("there is no status of the kind {}{hint}", name[kind as usize]))
        }
        _ => Refusal::error(format!("the status kind is {kind}, but a status kind must be from 0 to 3")),
    }
}
