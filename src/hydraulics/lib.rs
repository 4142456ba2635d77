//! Hydraulic actuators: a servo valve, a differential cylinder and the oil between them.
//!
//! In: the definition of a circuit, the motion of the cylinder, valve commands. Out: pressures, flows, the force,
//! energies, and the predicted motion of actuator and load over the next step. It must not know mechanisms, nor
//! FMI.
//!
//! ```text
//! definition -> circuit -> systems -> state -> outputs, common -> model
//! ```
pub mod any;
pub mod circuit;
mod common;
pub mod definition;
mod error;
mod events;
pub mod inputs;
pub mod inspection;
mod interface;
mod model;
pub mod network;
mod outputs;
pub mod plausibility;
mod state;
mod systems;

pub use common::{INPUT_ORDER, OUTPUT_ORDER};
pub use definition::FILE;
pub use error::HydraulicsError;
pub use interface::ACTUATOR;
pub use model::{Model, Snapshot};

#[cfg(test)]
mod tests;
