//! The mesh: nodes, elements between two nodes, and the weights that give joint forces from forces at nodes.
//!
//! In: a linkage of binary links. Out: nodes, elements, points relative to elements. It must not know loads or states.
use super::element::{Element, Ends, LocalCoordinates, Span};
use super::error::RigidFemError;
use crate::mechanism::linkage::{Freedom, GROUND, Joint, Linkage, Point};
use crate::numerics::plane::Vec2;
use crate::numerics::pseudo_inverse::pseudo_inverse;
use nalgebra::DMatrix;

/// Distance below which points of one body are one node, relative to the linkage's size.
const COINCIDE: f64 = 1e-12;

/// A point of an element or of the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MeshPoint {
    /// Position of a point of the ground [m].
    Fixed(Vec2),
    /// A point of an element.
    Moving {
        /// Index of the element.
        element: usize,
        /// Coordinates in the element.
        local: LocalCoordinates,
    },
}

/// Motion of the moving nodes, and the angles of the elements.
#[derive(Clone, Copy, Debug)]
pub struct Present<'a> {
    /// Positions [m].
    pub x: &'a [Vec2],
    /// Velocities [m/s].
    pub v: &'a [Vec2],
    /// Accelerations [m/s2].
    pub a: &'a [Vec2],
    /// Angles, with all revolutions counted [rad].
    pub angles: &'a [f64],
}

/// Contribution of a node's force to a joint's force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Share {
    /// Index of the element.
    pub element: usize,
    /// Node of the element, 0 or 1.
    pub end: usize,
    /// Weight of the force of the joints on the element at this node [1].
    pub weight: f64,
}

/// Nodes and elements. Element `i` is body `i + 1` of the linkage.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Number of moving nodes; they come before the fixed ones.
    pub moving: usize,
    /// Positions of the fixed nodes [m].
    pub fixed: Vec<Vec2>,
    /// A point of a body at each node.
    pub points: Vec<Point>,
    /// Elements.
    pub elements: Vec<Element>,
    /// Indices of the two nodes of each element.
    pub nodes: Vec<[usize; 2]>,
    /// Angle of the vector from the first to the second node in the body's frame [rad].
    pub axis: Vec<f64>,
    /// First node and vector from the first to the second node of each element, in the body's frame [m].
    arms: Vec<(Vec2, Vec2)>,
    /// Contributions to the force of each joint, that of its first body on its second.
    pub joints: Vec<Vec<Share>>,
}

impl Mesh {
    /// Mesh of a linkage; `axial_stiffness` gives E A [N] of a body by its index.
    ///
    /// # Errors
    /// A prismatic joint, a body that is not a binary link, an E A out of range.
    pub fn new(linkage: &Linkage, axial_stiffness: &dyn Fn(usize) -> f64) -> Result<Self, RigidFemError> {
        if let Some(coupling) = linkage.couplings.first() {
            return Err(RigidFemError::Coupling { coupling: linkage.joints[coupling.joint].name.clone() });
        }
        if !linkage.rotors.is_empty() {
            return Err(RigidFemError::Screw);
        }
        if let Some(joint) = linkage.joints.iter().find(|j| j.freedom != Freedom::Revolute) {
            return Err(RigidFemError::Prismatic { joint: joint.name.clone() });
        }
        let (groups, of_joint) = group(linkage);
        let is_fixed = |group: &Vec<Point>| group.iter().any(|p| p.body == GROUND);
        // Moving nodes first, else in the order of the joints.
        let (mut order, fixed): (Vec<usize>, Vec<usize>) = (0..groups.len()).partition(|&g| !is_fixed(&groups[g]));
        let moving = order.len();
        order.extend(fixed);
        let on_ground = |g: &usize| groups[*g].iter().find(|p| p.body == GROUND).map(|p| p.local);
        let mut mesh = Self {
            moving,
            fixed: order.iter().filter_map(on_ground).collect(),
            points: order.iter().map(|&g| groups[g][0]).collect(),
            ..Self::default()
        };
        for (i, body) in linkage.bodies.iter().enumerate().skip(1) {
            let held: Vec<(usize, Vec2)> = order
                .iter()
                .enumerate()
                .filter_map(|(node, &g)| groups[g].iter().find(|p| p.body == i).map(|p| (node, p.local)))
                .collect();
            let [(mut first, mut near), (mut second, mut far)] = held[..] else {
                return Err(RigidFemError::Nodes { body: body.name.clone(), count: held.len() });
            };
            // The first node is the one on the ground, or the one nearer to the frame's origin.
            if second >= moving || near.norm() > far.norm() {
                (first, near, second, far) = (second, far, first, near);
            }
            let ea = axial_stiffness(i);
            if !(ea.is_finite() && ea > 0.0) {
                return Err(RigidFemError::AxialStiffness { body: body.name.clone(), value: ea });
            }
            let d = far - near;
            let center = LocalCoordinates::new(body.center - near, d);
            let (length, mass, inertia) = (d.norm(), body.mass, body.inertia);
            mesh.elements.push(Element { length, axial_stiffness: ea, mass, center, inertia });
            mesh.nodes.push([first, second]);
            mesh.axis.push(d.y.atan2(d.x));
            mesh.arms.push((near, d));
        }
        mesh.joints = mesh.shares(linkage, &groups, &of_joint);
        Ok(mesh)
    }

    /// Number of unknowns: two components for each moving node.
    pub fn unknowns(&self) -> usize {
        2 * self.moving
    }

    /// A point of the linkage relative to the mesh.
    pub fn locate(&self, point: Point) -> MeshPoint {
        match point.body.checked_sub(1) {
            None => MeshPoint::Fixed(point.local),
            Some(element) => {
                let (near, d) = self.arms[element];
                MeshPoint::Moving { element, local: LocalCoordinates::new(point.local - near, d) }
            }
        }
    }

    /// Positions of an element's nodes.
    fn node_positions(&self, element: usize, x: &[Vec2]) -> [Vec2; 2] {
        self.nodes[element].map(|n| if n < self.moving { x[n] } else { self.fixed[n - self.moving] })
    }

    /// Velocities or accelerations of an element's nodes.
    pub fn node_rates(&self, element: usize, rates: &[Vec2]) -> [Vec2; 2] {
        self.nodes[element].map(|n| if n < self.moving { rates[n] } else { Vec2::zeros() })
    }

    /// Positions, velocities or accelerations of an element's nodes, for the order 0, 1 or 2.
    pub fn node_motion(&self, element: usize, at: &Present, order: usize) -> [Vec2; 2] {
        match order {
            0 => self.node_positions(element, at.x),
            1 => self.node_rates(element, at.v),
            _ => self.node_rates(element, at.a),
        }
    }

    /// Motion of an element's nodes.
    pub fn ends(&self, element: usize, at: &Present) -> Ends {
        let [x, v, a] = [0, 1, 2].map(|order| self.node_motion(element, at, order));
        Ends { x, v, a }
    }

    /// Present length and direction of an element.
    pub fn span(&self, element: usize, positions: &[Vec2]) -> Span {
        Span::new(self.node_positions(element, positions))
    }

    /// Position of a point [m], or its time derivative of order 1 or 2.
    pub fn point(&self, point: MeshPoint, at: &Present, order: usize) -> Vec2 {
        match point {
            MeshPoint::Fixed(position) if order == 0 => position,
            MeshPoint::Fixed(_) => Vec2::zeros(),
            MeshPoint::Moving { element, local } => local.interpolate(self.node_motion(element, at, order)),
        }
    }

    /// Angle of an element's body [rad], or its time derivative of order 1 or 2; None is the ground.
    pub fn angle(&self, element: Option<usize>, at: &Present, order: usize) -> f64 {
        element.map_or(0.0, |i| match order {
            0 => at.angles[i] - self.axis[i],
            1 => self.span(i, at.x).speed(self.node_rates(i, at.v)),
            _ => self.elements[i].angular_acceleration(&self.ends(i, at)),
        })
    }

    /// Indices of an element's unknowns, each with its index among the element's four components.
    pub fn unknowns_of(&self, element: usize) -> impl Iterator<Item = (usize, usize)> {
        let (nodes, moving) = (self.nodes[element], self.moving);
        (0..4).filter(move |k| nodes[k / 2] < moving).map(move |k| (2 * nodes[k / 2] + k % 2, k))
    }

    /// Weights of joint forces F in terms of the forces f of the joints on the bodies at a node: A F = f, with +1 in A
    /// for a joint's second body and -1 for its first. With redundant joints at a node, F has the least sum of squares.
    fn shares(&self, linkage: &Linkage, groups: &[Vec<Point>], of_joint: &[usize]) -> Vec<Vec<Share>> {
        let mut out = vec![Vec::new(); linkage.joints.len()];
        for (g, group) in groups.iter().enumerate() {
            let joints: Vec<usize> = (0..of_joint.len()).filter(|&j| of_joint[j] == g).collect();
            let incidence = DMatrix::from_fn(group.len(), joints.len(), |row, column| {
                let joint = &linkage.joints[joints[column]];
                f64::from(i8::from(joint.second.body == group[row].body))
                    - f64::from(i8::from(joint.first.body == group[row].body))
            });
            // Entries are 0, 1 and -1, so singular values are 0 or of order 1.
            let inverse = pseudo_inverse(incidence, 1e-9);
            // The force on the ground is minus the sum of the others.
            let ground = group.iter().position(|p| p.body == GROUND);
            for (row, joint) in joints.iter().enumerate() {
                for (column, point) in group.iter().enumerate().filter(|(_, p)| p.body != GROUND) {
                    let weight = inverse[(row, column)] - ground.map_or(0.0, |c| inverse[(row, c)]);
                    let element = point.body - 1;
                    let end = usize::from(self.points[self.nodes[element][1]] == group[0]);
                    if weight.abs() > 1e-12 {
                        out[*joint].push(Share { element, end, weight });
                    }
                }
            }
        }
        out
    }
}

/// Groups of points that joints connect, one point for each body, and the index of each joint's group.
fn group(linkage: &Linkage) -> (Vec<Vec<Point>>, Vec<usize>) {
    let is_at = |a: &Point, b: &Point| a.body == b.body && (a.local - b.local).norm() <= COINCIDE * linkage.size;
    let mut groups: Vec<Vec<Point>> = Vec::new();
    for joint in &linkage.joints {
        let ends = [joint.first, joint.second];
        let (touched, others): (Vec<_>, Vec<_>) =
            groups.into_iter().partition(|g| g.iter().any(|p| ends.iter().any(|e| is_at(p, e))));
        groups = others;
        let mut merged: Vec<Point> = Vec::new();
        for point in touched.into_iter().flatten().chain(ends) {
            if !merged.iter().any(|p| p.body == point.body) {
                merged.push(point);
            }
        }
        groups.push(merged);
    }
    let of = |j: &Joint| groups.iter().position(|g| g.iter().any(|p| is_at(p, &j.first))).unwrap_or_default();
    let of_joint = linkage.joints.iter().map(of).collect();
    (groups, of_joint)
}
