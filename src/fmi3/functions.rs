//! The exported functions of FMI 3.0.2 that serve co-simulation: life cycle, logging, values, states, derivatives,
//! steps (2.2, 2.3, 4.2). The contract of the pointers is that of the module `fmi3`.

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

/// New instance for co-simulation, `fmi3InstantiateCoSimulation`, of one of the kinds of models that the library has:
/// from the definition file in the folder of resources; NULL, with a message, if anything is amiss.
///
/// A NULL or empty path means the folder `resources` of the FMU that this library lies in. With event mode and early
/// return a step ends where a stop is met or lets go. Event mode is refused where the XML does not declare it, as no
/// stop does. After each internal step the callback is called if there is one; it may read any variable, so that the
/// list of those required has no meaning.
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
    // SAFETY: strings are the host's, for the duration of the call (2.2.6).
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

/// End of an instance; does nothing for NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeInstance(instance: Component) {
    // SAFETY: the instance is not used again (2.2.1).
    unsafe { handle::free(instance) }
}

/// The host's logger.
pub(super) fn sink(environment: Environment, log_message: Option<LogMessage>) -> Option<Sink> {
    let callback = log_message?;
    Some(Box::new(move |verdict, category, message| {
        // SAFETY: FMI 3.0.2, 2.2.4: the host's logger may be called from within any FMI function, with its own
        // environment. Both strings outlive the call.
        unsafe { callback(environment, verdict.into(), category.as_ptr(), message.as_ptr()) }
    }))
}

exported! {
    /// Switch log categories; none given means all. Unknown ones are refused.
    // SAFETY: `categories` has `count` strings (2.2.4).
    fn fmi3SetDebugLogging(on: Boolean, count: usize, categories: *const Text) in ALIVE => |i| {
        let categories = input("categories", categories, count)?;
        i.logger.set_debug_logging(on != FALSE, categories.iter().map(|&name| text(name)))
    };

    /// Tolerance, start time and stop time. From here on outputs have values; they are computed when one is read, or
    /// when the mode ends.
    fn fmi3EnterInitializationMode(
        tolerance_defined: Boolean, tolerance: f64, start: f64, stop_defined: Boolean, stop: f64
    ) in INSTANTIATED => |i| {
        let tolerance = (tolerance_defined != FALSE).then_some(tolerance);
        i.setup_experiment(tolerance, start, (stop_defined != FALSE).then_some(stop))?;
        i.phase = Phase::Initialization;
        Ok(())
    };

    /// Close the loops and start; step mode follows, or event mode if the host makes use of it. After a refusal,
    /// initialization mode goes on.
    fn fmi3ExitInitializationMode() in INITIALIZATION => |i| i.exit_initialization_mode();

    /// End of the simulation; values can still be read.
    fn fmi3Terminate() in STEP | EVENT | CONTINUOUS | FAILED => |i| {
        i.terminate();
        Ok(())
    };

    /// Back to a fresh instance; the log categories stay.
    fn fmi3Reset() in ALIVE => |i| {
        i.reset();
        Ok(())
    };

    /// Read Float64 variables, the time, and vectors, element after element. An output that does not exist in this
    /// state is NaN, all others are told, and the answer is `fmi3Warning`. On an error the array may be filled in part.
    // SAFETY: both arrays have as many elements as said (2.2.6).
    fn fmi3GetFloat64(vr: *const ValueReference, count: usize, value: *mut f64,
        values: usize) in ALIVE | INTERMEDIATE => often |i| {
        let (vr, value) = (input("valueReferences", vr, count)?, output("values", value, values)?);
        if i.are_scalars(vr, values) {
            return i.get_real(vr, value);
        }
        i.serialised(vr, values, |i, vr| i.get_real_or_time(vr, value))
    };

    /// Read Booleans, each 0 or 1. On an error the array may be filled in part.
    // SAFETY: both arrays have as many elements as said (2.2.6).
    fn fmi3GetBoolean(vr: *const ValueReference, count: usize, value: *mut Boolean,
        values: usize) in ALIVE | INTERMEDIATE => |i| {
        let (vr, value) = (input("valueReferences", vr, count)?, output("values", value, values)?);
        same_length(count, values)?;
        i.get_boolean(vr, value)
    };

    /// Read Enumerations, each as the number of its item; there are no Int64 variables. On an error the array may be
    /// filled in part.
    // SAFETY: both arrays have as many elements as said (2.2.6).
    fn fmi3GetInt64(vr: *const ValueReference, count: usize, value: *mut i64,
        values: usize) in ALIVE | INTERMEDIATE => |i| {
        let (vr, value) = (input("valueReferences", vr, count)?, output("values", value, values)?);
        same_length(count, values)?;
        i.get_enumeration(vr, value)
    };

    /// Read Strings: there are none, so that only the empty list can be read.
    // SAFETY: both arrays have as many elements as said (2.2.6).
    fn fmi3GetString(vr: *const ValueReference, count: usize, value: *mut Text,
        values: usize) in ALIVE | INTERMEDIATE => |i| {
        output("values", value, values)?;
        same_length(count, values)?;
        none_of_type(i, input("valueReferences", vr, count)?, "String")
    };

    /// Set Float64 inputs and parameters, all or none.
    // SAFETY: both arrays have as many elements as said (2.2.6).
    fn fmi3SetFloat64(vr: *const ValueReference, count: usize, value: *const f64, values: usize)
    in SETTABLE => often |i| {
        let (vr, value) = (input("valueReferences", vr, count)?, input("values", value, values)?);
        if i.are_scalars(vr, values) {
            return i.set_real(vr, value);
        }
        i.without_time(vr, "it cannot be set")?;
        i.serialised(vr, values, |i, vr| i.set_real(vr, value))
    };

    /// Set Boolean inputs and parameters, all or none.
    // SAFETY: both arrays have as many elements as said (2.2.6).
    fn fmi3SetBoolean(vr: *const ValueReference, count: usize, value: *const Boolean,
        values: usize) in SETTABLE => |i| {
        let (vr, value) = (input("valueReferences", vr, count)?, input("values", value, values)?);
        same_length(count, values)?;
        i.set_boolean(vr, value.iter().map(|&value| value != FALSE))
    };

    /// Set Enumerations by the numbers of their items, all or none.
    // SAFETY: both arrays have as many elements as said (2.2.6).
    fn fmi3SetInt64(vr: *const ValueReference, count: usize, value: *const i64, values: usize) in SETTABLE => |i| {
        let (vr, value) = (input("valueReferences", vr, count)?, input("values", value, values)?);
        same_length(count, values)?;
        i.set_enumeration(vr, value.iter().copied())
    };

    /// Set Strings: there are none, so that only the empty list can be set.
    // SAFETY: both arrays have as many elements as said (2.2.6).
    fn fmi3SetString(vr: *const ValueReference, count: usize, value: *const Text, values: usize) in SETTABLE => |i| {
        input("values", value, values)?;
        same_length(count, values)?;
        none_of_type(i, input("valueReferences", vr, count)?, "String")
    };

    /// Save everything that decides how the instance goes on. A state that `*state` already leads to is overwritten.
    // SAFETY: `state` leads to a pointer, which is NULL or leads to a state (2.2.10).
    fn fmi3GetFMUState(state: *mut FmuState) in ALIVE => |i| state_handle::save(i, state);

    /// Go on from a saved state, in the phase in which it was saved.
    // SAFETY: `state` is NULL or leads to a state (2.2.10).
    fn fmi3SetFMUState(state: FmuState) in ALIVE => |i| state_handle::restore(i, state);

    /// End of a state; `*state` becomes NULL. Does nothing for NULL and for a pointer to NULL. Legal after a fatal
    /// fault, as the host must give back what it holds.
    // SAFETY: `state` is NULL or leads to a pointer, and that is NULL or leads to a state (2.2.10).
    fn fmi3FreeFMUState(state: *mut FmuState) in ALIVE | FATAL => |i| state_handle::free(i, state);

    /// Number of bytes that [`fmi3SerializeFMUState`] writes.
    // SAFETY: `state` is NULL or leads to a state, `size` leads to memory for a number (2.2.10).
    fn fmi3SerializedFMUStateSize(state: FmuState, size: *mut usize) in ALIVE => |i| {
        output("size", size, 1)?[0].write(state_handle::serialized_size(i, state)?);
        Ok(())
    };

    /// Write the state as bytes that any process can read, on any machine. `size` is that of
    /// [`fmi3SerializedFMUStateSize`].
    // SAFETY: `state` is NULL or leads to a state, `bytes` leads to memory for `size` bytes (2.2.10).
    fn fmi3SerializeFMUState(state: FmuState, bytes: *mut u8, size: usize) in ALIVE => |i|
        state_handle::serialize_to(i, state, bytes, size);

    /// New state from bytes of [`fmi3SerializeFMUState`], in this process or another. The previous value of `*state` is
    /// not read.
    // SAFETY: `bytes` has `size` bytes, `state` leads to memory for a pointer (2.2.10).
    fn fmi3DeserializeFMUState(bytes: *const u8, size: usize, state: *mut FmuState) in ALIVE => |i|
        state_handle::deserialize(i, input("serializedState", bytes, size)?, state);

    /// For each unknown the sum over the knowns of the partial derivative times the seed, at the present state, exact.
    ///
    /// An unknown is a continuous output, a known is a continuous input. What has no derivative in this state is NaN,
    /// with `fmi3Warning`. Refused with `solver.method` = "rigid_fem". On an error the array may be filled in part.
    // SAFETY: all arrays have as many elements as said (2.2.11).
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

    /// For each known the sum over the unknowns of the seed times the partial derivative, as
    /// [`fmi3GetDirectionalDerivative`]: one direction for each known.
    // SAFETY: all arrays have as many elements as said (2.2.11).
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
    /// What has no derivative in this state is NaN, with `fmi3Warning`. Refused with `solver.method` = "rigid_fem". On
    /// an error the array may be filled in part.
    // SAFETY: all arrays have as many elements as said (4.2.4).
    fn fmi3GetOutputDerivatives(
        vr: *const ValueReference, count: usize, order: *const i32, value: *mut f64, values: usize
    ) in INITIALIZATION | INTERMEDIATE | STEPPED => |i| {
        let (vr, order) = (input("valueReferences", vr, count)?, input("orders", order, count)?);
        let value = output("values", value, values)?;
        i.without_time(vr, NO_DERIVATIVES)?;
        i.serialised_orders(vr, order, values, |i, vr, order| i.output_derivatives(vr, order, value))
    };

    /// Number of dependencies of an output that [`fmi3GetVariableDependencies`] tells.
    // SAFETY: `count` leads to memory for a number (2.2.9).
    fn fmi3GetNumberOfVariableDependencies(vr: ValueReference, count: *mut usize) in ALIVE => |i| {
        let count = output("nDependencies", count, 1)?;
        count[0].write(i.dependencies(vr)?.len());
        Ok(())
    };

    /// The knowns on which an output depends, for each element of a vector; before the end of initialization mode those
    /// of its initial value. The element of a scalar is 0, which means all of it. Each kind is `fmi3Dependent`.
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

    /// From step mode to event mode: an event is handled, or inputs jump.
    fn fmi3EnterEventMode() in STEP | CONTINUOUS => |i| i.enter_event_mode();

    /// From event mode to step mode. Refused before [`fmi3UpdateDiscreteStates`] if a step has led to an event.
    fn fmi3EnterStepMode() in EVENT => |i| i.enter_step_mode();

    /// Nothing to do: outputs are those under the present inputs whenever they are read, and no variable is a discrete
    /// state.
    fn fmi3EvaluateDiscreteStates() in INITIALIZATION | EVENT => |_i| Ok(());

    /// Handle the event to which a step has led: the impact takes place, and a lock catches. `*values_changed`: whether
    /// the state has jumped. One call is enough. `*next_event` is the next kink of a prescribed motion in model
    /// exchange; otherwise no event is known before, and `*next_event` is not written.
    // SAFETY: each pointer leads to memory for one value (2.3.5).
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

/// What is said of the time in a call about derivatives.
const NO_DERIVATIVES: &str = "this variable is neither an input nor an output";

/// Refuse the time among the unknowns and knowns of a derivative, and vectors among the knowns: they are outputs.
fn scalar_knowns(i: &Instance, unknowns: &[ValueReference], knowns: &[ValueReference]) -> Result<(), Refusal> {
    i.without_time(unknowns, NO_DERIVATIVES)?;
    i.without_time(knowns, NO_DERIVATIVES)?;
    i.without_vectors(knowns, "this variable is an output; a known must be an input")
}

/// Every variable of the call is a scalar: as many values as variables.
pub(super) fn same_length(variables: usize, values: usize) -> Result<(), Refusal> {
    if variables == values { Ok(()) } else { Err(wrong_number(variables, variables, values)) }
}
