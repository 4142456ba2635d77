//! The functions of FMI 3.0 that create an instance, for the kinds of models in a library. A library with fewer kinds
//! is smaller, because only these functions refer to the code of the kinds.
//!
//! In: the kinds, the host's arguments. Out: an instance. Must not know: any kind.
use crate::component::KINDS;

/// Defines the functions of FMI 3.0 that create an instance of one of the kinds, with this attribute. The contract of
/// the pointers is that of the module [`fmi3`](crate::fmi3).
#[macro_export]
macro_rules! fmi3_instantiation {
    ($kinds:expr $(, $attribute:meta)?) => {
        /// FMI 3.0.2, 4.2.2: creates an instance for co-simulation. `visible` and the list of variables that the
        /// callback reads have no effect.
        $(#[$attribute])?
        pub unsafe extern "C" fn fmi3InstantiateCoSimulation(
            name: $crate::fmi3::types::Text,
            token: $crate::fmi3::types::Text,
            resources: $crate::fmi3::types::Text,
            _visible: $crate::fmi3::types::Boolean,
            logging_on: $crate::fmi3::types::Boolean,
            event_mode: $crate::fmi3::types::Boolean,
            early_return: $crate::fmi3::types::Boolean,
            _required: *const $crate::fmi3::types::ValueReference,
            _required_count: usize,
            environment: $crate::fmi3::types::Environment,
            log: Option<$crate::fmi3::types::LogMessage>,
            update: Option<$crate::fmi3::types::IntermediateUpdateCallback>,
        ) -> $crate::fmi3::types::Instance {
            let kinds: &[$crate::component::ModelKind] = $kinds;
            // SAFETY: the caller is the host, which guarantees the contract of the pointers.
            unsafe {
                $crate::fmi3::instantiate_co_simulation(
                    kinds, name, token, resources, logging_on, event_mode, early_return, environment, log, update,
                )
            }
        }

        /// FMI 3.0.2, 3.2.1: creates an instance for model exchange. `visible` has no effect.
        $(#[$attribute])?
        pub unsafe extern "C" fn fmi3InstantiateModelExchange(
            name: $crate::fmi3::types::Text,
            token: $crate::fmi3::types::Text,
            resources: $crate::fmi3::types::Text,
            _visible: $crate::fmi3::types::Boolean,
            logging_on: $crate::fmi3::types::Boolean,
            environment: $crate::fmi3::types::Environment,
            log: Option<$crate::fmi3::types::LogMessage>,
        ) -> $crate::fmi3::types::Instance {
            let kinds: &[$crate::component::ModelKind] = $kinds;
            // SAFETY: the caller is the host, which guarantees the contract of the pointers.
            unsafe {
                $crate::fmi3::instantiate_model_exchange(kinds, name, token, resources, logging_on, environment, log)
            }
        }
    };
}

pub use fmi3_instantiation as instantiation;

fmi3_instantiation!(&KINDS);
