//! The linkage: bodies, joints and loop equations in the coordinates of a spanning tree.
//!
//! In: a checked definition. Out: positions, rates and accelerations of every body for given coordinates, and the
//! residuals of the joints that close the loops. It must not know masses' motion, loads, curves or time.
//!
//! Bodies that are fixed to one another are one body here. Bodies joined by prismatic joints turn together and share
//! one angle. The coordinates q are the angles of these groups [rad], then the positions of the prismatic joints [m].
mod build;
mod loops;
mod motion;

pub use loops::Loop;
pub use motion::{Arms, Positions, Rates};

use nalgebra::Vector2;

/// A vector in the plane.
pub type Vec2 = Vector2<f64>;

/// Place of the ground among the bodies.
pub const GROUND: usize = 0;

/// A point fixed in a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Place of the body.
    pub body: usize,
    /// Position in the body's frame [m].
    pub local: Vec2,
}

/// A rigid body.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Name, of the body to which the others are fixed.
    pub name: String,
    /// Coordinate that is its angle; none: it does not turn.
    pub angle_coordinate: Option<usize>,
    /// Its angle less that coordinate [rad].
    pub offset: f64,
    /// Mass [kg].
    pub mass: f64,
    /// Centre of mass in the body's frame [m].
    pub center: Vec2,
    /// Moment of inertia about the centre of mass [kg.m2].
    pub inertia: f64,
}

/// What a joint lets free.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Freedom {
    /// Turning: the points coincide.
    Revolute,
    /// Sliding of the second point along a line through the first; the unit vector is fixed in the first body.
    Prismatic(Vec2),
}

/// A joint between two bodies.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Name.
    pub name: String,
    /// What it lets free.
    pub freedom: Freedom,
    /// Point of the first-named body.
    pub first: Point,
    /// Point of the second-named body.
    pub second: Point,
}

/// A step from a body to one that is placed by it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Branch {
    /// The body that is placed.
    pub child: usize,
    /// The body that places it.
    pub parent: usize,
    /// The joint between them.
    pub joint: usize,
    /// Coordinate that is the joint's position.
    pub slide: Option<usize>,
    /// The joint's point on the parent, in its frame [m].
    pub from: Vec2,
    /// The same on the child.
    pub to: Vec2,
    /// Whether the child is the joint's first-named body.
    pub reversed: bool,
}

/// A planar linkage.
#[derive(Clone, Debug, PartialEq)]
pub struct Linkage {
    /// Bodies; the ground first.
    pub bodies: Vec<Body>,
    /// Joints in the order of the file.
    pub joints: Vec<Joint>,
    /// The spanning tree, parents before children.
    pub tree: Vec<Branch>,
    /// Joints outside the tree: each closes a loop.
    pub cuts: Vec<usize>,
    /// For each of them, the way round its loop.
    pub loops: Vec<Loop>,
    /// Names of the coordinates: the body that gives an angle, the joint that gives a position.
    pub coordinates: Vec<String>,
    /// Number of coordinates that are angles; they come first.
    pub angles: usize,
    /// Largest distance of two named points of one body [m]: the size to which gaps are compared.
    pub size: f64,
    /// Where each named body of the definition is: the body of this list, its place and its angle in that body's frame.
    pub(crate) placed: Vec<(usize, Vec2, f64)>,
}

/// The cross product's only component.
pub fn cross(a: Vec2, b: Vec2) -> f64 {
    a.x * b.y - a.y * b.x
}

/// A quarter turn anticlockwise.
pub fn perp(a: Vec2) -> Vec2 {
    Vec2::new(-a.y, a.x)
}

/// A vector turned by an angle [rad].
pub fn turned(a: Vec2, angle: f64) -> Vec2 {
    let (sin, cos) = angle.sin_cos();
    Vec2::new(cos * a.x - sin * a.y, sin * a.x + cos * a.y)
}

#[cfg(test)]
mod tests;
