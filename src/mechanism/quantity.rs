//! The quantity of each variable of a mechanism.
use crate::hydraulics::network::outputs as network;
use crate::mechanism::definition::ControlState;

/// What stops do to a mechanism: nothing; a bumper pushes; it rests on a rigid stop or a lock holds it there; it has
/// come to a stop, whose impact is still to follow.
pub const CONTACT_MODES: [&str; 5] = ["free", "pushed", "resting", "locked", "arrived"];

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
    /// Whether a lock has engaged by the force of its stop.
    Engaged(usize),
    /// Whether a pressure lock of the network is engaged.
    PressureLock(usize),
    /// Whether the motion of a drive is prescribed.
    Prescribed,
    /// Whether the mechanism is at a stop.
    AtStop(usize),
    /// Whether friction locks the mechanism against a drive, which has the index of its load.
    SelfLocking(usize),
    /// Whether friction holds the mechanism at rest.
    Sticking,
    /// What the stops do to the mechanism, one of [`CONTACT_MODES`].
    Contact,
    /// Computed from the state.
    Output(Output),
    /// sigma, counted on over whole revolutions, or its time derivative of this order: 0 and 1 are the continuous
    /// states of model exchange.
    State(usize),
    /// Event indicator of model exchange.
    Indicator(Indicator),
}

impl Quantity {
    /// The output, if it is one.
    #[inline]
    pub fn output(&self) -> Option<Output> {
        if let Self::Output(output) = self { Some(*output) } else { None }
    }
}

/// What an event indicator of model exchange watches.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(missing_docs, reason = "the sentence of a variant names its fields")]
pub enum Indicator {
    /// The rigid stop at the low (0) or the high (1) end of the travel.
    End(usize),
    /// The push of a bumper, by the index of its stop.
    Bumper(usize),
    /// The place where a lock catches the mechanism before it is at a rigid stop.
    Lock(usize),
    /// The sign of the speed, where drives have an efficiency or joints have friction.
    Reversal,
    /// The slip in a joint with friction that sticks, or in a coupling with losses, for each unit of sigma, by its
    /// index among the joints with friction: where it changes its sign, the friction jumps while the mechanism moves.
    Turn(usize),
    /// What is missing for setting off from rest, where drives with an efficiency or friction hold the mechanism and a
    /// controller has states.
    Breakaway,
    /// The slip speed of a joint with friction against the border of the static or of the kinetic regime.
    Slip { joint: usize, kinetic: bool },
    /// The slip speed on a driven surface that can hold its body, by the index of its joint among the joints with
    /// friction; while it does, the friction that is missing up to the limit.
    Surface(usize),
    /// The force along the motion of a drive with an efficiency, by the index of its load: its sign decides on the
    /// loss.
    DriveSign(usize),
    /// The normal force of a prismatic joint with friction, by its index among the joints with friction: its magnitude
    /// decides on the friction.
    NormalForce(usize),
    /// The distance of the force of a controlled drive or of its change from a limit, by the index of the drive and
    /// that of the limit.
    Limit { drive: usize, side: usize },
    /// The points of a curve.
    Points(Curve),
}

/// A curve whose points an event indicator watches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Curve {
    /// Force of a drive over its speed, by the index of its load.
    Drive(usize),
    /// Force of a damper over its rate, by the index of its spring.
    Damper(usize),
    /// Force of a spring over its length, angle or position, by its index.
    Spring(usize),
    /// Push of a bumper over its depth, by the index of its stop.
    Bumper(usize),
    /// Lift of a cam over its angle, by the index of its coupling: borders of segments, or points.
    Cam(usize),
    /// Curve of a slot over the position along it, by its index: its points.
    Slot(usize),
}

/// A computed quantity. `order` 0, 1 or 2 is that of the time derivative; the other fields are indices.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(missing_docs, reason = "the sentence of a variant names its fields")]
pub enum Output {
    /// Angle of a body of the linkage.
    Angle { body: usize, order: usize },
    /// Position of a prismatic joint, by its coordinate.
    JointPosition { coordinate: usize, order: usize },
    /// Reaction in a joint.
    Reaction { joint: usize, part: ReactionPart },
    /// Displacement of a drive's or a spring's load: length, angle or position.
    Displacement { load: usize, order: usize },
    /// Pressure angle of a cam, by the index of its coupling.
    PressureAngle { coupling: usize },
    /// A term of the mechanism reduced to a drive, which has the index of its load.
    OneElement { drive: usize, term: OneElement },
    /// Force or torque with which a drive acts, by the index of its load: that of the input, or that which its
    /// prescribed motion takes.
    ActingForce { drive: usize },
    /// A state of the controller of a drive, or its rate. In model exchange the former is a continuous state.
    Controller { drive: usize, state: ControlState, order: usize },
    /// Force or torque of a spring and damper.
    SpringForce { spring: usize },
    /// Position of a marker along the axis 0 for x or 1 for y.
    Marker { marker: usize, axis: usize, order: usize },
    /// Part of the position and direction of the frame of a body of the linkage.
    Frame { body: usize, part: FramePart },
    /// Friction force or torque of a joint on the second-named body, by its index among the joints with friction.
    Friction { friction_joint: usize },
    /// Slip speed in a joint, by its index among the joints with friction.
    SlipSpeed { friction_joint: usize },
    /// Power that moves the surface of a joint's first body against friction, by the index of the joint among those
    /// with friction: friction force times surface speed.
    SurfacePower { friction_joint: usize },
    /// Drag on a surface, along the flow.
    Drag { surface: usize },
    /// Force or torque of a stop.
    Stop { stop: usize },
    /// What a stop has met: number of impacts, time or impulse of the last one.
    Impact { stop: usize, part: ImpactPart },
    /// Force of a lock.
    Lock { lock: usize },
    /// Kinetic energy.
    Kinetic,
    /// Potential energy under the present load factor.
    Potential,
    /// Energy now less energy at the start less work done.
    Drift,
    /// A quantity of the hydraulic circuit of a drive.
    Hydraulic(Hydraulic),
    /// A quantity of the hydraulic network of the mechanism.
    Network(network::Output),
    /// A quantity of small motions about the present state.
    SmallMotion(SmallMotion),
}

/// A quantity of small motions about a state: sigma_ddot = -omega^2 sigma - 2 zeta omega sigma_dot for deviations from
/// it, in which the reduced inertia is 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SmallMotion {
    /// Eigenfrequency omega / (2 pi) of the undamped motion [Hz].
    Eigenfrequency,
    /// Damping ratio zeta, 1 where the motion is just aperiodic [1].
    DampingRatio,
}

/// A quantity of a hydraulic circuit. Chamber A has the index 0, B the index 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hydraulic {
    /// Force of the actuator.
    Force,
    /// Stiffness of the oil along the actuator.
    Stiffness,
    /// Derivative of the friction of the seals with respect to the speed.
    Damping,
    /// Pressure of a chamber.
    Pressure(usize),
    /// Flow into a chamber.
    Flow(usize),
    /// Volume of a chamber.
    Volume(usize),
    /// Effective bulk modulus of the oil in a chamber.
    BulkModulus(usize),
    /// Position of the spool.
    SpoolPosition,
    /// Speed of the spool.
    SpoolSpeed,
    /// Pressure at the supply port of the valve: that of the accumulator, or of the input without one.
    SupplyPressure,
    /// Flow from the supply.
    SupplyFlow,
    /// Flow into the tank.
    TankFlow,
    /// Position of the piston from the closed length.
    StrokePosition,
    /// Force of the ends of the cylinder on the piston.
    EndForce,
    /// A power: from the supply, into the tank, of the piston, of the seals, of compression, of throttling.
    Power(usize),
    /// The integral of a power over time, in the same order.
    Energy(usize),
    /// Energy supplied less all other energies.
    Balance,
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
    /// Derivative of [`Self::HoldingForce`] along the drive, dW/ds.
    HoldingForceDerivative,
    /// Force that begins to move the mechanism from rest forward along the drive, against static friction and the
    /// losses of all drives in this direction.
    BreakawayForward,
    /// Force that begins to move the mechanism from rest backward along the drive.
    BreakawayBackward,
    /// Least displacement of the drive that stops and locks leave: the present one while they hold the mechanism.
    LowerLimit,
    /// Largest displacement of the drive that they leave.
    UpperLimit,
    /// A part of one body of the linkage, by its index.
    OfBody(usize, BodyPart),
}

/// Part of one body in the mechanism reduced to a drive, with S the displacement of the drive, C the centre of mass of
/// the body and theta its angle. [CK16] superposes the bodies (conclusion 3): their reduced masses and static loads add
/// up to those of the mechanism.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodyPart {
    /// m (dC/dS)^2 + I (dtheta/dS)^2, eqs. (12), (33).
    ReducedMass,
    /// Minus the work of all present loads on the body for each dS, without that of the drive, eqs. (11), (32).
    StaticLoad,
    /// |dC/dS|: the effective radius R_z of a rotary drive, eq. (1).
    CenterByDrive,
    /// 1 / |dC/dS|: the ratio i_v of a linear drive, eq. (23).
    DriveByCenter,
    /// dS/dtheta: the ratio i_m of a rotary drive, eq. (2), or the effective radius R_e of a linear one, eq. (22).
    DriveByAngle,
}

/// Part of the record of a stop's impacts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImpactPart {
    /// Number of impacts.
    Count,
    /// Time of the last one.
    Time,
    /// Impulse of the last one.
    Impulse,
}

/// Part of a body's frame in the mechanism frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FramePart {
    /// Position of the origin along the axis 0 for x or 1 for y.
    Origin(usize),
    /// x of the first axis, y of the second: cosine of the angle of the body.
    Cos,
    /// y of the first axis: sine of the angle of the body.
    Sin,
    /// x of the second axis: the sine with the other sign.
    MinusSin,
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
