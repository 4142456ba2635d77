//! The loop of any number of joints and groups.
//!
//! In: arms, reactions as affine functions of the friction. Out: the solution, by Newton's method, if need be continued
//! from the frictionless one. It must not know the law of friction.
use super::{Balance, CONVERGED, FEW, FrictionLoop, Locked, NONE, are_near, greater, length_bound, norm};
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
        self.find_active();
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

    /// Find the unknowns that some friction affects.
    fn find_active(&mut self) {
        self.active = 0;
        self.places.fill(NONE);
        for (row, place) in self.effect.chunks_exact(self.arm.len()).zip(&mut self.places) {
            if row.iter().any(|effect| effect.value() != 0.0 || !effect.is_constant()) {
                *place = self.active;
                self.active += 1;
            }
        }
    }

    /// Whether friction changes the reactions by less than these change, of any number of joints and groups.
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
        let (n, unknowns, zero) = (self.arm.len(), self.active, T::constant(0.0));
        let mut converged = false;
        for iteration in 1..=most {
            self.iterations = iteration;
            let mut scale = f64::MIN_POSITIVE;
            for i in 0..n {
                let of = 1 + 2 * balance.groups[i];
                let [first, second] = [self.unknown[of], self.unknown[of + 1]];
                let [on_x, on_y] = balance.seconds[i].map(T::constant);
                let passed = [first + on_x * second, on_y * second];
                let r = [0, 1]
                    .map(|axis| balance.free[axis][i] + balance.inertial[axis][i] * self.unknown[0] + passed[axis]);
                self.size[i] = self.measure(i, r);
                let unit = if self.sign[i] == 0.0 {
                    let inverse = 1.0 / self.size[i].value().max(f64::MIN_POSITIVE);
                    r.map(|r| r.value() * inverse)
                } else {
                    [self.sign[i], 0.0]
                };
                let along = unit[0] * balance.inertial[0][i].value() + unit[1] * balance.inertial[1][i].value();
                let [on_x, on_y] = balance.seconds[i];
                self.direction[i] = [along, unit[0], on_x * unit[0] + on_y * unit[1]];
                scale = scale.max(self.size[i].value().abs());
            }
            let (matrix, rest) = (&mut self.matrix[..unknowns * unknowns], &mut self.rest[..unknowns]);
            matrix.fill(0.0);
            for (k, &place) in self.places.iter().enumerate().filter(|(_, place)| **place != NONE) {
                let row = &self.effect[k * n..(k + 1) * n];
                rest[place] = total(row, &self.size) * T::constant(part) - self.unknown[k];
                let out = &mut matrix[place * unknowns..(place + 1) * unknowns];
                out[place] = 1.0;
                for (j, effect) in row.iter().enumerate() {
                    let of = 1 + 2 * balance.groups[j];
                    for (k, slope) in [0, of, of + 1].into_iter().zip(self.direction[j]) {
                        if let Some(out) = out.get_mut(self.places[k]) {
                            *out -= part * effect.value() * slope;
                        }
                    }
                }
            }
            let determinant = eliminate(matrix, rest);
            if determinant.is_nan() || determinant <= 0.0 {
                return false;
            }
            let mut error: f64 = 0.0;
            let change = |k: usize| rest.get(self.places[k]).copied().unwrap_or(zero);
            for i in 0..n {
                let of = 1 + 2 * balance.groups[i];
                let [along, x, y] = self.direction[i];
                let more =
                    change(0) * T::constant(along) + change(of) * T::constant(x) + change(of + 1) * T::constant(y);
                let [on_x, on_y] = balance.seconds[i];
                let [u, first, second] = [0, of, of + 1].map(|k| change(k).value());
                let passed = [first + on_x * second, on_y * second];
                let step = [0, 1].map(|axis| balance.inertial[axis][i].value() * u + passed[axis]);
                if self.sign[i] == 0.0 {
                    let size = self.size[i].value().max(f64::MIN_POSITIVE);
                    error = error.max((step[0] * step[0] + step[1] * step[1]) / (size * scale));
                }
                self.size[i] = self.size[i] + more;
            }
            for (unknown, &place) in self.unknown.iter_mut().zip(&self.places).filter(|(_, place)| **place != NONE) {
                *unknown = *unknown + rest[place];
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

/// Inner product.
fn total<T: Number>(a: &[T], b: &[T]) -> T {
    a.iter().zip(b).fold(T::constant(0.0), |sum, (a, b)| sum + *a * *b)
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
