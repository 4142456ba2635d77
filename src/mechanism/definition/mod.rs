//! The definition of a mechanism: the content of `mechanism.json`, with all checks that need no geometry.
//!
//! In: the text of the file. Out: a [`Mechanism`] whose names resolve and whose numbers are finite and in range; the
//! list of its parameters. It must not know how loops are closed, nor FMI. SI units throughout, angles in rad,
//! anticlockwise positive.
mod between;
mod bodies;
mod cams;
mod characteristics;
mod contact;
mod control;
mod couplings;
mod drawing;
mod experiment;
mod expressions;
mod interpolation;
mod loads;
mod masses;
mod mechanism;
mod motion;
mod named_parameter;
mod refusal;
mod slots;
mod validate;
mod warnings;

use crate::format;
pub use crate::format::{DefinitionError, Experiment, Named, Range, Role, Visit};
pub use between::{Between, PLACES};
pub use bodies::{Body, Friction, FrictionLaw, Joint, JointKind, Marker, Shape};
pub use cams::{CamLaw, CamSegment, Follower};
pub use contact::{Limit, Lock, Stop};
pub use control::{Control, MOST_INTEGRALS, MOST_STATES};
pub use couplings::{Coupling, CouplingKind, Side};
pub use drawing::{AngleUnit, Drawn, LengthUnit, Units};
pub use experiment::{Method, Solver, Start};
pub use expressions::{Calculated, Expressions, Fault, Unclear};
pub use interpolation::Interpolation;
pub use loads::{Actuator, Air, Force, Gas, Gravity, Screw, Spring, Surface, Torque};
pub use masses::{Massless, listed};
pub use mechanism::{GROUND, Mechanism};
pub use motion::{PrescribedMotion, ProfileKind};
pub use named_parameter::{NamedParameter, Shared, SharedContents};
pub use validate::allow_hydraulics;

use crate::format::{About, Element, Faults};

/// The elements of a definition for its schema and reference: the whole first, those of a circuit apart.
pub const ELEMENTS: [Element; 29] = [
    Element::of::<Mechanism>(""),
    Element::of::<About>("about"),
    Element::of::<Shared>("parameters_from"),
    Element::of::<SharedContents>("shared_parameters"),
    Element::of::<NamedParameter>("parameter"),
    Element::of::<Units>("units"),
    Element::of::<Gravity>("gravity"),
    Element::of::<Body>("body"),
    Element::of::<Drawn>("drawn"),
    Element::of::<Joint>("joint"),
    Element::of::<Coupling>("coupling"),
    Element::of::<CamSegment>("cam_segment"),
    Element::of::<Actuator>("actuator"),
    Element::of::<Screw>("screw"),
    Element::of::<Control>("control"),
    Element::of::<PrescribedMotion>("motion"),
    Element::of::<Force>("force"),
    Element::of::<Torque>("torque"),
    Element::of::<Spring>("spring"),
    Element::of::<Gas>("gas"),
    Element::of::<Marker>("marker"),
    Element::of::<Friction>("friction"),
    Element::of::<Air>("air"),
    Element::of::<Surface>("surface"),
    Element::of::<Stop>("stop"),
    Element::of::<Lock>("lock"),
    Element::of::<Start>("start"),
    Element::of::<Solver>("solver"),
    Element::of::<Experiment>("experiment"),
];

impl Mechanism {
    /// Read and check a definition.
    ///
    /// # Errors
    /// A message with the key, its value and what is allowed.
    pub fn from_json(text: &str) -> Result<Self, DefinitionError> {
        allow_hydraulics();
        Self::checked(text)
    }

    /// [`Self::from_json`], with hydraulics only if [`allow_hydraulics`] was called.
    ///
    /// # Errors
    /// As [`Self::from_json`].
    pub fn checked(text: &str) -> Result<Self, DefinitionError> {
        let (mechanism, faults) = Self::with_faults(text).unwrap_or_else(|faults| (Self::default(), faults));
        faults.first()?;
        Ok(mechanism)
    }

    /// Read a definition, with all faults that show without geometry, keys that nobody knows among them.
    ///
    /// # Errors
    /// All faults for which the text cannot be read as a mechanism.
    pub fn with_faults(text: &str) -> Result<(Self, Faults), Faults> {
        let (mut mechanism, mut faults) = Self::read(text);
        // The FMU has the name of the mechanism.
        faults.forgive(|fault| fault.path() == "hydraulics" && *fault.fault() == format::Fault::Missing("name"));
        if !faults.are_of_unknown_keys() {
            return Err(faults);
        }
        mechanism.find_faults(&mut faults);
        faults.rename(|path| mechanism.path_in_file(path));
        mechanism.index_expressions();
        Ok((mechanism, faults))
    }
}

#[cfg(test)]
mod tests;
