//! Joint reactions as affine functions of sigma_ddot, sigma_dot^2 and the size of each load.
//!
//! In: a configuration and the loads. Out: one column of joint reactions for each of these terms, from Newton's and
//! Euler's equations of every body, inward along the spanning tree. The reactions of joints that close loops follow
//! from the loop Jacobian: J^T lambda = generalised forces. A single column need not satisfy the equations of all
//! bodies; the sum of the columns over a motion does. It must not know the state.
mod groups;
mod self_stress;

use crate::mechanism::closure::Closure;
use crate::mechanism::curve::Configuration;
use crate::mechanism::linkage::{Freedom, Point, Rates, Thrust};
use crate::mechanism::loads::unit_load::{Load, Wrench};
use crate::numerics::plane::{Vec2, cross, perp};
pub use groups::Groups;
use self_stress::SelfStresses;

/// Reaction of a joint or a coupling: force and moment of its first-named body on its second.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reaction {
    /// Force in the mechanism frame [N].
    pub force: Vec2,
    /// Moment about the second body's point [N.m]; 0 in a revolute joint and in a slot. Of a coupling the force that it
    /// transmits along the motion, of a cam that along the normal of its profile [N].
    pub moment: f64,
}

/// Reactions of all joints, for sigma_ddot = 1, for sigma_dot^2 = 1, then for each load = 1.
pub fn columns(closure: &Closure, c: &Configuration, loads: &[Load]) -> Vec<Vec<Reaction>> {
    let joints = closure.linkage.joints.len();
    Columns::default().fill(closure, c, loads, 0).chunks_exact(joints).map(<[Reaction]>::to_vec).collect()
}

/// Number of terms that are solved for side by side.
const SIDE: usize = 4;

/// Force (x, y) and moment about the origin of its frame that a body requires, in N terms.
#[derive(Clone, Copy, Debug)]
struct Demand<const N: usize> {
    force: [[f64; N]; 2],
    moment: [f64; N],
}

impl<const N: usize> Demand<N> {
    const NONE: Self = Self { force: [[0.0; N]; 2], moment: [0.0; N] };

    /// Add `sign` times a force at this arm from the origin.
    fn add(&mut self, sign: f64, arm: Vec2, [x, y]: &[[f64; N]; 2]) {
        for i in 0..N {
            self.force[0][i] += sign * x[i];
            self.force[1][i] += sign * y[i];
            self.moment[i] += sign * (arm.x * y[i] - arm.y * x[i]);
        }
    }
}

/// Scratch for N terms at one configuration.
#[derive(Debug, Default)]
struct Terms<const N: usize> {
    demand: Vec<Demand<N>>,
    /// Demands summed over the bodies outward of each body.
    summed: Vec<Demand<N>>,
    /// Generalised forces.
    general: Vec<[f64; N]>,
    /// Multipliers lambda of the independent loop equations.
    multipliers: Vec<[f64; N]>,
    /// Multipliers of all loop equations, 0 for dependent ones.
    all_multipliers: Vec<[f64; N]>,
}

/// Scratch for the reactions of one configuration after another.
#[derive(Debug, Default)]
pub struct Columns {
    normal: Vec<f64>,
    at_rest: Rates,
    terms: Terms<SIDE>,
    /// Reactions of all joints, term by term.
    reactions: Vec<Reaction>,
}

impl Columns {
    /// The reactions found last, as [`Self::fill`] returns them.
    pub fn reactions(&self) -> &[Reaction] {
        &self.reactions
    }

    /// Reactions of all joints, term by term from the term `skipped`: sigma_ddot = 1, sigma_dot^2 = 1, each load = 1.
    pub fn fill(&mut self, closure: &Closure, c: &Configuration, loads: &[Load], skipped: usize) -> &[Reaction] {
        let linkage = &*closure.linkage;
        let joints = linkage.joints.len();
        self.normal.clear();
        self.normal.extend(c.q_sigma.iter().zip(&closure.weights).map(|(q, w)| q * w * w));
        self.at_rest.angle.resize(linkage.bodies.len(), 0.0);
        self.at_rest.origin.resize(linkage.bodies.len(), Vec2::zeros());
        self.reactions.clear();
        self.reactions.resize((2 + loads.len() - skipped) * joints, Reaction::default());
        let self_stresses = SelfStresses::new(closure, c, &self.normal);
        for (block, reactions) in self.reactions.chunks_mut(SIDE * joints).enumerate() {
            let terms = &mut self.terms;
            terms.demand.clear();
            terms.demand.resize(linkage.bodies.len(), Demand::NONE);
            for (i, term) in (skipped + SIDE * block..2 + loads.len()).take(SIDE).enumerate() {
                match term {
                    0 => inertial(closure, c, &self.at_rest, &c.rates, i, &mut terms.demand),
                    1 => inertial(closure, c, &c.rates, &c.second, i, &mut terms.demand),
                    _ => loads[term - 2].exert(linkage, &c.positions, &mut |Wrench { body, force, moment }| {
                        let demand = &mut terms.demand[body];
                        demand.force[0][i] -= force.x;
                        demand.force[1][i] -= force.y;
                        demand.moment[i] -= moment;
                    }),
                }
            }
            terms.generalise(closure, c);
            terms.balance(closure, c, &self.normal);
            terms.inward(closure, c, None, &mut |joint, [x, y], moment| {
                for (i, term) in reactions.chunks_exact_mut(joints).enumerate() {
                    term[joint] = Reaction { force: Vec2::new(x[i], y[i]), moment: moment[i] };
                }
            });
        }
        self_stresses.make_least(&mut self.reactions, joints);
        for (term, reactions) in (skipped..).zip(self.reactions.chunks_exact_mut(joints)) {
            // The force of a coupling that does no work is a part of its reaction.
            if let Some(Load::Separation { coupling, lean }) = term.checked_sub(2).map(|load| &loads[load]) {
                let coupling = &linkage.couplings[*coupling];
                reactions[coupling.joint].force += linkage.contact(coupling, &c.positions).separation(*lean);
            }
        }
        &self.reactions
    }
}

/// Demand of each body for these accelerations, as the term with index `i`.
fn inertial<const N: usize>(
    closure: &Closure,
    c: &Configuration,
    r: &Rates,
    a: &Rates,
    i: usize,
    demand: &mut [Demand<N>],
) {
    let p = &c.positions;
    for (index, (body, demand)) in closure.linkage.bodies.iter().zip(&mut *demand).enumerate() {
        let force = body.mass * p.acceleration(r, a, Point { body: index, local: body.center });
        (demand.force[0][i], demand.force[1][i]) = (force.x, force.y);
        demand.moment[i] = body.inertia * a.angle[index] + cross(p.vector(index, body.center), force);
    }
    for rotor in &closure.linkage.rotors {
        let Thrust { force, couple, on } = closure.linkage.thrust(rotor, p, r, a);
        for ((body, at), sign) in on.into_iter().zip([-1.0, 1.0]) {
            let force = sign * force;
            demand[body].force[0][i] += force.x;
            demand[body].force[1][i] += force.y;
            demand[body].moment[i] += cross(at - p.origin[body], force) + sign * couple;
        }
    }
}

impl<const N: usize> Terms<N> {
    /// Generalised forces of the demands: virtual work for a unit change of each coordinate.
    fn generalise(&mut self, closure: &Closure, c: &Configuration) {
        let (linkage, p) = (&*closure.linkage, &c.positions);
        self.general.clear();
        self.general.resize(c.q.len(), [0.0; N]);
        // Moments about the origins of the bodies' frames.
        self.summed.clone_from(&self.demand);
        for (branch, arms) in linkage.tree.iter().zip(&p.arms).rev() {
            let (child, parent) = (branch.child, branch.parent);
            let Demand { force, moment } = self.summed[child];
            let [x, y] = &force;
            if let Some(angle) = linkage.bodies[child].angle_coordinate {
                for (i, work) in self.general[angle].iter_mut().enumerate() {
                    *work += moment[i] - (arms.to.x * y[i] - arms.to.y * x[i]);
                }
            }
            if let Some(slide) = branch.slide {
                for (i, work) in self.general[slide].iter_mut().enumerate() {
                    *work += arms.axis.x * x[i] + arms.axis.y * y[i];
                }
            }
            // The pivot moves with the parent. The moment does no work on the parent's coordinates.
            let pivot = p.origin[child] + arms.to;
            self.summed[parent].add(1.0, pivot - p.origin[parent], &force);
        }
    }

    /// Multipliers of all loop equations that balance the generalised forces; 0 for dependent equations.
    fn balance(&mut self, closure: &Closure, c: &Configuration, normal: &[f64]) {
        self.all_multipliers.clear();
        self.all_multipliers.resize(closure.linkage.rows(), [0.0; N]);
        if let Some(factors) = c.factors() {
            factors.solve_transposed(normal, &mut self.general, &mut self.multipliers);
            for (row, factor) in closure.rows().iter().zip(&self.multipliers) {
                self.all_multipliers[*row] = *factor;
            }
        }
    }

    /// Call `give` with the force and moment of every joint that satisfy the demands of all bodies, for the multipliers
    /// of all loop equations and a unit moment in the prismatic joint `twisted` outside the tree. Overwrites the
    /// demands.
    fn inward(
        &mut self,
        closure: &Closure,
        c: &Configuration,
        twisted: Option<usize>,
        give: &mut impl FnMut(usize, [[f64; N]; 2], [f64; N]),
    ) {
        let (linkage, p) = (&*closure.linkage, &c.positions);
        let demand = &mut self.demand;
        // Reactions of joints that close loops reduce the demands of their two bodies.
        let mut row = 0;
        for &j in &linkage.cuts {
            let joint = &linkage.joints[j];
            let multipliers = &self.all_multipliers[row..];
            let along = |v: Vec2| [v.x, v.y].map(|n| multipliers[0].map(|f| f * n));
            let (mut at, mut moment) = (p.point(joint.second), [if twisted == Some(j) { 1.0 } else { 0.0 }; N]);
            let mut given = moment;
            let force = match joint.freedom {
                Freedom::Revolute | Freedom::Slot(_) => [multipliers[0], multipliers[1]],
                Freedom::Prismatic(axis) => along(perp(p.vector(joint.first.body, axis))),
                Freedom::Coupling(index) => {
                    let contact = linkage.contact(&linkage.couplings[index], p);
                    (at, moment) = (contact.at, multipliers[0].map(|f| f * contact.moment));
                    given = multipliers[0].map(|f| f * contact.transmitted);
                    along(contact.force)
                }
            };
            row += joint.freedom.rows();
            for (body, sign) in [(joint.second.body, -1.0), (joint.first.body, 1.0)] {
                demand[body].add(sign, at - p.origin[body], &force);
            }
            for (i, moment) in moment.into_iter().enumerate() {
                demand[joint.second.body].moment[i] -= moment;
                demand[joint.first.body].moment[i] += moment;
            }
            give(j, force, given);
        }
        // Joints of the tree, from the outermost inward: each gives its child the rest of the child's demand.
        for branch in linkage.tree.iter().rev() {
            let Demand { force, moment } = demand[branch.child];
            let joint = &linkage.joints[branch.joint];
            let at = p.point(joint.second);
            let mut couple = [0.0; N];
            if !joint.freedom.turns() {
                let arm = at - p.origin[branch.child];
                couple = std::array::from_fn(|i| moment[i] - (arm.x * force[1][i] - arm.y * force[0][i]));
            }
            let parent = &mut demand[branch.parent];
            parent.add(1.0, at - p.origin[branch.parent], &force);
            parent.moment.iter_mut().zip(couple).for_each(|(moment, couple)| *moment += couple);
            let sign = if branch.reversed { -1.0 } else { 1.0 };
            give(branch.joint, force.map(|f| f.map(|f| sign * f)), couple.map(|m| sign * m));
        }
    }
}
