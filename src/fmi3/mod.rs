//! The C interface of FMI 3.0.2: every exported function, 1 to 4 lines over the version-free half in `fmi`.
//!
//! In: the host's calls. Out: statuses and values. Each function states the phases in which it is legal: the state
//! machine of FMI 3.0.2, 4.2.1. `types` has the C types. It must not know any kind of model.
//!
//! Model exchange, and co-simulation with event mode, early return and intermediate update, without clocks, which the
//! XML does not declare. Functions of scheduled execution, of clocks and of types that no variable has are exported
//! because hosts look them up; they log why they cannot serve, and return `fmi3Error`.
//!
//! # Safety
//! All functions share one contract, the standard's own. An instance is NULL or comes from
//! [`fmi3InstantiateCoSimulation`] or [`fmi3InstantiateModelExchange`], has not been freed, and is used by one thread
//! at a time (2.2.1); so is a state while it is written or freed (2.2.10). An array argument has as many elements as
//! its count says, and a string ends with a zero byte (2.2.4, 2.2.6). A NULL is answered with `fmi3Error`, wherever it
//! stands, except as an empty array.
#![allow(unsafe_code, non_snake_case, clippy::missing_safety_doc)]

mod absent;
mod exchange;
mod functions;
pub mod host;
mod instantiation;
mod step;
pub mod types;

use crate::fmi::version::Version;
use crate::variables::Kind;
pub use absent::*;
pub use exchange::*;
pub use functions::*;
pub use instantiation::*;
pub use step::fmi3DoStep;

/// What an instance must know of FMI 3.0.
pub(crate) const VERSION: Version = Version::with_vectors(Kind::word_of_fmi_3);

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// `fmi3FunctionTypes.h`, 3.0.2, has 75 functions; hosts look all of them up.
    #[test]
    fn all_functions_of_the_standard_are_exported() {
        let tables =
            [functions::FUNCTIONS, exchange::FUNCTIONS, absent::FUNCTIONS, absent::types_of_no_variable::FUNCTIONS];
        let names: BTreeSet<_> = tables.into_iter().flatten().map(|function| function.name).collect();
        // Besides: the version, three ways to instantiate, the end of an instance, the step.
        assert_eq!(names.len() + 6, 75);
        assert!(names.iter().all(|name| name.starts_with("fmi3")));
    }
}
