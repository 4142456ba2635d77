//! Bodies and the points on them whose motion is asked for.
use super::role::{Role, Visit};
use crate::format::{Named, Owner, Parameter, Range};
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
    pub(super) fn parameters(&mut self, name: &str, visit: &mut Visit) {
        let mut list = Owner::element("bodies", name, Role::Geometry, visit);
        list.add("angle", "Angle of the x axis", Unit::Radian, Range::Finite, &mut self.angle);
        list.add("length", "Length", Unit::Metre, Range::Length, &mut self.length);
        list.role = Role::Inertia;
        list.add("mass", "Mass", Unit::Kilogram, Range::NonNegative, &mut self.mass);
        if let Some([x, y]) = &mut self.center {
            let kind = (Unit::Metre, Range::Coordinate);
            list.add_component("center_x", "center[0]", "Centre of mass, x,", kind, x);
            list.add_component("center_y", "center[1]", "Centre of mass, y,", kind, y);
        }
        let words = "Moment of inertia about the centre of mass";
        list.add("inertia", words, Unit::KilogramSquareMetre, Range::NonNegative, &mut self.inertia);
        list.role = Role::Elasticity;
        list.add("axial_stiffness", "Axial stiffness E A", Unit::Newton, Range::Positive, &mut self.axial_stiffness);
        for (point, coordinates) in self.points.iter_mut() {
            for ((axis, index), value) in [("x", "[0]"), ("y", "[1]")].into_iter().zip(coordinates) {
                let key = ["bodies.", name, ".points.", point, index];
                let description = ["Point ", point, ", ", axis, ", of ", name];
                let kind = (Unit::Metre, Range::Coordinate, Role::Geometry);
                visit(Parameter::new([name, ".", point, "_", axis], key, description, kind), value);
            }
        }
    }
}
