//! The exported functions of FMI 3.0.2 for model exchange (3.2). The contract of the pointers is that of the module
//! `fmi3`.

use super::VERSION;
use super::functions::sink;
use super::types::{Boolean, Environment, FALSE, Instance as Component, LogMessage, Status, Text};
use crate::component::ModelKind;
use crate::fmi::array::{input, output, text};
use crate::fmi::exchange::served;
use crate::fmi::logger::Logger;
use crate::fmi::phase::{ALIVE, Function};
use crate::fmi::usage::Usage;
use crate::fmi::{exported_exchange, handle, resources};

/// `fmi3InstantiateModelExchange`: a new instance for model exchange of one of the `kinds` in the library, from the
/// definition file in the resources folder. Returns NULL, with a message, if anything is wrong or if the XML does not
/// declare model exchange. The path is that of [`super::instantiate_co_simulation`].
pub unsafe fn instantiate_model_exchange(
    kinds: &[ModelKind],
    name: Text,
    token: Text,
    resource_path: Text,
    logging_on: Boolean,
    environment: Environment,
    log_message: Option<LogMessage>,
) -> Component {
    // SAFETY: strings belong to the host and are valid during the call (2.2.6).
    unsafe {
        let (name, token, path) = (text(name).unwrap_or_default(), text(token), text(resource_path));
        let logger = Logger::new(sink(environment, log_message), logging_on != FALSE);
        let function = "fmi3InstantiateModelExchange";
        handle::instantiate(VERSION, function, name, logger, Usage::MODEL_EXCHANGE, || {
            served(resources::load(kinds, "instantiationToken", token, path)?)
        })
    }
}

exported_exchange! {
    fmi3EnterContinuousTimeMode, fmi3CompletedIntegratorStep, fmi3SetTime, fmi3SetContinuousStates,
    fmi3GetContinuousStateDerivatives, fmi3GetEventIndicators, fmi3GetContinuousStates,
        fmi3GetNominalsOfContinuousStates;

    /// Number of event indicators.
    // SAFETY: the pointer points to memory for one value (3.2.2).
    fn fmi3GetNumberOfEventIndicators(count: *mut usize) in ALIVE => |i| {
        output("nEventIndicators", count, 1)?[0].write(i.indicator_count()?);
        Ok(())
    };

    /// Number of continuous states.
    // SAFETY: the pointer points to memory for one value (3.2.2).
    fn fmi3GetNumberOfContinuousStates(count: *mut usize) in ALIVE => |i| {
        output("nContinuousStates", count, 1)?[0].write(i.state_count()?);
        Ok(())
    };
}
