//! States of self-stress: reactions in balance with one another, which exist only with redundant joints.
//!
//! In: a configuration and reactions of all joints. Out: those of least norm, the sum of |force|^2 + (moment / size)^2,
//! that load the bodies equally. Joints between the same two bodies share what they give together in closed form; what
//! such pairs of bodies give each other follows from a system with one unknown for each state that is left. It must not
//! know loads.
use super::{Demand, Reaction, Terms};
use crate::mechanism::closure::Closure;
use crate::mechanism::curve::Configuration;
use crate::mechanism::linkage::{Freedom, Linkage, Positions};
use crate::numerics::order;
use crate::numerics::plane::{Vec2, cross, perp};
use crate::numerics::pseudo_inverse::pseudo_inverse;
use nalgebra::{Cholesky, DMatrix, Dyn, Vector3};

/// States of self-stress at a configuration.
pub(super) struct SelfStresses {
    pairs: Vec<Pair>,
    /// A column for each state that is not one of a pair: forces and moments over the size of all joints.
    states: DMatrix<f64>,
    /// Inverse of the matrix of their inner products.
    inverse: Inverse,
    size: f64,
}

/// Inverse of a matrix of inner products.
enum Inverse {
    /// By Cholesky's factor.
    Factor(Cholesky<f64, Dyn>),
    /// The pseudo-inverse, where vectors are dependent but for rounding.
    Pseudo(DMatrix<f64>),
}

/// What a balance of the bodies leaves open.
#[derive(Clone, Copy)]
enum Open {
    /// Multiplier of this loop equation, which depends on others.
    Row(usize),
    /// Moment of a prismatic joint outside the tree, which connects bodies of one angle.
    Moment,
}

/// Rows of a joint among the states of self-stress.
const ROWS: usize = 3;
/// Components of the reaction of a joint that is no coupling.
const COMPONENTS: usize = 2;

impl SelfStresses {
    pub(super) fn new(closure: &Closure, c: &Configuration, normal: &[f64]) -> Self {
        let linkage = &*closure.linkage;
        let is_open = |&joint: &usize| matches!(linkage.joints[joint].freedom, Freedom::Prismatic(_));
        if !closure.redundant() && !linkage.cuts.iter().any(is_open) {
            let none = || DMatrix::zeros(0, 0);
            return Self { pairs: Vec::new(), states: none(), inverse: Inverse::Pseudo(none()), size: linkage.size };
        }
        let mut pairs = Vec::new();
        let mut open = open(closure);
        if open.iter().flatten().any(Option::is_some) {
            for joints in between_same_bodies(linkage) {
                pairs.push(Pair::new(linkage, &c.positions, joints, &mut open));
            }
        }
        let left: Vec<(usize, Open)> =
            open.iter().enumerate().flat_map(|(j, of)| of.iter().flatten().map(move |open| (j, *open))).collect();
        if left.is_empty() {
            let none = || DMatrix::zeros(0, 0);
            return Self { pairs, states: none(), inverse: Inverse::Pseudo(none()), size: linkage.size };
        }
        let mut states = DMatrix::zeros(ROWS * linkage.joints.len(), left.len());
        let jacobian = closure.redundant().then(|| linkage.jacobian(&c.positions, &c.q));
        let mut terms = Terms::<1>::default();
        for (mut state, (joint, open)) in states.column_iter_mut().zip(left) {
            terms.demand.clear();
            terms.demand.resize(linkage.bodies.len(), Demand::NONE);
            terms.general.clear();
            terms.general.resize(c.q.len(), [0.0]);
            let mut twisted = None;
            match (open, &jacobian) {
                (Open::Row(row), Some(jacobian)) => {
                    terms.general.iter_mut().zip(jacobian.row(row).iter()).for_each(|(general, g)| *general = [-g]);
                    terms.balance(closure, c, normal);
                    terms.all_multipliers[row] = [1.0];
                }
                _ => {
                    terms.all_multipliers.clear();
                    terms.all_multipliers.resize(linkage.rows(), [0.0]);
                    twisted = Some(joint);
                }
            }
            terms.inward(closure, c, twisted, &mut |joint, [[x], [y]], [moment]| {
                state.rows_mut(ROWS * joint, ROWS).copy_from_slice(&[x, y, moment / linkage.size]);
            });
            pairs.iter().for_each(|pair| pair.share(state.as_mut_slice()));
        }
        let inverse = inverse(states.tr_mul(&states));
        Self { pairs, states, inverse, size: linkage.size }
    }

    /// Replace the reactions of all joints, term by term, by those of least norm that load the bodies equally.
    pub(super) fn make_least(&self, reactions: &mut [Reaction], joints: usize) {
        if self.pairs.is_empty() && self.states.is_empty() {
            return;
        }
        let each = reactions.iter().flat_map(|r| [r.force.x, r.force.y, r.moment / self.size]);
        let mut all = DMatrix::from_iterator(ROWS * joints, reactions.len() / joints, each);
        for mut term in all.column_iter_mut() {
            self.pairs.iter().for_each(|pair| pair.share(term.as_mut_slice()));
        }
        if !self.states.is_empty() {
            let products = self.states.tr_mul(&all);
            let parts = match &self.inverse {
                Inverse::Factor(factor) => factor.solve(&products),
                // It is symmetric.
                Inverse::Pseudo(inverse) => inverse.tr_mul(&products),
            };
            for (mut term, part) in all.column_iter_mut().zip(parts.column_iter()) {
                term.gemv(-1.0, &self.states, &part, 1.0);
            }
        }
        for (r, part) in reactions.iter_mut().zip(all.as_slice().chunks_exact(ROWS)) {
            *r = Reaction { force: Vec2::new(part[0], part[1]), moment: self.size * part[2] };
        }
    }
}

/// What the balance leaves open of the components of each joint's reaction.
fn open(closure: &Closure) -> Vec<[Option<Open>; COMPONENTS]> {
    let linkage = &*closure.linkage;
    let mut open = vec![[None; COMPONENTS]; linkage.joints.len()];
    let mut rows = 0..;
    for &joint in &linkage.cuts {
        let freedom = linkage.joints[joint].freedom;
        for (component, row) in rows.by_ref().take(freedom.rows()).enumerate() {
            if closure.rows().binary_search(&row).is_err() {
                open[joint][component] = Some(Open::Row(row));
            }
        }
        if let Freedom::Prismatic(_) = freedom {
            open[joint][1] = Some(Open::Moment);
        }
    }
    open
}

/// Joints between the same two bodies, where there are several; couplings and slots are none.
fn between_same_bodies(linkage: &Linkage) -> Vec<Vec<usize>> {
    let bodies = |j: usize| {
        let [a, b] = [linkage.joints[j].first.body, linkage.joints[j].second.body];
        (a.min(b), a.max(b))
    };
    let is_joint = |j: &usize| !matches!(linkage.joints[*j].freedom, Freedom::Coupling(_) | Freedom::Slot(_));
    let joints = order::sorted_by_pair((0..linkage.joints.len()).filter(is_joint).collect(), |j| bodies(*j));
    let of_two = joints.chunk_by(|a, b| bodies(*a) == bodies(*b));
    of_two.filter(|joints| joints.len() > 1).map(<[usize]>::to_vec).collect()
}

/// Joints between the same two bodies. They can give together a wrench W = A r of at most three components, where r are
/// the components of their reactions; of all r that give W the least one is A^T (A A^T)^-1 W.
struct Pair {
    joints: Vec<usize>,
    /// An orthonormal basis of the rows of A: force and moment over the size of each joint.
    basis: Vec<Vec<Vector3<f64>>>,
}

impl Pair {
    /// The pair of bodies between which these joints are. What the balance leaves open of their components, but what
    /// the other components can give, is open no more.
    fn new(linkage: &Linkage, p: &Positions, joints: Vec<usize>, open: &mut [[Option<Open>; COMPONENTS]]) -> Self {
        let reference = linkage.joints[joints[0]].second;
        // Each component as a unit reaction of its joint, and the wrench that it is about the reference.
        let components: Vec<[[Vector3<f64>; 2]; COMPONENTS]> = joints
            .iter()
            .map(|&j| {
                let joint = &linkage.joints[j];
                let arm = (p.point(joint.second) - p.point(reference)) / linkage.size;
                let sign = if joint.second.body == reference.body { 1.0 } else { -1.0 };
                let units = match joint.freedom {
                    Freedom::Prismatic(axis) => {
                        let normal = perp(p.vector(joint.first.body, axis));
                        [Vector3::new(normal.x, normal.y, 0.0), Vector3::z()]
                    }
                    _ => [Vector3::x(), Vector3::y()],
                };
                units.map(|unit| [unit, sign * (unit + Vector3::z() * cross(arm, unit.xy()))])
            })
            .collect();
        let mut span: Vec<Vector3<f64>> = Vec::new();
        for needed in [true, false] {
            for (&j, components) in joints.iter().zip(&components) {
                for (open, [_, wrench]) in open[j].iter_mut().zip(components) {
                    if open.is_none() == needed && !extends(&mut span, *wrench) {
                        *open = None;
                    }
                }
            }
        }
        let mut basis: Vec<Vec<Vector3<f64>>> = Vec::new();
        for direction in &span {
            let part = |of: &[[Vector3<f64>; 2]; COMPONENTS]| of.iter().map(|[unit, w]| unit * w.dot(direction)).sum();
            let mut row: Vec<Vector3<f64>> = components.iter().map(part).collect();
            // Twice is enough.
            for other in basis.iter().chain(&basis) {
                let along = inner(other, &row);
                row.iter_mut().zip(other).for_each(|(row, other)| *row -= along * other);
            }
            let norm = inner(&row, &row).sqrt();
            row.iter_mut().for_each(|row| *row /= norm);
            basis.push(row);
        }
        Self { joints, basis }
    }

    /// Replace the reactions of the pair's joints, among those of all joints, by the least ones with the same wrench.
    fn share(&self, all: &mut [f64]) {
        let mut least = vec![Vector3::zeros(); self.joints.len()];
        let given = |&j: &usize| Vector3::from_column_slice(&all[ROWS * j..ROWS * (j + 1)]);
        for row in &self.basis {
            let along: f64 = self.joints.iter().zip(row).map(|(j, row)| row.dot(&given(j))).sum();
            least.iter_mut().zip(row).for_each(|(least, row)| *least += along * row);
        }
        for (&j, least) in self.joints.iter().zip(&least) {
            all[ROWS * j..ROWS * (j + 1)].copy_from_slice(least.as_slice());
        }
    }
}

/// Whether a wrench is none that the orthonormal wrenches of `span` make up; then they are extended by it.
fn extends(span: &mut Vec<Vector3<f64>>, wrench: Vector3<f64>) -> bool {
    /// Part of a wrench that is not rounding.
    const LEAST: f64 = 1e-9;
    let rest = span.iter().fold(wrench, |rest, unit| rest - unit * unit.dot(&rest));
    let is_new = rest.norm() > LEAST * wrench.norm();
    if is_new {
        span.push(rest.normalize());
    }
    is_new
}

fn inner(a: &[Vector3<f64>], b: &[Vector3<f64>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}

fn inverse(gram: DMatrix<f64>) -> Inverse {
    /// Least square of a diagonal entry of Cholesky's factor, as a part of the largest.
    const INDEPENDENT: f64 = 1e-8;
    let factor = gram.clone().cholesky().filter(|factor| {
        let diagonal = factor.l_dirty().diagonal();
        diagonal.min().powi(2) > INDEPENDENT * diagonal.max().powi(2)
    });
    match factor {
        Some(factor) => Inverse::Factor(factor),
        None => Inverse::Pseudo(pseudo_inverse(gram, 1e-12)),
    }
}
