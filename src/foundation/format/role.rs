//! The part of a model that a parameter changes.

/// The part of a model that a parameter changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The shape of the linkage.
    Geometry,
    /// Masses and moments of inertia.
    Inertia,
    /// The potential or the law of a load.
    Load,
    /// A number in the law of a load, such as friction, air, drag or the restitution of a stop. Tunable between steps.
    Law,
    /// The position at the start.
    StartPosition,
    /// The speed at the start.
    StartSpeed,
    /// Elastic lengthening of bodies as rods.
    Elasticity,
    /// The tolerance or the largest number of steps of the integration. Tunable between steps.
    Tolerance,
    /// The step of the finite elements.
    Step,
    /// The reference of the relative errors of the integration.
    Scale,
    /// The laws of a hydraulic circuit.
    Circuit,
    /// The pressures or the states of controllers at the start.
    CircuitStart,
    /// Only the numbers whose expressions contain the parameter.
    Named,
}

impl Role {
    /// Whether a host may change a parameter with this role between two steps.
    pub fn is_tunable(self) -> bool {
        matches!(self, Self::Law | Self::Tolerance)
    }
}
