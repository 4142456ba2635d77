//! The C interface of FMI 2.0.5. Each exported function is 1 to 4 lines that call the shared parts in `fmi`.
//!
//! In: the host's calls. Out: statuses and values. Each function states the phases in which it is legal, according to
//! the state machine of FMI 2.0.5, 4.2.4. `types` contains the C types. Must not know: any kind of model.
//!
//! Co-simulation and model exchange are complete, except for features that the XML does not declare. A function of one
//! interface type returns an error for an instance of the other.
//!
//! # Safety
//! All functions share the contract of the standard. A component is NULL or comes from [`fmi2Instantiate`] and was not
//! freed. One thread at a time uses a component (2.1.5), or a state that is written or freed (2.1.8). The count of an
//! array argument is the number of its elements, and a string is zero-terminated (2.1.4, 2.1.7). A NULL argument gives
//! `fmi2Error`, except as an empty array.
#![allow(unsafe_code, non_snake_case, clippy::missing_safety_doc)]

mod exchange;
mod functions;
pub mod host;
pub mod importer;
mod instantiation;
pub mod types;

use crate::fmi::version::Version;
use crate::variables::Kind;
pub use exchange::*;
pub use functions::*;
pub use instantiation::*;

/// The properties of FMI 2.0 that an instance needs.
pub(crate) const VERSION: Version = Version::of_scalars(Kind::word);

#[cfg(test)]
mod tests {
    use super::{exchange, functions};
    use crate::fmi::phase::{Function, Phase};

    fn all() -> impl Iterator<Item = &'static Function> {
        functions::FUNCTIONS.iter().chain(exchange::FUNCTIONS)
    }

    fn function(name: &str) -> &'static Function {
        all().find(|function| function.name == name).unwrap()
    }

    #[test]
    fn only_freeing_is_legal_after_a_fatal_fault() {
        assert_eq!(all().count(), 40);
        let legal = all().filter(|function| function.is_legal_in(Phase::Fatal));
        assert_eq!(legal.map(|function| function.name).collect::<Vec<_>>(), ["fmi2FreeFMUstate"]);
    }

    /// Any instance of the kind can free the states of a fatal instance, including the fatal instance.
    #[test]
    fn a_fatal_instance_frees_its_states() {
        use super::types::Status;
        use crate::component::Component;
        use crate::fmi::{handle, logger::Logger, refusal::Verdict, usage::Usage};
        use crate::mechanism::GEAR;
        let load = || Ok(Component::from_definition("mechanism.json", GEAR)?.into());
        let c = handle::instantiate(
            super::VERSION,
            "instantiate",
            c"gear",
            Logger::new(None, false),
            Usage::default(),
            load,
        );
        // SAFETY: the component is valid until it is freed, and so are the states.
        unsafe {
            let (mut one, mut other) = (std::ptr::null_mut(), std::ptr::null_mut());
            assert_eq!(super::fmi2GetFMUstate(c, &mut one), Status::Ok);
            assert_eq!(super::fmi2GetFMUstate(c, &mut other), Status::Ok);
            assert_eq!(handle::call(c, function("fmi2GetReal"), |_| panic!("on purpose")), Verdict::Fatal);
            assert_eq!(super::fmi2GetFMUstate(c, &mut one), Status::Fatal);
            assert_eq!(super::fmi2FreeFMUstate(c, &mut one), Status::Ok);
            assert!(one.is_null() && !other.is_null());
            assert_eq!(super::fmi2FreeFMUstate(c, &mut other), Status::Ok);
            assert_eq!(super::fmi2FreeFMUstate(c, &mut other), Status::Ok);
            assert!(other.is_null());
            super::fmi2FreeInstance(c);
        }
    }

    #[test]
    fn the_phases_follow_the_standard() {
        assert_eq!(function("fmi2DoStep").legal_phases(), "step mode");
        assert_eq!(function("fmi2SetupExperiment").legal_phases(), "instantiated");
        assert_eq!(function("fmi2ExitInitializationMode").legal_phases(), "initialization mode");
        assert_eq!(
            function("fmi2Terminate").legal_phases(),
            "step mode, step failed, step interrupted, event mode, continuous-time mode"
        );
        for setter in ["fmi2SetReal", "fmi2SetInteger", "fmi2SetBoolean", "fmi2SetString"] {
            assert!(!function(setter).is_legal_in(Phase::Terminated));
            assert!(!function(setter).is_legal_in(Phase::Failed));
            assert!(!function(setter).is_legal_in(Phase::Interrupted));
        }
    }
}
