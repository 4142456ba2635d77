//! Loads of unit size as forces at nodes.
//!
//! In: a load of unit size. Out: its displacement S and, by virtual work, the forces dS/dx at the nodes of every
//! element. It must not know the size of the load, nor time.
use super::element::{Element, Span};
use super::mesh::{Mesh, MeshPoint};
use crate::mechanism::linkage::{GROUND, Linkage};
use crate::mechanism::loads::unit_load::Load;
use crate::numerics::plane::Vec2;

/// A load of unit size on the mesh.
#[derive(Clone, Debug, PartialEq)]
pub enum NodalLoad {
    /// The acceleration [m/s2] on every mass. S is the sum of m acceleration . r [J].
    Weight(Vec2),
    /// 1 N at a point. S is the point's position in this direction [m].
    Force(MeshPoint, Vec2),
    /// 1 N that pushes two points apart. S is the points' distance [m].
    Pair(MeshPoint, MeshPoint),
    /// 1 N.m on the second element and -1 N.m on the first; None is the ground. S is the angle between them [rad].
    Couple(Option<usize>, Option<usize>),
}

/// Positions [m] and velocities [m/s] of the nodes, angles of the elements [rad].
#[derive(Clone, Copy, Debug)]
pub struct Present<'a> {
    /// Positions of the moving nodes.
    pub x: &'a [Vec2],
    /// Velocities of the moving nodes.
    pub v: &'a [Vec2],
    /// Angles of the elements, with all revolutions counted.
    pub angles: &'a [f64],
}

/// Forces at the two nodes of every element [N].
pub type NodalForces = [[Vec2; 2]];

impl NodalLoad {
    /// A load on the mesh; None for a load in a prismatic joint, which no mesh has.
    pub fn new(load: &Load, linkage: &Linkage, mesh: &Mesh) -> Option<Self> {
        let element = |body: usize| body.checked_sub(1);
        Some(match *load {
            Load::Gravity(acceleration) => Self::Weight(acceleration),
            Load::Force { at, direction } => Self::Force(mesh.locate(at), direction),
            Load::Pair { first, second } => Self::Pair(mesh.locate(first), mesh.locate(second)),
            Load::Torque { body } => Self::Couple(element(GROUND), element(body)),
            Load::Couple { first, second } => Self::Couple(element(first), element(second)),
            Load::Slide { joint } => {
                debug_assert!(joint < linkage.joints.len());
                return None;
            }
        })
    }

    /// S [m, rad or J].
    pub fn displacement(&self, mesh: &Mesh, at: &Present) -> f64 {
        match *self {
            Self::Weight(acceleration) => weight(mesh, acceleration, |i| mesh.node_positions(i, at.x)),
            Self::Force(point, direction) => direction.dot(&position(mesh, at, point)),
            Self::Pair(first, second) => (position(mesh, at, second) - position(mesh, at, first)).norm(),
            Self::Couple(first, second) => {
                let angle = |e: Option<usize>| e.map_or(0.0, |i| at.angles[i] - mesh.axis[i]);
                angle(second) - angle(first)
            }
        }
    }

    /// Add `size` dS/dx to the forces at the nodes.
    pub fn push(&self, mesh: &Mesh, at: &Present, size: f64, forces: &mut NodalForces) {
        match *self {
            Self::Weight(acceleration) => {
                for (element, force) in mesh.elements.iter().zip(forces) {
                    add(force, element.center.spread(size * element.mass * acceleration));
                }
            }
            Self::Force(point, direction) => push_at(point, size * direction, forces),
            Self::Pair(first, second) => {
                let gap = position(mesh, at, second) - position(mesh, at, first);
                let force = (size / gap.norm()) * gap;
                push_at(second, force, forces);
                push_at(first, -force, forces);
            }
            Self::Couple(first, second) => {
                for (element, moment) in [(first, -size), (second, size)] {
                    if let Some(i) = element {
                        let span = Span::new(mesh.node_positions(i, at.x));
                        let force = (moment / span.length) * span.across;
                        add(&mut forces[i], [-force, force]);
                    }
                }
            }
        }
    }

    /// S_dot [m/s, rad/s or W].
    pub fn rate(&self, mesh: &Mesh, at: &Present) -> f64 {
        match *self {
            Self::Weight(acceleration) => weight(mesh, acceleration, |i| mesh.node_rates(i, at.v)),
            Self::Force(point, direction) => direction.dot(&rate(mesh, at.v, point)),
            Self::Pair(first, second) => {
                let gap = position(mesh, at, second) - position(mesh, at, first);
                gap.dot(&(rate(mesh, at.v, second) - rate(mesh, at.v, first))) / gap.norm()
            }
            Self::Couple(first, second) => {
                let speed = |e: Option<usize>| {
                    e.map_or(0.0, |i| Span::new(mesh.node_positions(i, at.x)).speed(mesh.node_rates(i, at.v)))
                };
                speed(second) - speed(first)
            }
        }
    }

    /// S_ddot [m/s2, rad/s2 or W/s] where the nodes have the accelerations `a`.
    pub fn acceleration(&self, mesh: &Mesh, at: &Present, a: &[Vec2]) -> f64 {
        match *self {
            Self::Weight(acceleration) => weight(mesh, acceleration, |i| mesh.node_rates(i, a)),
            Self::Force(point, direction) => direction.dot(&rate(mesh, a, point)),
            Self::Pair(first, second) => {
                // L^2 = d . d, twice differentiated.
                let gap = position(mesh, at, second) - position(mesh, at, first);
                let [speed, change] = [at.v, a].map(|rates| rate(mesh, rates, second) - rate(mesh, rates, first));
                let length = gap.norm();
                let along = gap.dot(&speed) / length;
                (speed.norm_squared() + gap.dot(&change) - along * along) / length
            }
            Self::Couple(first, second) => {
                let of = |e: Option<usize>| {
                    e.map_or(0.0, |i| mesh.elements[i].angular_acceleration(&mesh.ends(i, at.x, at.v, a)))
                };
                of(second) - of(first)
            }
        }
    }
}

fn position(mesh: &Mesh, at: &Present, point: MeshPoint) -> Vec2 {
    match point {
        MeshPoint::Fixed(position) => position,
        MeshPoint::Moving { element, local } => local.interpolate(mesh.node_positions(element, at.x)),
    }
}

/// Velocity or acceleration of a point, for those of the nodes.
fn rate(mesh: &Mesh, rates: &[Vec2], point: MeshPoint) -> Vec2 {
    match point {
        MeshPoint::Fixed(_) => Vec2::zeros(),
        MeshPoint::Moving { element, local } => local.interpolate(mesh.node_rates(element, rates)),
    }
}

/// Sum of m acceleration . s over the elements, with s the value at the centre of mass for values at the nodes.
fn weight(mesh: &Mesh, acceleration: Vec2, at_nodes: impl Fn(usize) -> [Vec2; 2]) -> f64 {
    let of = |(i, e): (usize, &Element)| e.mass * acceleration.dot(&e.center.interpolate(at_nodes(i)));
    mesh.elements.iter().enumerate().map(of).sum()
}

fn push_at(point: MeshPoint, force: Vec2, forces: &mut NodalForces) {
    if let MeshPoint::Moving { element, local } = point {
        add(&mut forces[element], local.spread(force));
    }
}

fn add(to: &mut [Vec2; 2], force: [Vec2; 2]) {
    to[0] += force[0];
    to[1] += force[1];
}
