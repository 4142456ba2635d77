//! The loop of any number of joints and groups.
//!
//! In: arms, reactions as affine functions of the friction. Out: the solution, by Newton's method, if need be continued
//! from the frictionless one. It must not know the law of friction.
use super::{Balance, CONVERGED, FEW, FrictionLoop, Locked, are_near, greater, length_bound, norm};
use crate::numerics::dual::Number;

impl<T: Number> FrictionLoop<T> {
    /// [`Self::solve`] for any number of joints and groups.
    ///
    /// If Newton's method does not converge in a few iterations from the frictionless reactions, as where friction
    /// takes away most of a reaction, the solution is continued from the frictionless one while the arms grow from 0.
    pub(super) fn solve_any(&mut self, balance: &Balance<T>) -> Result<(), Locked> {
        /// First growth of the arms, relative to their full size.
        const FIRST: f64 = 0.25;
        /// Least growth of the arms: near the end of the solution, where reactions may grow without bound, each growth
        /// is a part of what is left.
        const LEAST: f64 = 1e-11;
        /// Largest number of iterations for one growth.
        const MOST: u32 = 12;
        /// Growth that has become so small, where the determinant vanishes within so small a part of what is left,
        /// shows that the solution ends there.
        const SMALL: f64 = 1e-4;
        const CLOSE: f64 = 1e-2;
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
            self.size[j] = measure(self.sign[j], [balance.free[0][j], balance.free[1][j]]);
        }
        let stride = stride(n);
        for (values, row) in self.values.chunks_exact_mut(stride).zip(self.effect.chunks_exact(n)) {
            values.iter_mut().zip(row).for_each(|(value, effect)| *value = effect.value());
        }
        self.keep_sizes();
        let contracts = self.contracts(balance);
        if self.newton(balance, 1.0, FEW + u32::from(T::CARRIES)) && (contracts || self.is_near()) {
            return Ok(());
        }
        let (mut part, mut more, mut determinant, mut ends) = (0.0, FIRST, 1.0, false);
        while part < 1.0 {
            self.size.iter_mut().zip(&self.last).for_each(|(size, last)| *size = T::constant(*last));
            let next = f64::min(part + more, 1.0);
            if self.newton(balance, next, MOST) && self.is_near() {
                // The determinant falls ever faster towards the end, so that its chord vanishes beyond.
                let fallen = determinant - self.determinant;
                ends = fallen > 0.0 && self.determinant * (next - part) < CLOSE * (1.0 - next) * fallen;
                (part, more, determinant) = (next, 2.0 * more, self.determinant);
                self.keep_sizes();
            } else if more > if ends { SMALL } else { LEAST } {
                more *= 0.25;
            } else {
                return Err(Locked);
            }
        }
        Ok(())
    }

    /// Whether friction changes the reactions by less than these change, of any number of joints and groups.
    fn contracts(&self, balance: &Balance<T>) -> bool {
        let n = self.arm.len();
        let largest = balance.inertial[0].iter().zip(balance.inertial[1]).map(|(x, y)| length_bound(*x, *y));
        let largest = largest.fold(0.0, greater);
        let (first, groups) = self.values.split_at(stride(n));
        let total = |rows: &[f64]| rows.iter().map(|effect| effect.abs()).sum::<f64>();
        let along = total(first);
        let passed = groups.chunks_exact(2 * stride(n)).map(total).fold(0.0, greater);
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

    /// Newton's method for s = |R(z)|, z = part B s, from the present magnitudes s. False if it does not converge in
    /// `most` iterations, or if a determinant is not positive. Of many iterations each is to be much nearer than the one
    /// before.
    ///
    /// With D = d|R| / dz, each correction solves (1 - part D B) ds = |R(z)| - s. That is Newton's method for
    /// z = part B |R(z)| as well: there the matrix is 1 - part B D, which has the same determinant, and dz = part B ds.
    pub(super) fn newton(&mut self, balance: &Balance<T>, part: f64, most: u32) -> bool {
        /// Least contraction of [`CONVERGED`]'s measure, the square of a correction: at the end of the solution the
        /// square of a correction is a quarter of the one before, elsewhere far less.
        const CONTRACTION: f64 = 0.2;
        let (n, stride) = (self.arm.len(), stride(self.arm.len()));
        // Slices of one length: no index of a joint is checked.
        let Self { sign, size, effect, values, unknown, change, measured, rest, matrix, direction, .. } = self;
        let (sign, size, measured, rest) = (&sign[..n], &mut size[..n], &mut measured[..n], &mut rest[..n]);
        let (groups, seconds, direction) = (&balance.groups[..n], &balance.seconds[..n], &mut direction[..n]);
        let [free_x, free_y] = balance.free.map(|free| &free[..n]);
        let [along_x, along_y] = balance.inertial.map(|inertial| &inertial[..n]);
        let (mut converged, mut before) = (false, f64::INFINITY);
        for iteration in 1..=most {
            self.iterations = iteration;
            for (unknown, row) in unknown.iter_mut().zip(effect.chunks_exact(n)) {
                *unknown = total(row, size) * part;
            }
            let (u, mut scale) = (unknown[0], f64::MIN_POSITIVE);
            for i in 0..n {
                let [first, second] = of_group(unknown, groups[i]);
                let [on_x, on_y] = seconds[i];
                let x = free_x[i] + along_x[i] * u + (first + second * on_x);
                let y = free_y[i] + along_y[i] * u + second * on_y;
                let length = measure(sign[i], [x, y]);
                rest[i] = length - size[i];
                measured[i] = length.value();
                scale = scale.max(measured[i].abs());
                let unit = if sign[i] == 0.0 {
                    let inverse = 1.0 / measured[i].max(f64::MIN_POSITIVE);
                    [x.value() * inverse, y.value() * inverse]
                } else {
                    [sign[i], 0.0]
                };
                let along = unit[0] * along_x[i].value() + unit[1] * along_y[i].value();
                direction[i] = [along, unit[0], on_x * unit[0] + on_y * unit[1]];
            }
            let (along, passed) = values.split_at(stride);
            let rows = matrix.chunks_exact_mut(stride).zip(&*direction).zip(groups);
            for (i, ((row, slopes), group)) in rows.enumerate() {
                let (first, second) = passed[2 * group * stride..2 * (group + 1) * stride].split_at(stride);
                let [u, x, y] = slopes.map(|slope| -part * slope);
                let fours = row.as_chunks_mut::<FOUR>().0.iter_mut();
                let [along, first, second] = [along, first, second].map(|row| row.as_chunks::<FOUR>().0);
                for (((out, along), first), second) in fours.zip(along).zip(first).zip(second) {
                    *out = std::array::from_fn(|j| u * along[j] + x * first[j] + y * second[j]);
                }
                row[i] += 1.0;
            }
            self.determinant = eliminate(matrix, rest);
            if self.determinant.is_nan() || self.determinant <= 0.0 {
                return false;
            }
            for (change, row) in change.iter_mut().zip(values.chunks_exact(stride)) {
                *change = part * row.iter().zip(&*rest).fold(0.0, |sum, (effect, rest)| sum + effect * rest.value());
            }
            let (u, mut error): (f64, f64) = (change[0], 0.0);
            for i in 0..n {
                if sign[i] == 0.0 {
                    let ([first, second], [on_x, on_y]) = (of_group(change, groups[i]), seconds[i]);
                    let x = along_x[i].value() * u + (first + on_x * second);
                    let y = along_y[i].value() * u + on_y * second;
                    error = error.max((x * x + y * y) / (measured[i].max(f64::MIN_POSITIVE) * scale));
                }
                size[i] = size[i] + rest[i];
            }
            if !error.is_finite() {
                return false;
            }
            if converged || (error < CONVERGED && !T::CARRIES) || error == 0.0 {
                return true;
            }
            converged = error < CONVERGED;
            if most > FEW + 1 && iteration > 2 && error > CONTRACTION * before && !converged {
                return false;
            }
            before = error;
        }
        false
    }
}

/// The components of P_g among the unknowns.
#[inline(always)]
fn of_group<N: Copy>(unknown: &[N], group: usize) -> [N; 2] {
    [unknown[1 + 2 * group], unknown[2 + 2 * group]]
}

/// |R|, or what stands for it under a held sign.
#[inline(always)]
fn measure<T: Number>(sign: f64, r: [T; 2]) -> T {
    if sign == 0.0 { norm(r) } else { r[0] * T::constant(sign) }
}

/// Inner product.
fn total<T: Number>(a: &[T], b: &[T]) -> T {
    a.iter().zip(b).fold(T::constant(0.0), |sum, (a, b)| sum + *a * *b)
}

/// Length of a row of so many numbers that are computed four at a time; the last ones are 0.
pub(super) fn stride(n: usize) -> usize {
    n.next_multiple_of(FOUR)
}

/// Numbers that are computed at a time.
const FOUR: usize = 4;

/// Gauss elimination in place with row pivoting, of rows of the length [`stride`]; the solution replaces the right-hand
/// side. Returns the determinant.
fn eliminate<T: Number>(a: &mut [f64], b: &mut [T]) -> f64 {
    let (n, stride) = (b.len(), stride(b.len()));
    let mut determinant = 1.0;
    for k in 0..n {
        let (mut pivot, mut most) = (k, a[k * stride + k].abs());
        for (i, other) in (k + 1..n).zip(a[(k + 1) * stride..].chunks_exact(stride)) {
            if other[k].abs() > most {
                (pivot, most) = (i, other[k].abs());
            }
        }
        if pivot != k {
            for j in k..n {
                a.swap(k * stride + j, pivot * stride + j);
            }
            b.swap(k, pivot);
            determinant = -determinant;
        }
        let (above, below) = a.split_at_mut((k + 1) * stride);
        let (row, head) = (&above[k * stride..], above[k * stride + k]);
        determinant *= head;
        let (inverse, first) = (1.0 / head, k / FOUR);
        for (i, other) in (k + 1..n).zip(below.chunks_exact_mut(stride)) {
            let factor = other[k] * inverse;
            let (other, row) = (&mut other.as_chunks_mut::<FOUR>().0[first..], &row.as_chunks::<FOUR>().0[first..]);
            for (other, row) in other.iter_mut().zip(row) {
                *other = std::array::from_fn(|j| other[j] - factor * row[j]);
            }
            b[i] = b[i] - b[k] * factor;
        }
    }
    for k in (0..n).rev() {
        let mut sum = b[k];
        for j in k + 1..n {
            sum = sum - b[j] * a[k * stride + j];
        }
        b[k] = sum * (1.0 / a[k * stride + k]);
    }
    determinant
}
