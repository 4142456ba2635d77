//! Bodies, points on them whose motion is asked for, joints, and the friction in these.
use super::drawing::Drawn;
use super::{AXES, Role, Visit};
use crate::format::{Flag, Named, Owner, Parameter, Range};
use crate::variables::Unit;
use serde::{Deserialize, Serialize};

/// A rigid body. Its frame has the point `origin` and the x axis, on which the point `end` lies at `length`.
#[derive(Clone, Debug, Default, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Body {
    /// Point (`body.point`) of another body to which the body is rigidly fixed, with its origin there.
    pub fixed_to: Option<String>,
    /// Angle of a fixed body's x axis from the x axis of the other body [rad]; 0 where absent.
    pub angle: Option<f64>,
    /// Distance from the point `origin` to the point `end` [m], > 0.
    pub length: Option<f64>,
    /// Mass [kg], >= 0; 0 where absent.
    pub mass: Option<f64>,
    /// Distribution of the mass; `mass`, `center` and `inertia` as stated where absent.
    pub shape: Option<Shape>,
    /// Centre of mass in the body's frame [m]; the origin where absent.
    pub center: Option<[f64; 2]>,
    /// Moment of inertia about the centre of mass [kg.m2], >= 0; 0 where absent.
    pub inertia: Option<f64>,
    /// E A of the body as a rod between its two joints [N], > 0; read by the formulation `rigid_fem` only.
    pub axial_stiffness: Option<f64>,
    /// Further named points in the body's frame [m].
    #[serde(default)]
    pub points: Named<[f64; 2]>,
    /// The body at the drawn position, in place of lengths and points in its frame; None once these are known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drawn: Option<Drawn>,
}

/// Distribution of a body's mass.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum Shape {
    /// Evenly between `origin` and `end`: centre at half the length, moment of inertia m l2 / 12.
    UniformRod,
}

/// A point whose position, velocity and acceleration are outputs.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Marker {
    /// The point (`body.point`).
    pub at: String,
}

impl Body {
    /// Centre of mass in the body's frame [m]: half-way along a uniform rod, else as stated.
    pub fn center_of_mass(&self) -> [f64; 2] {
        match (self.shape, self.length) {
            (Some(Shape::UniformRod), Some(length)) => [0.5 * length, 0.0],
            _ => self.center.unwrap_or_default(),
        }
    }

    pub(super) fn parameters(&mut self, name: &str, visit: &mut Visit) {
        let mut list = Owner::new(Some("bodies"), name, Role::Geometry, visit);
        list.add("angle", "Angle of the x axis", Unit::Radian, Range::Finite, &mut self.angle);
        list.add("length", "Length", Unit::Metre, Range::Length, &mut self.length);
        list.role = Role::Inertia;
        list.add("mass", "Mass", Unit::Kilogram, Range::NonNegative, &mut self.mass);
        for ((axis, index), value) in AXES.into_iter().zip(self.center.iter_mut().flatten()) {
            let (key, kind) = (["bodies.", name, ".center", index], (Unit::Metre, Range::Coordinate, Role::Inertia));
            let description = ["Centre of mass, ", axis, ", of ", name];
            (list.visit)(Parameter::new([name, ".center_", axis], key, description, kind), value);
        }
        let words = "Moment of inertia about the centre of mass";
        list.add("inertia", words, Unit::KilogramSquareMetre, Range::NonNegative, &mut self.inertia);
        list.role = Role::Elasticity;
        list.add("axial_stiffness", "Axial stiffness E A", Unit::Newton, Range::Positive, &mut self.axial_stiffness);
        for (point, coordinates) in self.points.iter_mut() {
            for ((axis, index), value) in AXES.into_iter().zip(coordinates) {
                let key = ["bodies.", name, ".points.", point, index];
                let description = ["Point ", point, ", ", axis, ", of ", name];
                let kind = (Unit::Metre, Range::Coordinate, Role::Geometry);
                visit(Parameter::new([name, ".", point, "_", axis], key, description, kind), value);
            }
        }
    }
}

/// Connection of two bodies.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Joint {
    /// Kind of joint.
    #[serde(rename = "type")]
    pub kind: JointKind,
    /// Point (`body.point`) of the first body. The joint's reaction is the force of the first body on the second.
    pub first: String,
    /// Point (`body.point`) of the second body.
    pub second: String,
    /// Prismatic only: direction of sliding in the first body's frame [rad]; 0 where absent.
    pub axis_angle: Option<f64>,
    /// Prismatic only: angle of the second body's x axis from the x axis of the first [rad]; 0 where absent.
    pub angle: Option<f64>,
    /// Revolute only: radius of the pin [m], >= 0; no friction in the joint where absent.
    pub pin_radius: Option<f64>,
    /// Coefficient of static friction in this joint [1], >= 0; `friction.static_coefficient` where absent.
    pub static_coefficient: Option<f64>,
    /// Coefficient of kinetic friction in this joint [1], >= 0; `friction.kinetic_coefficient` where absent.
    pub kinetic_coefficient: Option<f64>,
}

/// Kind of a joint.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum JointKind {
    /// The two points coincide.
    Revolute,
    /// The second point lies on a line through the first, fixed in the first body; the bodies do not turn relatively.
    Prismatic,
}

/// Law of friction at low slip speeds.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum FrictionLaw {
    /// Proportional to the slip speed up to V_S ([HF08] section 4), so that nothing is held at rest.
    #[default]
    Viscous,
    /// Coulomb's: static friction up to V_S, and at rest as much as holds, up to static friction.
    Stick,
}

impl FrictionLaw {
    /// Whether it is the law that a file need not state.
    fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

/// Friction in the joints ([HF08] section 4): in every revolute joint with a pin radius, and in every prismatic joint.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Friction {
    /// Whether the joints have friction; not where absent.
    pub enabled: Option<bool>,
    /// Law at low slip speeds.
    #[serde(default, skip_serializing_if = "FrictionLaw::is_default")]
    pub law: FrictionLaw,
    /// Coefficient of static friction mu_S [1], >= 0; >= mu_d if the law is `stick`.
    pub static_coefficient: f64,
    /// Coefficient of kinetic friction mu_d [1], >= 0.
    pub kinetic_coefficient: f64,
    /// Slip speed V_S at which friction is static [m/s], > 0; at lower slip speeds friction is proportional to the slip
    /// speed, or static if the law is `stick`, where V_S may be 0.
    #[serde(default = "static_speed")]
    pub static_speed: f64,
    /// Slip speed V_d above which friction is kinetic [m/s], > V_S; if the law is `stick`, both may be 0.
    #[serde(default = "kinetic_speed")]
    pub kinetic_speed: f64,
}

fn static_speed() -> f64 {
    0.01
}

fn kinetic_speed() -> f64 {
    1.0
}

impl Joint {
    pub(super) fn parameters(&mut self, name: &str, visit: &mut Visit) {
        use Unit::{Metre, One, Radian};
        let mut list = Owner::new(Some("joints"), name, Role::Geometry, visit);
        list.add("axis_angle", "Direction of sliding", Radian, Range::Finite, &mut self.axis_angle);
        list.add("angle", "Angle between the bodies", Radian, Range::Finite, &mut self.angle);
        list.role = Role::Load;
        list.add("pin_radius", "Radius of the pin", Metre, Range::NonNegative, &mut self.pin_radius);
        let words = ["Coefficient of static friction", "Coefficient of kinetic friction"];
        list.role = Role::Law;
        list.add("static_coefficient", words[0], One, Range::NonNegative, &mut self.static_coefficient);
        list.add("kinetic_coefficient", words[1], One, Range::NonNegative, &mut self.kinetic_coefficient);
    }
}

impl Friction {
    pub(super) fn parameters(&mut self, visit: &mut Visit) {
        use Unit::{MetrePerSecond, One};
        let mut list = Owner::new(None, "friction", Role::Law, visit);
        let words = ["Coefficient of static friction", "Coefficient of kinetic friction"];
        list.add("static_coefficient", words[0], One, Range::NonNegative, &mut self.static_coefficient);
        list.add("kinetic_coefficient", words[1], One, Range::NonNegative, &mut self.kinetic_coefficient);
        list.role = Role::Load;
        let words = ["Slip speed at which friction is static", "Slip speed from which friction is kinetic"];
        let range = if self.law == FrictionLaw::Stick { Range::NonNegative } else { Range::Positive };
        list.add("static_speed", words[0], MetrePerSecond, range, &mut self.static_speed);
        list.add("kinetic_speed", words[1], MetrePerSecond, range, &mut self.kinetic_speed);
    }

    pub(super) fn flags(&mut self, visit: &mut dyn FnMut(Flag, &mut bool)) {
        let text = ["Whether the joints have friction"];
        visit(Flag::new("friction", "enabled", text), self.enabled.get_or_insert(false));
    }
}
