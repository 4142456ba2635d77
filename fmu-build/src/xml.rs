//! The XML files of an FMU: their writers, and the reader of the description.
//!
//! In: the model. Out: the text of each file, the same for the same interface, as none holds a time stamp.

pub(crate) mod common;
pub mod description;
pub mod fmi2;
pub mod fmi3;
mod interface;
mod sizes;
pub mod ssd;
pub mod terminals;

pub use sizes::quantity;
