//! Couplings: gears, racks, belts and cams between two bodies, with the checks that need no geometry.
use super::cams::{CamSegment, Follower};
use super::interpolation::Interpolation;
use super::{Mechanism, Role, Visit};
use crate::format::{DefinitionError, Faults, Owner, Range};
use crate::mechanism::definition::bodies::JointKind;
use crate::variables::Unit;
use serde::{Deserialize, Serialize};

/// Pressure angle of teeth where the file states none [rad]: 20 degrees (ISO 53).
const PRESSURE_ANGLE: f64 = 20.0 * std::f64::consts::PI / 180.0;

/// A coupling: with the angle u1 of the first wheel relative to the carrier, and the angle of the second wheel, or the
/// position of the rack, relative to the carrier u2, it holds u2 = F(u1); of gears, racks and belts u2 = ratio u1 + phase.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Coupling {
    /// Kind of coupling.
    #[serde(rename = "type")]
    pub kind: CouplingKind,
    /// Centre of the first wheel or of the cam (`body.point`), where it is hinged on the carrier.
    pub first: String,
    /// Centre of the second wheel or of an oscillating follower (`body.point`), where it is hinged on the carrier.
    pub second: Option<String>,
    /// Body on which both are hinged; the ground where absent.
    pub carrier: Option<String>,
    /// The prismatic joint between the rack, or a translating follower, and the body on which the wheel or cam is hinged.
    pub joint: Option<String>,
    /// Elliptic gears: eccentricity of both pitch curves [1], from 0 to 0.9.
    pub eccentricity: Option<f64>,
    /// Elliptic gears: number of lobes of each wheel [1]; 1, ellipses about a focus, where absent.
    pub lobes: Option<f64>,
    /// Elliptic gears: direction in the first wheel's frame, from its centre to the nearest vertex of its pitch curve [rad];
    /// 0 where absent.
    pub vertex_angle: Option<f64>,
    /// Cam: what touches it.
    pub follower: Option<Follower>,
    /// Cam: centre of the roller, or a point of the flat face, on the follower (`body.point`).
    pub contact: Option<String>,
    /// Cam: radius of its base circle [m], > 0: the least of the profile, which touches without lift.
    pub base_radius: Option<f64>,
    /// Cam: radius of the roller [m], > 0.
    pub roller_radius: Option<f64>,
    /// Cam: direction of the flat face in the follower's frame [rad]; across the joint's axis, or along the x axis of an
    /// oscillating follower, where absent.
    pub face_angle: Option<f64>,
    /// Cam: u1 at which the first segment begins, or at which the angle of the table is 0 [rad]; 0 where absent.
    pub start_angle: Option<f64>,
    /// Cam: the lift over a revolution, segment after segment.
    pub segments: Option<Vec<CamSegment>>,
    /// Cam: points of the lift in place of segments: pairs of angle [rad] and lift [m or rad], angles ascending.
    pub points: Option<Vec<[f64; 2]>>,
    /// Cam: curve through the points; a spline where absent.
    pub interpolation: Option<Interpolation>,
    /// Cam: whether it holds its follower in both directions, in a groove or by a second cam.
    pub grooved: Option<bool>,
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
    /// Gears, elliptic gears, rack: pressure angle of the teeth [rad], >= 0 and < pi/2; 20 degrees where absent.
    pub pressure_angle: Option<f64>,
    /// u2 at u1 = 0 [rad, or m for a rack]; as in the guess where absent.
    pub phase: Option<f64>,
    /// Gears, rack, belt: part of the power that is passed on, whichever way it flows [1], > 0 and <= 1; no loss where absent.
    pub efficiency: Option<f64>,
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
    /// Two equal elliptic gear wheels in mesh.
    EllipticGears,
    /// A disc cam and its follower.
    Cam,
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
        list.add("eccentricity", "Eccentricity of the pitch curves", One, Range::Eccentricity, &mut self.eccentricity);
        list.add("lobes", "Lobes of each wheel", One, Range::Count, &mut self.lobes);
        list.add("vertex_angle", "Direction of the nearest vertex", Radian, Range::Turn, &mut self.vertex_angle);
        list.add("base_radius", "Radius of the base circle", Metre, Range::Length, &mut self.base_radius);
        list.add("roller_radius", "Radius of the roller", Metre, Range::Length, &mut self.roller_radius);
        list.add("face_angle", "Direction of the flat face", Radian, Range::Turn, &mut self.face_angle);
        list.add("start_angle", "Angle at which the lift begins", Radian, Range::Turn, &mut self.start_angle);
        list.role = Role::Load;
        list.add("pretension", "Tension of each span without load", Newton, Range::NonNegative, &mut self.pretension);
        list.add("pressure_angle", "Pressure angle", Radian, Range::Pressure, &mut self.pressure_angle);
        list.add("efficiency", "Efficiency", One, Range::Fraction, &mut self.efficiency);
    }

    /// Keys that this kind must have, and the others that it may have.
    fn keys(&self) -> (&'static [&'static str], &'static [&'static str]) {
        match self.kind {
            CouplingKind::Gears => {
                (&["second", "first_teeth", "second_teeth"], &["carrier", "internal", "pressure_angle", "efficiency"])
            }
            CouplingKind::Rack => (&["joint", "radius"], &["side", "pressure_angle", "efficiency"]),
            CouplingKind::Belt => {
                (&["second", "first_radius", "second_radius"], &["carrier", "crossed", "pretension", "efficiency"])
            }
            CouplingKind::EllipticGears => {
                (&["second", "eccentricity"], &["carrier", "lobes", "vertex_angle", "pressure_angle"])
            }
            CouplingKind::Cam => (
                &["follower", "contact", "base_radius"],
                &[
                    "joint",
                    "second",
                    "carrier",
                    "roller_radius",
                    "face_angle",
                    "start_angle",
                    "segments",
                    "points",
                    "interpolation",
                    "grooved",
                ],
            ),
            CouplingKind::Screw => (&[], &[]),
        }
    }

    /// Keys that not all kinds have, and whether they are given.
    fn given(&self) -> [(&'static str, bool); 25] {
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
            ("eccentricity", self.eccentricity.is_some()),
            ("lobes", self.lobes.is_some()),
            ("vertex_angle", self.vertex_angle.is_some()),
            ("follower", self.follower.is_some()),
            ("contact", self.contact.is_some()),
            ("base_radius", self.base_radius.is_some()),
            ("roller_radius", self.roller_radius.is_some()),
            ("face_angle", self.face_angle.is_some()),
            ("start_angle", self.start_angle.is_some()),
            ("segments", self.segments.is_some()),
            ("points", self.points.is_some()),
            ("interpolation", self.interpolation.is_some()),
            ("grooved", self.grooved.is_some()),
        ]
    }

    /// State what the file leaves out.
    fn complete(&mut self) {
        if matches!(self.kind, CouplingKind::Gears | CouplingKind::EllipticGears | CouplingKind::Rack) {
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
            let message = "the axis of a screw lies in the plane, so that its rotation is no planar motion: give the key \
                           screw of an actuator, or write rack for a wheel that turns in the plane";
            return refused("type", message);
        }
        if coupling.efficiency.is_some() && matches!(coupling.kind, CouplingKind::EllipticGears | CouplingKind::Cam) {
            let message = "couplings of variable ratio pass on all power: remove it, and give the efficiency of a drive, or the \
                           friction of joints";
            return refused("efficiency", message);
        }
        let (needed, allowed) = coupling.keys();
        let given = coupling.given().into_iter().chain([
            ("pressure_angle", coupling.pressure_angle.is_some()),
            ("efficiency", coupling.efficiency.is_some()),
        ]);
        for (k, is_given) in given {
            if is_given && !needed.contains(&k) && !allowed.contains(&k) {
                let phase: &[&str] = if coupling.kind == CouplingKind::Cam { &[] } else { &["phase"] };
                let keys = [&["first"], needed, allowed, phase].concat().join(", ");
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
            let what = if coupling.kind == CouplingKind::Cam { "follower" } else { "rack" };
            return refused(
                "joint",
                &format!("is a revolute joint: name the prismatic joint in which the {what} slides"),
            );
        }
        if let Some(contact) = &coupling.contact {
            self.point(key("contact"), contact)?;
        }
        if coupling.kind == CouplingKind::Cam {
            coupling.check_cam(&format!("couplings.{name}"))?;
        }
        if coupling.internal == Some(true) && coupling.first_teeth == coupling.second_teeth {
            return refused("internal", "a wheel cannot lie in a ring with as many teeth: change a number of teeth");
        }
        Ok(())
    }
}
