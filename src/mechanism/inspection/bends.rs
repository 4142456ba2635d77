//! Bends: two links at a joint between moving bodies, and where they come into line.
//!
//! In: a linkage, positions. Out: angles of the bends, the joints that are in line. It must not know the travel.
use crate::mechanism::linkage::{Freedom, GROUND, Linkage, Point, Positions};
use crate::mechanism::loads::unit_load::Load;
use crate::numerics::plane::cross;

/// Sine of a bend below which three joints are in line.
const IN_LINE: f64 = 1e-6;
/// Part of the linkage's size below which two points coincide.
const APART: f64 = 1e-9;

/// Two links at a joint between moving bodies, as seen from another joint of each.
pub struct Bend {
    /// A joint of one body, the joint between the two, a joint of the other body.
    pub joints: [usize; 3],
    points: [Point; 3],
}

impl Bend {
    /// Angle by which the way through the three joints turns, anticlockwise positive [rad].
    pub fn angle(&self, positions: &Positions) -> f64 {
        let [from, at, to] = self.points.map(|point| positions.point(point));
        let (one, other) = (at - from, to - at);
        cross(one, other).atan2(one.dot(&other))
    }
}

/// The bends whose sides show in which way a linkage is put together: at each revolute joint between two moving bodies
/// one, towards the first other joint of each body.
pub fn bends(linkage: &Linkage) -> Vec<Bend> {
    let mut firsts: Vec<Bend> = Vec::new();
    for bend in all(linkage) {
        if firsts.last().is_none_or(|last| last.joints[1] != bend.joints[1]) {
            firsts.push(bend);
        }
    }
    firsts
}

/// All bends, by their joints: towards each other joint of both bodies.
fn all(linkage: &Linkage) -> impl Iterator<Item = Bend> + '_ {
    let hinges = &linkage.joints[..linkage.joints.len() - linkage.couplings.len()];
    let mut joints_of: Vec<Vec<usize>> = vec![Vec::new(); linkage.bodies.len()];
    for (index, joint) in hinges.iter().enumerate() {
        joints_of[joint.first.body].push(index);
        joints_of[joint.second.body].push(index);
    }
    hinges.iter().enumerate().flat_map(move |(index, joint)| {
        let bodies = [joint.first.body, joint.second.body];
        let is_bend = joint.freedom == Freedom::Revolute && !bodies.contains(&GROUND);
        let next = |own: Point| -> Vec<(usize, Point)> {
            let on = |other: usize| {
                let j = &hinges[other];
                (other, if j.first.body == own.body { j.first } else { j.second })
            };
            let others = joints_of[own.body].iter().filter(|other| is_bend && **other != index);
            let apart = |(_, point): &(usize, Point)| (point.local - own.local).norm() > APART * linkage.size;
            others.map(|other| on(*other)).filter(apart).collect()
        };
        let (ones, others) = (next(joint.first), next(joint.second));
        let pairs = ones.into_iter().flat_map(move |one| others.clone().into_iter().map(move |other| (one, other)));
        let pairs = pairs.filter(|((from, _), (to, _))| from != to);
        let bend =
            move |((from, one), (to, other))| Bend { joints: [from, index, to], points: [one, joint.first, other] };
        pairs.map(bend).collect::<Vec<_>>()
    })
}

/// Names of three revolute joints that are in line: of two links that move against each other.
pub fn in_line(linkage: &Linkage, positions: &Positions) -> Option<String> {
    let is_hinge = |joint: &usize| linkage.joints[*joint].freedom == Freedom::Revolute;
    let mut bends = all(linkage).filter(|bend| bend.joints.iter().all(is_hinge));
    let bend = bends.find(|bend| bend.angle(positions).sin().abs() < IN_LINE)?;
    let [from, at, to] = bend.joints.map(|joint| linkage.joints[joint].name.as_str());
    Some(format!("{from}, {at} and {to}"))
}

/// Name of the joint between the two bodies that a load connects, where both ends of the load are in line with it.
pub fn in_line_with_ends(linkage: &Linkage, load: &Load, positions: &Positions) -> Option<String> {
    let Load::Pair { first, second, .. } = load else { return None };
    let bodies = [first.body, second.body];
    let joins = |a: Point, b: Point| [a.body, b.body] == bodies || [b.body, a.body] == bodies;
    let joint =
        linkage.joints.iter().find(|joint| joint.freedom == Freedom::Revolute && joins(joint.first, joint.second))?;
    let [from, to, at] = [*first, *second, joint.first].map(|point| positions.point(point));
    let (one, other) = (from - at, to - at);
    (cross(one, other).abs() < IN_LINE * one.norm() * other.norm()).then(|| joint.name.clone())
}
