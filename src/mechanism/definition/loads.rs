//! Loads: gravity, drives, forces, torques, springs and drag.
use super::motion::PrescribedMotion;
use crate::format::{
    AXES, Flag, Key, Owner, Parameter, Range, Role, Visit, curve, either, element, keys, number, point,
};
use crate::hydraulics::definition::Circuit;
use crate::variables::Unit::{
    CubicMetre, KilogramPerCubicMetre, KilogramSquareMetre, Metre, MetrePerSecond, MetrePerSecondSquared, Newton,
    NewtonMetre, NewtonMetrePerRadian, NewtonMetreSecondPerRadian, NewtonPerMetre, NewtonSecondPerMetre, One, Pascal,
    Radian, RadianPerSecond, SquareMetre,
};
use std::f64::consts::TAU;

keys! {
    /// Uniform gravity: the acceleration load_factor * acceleration along -(cos up_angle, sin up_angle). Gives the
    /// input `load_factor`.
    pub struct Gravity {
        /// Acceleration of free fall [m/s2], >= 0.
        acceleration: f64 => number(MetrePerSecondSquared, Range::Size)
            .parameter(Role::Load, "Acceleration of free fall").required();
        /// Angle of the upward direction from the X axis [rad].
        up_angle: f64 => number(Radian, Range::Finite)
            .parameter(Role::Load, "Upward direction, angle from the X axis").required();
        /// Start value of the input `load_factor` [1].
        load_factor: f64 = 1.0 => number(One, Range::Finite);
    }

    /// A drive along the line between two points or in a joint. A positive force pushes the points apart; in a joint a
    /// positive force or torque moves the second body along the axis or anticlockwise.
    pub struct Actuator {
        /// One end (`body.point`).
        first: Option<String> => point();
        /// The other end (`body.point`).
        second: Option<String> => point();
        /// Joint, in place of the two ends.
        joint: Option<String> => element();
        /// Start value of the input `<name>.force` [N]; neither in a revolute joint nor with a screw.
        force: Option<f64> => number(Newton, Range::Finite).absent("0");
        /// Start value of the input `<name>.torque` [N.m]; in a revolute joint or with a screw.
        torque: Option<f64> => number(NewtonMetre, Range::Finite).absent("0");
        /// Efficiency eta [1], > 0 and <= 1 ([CK16] eq. (5)): part of the power that the drive passes on to the
        /// mechanism, and back from it.
        efficiency: Option<f64> => number(One, Range::Fraction).parameter(Role::Load, "Efficiency").absent("1");
        /// Curve of a further force over the speed of the drive, times the input `<name>.command`: pairs of speed and
        /// force [m/s or rad/s, N or N.m], speeds ascending; straight on beyond the first and the last. Not with
        /// `hydraulics` or `motion`.
        points: Option<Vec<[f64; 2]>> => curve([MetrePerSecond, RadianPerSecond], [Newton, NewtonMetre],
            Range::Coordinate).brief();
        /// Start value of the input `<name>.command` [1]; with `points` only.
        command: Option<f64> => number(One, Range::Finite).absent("1").brief();
        /// The screw through which a motor drives along the line, so that the drive is its rotation and has a torque;
        /// not in a revolute joint.
        screw: Option<Screw> => Key::PLAIN.brief();
        /// The hydraulic circuit that drives it, of one drive at most; not in a revolute joint. The force is then an
        /// output.
        hydraulics: Option<Circuit> => Key::PLAIN.brief();
        /// The motion of the drive, which can be prescribed, so that the force is what it takes; of one drive at most,
        /// and not with `hydraulics`.
        motion: Option<PrescribedMotion> => Key::PLAIN.brief();
    }

    /// A screw and nut along the line of a drive: with the angle phi of the screw the stroke is lead phi / (2 pi).
    pub struct Screw: Copy {
        /// Stroke for one revolution [m], > 0.
        lead: f64 => number(Metre, Range::Length).parameter(Role::Geometry, "Lead of the screw").required();
        /// Moment of inertia of the screw with its motor about its axis [kg.m2], >= 0.
        inertia: Option<f64> => number(KilogramSquareMetre, Range::NonNegative)
            .parameter(Role::Geometry, "Moment of inertia of the screw").absent("0");
    }

    /// A force at a point, in the mechanism frame.
    pub struct Force {
        /// Point of application (`body.point`).
        at: String => point().required();
        /// Components [N]: start values of `<name>.force_x` and `<name>.force_y`, parameters if `constant`, inputs
        /// else.
        force: [f64; 2] => number(Newton, Range::Finite).parameter(Role::Load, "Constant force");
        /// Whether the components are parameters; inputs else.
        constant: bool;
    }

    /// A torque on a body.
    pub struct Torque {
        /// Body on which the torque acts.
        on: String => element().required();
        /// Start value of `<name>.torque` [N.m], a parameter if `constant`, an input else.
        torque: f64 => number(NewtonMetre, Range::Finite).parameter(Role::Load, "Constant torque");
        /// Whether the torque is a parameter; an input else.
        constant: bool;
    }

    /// A spring and damper. Between two points the force preload + stiffness (length - free_length) + damping
    /// d(length)/dt pulls the points together; in a prismatic joint it pulls the second body back, with the joint's
    /// position as length. In a revolute joint the torque preload + stiffness (angle - free_angle) + damping
    /// d(angle)/dt turns the second body clockwise, where angle is the angle of the second body less the angle of the
    /// first. A characteristic, by points or of a gas, is added.
    pub struct Spring {
        /// One end (`body.point`).
        first: Option<String> => point();
        /// The other end (`body.point`).
        second: Option<String> => point();
        /// Joint, in place of the two ends.
        joint: Option<String> => element();
        /// Stiffness [N/m or N.m/rad], >= 0.
        stiffness: f64 => either([NewtonPerMetre, NewtonMetrePerRadian], Range::NonNegative)
            .parameter(Role::Load, "Stiffness");
        /// Damping [N.s/m or N.m.s/rad], >= 0.
        damping: Option<f64> => either([NewtonSecondPerMetre, NewtonMetreSecondPerRadian], Range::NonNegative)
            .parameter(Role::Load, "Damping").absent("0");
        /// Length without force but the preload [m]; between two points >= 0, or along a prismatic joint.
        free_length: Option<f64> => number(Metre, Range::Finite).parameter(Role::Load, "Free length").absent("0");
        /// Angle without torque but the preload [rad]; in a revolute joint only.
        free_angle: Option<f64> => number(Radian, Range::Finite).parameter(Role::Load, "Free angle").absent("0");
        /// Pull at the free length or angle [N or N.m].
        preload: Option<f64> => either([Newton, NewtonMetre], Range::Finite).parameter(Role::Load,
            "Preload").absent("0");
        /// Curve of a further pull: pairs of length, position or angle and pull [m or rad, N or N.m], ascending;
        /// straight on beyond the first and the last.
        points: Option<Vec<[f64; 2]>> => curve([Metre, Radian], [Newton, NewtonMetre], Range::Coordinate);
        /// Curve of a further pull over the speed of lengthening or turning: pairs of speed and pull
        /// [m/s or rad/s, N or N.m], ascending, with [0, 0], no pull against its speed; straight on beyond the first
        /// and the last.
        damping_points: Option<Vec<[f64; 2]>> =>
            curve([MetrePerSecond, RadianPerSecond], [Newton, NewtonMetre], Range::Coordinate).brief();
        /// Gas that the spring compresses; between two points, or along a prismatic joint.
        gas: Option<Gas>;
    }

    /// The gas of a gas spring: with the volume V = volume + area (length - free_length) its pressure is
    /// pressure (volume / V)^exponent, and the pull (ambient - pressure) area is added to the spring's.
    pub struct Gas: Copy {
        /// Absolute pressure at the free length [Pa], > 0.
        pressure: f64 => number(Pascal, Range::Positive)
            .parameter(Role::Load, "Absolute gas pressure at the free length").required();
        /// Area on which the gas acts [m2], > 0: the rod's cross section if gas is on both sides of the piston.
        area: f64 => number(SquareMetre, Range::Positive).parameter(Role::Load, "Area on which the gas \
            acts").required();
        /// Volume at the free length [m3], > 0.
        volume: f64 => number(CubicMetre, Range::Positive)
            .parameter(Role::Load, "Gas volume at the free length").required();
        /// Polytropic exponent [1], from 1 (slow, isothermal) to 2; 1.4 for fast changes of nitrogen.
        exponent: f64 => number(One, Range::Polytropic).parameter(Role::Load, "Polytropic exponent of the \
            gas").required();
        /// Absolute pressure around the spring [Pa], >= 0; the standard atmosphere where absent.
        ambient: f64 = 101_325.0 => number(Pascal, Range::NonNegative).parameter(Role::Load, "Absolute ambient \
            pressure");
    }

    /// Air in uniform flow. Gives the input `airspeed`.
    pub struct Air: Copy {
        /// Mass density [kg/m3], >= 0.
        density: f64 => number(KilogramPerCubicMetre, Range::NonNegative)
            .parameter(Role::Law, "Mass density of the air").required();
        /// Direction in which the air flows, angle from the X axis [rad].
        flow_angle: f64 => number(Radian, Range::Finite)
            .parameter(Role::Load, "Direction in which the air flows, angle from the X axis").required();
        /// Whether the motion of the surfaces counts for the speed of the air that meets them.
        relative_wind: bool => Key::PLAIN.parameter(
            Role::Load,
            "Whether the motion of the surfaces counts for the speed of the air that meets them",
        );
        /// Start value of the input `airspeed` [m/s].
        airspeed: f64 => number(MetrePerSecond, Range::Finite);
    }

    /// A surface with drag: a strip along the line between two points of one body, or an area at a point. The drag [N]
    /// is 1/2 density |u| u c S, with the air's velocity u [m/s] relative to the surface and the area S [m2] across u
    /// ([HF08] (1)).
    pub struct Surface {
        /// One end of a strip (`body.point`).
        from: Option<String> => point();
        /// The other end (`body.point`), on the same body.
        to: Option<String> => point();
        /// Width of a strip [m], >= 0.
        width: Option<f64> => number(Metre, Range::NonNegative).parameter(Role::Load, "Width of the surface");
        /// Point of an area (`body.point`).
        at: Option<String> => point();
        /// Area [m2], >= 0.
        area: Option<f64> => number(SquareMetre, Range::NonNegative).parameter(Role::Load, "Area");
        /// Angle of a flat area's plane in the body's frame [rad]; where absent, the area is the same from all sides.
        surface_angle: Option<f64> => number(Radian, Range::Finite).parameter(Role::Load, "Angle of the flat area");
        /// Drag coefficient c [1], >= 0.
        drag_coefficient: f64 => number(One, Range::NonNegative).parameter(Role::Law, "Drag coefficient").required();
    }
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

impl Gravity {
    pub(super) fn parameters(&mut self, visit: &mut Visit) {
        Owner { group: None, name: "gravity", is_rotary: false }.parameters(self, &Some, visit);
    }
}

impl Actuator {
    /// Start value of the command of the drive's curve [1].
    pub fn command(&self) -> f64 {
        self.command.unwrap_or(1.0)
    }

    pub(super) fn parameters(&mut self, name: &str, is_rotary: bool, visit: &mut Visit) {
        let own = |key: Key| (key.name != "hydraulics").then_some(key);
        Owner { group: Some("actuators"), name, is_rotary }.parameters(self, &own, visit);
        self.hydraulics.iter_mut().for_each(|circuit| circuit.parameters(visit));
    }
}

impl Force {
    pub(super) fn parameters(&mut self, name: &str, visit: &mut Visit) {
        for ((axis, index), value) in AXES.into_iter().zip(&mut self.force) {
            let (key, kind) = (["forces.", name, ".force", index], (Newton, Range::Finite, Role::Load));
            let description = ["Constant force at ", name, ", ", axis, ", mechanism frame"];
            visit(Parameter::new([name, ".force_", axis], key, description, kind), value);
        }
    }
}

impl Torque {
    pub(super) fn parameters(&mut self, name: &str, visit: &mut Visit) {
        let (key, kind) = (["torques.", name, ".torque"], (NewtonMetre, Range::Finite, Role::Load));
        visit(Parameter::new([name, ".torque"], key, ["Constant torque on ", &self.on], kind), &mut self.torque);
    }
}

impl Spring {
    pub(super) fn parameters(&mut self, name: &str, is_rotary: bool, visit: &mut Visit) {
        // A distance is not negative, a position along an axis may be.
        let is_distance = self.joint.is_none();
        let refined = |key: Key| match is_distance && key.name == "free_length" {
            true => Some(Key { range: Range::NonNegative, ..key }),
            false => Some(key),
        };
        Owner { group: Some("springs"), name, is_rotary }.parameters(self, &refined, visit);
    }
}

impl Air {
    pub(super) fn parameters(&mut self, visit: &mut Visit) {
        Owner { group: None, name: "air", is_rotary: false }.parameters(self, &Some, visit);
    }

    pub(super) fn flags(&mut self, visit: &mut dyn FnMut(Flag, &mut bool)) {
        Owner { group: None, name: "air", is_rotary: false }.flags(self, visit);
    }
}

impl Surface {
    pub(super) fn parameters(&mut self, name: &str, visit: &mut Visit) {
        Owner { group: Some("surfaces"), name, is_rotary: false }.parameters(self, &Some, visit);
    }
}
