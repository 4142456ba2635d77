//! The definition of a mechanism: the content of `mechanism.json`, with all checks that need no geometry.
//!
//! In: the text of the file. Out: a [`Mechanism`] whose names resolve and whose numbers are finite and in range; the
//! list of its parameters. It must not know how loops are closed, nor FMI. SI units throughout, angles in rad,
//! anticlockwise positive.
mod bodies;
mod cams;
mod characteristics;
mod contact;
mod couplings;
mod drawing;
mod experiment;
mod expressions;
mod interpolation;
mod loads;
mod mechanism;
mod motion;
mod named_parameter;
mod validate;
mod warnings;

pub use crate::format::{DefinitionError, Experiment, Named, Range};
pub use bodies::{Body, Friction, FrictionLaw, Joint, JointKind, Marker, Shape};
pub use cams::{CamLaw, CamSegment, Follower};
pub use contact::{Limit, Lock, Stop};
pub use couplings::{Coupling, CouplingKind, Side};
pub use drawing::{AngleUnit, Drawn, LengthUnit, Units};
pub use experiment::{Method, Solver, Start};
pub use expressions::{Calculated, Expressions, Fault, Unclear};
pub use interpolation::Interpolation;
pub use loads::{Actuator, Air, Force, Gas, Gravity, Screw, Spring, Surface, Torque};
pub use mechanism::{GROUND, Mechanism};
pub use motion::{PrescribedMotion, ProfileKind};
pub use named_parameter::{NamedParameter, Shared, SharedContents};

use crate::format::{Faults, Parameter};

/// What a parameter changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The shape of the linkage.
    Geometry,
    /// Masses and moments of inertia.
    Inertia,
    /// The potential or the law of a load.
    Load,
    /// A number in the law of a load, which may change between two steps: of friction, air, drag, what a stop does.
    Law,
    /// The position at the start.
    StartPosition,
    /// The speed at the start.
    StartSpeed,
    /// The stretch of bodies as rods.
    Elasticity,
    /// The tolerance of the integration or the bound on its work, which may change between two steps.
    Tolerance,
    /// The step of the finite elements.
    Step,
    /// What the errors of the integration are relative to.
    Scale,
    /// The laws of a hydraulic circuit.
    Circuit,
    /// The pressures at the start.
    CircuitStart,
    /// Nothing by itself: the numbers whose expressions read it.
    Named,
}

impl Role {
    /// Whether a host may change such a parameter between two steps.
    pub fn is_tunable(self) -> bool {
        matches!(self, Self::Law | Self::Tolerance)
    }
}

/// Function that is called with each parameter and its value.
pub type Visit<'v> = dyn FnMut(Parameter<'_, Role>, &mut f64) + 'v;

/// Name of a coordinate in variables, and its index in the file.
const AXES: [(&str, &str); 2] = [("x", "[0]"), ("y", "[1]")];

impl Mechanism {
    /// Read and check a definition.
    ///
    /// # Errors
    /// A message with the key, its value and what is allowed.
    pub fn from_json(text: &str) -> Result<Self, DefinitionError> {
        let mut mechanism = Self::read(text)?;
        mechanism.faults().first()?;
        mechanism.index_expressions();
        Ok(mechanism)
    }

    /// Read a definition, with all faults that show without geometry.
    ///
    /// # Errors
    /// The text cannot be read as a mechanism at all.
    pub fn with_faults(text: &str) -> Result<(Self, Faults), DefinitionError> {
        let mut mechanism = Self::read(text)?;
        let faults = mechanism.faults();
        mechanism.index_expressions();
        Ok((mechanism, faults))
    }
}

#[cfg(test)]
mod tests;
