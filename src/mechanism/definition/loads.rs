//! Loads: gravity, drives, forces, torques, springs and drag.
use super::between::Between;
use super::control::Control;
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
    /// The object `gravity` describes uniform gravity. The weight of a mass m is m * load_factor * acceleration.
    /// Weights act against the upward direction `up_angle`. The load factor is the input `load_factor`.
    pub struct Gravity {
        /// Acceleration of free fall [m/s2], >= 0.
        acceleration: f64 => number(MetrePerSecondSquared, Range::Size)
            .parameter(Role::Load, "Acceleration of free fall").required();
        /// Upward direction, as an angle from the X axis of the mechanism frame [rad].
        up_angle: f64 => number(Radian, Range::Finite)
            .parameter(Role::Load, "Upward direction, as an angle from the X axis of the mechanism frame").required();
        /// Start value of the input `load_factor`, by which all weights are multiplied [1].
        load_factor: f64 = 1.0 => number(One, Range::Finite);
    }

    /// A drive (actuator) exerts a force along the line between two points, a force or torque in a joint, or a torque
    /// between two bodies. A positive drive force between two points pushes the points apart. A positive drive force in
    /// a prismatic joint moves the joint's second body along the axis. A positive drive torque in a revolute joint
    /// turns the joint's second body anticlockwise, relative to its first body. A positive drive torque between two
    /// bodies turns the body `second_body` anticlockwise, relative to the body `first_body`.
    pub struct Actuator {
        /// Point (`body.point`) at the first end of the drive.
        first: Option<String> => point();
        /// Point (`body.point`) at the second end of the drive.
        second: Option<String> => point();
        /// Joint in which the drive acts, in place of the keys `first` and `second`.
        joint: Option<String> => element();
        /// First of the two bodies between which the drive exerts a torque. The bodies `first_body` and `second_body`
        /// need no common joint.
        first_body: Option<String> => element();
        /// Second of the two bodies between which the drive exerts a torque. The angle of the drive is the angle of
        /// `second_body` relative to `first_body`.
        second_body: Option<String> => element();
        /// Start value of the input `<name>.force`, the force that the drive exerts [N]. The key `force` is not
        /// allowed in a revolute joint, between two bodies or together with `screw`.
        force: Option<f64> => number(Newton, Range::Finite).absent("0");
        /// Start value of the input `<name>.torque`, the torque that the drive (or the motor of its screw) exerts
        /// [N.m]. The key `torque` is allowed only in a revolute joint, between two bodies or together with `screw`.
        torque: Option<f64> => number(NewtonMetre, Range::Finite).absent("0");
        /// Efficiency eta of the drive [1], > 0 and <= 1: the fraction of the power that is not lost. Without the key
        /// `backward_efficiency`, the efficiency of the drive is equal in both directions of the power flow ([CK16] eq.
        /// (5)).
        efficiency: Option<f64> => number(One, Range::Fraction).parameter(Role::Load, "Efficiency").absent("1");
        /// Efficiency of the drive for the power flow from the mechanism to the drive [1], 0 to 1. Default: the value
        /// of the key `efficiency`. The value 0 is allowed only for a drive with a `screw` that has an `inertia`: the
        /// screw locks itself, so that no load on the nut turns the screw.
        backward_efficiency: Option<f64> => number(One, Range::Unit)
            .parameter(Role::Load, "Efficiency of @ for the power flow from the mechanism to the drive");
        /// true: the drive has outputs for each moving body ([CK16] conclusion 3). These are the share of the body in
        /// the reduced mass and in the static load of the drive, and the ratios between the speeds of drive and body.
        by_body: bool => Key::PLAIN.brief();
        /// Force-speed curve: additional drive force as a function of the speed of the drive [m/s or rad/s, N or N.m].
        /// The input `<name>.command` is a factor of the force of the curve `points`. The list `points` contains pairs
        /// of speed and force in the order of increasing speed. Beyond the first and the last pair, the force-speed
        /// curve is a straight line. The key `points` is not allowed together with `hydraulics` or `motion`.
        points: Option<Vec<[f64; 2]>> => curve([MetrePerSecond, RadianPerSecond], [Newton, NewtonMetre],
            Range::Coordinate).brief();
        /// Start value of the input `<name>.command`, the factor of the force of the curve `points` [1]. The key
        /// `command` is allowed only together with `points`.
        command: Option<f64> => number(One, Range::Finite).absent("1").brief();
        /// Screw that converts the rotation of a motor into the stroke of the drive. The input of a drive with a screw
        /// is the torque of the motor that turns the screw. The key `screw` is not allowed in a revolute joint or
        /// between two bodies.
        screw: Option<Screw> => Key::PLAIN.brief();
        /// Controller of the drive, with gains for position and speed and with limits of the force. The key `control`
        /// is not allowed together with `points`, `hydraulics` or `motion`.
        control: Option<Control> => Key::PLAIN.brief();
        /// Hydraulic circuit that drives the actuator. The force of a drive with a circuit is an output. At most one
        /// drive can have a hydraulic circuit. A drive whose motion is an angle cannot have a hydraulic circuit.
        hydraulics: Option<Circuit> => Key::PLAIN.brief();
        /// Prescribed motion of the drive. The force of a drive with prescribed motion is an output. At most one drive
        /// can have a prescribed motion. The key `motion` is not allowed together with `hydraulics`.
        motion: Option<PrescribedMotion> => Key::PLAIN.brief();
    }

    /// A screw with nut acts along the line of a drive. When the screw turns by the angle phi, the stroke of the drive
    /// changes by lead * phi / (2 pi).
    pub struct Screw: Copy {
        /// Lead of the screw: stroke of the drive for one revolution of the screw [m], > 0.
        lead: f64 => number(Metre, Range::Length).parameter(Role::Geometry, "Lead of the screw").required();
        /// Moment of inertia of screw and motor about the screw axis [kg.m2], >= 0.
        inertia: Option<f64> => number(KilogramSquareMetre, Range::NonNegative)
            .parameter(Role::Geometry, "Moment of inertia of screw and motor").absent("0");
    }

    /// An external force acts on a point of a body, with components in the mechanism frame.
    pub struct Force {
        /// Point (`body.point`) on which the force acts.
        at: String => point().required();
        /// Components of the force [N]: start values of the variables `<name>.force_x` and `<name>.force_y`.
        force: [f64; 2] => number(Newton, Range::Finite).parameter(Role::Load, "Constant force");
        /// true: the components of the force are parameters. false: the components are inputs.
        constant: bool;
    }

    /// An external torque acts on a body.
    pub struct Torque {
        /// Body on which the torque acts.
        on: String => element().required();
        /// Start value of the variable `<name>.torque`, the external torque [N.m].
        torque: f64 => number(NewtonMetre, Range::Finite).parameter(Role::Load, "Constant torque");
        /// true: the torque is a parameter. false: the torque is an input.
        constant: bool;
    }

    /// A spring can combine a linear spring, a damper, force curves and a gas filling. A spring between two points
    /// pulls the points together with the force preload + stiffness * (length - free_length) + damping * d(length)/dt.
    /// For a spring in a prismatic joint, the position of the joint replaces the length, and a positive force moves the
    /// second body against the direction of the axis. For a spring in a revolute joint or between two bodies, the
    /// torque preload + stiffness * (angle - free_angle) + damping * d(angle)/dt turns the second body clockwise. The
    /// angle of the spring is the angle of the second body relative to the first body. The spring force also includes
    /// the forces of the keys `points`, `damping_points` and `gas`.
    pub struct Spring {
        /// Point (`body.point`) at the first end of the spring.
        first: Option<String> => point();
        /// Point (`body.point`) at the second end of the spring.
        second: Option<String> => point();
        /// Joint in which the spring acts, in place of the keys `first` and `second`.
        joint: Option<String> => element();
        /// First of the two bodies between which the spring exerts a torque. The bodies `first_body` and `second_body`
        /// need no common joint.
        first_body: Option<String> => element();
        /// Second of the two bodies between which the spring exerts a torque. The angle of the spring is the angle of
        /// `second_body` relative to `first_body`.
        second_body: Option<String> => element();
        /// Stiffness of the linear spring [N/m or N.m/rad], >= 0.
        stiffness: f64 => either([NewtonPerMetre, NewtonMetrePerRadian], Range::NonNegative)
            .parameter(Role::Load, "Stiffness");
        /// Damping coefficient of the linear damper [N.s/m or N.m.s/rad], >= 0.
        damping: Option<f64> => either([NewtonSecondPerMetre, NewtonMetreSecondPerRadian], Range::NonNegative)
            .parameter(Role::Load, "Damping coefficient").absent("0");
        /// Length of the spring at which the force of the linear spring equals `preload` [m]. For a spring between two
        /// points `free_length` must be >= 0.
        free_length: Option<f64> => number(Metre, Range::Finite).parameter(Role::Load, "Free length").absent("0");
        /// Angle of the spring at which the torque of the linear spring equals `preload` [rad]. The key `free_angle` is
        /// allowed only in a revolute joint or between two bodies.
        free_angle: Option<f64> => number(Radian, Range::Finite).parameter(Role::Load, "Free angle").absent("0");
        /// Force or torque of the linear spring at its free length or free angle [N or N.m]. A positive preload force
        /// pulls the ends of the spring together. A positive preload torque turns the second body of the spring
        /// clockwise, relative to the first body.
        preload: Option<f64> => either([Newton, NewtonMetre], Range::Finite).parameter(Role::Load,
            "Preload (force at the free length, or torque at the free angle)").absent("0");
        /// Additional pulling force of the spring as a curve over the length, position or angle of the spring [m or
        /// rad, N or N.m]. The list `points` contains pairs of length and force in the order of increasing length.
        /// Beyond the first and the last pair, the force curve is a straight line.
        points: Option<Vec<[f64; 2]>> => curve([Metre, Radian], [Newton, NewtonMetre], Range::Coordinate);
        /// Additional damping force of the spring as a curve over the speed of extension or rotation. The list
        /// `damping_points` contains pairs of speed and pulling force [m/s or rad/s, N or N.m] in the order of
        /// increasing speed. The damping curve must pass through [0, 0], and each force must have the sign of its
        /// speed. Beyond the first and the last pair, the damping curve is a straight line.
        damping_points: Option<Vec<[f64; 2]>> =>
            curve([MetrePerSecond, RadianPerSecond], [Newton, NewtonMetre], Range::Coordinate).brief();
        /// Gas filling of a gas spring. The key `gas` is allowed only for a spring between two points or in a prismatic
        /// joint.
        gas: Option<Gas>;
    }

    /// The object `gas` describes the gas filling of a gas spring. The gas volume is V = volume + area * (length -
    /// free_length). The absolute gas pressure is p = pressure * (volume / V)^exponent, where V is the gas volume. The
    /// spring force includes the pulling force of the gas, (ambient - p) * area, where p is the gas pressure.
    pub struct Gas: Copy {
        /// Absolute pressure of the gas at the free length [Pa], > 0.
        pressure: f64 => number(Pascal, Range::Positive)
            .parameter(Role::Load, "Absolute gas pressure at the free length").required();
        /// Area on which the gas pressure acts [m2], > 0. If the gas is on both sides of the piston, `area` is the
        /// cross section of the rod.
        area: f64 => number(SquareMetre, Range::Positive)
            .parameter(Role::Load, "Area on which the pressure of the gas filling @ acts").required();
        /// Gas volume at the free length [m3], > 0.
        volume: f64 => number(CubicMetre, Range::Positive)
            .parameter(Role::Load, "Gas volume at the free length").required();
        /// Polytropic exponent of the gas [1], from 1 to 2. Use the exponent 1 for slow (isothermal) motion, and 1.4
        /// for fast motion with nitrogen.
        exponent: f64 => number(One, Range::Polytropic).parameter(Role::Load, "Polytropic exponent of the \
            gas").required();
        /// Absolute pressure of the air around the spring [Pa], >= 0. Default: the pressure of the standard atmosphere,
        /// 101325 Pa.
        ambient: f64 = 101_325.0 => number(Pascal, Range::NonNegative).parameter(Role::Load, "Absolute pressure of the \
            air around the gas");
    }

    /// The object `air` describes a uniform air flow past the mechanism. The speed of the flow is the input
    /// `airspeed`.
    pub struct Air: Copy {
        /// Density of the air [kg/m3], >= 0.
        density: f64 => number(KilogramPerCubicMetre, Range::NonNegative)
            .parameter(Role::Law, "Density of the air").required();
        /// Direction in which the air flows, as an angle from the X axis of the mechanism frame [rad].
        flow_angle: f64 => number(Radian, Range::Finite)
            .parameter(Role::Load, "Direction of the air flow, as an angle from the X axis of the mechanism \
                frame").required();
        /// true: the drag of a surface depends on the air velocity relative to the moving surface. false: the motion of
        /// the surface has no effect on its drag.
        relative_wind: bool => Key::PLAIN.parameter(
            Role::Load,
            "true: drag depends on the air velocity relative to the moving surface; false: drag depends on the \
             airspeed only",
        );
        /// Start value of the input `airspeed`, the speed of the air flow [m/s].
        airspeed: f64 => number(MetrePerSecond, Range::Finite);
    }

    /// The air exerts drag on a surface: a strip between two points of one body, or an area at a point. The drag is
    /// 1/2 * density * c * S * |u| * u [N] ([HF08] eq. (1)). In the drag formula, c is the drag coefficient and u is
    /// the air velocity relative to the surface [m/s]. The projected area S of the surface is perpendicular to the air
    /// velocity u [m2].
    pub struct Surface {
        /// Point (`body.point`) at the first end of a strip.
        from: Option<String> => point();
        /// Point (`body.point`) at the second end of a strip, on the same body.
        to: Option<String> => point();
        /// Width of a strip [m], >= 0.
        width: Option<f64> => number(Metre, Range::NonNegative).parameter(Role::Load, "Width of @");
        /// Point (`body.point`) at which the drag of an area acts.
        at: Option<String> => point();
        /// Area of a surface that has the key `at` [m2], >= 0.
        area: Option<f64> => number(SquareMetre, Range::NonNegative).parameter(Role::Load, "Area of @");
        /// Direction of the plane of a flat area, as an angle in the frame of the body [rad]. Without the key
        /// `surface_angle`, the projected area of the surface is equal in all directions of the flow.
        surface_angle: Option<f64> => number(Radian, Range::Finite).parameter(Role::Load, "Direction of the plane of \
            @, as an angle in the frame of the body");
        /// Drag coefficient c of the surface [1], >= 0.
        drag_coefficient: f64 => number(One, Range::NonNegative)
            .parameter(Role::Law, "Drag coefficient of @").required();
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
        Owner { group: None, kind: "", name: "gravity", is_rotary: false }.parameters(self, &Some, visit);
    }
}

impl Actuator {
    /// Where the drive acts; None if the keys do not state one place.
    pub fn between(&self) -> Option<Between<'_>> {
        Between::of([&self.first, &self.second], &self.joint, [&self.first_body, &self.second_body])
    }

    /// Whether it has a screw that no load turns.
    pub fn locks_itself(&self) -> bool {
        self.backward_efficiency == Some(0.0)
    }

    /// Start value of the command of the drive's curve [1].
    pub fn command(&self) -> f64 {
        self.command.unwrap_or(1.0)
    }

    pub(super) fn parameters(&mut self, name: &str, is_rotary: bool, visit: &mut Visit) {
        let motion = self.motion.clone();
        let refined = |key: Key| motion.as_ref().map_or(key, |motion| motion.refined(key));
        let own = |key: Key| (key.name != "hydraulics").then(|| refined(key));
        Owner { group: Some("actuators"), kind: "the drive ", name, is_rotary }.parameters(self, &own, visit);
        self.hydraulics.iter_mut().for_each(|circuit| circuit.parameters(visit));
    }
}

impl Force {
    pub(super) fn parameters(&mut self, name: &str, visit: &mut Visit) {
        for ((axis, index), value) in AXES.into_iter().zip(&mut self.force) {
            let (key, kind) = (["forces.", name, ".force", index], (Newton, Range::Finite, Role::Load));
            let description = [axis, " component of the constant force ", name, " in the mechanism frame"];
            visit(Parameter::new([name, ".force_", axis], key, description, kind), value);
        }
    }
}

impl Torque {
    pub(super) fn parameters(&mut self, name: &str, visit: &mut Visit) {
        let (key, kind) = (["torques.", name, ".torque"], (NewtonMetre, Range::Finite, Role::Load));
        visit(
            Parameter::new(
                [name, ".torque"],
                key,
                ["Constant torque ", name, " on the body ", &self.on, ", anticlockwise positive"],
                kind,
            ),
            &mut self.torque,
        );
    }
}

impl Spring {
    /// Where the spring acts; None if the keys do not state one place.
    pub fn between(&self) -> Option<Between<'_>> {
        Between::of([&self.first, &self.second], &self.joint, [&self.first_body, &self.second_body])
    }

    pub(super) fn parameters(&mut self, name: &str, is_rotary: bool, visit: &mut Visit) {
        // A distance is not negative, a position along an axis may be.
        let is_distance = matches!(self.between(), Some(Between::Points(_)));
        let refined = |key: Key| match is_distance && key.name == "free_length" {
            true => Some(Key { range: Range::NonNegative, ..key }),
            false => Some(key),
        };
        Owner { group: Some("springs"), kind: "the spring ", name, is_rotary }.parameters(self, &refined, visit);
    }
}

impl Air {
    pub(super) fn parameters(&mut self, visit: &mut Visit) {
        Owner { group: None, kind: "", name: "air", is_rotary: false }.parameters(self, &Some, visit);
    }

    pub(super) fn flags(&mut self, visit: &mut dyn FnMut(Flag, &mut bool)) {
        Owner { group: None, kind: "", name: "air", is_rotary: false }.flags(self, visit);
    }
}

impl Surface {
    pub(super) fn parameters(&mut self, name: &str, visit: &mut Visit) {
        Owner { group: Some("surfaces"), kind: "the surface ", name, is_rotary: false }.parameters(self, &Some, visit);
    }
}
