//! Loads of unit size as forces at nodes.
//!
//! In: a load of unit size. Out: its displacement S and, by virtual work, the forces dS/dx at the nodes of every
//! element. It must not know the size of the load, nor time.
use super::element::Element;
use super::mesh::{Mesh, MeshPoint, Present};
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
    /// 1 N.m on the second element and -1 N.m on the first; None is the ground. S is the angle between them plus a
    /// constant [rad].
    Couple([Option<usize>; 2], f64),
}

/// Forces at the two nodes of every element [N].
pub type NodalForces = [[Vec2; 2]];

impl NodalLoad {
    /// A load on the mesh; None for a load in a prismatic joint or a coupling, which no mesh has.
    pub fn new(load: &Load, linkage: &Linkage, mesh: &Mesh) -> Option<Self> {
        let element = |body: usize| body.checked_sub(1);
        Some(match *load {
            Load::Gravity(acceleration) => Self::Weight(acceleration),
            Load::Force { at, direction } => Self::Force(mesh.locate(at), direction),
            Load::Pair { first, second, .. } => Self::Pair(mesh.locate(first), mesh.locate(second)),
            Load::Torque { body, shift } => Self::Couple([element(GROUND), element(body)], shift),
            Load::Couple { first, second, shift, .. } => Self::Couple([element(first), element(second)], shift),
            // No mesh has a coupling.
            Load::Separation { .. } | Load::Rub { .. } | Load::Screw { .. } => return None,
            Load::Slide { joint, .. } => {
                debug_assert!(joint < linkage.joints.len());
                return None;
            }
        })
    }

    /// S [m, rad or J], or its time derivative of order 1 or 2.
    pub fn displacement(&self, mesh: &Mesh, at: &Present, order: usize) -> f64 {
        match *self {
            Self::Weight(acceleration) => {
                let center = |i: usize, e: &Element| e.center.interpolate(mesh.node_motion(i, at, order));
                mesh.elements.iter().enumerate().map(|(i, e)| e.mass * acceleration.dot(&center(i, e))).sum()
            }
            Self::Force(point, direction) => direction.dot(&mesh.point(point, at, order)),
            Self::Pair(first, second) => {
                let apart = |order| mesh.point(second, at, order) - mesh.point(first, at, order);
                let gap = apart(0);
                let length = gap.norm();
                let rate = || gap.dot(&apart(1)) / length;
                match order {
                    0 => length,
                    1 => rate(),
                    // L^2 = d . d, twice differentiated.
                    _ => (apart(1).norm_squared() + gap.dot(&apart(2)) - rate() * rate()) / length,
                }
            }
            Self::Couple([first, second], shift) => {
                let angle = mesh.angle(second, at, order) - mesh.angle(first, at, order);
                if order == 0 { angle + shift } else { angle }
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
                let gap = mesh.point(second, at, 0) - mesh.point(first, at, 0);
                let force = (size / gap.norm()) * gap;
                push_at(second, force, forces);
                push_at(first, -force, forces);
            }
            Self::Couple([first, second], _) => {
                for (element, moment) in [(first, -size), (second, size)] {
                    if let Some(i) = element {
                        let span = mesh.span(i, at.x);
                        let force = (moment / span.length) * span.across;
                        add(&mut forces[i], [-force, force]);
                    }
                }
            }
        }
    }
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
