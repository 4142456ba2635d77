//! The loads of a mechanism, resolved: loads of unit size, and the laws that size them.
//!
//! In: a definition and its linkage. Out: loads in a fixed order - those sized by inputs, those of constant size,
//! springs, those sized by a state: stops, springs with a part of that kind, surfaces, friction - with their laws. It
//! must not know the state.
mod air;
mod couplings;
mod drives;
mod ends;
mod friction;
mod hydraulic;

use super::laws::gas::Gas;
use super::laws::profile::{Profile, Shape};
use super::laws::spring::{Characteristic, Spring};
use super::laws::stop::Stop;
use super::unit_load::Load;
use crate::mechanism::definition::{self, ControlState, DefinitionError, Mechanism, PrescribedMotion, ProfileKind};
use crate::mechanism::linkage::{GROUND, Linkage, Point};
use crate::numerics::monotone::monotone;
use crate::numerics::plane::Vec2;
use crate::numerics::rise::Rise;
pub use air::{Air, Surface};
pub use couplings::Mesh;
pub use drives::{Drive, DriveLaw, Efficiency};
use ends::{Hinges, between, joint_load};
pub use friction::{FrictionJoint, FrictionKind, JointFriction};
pub use hydraulic::{HydraulicDrive, NO_HYDRAULICS, NetworkDrives, PORTS, allow_hydraulics};
use std::ops::Range;

/// All loads of a mechanism.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Loading {
    /// Loads of unit size: one for each input that sizes a load, one for each constant, one for each spring; then one
    /// for each stop, one for each spring that the state sizes in part, three for each surface, one for each joint with
    /// friction, one or two for each mesh of teeth.
    pub loads: Vec<Load>,
    /// Names of the inputs that size the first loads, such as `actuator.force`.
    pub inputs: Vec<String>,
    /// The inputs among them that are speeds of surfaces, which friction is relative to: the last ones.
    pub surfaces: Range<usize>,
    /// Sizes of the loads of constant size.
    pub constants: Vec<f64>,
    /// Springs.
    pub springs: Vec<Spring>,
    /// Drives; each sizes the load with the same index. The loads of their curves and controls follow.
    pub drives: Vec<Drive>,
    /// Index of the load of gravity.
    pub gravity: Option<usize>,
    /// Stops: those of the definition, then the ends of the cylinder of a hydraulic drive.
    pub stops: Vec<Stop>,
    /// Locks.
    pub locks: Vec<Lock>,
    /// Air and the surfaces in it.
    pub air: Option<Air>,
    /// Friction in the joints.
    pub friction: Option<JointFriction>,
    /// Couplings with teeth whose pressure angle is not 0.
    pub meshes: Vec<Mesh>,
    /// The hydraulic circuit that sizes the load of one drive.
    pub hydraulics: Option<HydraulicDrive>,
    /// The hydraulic network that sizes the loads of some drives.
    pub network: Option<NetworkDrives>,
    /// The drive whose motion can be prescribed.
    pub motion: Option<MotionDrive>,
}

/// A drive whose motion can be prescribed.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionDrive {
    /// Index of the drive and of its load.
    pub load: usize,
    /// Index of the input `motion.position`; speed and acceleration follow. None with a profile.
    pub first_input: Option<usize>,
    /// Motion over time; without it inputs prescribe it.
    pub profile: Option<Profile>,
}

/// Number of inputs of a motion without a profile: position, speed, acceleration.
pub const MOTION: usize = 3;

impl MotionDrive {
    /// The drive with this load and motion, whose inputs begin with this index.
    fn new(load: usize, motion: &PrescribedMotion, first_input: usize) -> Self {
        let number = |value: Option<f64>| value.unwrap_or(0.0);
        let (distance, duration) = (number(motion.distance), number(motion.duration));
        let rise = |law| Some(Shape::Rise { law, distance, duration });
        let shape = motion.profile.and_then(|kind| match kind {
            ProfileKind::Trapezoid => {
                Some(Shape::trapezoid(distance, number(motion.speed), number(motion.acceleration)))
            }
            ProfileKind::Cycloidal => rise(Rise::Cycloidal),
            ProfileKind::Polynomial345 => rise(Rise::Polynomial345),
            ProfileKind::Polynomial4567 => rise(Rise::Polynomial4567),
            ProfileKind::ConstantSpeed => Some(Shape::ConstantSpeed(number(motion.speed))),
            ProfileKind::Table => motion.curve().map(Shape::Table),
        });
        let profile = shape.map(|shape| Profile { start_time: number(motion.start_time), shape });
        let first_input = profile.is_none().then_some(first_input);
        Self { load, first_input, profile }
    }
}

/// A lock.
#[derive(Clone, Debug, PartialEq)]
pub struct Lock {
    /// Name.
    pub name: String,
    /// Index of its stop.
    pub stop: usize,
    /// Point at which the lock holds the linkage.
    pub at: Point,
    /// Force on this point at which the lock releases [N]; None for a lock that holds against any load.
    pub release: Option<f64>,
    /// Force of the stop above which the lock engages [N or N.m]; None for a lock that engages at the stop.
    pub engage: Option<f64>,
}

/// Whether the state sizes a part of a spring's force: that of a damper with a curve, or a curve of torque, if the
/// joint turns round and round.
fn is_sized_by_state(spring: &definition::Spring, load: &Load) -> bool {
    spring.damping_points.is_some() || (spring.points.is_some() && matches!(load, Load::Couple { .. }))
}

/// Nonlinear part of a spring's law, if the definition, which is checked, states one.
fn characteristic(spring: &definition::Spring) -> Option<Characteristic> {
    let gas = spring.gas.map(|definition::Gas { pressure, area, volume, exponent, ambient }| {
        Characteristic::Gas(Gas { pressure, area, volume, exponent, ambient })
    });
    gas.or_else(|| monotone(spring.points.as_ref()?).map(Characteristic::Points))
}

impl Loading {
    /// Resolve the loads of a definition.
    ///
    /// # Errors
    /// A point, body or joint does not exist; the two ends of a load are on one body or at one point.
    pub fn new(mechanism: &Mechanism, linkage: &Linkage) -> Result<Self, DefinitionError> {
        let hinges = &Hinges::new(linkage);
        let mut sized: Vec<(String, Load)> = Vec::new();
        let mut constant: Vec<(f64, Load)> = Vec::new();
        let (mut drives, mut states) = (Vec::new(), 0..);
        for (name, a) in mechanism.actuators.iter() {
            let load = between(mechanism, linkage, hinges, format_args!("actuators.{name}"), a.between())?;
            let load = match a.screw {
                Some(screw) => Load::Screw { along: Box::new(load), ratio: screw.ratio() },
                None => load,
            };
            let is_rotary = matches!(load, Load::Couple { .. } | Load::Screw { .. });
            sized.push((format!("{name}.{}", if is_rotary { "torque" } else { "force" }), load));
            drives.push(Drive { name: name.into(), is_rotary, efficiency: Efficiency::of(a), law: None });
        }
        for (drive, (name, a)) in mechanism.actuators.iter().enumerate() {
            let Some(mut law) = DriveLaw::new(name, a, sized.len())? else { continue };
            for (state, _) in a.control.iter().flat_map(definition::Control::states) {
                law.states[state as usize] = states.next();
            }
            sized.extend(law.inputs(name).map(|input| (input, sized[drive].1.clone())).collect::<Vec<_>>());
            drives[drive].law = Some(law);
        }
        let gravity = mechanism.gravity.as_ref().map(|_| sized.len());
        if let Some(g) = &mechanism.gravity {
            let acceleration = -g.acceleration * Vec2::new(g.up_angle.cos(), g.up_angle.sin());
            sized.push(("load_factor".into(), Load::Gravity(acceleration)));
        }
        for (name, force) in mechanism.forces.iter() {
            let at = linkage.locate(mechanism, format_args!("forces.{name}.at"), &force.at)?;
            for (axis, direction, size) in [("x", Vec2::x(), force.force[0]), ("y", Vec2::y(), force.force[1])] {
                let load = Load::Force { at, direction };
                if force.constant {
                    constant.push((size, load))
                } else {
                    sized.push((format!("{name}.force_{axis}"), load))
                }
            }
        }
        for (name, t) in mechanism.torques.iter() {
            let load = Load::Torque { body: linkage.carrier(mechanism, &t.on).map_or(0, |(body, _)| body), shift: 0.0 };
            if t.constant { constant.push((t.torque, load)) } else { sized.push((format!("{name}.torque"), load)) }
        }
        let first = sized.len();
        let driven = mechanism.joints.iter().enumerate().filter(|(_, (_, own))| own.surface_speed.is_some());
        sized.extend(driven.map(|(joint, (name, _))| (surface_speed(name), joint_load(linkage, joint, 0.0))));
        let surfaces = first..sized.len();
        for (coupling, (_, defined)) in mechanism.couplings.iter().enumerate() {
            if let Some(pretension) = defined.pretension {
                constant.push(couplings::pretension(linkage, coupling, pretension));
            }
        }
        let (inputs, mut loads): (Vec<String>, Vec<Load>) = sized.into_iter().unzip();
        let (constants, more): (Vec<f64>, Vec<Load>) = constant.into_iter().unzip();
        loads.extend(more);
        let mut springs = Vec::new();
        for (name, s) in mechanism.springs.iter() {
            let load = between(mechanism, linkage, hinges, format_args!("springs.{name}"), s.between())?;
            springs.push(Spring {
                name: name.into(),
                load: loads.len(),
                stiffness: s.stiffness,
                damping: s.damping.unwrap_or(0.0),
                free: s.free_length.or(s.free_angle).unwrap_or(0.0),
                preload: s.preload.unwrap_or(0.0),
                characteristic: characteristic(s),
                damper: s.damping_points.as_ref().and_then(|points| monotone(points)),
                state_load: None,
            });
            loads.push(load);
        }
        let first = inputs.len() + drives.len();
        let (hydraulics, network) = hydraulic::hydraulic_drives(mechanism, first)?;
        let motion = mechanism.motion_drive().map(|(load, _, motion)| MotionDrive::new(load, motion, first));
        let empty = Self::default();
        let mut loading =
            Self { loads, inputs, surfaces, constants, springs, drives, gravity, hydraulics, network, motion, ..empty };
        loading.add_stops(mechanism, linkage, hinges)?;
        loading.add_ends_of_cylinders();
        loading.add_springs_of_state(mechanism);
        loading.add_air(mechanism, linkage)?;
        loading.add_friction(mechanism, linkage)?;
        loading.add_meshes(mechanism, linkage)?;
        Ok(loading)
    }

    fn add_stops(&mut self, mechanism: &Mechanism, linkage: &Linkage, hinges: &Hinges) -> Result<(), DefinitionError> {
        for (name, s) in mechanism.stops.iter() {
            let value = s.angle.or(s.position).or(s.length).unwrap_or(0.0);
            let load = match &s.body {
                Some(body) => {
                    let (carrier, shift) = linkage.carrier(mechanism, body).unwrap_or((GROUND, 0.0));
                    if linkage.bodies[carrier].angle_coordinate.is_none() {
                        let message = format!(
                            "{body} does not turn, so this body has no angle: name a body that turns, a joint, two \
                             points or two bodies"
                        );
                        return Err(DefinitionError::key(format_args!("stops.{name}.body"), message));
                    }
                    Load::Torque { body: carrier, shift }
                }
                None => between(mechanism, linkage, hinges, format_args!("stops.{name}"), s.between())?,
            };
            let quantity = match load {
                Load::Torque { .. } | Load::Couple { .. } => "angle",
                Load::Slide { .. } => "position",
                _ => "length",
            };
            self.stops.push(Stop {
                name: name.into(),
                load: self.loads.len(),
                limit: s.limit,
                value,
                quantity,
                enabled: s.enabled,
                rigid: s.rigid.unwrap_or(true),
                restitution: s.restitution,
                stiffness: s.stiffness,
                damping: s.damping,
                curve: s.points.as_ref().and_then(|points| monotone(points)),
                of_cylinder: false,
            });
            self.loads.push(load);
        }
        for (name, lock) in mechanism.locks.iter() {
            let at = linkage.locate(mechanism, format_args!("locks.{name}.at"), &lock.at)?;
            if at.body == GROUND {
                let message =
                    format!("{} is on the ground, so the load has no effect: give a point that moves", lock.at);
                return Err(DefinitionError::key(format_args!("locks.{name}.at"), message));
            }
            let stop = mechanism.stops.position(&lock.stop).unwrap_or(0);
            let (release, engage) = (lock.release_force, lock.engage_force);
            self.locks.push(Lock { name: name.into(), stop, at, release, engage });
        }
        Ok(())
    }

    /// The stops of the definition, without the ends of a cylinder.
    pub fn defined_stops(&self) -> impl Iterator<Item = &Stop> {
        self.stops.iter().filter(|stop| !stop.of_cylinder)
    }

    fn add_springs_of_state(&mut self, mechanism: &Mechanism) {
        for (spring, (_, defined)) in self.springs.iter_mut().zip(mechanism.springs.iter()) {
            let load = self.loads[spring.load].clone();
            if is_sized_by_state(defined, &load) {
                spring.state_load = Some(self.loads.len());
                self.loads.push(load);
            }
        }
    }

    /// Number of inputs of the hydraulic circuit or network, or of a prescribed motion; 0 without these.
    pub fn ports(&self) -> usize {
        match (&self.hydraulics, &self.network, &self.motion) {
            (Some(_), ..) => PORTS,
            (None, Some(network), _) => network.laws.layout.flow_inputs(),
            (None, None, Some(motion)) if motion.first_input.is_some() => MOTION,
            _ => 0,
        }
    }

    /// Number of loads sized by inputs, constants and springs. The other loads are sized by a state.
    pub fn base(&self) -> usize {
        self.sized() + self.springs.len()
    }

    /// Whether an input is a command of the law of a drive, or the speed of a surface: then the load of this index has
    /// no potential.
    pub fn is_command(&self, load: usize) -> bool {
        self.drives.iter().filter_map(|drive| drive.law.as_ref()).any(|law| law.commands().contains(&load))
            || self.surfaces.contains(&load)
    }

    /// The speed of the driven surface that can hold its body, by its index among the inputs.
    pub fn surface_that_holds(&self) -> Option<usize> {
        self.friction.as_ref()?.friction_joints.iter().find(|joint| joint.clings())?.surface
    }

    /// The states of all controllers, each with the index of its drive, in the order of their indices.
    pub fn control_states(&self) -> impl Iterator<Item = (usize, ControlState)> + '_ {
        let laws = self.drives.iter().enumerate().filter_map(|(index, drive)| Some((index, drive.law.as_ref()?)));
        laws.flat_map(|(drive, law)| {
            let all = [ControlState::Integral, ControlState::Force].into_iter();
            all.filter(|state| law.states[*state as usize].is_some()).map(move |state| (drive, state))
        })
    }

    /// Number of applied loads: those sized by inputs, then those of constant size.
    pub fn sized(&self) -> usize {
        self.inputs.len() + self.constants.len()
    }

    /// Name of the joint, coupling or drive with this friction.
    pub fn friction_name<'a>(&'a self, linkage: &'a Linkage, friction: &FrictionJoint) -> &'a str {
        match friction.kind {
            FrictionKind::Screw { drive, .. } => &self.drives[drive].name,
            _ => &linkage.joints[friction.joint].name,
        }
    }

    /// Name of a load for messages.
    pub fn name(&self, load: usize) -> String {
        match load.checked_sub(self.sized()).map(|spring| self.springs.get(spring)) {
            Some(Some(spring)) => spring.name.clone(),
            Some(None) => {
                let stops = self.stops.iter().filter(|s| s.load == load).map(|s| &s.name);
                let surfaces = self.air.iter().flat_map(|air| &air.surfaces);
                let springs = self.springs.iter().filter(|s| s.state_load == Some(load)).map(|s| &s.name);
                let surfaces = surfaces.filter(|s| (s.load..s.load + 3).contains(&load)).map(|s| &s.name);
                let mut names = stops.chain(springs).chain(surfaces);
                names.next().map_or("friction".into(), String::clone)
            }
            None => self.inputs.get(load).cloned().unwrap_or_else(|| "a constant load".into()),
        }
    }
}

/// Name of the input that is the speed of the surface of a joint's first body.
fn surface_speed(joint: &str) -> String {
    format!("{joint}.surface_speed")
}

/// Markers of a definition, in its order.
///
/// # Errors
/// A point does not exist.
pub fn markers(mechanism: &Mechanism, linkage: &Linkage) -> Result<Vec<Point>, DefinitionError> {
    let named = mechanism.markers.iter();
    named.map(|(name, m)| linkage.locate(mechanism, format_args!("markers.{name}.at"), &m.at)).collect()
}
