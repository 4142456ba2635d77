//! The definition of a mechanism: the content of `mechanism.json`, with all checks that need no geometry.
//!
//! In: the text of the file. Out: a [`Mechanism`] whose names resolve and whose numbers are finite and in range; the
//! list of its parameters. It must not know how loops are closed, nor FMI. SI units throughout, angles in rad,
//! anticlockwise positive.
mod bodies;
mod contact;
mod joints;
mod loads;
mod mechanism;
mod role;
mod solver;
mod start;
mod validate;

pub use crate::format::{DefinitionError, Named, Range};
pub use bodies::{Body, Marker, Shape};
pub use contact::{Limit, Lock, Stop};
pub use joints::{Friction, Joint, JointKind};
pub use loads::{Actuator, Air, Force, Gravity, Spring, Surface, Torque};
pub use mechanism::{GROUND, Mechanism};
pub use role::{Role, Visit};
pub use solver::{Method, Solver};
pub use start::{Experiment, Start};

use crate::format::read;

impl Mechanism {
    /// Read and check a definition.
    ///
    /// # Errors
    /// A message with the key, its value and what is allowed.
    pub fn from_json(text: &str) -> Result<Self, DefinitionError> {
        let mut mechanism: Self = read("mechanism", text)?;
        mechanism.check()?;
        Ok(mechanism)
    }
}

#[cfg(test)]
mod tests;
