//! Couplings: gears, racks and belts between two bodies, with the checks that need no geometry.
use super::{Mechanism, Role, Visit};
use crate::format::{DefinitionError, Faults, Owner, Range};
use crate::mechanism::definition::bodies::JointKind;
use crate::variables::Unit;
use serde::{Deserialize, Serialize};

/// Pressure angle of teeth where the file states none [rad]: 20 degrees (ISO 53).
const PRESSURE_ANGLE: f64 = 20.0 * std::f64::consts::PI / 180.0;

/// A coupling: with the angle u1 of the first wheel relative to the carrier, and the angle of the second wheel, or the
/// position of the rack, relative to the carrier u2, it holds u2 = ratio u1 + phase.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Coupling {
    /// Kind of coupling.
    #[serde(rename = "type")]
    pub kind: CouplingKind,
    /// Centre of the first wheel (`body.point`), where it is hinged on the carrier.
    pub first: String,
    /// Gears, belt: centre of the second wheel (`body.point`), where it is hinged on the carrier.
    pub second: Option<String>,
    /// Gears, belt: body on which both wheels are hinged; the ground where absent.
    pub carrier: Option<String>,
    /// Rack: the prismatic joint between the rack and the body on which the wheel is hinged.
    pub joint: Option<String>,
    /// Gears: number of teeth of the first wheel [1], > 0; the ratio of both numbers counts.
    pub first_teeth: Option<f64>,
    /// Gears: number of teeth of the second wheel [1], > 0.
    pub second_teeth: Option<f64>,
    /// Gears: whether the wheel with more teeth is a ring around the other.
    pub internal: Option<bool>,
    /// Belt: radius of the first pulley [m], > 0.
    pub first_radius: Option<f64>,
    /// Belt: radius of the second pulley [m], > 0.
    pub second_radius: Option<f64>,
    /// Belt: whether its spans cross, so that the pulleys turn against one another.
    pub crossed: Option<bool>,
    /// Belt: tension of each span without load [N], >= 0; 0 where absent.
    pub pretension: Option<f64>,
    /// Rack: pitch radius of the wheel [m], > 0.
    pub radius: Option<f64>,
    /// Rack: side of the wheel's centre on which the rack lies, seen along the axis of the joint; right where absent.
    pub side: Option<Side>,
    /// Gears, rack: pressure angle of the teeth [rad], >= 0 and < pi/2; 20 degrees where absent.
    pub pressure_angle: Option<f64>,
    /// u2 at u1 = 0 [rad, or m for a rack]; as in the guess where absent.
    pub phase: Option<f64>,
}

/// Kind of a coupling.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum CouplingKind {
    /// Two gear wheels in mesh.
    Gears,
    /// A gear wheel in mesh with a rack.
    Rack,
    /// A belt or a chain around two pulleys, without slip.
    Belt,
    /// A screw, which is refused: its axis lies in the plane.
    Screw,
}

/// Side of a wheel.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// Left.
    Left,
    /// Right.
    Right,
}

impl Coupling {
    pub(super) fn parameters(&mut self, name: &str, visit: &mut Visit) {
        use Unit::{Metre, Newton, One, Radian};
        let is_rack = self.kind == CouplingKind::Rack;
        let mut list = Owner::new(Some("couplings"), name, Role::Geometry, visit);
        list.add("first_teeth", "Teeth of the first wheel", One, Range::Positive, &mut self.first_teeth);
        list.add("second_teeth", "Teeth of the second wheel", One, Range::Positive, &mut self.second_teeth);
        list.add("first_radius", "Radius of the first pulley", Metre, Range::Length, &mut self.first_radius);
        list.add("second_radius", "Radius of the second pulley", Metre, Range::Length, &mut self.second_radius);
        list.add("radius", "Pitch radius of the wheel", Metre, Range::Length, &mut self.radius);
        match is_rack {
            true => list.add("phase", "Position at angle 0 of the wheel", Metre, Range::Coordinate, &mut self.phase),
            false => list.add("phase", "Second angle at the first angle 0", Radian, Range::Turn, &mut self.phase),
        }
        list.role = Role::Load;
        list.add("pretension", "Tension of each span without load", Newton, Range::NonNegative, &mut self.pretension);
        list.add("pressure_angle", "Pressure angle", Radian, Range::Pressure, &mut self.pressure_angle);
    }

    /// Keys that this kind must have, and the others that it may have.
    fn keys(&self) -> (&'static [&'static str], &'static [&'static str]) {
        match self.kind {
            CouplingKind::Gears => {
                (&["second", "first_teeth", "second_teeth"], &["carrier", "internal", "pressure_angle"])
            }
            CouplingKind::Rack => (&["joint", "radius"], &["side", "pressure_angle"]),
            CouplingKind::Belt => (&["second", "first_radius", "second_radius"], &["carrier", "crossed", "pretension"]),
            CouplingKind::Screw => (&[], &[]),
        }
    }

    /// Keys that not all kinds have, and whether they are given.
    fn given(&self) -> [(&'static str, bool); 12] {
        [
            ("second", self.second.is_some()),
            ("carrier", self.carrier.is_some()),
            ("joint", self.joint.is_some()),
            ("first_teeth", self.first_teeth.is_some()),
            ("second_teeth", self.second_teeth.is_some()),
            ("internal", self.internal.is_some()),
            ("first_radius", self.first_radius.is_some()),
            ("second_radius", self.second_radius.is_some()),
            ("crossed", self.crossed.is_some()),
            ("pretension", self.pretension.is_some()),
            ("radius", self.radius.is_some()),
            ("side", self.side.is_some()),
        ]
    }

    /// State what the file leaves out.
    fn complete(&mut self) {
        if matches!(self.kind, CouplingKind::Gears | CouplingKind::Rack) {
            self.pressure_angle.get_or_insert(PRESSURE_ANGLE);
        }
    }
}

impl Mechanism {
    /// Faults of the couplings, which are completed.
    pub(super) fn check_couplings(&mut self, faults: &mut Faults) {
        self.couplings.iter_mut().for_each(|(_, coupling)| coupling.complete());
        for (name, coupling) in self.couplings.iter() {
            faults.keep(self.check_coupling(name, coupling));
        }
    }

    fn check_coupling(&self, name: &str, coupling: &Coupling) -> Result<(), DefinitionError> {
        let key = |k: &str| format!("couplings.{name}.{k}");
        let refused = |k: &str, message: &str| Err(DefinitionError::key(key(k), message));
        if coupling.kind == CouplingKind::Screw {
            let message = "the axis of a screw lies in the plane, so that its rotation is no planar motion: drive the \
                           prismatic joint by an actuator, or write rack for a wheel that turns in the plane";
            return refused("type", message);
        }
        if self.bodies.get(name).is_some() || self.joints.get(name).is_some() {
            let group = if self.joints.get(name).is_some() { "joint" } else { "body" };
            let message = format!("names a {group} too, and both would have the same outputs: rename one");
            return Err(DefinitionError::key(format_args!("couplings.{name}"), message));
        }
        let (needed, allowed) = coupling.keys();
        let given = coupling.given().into_iter().chain([("pressure_angle", coupling.pressure_angle.is_some())]);
        for (k, is_given) in given {
            if is_given && !needed.contains(&k) && !allowed.contains(&k) {
                let keys = [&["first"], needed, allowed, &["phase"]].concat().join(", ");
                return refused(k, &format!("goes with another type of coupling; the keys of this one are {keys}"));
            }
            if !is_given && needed.contains(&k) {
                return refused(k, "is missing: add it");
            }
        }
        self.point(key("first"), &coupling.first)?;
        if let Some(second) = &coupling.second {
            self.point(key("second"), second)?;
        }
        if let Some(carrier) = &coupling.carrier {
            self.named_body(&key("carrier"), carrier)?;
        }
        if let Some(joint) = &coupling.joint
            && self.named_joint(&key("joint"), joint)?.kind != JointKind::Prismatic
        {
            return refused("joint", "is a revolute joint: name the prismatic joint in which the rack slides");
        }
        if coupling.internal == Some(true) && coupling.first_teeth == coupling.second_teeth {
            return refused("internal", "a wheel cannot lie in a ring with as many teeth: change a number of teeth");
        }
        Ok(())
    }
}
