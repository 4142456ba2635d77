//! The parts that all versions of FMI share: handles, arrays, times, values and states.
//!
//! In: arguments of an exported function as plain numbers, slices and checked pointers. Out: values and verdicts. Must
//! not know: names, C types or status numbers of any version, kinds of model.
//!
//! A version adds the exported functions and the table of their legal phases ([`phase::Function`]). It also adds the C
//! types, the status number of each [`refusal::Verdict`], and a closure that calls the host's logger. Calls pass
//! through [`handle::call`] to an [`instance::Instance`].

pub(crate) mod access;
pub(crate) mod array;
pub(crate) mod clock;
mod derivatives;
pub(crate) mod event_mode;
pub(crate) mod exchange;
mod exported;
pub(crate) mod handle;
pub(crate) mod instance;
pub mod logger;
pub(crate) mod phase;
pub(crate) mod refusal;
pub(crate) mod resources;
pub(crate) mod saved;
pub(crate) mod state_handle;
pub(crate) mod undefined;
pub(crate) mod usage;
mod values;
pub(crate) mod vectors;
pub(crate) mod version;

pub(crate) use exported::{exchange_calls, exported, exported_exchange};
pub use resources::LARGEST_DEFINITION;
