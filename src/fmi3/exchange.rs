//! The exported functions of FMI 3.0.2 for model exchange (3.2). The contract of the pointers is that of the module `fmi3`.

use super::VERSION;
use super::functions::sink;
use super::types::{Boolean, Environment, FALSE, Instance as Component, LogMessage, Status, Text};
use crate::fmi::array::{input, output, text};
use crate::fmi::event_mode::Usage;
use crate::fmi::exchange::served;
use crate::fmi::logger::Logger;
use crate::fmi::phase::{ALIVE, CONTINUOUS, EVENT, Function, INSTANTIATED, SOLVABLE};
use crate::fmi::{exported, handle, resources};

/// New instance for model exchange, from the definition file in the folder of resources; NULL, with a message, if anything
/// is amiss, and where the XML does not declare model exchange. The path is that of
/// [`super::fmi3InstantiateCoSimulation`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateModelExchange(
    name: Text,
    token: Text,
    resource_path: Text,
    _visible: Boolean,
    logging_on: Boolean,
    environment: Environment,
    log_message: Option<LogMessage>,
) -> Component {
    // SAFETY: strings are the host's, for the duration of the call (2.2.6).
    unsafe {
        let (name, token, path) = (text(name).unwrap_or_default(), text(token), text(resource_path));
        let logger = Logger::new(sink(environment, log_message), logging_on != FALSE);
        let function = "fmi3InstantiateModelExchange";
        handle::instantiate(VERSION, function, name, logger, Usage::MODEL_EXCHANGE, || {
            served(resources::load("instantiationToken", token, path)?)
        })
    }
}

exported! {
    /// From event mode to continuous-time mode.
    fn fmi3EnterContinuousTimeMode() in EVENT => |i| i.enter_continuous_time_mode();

    /// A step of the host's solver is complete. `*enter_event_mode`: whether a transition is due.
    // SAFETY: both pointers lead to memory for one value (3.2.2).
    fn fmi3CompletedIntegratorStep(
        _no_set_state_prior: Boolean, enter_event_mode: *mut Boolean, terminate: *mut Boolean
    ) in CONTINUOUS => |i| {
        let (enter, terminate) = (output("enterEventMode", enter_event_mode, 1)?, output("terminateSimulation", terminate, 1)?);
        enter[0].write(i.completed_integrator_step()?.into());
        terminate[0].write(FALSE);
        Ok(())
    };

    /// The time at which values are asked for.
    fn fmi3SetTime(time: f64) in EVENT | CONTINUOUS => |i| i.set_time(time);

    /// Take the states that the solver tries. `fmi3Discard` where the mechanism has no such position: a shorter step
    /// avoids it; nothing has changed.
    // SAFETY: the array has `count` elements (3.2.2).
    fn fmi3SetContinuousStates(states: *const f64, count: usize) in CONTINUOUS => |i|
        i.set_continuous_states(input("continuousStates", states, count)?);

    /// Time derivatives of the states; `fmi3Discard` where there are none.
    // SAFETY: the array has `count` elements (3.2.2).
    fn fmi3GetContinuousStateDerivatives(derivatives: *mut f64, count: usize) in SOLVABLE => |i|
        i.derivatives(output("derivatives", derivatives, count)?);

    /// Event indicators; `fmi3Discard` where one has no value.
    // SAFETY: the array has `count` elements (3.2.2).
    fn fmi3GetEventIndicators(indicators: *mut f64, count: usize) in SOLVABLE => |i|
        i.event_indicators(output("eventIndicators", indicators, count)?);

    /// The continuous states.
    // SAFETY: the array has `count` elements (3.2.2).
    fn fmi3GetContinuousStates(states: *mut f64, count: usize) in SOLVABLE => |i|
        i.continuous_states(output("continuousStates", states, count)?);

    /// Scales of the continuous states.
    // SAFETY: the array has `count` elements (3.2.2).
    fn fmi3GetNominalsOfContinuousStates(nominals: *mut f64, count: usize) in INSTANTIATED | SOLVABLE => |i|
        i.nominals(output("nominals", nominals, count)?);

    /// Number of event indicators.
    // SAFETY: the pointer leads to memory for one value (3.2.2).
    fn fmi3GetNumberOfEventIndicators(count: *mut usize) in ALIVE => |i| {
        output("nEventIndicators", count, 1)?[0].write(i.indicator_count()?);
        Ok(())
    };

    /// Number of continuous states.
    // SAFETY: the pointer leads to memory for one value (3.2.2).
    fn fmi3GetNumberOfContinuousStates(count: *mut usize) in ALIVE => |i| {
        output("nContinuousStates", count, 1)?[0].write(i.state_count()?);
        Ok(())
    };
}
