//! The C interface of FMI 3.0.2. Each exported function is 1 to 4 lines that call the shared parts in `fmi`.
//!
//! In: the host's calls. Out: statuses and values. Each function states the phases in which it is legal, according to
//! the state machine of FMI 3.0.2, 4.2.1. `types` contains the C types. Must not know: any kind of model.
//!
//! Interface types: model exchange, and co-simulation with event mode, early return and intermediate update, but
//! without clocks. Functions for scheduled execution, clocks and types of no variable are exported because hosts look
//! them up. They log the reason and return `fmi3Error`.
//!
//! # Safety
//! All functions share the contract of the standard. An instance is NULL or comes from [`fmi3InstantiateCoSimulation`]
//! or [`fmi3InstantiateModelExchange`] and was not freed. One thread at a time uses an instance (2.2.1), or a state
//! that is written or freed (2.2.10). The count of an array argument is the number of its elements, and a string is
//! zero-terminated (2.2.4, 2.2.6). A NULL argument gives `fmi3Error`, except as an empty array.
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

/// The properties of FMI 3.0 that an instance needs.
pub(crate) const VERSION: Version = Version::with_vectors(Kind::word_of_fmi_3);

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// `fmi3FunctionTypes.h`, 3.0.2, has 75 functions. Hosts look up all of them.
    #[test]
    fn all_functions_of_the_standard_are_exported() {
        let tables =
            [functions::FUNCTIONS, exchange::FUNCTIONS, absent::FUNCTIONS, absent::types_of_no_variable::FUNCTIONS];
        let names: BTreeSet<_> = tables.into_iter().flatten().map(|function| function.name).collect();
        // Not in the tables: the version, three functions that instantiate, the freeing of an instance, the step.
        assert_eq!(names.len() + 6, 75);
        assert!(names.iter().all(|name| name.starts_with("fmi3")));
    }
}
