//! The C interface of FMI 2.0.5: every exported function, 1 to 4 lines over the version-free half in `fmi`.
//!
//! In: the host's calls. Out: statuses and values. Each function states the phases in which it is legal: the state
//! machine of FMI 2.0.5, 4.2.4. `types` has the C types. It must not know any kind of model.
//!
//! Co-simulation and model exchange are complete but for what the XML does not declare. A function of the one refuses
//! an instance that was made for the other.
//!
//! # Safety
//! All functions share one contract, the standard's own. A component is NULL or comes from [`fmi2Instantiate`], has not
//! been freed, and is used by one thread at a time (2.1.5); so is a state while it is written or freed (2.1.8). An
//! array argument has as many elements as its count says, and a string ends with a zero byte (2.1.4, 2.1.7). A NULL is
//! answered with `fmi2Error`, wherever it stands, except as an empty array.
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

/// What an instance must know of FMI 2.0.
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

    /// States of an instance that is lost are given back by any instance of the kind, itself included.
    #[test]
    fn a_lost_instance_frees_its_states() {
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
