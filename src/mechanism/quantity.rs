//! What a variable of a mechanism stands for.

/// What the model looks up or computes for a variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Quantity {
    /// A number of the definition, by its place among the parameters.
    Parameter(usize),
    /// A Real that the host sets between steps, by its place.
    Input(usize),
    /// A Boolean of the definition, by its place among those.
    Flag(usize),
    /// The formulation of the motion, by its word.
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
        /// Place of the body in the linkage.
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
        /// Place of the joint.
        joint: usize,
        /// Which part of it.
        part: ReactionPart,
    },
    /// Displacement of a drive's or a spring's load - length, angle or position - or its first or second time derivative.
    Displacement {
        /// Place of the load.
        load: usize,
        /// 0, 1 or 2.
        order: usize,
    },
    /// A term of the mechanism reduced to a drive.
    OneElement {
        /// Place of the drive, and of its load.
        drive: usize,
        /// Which term.
        term: OneElement,
    },
    /// Pull of a spring and damper.
    SpringForce {
        /// Place of the spring.
        spring: usize,
    },
    /// Position of a marker, or its first or second time derivative.
    Marker {
        /// Its place.
        marker: usize,
        /// 0 for x, 1 for y.
        axis: usize,
        /// 0, 1 or 2.
        order: usize,
    },
    /// Friction in a joint: on the second-named body.
    Friction {
        /// Place among the joints with friction.
        friction_joint: usize,
    },
    /// Drag on a surface, along the flow.
    Drag {
        /// Place of the surface.
        surface: usize,
    },
    /// Force or torque of a stop.
    Stop {
        /// Place of the stop.
        stop: usize,
    },
    /// Force of a lock.
    Lock {
        /// Place of the lock.
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
    /// Its derivative along the drive.
    ReducedMassDerivative,
    /// F_Su or T_Su, eqs. (11), (32), under all present loads but the drive's own.
    StaticLoad,
    /// Delta F_S or Delta T_S, eqs. (15), (36).
    AdditionalForce,
    /// F_S or T_S for the demanded acceleration, eqs. (16), (37): inverse dynamics. The other drives lose what the direction
    /// of the motion says, at rest that in which it sets off; without a demand at rest they lose nothing.
    RequiredForce,
    /// What holds the mechanism still here under the present loads, without friction and without the losses of any drive: it
    /// lies between what sets off backward and forward.
    HoldingForce,
    /// What begins to move the mechanism here from rest, forward along the drive, against static friction and against the
    /// losses of all drives in a motion that way.
    BreakawayForward,
    /// The same backward.
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
