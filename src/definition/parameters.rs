//! Every number of a definition that is a parameter of the FMU, listed once.
use super::{Body, GROUND, JointKind, Mechanism};
use crate::variables::Unit;

/// What a parameter may be; always finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    /// Any finite number.
    Finite,
    /// >= 0.
    NonNegative,
    /// > 0.
    Positive,
    /// A length: > 0, and so that its square is a number.
    Length,
    /// A coordinate: of any sign, and so that its square is a number.
    Coordinate,
    /// > 0 and <= 1.
    Fraction,
    /// From 0 to 1.
    Unit,
    /// From the first to the second.
    Between(f64, f64),
}

/// Largest length [m].
const FARTHEST: f64 = 1e100;

impl Range {
    /// Whether the value is in the range.
    pub fn contains(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Finite => true,
                Self::NonNegative => value >= 0.0,
                Self::Positive => value > 0.0,
                Self::Length => value > 0.0 && value <= FARTHEST,
                Self::Coordinate => value.abs() <= FARTHEST,
                Self::Fraction => value > 0.0 && value <= 1.0,
                Self::Unit => (0.0..=1.0).contains(&value),
                Self::Between(low, high) => (low..=high).contains(&value),
            }
    }

    /// The range in words.
    pub fn text(self) -> String {
        match self {
            Self::Finite => "a finite number".into(),
            Self::NonNegative => "a finite number >= 0".into(),
            Self::Positive => "a finite number > 0".into(),
            Self::Length => format!("a number > 0 and <= {FARTHEST:e}"),
            Self::Coordinate => format!("a number from -{FARTHEST:e} to {FARTHEST:e}"),
            Self::Fraction => "a number > 0 and <= 1".into(),
            Self::Unit => "a number from 0 to 1".into(),
            Self::Between(low, high) => format!("a number from {low:e} to {high:e}"),
        }
    }
}

/// What is known of a parameter besides its value.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Variable name, `<body>.<quantity>`.
    pub name: String,
    /// Path of the key in the file.
    pub key: String,
    /// One line of text.
    pub description: String,
    /// Unit.
    pub unit: Unit,
    /// What it may be.
    pub range: Range,
    /// What it changes.
    pub role: Role,
}

/// What a parameter changes: the positions, the masses, the start or the integration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The shape of the linkage.
    Geometry,
    /// Masses and moments of inertia.
    Inertia,
    /// The potential of a load.
    Load,
    /// The position at the start.
    StartPosition,
    /// The speed at the start.
    StartSpeed,
    /// The stretch of bodies as rods.
    Elasticity,
    /// The tolerance or the step of the integration.
    Tolerance,
}

/// Limits of solver.tolerance: below, rounding takes over; above, the error estimate means nothing.
const TOLERANCE: Range = Range::Between(1e-14, 1e-1);

impl Mechanism {
    /// Call `visit` with every parameter and its value, in the order of the file.
    pub fn parameters(&mut self, visit: &mut dyn FnMut(Parameter, &mut f64)) {
        use Role::{Elasticity, Geometry, Inertia, Load, StartPosition, StartSpeed, Tolerance};
        let make = |name: String, key: String, text: String, unit, range, role| Parameter {
            name,
            key,
            description: text,
            unit,
            range,
            role,
        };
        if let Some(g) = &mut self.gravity {
            let p = |n: &str, text: &str, unit, range| {
                make(format!("gravity.{n}"), format!("gravity.{n}"), text.into(), unit, range, Load)
            };
            let unit = Unit::MetrePerSecondSquared;
            visit(p("acceleration", "Acceleration of free fall", unit, Range::NonNegative), &mut g.acceleration);
            visit(
                p("up_angle", "Upward direction, angle from the X axis", Unit::Radian, Range::Finite),
                &mut g.up_angle,
            );
        }
        for (name, body) in self.bodies.iter_mut() {
            let p = |n: &str, key: &str, text: &str, unit, range, role| {
                let text = format!("{text} of {name}");
                make(format!("{name}.{n}"), format!("bodies.{name}.{key}"), text, unit, range, role)
            };
            let Body { angle, length, mass, center, inertia, axial_stiffness, points, .. } = body;
            if let Some(v) = angle {
                visit(p("angle", "angle", "Angle of the x axis", Unit::Radian, Range::Finite, Geometry), v);
            }
            if let Some(v) = length {
                visit(p("length", "length", "Length", Unit::Metre, Range::Length, Geometry), v);
            }
            if name != GROUND {
                if let Some(v) = mass {
                    visit(p("mass", "mass", "Mass", Unit::Kilogram, Range::NonNegative, Inertia), v);
                }
                if let Some([x, y]) = center {
                    visit(p("center_x", "center[0]", "Centre of mass, x,", Unit::Metre, Range::Coordinate, Inertia), x);
                    visit(p("center_y", "center[1]", "Centre of mass, y,", Unit::Metre, Range::Coordinate, Inertia), y);
                }
                if let Some(v) = inertia {
                    let text = "Moment of inertia about the centre of mass";
                    visit(p("inertia", "inertia", text, Unit::KilogramSquareMetre, Range::NonNegative, Inertia), v);
                }
                if let Some(v) = axial_stiffness {
                    let (n, text) = ("axial_stiffness", "Axial stiffness E A");
                    visit(p(n, n, text, Unit::Newton, Range::Positive, Elasticity), v);
                }
            }
            for (point, [x, y]) in points.iter_mut() {
                let p = |axis: &str, index: usize| {
                    let text = format!("Point {point}, {axis},");
                    let key = format!("points.{point}[{index}]");
                    p(&format!("{point}_{axis}"), &key, &text, Unit::Metre, Range::Coordinate, Geometry)
                };
                visit(p("x", 0), x);
                visit(p("y", 1), y);
            }
        }
        for (name, joint) in self.joints.iter_mut() {
            let p = |n: &str, text: &str| {
                let text = format!("{text} of {name}");
                make(format!("{name}.{n}"), format!("joints.{name}.{n}"), text, Unit::Radian, Range::Finite, Geometry)
            };
            if let Some(v) = &mut joint.axis_angle {
                visit(p("axis_angle", "Direction of sliding"), v);
            }
            if let Some(v) = &mut joint.angle {
                visit(p("angle", "Angle between the bodies"), v);
            }
            let p = |n: &str, text: &str, unit| {
                let text = format!("{text} of {name}");
                let (n, key) = (format!("{name}.{n}"), format!("joints.{name}.{n}"));
                make(n, key, text, unit, Range::NonNegative, Load)
            };
            if let Some(v) = &mut joint.pin_radius {
                visit(p("pin_radius", "Radius of the pin", Unit::Metre), v);
            }
            if let Some(v) = &mut joint.static_coefficient {
                visit(p("static_coefficient", "Coefficient of static friction", Unit::One), v);
            }
            if let Some(v) = &mut joint.kinetic_coefficient {
                visit(p("kinetic_coefficient", "Coefficient of kinetic friction", Unit::One), v);
            }
        }
        for (name, actuator) in self.actuators.iter_mut() {
            if let Some(v) = &mut actuator.efficiency {
                let key = format!("actuators.{name}.efficiency");
                let range = Range::Fraction;
                visit(
                    make(format!("{name}.efficiency"), key, format!("Efficiency of {name}"), Unit::One, range, Load),
                    v,
                );
            }
        }
        for (name, force) in self.forces.iter_mut().filter(|(_, f)| f.constant) {
            for (i, (axis, v)) in ["x", "y"].into_iter().zip(&mut force.force).enumerate() {
                let (n, key) = (format!("{name}.force_{axis}"), format!("forces.{name}.force[{i}]"));
                let text = format!("Constant force at {name}, {axis}, mechanism frame");
                visit(make(n, key, text, Unit::Newton, Range::Finite, Load), v);
            }
        }
        for (name, torque) in self.torques.iter_mut().filter(|(_, t)| t.constant) {
            let text = format!("Constant torque on {}", torque.on);
            let (n, key) = (format!("{name}.torque"), format!("torques.{name}.torque"));
            visit(make(n, key, text, Unit::NewtonMetre, Range::Finite, Load), &mut torque.torque);
        }
        let revolute: Vec<String> =
            self.joints.iter().filter(|(_, j)| j.kind == JointKind::Revolute).map(|(n, _)| n.to_string()).collect();
        for (name, spring) in self.springs.iter_mut() {
            let turns = spring.joint.as_ref().is_some_and(|j| revolute.contains(j));
            let p = |n: &str, text: &str, linear: Unit, rotary: Unit, range| {
                let unit = if turns { rotary } else { linear };
                make(
                    format!("{name}.{n}"),
                    format!("springs.{name}.{n}"),
                    format!("{text} of {name}"),
                    unit,
                    range,
                    Load,
                )
            };
            let (k, range) = ("Stiffness", Range::NonNegative);
            visit(p("stiffness", k, Unit::NewtonPerMetre, Unit::NewtonMetrePerRadian, range), &mut spring.stiffness);
            if let Some(v) = &mut spring.damping {
                let (linear, rotary) = (Unit::NewtonSecondPerMetre, Unit::NewtonMetreSecondPerRadian);
                visit(p("damping", "Damping", linear, rotary, range), v);
            }
            if let Some(v) = &mut spring.free_length {
                // A distance is not negative, a position along an axis may be.
                let range = if spring.joint.is_none() { Range::NonNegative } else { Range::Finite };
                visit(p("free_length", "Free length", Unit::Metre, Unit::Metre, range), v);
            }
            if let Some(v) = &mut spring.free_angle {
                visit(p("free_angle", "Free angle", Unit::Radian, Unit::Radian, Range::Finite), v);
            }
            if let Some(v) = &mut spring.preload {
                visit(p("preload", "Preload", Unit::Newton, Unit::NewtonMetre, Range::Finite), v);
            }
        }
        if let Some(f) = &mut self.friction {
            let p = |n: &str, text: &str, unit, range| {
                make(format!("friction.{n}"), format!("friction.{n}"), text.into(), unit, range, Load)
            };
            let (one, speed) = (Unit::One, Unit::MetrePerSecond);
            let (not_less, more) = (Range::NonNegative, Range::Positive);
            let text = "Coefficient of static friction";
            visit(p("static_coefficient", text, one, not_less), &mut f.static_coefficient);
            let text = "Coefficient of kinetic friction";
            visit(p("kinetic_coefficient", text, one, not_less), &mut f.kinetic_coefficient);
            visit(p("static_speed", "Slip speed at which friction is static", speed, more), &mut f.static_speed);
            visit(p("kinetic_speed", "Slip speed from which friction is kinetic", speed, more), &mut f.kinetic_speed);
        }
        if let Some(air) = &mut self.air {
            let p = |n: &str, text: &str, unit, range| {
                make(format!("air.{n}"), format!("air.{n}"), text.into(), unit, range, Load)
            };
            let unit = Unit::KilogramPerCubicMetre;
            visit(p("density", "Mass density of the air", unit, Range::NonNegative), &mut air.density);
            let text = "Direction in which the air flows, angle from the X axis";
            visit(p("flow_angle", text, Unit::Radian, Range::Finite), &mut air.flow_angle);
        }
        for (name, surface) in self.surfaces.iter_mut() {
            let p = |n: &str, text: &str, unit, range| {
                let (key, text) = (format!("surfaces.{name}.{n}"), format!("{text} of {name}"));
                make(format!("{name}.{n}"), key, text, unit, range, Load)
            };
            if let Some(v) = &mut surface.width {
                visit(p("width", "Width of the surface", Unit::Metre, Range::NonNegative), v);
            }
            if let Some(v) = &mut surface.area {
                visit(p("area", "Area", Unit::SquareMetre, Range::NonNegative), v);
            }
            if let Some(v) = &mut surface.surface_angle {
                visit(p("surface_angle", "Angle of the flat area", Unit::Radian, Range::Finite), v);
            }
            let unit = Unit::One;
            visit(p("drag_coefficient", "Drag coefficient", unit, Range::NonNegative), &mut surface.drag_coefficient);
        }
        for (name, stop) in self.stops.iter_mut() {
            let p = |n: &str, text: &str, unit, range| {
                let (key, text) = (format!("stops.{name}.{n}"), format!("{text} of {name}"));
                make(format!("{name}.{n}"), key, text, unit, range, Load)
            };
            let turns = stop.angle.is_some();
            if let Some(v) = &mut stop.angle {
                visit(p("angle", "Angle", Unit::Radian, Range::Finite), v);
            }
            if let Some(v) = &mut stop.position {
                visit(p("position", "Position", Unit::Metre, Range::Finite), v);
            }
            if let Some(v) = &mut stop.length {
                visit(p("length", "Distance of the points", Unit::Metre, Range::NonNegative), v);
            }
            let unit = if turns { Unit::NewtonMetrePerRadian } else { Unit::NewtonPerMetre };
            visit(p("restitution", "Restitution", Unit::One, Range::Unit), &mut stop.restitution);
            visit(p("stiffness", "Stiffness as a bumper", unit, Range::NonNegative), &mut stop.stiffness);
            let unit = if turns { Unit::NewtonMetreSecondPerRadian } else { Unit::NewtonSecondPerMetre };
            visit(p("damping", "Damping as a bumper", unit, Range::NonNegative), &mut stop.damping);
        }
        let start = &mut self.start;
        let stated = match (&start.body, &mut start.angle, &start.joint, &mut start.position) {
            (Some(body), Some(v), ..) => Some((body, v, "angle", Unit::Radian, Unit::RadianPerSecond)),
            (.., Some(joint), Some(v)) => Some((joint, v, "position", Unit::Metre, Unit::MetrePerSecond)),
            _ => None,
        };
        if let Some((name, value, quantity, unit, speed_unit)) = stated {
            let p = |n: &str, unit, role| {
                let (key, text) = (format!("start.{n}"), format!("Start {n} of {name}"));
                make(format!("{name}.start_{n}"), key, text, unit, Range::Finite, role)
            };
            visit(p(quantity, unit, StartPosition), value);
            visit(p("speed", speed_unit, StartSpeed), &mut start.speed);
        }
        visit(
            make(
                "solver.tolerance".into(),
                "solver.tolerance".into(),
                "Relative tolerance of the integration".into(),
                Unit::One,
                TOLERANCE,
                Tolerance,
            ),
            &mut self.solver.tolerance,
        );
        if let Some(v) = self.solver.method.and(self.solver.fem_step.as_mut()) {
            let (n, text) = ("solver.fem_step", "Largest step of the rigid finite elements");
            visit(make(n.into(), n.into(), text.into(), Unit::Second, Range::Positive, Tolerance), v);
        }
    }

    /// Call `visit` with every Boolean parameter: its name, what it says, and its value.
    pub fn flags(&mut self, visit: &mut dyn FnMut(String, String, &mut bool)) {
        if let Some(f) = &mut self.friction {
            visit("friction.enabled".into(), "Whether the joints have friction".into(), &mut f.enabled);
        }
        if let Some(air) = &mut self.air {
            let text = "Whether the motion of the surfaces counts for the speed of the air that meets them";
            visit("air.relative_wind".into(), text.into(), &mut air.relative_wind);
        }
        for (name, stop) in self.stops.iter_mut() {
            visit(format!("{name}.enabled"), format!("Whether {name} is there"), &mut stop.enabled);
            let text = format!("Whether {name} is rigid; else it is a spring and damper that only pushes");
            visit(format!("{name}.rigid"), text, &mut stop.rigid);
        }
    }
}
