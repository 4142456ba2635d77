//! The friction loop: friction and the reactions that cause it, solved together.
//!
//! In: arms of the friction, reactions as affine functions of the friction. Out: magnitudes of the reactions and
//! friction. It must not know bodies, joints or the law of friction. Source: [HF08] section 4, eqs. (26), (27).
mod prediction;

use crate::numerics::dual::Number;
use prediction::Prediction;
use std::fmt;

/// Reactions R_i of n joints as affine functions of their friction M_j:
///
///   R_i = free_i + inertial_i u + P_g(i),   u = sum_j influence_j M_j,   P_g = sum_j passed_gj M_j,
///
/// where u is the part of sigma_ddot due to friction, and P_g the force due to friction without motion, which is the
/// same, up to its sign, for all joints of a group g. The sign has no effect on |R_i|. Vectors are pairs of x and y
/// [N]; where only the component normal to an axis matters, it is x, and y is 0.
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
}

/// Solver of the equations between the reactions R_i of n joints and their friction M_j = -m_j |R_j|, with the arms
/// m_j = mu(v_j) r_j [m, or 1 in a prismatic joint].
///
/// Friction affects the reactions only through u and P_g, three numbers for each group of joints. These are the
/// unknowns z of z = B |R(z)|, solved by Newton's method from z = B |R(0)|. Of several solutions the solver finds the
/// one that is connected with the frictionless solution as the m_j grow from 0.
#[derive(Clone, Debug)]
pub struct FrictionLoop<T> {
    /// Arms m_j [m, or 1], with the sign of the slip.
    pub arm: Vec<T>,
    /// Magnitudes |R_i| [N]: the solution. With a held sign s_i, s_i times the component x of R_i, the normal force of a
    /// prismatic joint: equal to |R_i| up to where the normal force passes 0, and smooth beyond.
    pub size: Vec<T>,
    /// Held signs s_i of normal forces; 0 where the magnitude counts.
    pub sign: Vec<f64>,
    /// Whether some joint may have a held sign.
    pub has_normal_forces: bool,
    /// B: derivative of each unknown with respect to |R_j|.
    effect: Vec<T>,
    unknown: Vec<T>,
    before: Vec<T>,
    /// Magnitudes of the solution before.
    last: Vec<f64>,
    rest: Vec<T>,
    matrix: Vec<f64>,
    /// Component of inertial_i in the direction of R_i, then the direction of R_i.
    direction: Vec<[f64; 3]>,
    /// Number of iterations of the last solution.
    pub iterations: u32,
    /// What friction adds to the unknowns within a step.
    pub prediction: Prediction,
}

/// Friction and reactions of some joints have no common solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Locked;

impl fmt::Display for Locked {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("reactions and friction have no common solution")
    }
}

/// Newton's method converges quadratically: a correction dR leaves an error of about |dR|^2 / |R|. The iteration ends
/// when this is below this part of the largest reaction, which is rounding of the friction.
const CONVERGED: f64 = 1e-14;

/// Largest number of iterations from the frictionless reactions. With more, Newton's method may converge to a solution
/// that is not connected with the frictionless one.
const FEW: u32 = 4;

impl<T: Number> FrictionLoop<T> {
    /// Solver for n joints in a number of groups.
    pub fn new(n: usize, groups: usize) -> Self {
        let (zero, unknowns) = (T::constant(0.0), if n == 0 { 0 } else { 1 + 2 * groups });
        Self {
            arm: vec![zero; n],
            size: vec![zero; n],
            sign: vec![0.0; n],
            has_normal_forces: false,
            effect: vec![zero; unknowns * n],
            unknown: vec![zero; unknowns],
            before: vec![zero; unknowns],
            last: vec![0.0; n],
            rest: vec![zero; unknowns],
            matrix: vec![0.0; unknowns * unknowns],
            direction: vec![[0.0; 3]; n],
            iterations: 0,
            prediction: Prediction::default(),
        }
    }

    /// Friction M_j of the last solution.
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
        let one_group = balance.passed[0].len() == self.arm.len() && !self.has_normal_forces;
        let solved = match self.arm.len() {
            0 => true,
            1 if one_group => self.solve_one::<1>(t, balance),
            2 if one_group => self.solve_one::<2>(t, balance),
            3 if one_group => self.solve_one::<3>(t, balance),
            4 if one_group => self.solve_one::<4>(t, balance),
            _ => false,
        };
        if solved { Ok(()) } else { self.solve_any(balance) }
    }

    /// [`Self::solve`] for one group of N joints. False if it takes too many iterations or a determinant is not
    /// positive.
    #[inline]
    fn solve_one<const N: usize>(&mut self, t: f64, balance: &Balance<T>) -> bool {
        let most = FEW + u32::from(T::CARRIES);
        let [Some(free_x), Some(free_y)] = balance.free.map(<[T]>::first_chunk::<N>) else { return false };
        let [Some(along_x), Some(along_y)] = balance.inertial.map(<[T]>::first_chunk::<N>) else { return false };
        let [Some(passed_x), Some(passed_y)] = balance.passed.map(<[T]>::first_chunk::<N>) else { return false };
        let (Some(influence), Some(arm)) = (balance.influence.first_chunk::<N>(), self.arm.first_chunk::<N>()) else {
            return false;
        };
        let effect = [influence, passed_x, passed_y].map(|row| std::array::from_fn::<T, N, _>(|j| -(row[j] * arm[j])));
        let contracts = is_contraction(&effect, along_x, along_y);
        let zero = T::constant(0.0);
        let (mut x, mut y, mut sizes) = (*free_x, *free_y, [zero; N]);
        let mut z = [zero; 3];
        for i in 0..N {
            sizes[i] = norm([x[i], y[i]]);
        }
        for k in 0..3 {
            z[k] = dot(&effect[k], &sizes);
        }
        let (free, without) = (sizes, z);
        // A solution that is not unique is found from the frictionless one.
        if contracts && !T::CARRIES {
            let added = self.prediction.at(t);
            for k in 0..3 {
                z[k] = z[k] + T::constant(added[k]);
            }
        }
        let mut converged = false;
        for iteration in 1..=most {
            // Derivatives of each |R| with respect to the unknowns.
            let mut slopes = [[0.0; N]; 3];
            let mut inverse = [0.0; N];
            for i in 0..N {
                x[i] = free_x[i] + along_x[i] * z[0] + z[1];
                y[i] = free_y[i] + along_y[i] * z[0] + z[2];
                let square = x[i] * x[i] + y[i] * y[i];
                sizes[i] = square.sqrt();
                // This quotient does not depend on the square root, so both are computed at once.
                inverse[i] = sizes[i].value() * (1.0 / greater(f64::MIN_POSITIVE, square.value()));
                slopes[1][i] = x[i].value() * inverse[i];
                slopes[2][i] = y[i].value() * inverse[i];
                slopes[0][i] = slopes[1][i] * along_x[i].value() + slopes[2][i] * along_y[i].value();
            }
            // I - B d|R|/dz.
            let mut matrix = [[0.0; 3]; 3];
            let mut rest = [zero; 3];
            for k in 0..3 {
                rest[k] = dot(&effect[k], &sizes) - z[k];
                for l in 0..3 {
                    let mut sums = [0.0; 2];
                    for j in 0..N {
                        sums[j % 2] += effect[k][j].value() * slopes[l][j];
                    }
                    matrix[k][l] = f64::from(u8::from(k == l)) - (sums[0] + sums[1]);
                }
            }
            let (step, determinant) = solve_three(&matrix, &rest);
            if determinant.is_nan() || determinant <= 0.0 {
                return false;
            }
            // Error that is left, summed over all reactions.
            let errors: [f64; N] = std::array::from_fn(|i| {
                let dx = along_x[i].value() * step[0].value() + step[1].value();
                let dy = along_y[i].value() * step[0].value() + step[2].value();
                (dx * dx + dy * dy) * inverse[i]
            });
            let error = total_of(&errors) / greater(f64::MIN_POSITIVE, total_of(&sizes.map(T::value)));
            for k in 0..3 {
                z[k] = z[k] + step[k];
            }
            // Derivatives carried by T converge one iteration later.
            if converged || (error < CONVERGED && !T::CARRIES) || error == 0.0 {
                self.iterations = iteration;
                self.prediction.learn(t, std::array::from_fn(|k| (z[k] - without[k]).value()));
                for (i, size) in self.size.iter_mut().enumerate() {
                    *size = sizes[i];
                    for k in 0..3 {
                        *size = *size + step[k] * T::constant(slopes[k][i]);
                    }
                }
                return contracts || are_near(&self.size, free.iter().map(|size| size.value()));
            }
            converged = error < CONVERGED;
        }
        false
    }

    /// [`Self::solve`] for any number of joints and groups.
    ///
    /// If Newton's method does not converge in a few iterations from the frictionless reactions, as where friction
    /// takes away most of a reaction, the solution is continued from the frictionless one while the arms grow from 0.
    fn solve_any(&mut self, balance: &Balance<T>) -> Result<(), Locked> {
        /// First growth of the arms, relative to their full size.
        const FIRST: f64 = 0.25;
        /// Least growth of the arms: near the end of the solution, where reactions may grow without bound, each growth is
        /// a part of what is left.
        const LEAST: f64 = 1e-11;
        /// Largest number of iterations for one growth.
        const MOST: u32 = 12;
        let n = self.arm.len();
        let groups = (self.unknown.len() - 1) / 2;
        // Unknown 0 is u, unknown 1 + axis + 2 g a component of P_g.
        for j in 0..n {
            self.effect[j] = -(balance.influence[j] * self.arm[j]);
            for g in 0..groups {
                for axis in 0..2 {
                    self.effect[(1 + axis + 2 * g) * n + j] = -(balance.passed[axis][g * n + j] * self.arm[j]);
                }
            }
            self.size[j] = self.measure(j, [balance.free[0][j], balance.free[1][j]]);
        }
        for (z, row) in self.unknown.iter_mut().zip(self.effect.chunks_exact(n)) {
            *z = total(row, &self.size);
        }
        self.keep_sizes();
        let contracts = self.contracts(balance);
        if self.newton(balance, 1.0, FEW + u32::from(T::CARRIES)) && (contracts || self.is_near()) {
            return Ok(());
        }
        self.unknown.fill(T::constant(0.0));
        let (mut part, mut more) = (0.0, FIRST);
        while part < 1.0 {
            self.before.copy_from_slice(&self.unknown);
            let next = f64::min(part + more, 1.0);
            if self.newton(balance, next, MOST) && self.is_near() {
                (part, more) = (next, 2.0 * more);
                self.keep_sizes();
            } else if more > LEAST {
                self.unknown.copy_from_slice(&self.before);
                more *= 0.25;
            } else {
                return Err(Locked);
            }
        }
        Ok(())
    }

    /// [`is_contraction`] for any number of joints and groups.
    fn contracts(&self, balance: &Balance<T>) -> bool {
        let n = self.arm.len();
        let largest = balance.inertial[0].iter().zip(balance.inertial[1]).map(|(x, y)| length_bound(*x, *y));
        let largest = largest.fold(0.0, greater);
        let along: f64 = self.effect[..n].iter().map(|effect| effect.value().abs()).sum();
        let group = |rows: &[T]| rows.iter().map(|effect| effect.value().abs()).sum::<f64>();
        let passed = self.effect[n..].chunks_exact(2 * n).map(group).fold(0.0, greater);
        along * largest + passed < 1.0
    }

    /// Keep the magnitudes, for [`Self::is_near`].
    fn keep_sizes(&mut self) {
        self.last.iter_mut().zip(&self.size).for_each(|(last, size)| *last = size.value());
    }

    /// Whether the magnitudes are near those kept last.
    fn is_near(&self) -> bool {
        are_near(&self.size, self.last.iter().copied())
    }

    /// |R_j|, or what stands for it under a held sign.
    #[inline]
    fn measure(&self, j: usize, r: [T; 2]) -> T {
        if self.sign[j] == 0.0 { norm(r) } else { r[0] * T::constant(self.sign[j]) }
    }

    /// Newton's method from the current unknowns with a part of the arms. False if it does not converge in `most`
    /// iterations, or if a determinant is not positive.
    fn newton(&mut self, balance: &Balance<T>, part: f64, most: u32) -> bool {
        let (n, unknowns) = (self.arm.len(), self.unknown.len());
        let mut converged = false;
        for iteration in 1..=most {
            self.iterations = iteration;
            let mut scale = f64::MIN_POSITIVE;
            for i in 0..n {
                let of = 1 + 2 * balance.groups[i];
                let r = [0, 1].map(|axis| {
                    balance.free[axis][i] + balance.inertial[axis][i] * self.unknown[0] + self.unknown[of + axis]
                });
                self.size[i] = self.measure(i, r);
                let unit = if self.sign[i] == 0.0 {
                    let inverse = 1.0 / self.size[i].value().max(f64::MIN_POSITIVE);
                    r.map(|r| r.value() * inverse)
                } else {
                    [self.sign[i], 0.0]
                };
                let along = unit[0] * balance.inertial[0][i].value() + unit[1] * balance.inertial[1][i].value();
                self.direction[i] = [along, unit[0], unit[1]];
                scale = scale.max(self.size[i].value().abs());
            }
            self.matrix.fill(0.0);
            for k in 0..unknowns {
                let row = &self.effect[k * n..(k + 1) * n];
                self.rest[k] = total(row, &self.size) * T::constant(part) - self.unknown[k];
                let out = &mut self.matrix[k * unknowns..(k + 1) * unknowns];
                out[k] = 1.0;
                for (j, effect) in row.iter().enumerate() {
                    let of = 1 + 2 * balance.groups[j];
                    let [along, x, y] = self.direction[j].map(|slope| part * effect.value() * slope);
                    out[0] -= along;
                    out[of] -= x;
                    out[of + 1] -= y;
                }
            }
            let determinant = eliminate(&mut self.matrix, &mut self.rest);
            if determinant.is_nan() || determinant <= 0.0 {
                return false;
            }
            let mut error: f64 = 0.0;
            for i in 0..n {
                let of = 1 + 2 * balance.groups[i];
                let [along, x, y] = self.direction[i];
                let more = self.rest[0] * T::constant(along)
                    + self.rest[of] * T::constant(x)
                    + self.rest[of + 1] * T::constant(y);
                let step = [0, 1].map(|axis| {
                    balance.inertial[axis][i].value() * self.rest[0].value() + self.rest[of + axis].value()
                });
                if self.sign[i] == 0.0 {
                    let size = self.size[i].value().max(f64::MIN_POSITIVE);
                    error = error.max((step[0] * step[0] + step[1] * step[1]) / (size * scale));
                }
                self.size[i] = self.size[i] + more;
            }
            for (z, step) in self.unknown.iter_mut().zip(&self.rest) {
                *z = *z + *step;
            }
            if !error.is_finite() {
                return false;
            }
            if converged || (error < CONVERGED && !T::CARRIES) || error == 0.0 {
                return true;
            }
            converged = error < CONVERGED;
        }
        false
    }
}

/// Whether the friction of N joints of one group changes the reactions that cause it by less than these change: then
/// there is one solution, and it is connected with the frictionless one. `effect` is B, `along` are reactions to
/// sigma_ddot = 1; a reaction |R| changes by at most |along| for each unit of u, and as much as P_g.
#[inline(always)]
fn is_contraction<T: Number, const N: usize>(effect: &[[T; N]; 3], along_x: &[T; N], along_y: &[T; N]) -> bool {
    let [mut along, mut passed, mut largest] = [0.0; 3];
    for j in 0..N {
        along += effect[0][j].value().abs();
        passed += length_bound(effect[1][j], effect[2][j]);
        largest = greater(largest, length_bound(along_x[j], along_y[j]));
    }
    along * largest + passed < 1.0
}

/// Whether magnitudes are near others. Where the solution that is connected with the frictionless one ends, Newton's
/// method may find another one, far away.
#[inline]
fn are_near<T: Number>(sizes: &[T], others: impl Iterator<Item = f64> + Clone) -> bool {
    /// Largest change of a reaction, relative to the largest reaction.
    const FAR: f64 = 0.5;
    let scale = others.clone().fold(f64::MIN_POSITIVE, |most, size| greater(most, size.abs()));
    sizes.iter().zip(others).all(|(size, other)| (size.value() - other).abs() <= FAR * scale)
}

/// A bound of the length of a vector.
#[inline(always)]
fn length_bound<T: Number>(x: T, y: T) -> f64 {
    x.value().abs() + y.value().abs()
}

/// Inner product.
fn total<T: Number>(a: &[T], b: &[T]) -> T {
    a.iter().zip(b).fold(T::constant(0.0), |sum, (a, b)| sum + *a * *b)
}

/// Inner product of short vectors: two independent sums, over even and over odd indices.
#[inline]
fn dot<T: Number, const N: usize>(a: &[T; N], b: &[T; N]) -> T {
    let mut sums = [a[0] * b[0], if N > 1 { a[1] * b[1] } else { T::constant(0.0) }];
    for j in 2..N {
        sums[j % 2] = sums[j % 2] + a[j] * b[j];
    }
    sums[0] + sums[1]
}

/// Sum of a few numbers: two independent sums, over even and over odd indices.
#[inline]
fn total_of<const N: usize>(a: &[f64; N]) -> f64 {
    let mut sums = [0.0; 2];
    for j in 0..N {
        sums[j % 2] += a[j];
    }
    sums[0] + sums[1]
}

/// The greater of two numbers; the first if the second is NaN.
#[inline]
fn greater(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

/// Solution of three linear equations by cofactors, and their determinant.
#[inline]
fn solve_three<T: Number>(a: &[[f64; 3]; 3], b: &[T; 3]) -> ([T; 3], f64) {
    let minor = |i: usize, j: usize| {
        let ((r, s), (t, u)) = (((i + 1) % 3, (i + 2) % 3), ((j + 1) % 3, (j + 2) % 3));
        a[r][t] * a[s][u] - a[r][u] * a[s][t]
    };
    let first = [minor(0, 0), minor(0, 1), minor(0, 2)];
    let determinant = a[0][0] * first[0] + a[0][1] * first[1] + a[0][2] * first[2];
    let inverse = T::constant(1.0 / determinant);
    let mut solution = *b;
    for j in 0..3 {
        let sum = b[0] * T::constant(first[j]) + b[1] * T::constant(minor(1, j)) + b[2] * T::constant(minor(2, j));
        solution[j] = sum * inverse;
    }
    (solution, determinant)
}

fn norm<T: Number>(r: [T; 2]) -> T {
    (r[0] * r[0] + r[1] * r[1]).sqrt()
}

/// Gauss elimination in place with row pivoting; the solution replaces the right-hand side. Returns the determinant.
fn eliminate<T: Number>(a: &mut [f64], b: &mut [T]) -> f64 {
    let n = b.len();
    let mut determinant = 1.0;
    for k in 0..n {
        let mut pivot = k;
        for i in k + 1..n {
            if a[i * n + k].abs() > a[pivot * n + k].abs() {
                pivot = i;
            }
        }
        if pivot != k {
            for j in k..n {
                a.swap(k * n + j, pivot * n + j);
            }
            b.swap(k, pivot);
            determinant = -determinant;
        }
        let head = a[k * n + k];
        determinant *= head;
        for i in k + 1..n {
            let factor = a[i * n + k] / head;
            for j in k + 1..n {
                a[i * n + j] -= factor * a[k * n + j];
            }
            b[i] = b[i] - b[k] * T::constant(factor);
        }
    }
    for k in (0..n).rev() {
        let mut sum = b[k];
        for j in k + 1..n {
            sum = sum - b[j] * T::constant(a[k * n + j]);
        }
        b[k] = sum * T::constant(1.0 / a[k * n + k]);
    }
    determinant
}

#[cfg(test)]
mod tests;
