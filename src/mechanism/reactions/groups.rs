//! Groups of joints whose reactions to friction follow from one another.
//!
//! In: a linkage. Out: the group of each joint, and how its reaction follows from two numbers of the group. It must not
//! know loads.
use crate::mechanism::linkage::{Freedom, GROUND, Joint, Linkage};
use crate::numerics::order;
use crate::numerics::plane::{Vec2, cross, turned};

/// Groups of some joints of a linkage, which are numbered here in their order.
///
/// The reactions of the joints of a group to friction are equal up to their sign, or normal forces that are an affine
/// function of their levers: two forces of the group make up each of them.
#[derive(Clone, Debug)]
pub struct Groups {
    /// Index of the group of each joint.
    pub of: Vec<usize>,
    /// Sign of each joint's reaction relative to the first joint of its group.
    pub signs: Vec<f64>,
    /// Effect of the second force of its group on each joint: on the component x by its lever in a prismatic joint, on
    /// y in others. The first force is the component x of the first joint.
    pub seconds: Vec<[f64; 2]>,
    /// The first joint of each group, and the one that is farthest from it.
    ends: Vec<[usize; 2]>,
}

impl Groups {
    /// Groups of these joints of a linkage; what is none of them is a group of its own, whose forces are 0. A joint
    /// that is named before, and an index above those of all joints, is a group of its own.
    pub fn new(linkage: &Linkage, joints: impl Iterator<Item = Option<usize>>) -> Self {
        let all = groups(linkage);
        let mut own = Self { of: Vec::new(), signs: Vec::new(), seconds: Vec::new(), ends: Vec::new() };
        let mut leaders: Vec<Member> = Vec::new();
        let joints: Vec<Option<usize>> = joints.collect();
        for (i, &joint) in joints.iter().enumerate() {
            let alone = |first: usize| Member { first, sign: 1.0, lever: 0.0 };
            let member = joint.map_or(alone(NO_JOINT), |joint| all.get(joint).copied().unwrap_or(alone(joint)));
            let is_again = joint.is_some() && joints[..i].contains(&joint);
            let found = leaders.iter().position(|leader| leader.first == member.first).filter(|_| !is_again);
            let group = found.unwrap_or(leaders.len());
            if found.is_none() {
                leaders.push(member);
                own.ends.push([i, i]);
            }
            let is_revolute =
                joint.is_none_or(|joint| linkage.joints.get(joint).is_some_and(|own| own.freedom == Freedom::Revolute));
            let lever = member.lever - leaders[group].lever;
            own.of.push(group);
            own.signs.push(member.sign * leaders[group].sign);
            own.seconds.push(if is_revolute { [0.0, 1.0] } else { [lever, 0.0] });
            let [_, farthest] = &mut own.ends[group];
            if lever.abs() > own.seconds[*farthest][0].abs() {
                *farthest = i;
            }
        }
        own
    }

    /// Number of groups.
    pub fn count(&self) -> usize {
        self.ends.len()
    }

    /// The two forces of each group, from the components of the reactions of the joints: all x, then all y.
    pub fn forces<'a>(&'a self, components: &'a [f64]) -> impl Iterator<Item = [f64; 2]> + 'a {
        let (x, y) = components.split_at(self.of.len());
        self.ends.iter().map(move |&[first, farthest]| {
            let lever = self.seconds[farthest][0];
            [x[first], if lever == 0.0 { y[first] } else { (x[farthest] - x[first]) / lever }]
        })
    }
}

/// In the place of the first joint of a group without joints.
const NO_JOINT: usize = usize::MAX;

/// A joint as a member of its group.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Member {
    /// Index of the first joint of the group.
    first: usize,
    /// Sign of the joint's reaction relative to that of the first joint.
    sign: f64,
    /// Position of a prismatic joint along the axis of the first one, from there, over the size of the linkage. The
    /// normal forces of the joints of a group are an affine function of it.
    lever: f64,
}

/// Groups of joints whose reactions to torques on bodies and to forces along prismatic joints are equal up to their
/// sign: the two joints of a body with two revolute joints and no other, and revolute joints of the same two bodies at
/// one point, which share what these give each other. So do prismatic joints from one body to another: a group with
/// levers.
fn groups(linkage: &Linkage) -> Vec<Member> {
    let alone = |first: usize| Member { first, sign: 1.0, lever: 0.0 };
    let mut groups: Vec<Member> = (0..linkage.joints.len()).map(alone).collect();
    for body in GROUND + 1..linkage.bodies.len() {
        let at = linkage.joints.iter().enumerate().filter(|(_, j)| j.first.body == body || j.second.body == body);
        let at: Vec<(usize, &Joint)> = at.collect();
        let &[(a, first), (b, second)] = &at[..] else { continue };
        if first.freedom == Freedom::Revolute && second.freedom == Freedom::Revolute {
            merge(&mut groups, a, b, -side(first, body) * side(second, body));
        }
    }
    hinges(linkage, &mut groups);
    slides(linkage, &mut groups);
    groups
}

/// Sign of a joint's reaction as a force on a body.
fn side(joint: &Joint, body: usize) -> f64 {
    if joint.second.body == body { 1.0 } else { -1.0 }
}

/// Make one group of those of two joints, whose reactions are equal up to this sign.
fn merge(groups: &mut [Member], a: usize, b: usize, sign: f64) {
    let (one, other) = (groups[a], groups[b]);
    let (into, from) = (one.first.min(other.first), one.first.max(other.first));
    for member in groups.iter_mut().filter(|member| into != from && member.first == from) {
        (member.first, member.sign) = (into, member.sign * sign * one.sign * other.sign);
    }
}

/// Make groups of the revolute joints of two bodies at one point.
fn hinges(linkage: &Linkage, groups: &mut [Member]) {
    /// Distance of two points that are one but for rounding, over the size of the linkage.
    const SAME: f64 = 1e-12;
    // The body of two with the higher index, and the joint's point on it.
    let on = |j: usize| {
        let Joint { first, second, .. } = linkage.joints[j];
        if first.body > second.body { (first, second.body) } else { (second, first.body) }
    };
    let bodies = |j: usize| (on(j).0.body, on(j).1);
    let is_hinge = |j: &usize| linkage.joints[*j].freedom == Freedom::Revolute;
    let hinges: Vec<usize> = (0..groups.len()).filter(is_hinge).collect();
    let hinges = order::sorted_by_pair(hinges, |j| bodies(*j));
    for of_two in hinges.chunk_by(|a, b| bodies(*a) == bodies(*b)) {
        for (k, &j) in of_two.iter().enumerate() {
            let (at, _) = on(j);
            let is_here = |other: &&usize| (on(**other).0.local - at.local).norm() <= SAME * linkage.size;
            if let Some(&first) = of_two[..k].iter().find(is_here) {
                let sign = [first, j].map(|j| side(&linkage.joints[j], at.body));
                merge(groups, first, j, sign[0] * sign[1]);
            }
        }
    }
}

/// Make groups of the prismatic joints from one body to another.
fn slides(linkage: &Linkage, groups: &mut [Member]) {
    /// Sine of the angle between axes that are parallel but for rounding.
    const PARALLEL: f64 = 1e-12;
    let axis = |j: usize| match linkage.joints[j].freedom {
        Freedom::Prismatic(axis) => Some(axis),
        _ => None,
    };
    let bodies = |j: usize| (linkage.joints[j].first.body, linkage.joints[j].second.body);
    let slides: Vec<(usize, Vec2)> = (0..groups.len()).filter_map(|j| Some((j, axis(j)?))).collect();
    let slides = order::sorted_by_pair(slides, |(j, _)| bodies(*j));
    for of_two in slides.chunk_by(|a, b| bodies(a.0) == bodies(b.0)) {
        let (leader, along) = of_two[0];
        let (first, second) = bodies(leader);
        let in_second = turned(along, linkage.bodies[first].offset - linkage.bodies[second].offset);
        for &(j, axis) in &of_two[1..] {
            if cross(along, axis).abs() < PARALLEL {
                let away = linkage.joints[j].second.local - linkage.joints[leader].second.local;
                groups[j] = Member {
                    first: leader,
                    sign: along.dot(&axis).signum(),
                    lever: away.dot(&in_second) / linkage.size,
                };
            }
        }
    }
}
