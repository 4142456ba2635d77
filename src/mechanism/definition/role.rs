//! What a parameter changes in a mechanism.
use crate::format::Parameter;

/// What a parameter changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The shape of the linkage.
    Geometry,
    /// Masses and moments of inertia.
    Inertia,
    /// The potential or the law of a load.
    Load,
    /// The position at the start.
    StartPosition,
    /// The speed at the start.
    StartSpeed,
    /// The stretch of bodies as rods.
    Elasticity,
    /// The tolerance or the step of the integration.
    Tolerance,
}

/// Function that is called with each parameter and its value.
pub type Visit<'v> = dyn FnMut(Parameter<'_, Role>, &mut f64) + 'v;
