//! Reactions: what every joint transmits, as an affine function of (sigma_ddot, sigma_dot^2, each load).
//!
//! In: a configuration and the loads. Out: one column of joint reactions for each of these terms. Newton and Euler's
//! equations of every body, inward along the spanning tree; the joints that close the loops follow from the loop
//! Jacobian: J^T lambda = generalised forces. A column alone need not be in balance; the sum over a motion is.
use crate::closure::{Closure, Workspace};
use crate::curve::Configuration;
use crate::linkage::{Freedom, GROUND, Joint, Linkage, Point, Rates, Vec2, cross, quarter};
use crate::loads::{Load, Wrench};
use nalgebra::{DMatrix, DVector};

/// What the first-named body of a joint exerts on the second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reaction {
    /// Force in the mechanism frame [N].
    pub force: Vec2,
    /// Moment about the second body's point [N.m]; 0 in a revolute joint.
    pub moment: f64,
}

impl Default for Reaction {
    fn default() -> Self {
        Self { force: Vec2::zeros(), moment: 0.0 }
    }
}

/// Reactions of all joints, for sigma_ddot = 1, for sigma_dot^2 = 1, then for each load = 1.
pub fn columns(closure: &Closure, c: &Configuration, loads: &[Load]) -> Vec<Vec<Reaction>> {
    let joints = closure.linkage.joints.len();
    Columns::default().fill(closure, c, loads).chunks_exact(joints).map(<[Reaction]>::to_vec).collect()
}

/// Groups of joints that transmit one force, but for its sign, under torques on bodies and forces along prismatic joints: a
/// body with two revolute joints and no other passes on what it gets. For each joint, the first of its group, and the sign.
pub fn groups(linkage: &Linkage) -> Vec<(usize, f64)> {
    let mut groups: Vec<(usize, f64)> = (0..linkage.joints.len()).map(|j| (j, 1.0)).collect();
    for body in GROUND + 1..linkage.bodies.len() {
        // What a joint exerts on the body, for each unit of its reaction.
        let side = |j: &Joint| if j.second.body == body { 1.0 } else { -1.0 };
        let at = linkage.joints.iter().enumerate().filter(|(_, j)| j.first.body == body || j.second.body == body);
        let at: Vec<(usize, &Joint)> = at.collect();
        let &[(a, first), (b, second)] = &at[..] else { continue };
        if first.freedom != Freedom::Turn || second.freedom != Freedom::Turn {
            continue;
        }
        let sign = -side(first) * side(second);
        let ((into, of_first), (from, of_second)) = (groups[a], groups[b]);
        if into == from {
            continue;
        }
        let (into, from) = (into.min(from), into.max(from));
        for (group, own) in groups.iter_mut().filter(|(group, _)| *group == from) {
            (*group, *own) = (into, *own * sign * of_first * of_second);
        }
    }
    groups
}

/// What a body needs: force, and moment about the origin of its frame.
type Demand = (Vec2, f64);

/// Room for the reactions of one configuration after another.
#[derive(Debug, Default)]
pub struct Columns {
    work: Workspace,
    normal: Vec<f64>,
    at_rest: Rates,
    demand: Vec<Demand>,
    /// Forces and moments of the bodies while they are summed inward.
    summed: Vec<Demand>,
    general: Vec<f64>,
    factors: Vec<f64>,
    all_factors: Vec<f64>,
    /// Reactions of all joints, term after term.
    reactions: Vec<Reaction>,
}

impl Columns {
    /// Reactions of all joints, for sigma_ddot = 1, for sigma_dot^2 = 1, then for each load = 1: term after term.
    pub fn fill(&mut self, closure: &Closure, c: &Configuration, loads: &[Load]) -> &[Reaction] {
        let linkage = &*closure.linkage;
        let joints = linkage.joints.len();
        self.normal.clear();
        self.normal.extend(c.q_sigma.iter().zip(&closure.weights).map(|(q, w)| q * w * w));
        let regular = closure.linearise(&c.q, &mut self.work);
        self.at_rest.angle.resize(linkage.bodies.len(), 0.0);
        self.at_rest.origin.resize(linkage.bodies.len(), Vec2::zeros());
        self.reactions.clear();
        self.reactions.resize((2 + loads.len()) * joints, Reaction::default());
        let redundant = self.self_stresses(closure, c, regular);
        for term in 0..2 + loads.len() {
            match term {
                0 => inertial(closure, c, &self.at_rest, &c.rates, &mut self.demand),
                1 => inertial(closure, c, &c.rates, &c.second, &mut self.demand),
                _ => {
                    self.demand.clear();
                    self.demand.resize(linkage.bodies.len(), (Vec2::zeros(), 0.0));
                    for Wrench { body, force, moment } in loads[term - 2].wrenches(linkage, &c.positions) {
                        self.demand[body].0 -= force;
                        self.demand[body].1 -= moment;
                    }
                }
            }
            self.general.clear();
            self.general.resize(c.q.len(), 0.0);
            generalised(closure, c, &self.demand, &mut self.summed, &mut self.general);
            self.balance(closure, regular);
            let reactions = &mut self.reactions[term * joints..(term + 1) * joints];
            inward(closure, c, &self.all_factors, None, &mut self.demand, reactions);
            redundant.relieve(reactions);
        }
        &self.reactions
    }

    /// Factors of all loop equations, those that follow from others 0, which balance the generalised forces.
    fn balance(&mut self, closure: &Closure, regular: bool) {
        self.all_factors.clear();
        self.all_factors.resize(closure.linkage.rows(), 0.0);
        if regular {
            self.work.factors.solve_transposed(&self.normal, &mut self.general, &mut self.factors);
            for (row, factor) in closure.rows().iter().zip(&self.factors) {
                self.all_factors[*row] = *factor;
            }
        }
    }

    fn self_stresses(&mut self, closure: &Closure, c: &Configuration, regular: bool) -> SelfStresses {
        let linkage = &*closure.linkage;
        let size = linkage.size;
        let idle = || vec![(Vec2::zeros(), 0.0); linkage.bodies.len()];
        let mut states = Vec::new();
        let mut state = |factors: &[f64], twisted: Option<usize>| {
            let mut reactions = vec![Reaction::default(); linkage.joints.len()];
            inward(closure, c, factors, twisted, &mut idle(), &mut reactions);
            states.push(reactions);
        };
        if closure.redundant() {
            let jacobian = linkage.jacobian(&c.positions, &c.q);
            for extra in (0..linkage.rows()).filter(|r| !closure.rows().contains(r)) {
                self.general.clear();
                self.general.extend(jacobian.row(extra).iter().map(|g| -g));
                self.balance(closure, regular);
                self.all_factors[extra] = 1.0;
                state(&self.all_factors, None);
            }
        }
        // A prismatic joint outside the tree joins bodies that already turn together: its moment is free.
        for &joint in linkage.cuts.iter().filter(|&&j| linkage.joints[j].freedom != Freedom::Turn) {
            state(&vec![0.0; linkage.rows()], Some(joint));
        }
        let n = states.len();
        if n == 0 {
            return SelfStresses { states, inverse: DMatrix::zeros(0, 0), size };
        }
        let gram = DMatrix::from_fn(n, n, |i, j| product(&states[i], &states[j], size));
        let inverse = gram.pseudo_inverse(1e-12).unwrap_or(DMatrix::zeros(n, n));
        SelfStresses { states, inverse, size }
    }
}

/// Reactions that hold one another in balance without any demand; there are some only if joints are redundant. Of all
/// reactions in balance those of least norm are told: the least sum of |force|^2 + (moment / size)^2.
struct SelfStresses {
    states: Vec<Vec<Reaction>>,
    /// Inverse of the matrix of their inner products.
    inverse: DMatrix<f64>,
    size: f64,
}

impl SelfStresses {
    /// Take away what the reactions have of these states.
    fn relieve(&self, reactions: &mut [Reaction]) {
        if self.states.is_empty() {
            return;
        }
        let parts = DVector::from_iterator(
            self.states.len(),
            self.states.iter().map(|state| product(state, reactions, self.size)),
        );
        for (state, part) in self.states.iter().zip((&self.inverse * parts).iter()) {
            for (r, s) in reactions.iter_mut().zip(state) {
                r.force -= *part * s.force;
                r.moment -= part * s.moment;
            }
        }
    }
}

fn product(a: &[Reaction], b: &[Reaction], size: f64) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.force.dot(&b.force) + a.moment * b.moment / (size * size)).sum()
}

/// What each body needs for these accelerations.
fn inertial(closure: &Closure, c: &Configuration, r: &Rates, a: &Rates, demand: &mut Vec<Demand>) {
    let p = &c.positions;
    demand.clear();
    demand.extend(closure.linkage.bodies.iter().enumerate().map(|(i, body)| {
        let force = body.mass * p.acceleration(r, a, Point { body: i, local: body.center });
        (force, body.inertia * a.angle[i] + cross(p.vector(i, body.center), force))
    }));
}

/// The reactions that give every body what it needs, for these factors of the loop equations and a unit moment in
/// `twisted`, a prismatic joint outside the tree. The demand is used up.
fn inward(
    closure: &Closure,
    c: &Configuration,
    factors: &[f64],
    twisted: Option<usize>,
    demand: &mut [Demand],
    reactions: &mut [Reaction],
) {
    let linkage = &*closure.linkage;
    let p = &c.positions;
    // Joints that close loops: their forces relieve the demands of the two bodies.
    if let Some(j) = twisted {
        reactions[j].moment = 1.0;
        demand[linkage.joints[j].second.body].1 -= 1.0;
        demand[linkage.joints[j].first.body].1 += 1.0;
    }
    let mut row = 0;
    for &j in &linkage.cuts {
        let joint = &linkage.joints[j];
        let force = match joint.freedom {
            Freedom::Turn => {
                row += 2;
                Vec2::new(factors[row - 2], factors[row - 1])
            }
            Freedom::Slide(axis) => {
                row += 1;
                factors[row - 1] * quarter(p.vector(joint.first.body, axis))
            }
        };
        reactions[j].force = force;
        let at = p.point(joint.second);
        for (body, force) in [(joint.second.body, force), (joint.first.body, -force)] {
            demand[body].0 -= force;
            demand[body].1 -= cross(at - p.origin[body], force);
        }
    }
    // Joints of the tree, from the outermost inward: each gives its child what the child still needs.
    for branch in linkage.tree.iter().rev() {
        let (force, moment) = demand[branch.child];
        let joint = &linkage.joints[branch.joint];
        let slides = joint.freedom != Freedom::Turn;
        let at = p.point(joint.second);
        let about = |body: usize| cross(at - p.origin[body], force);
        let couple = if slides { moment - about(branch.child) } else { 0.0 };
        demand[branch.parent].0 += force;
        demand[branch.parent].1 += about(branch.parent) + couple;
        let sign = if branch.reversed { -1.0 } else { 1.0 };
        reactions[branch.joint] = Reaction { force: sign * force, moment: sign * couple };
    }
}

/// Generalised forces of the demands: their virtual work for each change of a coordinate; added to `out`.
fn generalised(closure: &Closure, c: &Configuration, demand: &[Demand], summed: &mut Vec<Demand>, out: &mut [f64]) {
    let linkage = &*closure.linkage;
    let p = &c.positions;
    // Moments about the origins of the bodies' frames.
    summed.clear();
    summed.extend_from_slice(demand);
    for (branch, arms) in linkage.tree.iter().zip(&p.arms).rev() {
        let (child, parent) = (branch.child, branch.parent);
        let (force, moment) = summed[child];
        if let Some(turn) = linkage.bodies[child].turn {
            out[turn] += moment - cross(arms.to, force);
        }
        if let Some(slide) = branch.slide {
            out[slide] += arms.axis.dot(&force);
        }
        // The pivot moves with the parent; only the force is passed on, turning has its own coordinate.
        let pivot = p.origin[child] + arms.to;
        summed[parent].0 += force;
        summed[parent].1 += cross(pivot - p.origin[parent], force);
    }
}
