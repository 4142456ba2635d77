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
    #[inline(never)]
    pub(super) fn solve_any(&mut self, t: f64, balance: &Balance<T>) -> Result<(), Locked> {
        /// First growth of the arms, relative to their full size.
        const FIRST: f64 = 0.25;
        /// Least growth of the arms: near the end of the solution, where reactions may grow without bound, each growth
        /// is a part of what is left.
        const LEAST: f64 = 1e-11;
        /// Largest number of iterations for one growth.
        const MOST: u32 = 12;
        /// Growth relative to the distance at which the chord of the determinant vanishes.
        const PART: f64 = 0.3;
        /// Such a distance, relative to what is left of the arms, that shows that the solution ends there.
        const CLOSE: f64 = 3e-4;
        let n = self.arm.len();
        self.set_effects(balance);
        for j in 0..n {
            self.size[j] = self.measure(j, [balance.free[0][j], balance.free[1][j]]);
        }
        if self.constant > 0 {
            // From the reactions under the friction that is known before.
            let (known, wide) = (n - self.constant, self.wide());
            for (unknown, row) in self.unknown.iter_mut().zip(self.effect.chunks_exact(wide)) {
                *unknown = total(&row[known..n], &self.size[known..]);
            }
            for j in 0..known {
                self.size[j] = self.measure(j, self.reaction(j, balance));
            }
        }
        self.keep_sizes();
        // A solution that is not unique is found from the frictionless one.
        if self.contracts(balance) {
            self.of_sizes.add_to(t, &mut self.size);
            if self.contract(balance) {
                self.of_sizes.learn(t, &self.size, &self.last);
                return Ok(());
            }
            self.take_sizes();
        }
        if self.newton(balance, 1.0, FEW) && self.is_near() {
            return Ok(());
        }
        let (mut part, mut more, mut determinant) = (0.0, FIRST, 1.0);
        while part < 1.0 {
            self.take_sizes();
            let next = f64::min(part + more, 1.0);
            if self.newton(balance, next, MOST) && self.is_near() {
                // The determinant falls ever faster towards the end, so that its chord vanishes beyond.
                let left = self.determinant * (next - part) / (determinant - self.determinant).max(0.0);
                if left < CLOSE * (1.0 - next) {
                    return Err(Locked);
                }
                more *= 2.0;
                if left < 1.0 - next {
                    more = more.min(PART * left);
                }
                (part, determinant) = (next, self.determinant);
                self.keep_sizes();
            } else if more > LEAST {
                more *= 0.25;
            } else {
                return Err(Locked);
            }
        }
        Ok(())
    }

    /// State B for the present arms. Unknown 0 is u, unknown 1 + axis + 2 g a component of P_g.
    pub(super) fn set_effects(&mut self, balance: &Balance<T>) {
        let (n, wide, arm) = (self.arm.len(), self.wide(), &self.arm);
        for (k, row) in self.effect.chunks_exact_mut(wide).enumerate() {
            let from = match k.checked_sub(1) {
                None => balance.influence,
                Some(k) => &balance.passed[k % 2][k / 2 * n..][..n],
            };
            row.iter_mut().zip(from).zip(arm).for_each(|((effect, from), arm)| *effect = -(*from * *arm));
        }
    }

    /// Whether friction changes the reactions by less than these change, of any number of joints and groups.
    fn contracts(&self, balance: &Balance<T>) -> bool {
        let n = self.arm.len();
        let largest = balance.inertial[0].iter().zip(balance.inertial[1]).map(|(x, y)| length_bound(*x, *y));
        let largest = largest.fold(0.0, greater);
        let varying = |row: &[T]| row[..n - self.constant].iter().fold(0.0, |sum, effect| sum + effect.value().abs());
        let mut rows = self.effect.chunks_exact(self.wide()).map(varying);
        let along = rows.next().unwrap_or(0.0);
        let mut passed = 0.0;
        while let (Some(first), Some(second)) = (rows.next(), rows.next()) {
            passed = greater(passed, first + second);
        }
        along * largest + passed < 1.0
    }

    /// Keep the magnitudes, for [`Self::is_near`].
    fn keep_sizes(&mut self) {
        self.last.iter_mut().zip(&self.size).for_each(|(last, size)| *last = size.value());
    }

    /// Take the magnitudes kept last.
    fn take_sizes(&mut self) {
        self.size.iter_mut().zip(&self.last).for_each(|(size, last)| *size = T::constant(*last));
    }

    /// Whether the magnitudes are near those kept last.
    fn is_near(&self) -> bool {
        are_near(&self.size, self.last.iter().copied())
    }

    /// R_i at the present unknowns.
    #[inline]
    fn reaction(&self, i: usize, balance: &Balance<T>) -> [T; 2] {
        let of = 1 + 2 * balance.groups[i];
        let [first, second] = [self.unknown[of], self.unknown[of + 1]];
        let [on_x, on_y] = balance.seconds[i];
        let passed = [first + second * on_x, second * on_y];
        [0, 1].map(|axis| balance.free[axis][i] + balance.inertial[axis][i] * self.unknown[0] + passed[axis])
    }

    /// |R_j|, or what stands for it under a held sign.
    #[inline]
    fn measure(&self, j: usize, r: [T; 2]) -> T {
        if self.sign[j] == 0.0 { norm(r) } else { r[0] * T::constant(self.sign[j]) }
    }

    /// Newton's method for s = |R(z)|, z = part B s, from the present magnitudes s. False if it does not converge in
    /// `most` iterations, or if a determinant is not positive. Of many iterations each is to be much nearer than the
    /// one before.
    fn newton(&mut self, balance: &Balance<T>, part: f64, most: u32) -> bool {
        /// Least contraction of [`CONVERGED`]'s measure, the square of a correction: at the end of the solution the
        /// square of a correction is a quarter of the one before, elsewhere far less.
        const CONTRACTION: f64 = 0.2;
        let mut before = f64::INFINITY;
        for iteration in 1..=most {
            self.iterations = iteration;
            let Some(error) = self.correct(balance, part) else { return false };
            if error < CONVERGED {
                return true;
            }
            if most > FEW && iteration > 2 && error > CONTRACTION * before {
                return false;
            }
            before = error;
        }
        false
    }

    /// |R_i| at the present unknowns, whose slopes it keeps.
    #[inline]
    pub(super) fn find_size(&mut self, i: usize, balance: &Balance<T>) -> T {
        let [on_x, on_y] = balance.seconds[i];
        let r = self.reaction(i, balance);
        let size = self.measure(i, r);
        let unit = if self.sign[i] == 0.0 {
            let inverse = 1.0 / size.value().max(f64::MIN_POSITIVE);
            r.map(|r| r.value() * inverse)
        } else {
            [self.sign[i], 0.0]
        };
        let along = unit[0] * balance.inertial[0][i].value() + unit[1] * balance.inertial[1][i].value();
        self.direction[i] = [along, unit[0], on_x * unit[0] + on_y * unit[1]];
        size
    }

    /// One correction by Newton's method. Returns the error that is left, or None if the determinant is not positive or
    /// the correction not finite.
    ///
    /// With D = d|R| / dz, each correction solves (1 - part D B) ds = |R(z)| - s. That is Newton's method for
    /// z = part B |R(z)| as well: there the matrix is 1 - part B D, which has the same determinant, and dz = part B ds.
    fn correct(&mut self, balance: &Balance<T>, part: f64) -> Option<f64> {
        let n = self.arm.len();
        let (known, wide) = (n - self.constant, self.wide());
        for (unknown, row) in self.unknown.iter_mut().zip(self.effect.chunks_exact(wide)) {
            *unknown = total(&row[..known], &self.size[..known]) * part + total(&row[known..n], &self.size[known..]);
        }
        let mut scale = f64::MIN_POSITIVE;
        for i in 0..n {
            let size = self.find_size(i, balance);
            self.rest[i] = size - self.size[i];
            self.measured[i] = size.value();
            scale = scale.max(size.value().abs());
            let of = 1 + 2 * balance.groups[i];
            let [u, x, y] = self.direction[i].map(|slope| -part * slope);
            let row = &mut self.matrix[i * n..(i + 1) * n];
            let [along, first, second] = [0, of, of + 1].map(|k| &self.effect[k * wide..k * wide + n]);
            for (((out, along), first), second) in row.iter_mut().zip(along).zip(first).zip(second) {
                *out = u * along.value() + x * first.value() + y * second.value();
            }
            row[i] += 1.0;
        }
        self.determinant = eliminate(&mut self.matrix[..n * n], &mut self.rest[..n]);
        if self.determinant.is_nan() || self.determinant <= 0.0 {
            return None;
        }
        for (change, row) in self.change.iter_mut().zip(self.effect.chunks_exact(wide)) {
            let of = |sum: f64, (effect, rest): (&T, &T)| sum + effect.value() * rest.value();
            *change = part * row[..n].iter().zip(&self.rest).fold(0.0, of);
        }
        let mut error: f64 = 0.0;
        for i in 0..n {
            let of = 1 + 2 * balance.groups[i];
            let [u, first, second] = [0, of, of + 1].map(|k| self.change[k]);
            if self.sign[i] == 0.0 {
                let [on_x, on_y] = balance.seconds[i];
                let passed = [first + on_x * second, on_y * second];
                let step = [0, 1].map(|axis| balance.inertial[axis][i].value() * u + passed[axis]);
                let size = self.measured[i].max(f64::MIN_POSITIVE);
                error = error.max((step[0] * step[0] + step[1] * step[1]) / (size * scale));
            }
            self.size[i] = self.size[i] + self.rest[i];
        }
        error.is_finite().then_some(error)
    }
}

/// Inner product.
#[inline]
pub(super) fn total<T: Number>(a: &[T], b: &[T]) -> T {
    a.iter().zip(b).fold(T::constant(0.0), |sum, (a, b)| sum + *a * *b)
}

/// Gauss elimination in place with row pivoting; the solution replaces the right-hand side. Returns the determinant.
pub(super) fn eliminate<T: Number>(a: &mut [f64], b: &mut [T]) -> f64 {
    let n = b.len();
    let mut determinant = 1.0;
    for k in 0..n {
        let (mut pivot, mut most) = (k, a[k * n + k].abs());
        for (i, below) in (k + 1..n).zip(a[k * n + k..].iter().step_by(n).skip(1)) {
            if below.abs() > most {
                (pivot, most) = (i, below.abs());
            }
        }
        if pivot != k {
            for j in k..n {
                a.swap(k * n + j, pivot * n + j);
            }
            b.swap(k, pivot);
            determinant = -determinant;
        }
        let (above, below) = a.split_at_mut((k + 1) * n);
        let (row, head) = (&above[k * n + k + 1..], above[k * n + k]);
        determinant *= head;
        let inverse = 1.0 / head;
        for (i, other) in (k + 1..n).zip(below.chunks_exact_mut(n)) {
            let factor = other[k] * inverse;
            other[k + 1..].iter_mut().zip(row).for_each(|(other, c)| *other -= factor * c);
            b[i] = b[i] - b[k] * factor;
        }
    }
    for k in (0..n).rev() {
        let mut sum = b[k];
        for j in k + 1..n {
            sum = sum - b[j] * a[k * n + j];
        }
        b[k] = sum * (1.0 / a[k * n + k]);
    }
    determinant
}
