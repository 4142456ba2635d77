//! The exported functions of FMI 3.0.2 for co-simulation: life cycle, logging, values, states, derivatives, steps (2.2,
//! 2.3, 4.2). The contract of the pointers is that of the module `fmi3`.

use super::VERSION;
use super::step::{intermediate_update, set_update};
use super::types::{
    Boolean, DEPENDENT, Enumeration, Environment, FALSE, FmuState, Instance as Component, IntermediateUpdateCallback,
    LogMessage, Status, Text, ValueReference,
};
use crate::component::ModelKind;
use crate::fmi::access::none_of_type;
use crate::fmi::array::{input, output, text};
use crate::fmi::instance::Instance;
use crate::fmi::logger::{Logger, Sink};
use crate::fmi::phase::{
    ALIVE, CONTINUOUS, EVENT, FAILED, FATAL, Function, INITIALIZATION, INSTANTIATED, INTERMEDIATE, Phase, SETTABLE,
    STEP, STEPPED,
};
use crate::fmi::refusal::Refusal;
use crate::fmi::usage::Usage;
use crate::fmi::vectors::wrong_number;
use crate::fmi::{exported, handle, resources, state_handle};

/// Always `"3.0"`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3GetVersion() -> Text {
    c"3.0".as_ptr()
}

/// `fmi3InstantiateCoSimulation`: a new instance for co-simulation of one of the `kinds` in the library, from the
/// definition file in the resources folder. Returns NULL, with a message, if anything is wrong.
///
/// A NULL or empty path means the folder `resources` of the FMU that contains this library. With event mode and early
/// return, a step ends when a stop is reached or released. Event mode is rejected if the XML does not declare it,
/// because the model has no events. The callback, if there is one, is called after each internal step. The callback may
/// read any variable, so the list of required variables has no effect.
#[expect(clippy::too_many_arguments, reason = "those of the standard's function")]
pub unsafe fn instantiate_co_simulation(
    kinds: &[ModelKind],
    name: Text,
    token: Text,
    resource_path: Text,
    logging_on: Boolean,
    event_mode_used: Boolean,
    early_return_allowed: Boolean,
    environment: Environment,
    log_message: Option<LogMessage>,
    update: Option<IntermediateUpdateCallback>,
) -> Component {
    // SAFETY: strings belong to the host and are valid during the call (2.2.6).
    unsafe {
        let (name, token, path) = (text(name).unwrap_or_default(), text(token), text(resource_path));
        let logger = Logger::new(sink(environment, log_message), logging_on != FALSE);
        let usage = Usage {
            event_mode: event_mode_used != FALSE,
            early_return: early_return_allowed != FALSE,
            intermediate_update: update.is_some(),
            model_exchange: false,
        };
        let c = handle::instantiate(VERSION, "fmi3InstantiateCoSimulation", name, logger, usage, || {
            let loaded = resources::load(kinds, "instantiationToken", token, path)?;
            if usage.event_mode && !loaded.component.has_events() {
                return Err(Refusal::error(
                    "eventModeUsed is true, but this FMU has no events and therefore no event mode (hasEventMode \
                     is false); pass false",
                ));
            }
            Ok(loaded)
        });
        if let (false, Some(callback)) = (c.is_null(), update) {
            set_update(c, intermediate_update(callback, environment, usage.early_return));
        }
        c
    }
}

/// Frees an instance. Does nothing for NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeInstance(instance: Component) {
    // SAFETY: the instance is not used again (2.2.1).
    unsafe { handle::free(instance) }
}

/// The host's logger.
pub(super) fn sink(environment: Environment, log_message: Option<LogMessage>) -> Option<Sink> {
    let callback = log_message?;
    Some(Box::new(move |verdict, category, message| {
        // SAFETY: FMI 3.0.2, 2.2.4: the host's logger may be called in any FMI function, with the host's environment.
        // Both strings are valid during the call.
        unsafe { callback(environment, verdict.into(), category.as_ptr(), message.as_ptr()) }
    }))
}

exported! {
    /// Switches log categories. An empty list means all categories. Unknown categories are rejected.
    // SAFETY: `categories` has `count` strings (2.2.4).
    fn fmi3SetDebugLogging(on: Boolean, count: usize, categories: *const Text) in ALIVE => |i| {
        let categories = input("categories", categories, count)?;
        i.logger.set_debug_logging(on != FALSE, categories.iter().map(|&name| text(name)))
    };

    /// Sets tolerance, start time and stop time. From this call on, outputs have values. They are computed when one is
    /// read, or when the mode ends.
    fn fmi3EnterInitializationMode(
        tolerance_defined: Boolean, tolerance: f64, start: f64, stop_defined: Boolean, stop: f64
    ) in INSTANTIATED => |i| {
        let tolerance = (tolerance_defined != FALSE).then_some(tolerance);
        i.setup_experiment(tolerance, start, (stop_defined != FALSE).then_some(stop))?;
        i.phase = Phase::Initialization;
        Ok(())
    };

    /// Solves the loop equations and computes the initial state. The next phase is step mode, or event mode if the host
    /// uses it. After an error the instance stays in initialization mode.
    fn fmi3ExitInitializationMode() in INITIALIZATION => |i| i.exit_initialization_mode();

    /// Ends the simulation. Values can still be read.
    fn fmi3Terminate() in STEP | EVENT | CONTINUOUS | FAILED => |i| {
        i.terminate();
        Ok(())
    };

    /// Returns to the state after instantiation, except for the log categories.
    fn fmi3Reset() in ALIVE => |i| {
        i.reset();
        Ok(())
    };

    /// Reads Float64 variables, the time, and vectors, element by element. An output that has no value in this state is
    /// NaN. The other values are returned, and the status is `fmi3Warning`. After an error, the array may be partly
    /// filled.
    // SAFETY: the counts are the numbers of elements of the arrays (2.2.6).
    fn fmi3GetFloat64(vr: *const ValueReference, count: usize, value: *mut f64,
        values: usize) in ALIVE | INTERMEDIATE => often |i|
        i.get_serialised(input("valueReferences", vr, count)?, output("values", value, values)?);

    /// Reads Booleans, each 0 or 1. After an error, the array may be partly filled.
    // SAFETY: the counts are the numbers of elements of the arrays (2.2.6).
    fn fmi3GetBoolean(vr: *const ValueReference, count: usize, value: *mut Boolean,
        values: usize) in ALIVE | INTERMEDIATE => |i| {
        let (vr, value) = (input("valueReferences", vr, count)?, output("values", value, values)?);
        same_length(count, values)?;
        i.get_boolean(vr, value)
    };

    /// Reads Enumerations, each as the number of its item. There are no Int64 variables. After an error, the array may
    /// be partly filled.
    // SAFETY: the counts are the numbers of elements of the arrays (2.2.6).
    fn fmi3GetInt64(vr: *const ValueReference, count: usize, value: *mut i64,
        values: usize) in ALIVE | INTERMEDIATE => |i| {
        let (vr, value) = (input("valueReferences", vr, count)?, output("values", value, values)?);
        same_length(count, values)?;
        i.get_enumeration(vr, value)
    };

    /// Reads Strings. There are no Strings, so only the empty list is accepted.
    // SAFETY: the counts are the numbers of elements of the arrays (2.2.6).
    fn fmi3GetString(vr: *const ValueReference, count: usize, value: *mut Text,
        values: usize) in ALIVE | INTERMEDIATE => |i| {
        output("values", value, values)?;
        same_length(count, values)?;
        none_of_type(i, input("valueReferences", vr, count)?, "String")
    };

    /// Sets Float64 inputs and parameters. After an error, no value has changed.
    // SAFETY: the counts are the numbers of elements of the arrays (2.2.6).
    fn fmi3SetFloat64(vr: *const ValueReference, count: usize, value: *const f64, values: usize)
    in SETTABLE => often |i|
        i.set_serialised(input("valueReferences", vr, count)?, input("values", value, values)?);

    /// Sets Boolean inputs and parameters. After an error, no value has changed.
    // SAFETY: the counts are the numbers of elements of the arrays (2.2.6).
    fn fmi3SetBoolean(vr: *const ValueReference, count: usize, value: *const Boolean,
        values: usize) in SETTABLE => |i| {
        let (vr, value) = (input("valueReferences", vr, count)?, input("values", value, values)?);
        same_length(count, values)?;
        i.set_boolean(vr, value.iter().map(|&value| value != FALSE))
    };

    /// Sets Enumerations by the numbers of their items. After an error, no value has changed.
    // SAFETY: the counts are the numbers of elements of the arrays (2.2.6).
    fn fmi3SetInt64(vr: *const ValueReference, count: usize, value: *const i64, values: usize) in SETTABLE => |i| {
        let (vr, value) = (input("valueReferences", vr, count)?, input("values", value, values)?);
        same_length(count, values)?;
        i.set_enumeration(vr, value.iter().copied())
    };

    /// Sets Strings. There are no Strings, so only the empty list is accepted.
    // SAFETY: the counts are the numbers of elements of the arrays (2.2.6).
    fn fmi3SetString(vr: *const ValueReference, count: usize, value: *const Text, values: usize) in SETTABLE => |i| {
        input("values", value, values)?;
        same_length(count, values)?;
        none_of_type(i, input("valueReferences", vr, count)?, "String")
    };

    /// Saves all data that determine how the simulation continues. An existing state at `*state` is overwritten.
    // SAFETY: `state` points to a pointer, which is NULL or points to a state (2.2.10).
    fn fmi3GetFMUState(state: *mut FmuState) in ALIVE => |i| state_handle::save(i, state);

    /// Restores a saved state, with the phase in which it was saved.
    // SAFETY: `state` is NULL or points to a state (2.2.10).
    fn fmi3SetFMUState(state: FmuState) in ALIVE => |i| state_handle::restore(i, state);

    /// Frees a state and sets `*state` to NULL. Does nothing for NULL and for a pointer to NULL. Also legal after a
    /// fatal fault, because the host must free its states.
    // SAFETY: `state` is NULL or points to a pointer, which is NULL or points to a state (2.2.10).
    fn fmi3FreeFMUState(state: *mut FmuState) in ALIVE | FATAL => |i| state_handle::free(i, state);

    /// Number of bytes that [`fmi3SerializeFMUState`] writes.
    // SAFETY: `state` is NULL or points to a state, `size` points to memory for a number (2.2.10).
    fn fmi3SerializedFMUStateSize(state: FmuState, size: *mut usize) in ALIVE => |i| {
        output("size", size, 1)?[0].write(state_handle::serialized_size(i, state)?);
        Ok(())
    };

    /// Writes the state as bytes that any process on any machine can read. `size` is the result of
    /// [`fmi3SerializedFMUStateSize`].
    // SAFETY: `state` is NULL or points to a state, `bytes` points to memory for `size` bytes (2.2.10).
    fn fmi3SerializeFMUState(state: FmuState, bytes: *mut u8, size: usize) in ALIVE => |i|
        state_handle::serialize_to(i, state, bytes, size);

    /// Creates a state from bytes of [`fmi3SerializeFMUState`], in this process or another. The previous value of
    /// `*state` is not read.
    // SAFETY: `bytes` has `size` bytes, `state` points to memory for a pointer (2.2.10).
    fn fmi3DeserializeFMUState(bytes: *const u8, size: usize, state: *mut FmuState) in ALIVE => |i|
        state_handle::deserialize(i, input("serializedState", bytes, size)?, state);

    /// For each unknown, the sum over the knowns of partial derivative times seed, exact, at the present state.
    ///
    /// An unknown is a continuous output, a known is a continuous input. An unknown whose derivative does not exist in
    /// this state gets NaN, with `fmi3Warning`. With `solver.method` = "rigid_fem" the call returns an error. After an
    /// error, the array may be partly filled.
    // SAFETY: the counts are the numbers of elements of the arrays (2.2.11).
    fn fmi3GetDirectionalDerivative(
        unknowns: *const ValueReference, unknown_count: usize, knowns: *const ValueReference, known_count: usize,
        seed: *const f64, seeds: usize, sensitivity: *mut f64, sensitivities: usize
    ) in INITIALIZATION | EVENT | CONTINUOUS | INTERMEDIATE | STEPPED => |i| {
        let (unknowns, knowns) = (input("unknowns", unknowns, unknown_count)?, input("knowns", knowns, known_count)?);
        let (seed, sensitivity) = (input("seed", seed, seeds)?, output("sensitivity", sensitivity, sensitivities)?);
        scalar_knowns(i, unknowns, knowns)?;
        same_length(known_count, seeds)?;
        i.serialised(unknowns, sensitivities, |i, unknowns| {
            i.directional_derivative(unknowns, knowns, seed, sensitivity)
        })
    };

    /// For each known, the sum over the unknowns of seed times partial derivative. The method is that of
    /// [`fmi3GetDirectionalDerivative`], with one direction for each known.
    // SAFETY: the counts are the numbers of elements of the arrays (2.2.11).
    fn fmi3GetAdjointDerivative(
        unknowns: *const ValueReference, unknown_count: usize, knowns: *const ValueReference, known_count: usize,
        seed: *const f64, seeds: usize, sensitivity: *mut f64, sensitivities: usize
    ) in INITIALIZATION | EVENT | CONTINUOUS | INTERMEDIATE | STEPPED => |i| {
        let (unknowns, knowns) = (input("unknowns", unknowns, unknown_count)?, input("knowns", knowns, known_count)?);
        let (seed, sensitivity) = (input("seed", seed, seeds)?, output("sensitivity", sensitivity, sensitivities)?);
        scalar_knowns(i, unknowns, knowns)?;
        same_length(known_count, sensitivities)?;
        i.serialised(unknowns, seeds, |i, unknowns| i.adjoint_derivative(unknowns, knowns, seed, sensitivity))
    };

    /// First time derivatives of continuous outputs at the present communication point, exact.
    ///
    /// A derivative that does not exist in this state is NaN, with `fmi3Warning`. With `solver.method` = "rigid_fem"
    /// the call returns an error. After an error, the array may be partly filled.
    // SAFETY: the counts are the numbers of elements of the arrays (4.2.4).
    fn fmi3GetOutputDerivatives(
        vr: *const ValueReference, count: usize, order: *const i32, value: *mut f64, values: usize
    ) in INITIALIZATION | INTERMEDIATE | STEPPED => |i| {
        let (vr, order) = (input("valueReferences", vr, count)?, input("orders", order, count)?);
        let value = output("values", value, values)?;
        i.without_time(vr, NO_DERIVATIVES)?;
        i.serialised_orders(vr, order, values, |i, vr, order| i.output_derivatives(vr, order, value))
    };

    /// Number of dependencies of an output that [`fmi3GetVariableDependencies`] returns.
    // SAFETY: `count` points to memory for a number (2.2.9).
    fn fmi3GetNumberOfVariableDependencies(vr: ValueReference, count: *mut usize) in ALIVE => |i| {
        let count = output("nDependencies", count, 1)?;
        count[0].write(i.dependencies(vr)?.len());
        Ok(())
    };

    /// The knowns on which an output depends, for each element of a vector. Before the end of initialization mode, the
    /// dependencies are those of the initial value. The element of a scalar is 0. Each kind is `fmi3Dependent`.
    // SAFETY: each array has `count` elements (2.2.9).
    fn fmi3GetVariableDependencies(
        dependent: ValueReference, elements: *mut usize, independents: *mut ValueReference,
        independent_elements: *mut usize, kinds: *mut Enumeration, count: usize
    ) in ALIVE => |i| {
        let elements = output("elementIndicesOfDependent", elements, count)?;
        let independents = output("independents", independents, count)?;
        let independent_elements = output("elementIndicesOfIndependents", independent_elements, count)?;
        let kinds = output("dependencyKinds", kinds, count)?;
        let dependencies = i.dependencies(dependent)?;
        if dependencies.len() != count {
            let needed = dependencies.len();
            return Err(Refusal::error(format!("nDependencies is {count}, but the variable has {needed} \
                                               dependencies; pass arrays of {needed} elements")));
        }
        for (index, (element, known)) in dependencies.into_iter().enumerate() {
            elements[index].write(element);
            independents[index].write(known);
            independent_elements[index].write(0);
            kinds[index].write(DEPENDENT);
        }
        Ok(())
    };

    /// Changes from step mode to event mode, to handle an event or to let inputs jump.
    fn fmi3EnterEventMode() in STEP | CONTINUOUS => |i| i.enter_event_mode();

    /// Changes from event mode to step mode. If a step ended at an event, [`fmi3UpdateDiscreteStates`] must be called
    /// before.
    fn fmi3EnterStepMode() in EVENT => |i| i.enter_step_mode();

    /// Does nothing: outputs are always computed from the present inputs, and no variable is a discrete state.
    fn fmi3EvaluateDiscreteStates() in INITIALIZATION | EVENT => |_i| Ok(());

    /// Handles the event at which a step ended: applies the impact, or engages a lock. `*values_changed`: whether the
    /// state jumped. One call is enough. `*next_event` is the next kink of a prescribed motion in model exchange.
    /// Otherwise no event time is known, and `*next_event` is not written.
    // SAFETY: each pointer points to memory for one value (2.3.5).
    fn fmi3UpdateDiscreteStates(
        update_needed: *mut Boolean, terminate: *mut Boolean, nominals_changed: *mut Boolean,
        values_changed: *mut Boolean, next_event_defined: *mut Boolean, next_event: *mut f64
    ) in EVENT => |i| {
        let flags = [
            output("discreteStatesNeedUpdate", update_needed, 1)?, output("terminateSimulation", terminate, 1)?,
            output("nominalsOfContinuousStatesChanged", nominals_changed, 1)?,
        ];
        let values_changed = output("valuesOfContinuousStatesChanged", values_changed, 1)?;
        let next_event_defined = output("nextEventTimeDefined", next_event_defined, 1)?;
        let next_event = output("nextEventTime", next_event, 1)?;
        values_changed[0].write(i.update_discrete_states()?.into());
        for flag in flags {
            flag[0].write(FALSE);
        }
        let next = i.component.next_event();
        next_event_defined[0].write(next.is_some().into());
        if let Some(time) = next {
            next_event[0].write(time);
        }
        Ok(())
    };
}

/// Message for the time in a call about derivatives.
const NO_DERIVATIVES: &str = "this variable is neither an input nor an output";

/// Rejects the time among the unknowns and knowns of a derivative, and vectors, which are outputs, among the knowns.
fn scalar_knowns(i: &Instance, unknowns: &[ValueReference], knowns: &[ValueReference]) -> Result<(), Refusal> {
    i.without_time(unknowns, NO_DERIVATIVES)?;
    i.without_time(knowns, NO_DERIVATIVES)?;
    i.without_vectors(knowns, "this variable is an output; a known must be an input")
}

/// Returns an error unless there is one value for each variable.
pub(super) fn same_length(variables: usize, values: usize) -> Result<(), Refusal> {
    if variables == values { Ok(()) } else { Err(wrong_number(variables, variables, values)) }
}
