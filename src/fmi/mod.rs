//! The half of FMI that its versions share: how a host's pointers, arrays, times, values and states reach a component.
//!
//! In: what an exported function was called with, as plain numbers, slices and checked pointers. Out: values and
//! verdicts. It must not know the names, C types or status numbers of any version, nor any kind of model.
//!
//! A version has the exported functions, the table of the phases in which each is legal ([`phase::Function`]), its C
//! types, the status number of each [`refusal::Verdict`], and a closure that calls the host's logger. Calls go through
//! [`handle::call`] to an [`instance::Instance`].

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
