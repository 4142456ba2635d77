//! Every number of a definition that is a parameter of the FMU, listed once.
use super::parameter::{Flag, Parameter, Place, Range, Role};
use super::{Body, GROUND, JointKind, Mechanism};
use crate::variables::Unit;

/// Limits of solver.tolerance: below, rounding takes over; above, the error estimate means nothing.
const TOLERANCE: Range = Range::Between(1e-14, 1e-1);

/// A number of a section that there is once.
fn of_section(
    section: &'static str,
    quantity: &'static str,
    words: &'static str,
    unit: Unit,
    range: Range,
    role: Role,
) -> Parameter<'static> {
    Parameter { place: Place::Section { section, quantity }, words, unit, range, role }
}

/// A named element: what its numbers are called.
#[derive(Clone, Copy)]
struct Element<'a> {
    group: &'static str,
    name: &'a str,
}

impl<'a> Element<'a> {
    fn part(self, quantity: &'static str, words: &'static str, unit: Unit, range: Range, role: Role) -> Parameter<'a> {
        self.keyed(quantity, quantity, words, (unit, range, role))
    }

    /// A number whose variable is called otherwise than its key.
    fn keyed(
        self,
        quantity: &'static str,
        key: &'static str,
        words: &'static str,
        (unit, range, role): (Unit, Range, Role),
    ) -> Parameter<'a> {
        let place = Place::Element { group: self.group, element: self.name, quantity, key };
        Parameter { place, words, unit, range, role }
    }
}

impl Mechanism {
    /// Call `visit` with every parameter and its value, in the order of the file.
    pub fn parameters(&mut self, visit: &mut dyn FnMut(Parameter, &mut f64)) {
        use Role::{Elasticity, Geometry, Inertia, Load, StartPosition, StartSpeed, Tolerance};
        if let Some(g) = &mut self.gravity {
            let p = |n, words, unit, range| of_section("gravity", n, words, unit, range, Load);
            let unit = Unit::MetrePerSecondSquared;
            visit(p("acceleration", "Acceleration of free fall", unit, Range::NonNegative), &mut g.acceleration);
            visit(
                p("up_angle", "Upward direction, angle from the X axis", Unit::Radian, Range::Finite),
                &mut g.up_angle,
            );
        }
        for (name, body) in self.bodies.iter_mut() {
            let e = Element { group: "bodies", name };
            let Body { angle, length, mass, center, inertia, axial_stiffness, points, .. } = body;
            if let Some(v) = angle {
                visit(e.part("angle", "Angle of the x axis", Unit::Radian, Range::Finite, Geometry), v);
            }
            if let Some(v) = length {
                visit(e.part("length", "Length", Unit::Metre, Range::Length, Geometry), v);
            }
            if name != GROUND {
                if let Some(v) = mass {
                    visit(e.part("mass", "Mass", Unit::Kilogram, Range::NonNegative, Inertia), v);
                }
                if let Some([x, y]) = center {
                    let kind = (Unit::Metre, Range::Coordinate, Inertia);
                    visit(e.keyed("center_x", "center[0]", "Centre of mass, x,", kind), x);
                    visit(e.keyed("center_y", "center[1]", "Centre of mass, y,", kind), y);
                }
                if let Some(v) = inertia {
                    let words = "Moment of inertia about the centre of mass";
                    visit(e.part("inertia", words, Unit::KilogramSquareMetre, Range::NonNegative, Inertia), v);
                }
                if let Some(v) = axial_stiffness {
                    let words = "Axial stiffness E A";
                    visit(e.part("axial_stiffness", words, Unit::Newton, Range::Positive, Elasticity), v);
                }
            }
            for (point, coordinates) in points.iter_mut() {
                for (axis, v) in coordinates.iter_mut().enumerate() {
                    let place = Place::Point { body: name, point, axis };
                    let (unit, range) = (Unit::Metre, Range::Coordinate);
                    visit(Parameter { place, words: "Point", unit, range, role: Geometry }, v);
                }
            }
        }
        for (name, joint) in self.joints.iter_mut() {
            let e = Element { group: "joints", name };
            let p = |n, words| e.part(n, words, Unit::Radian, Range::Finite, Geometry);
            if let Some(v) = &mut joint.axis_angle {
                visit(p("axis_angle", "Direction of sliding"), v);
            }
            if let Some(v) = &mut joint.angle {
                visit(p("angle", "Angle between the bodies"), v);
            }
            let p = |n, words, unit| e.part(n, words, unit, Range::NonNegative, Load);
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
                let e = Element { group: "actuators", name };
                visit(e.part("efficiency", "Efficiency", Unit::One, Range::Fraction, Load), v);
            }
        }
        let (finite, role) = (Range::Finite, Load);
        for (name, force) in self.forces.iter_mut().filter(|(_, f)| f.constant) {
            for (axis, v) in force.force.iter_mut().enumerate() {
                let place = Place::Force { force: name, axis };
                visit(Parameter { place, words: "Constant force", unit: Unit::Newton, range: finite, role }, v);
            }
        }
        for (name, torque) in self.torques.iter_mut().filter(|(_, t)| t.constant) {
            let place = Place::Torque { torque: name, on: &torque.on };
            let p = Parameter { place, words: "Constant torque", unit: Unit::NewtonMetre, range: finite, role };
            visit(p, &mut torque.torque);
        }
        let joints = &self.joints;
        for (name, spring) in self.springs.iter_mut() {
            let revolute = |j: &String| joints.get(j).is_some_and(|j| j.kind == JointKind::Revolute);
            let is_rotary = spring.joint.as_ref().is_some_and(revolute);
            let p = |n, words, linear: Unit, rotary: Unit, range| {
                Element { group: "springs", name }.part(n, words, if is_rotary { rotary } else { linear }, range, Load)
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
            let p = |n, words, unit, range| of_section("friction", n, words, unit, range, Load);
            let (one, speed) = (Unit::One, Unit::MetrePerSecond);
            let (not_less, more) = (Range::NonNegative, Range::Positive);
            let words = "Coefficient of static friction";
            visit(p("static_coefficient", words, one, not_less), &mut f.static_coefficient);
            let words = "Coefficient of kinetic friction";
            visit(p("kinetic_coefficient", words, one, not_less), &mut f.kinetic_coefficient);
            visit(p("static_speed", "Slip speed at which friction is static", speed, more), &mut f.static_speed);
            visit(p("kinetic_speed", "Slip speed from which friction is kinetic", speed, more), &mut f.kinetic_speed);
        }
        if let Some(air) = &mut self.air {
            let p = |n, words, unit, range| of_section("air", n, words, unit, range, Load);
            let unit = Unit::KilogramPerCubicMetre;
            visit(p("density", "Mass density of the air", unit, Range::NonNegative), &mut air.density);
            let words = "Direction in which the air flows, angle from the X axis";
            visit(p("flow_angle", words, Unit::Radian, Range::Finite), &mut air.flow_angle);
        }
        for (name, surface) in self.surfaces.iter_mut() {
            let p = |n, words, unit, range| Element { group: "surfaces", name }.part(n, words, unit, range, Load);
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
            let p = |n, words, unit, range| Element { group: "stops", name }.part(n, words, unit, range, Load);
            let is_rotary = stop.angle.is_some();
            if let Some(v) = &mut stop.angle {
                visit(p("angle", "Angle", Unit::Radian, Range::Finite), v);
            }
            if let Some(v) = &mut stop.position {
                visit(p("position", "Position", Unit::Metre, Range::Finite), v);
            }
            if let Some(v) = &mut stop.length {
                visit(p("length", "Distance of the points", Unit::Metre, Range::NonNegative), v);
            }
            let unit = if is_rotary { Unit::NewtonMetrePerRadian } else { Unit::NewtonPerMetre };
            visit(p("restitution", "Restitution", Unit::One, Range::Unit), &mut stop.restitution);
            visit(p("stiffness", "Stiffness as a bumper", unit, Range::NonNegative), &mut stop.stiffness);
            let unit = if is_rotary { Unit::NewtonMetreSecondPerRadian } else { Unit::NewtonSecondPerMetre };
            visit(p("damping", "Damping as a bumper", unit, Range::NonNegative), &mut stop.damping);
        }
        let start = &mut self.start;
        let stated = match (&start.body, &mut start.angle, &start.joint, &mut start.position) {
            (Some(body), Some(v), ..) => Some((body, v, "angle", Unit::Radian, Unit::RadianPerSecond)),
            (.., Some(joint), Some(v)) => Some((joint, v, "position", Unit::Metre, Unit::MetrePerSecond)),
            _ => None,
        };
        if let Some((of, value, quantity, unit, speed_unit)) = stated {
            let p = |quantity, unit, range, role| Parameter {
                place: Place::Start { of, quantity },
                words: "Start",
                unit,
                range,
                role,
            };
            let range = if quantity == "angle" { Range::Turn } else { Range::Finite };
            visit(p(quantity, unit, range, StartPosition), value);
            visit(p("speed", speed_unit, Range::Finite, StartSpeed), &mut start.speed);
        }
        let p = |n, words, unit, range| of_section("solver", n, words, unit, range, Tolerance);
        let words = "Relative tolerance of the integration";
        visit(p("tolerance", words, Unit::One, TOLERANCE), &mut self.solver.tolerance);
        if let Some(v) = self.solver.method.and(self.solver.fem_step.as_mut()) {
            let words = "Largest step of the rigid finite elements";
            visit(p("fem_step", words, Unit::Second, Range::Positive), v);
        }
    }

    /// Call `visit` with every Boolean parameter and its value.
    pub fn flags(&mut self, visit: &mut dyn FnMut(Flag, &mut bool)) {
        if let Some(f) = &mut self.friction {
            let words = ["Whether the joints have friction", ""];
            visit(Flag { owner: "friction", quantity: "enabled", words }, &mut f.enabled);
        }
        if let Some(air) = &mut self.air {
            let words = ["Whether the motion of the surfaces counts for the speed of the air that meets them", ""];
            visit(Flag { owner: "air", quantity: "relative_wind", words }, &mut air.relative_wind);
        }
        for (owner, stop) in self.stops.iter_mut() {
            visit(Flag { owner, quantity: "enabled", words: ["Whether", "is there"] }, &mut stop.enabled);
            let words = ["Whether", "is rigid; else it is a spring and damper that only pushes"];
            visit(Flag { owner, quantity: "rigid", words }, &mut stop.rigid);
        }
        let words = ["Whether the right-hand side is read from tables; else it is computed anew each time", ""];
        visit(Flag { owner: "solver", quantity: "tables", words }, &mut self.solver.tables);
    }
}
