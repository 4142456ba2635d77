//! The friction loop: friction and the reactions that cause it, solved together.
//!
//! In: arms of the friction, reactions as affine functions of the friction. Out: magnitudes of the reactions and
//! friction. It must not know bodies, joints or the law of friction. Source: [HF08] section 4, eqs. (26), (27).
mod any;
mod carried;
mod contraction;
mod one_group;
mod prediction;

use crate::numerics::dual::Number;
use carried::Values;
use contraction::Kept;
use prediction::Prediction;
use std::fmt;

/// Reactions R_i of n joints as affine functions of their friction M_j:
///
///   R_i = free_i + inertial_i u + P_g(i),   u = sum_j influence_j M_j,   P_g = sum_j passed_gj M_j,
///
/// where u is the part of sigma_ddot due to friction, and P_g the force due to friction without motion, which is the
/// same, up to its sign, for all joints of a group g. The sign has no effect on |R_i|. Vectors are pairs of x and y
/// [N]; where only the component normal to an axis matters, it is x, and y is 0: then P_g is the pair of a force and
/// its change with the joint's lever l_i, and it adds P_g,x + l_i P_g,y to x.
#[derive(Clone, Copy, Debug)]
pub struct Balance<'a, T> {
    /// R_i without friction [N].
    pub free: [&'a [T]; 2],
    /// Reactions to sigma_ddot = 1.
    pub inertial: [&'a [T]; 2],
    /// Derivative of sigma_ddot with respect to M_j.
    pub influence: &'a [T],
    /// passed_gj, group by group, for all j [1/m, or 1].
    pub passed: [&'a [T]; 2],
    /// Index g(i) of the group of each joint.
    pub groups: &'a [usize],
    /// Effect of P_g,y on x and on y of each joint: (0, 1), or (l_i, 0).
    pub seconds: &'a [[f64; 2]],
}

/// Solver of the equations between the reactions R_i of n joints and their friction M_j = -m_j |R_j|, with the arms
/// m_j = mu(v_j) r_j [m, or 1 in a prismatic joint].
///
/// Friction affects the reactions only through u and P_g, three numbers for each group of joints. These are the
/// unknowns z of z = B |R(z)|, solved by Newton's method from z = B |R(0)|; the magnitudes s = |R(B s)| stand for them
/// where there are many. Friction that is known before, whose |R_i| no friction changes, belongs to R(0). Of several
/// solutions the solver finds the
/// one that is connected with the frictionless solution as the m_j grow from 0.
#[derive(Clone, Debug)]
pub struct FrictionLoop<T> {
    /// Arms m_j [m, or 1], with the sign of the slip.
    pub arm: Vec<T>,
    /// Magnitudes |R_i| [N]: the solution. With a held sign s_i, s_i times the component x of R_i, the normal force of
    /// a prismatic joint: equal to |R_i| up to where the normal force passes 0, and smooth beyond.
    pub size: Vec<T>,
    /// Held signs s_i of normal forces; 0 where the magnitude counts.
    pub sign: Vec<f64>,
    /// Whether some joint may have a held sign.
    pub has_normal_forces: bool,
    /// Number of the last joints whose |R_i| no friction changes.
    pub constant: usize,
    /// Of losses of couplings: whether power flows back, for which `arm` then is.
    pub flows_back: Vec<bool>,
    /// B: derivative of each unknown with respect to |R_j|. Rows have zeros up to a whole block.
    effect: Vec<T>,
    unknown: Vec<T>,
    /// Determinant of the last correction.
    determinant: f64,
    /// Correction of each unknown.
    change: Vec<f64>,
    /// |R_i| at the unknowns.
    measured: Vec<f64>,
    /// Magnitudes of the solution before.
    last: Vec<f64>,
    rest: Vec<T>,
    matrix: Vec<f64>,
    /// Derivatives of |R_i| with respect to u and to the components x and y of P_g.
    direction: Vec<[f64; 3]>,
    /// Number of matrices in the last solution, one for each iteration without a kept inverse.
    pub iterations: u32,
    /// What friction adds to the three unknowns of one group within a step.
    prediction: Prediction,
    /// What friction adds to the magnitudes of many joints within a step.
    of_sizes: Prediction<Vec<f64>>,
    /// Inverse of the equations of many joints within a step.
    kept: Kept,
    /// The loop of the values alone, for numbers that carry derivatives.
    values: Option<Box<Values>>,
}

/// Friction and reactions of some joints have no common solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Locked;

impl fmt::Display for Locked {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the equations of reactions and friction have no common solution")
    }
}

/// Newton's method converges quadratically: a correction dR leaves an error of about |dR|^2 / |R|. The iteration ends
/// when this is below this part of the largest reaction, which is rounding of the friction.
const CONVERGED: f64 = 1e-14;

/// Largest number of iterations from the frictionless reactions. With more, Newton's method may converge to a solution
/// that is not connected with the frictionless one.
const FEW: u32 = 4;

/// Number of elements that a processor multiplies at once.
const BLOCK: usize = 4;

impl<T: Number> FrictionLoop<T> {
    /// Solver for n joints in a number of groups.
    #[inline(never)]
    pub fn new(n: usize, groups: usize) -> Self {
        let (zero, unknowns) = (T::constant(0.0), if n == 0 { 0 } else { 1 + 2 * groups });
        let most = n.max(unknowns);
        Self {
            arm: vec![zero; n],
            size: vec![zero; n],
            sign: vec![0.0; n],
            has_normal_forces: false,
            constant: 0,
            flows_back: vec![false; n],
            effect: vec![zero; unknowns * n.next_multiple_of(BLOCK)],
            unknown: vec![zero; unknowns],
            determinant: 1.0,
            change: vec![0.0; unknowns],
            measured: vec![0.0; n],
            last: vec![0.0; n],
            rest: vec![zero; most],
            matrix: vec![0.0; most * most],
            direction: vec![[0.0; 3]; n],
            iterations: 0,
            prediction: Prediction::default(),
            of_sizes: Prediction::<Vec<f64>>::new(n),
            kept: Kept::new(if T::CARRIES { 0 } else { n }),
            values: T::CARRIES.then(|| Box::new(Values::new(n, groups))),
        }
    }

    /// Number of elements of a row of B.
    fn wide(&self) -> usize {
        self.arm.len().next_multiple_of(BLOCK)
    }

    /// A step begins.
    pub fn begin_step(&mut self) {
        self.prediction.begin();
        self.of_sizes.begin();
        self.kept.is_known = false;
    }

    /// No step is being made.
    pub fn end_step(&mut self) {
        self.prediction.end();
        self.of_sizes.end();
        self.kept.is_known = false;
    }

    /// Friction M_j of the last solution.
    #[inline]
    pub fn friction(&self, j: usize) -> T {
        -(self.arm[j] * self.size[j])
    }

    /// Component x of R_i [N] in the last solution, the normal force of a prismatic joint, where some joint may have a
    /// held sign.
    pub fn normal_force(&self, j: usize) -> f64 {
        self.size[j].value() * self.direction[j][1]
    }

    /// Solve for the magnitudes |R_i| to rounding.
    ///
    /// At small coefficients the solution is unique and the determinant of the equations is near 1. The solution ends
    /// where the determinant vanishes as the coefficients grow: the mechanism locks.
    ///
    /// # Errors
    /// [`Locked`]: no solution, or none that is connected with the frictionless one.
    pub fn solve(&mut self, balance: &Balance<T>) -> Result<(), Locked> {
        self.solve_at(0.0, balance)
    }

    /// [`Self::solve`] at a time t [s] of a step.
    ///
    /// # Errors
    /// [`Locked`].
    pub fn solve_at(&mut self, t: f64, balance: &Balance<T>) -> Result<(), Locked> {
        if T::CARRIES {
            return self.solve_carried(balance);
        }
        let one_group = balance.passed[0].len() == self.arm.len() && !self.has_normal_forces;
        let solved = match self.arm.len() {
            0 => true,
            1 if one_group => self.solve_one::<1>(t, balance),
            2 if one_group => self.solve_one::<2>(t, balance),
            3 if one_group => self.solve_one::<3>(t, balance),
            4 if one_group => self.solve_one::<4>(t, balance),
            _ => false,
        };
        if solved { Ok(()) } else { self.solve_any(t, balance) }
    }
}

/// Whether magnitudes are near others. Where the solution that is connected with the frictionless one ends, Newton's
/// method may find another one, far away.
#[inline]
pub(super) fn are_near<T: Number>(sizes: &[T], others: impl Iterator<Item = f64> + Clone) -> bool {
    /// Largest change of a reaction, relative to the largest reaction.
    const FAR: f64 = 0.5;
    let scale = others.clone().fold(f64::MIN_POSITIVE, |most, size| greater(most, size.abs()));
    sizes.iter().zip(others).all(|(size, other)| (size.value() - other).abs() <= FAR * scale)
}

/// A bound of the length of a vector.
#[inline(always)]
pub(super) fn length_bound<T: Number>(x: T, y: T) -> f64 {
    x.value().abs() + y.value().abs()
}

/// The greater of two numbers; the first if the second is NaN.
#[inline]
pub(super) fn greater(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

#[inline]
pub(super) fn norm<T: Number>(r: [T; 2]) -> T {
    (r[0] * r[0] + r[1] * r[1]).sqrt()
}

#[cfg(test)]
mod tests;
