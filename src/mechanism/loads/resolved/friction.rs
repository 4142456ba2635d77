//! The joints with friction, each with its law.
//!
//! In: a definition and its linkage. Out: friction joints with their loads. It must not know the state.
use super::couplings::{Mesh, pressure_angles};
use super::ends::joint_load;
use super::{Loading, surface_speed};
use crate::mechanism::definition::{CouplingKind, DefinitionError, Friction, FrictionLaw, Mechanism};
use crate::mechanism::linkage::{Freedom, Kind, Linkage, Second};
use crate::mechanism::loads::laws::friction::{Cubic, Law, Regime};
use crate::mechanism::loads::unit_load::Load;
use crate::numerics::decimal::Decimal;
use std::fmt;

/// Part of the force on the second body by which the loss of a coupling that locks itself exceeds this force, so that
/// rounding does not set it in motion.
const HOLD: f64 = 1e-12;

/// Friction in the joints, and the losses of couplings.
#[derive(Clone, Debug, PartialEq)]
pub struct JointFriction {
    /// Whether friction that reactions cause in joints acts; losses of couplings and constant friction do in any case.
    pub enabled: bool,
    /// Joints and cams with friction, then couplings with losses, then teeth, then screws that lock themselves, then
    /// joints with constant friction.
    pub friction_joints: Vec<FrictionJoint>,
}

impl JointFriction {
    /// The joints whose friction acts, and the couplings with losses.
    pub fn acting(&self) -> impl Iterator<Item = &FrictionJoint> + Clone {
        self.friction_joints.iter().filter(|joint| self.enabled || joint.kind != FrictionKind::Joint)
    }

    /// Whether the friction with this index acts, or the constant friction of the same joint.
    pub fn acts(&self, index: usize) -> bool {
        let (first, constant) = self.of_joint(index);
        self.enabled || first.kind != FrictionKind::Joint || constant.is_some()
    }

    /// The friction that sticks and the losses, by their indices, each joint once: these jump where its slip turns.
    pub fn turning(&self) -> impl Iterator<Item = usize> + '_ {
        let all = &self.friction_joints;
        let is_first = |k: &usize| all[..*k].iter().all(|before| before.joint != all[*k].joint);
        (0..all.len()).filter(|k| all[*k].law.sticks).filter(is_first)
    }

    /// The friction with this index, and the constant friction of the same joint where that is another one.
    pub fn of_joint(&self, index: usize) -> (&FrictionJoint, Option<&FrictionJoint>) {
        let first = &self.friction_joints[index];
        let is_constant = |own: &FrictionJoint| matches!(own.kind, FrictionKind::Constant(_));
        (first, self.friction_joints[index + 1..].iter().find(|own| own.joint == first.joint && is_constant(own)))
    }
}

/// What the friction of a joint follows from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FrictionKind {
    /// The reaction of a joint, or the contact force of a cam.
    Joint,
    /// The transmitted force of a coupling: its loss.
    Coupling,
    /// The transmitted force F_t of a coupling with teeth: no friction, but the force |F_t| tan(alpha) that pushes the
    /// wheels apart, whichever way they turn. It does no work, and loads the joints with friction.
    Teeth,
    /// The force of a screw that locks itself on its nut: its loss, as that of a coupling between screw and nut.
    Screw {
        /// Index of the drive.
        drive: usize,
        /// Index of the rotor.
        rotor: usize,
    },
    /// Nothing: it is constant, [N.m] in a revolute joint or [N] in a prismatic one.
    Constant(f64),
}

/// A joint with friction, or a coupling with losses.
///
/// Constant friction is that of a reaction that has this size in any state, with the coefficient 1.
///
/// The loss of a coupling with the efficiency eta is friction that the force N on its second body causes: a load on
/// this body, from the carrier, of the size (1 / eta - 1) |N| where power flows to the second body, and (1 - eta_b) |N|
/// where it flows back, against the motion, with the backward efficiency eta_b, which is eta unless stated. The first
/// body gives or gets N / eta, or eta_b N: nothing for eta_b = 0, a coupling that locks itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionJoint {
    /// Index of the joint; of a screw an index of its own, above those of all joints.
    pub joint: usize,
    /// Index of its load: a couple [N.m] in a revolute joint, a force along the axis [N] in a prismatic one, along the
    /// curve of a slot, along the profile of a cam.
    pub load: usize,
    /// Radius of the pin of a revolute joint [m]; 1 for another joint or a cam, where the load is a force; pitch radius
    /// of the second wheel of a coupling, or 1; of teeth -tan(alpha), with the pressure angle alpha.
    pub radius: f64,
    /// What the friction follows from.
    pub kind: FrictionKind,
    /// Coefficient where power flows back over that where it flows forward; 1 for a joint.
    pub back: f64,
    /// Coefficient of friction over slip speed.
    pub law: Law,
    /// Index of the input that is the speed of the surface of the first body [m/s], which the slip speed is relative
    /// to; none where the surface is fixed to the first body.
    pub surface: Option<usize>,
}

impl FrictionJoint {
    /// Whether it is a loss, which depends on the direction in which power flows.
    pub fn is_loss(&self) -> bool {
        matches!(self.kind, FrictionKind::Coupling | FrictionKind::Screw { .. })
    }

    /// Whether its driven surface can hold its body.
    pub fn clings(&self) -> bool {
        self.law.sticks && self.surface.is_some() && self.radius != 0.0
    }

    /// Whether it follows from one component of a reaction, whose sign can be held.
    pub fn has_normal_force(&self, linkage: &Linkage) -> bool {
        let is_pin = linkage.joints.get(self.joint).is_some_and(|joint| joint.freedom == Freedom::Revolute);
        !is_pin && !matches!(self.kind, FrictionKind::Constant(_))
    }

    /// Arm of the friction, mu with its sign times the radius [m, or 1], over the slip speed [m/s] on a regime.
    #[inline]
    pub fn arm(&self, regime: Regime) -> Cubic {
        self.law.cubic(regime).times(self.radius)
    }
}

impl Loading {
    pub(super) fn add_friction(&mut self, mechanism: &Mechanism, linkage: &Linkage) -> Result<(), DefinitionError> {
        let mut friction_joints = Vec::new();
        if let Some(friction) = &mechanism.friction {
            self.add_joints(mechanism, linkage, friction, &mut friction_joints)?;
        }
        self.add_losses(mechanism, linkage, &mut friction_joints)?;
        self.add_teeth(mechanism, &mut friction_joints)?;
        self.add_screws(mechanism, linkage, &mut friction_joints)?;
        self.add_constant(mechanism, linkage, &mut friction_joints)?;
        let enabled = mechanism.friction.as_ref().is_some_and(|friction| friction.enabled.unwrap_or(false));
        if mechanism.friction.is_some() || !friction_joints.is_empty() {
            self.friction = Some(JointFriction { enabled, friction_joints });
        }
        Ok(())
    }

    /// Add the losses of couplings, behind the friction of joints.
    fn add_losses(
        &mut self,
        mechanism: &Mechanism,
        linkage: &Linkage,
        friction_joints: &mut Vec<FrictionJoint>,
    ) -> Result<(), DefinitionError> {
        for ((name, defined), coupling) in mechanism.couplings.iter().zip(&linkage.couplings) {
            let Some(efficiency) = defined.efficiency else { continue };
            check_law(mechanism, "a coupling with losses", format_args!("couplings.{name}.efficiency"))?;
            let joint = &linkage.joints[coupling.joint];
            let (load, radius) = match (coupling.second, &coupling.kind) {
                (Second::Position { joint, sign, .. }, _) => (Load::Slide { joint, sign, is_idle: false }, 1.0),
                (Second::Angle { .. }, kind) => {
                    let [_, slope, _] = coupling.law.at(0.0);
                    let radius = match kind {
                        Kind::Belt { radii, .. } => radii[1],
                        _ => linkage.hinge_distance(coupling.carrier, joint) / (slope - 1.0).abs(),
                    };
                    (
                        Load::Couple { first: coupling.carrier, second: joint.second.body, shift: 0.0, is_idle: false },
                        radius,
                    )
                }
            };
            let (joint, index) = (coupling.joint, self.loads.len());
            let backward = defined.backward_efficiency.unwrap_or(efficiency);
            let (kind, (law, back)) = (FrictionKind::Coupling, loss(efficiency, backward));
            friction_joints.push(FrictionJoint { joint, load: index, radius, kind, back, law, surface: None });
            self.loads.push(load);
        }
        Ok(())
    }

    /// Add the teeth that push wheels apart in a mechanism whose joints have friction, behind the losses of couplings.
    fn add_teeth(
        &mut self,
        mechanism: &Mechanism,
        friction_joints: &mut Vec<FrictionJoint>,
    ) -> Result<(), DefinitionError> {
        let Some(_) = &mechanism.friction else { return Ok(()) };
        for (coupling, (name, angle)) in pressure_angles(mechanism) {
            if mechanism.couplings.get(name).is_some_and(|own| own.kind == CouplingKind::EllipticGears) {
                let message = "the friction of joints cannot include the separating force of elliptic gears: set \
                               `pressure_angle` to 0, or remove `friction`";
                return Err(DefinitionError::key(format_args!("couplings.{name}.pressure_angle"), message));
            }
            let (joint, load, kind) = (mechanism.joints.len() + coupling, self.loads.len(), FrictionKind::Teeth);
            let tangent = angle.tan();
            friction_joints.push(FrictionJoint {
                joint,
                load,
                radius: -tangent,
                kind,
                back: 1.0,
                law: ANY_SLIP,
                surface: None,
            });
            self.meshes.push(Mesh { joint, loads: [load; 2], tangent });
            self.loads.push(Load::Separation { coupling, lean: 0.0 });
        }
        Ok(())
    }

    /// Add the losses of screws that lock themselves, behind the teeth.
    fn add_screws(
        &mut self,
        mechanism: &Mechanism,
        linkage: &Linkage,
        friction_joints: &mut Vec<FrictionJoint>,
    ) -> Result<(), DefinitionError> {
        let screws = mechanism.actuators.iter().enumerate().filter(|(_, (_, defined))| defined.screw.is_some());
        for (rotor, (drive, (name, defined))) in screws.enumerate().filter(|(_, (_, (_, own)))| own.locks_itself()) {
            check_law(mechanism, "a screw that locks itself", format_args!("actuators.{name}.backward_efficiency"))?;
            let (joint, load, kind) =
                (linkage.joints.len() + drive, self.loads.len(), FrictionKind::Screw { drive, rotor });
            let (law, back) = loss(defined.efficiency.unwrap_or(1.0), 0.0);
            friction_joints.push(FrictionJoint { joint, load, radius: 1.0, kind, back, law, surface: None });
            self.loads.push(self.loads[drive].along().clone());
        }
        Ok(())
    }

    /// Add the constant friction of joints, behind the screws.
    fn add_constant(
        &mut self,
        mechanism: &Mechanism,
        linkage: &Linkage,
        friction_joints: &mut Vec<FrictionJoint>,
    ) -> Result<(), DefinitionError> {
        for (joint, (name, defined)) in mechanism.joints.iter().enumerate() {
            let Some(size) = defined.frictionloss else { continue };
            check_law(mechanism, "a joint with constant friction", format_args!("joints.{name}.frictionloss"))?;
            let (load, kind) = (self.loads.len(), FrictionKind::Constant(size));
            friction_joints.push(FrictionJoint {
                joint,
                load,
                radius: 1.0,
                kind,
                back: 1.0,
                law: coulomb(1.0),
                surface: None,
            });
            self.loads.push(joint_load(linkage, joint, 0.0));
        }
        Ok(())
    }

    /// Add the joints with friction.
    fn add_joints(
        &mut self,
        mechanism: &Mechanism,
        linkage: &Linkage,
        f: &Friction,
        friction_joints: &mut Vec<FrictionJoint>,
    ) -> Result<(), DefinitionError> {
        let Friction { enabled: _, law, static_coefficient, kinetic_coefficient, static_speed, kinetic_speed } = *f;
        let sticks = law == FrictionLaw::Stick;
        if kinetic_speed <= static_speed && !(sticks && kinetic_speed == 0.0 && static_speed == 0.0) {
            let or = if sticks { ", or 0 if static_speed is 0" } else { "" };
            let allowed = format!("greater than friction.static_speed = {}{or}", Decimal(static_speed));
            return Err(DefinitionError::value("friction.kinetic_speed", Decimal(kinetic_speed), allowed));
        }
        let law = |key: fmt::Arguments, own: [Option<f64>; 2]| {
            let [at_rest, slipping] = [own[0].unwrap_or(static_coefficient), own[1].unwrap_or(kinetic_coefficient)];
            if sticks && at_rest < slipping {
                return Err(static_below_kinetic(key, own, [at_rest, slipping]));
            }
            Ok(Law { sticks, static_coefficient: at_rest, kinetic_coefficient: slipping, static_speed, kinetic_speed })
        };
        let (kind, back) = (FrictionKind::Joint, 1.0);
        for (joint, ((name, defined), resolved)) in mechanism.joints.iter().zip(&linkage.joints).enumerate() {
            let radius = match (resolved.freedom, defined.pin_radius) {
                (Freedom::Prismatic(_) | Freedom::Slot(_), _) => 1.0,
                (Freedom::Revolute, Some(radius)) => radius,
                (Freedom::Revolute, None) | (Freedom::Coupling(_), _) => continue,
            };
            let own = [defined.static_coefficient, defined.kinetic_coefficient];
            let (load, law) = (self.loads.len(), law(format_args!("joints.{name}"), own)?);
            let input = defined.surface_speed.map(|_| surface_speed(name));
            if input.is_some() && sticks {
                check_surface(mechanism, name, friction_joints.iter().find(|own| own.surface.is_some()))?;
            }
            let surface = input.and_then(|input| self.inputs.iter().position(|name| *name == input));
            friction_joints.push(FrictionJoint { joint, load, radius, kind, back, law, surface });
            self.loads.push(joint_load(linkage, joint, 0.0));
        }
        for (coupling, (name, defined)) in mechanism.couplings.iter().enumerate() {
            let own = [defined.static_coefficient, defined.kinetic_coefficient];
            if own != [None; 2] {
                let (joint, load, law) =
                    (mechanism.joints.len() + coupling, self.loads.len(), law(format_args!("couplings.{name}"), own)?);
                friction_joints.push(FrictionJoint { joint, load, radius: 1.0, kind, back, law, surface: None });
                self.loads.push(Load::Rub { coupling });
            }
        }
        Ok(())
    }
}

/// Law of the loss of an efficiency where power flows forward, and the coefficient where it flows back over that.
fn loss(forward: f64, backward: f64) -> (Law, f64) {
    // Their ratio needs losses in both directions, which may be rounding.
    let lost = (1.0 / forward - 1.0).max(f64::EPSILON);
    let lost_back = if backward == 0.0 { 1.0 + HOLD } else { (1.0 - backward).max(f64::EPSILON) };
    (coulomb(lost), lost_back / lost)
}

/// The coefficient 1 at any slip of either sign.
const ANY_SLIP: Law = Law {
    sticks: false,
    static_coefficient: 1.0,
    kinetic_coefficient: 1.0,
    static_speed: f64::NEG_INFINITY,
    kinetic_speed: f64::NEG_INFINITY,
};

/// Coulomb's law with one coefficient at rest and at any slip speed.
fn coulomb(coefficient: f64) -> Law {
    Law {
        sticks: true,
        static_coefficient: coefficient,
        kinetic_coefficient: coefficient,
        static_speed: 0.0,
        kinetic_speed: 0.0,
    }
}

/// Refuse friction in joints that does not hold at rest together with an element whose friction does.
fn check_law(mechanism: &Mechanism, what: &str, key: fmt::Arguments) -> Result<(), DefinitionError> {
    if mechanism.friction.as_ref().is_none_or(|friction| friction.law == FrictionLaw::Stick) {
        return Ok(());
    }
    let message = format!(
        "{what} needs a friction law that can hold the mechanism at rest: write \"law\": \"stick\" in `friction`, or \
         remove this key"
    );
    Err(DefinitionError::key(key, message))
}

/// Refuse a driven surface that can hold its body together with what cannot be computed while it does.
fn check_surface(mechanism: &Mechanism, name: &str, other: Option<&FrictionJoint>) -> Result<(), DefinitionError> {
    let other = other.and_then(|own| mechanism.joints.names().get(own.joint).copied());
    let what = match (other, mechanism.motion_drive()) {
        (Some(other), _) => format!("joints.{other}.surface_speed: only 1 joint can have a driven surface"),
        (None, Some((_, drive, _))) => format!("actuators.{drive}.motion: the motion must not be prescribed"),
        (None, None) if mechanism.has_hydraulics() => "hydraulics: no hydraulic circuit is possible".to_owned(),
        (None, None) if mechanism.control_states().next().is_some() => {
            "the key `control` of a drive: no controller with a state is possible".to_owned()
        }
        (None, None) => return Ok(()),
    };
    let message = format!(
        "does not agree with {what} where friction.law = \"stick\"; write \"law\": \"viscous\" with a small \
         static_speed in friction, or remove this key"
    );
    Err(DefinitionError::key(format_args!("joints.{name}.surface_speed"), message))
}

/// The error for a law that sticks with less static than kinetic friction: a mechanism that breaks away would stick at
/// once.
fn static_below_kinetic(key: fmt::Arguments, own: [Option<f64>; 2], present: [f64; 2]) -> DefinitionError {
    let key = match own {
        [None, None] => "friction.static_coefficient".to_owned(),
        [None, Some(_)] => format!("{key}.kinetic_coefficient"),
        [Some(_), _] => format!("{key}.static_coefficient"),
    };
    let [rest, slip] = present.map(Decimal);
    let message = format!(
        "the static coefficient {rest} is smaller than the kinetic coefficient {slip}, but \"law\": \"stick\" needs \
         a static coefficient that is at least as large"
    );
    DefinitionError::key(key, message)
}
