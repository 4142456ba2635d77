//! The laws of outputs, each written once: for values and exact derivatives, for the reduced model and the rigid finite
//! elements.
//!
//! In: an output, and a formulation of the motion as [`Kinematics`]. Out: the output in numbers N. It must not know how
//! a formulation finds what it gives.
use crate::hydraulics::network::outputs as network;
use crate::mechanism::definition::ControlState;
use crate::mechanism::loads::friction_loop::Locked;
use crate::mechanism::loads::resolved::{FrictionJoint, Loading};
use crate::mechanism::motion::impacts::Impacts;
use crate::mechanism::quantity::{FramePart, Hydraulic, ImpactPart, OneElement, Output, ReactionPart, SmallMotion};
use crate::mechanism::rigid_fem::RigidFemError;
use crate::numerics::dual::Number;
use crate::numerics::table::Unresolved;
use std::f64::consts::TAU;

/// Why an output has no value.
#[derive(Clone, Debug, PartialEq)]
pub enum OutputError {
    /// The table of a function along the curve cannot be built.
    Table(Unresolved),
    /// Friction and reactions have no common solution.
    Locked,
    /// Friction and reactions have no common solution, whatever the force of this drive, which has the index of its
    /// load.
    SelfLocking(usize),
    /// The loads do not drive the mechanism back to the present position, so that it does not swing about it.
    Unstable,
    /// This drive, whose motion is prescribed, is at a dead point.
    Dead(usize),
    /// The mechanism cannot make the motion that is prescribed, as the words tell.
    Motion(String),
    /// The finite elements' forces are not finite.
    RigidFem(RigidFemError),
}

impl From<RigidFemError> for OutputError {
    fn from(error: RigidFemError) -> Self {
        Self::RigidFem(error)
    }
}

impl From<Unresolved> for OutputError {
    fn from(at: Unresolved) -> Self {
        Self::Table(at)
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

/// What a formulation of the motion gives to the laws, in one state under the present inputs. `order` 0, 1 or 2 is that
/// of the time derivative. What a formulation does not have is 0.
///
/// # Errors
/// [`OutputError`], of all methods with a Result.
pub trait Kinematics<N: Number> {
    /// Angle of a body [rad]; of one that does not turn the constant angle.
    fn angle(&mut self, body: usize, order: usize) -> Result<N, OutputError>;

    /// Position of a prismatic joint [m].
    fn joint_position(&mut self, _coordinate: usize, _order: usize) -> Result<N, OutputError> {
        Ok(N::constant(0.0))
    }

    /// Displacement S of a load [m, rad, or J for gravity].
    fn displacement(&mut self, load: usize, order: usize) -> Result<N, OutputError>;

    /// Position of a marker along an axis [m].
    fn marker(&mut self, marker: usize, axis: usize, order: usize) -> Result<N, OutputError>;

    /// Position of a body's origin along an axis [m].
    fn origin(&mut self, body: usize, axis: usize) -> Result<N, OutputError>;

    /// Pressure angle of a cam [rad].
    fn pressure_angle(&mut self, _coupling: usize) -> Result<N, OutputError> {
        Ok(N::constant(0.0))
    }

    /// Force x, force y [N] and moment [N.m] that a joint transmits.
    fn reaction(&mut self, joint: usize) -> Result<[N; 3], OutputError>;

    /// Size of a load that an input or a constant sizes.
    fn size(&self, load: usize) -> N;

    /// Force with which a drive acts, before the loss of the drive.
    fn acting_force(&mut self, drive: usize) -> Result<N, OutputError> {
        Ok(self.size(drive))
    }

    /// A state of the controller of a drive, or its rate (order 1).
    fn controller(&mut self, _drive: usize, _state: ControlState, _order: usize) -> Result<N, OutputError> {
        Ok(N::constant(0.0))
    }

    /// Whether the state may decide the size of a load. If not, each [`Self::state_load`] is 0.
    fn has_state_loads(&self) -> bool {
        true
    }

    /// Size of a load that the state decides: friction, drag, bumpers, losses of drives.
    fn state_load(&mut self, _load: usize) -> Result<N, OutputError> {
        Ok(N::constant(0.0))
    }

    /// Force or torque with which a rigid stop holds the mechanism at rest.
    fn stop_force(&mut self, _stop: usize) -> Result<N, OutputError> {
        Ok(N::constant(0.0))
    }

    /// Impacts on a stop since the start.
    fn impacts(&self, _stop: usize) -> Impacts {
        Impacts::default()
    }

    /// Force with which a lock holds the mechanism [N], along the path of its point; positive towards the stop.
    fn lock_force(&mut self, _lock: usize) -> Result<N, OutputError> {
        Ok(N::constant(0.0))
    }

    /// -d sigma_ddot / d sigma [1/s^2] and -d sigma_ddot / d sigma_dot [1/s], as if nothing held the mechanism.
    fn small_motion(&mut self) -> Result<[N; 2], OutputError>;

    /// A term of the mechanism reduced to a drive.
    fn one_element(&mut self, drive: usize, term: OneElement) -> Result<N, OutputError>;

    /// A quantity of the hydraulic circuit of a drive.
    fn hydraulic(&mut self, _output: Hydraulic) -> Result<N, OutputError> {
        Ok(N::constant(0.0))
    }

    /// A quantity of the hydraulic network.
    fn network(&mut self, _output: network::Output) -> Result<N, OutputError> {
        Ok(N::constant(0.0))
    }

    /// Kinetic energy [J].
    fn kinetic(&self) -> N;

    /// Energy less that at the start and the work done since [J]; the exact motion has none.
    fn drift(&mut self) -> N;
}

/// An output of a formulation. It is inlined, so that a call that reads many outputs enters no function for each.
///
/// # Errors
/// [`OutputError`].
#[inline(always)]
pub fn evaluate<N: Number, K: Kinematics<N>>(
    motion: &mut K,
    loading: &Loading,
    output: &Output,
) -> Result<N, OutputError> {
    Ok(match *output {
        Output::Angle { body, order } => motion.angle(body, order)?,
        Output::JointPosition { coordinate, order } => motion.joint_position(coordinate, order)?,
        Output::Displacement { load, order } => motion.displacement(load, order)?,
        Output::Marker { marker, axis, order } => motion.marker(marker, axis, order)?,
        Output::Frame { body, part } => frame(motion, body, part)?,
        Output::Reaction { joint, part } => part_of(motion.reaction(joint)?, part),
        Output::PressureAngle { coupling } => motion.pressure_angle(coupling)?,
        Output::ActingForce { drive } => motion.acting_force(drive)?,
        Output::Controller { drive, state, order } => motion.controller(drive, state, order)?,
        Output::SpringForce { spring } => spring_force(motion, loading, spring)?,
        Output::Friction { friction_joint } => match &loading.friction {
            Some(friction) if motion.has_state_loads() => {
                let (first, later) = friction.of_joint(friction_joint);
                let further = later.map_or(Ok(N::constant(0.0)), |own| motion.state_load(own.load))?;
                motion.state_load(first.load)? + further
            }
            _ => N::constant(0.0),
        },
        Output::SlipSpeed { friction_joint } => match &loading.friction {
            Some(friction) => {
                let joint = &friction.friction_joints[friction_joint];
                let slip = motion.displacement(joint.load, 1)? * joint.radius;
                joint.surface.map_or(slip, |surface| slip - motion.size(surface))
            }
            None => N::constant(0.0),
        },
        Output::SurfacePower { friction_joint } => match &loading.friction {
            Some(friction) => surface_power(motion, &friction.friction_joints[friction_joint])?,
            None => N::constant(0.0),
        },
        Output::Drag { surface } => match &loading.air {
            Some(air) if motion.has_state_loads() => {
                let load = air.surfaces[surface].load;
                motion.state_load(load)? * air.flow.x + motion.state_load(load + 1)? * air.flow.y
            }
            _ => N::constant(0.0),
        },
        Output::Stop { stop } => motion.state_load(loading.stops[stop].load)? + motion.stop_force(stop)?,
        Output::Impact { stop, part } => {
            let impacts = motion.impacts(stop);
            N::constant(match part {
                ImpactPart::Count => impacts.count,
                ImpactPart::Time => impacts.time,
                ImpactPart::Impulse => impacts.impulse,
            })
        }
        Output::Lock { lock } => motion.lock_force(lock)?,
        Output::OneElement { drive, term } => motion.one_element(drive, term)?,
        Output::Kinetic => motion.kinetic(),
        Output::Potential => potential(motion, loading)?,
        Output::Drift => motion.drift(),
        Output::Hydraulic(output) => motion.hydraulic(output)?,
        Output::Network(output) => motion.network(output)?,
        Output::SmallMotion(output) => small_motion(motion, output)?,
    })
}

/// A part of the reaction of a joint: force x, force y, moment.
#[inline(always)]
pub fn part_of<N: Number>([x, y, moment]: [N; 3], part: ReactionPart) -> N {
    match part {
        ReactionPart::X => x,
        ReactionPart::Y => y,
        ReactionPart::Magnitude => x.hypot(y),
        ReactionPart::Moment => moment,
    }
}

/// Power that moves the surface of the first body of a joint against its friction: 0 without a pin radius.
#[inline(never)]
fn surface_power<N: Number, K: Kinematics<N>>(motion: &mut K, joint: &FrictionJoint) -> Result<N, OutputError> {
    let Some(surface) = joint.surface.filter(|_| joint.radius != 0.0) else { return Ok(N::constant(0.0)) };
    Ok(motion.state_load(joint.load)? * motion.size(surface) * (1.0 / joint.radius))
}

/// Eigenfrequency or damping ratio of small motions about the present state.
#[inline(never)]
fn small_motion<N: Number, K: Kinematics<N>>(motion: &mut K, output: SmallMotion) -> Result<N, OutputError> {
    let [stiffness, damping] = motion.small_motion()?;
    if stiffness.value() <= 0.0 {
        return Err(OutputError::Unstable);
    }
    let omega = stiffness.sqrt();
    Ok(match output {
        SmallMotion::Eigenfrequency => omega * (1.0 / TAU),
        SmallMotion::DampingRatio => damping / (omega * 2.0),
    })
}

/// Part of a body's frame: the origin, or an entry of the matrix of rotation by the angle theta.
#[inline(never)]
fn frame<N: Number, K: Kinematics<N>>(motion: &mut K, body: usize, part: FramePart) -> Result<N, OutputError> {
    if let FramePart::Origin(axis) = part {
        return motion.origin(body, axis);
    }
    let theta = motion.angle(body, 0)?;
    let (sin, cos) = theta.value().sin_cos();
    Ok(match part {
        FramePart::Cos => theta.compose([cos, -sin, -cos]),
        FramePart::Sin => theta.compose([sin, cos, -sin]),
        _ => theta.compose([-sin, -cos, sin]),
    })
}

/// Force or torque of a spring and damper.
#[inline(never)]
pub fn spring_force<N: Number, K: Kinematics<N>>(
    motion: &mut K,
    loading: &Loading,
    spring: usize,
) -> Result<N, OutputError> {
    let spring = &loading.springs[spring];
    let s = motion.displacement(spring.load, 0)?;
    if !spring.is_damped() {
        return Ok(spring.force(s));
    }
    Ok(spring.force(s) + spring.damping_force(motion.displacement(spring.load, 1)?))
}

/// Potential of gravity under the present load factor, and of the springs [J].
#[inline(never)]
fn potential<N: Number, K: Kinematics<N>>(motion: &mut K, loading: &Loading) -> Result<N, OutputError> {
    let mut springs = N::constant(0.0);
    for spring in &loading.springs {
        springs = springs + spring.energy(motion.displacement(spring.load, 0)?);
    }
    Ok(match loading.gravity {
        Some(load) => springs - motion.size(load) * motion.displacement(load, 0)?,
        None => springs,
    })
}

/// At a dead centre of a drive no finite force or mass has the effect, and at some flat positions no finite reaction:
/// the largest finite number stands for it, without derivatives. What is indeterminate there, as 0 / 0, stays NaN.
#[inline]
pub fn finite<N: Number>(value: N) -> N {
    match value.value() {
        v if v.is_infinite() => N::constant(f64::MAX.copysign(v)),
        _ => value,
    }
}
