//! The XML files of an FMU and of a system: their writers, and the readers of descriptions and of parameter sets.
//!
//! In: the model. Out: the text of each file. It depends only on the interface, because no file contains a time stamp.

pub(crate) mod common;
pub mod description;
pub mod fmi2;
pub mod fmi3;
mod interface;
mod sizes;
pub mod ssd;
pub mod ssv;
pub mod terminals;

pub use sizes::quantity;
