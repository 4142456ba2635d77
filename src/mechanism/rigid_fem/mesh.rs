//! The mesh: which nodes there are, which two each body has, and how the forces of joints follow from forces at nodes.
//!
//! In: a linkage of binary links with revolute joints. Out: nodes, elements, points in elements' terms. It must not know
//! loads, states or time.
use super::RigidFemError;
use super::element::{Element, Ends, Place};
use crate::mechanism::linkage::{Freedom, GROUND, Linkage, Point, Positions, Vec2};
use nalgebra::DMatrix;

/// Points of one body closer than this part of the linkage's size are one node.
const COINCIDE: f64 = 1e-12;

/// A point of a body or of the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TablePosition {
    /// On the ground, at this position [m].
    Fixed(Vec2),
    /// In an element.
    Moving {
        /// The element.
        element: usize,
        /// Where in it.
        place: Place,
    },
}

/// A part of the force that a joint's first body exerts on its second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Share {
    /// Element whose node counts.
    pub element: usize,
    /// 0 or 1: which of its nodes.
    pub end: usize,
    /// How much of the force that joints exert on it there [1].
    pub weight: f64,
}

/// Nodes and elements. Element `i` is body `i + 1` of the linkage.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// Number of moving nodes; they come first.
    pub moving: usize,
    /// Positions of the others [m].
    pub fixed: Vec<Vec2>,
    /// A point of a body at each node.
    pub points: Vec<Point>,
    /// Elements.
    pub elements: Vec<Element>,
    /// The two nodes of each element.
    pub nodes: Vec<[usize; 2]>,
    /// Angle from the body's x axis to its second node, seen from the first [rad].
    pub axis: Vec<f64>,
    /// The bodies' first nodes, in their frames [m], and the vector from there to the second.
    arms: Vec<(Vec2, Vec2)>,
    /// How the force of each joint follows from the forces at the elements' nodes.
    pub joints: Vec<Vec<Share>>,
}

impl Mesh {
    /// From a linkage; `axial_stiffness` gives E A [N] of a body of the linkage.
    ///
    /// # Errors
    /// A prismatic joint, a body that is no binary link, an E A out of range.
    pub fn new(linkage: &Linkage, axial_stiffness: &dyn Fn(usize) -> f64) -> Result<Self, RigidFemError> {
        if let Some(joint) = linkage.joints.iter().find(|j| j.freedom != Freedom::Revolute) {
            return Err(RigidFemError::Prismatic { joint: joint.name.clone() });
        }
        let (groups, of_joint) = group(linkage);
        let is_fixed = |group: &Vec<Point>| group.iter().any(|p| p.body == GROUND);
        // Moving nodes first, else in the order of the joints.
        let mut order: Vec<usize> = (0..groups.len()).collect();
        order.sort_by_key(|&g| is_fixed(&groups[g]));
        let moving = groups.iter().filter(|g| !is_fixed(g)).count();
        let on_ground = |g: &usize| groups[*g].iter().find(|p| p.body == GROUND).map(|p| p.local);
        let mut mesh = Self {
            moving,
            fixed: order.iter().filter_map(on_ground).collect(),
            points: order.iter().map(|&g| groups[g][0]).collect(),
            elements: Vec::new(),
            nodes: Vec::new(),
            axis: Vec::new(),
            arms: Vec::new(),
            joints: Vec::new(),
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
            // From the pivot on the ground, or from the node nearer to the frame's origin.
            if second >= moving || near.norm() > far.norm() {
                (first, near, second, far) = (second, far, first, near);
            }
            let ea = axial_stiffness(i);
            if !(ea.is_finite() && ea > 0.0) {
                return Err(RigidFemError::AxialStiffness { body: body.name.clone(), value: ea });
            }
            let d = far - near;
            let center = Place::new(body.center - near, d);
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

    /// A point of the linkage in elements' terms.
    pub fn spot(&self, point: Point) -> TablePosition {
        match point.body.checked_sub(1) {
            None => TablePosition::Fixed(point.local),
            Some(element) => {
                let (near, d) = self.arms[element];
                TablePosition::Moving { element, place: Place::new(point.local - near, d) }
            }
        }
    }

    /// Positions of the moving nodes where a linkage's bodies are at these positions [m].
    pub fn positions(&self, p: &Positions) -> Vec<Vec2> {
        self.points[..self.moving].iter().map(|&point| p.point(point)).collect()
    }

    /// Positions of an element's nodes.
    pub fn place(&self, element: usize, positions: &[Vec2]) -> [Vec2; 2] {
        self.nodes[element].map(|n| if n < self.moving { positions[n] } else { self.fixed[n - self.moving] })
    }

    /// Velocities or accelerations of an element's nodes.
    pub fn rate(&self, element: usize, rates: &[Vec2]) -> [Vec2; 2] {
        self.nodes[element].map(|n| if n < self.moving { rates[n] } else { Vec2::zeros() })
    }

    /// All of an element's nodes.
    pub fn ends(&self, element: usize, x: &[Vec2], v: &[Vec2], a: &[Vec2]) -> Ends {
        Ends { x: self.place(element, x), v: self.rate(element, v), a: self.rate(element, a) }
    }

    /// The unknowns of an element, each with its place among the element's four components.
    pub fn unknowns_of(&self, element: usize) -> impl Iterator<Item = (usize, usize)> {
        let (nodes, moving) = (self.nodes[element], self.moving);
        (0..4).filter(move |k| nodes[k / 2] < moving).map(move |k| (2 * nodes[k / 2] + k % 2, k))
    }

    /// Joint forces F from the forces f that the joints at a node exert on its bodies: A F = f, with +1 in A for a joint's
    /// second body and -1 for its first. More joints than needed at one node share f with the least sum of F^2.
    fn shares(&self, linkage: &Linkage, groups: &[Vec<Point>], of_joint: &[usize]) -> Vec<Vec<Share>> {
        let mut out = vec![Vec::new(); linkage.joints.len()];
        for (g, group) in groups.iter().enumerate() {
            let joints: Vec<usize> = (0..of_joint.len()).filter(|&j| of_joint[j] == g).collect();
            let incidence = DMatrix::from_fn(group.len(), joints.len(), |row, column| {
                let joint = &linkage.joints[joints[column]];
                f64::from(i8::from(joint.second.body == group[row].body))
                    - f64::from(i8::from(joint.first.body == group[row].body))
            });
            // Entries are 0, 1 and -1: singular values are 0 or of the size of 1.
            let Ok(inverse) = incidence.pseudo_inverse(1e-9) else { continue };
            // The ground receives less the sum of the others.
            let ground = group.iter().position(|p| p.body == GROUND);
            for (row, joint) in joints.iter().enumerate() {
                for (column, point) in group.iter().enumerate().filter(|(_, p)| p.body != GROUND) {
                    let weight = inverse[(row, column)] - ground.map_or(0.0, |c| inverse[(row, c)]);
                    let (element, node) = (point.body - 1, self.node(group));
                    let end = usize::from(self.nodes[element][1] == node);
                    if weight.abs() > 1e-12 {
                        out[*joint].push(Share { element, end, weight });
                    }
                }
            }
        }
        out
    }

    fn node(&self, group: &[Point]) -> usize {
        self.points.iter().position(|p| *p == group[0]).unwrap_or_default()
    }
}

/// Points that joints hold together, one of each body; and the group of each joint.
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
    let of_joint = linkage
        .joints
        .iter()
        .map(|j| groups.iter().position(|g| g.iter().any(|p| is_at(p, &j.first))).unwrap_or_default());
    let of_joint = of_joint.collect();
    (groups, of_joint)
}
