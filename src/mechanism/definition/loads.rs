//! Loads: gravity, drives, forces, torques, springs and drag.
use super::motion::PrescribedMotion;
use super::{AXES, Role, Visit};
use crate::format::{Flag, Owner, Parameter, Range};
use crate::hydraulics::definition::{Circuit, Role as CircuitRole};
use crate::variables::Unit;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Uniform gravity: the acceleration load_factor * acceleration along -(cos up_angle, sin up_angle).
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Gravity {
    /// Acceleration of free fall [m/s2], >= 0.
    pub acceleration: f64,
    /// Angle of the upward direction from the X axis [rad].
    pub up_angle: f64,
    /// Start value of the input `load_factor` [1].
    #[serde(default = "load_factor")]
    pub load_factor: f64,
}

fn load_factor() -> f64 {
    1.0
}

/// A drive along the line between two points or in a joint. A positive force pushes the points apart; in a joint a
/// positive force or torque moves the second body along the axis or anticlockwise.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Actuator {
    /// One end (`body.point`).
    pub first: Option<String>,
    /// The other end (`body.point`).
    pub second: Option<String>,
    /// Joint, in place of the two ends.
    pub joint: Option<String>,
    /// Neither in a revolute joint nor with a screw: start value of the input `<name>.force` [N].
    pub force: Option<f64>,
    /// In a revolute joint or with a screw: start value of the input `<name>.torque` [N.m].
    pub torque: Option<f64>,
    /// Efficiency eta [1], 0 < eta <= 1 ([CK16] eq. (5)): part of the power that the drive passes on to the mechanism,
    /// and back from it; 1 where absent.
    pub efficiency: Option<f64>,
    /// Points of a force or torque over the speed of the drive: pairs [m/s or rad/s, N or N.m], speeds ascending. It is
    /// added to the force, times the input `<name>.command`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub points: Option<Vec<[f64; 2]>>,
    /// Start value of the input `<name>.command` [1]; 1 where absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub command: Option<f64>,
    /// Not in a revolute joint: the hydraulic circuit that drives it, with the sections of a hydraulic actuator. The force
    /// is then an output.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hydraulics: Option<Circuit>,
    /// Not in a revolute joint: the screw through which a motor drives. The drive is then its rotation, with a torque.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub screw: Option<Screw>,
    /// The motion of the drive, where it can be prescribed; one drive of a mechanism may have it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motion: Option<PrescribedMotion>,
}

/// A screw and nut along the line of a drive: with the angle phi of the screw the stroke is lead phi / (2 pi).
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Screw {
    /// Stroke for one revolution [m], > 0.
    pub lead: f64,
    /// Moment of inertia of the screw with its motor about its axis [kg.m2], >= 0; 0 where absent.
    pub inertia: Option<f64>,
}

impl Screw {
    /// Angle for each metre of the stroke [rad/m].
    pub fn ratio(self) -> f64 {
        TAU / self.lead
    }

    /// Mass that has the kinetic energy of the screw at the speed of the stroke [kg].
    pub fn reflected_mass(self) -> f64 {
        self.inertia.unwrap_or(0.0) * self.ratio().powi(2)
    }
}

/// A force at a point, in the mechanism frame.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Force {
    /// Point of application (`body.point`).
    pub at: String,
    /// Start values of `<name>.force_x` and `<name>.force_y` [N].
    #[serde(default)]
    pub force: [f64; 2],
    /// Whether the components are parameters; inputs where absent.
    #[serde(default)]
    pub constant: bool,
}

/// A torque on a body.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Torque {
    /// Body on which the torque acts.
    pub on: String,
    /// Start value of `<name>.torque` [N.m].
    #[serde(default)]
    pub torque: f64,
    /// Whether the torque is a parameter; an input where absent.
    #[serde(default)]
    pub constant: bool,
}

/// A spring and damper. Between two points the force preload + stiffness (length - free_length) + damping d(length)/dt
/// pulls the points together; in a prismatic joint it pulls the second body back, with the joint's position as length.
/// In a revolute joint the torque preload + stiffness (angle - free_angle) + damping d(angle)/dt turns the second body
/// clockwise, where angle is the angle of the second body less the angle of the first. A characteristic, by points or of
/// a gas, is added.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Spring {
    /// One end (`body.point`).
    pub first: Option<String>,
    /// The other end (`body.point`).
    pub second: Option<String>,
    /// Joint, in place of the two ends.
    pub joint: Option<String>,
    /// Stiffness [N/m or N.m/rad], >= 0.
    #[serde(default)]
    pub stiffness: f64,
    /// Damping [N.s/m or N.m.s/rad], >= 0; none where absent.
    pub damping: Option<f64>,
    /// Length at which the static force is the preload [m], >= 0; between two points, or along a prismatic joint.
    pub free_length: Option<f64>,
    /// Angle at which the static torque is the preload [rad]; in a revolute joint.
    pub free_angle: Option<f64>,
    /// Force or torque at the free length or angle [N or N.m]; 0 where absent.
    pub preload: Option<f64>,
    /// Points of a further force as a function of length, position or angle: pairs [m or rad, N or N.m], ascending.
    pub points: Option<Vec<[f64; 2]>>,
    /// Points of a further force as a function of the speed of lengthening or turning: pairs [m/s or rad/s, N or N.m],
    /// ascending, one of them [0, 0].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub damping_points: Option<Vec<[f64; 2]>>,
    /// Gas that the spring compresses; between two points, or along a prismatic joint.
    pub gas: Option<Gas>,
}

/// The gas of a gas spring: with the volume V = volume + area (length - free_length) its pressure is
/// pressure (volume / V)^exponent, and (ambient - pressure) area is added to the spring's force.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Gas {
    /// Absolute pressure at the free length [Pa], > 0.
    pub pressure: f64,
    /// Area on which the gas acts [m2], > 0: the rod's cross section if gas is on both sides of the piston.
    pub area: f64,
    /// Volume at the free length [m3], > 0.
    pub volume: f64,
    /// Polytropic exponent [1], from 1 (slow, isothermal) to 2; 1.4 for fast changes of nitrogen.
    pub exponent: f64,
    /// Absolute pressure around the spring [Pa], >= 0; the standard atmosphere where absent.
    #[serde(default = "atmosphere")]
    pub ambient: f64,
}

/// Standard atmosphere [Pa].
fn atmosphere() -> f64 {
    101_325.0
}

/// Air in uniform flow, with the input `airspeed`.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Air {
    /// Mass density [kg/m3], >= 0.
    pub density: f64,
    /// Direction in which the air flows, angle from the X axis [rad].
    pub flow_angle: f64,
    /// Whether drag follows from the velocity of the air relative to the moving surface; from the velocity of the air
    /// alone where absent.
    #[serde(default)]
    pub relative_wind: bool,
    /// Start value of the input `airspeed` [m/s].
    #[serde(default)]
    pub airspeed: f64,
}

/// A surface with drag: a strip along the line between two points of one body, or an area at a point. The drag [N] is
/// 1/2 density |u| u c S, with the air's velocity u [m/s] relative to the surface and the area S [m2] across u ([HF08]
/// (1)).
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Surface {
    /// One end of a strip (`body.point`).
    pub from: Option<String>,
    /// The other end, on the same body.
    pub to: Option<String>,
    /// Width of a strip [m], >= 0.
    pub width: Option<f64>,
    /// Point of an area (`body.point`).
    pub at: Option<String>,
    /// Area [m2], >= 0.
    pub area: Option<f64>,
    /// Angle of a flat area's plane in the body's frame [rad]; where absent, the area is the same from all sides.
    pub surface_angle: Option<f64>,
    /// Drag coefficient c [1], >= 0.
    pub drag_coefficient: f64,
}

impl Gravity {
    pub(super) fn parameters(&mut self, visit: &mut Visit) {
        let mut list = Owner::new(None, "gravity", Role::Load, visit);
        let (unit, words) = (Unit::MetrePerSecondSquared, "Upward direction, angle from the X axis");
        list.add("acceleration", "Acceleration of free fall", unit, Range::Size, &mut self.acceleration);
        list.add("up_angle", words, Unit::Radian, Range::Finite, &mut self.up_angle);
    }
}

impl Actuator {
    /// Start value of the command of the drive's curve [1].
    pub fn command(&self) -> f64 {
        self.command.unwrap_or(1.0)
    }

    pub(super) fn parameters(&mut self, name: &str, is_rotary: bool, visit: &mut Visit) {
        let mut list = Owner::new(Some("actuators"), name, Role::Load, visit);
        list.add("efficiency", "Efficiency", Unit::One, Range::Fraction, &mut self.efficiency);
        if let Some(screw) = &mut self.screw {
            list.role = Role::Geometry;
            list.add("screw.lead", "Lead of the screw", Unit::Metre, Range::Length, &mut screw.lead);
            let (words, unit) = ("Moment of inertia of the screw", Unit::KilogramSquareMetre);
            list.add("screw.inertia", words, unit, Range::NonNegative, &mut screw.inertia);
        }
        if let Some(circuit) = &mut self.hydraulics {
            circuit.parameters(&mut |parameter, value| {
                let is_start = parameter.role == CircuitRole::Start;
                visit(parameter.with(if is_start { Role::CircuitStart } else { Role::Circuit }), value);
            });
        }
        if let Some(motion) = &mut self.motion {
            motion.parameters(name, is_rotary, visit);
        }
    }
}

impl Force {
    pub(super) fn parameters(&mut self, name: &str, visit: &mut Visit) {
        for ((axis, index), value) in AXES.into_iter().zip(&mut self.force) {
            let (key, kind) = (["forces.", name, ".force", index], (Unit::Newton, Range::Finite, Role::Load));
            let description = ["Constant force at ", name, ", ", axis, ", mechanism frame"];
            visit(Parameter::new([name, ".force_", axis], key, description, kind), value);
        }
    }
}

impl Torque {
    pub(super) fn parameters(&mut self, name: &str, visit: &mut Visit) {
        let (key, kind) = (["torques.", name, ".torque"], (Unit::NewtonMetre, Range::Finite, Role::Load));
        visit(Parameter::new([name, ".torque"], key, ["Constant torque on ", &self.on], kind), &mut self.torque);
    }
}

impl Spring {
    pub(super) fn parameters(&mut self, name: &str, is_rotary: bool, visit: &mut Visit) {
        let [stiffness, damping, force] = if is_rotary {
            [Unit::NewtonMetrePerRadian, Unit::NewtonMetreSecondPerRadian, Unit::NewtonMetre]
        } else {
            [Unit::NewtonPerMetre, Unit::NewtonSecondPerMetre, Unit::Newton]
        };
        // A distance is not negative, a position along an axis may be.
        let length = if self.joint.is_none() { Range::NonNegative } else { Range::Finite };
        let mut list = Owner::new(Some("springs"), name, Role::Load, visit);
        list.add("stiffness", "Stiffness", stiffness, Range::NonNegative, &mut self.stiffness);
        list.add("damping", "Damping", damping, Range::NonNegative, &mut self.damping);
        list.add("free_length", "Free length", Unit::Metre, length, &mut self.free_length);
        list.add("free_angle", "Free angle", Unit::Radian, Range::Finite, &mut self.free_angle);
        list.add("preload", "Preload", force, Range::Finite, &mut self.preload);
        if let Some(gas) = &mut self.gas {
            list.add(
                "gas.pressure",
                "Absolute gas pressure at the free length",
                Unit::Pascal,
                Range::Positive,
                &mut gas.pressure,
            );
            list.add("gas.area", "Area on which the gas acts", Unit::SquareMetre, Range::Positive, &mut gas.area);
            list.add("gas.volume", "Gas volume at the free length", Unit::CubicMetre, Range::Positive, &mut gas.volume);
            list.add("gas.exponent", "Polytropic exponent of the gas", Unit::One, Range::Polytropic, &mut gas.exponent);
            list.add("gas.ambient", "Absolute ambient pressure", Unit::Pascal, Range::NonNegative, &mut gas.ambient);
        }
    }
}

impl Air {
    pub(super) fn parameters(&mut self, visit: &mut Visit) {
        let mut list = Owner::new(None, "air", Role::Load, visit);
        let (unit, words) = (Unit::KilogramPerCubicMetre, "Direction in which the air flows, angle from the X axis");
        list.role = Role::Law;
        list.add("density", "Mass density of the air", unit, Range::NonNegative, &mut self.density);
        list.role = Role::Load;
        list.add("flow_angle", words, Unit::Radian, Range::Finite, &mut self.flow_angle);
    }

    pub(super) fn flags(&mut self, visit: &mut dyn FnMut(Flag, &mut bool)) {
        let text = "Whether the motion of the surfaces counts for the speed of the air that meets them";
        visit(Flag::new("air", "relative_wind", [text]), &mut self.relative_wind);
    }
}

impl Surface {
    pub(super) fn parameters(&mut self, name: &str, visit: &mut Visit) {
        let mut list = Owner::new(Some("surfaces"), name, Role::Load, visit);
        list.add("width", "Width of the surface", Unit::Metre, Range::NonNegative, &mut self.width);
        list.add("area", "Area", Unit::SquareMetre, Range::NonNegative, &mut self.area);
        list.add("surface_angle", "Angle of the flat area", Unit::Radian, Range::Finite, &mut self.surface_angle);
        let coefficient = &mut self.drag_coefficient;
        list.role = Role::Law;
        list.add("drag_coefficient", "Drag coefficient", Unit::One, Range::NonNegative, coefficient);
    }
}
