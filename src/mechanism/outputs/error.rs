//! Why an output has no value.
use crate::mechanism::loads::laws::friction::Locked;
use crate::mechanism::rigid_fem::RigidFemError;
use crate::numerics::table::Unresolved;

/// Why an output has no value.
#[derive(Clone, Debug, PartialEq)]
pub enum OutputError {
    /// The table of a function along the curve cannot be built.
    Table(Unresolved),
    /// Friction and reactions have no common solution.
    Locked,
    /// The finite elements' forces are not finite.
    RigidFem(RigidFemError),
}

impl From<RigidFemError> for OutputError {
    fn from(error: RigidFemError) -> Self {
        Self::RigidFem(error)
    }
}

impl From<&Unresolved> for OutputError {
    fn from(at: &Unresolved) -> Self {
        Self::Table(at.clone())
    }
}

impl From<Locked> for OutputError {
    fn from(_: Locked) -> Self {
        Self::Locked
    }
}
