//! The quantity of each variable of a mechanism.

/// Quantity of a variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Quantity {
    /// A number of the definition, by its index among the parameters.
    Parameter(usize),
    /// A Real that the host sets between steps, by its index.
    Input(usize),
    /// A Boolean of the definition, by its index among the Boolean parameters.
    Flag(usize),
    /// The formulation of the motion: `solver.method`.
    Method,
    /// Whether a lock is engaged.
    Lock(usize),
    /// Whether the mechanism is at a stop.
    AtStop(usize),
    /// Computed from the state.
    Output(Output),
}

/// A computed quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Output {
    /// Angle of a body, or its first or second time derivative.
    Angle {
        /// Index of the body in the linkage.
        body: usize,
        /// 0, 1 or 2.
        order: usize,
    },
    /// Position of a prismatic joint, or its first or second time derivative.
    JointPosition {
        /// Coordinate of the linkage.
        coordinate: usize,
        /// 0, 1 or 2.
        order: usize,
    },
    /// Reaction in a joint.
    Reaction {
        /// Index of the joint.
        joint: usize,
        /// Part of the reaction.
        part: ReactionPart,
    },
    /// Displacement of a drive's or a spring's load - length, angle or position - or its first or second time
    /// derivative.
    Displacement {
        /// Index of the load.
        load: usize,
        /// 0, 1 or 2.
        order: usize,
    },
    /// A term of the mechanism reduced to a drive.
    OneElement {
        /// Index of the drive, and of its load.
        drive: usize,
        /// Term of the one-element model.
        term: OneElement,
    },
    /// Force or torque of a spring and damper.
    SpringForce {
        /// Index of the spring.
        spring: usize,
    },
    /// Position of a marker, or its first or second time derivative.
    Marker {
        /// Index of the marker.
        marker: usize,
        /// 0 for x, 1 for y.
        axis: usize,
        /// 0, 1 or 2.
        order: usize,
    },
    /// Friction force or torque of a joint on the second-named body.
    Friction {
        /// Index among the joints with friction.
        friction_joint: usize,
    },
    /// Slip speed in a joint with friction.
    SlipSpeed {
        /// Index among the joints with friction.
        friction_joint: usize,
    },
    /// Drag on a surface, along the flow.
    Drag {
        /// Index of the surface.
        surface: usize,
    },
    /// Force or torque of a stop.
    Stop {
        /// Index of the stop.
        stop: usize,
    },
    /// Force of a lock.
    Lock {
        /// Index of the lock.
        lock: usize,
    },
    /// Kinetic energy.
    Kinetic,
    /// Potential energy under the present load factor.
    Potential,
    /// Energy now less energy at the start less work done.
    Drift,
}

/// A term of the one-element model of [CK16]: F_S = F_Su + m_zS a_S - Delta F_S, eqs. (16), (37).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OneElement {
    /// m_zS or I_zS, eqs. (12), (33).
    ReducedMass,
    /// Derivative of the reduced mass or inertia along the drive.
    ReducedMassDerivative,
    /// F_Su or T_Su, eqs. (11), (32): all present loads but the drive's own.
    StaticLoad,
    /// Delta F_S or Delta T_S, eqs. (15), (36).
    AdditionalForce,
    /// F_S or T_S for the demanded acceleration, eqs. (16), (37): inverse dynamics. The other drives lose as in the
    /// direction of motion, at rest as in the direction of setting off; they lose nothing at rest without a demand.
    RequiredForce,
    /// Force that holds the mechanism at rest under the present loads, without friction and losses of drives; it lies
    /// between the two breakaway forces.
    HoldingForce,
    /// Force that begins to move the mechanism from rest forward along the drive, against static friction and the
    /// losses of all drives in this direction.
    BreakawayForward,
    /// Force that begins to move the mechanism from rest backward along the drive.
    BreakawayBackward,
}

/// Part of a joint's reaction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReactionPart {
    /// x component of the force.
    X,
    /// y component of the force.
    Y,
    /// Magnitude of the force.
    Magnitude,
    /// Moment about the second body's point.
    Moment,
}
