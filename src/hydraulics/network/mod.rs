//! Hydraulic systems: a supply network with up to 12 cylinders.
//!
//! In: the definition of a network, the motions of the cylinders, commands. Out: pressures, flows, forces, volumes,
//! energies, and the motions with what the cylinders move, foreseen over the next step. It must not know mechanisms,
//! nor FMI.
//!
//! ```text
//! definition -> layout, laws -> system -> state -> outputs, model
//! ```
pub mod definition;
pub mod facts;
pub mod inputs;
pub mod inspection;
pub mod interface;
pub mod laws;
pub mod layout;
mod model;
pub mod outputs;
mod state;
mod system;

/// Name of the definition file of a hydraulic system.
pub const FILE: &str = "network.json";

pub use model::Model;
/// All values that decide how a hydraulic system continues.
pub type Snapshot = super::common::Snapshot<model::Network>;

#[cfg(test)]
mod tests;
