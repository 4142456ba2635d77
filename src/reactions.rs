//! Reactions: what every joint transmits, as an affine function of (sigma_ddot, sigma_dot^2, each load).
//!
//! In: a configuration and the loads. Out: one column of joint reactions for each of these terms. Newton and Euler's
//! equations of every body, inward along the spanning tree; the joints that close the loops follow from the loop
//! Jacobian: J^T lambda = generalised forces. A column alone need not be in balance; the sum over a motion is.
use crate::closure::{Bordered, Closure};
use crate::curve::Configuration;
use crate::linkage::{Freedom, Point, Rates, Vec2, cross, quarter};
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
    let linkage = &*closure.linkage;
    let n = c.q.len();
    let weights = &closure.weights;
    let normal: Vec<f64> = (0..n).map(|i| c.q_sigma[i] * weights[i] * weights[i]).collect();
    let matrix = closure.matrix(&c.positions, &c.q, &normal);
    let at_rest = Rates { angle: vec![0.0; linkage.bodies.len()], origin: vec![Vec2::zeros(); linkage.bodies.len()] };
    let mut demands = vec![inertial(closure, c, &at_rest, &c.rates), inertial(closure, c, &c.rates, &c.second)];
    for load in loads {
        let mut demand = vec![(Vec2::zeros(), 0.0); linkage.bodies.len()];
        for Wrench { body, force, moment } in load.wrenches(linkage, &c.positions) {
            demand[body].0 -= force;
            demand[body].1 -= moment;
        }
        demands.push(demand);
    }
    let redundant = self_stresses(closure, c, &matrix);
    demands
        .into_iter()
        .map(|demand| {
            let factors = solve(closure, &matrix, &generalised(closure, c, &demand));
            let mut reactions = inward(closure, c, &factors, None, demand);
            redundant.relieve(&mut reactions);
            reactions
        })
        .collect()
}

/// Factors of all loop equations, those that follow from others 0, which balance these generalised forces.
fn solve(closure: &Closure, matrix: &DMatrix<f64>, general: &[f64]) -> Vec<f64> {
    let mut all = vec![0.0; closure.linkage.rows()];
    let factors = Bordered::solve_transposed(matrix, general).unwrap_or_default();
    for (row, factor) in closure.rows().iter().zip(&factors) {
        all[*row] = *factor;
    }
    all
}

/// Reactions that hold one another in balance without any demand; there are some only if joints are redundant. Of all
/// reactions in balance those of least norm are told: the least sum of |force|^2 + (moment / size)^2.
struct SelfStresses {
    states: Vec<Vec<Reaction>>,
    /// Inverse of the matrix of their inner products.
    inverse: DMatrix<f64>,
    size: f64,
}

fn self_stresses(closure: &Closure, c: &Configuration, matrix: &DMatrix<f64>) -> SelfStresses {
    let linkage = &*closure.linkage;
    let size = linkage.size;
    let idle = || vec![(Vec2::zeros(), 0.0); linkage.bodies.len()];
    let mut states = Vec::new();
    if closure.redundant() {
        let jacobian = linkage.jacobian(&c.positions, &c.q);
        for extra in (0..linkage.rows()).filter(|r| !closure.rows().contains(r)) {
            let balance: Vec<f64> = jacobian.row(extra).iter().map(|g| -g).collect();
            let mut factors = solve(closure, matrix, &balance);
            factors[extra] = 1.0;
            states.push(inward(closure, c, &factors, None, idle()));
        }
    }
    // A prismatic joint outside the tree joins bodies that already turn together: its moment is free.
    for &joint in linkage.cuts.iter().filter(|&&j| linkage.joints[j].freedom != Freedom::Turn) {
        states.push(inward(closure, c, &vec![0.0; linkage.rows()], Some(joint), idle()));
    }
    let n = states.len();
    let gram = DMatrix::from_fn(n, n, |i, j| product(&states[i], &states[j], size));
    let none = DMatrix::zeros(n, n);
    let inverse = if n == 0 { none } else { gram.pseudo_inverse(1e-12).unwrap_or(none) };
    SelfStresses { states, inverse, size }
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

/// Force and moment about its origin that each body needs for these accelerations.
fn inertial(closure: &Closure, c: &Configuration, r: &Rates, a: &Rates) -> Vec<(Vec2, f64)> {
    let p = &c.positions;
    let bodies = closure.linkage.bodies.iter().enumerate();
    bodies
        .map(|(i, body)| {
            let force = body.mass * p.acceleration(r, a, Point { body: i, local: body.center });
            (force, body.inertia * a.angle[i] + cross(p.vector(i, body.center), force))
        })
        .collect()
}

/// The reactions that give every body the force and moment that it needs, for these factors of the loop equations and
/// a unit moment in `twisted`, a prismatic joint outside the tree.
fn inward(
    closure: &Closure,
    c: &Configuration,
    factors: &[f64],
    twisted: Option<usize>,
    mut demand: Vec<(Vec2, f64)>,
) -> Vec<Reaction> {
    let linkage = &*closure.linkage;
    let p = &c.positions;
    let mut reactions = vec![Reaction::default(); linkage.joints.len()];
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
    reactions
}

/// Generalised forces of the demands: their virtual work for each change of a coordinate.
fn generalised(closure: &Closure, c: &Configuration, demand: &[(Vec2, f64)]) -> Vec<f64> {
    let linkage = &*closure.linkage;
    let p = &c.positions;
    let mut force: Vec<Vec2> = demand.iter().map(|d| d.0).collect();
    // Moments about the origins of the bodies' frames.
    let mut moment: Vec<f64> = demand.iter().map(|d| d.1).collect();
    let mut out = vec![0.0; c.q.len()];
    for branch in linkage.tree.iter().rev() {
        let (_, to, axis) = linkage.arms(p, branch);
        let (child, parent) = (branch.child, branch.parent);
        if let Some(turn) = linkage.bodies[child].turn {
            out[turn] += moment[child] - cross(to, force[child]);
        }
        if let Some(slide) = branch.slide {
            out[slide] += axis.dot(&force[child]);
        }
        // The pivot moves with the parent; only the force is passed on, turning has its own coordinate.
        let (pivot, passed) = (p.origin[child] + to, force[child]);
        force[parent] += passed;
        moment[parent] += cross(pivot - p.origin[parent], passed);
    }
    out
}
