//! Bodies, joints, spanning tree and loops of a linkage.
use super::coupling::Coupling;
use super::slot::Slot;
use crate::numerics::plane::Vec2;

/// Index of the ground among the bodies.
pub const GROUND: usize = 0;

/// A point fixed in a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Index of the body.
    pub body: usize,
    /// Position in the body's frame [m].
    pub local: Vec2,
}

/// A rigid body.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Name; of bodies fixed to one another the name of the one that carries the others.
    pub name: String,
    /// Index of the coordinate from which the body's angle follows; None for a body that does not turn.
    pub angle_coordinate: Option<usize>,
    /// Angle of the body less its angle coordinate [rad].
    pub offset: f64,
    /// Mass [kg].
    pub mass: f64,
    /// Centre of mass in the body's frame [m].
    pub center: Vec2,
    /// Moment of inertia about the centre of mass [kg.m2].
    pub inertia: f64,
}

/// Freedom of a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Freedom {
    /// Rotation: the joint's two points coincide.
    Revolute,
    /// Translation of the second point along a line through the first; the unit vector is fixed in the first body.
    Prismatic(Vec2),
    /// A pin in a curved slot, by its index among [`Linkage::slots`]: the second point is on a curve of the first body.
    Slot(usize),
    /// A coupling, by its index among [`Linkage::couplings`]: no more than its equation. It is never in the tree.
    Coupling(usize),
}

impl Freedom {
    /// Number of loop equations of a joint outside the spanning tree.
    pub fn rows(self) -> usize {
        if self.turns() { 2 } else { 1 }
    }

    /// Whether the two bodies turn freely, so that the joint has a force at its second point and no moment.
    pub fn turns(self) -> bool {
        matches!(self, Self::Revolute | Self::Slot(_))
    }
}

/// A joint between two bodies.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Name.
    pub name: String,
    /// Freedom.
    pub freedom: Freedom,
    /// Point of the first-named body.
    pub first: Point,
    /// Point of the second-named body.
    pub second: Point,
}

/// An edge of the spanning tree, from a body (the parent) to the body that is positioned relative to it (the child).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Branch {
    /// Index of the child.
    pub child: usize,
    /// Index of the parent.
    pub parent: usize,
    /// Index of the joint between them.
    pub joint: usize,
    /// Index of the coordinate that is the position of a prismatic joint or a slot.
    pub slide: Option<usize>,
    /// Joint's point on the parent, in the parent's frame [m].
    pub from: Vec2,
    /// Joint's point on the child, in the child's frame [m].
    pub to: Vec2,
    /// Whether the child is the joint's first-named body.
    pub reversed: bool,
}

/// A loop that a joint outside the tree closes: the structure of this joint's rows of the Jacobian.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Loop {
    /// Indices of the coordinates on which the joint's gap depends, ascending. These are the columns of the rows.
    pub columns: Vec<usize>,
    /// Branches round the loop, from the joint's two bodies inward to where they meet.
    pub(super) steps: Vec<Step>,
    /// Column of the angle of the joint's first body.
    pub(super) first: Option<usize>,
    /// Column of the angle of the joint's second body.
    pub(super) second: Option<usize>,
    /// Column of the position of a slot.
    pub(super) slide: Option<usize>,
}

/// A branch as a part of a loop. `parent`, `child` and `slide` are columns of the loop: those of the parent's angle,
/// the child's angle and the joint's position.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Step {
    pub(super) branch: usize,
    /// Sign of the branch's contribution to the gap: 1 on the side of the joint's second body, -1 on the other.
    pub(super) sign: f64,
    pub(super) parent: Option<usize>,
    pub(super) child: Option<usize>,
    pub(super) slide: Option<usize>,
}

/// Frame of a body of the definition, in the body of the linkage that carries it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    pub(super) body: usize,
    /// Origin [m].
    pub(super) origin: Vec2,
    /// Angle [rad].
    pub(super) angle: f64,
}

/// A rotor.
#[derive(Clone, Debug, PartialEq)]
pub struct Rotor {
    /// What moves it.
    pub stroke: Stroke,
    /// Mass that has its kinetic energy at the speed of the stroke [kg]; moment of inertia for an angle [kg.m2].
    pub mass: f64,
}

/// A distance or an angle in the linkage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stroke {
    /// A distance.
    Along(Line),
    /// Angle of a second body relative to a first one, by their indices.
    Angle(usize, usize),
}

/// A distance in the linkage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Line {
    /// Between two points.
    Between(Point, Point),
    /// Position of a prismatic joint, by its index.
    Joint(usize),
}

/// A planar linkage.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Linkage {
    /// Bodies; the ground first.
    pub bodies: Vec<Body>,
    /// Joints in the order of the file, then one for each coupling.
    pub joints: Vec<Joint>,
    /// Spanning tree, parents before children.
    pub tree: Vec<Branch>,
    /// Joints outside the tree; each closes a loop.
    pub cuts: Vec<usize>,
    /// The loop of each of `cuts`.
    pub loops: Vec<Loop>,
    /// Couplings in the order of the file.
    pub couplings: Vec<Coupling>,
    /// Curved slots in the order of the file.
    pub slots: Vec<Slot>,
    /// Rotors, one for each drive with a screw and one for each joint with a rotor.
    pub rotors: Vec<Rotor>,
    /// Names of the coordinates: of a body for an angle, of a joint for a position.
    pub coordinates: Vec<String>,
    /// Number of coordinates that are angles; they come first.
    pub angles: usize,
    /// Largest distance of two named points of one body [m]: the scale of gaps.
    pub size: f64,
    /// Whether the definition has no masses, so that those of the bodies are nominal: their only use is the metric of
    /// the curve.
    pub is_massless: bool,
    /// Frame of each body of the definition.
    pub(super) frames: Vec<Frame>,
}
