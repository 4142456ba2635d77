//! Friction in the joints: the coefficient over slip speed, and the loop between reactions and friction.
//!
//! In: slip speeds, and reactions as affine functions of the friction. Out: the friction torques. It must not know what
//! bodies or joints are. Source: [HF08] section 4, eqs. (26), (27).
use crate::numerics::dual::Number;
use std::fmt;

/// Coefficient of friction mu over slip speed v >= 0: in proportion to v up to mu_S at V_S, then by a cubic step to mu_d at
/// V_d, mu_d above ([HF08] fig. 8).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Law {
    /// mu_S [1], >= 0.
    pub static_coefficient: f64,
    /// mu_d [1], >= 0.
    pub kinetic_coefficient: f64,
    /// V_S [m/s], > 0.
    pub static_speed: f64,
    /// V_d [m/s], > V_S.
    pub kinetic_speed: f64,
}

/// A stretch of slip speeds in which the law is smooth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Regime {
    /// |v| up to V_S: in proportion.
    Viscous,
    /// Between V_S and V_d: the cubic step; with the sign of v.
    Transition(f64),
    /// Above V_d: constant; with the sign of v.
    Kinetic(f64),
}

impl Law {
    /// The stretch in which v [m/s] lies.
    pub fn regime(&self, v: f64) -> Regime {
        let sign = if v < 0.0 { -1.0 } else { 1.0 };
        if v.abs() <= self.static_speed {
            Regime::Viscous
        } else if v.abs() < self.kinetic_speed {
            Regime::Transition(sign)
        } else {
            Regime::Kinetic(sign)
        }
    }

    /// First and last v of a stretch [m/s].
    pub fn range(&self, regime: Regime) -> (f64, f64) {
        let (low, high) = (self.static_speed, self.kinetic_speed);
        match regime {
            Regime::Viscous => (-low, low),
            Regime::Transition(sign) if sign > 0.0 => (low, high),
            Regime::Transition(_) => (-high, -low),
            Regime::Kinetic(sign) if sign > 0.0 => (high, f64::INFINITY),
            Regime::Kinetic(_) => (f64::NEG_INFINITY, -high),
        }
    }

    /// The stretch next to `regime` towards v.
    pub fn next(&self, regime: Regime, v: f64) -> Regime {
        let (low, high) = self.range(regime);
        let upward = v > 0.5 * (low.max(-f64::MAX) + high.min(f64::MAX));
        match regime {
            Regime::Viscous => Regime::Transition(if upward { 1.0 } else { -1.0 }),
            Regime::Transition(sign) if upward == (sign > 0.0) => Regime::Kinetic(sign),
            Regime::Transition(_) => Regime::Viscous,
            Regime::Kinetic(sign) => Regime::Transition(sign),
        }
    }

    /// mu with the sign of v [1] over the slip speed v [m/s] of any sign, as on `regime`; it goes on beyond its ends, for steps that
    /// try to go there before the end is found.
    pub fn cubic(&self, regime: Regime) -> Cubic {
        let (low, high) = (self.static_coefficient, self.kinetic_coefficient);
        match regime {
            Regime::Viscous => Cubic { from: 0.0, rate: 1.0 / self.static_speed, terms: [0.0, low, 0.0, 0.0] },
            Regime::Transition(sign) => Cubic {
                from: sign * self.static_speed,
                rate: sign / (self.kinetic_speed - self.static_speed),
                terms: [low, 0.0, 3.0 * (high - low), -2.0 * (high - low)].map(|term| sign * term),
            },
            Regime::Kinetic(sign) => Cubic { from: 0.0, rate: 0.0, terms: [sign * high, 0.0, 0.0, 0.0] },
        }
    }
}

/// A stretch of a law as a cubic in s = rate (v - from).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cubic {
    from: f64,
    rate: f64,
    terms: [f64; 4],
}

impl Cubic {
    /// Value at v.
    #[inline]
    pub fn at<T: Number>(&self, v: T) -> T {
        let s = (v - T::constant(self.from)) * T::constant(self.rate);
        let [a, b, c, d] = self.terms.map(T::constant);
        (a + s * b) + s * s * (c + s * d)
    }

    /// That many times as much.
    pub fn times(self, factor: f64) -> Self {
        Self { terms: self.terms.map(|term| term * factor), ..self }
    }
}

/// What the reactions R_i of n joints are made of, given their friction M_j:
///
///   R_i = free_i + inertial_i u + P_g(i),   u = sum_j influence_j M_j,   P_g = sum_j passed_gj M_j,
///
/// where u is what friction adds to sigma_ddot, and the joints of a group g transmit the same force P_g at rest, but for its
/// sign, which does not count. Vectors are told as x and y [N]; where only the part normal to an axis counts, y is 0.
#[derive(Clone, Copy, Debug)]
pub struct Balance<'a, T> {
    /// R_i without friction [N].
    pub free: [&'a [T]; 2],
    /// Reaction to sigma_ddot = 1.
    pub inertial: [&'a [T]; 2],
    /// Influence of M_j on sigma_ddot.
    pub influence: &'a [T],
    /// passed_gj, group by group, for every j [1/m, or 1].
    pub passed: [&'a [T]; 2],
    /// g(i), numbered from 0.
    pub groups: &'a [usize],
}

/// The loop between the reactions R_i of n joints and their friction M_j = -m_j |R_j|, with m_j = mu(v_j) r_j [m, or 1 in a
/// prismatic joint].
///
/// Friction acts on the reactions only through u and P_g, three numbers for one group of joints however many they are: these
/// are the unknowns z, z = B |R(z)|, solved by Newton's method from z = B |R(0)|. Of several solutions it is that which comes
/// from the one without friction as the m_j grow.
#[derive(Clone, Debug)]
pub struct Loop<T> {
    /// m_j [m or 1], with the sign of the slip.
    pub arm: Vec<T>,
    /// Solution: |R_i| [N].
    pub size: Vec<T>,
    /// B: effect of |R_j| on each unknown.
    effect: Vec<T>,
    unknown: Vec<T>,
    before: Vec<T>,
    rest: Vec<T>,
    matrix: Vec<f64>,
    /// Direction of R_i, and its part along inertial_i.
    direction: Vec<[f64; 3]>,
    /// Iterations that the last solution took.
    pub iterations: u32,
}

/// The friction of some joints and their reactions contradict each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Locked;

impl fmt::Display for Locked {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("reactions and friction have no common solution")
    }
}

/// An iteration of Newton's method that changes R by dR leaves about |dR|^2 / |R|; less than this part of the largest reaction
/// is rounding in the friction, which is a small part of the reactions itself.
const SETTLED: f64 = 1e-14;

/// Newton's method that takes more iterations, from the reactions without friction, may be on its way to a solution that is
/// not connected with that.
const FEW: u32 = 4;

impl<T: Number> Loop<T> {
    /// Room for n joints in so many groups.
    pub fn new(n: usize, groups: usize) -> Self {
        let (zero, unknowns) = (T::constant(0.0), 1 + 2 * groups);
        Self {
            arm: vec![zero; n],
            size: vec![zero; n],
            effect: vec![zero; unknowns * n],
            unknown: vec![zero; unknowns],
            before: vec![zero; unknowns],
            rest: vec![zero; unknowns],
            matrix: vec![0.0; unknowns * unknowns],
            direction: vec![[0.0; 3]; n],
            iterations: 0,
        }
    }

    /// Friction M_j of the last solution.
    pub fn friction(&self, j: usize) -> T {
        -(self.arm[j] * self.size[j])
    }

    /// Solve for the sizes |R_i| to rounding.
    ///
    /// At small coefficients the solution is unique and the determinant of the equations near 1; where it ceases to be
    /// positive as the coefficients grow, friction holds more than the reactions that cause it can explain.
    ///
    /// # Errors
    /// [`Locked`]: no solution, or none that is continuously connected with that without friction.
    pub fn solve(&mut self, balance: &Balance<T>) -> Result<(), Locked> {
        let one = balance.passed[0].len() == self.arm.len();
        let solved = match self.arm.len() {
            1 if one => self.solve_one::<1>(balance),
            2 if one => self.solve_one::<2>(balance),
            3 if one => self.solve_one::<3>(balance),
            4 if one => self.solve_one::<4>(balance),
            _ => false,
        };
        if solved { Ok(()) } else { self.solve_any(balance) }
    }

    /// [`Self::solve`] for one group of N joints; false if it does not settle soon with a positive determinant.
    #[inline]
    fn solve_one<const N: usize>(&mut self, balance: &Balance<T>) -> bool {
        let most = FEW + u32::from(T::CARRIES);
        let [Some(free_x), Some(free_y)] = balance.free.map(<[T]>::first_chunk::<N>) else { return false };
        let [Some(along_x), Some(along_y)] = balance.inertial.map(<[T]>::first_chunk::<N>) else { return false };
        let [Some(passed_x), Some(passed_y)] = balance.passed.map(<[T]>::first_chunk::<N>) else { return false };
        let (Some(influence), Some(arm)) = (balance.influence.first_chunk::<N>(), self.arm.first_chunk::<N>()) else {
            return false;
        };
        let effect = [influence, passed_x, passed_y].map(|row| std::array::from_fn::<T, N, _>(|j| -(row[j] * arm[j])));
        let zero = T::constant(0.0);
        let (mut x, mut y, mut sizes) = (*free_x, *free_y, [zero; N]);
        let mut z = [zero; 3];
        for i in 0..N {
            sizes[i] = norm([x[i], y[i]]);
        }
        for k in 0..3 {
            z[k] = dot(&effect[k], &sizes);
        }
        let mut settled = false;
        for iteration in 1..=most {
            // Derivatives of each |R| along the unknowns.
            let mut slopes = [[0.0; N]; 3];
            let mut inverse = [0.0; N];
            for i in 0..N {
                x[i] = free_x[i] + along_x[i] * z[0] + z[1];
                y[i] = free_y[i] + along_y[i] * z[0] + z[2];
                let square = x[i] * x[i] + y[i] * y[i];
                sizes[i] = square.sqrt();
                // A quotient that does not wait for the root.
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
            // Of all reactions together.
            let moved: [f64; N] = std::array::from_fn(|i| {
                let dx = along_x[i].value() * step[0].value() + step[1].value();
                let dy = along_y[i].value() * step[0].value() + step[2].value();
                (dx * dx + dy * dy) * inverse[i]
            });
            let values = sizes.map(T::value);
            let left = total_of(&moved) / greater(f64::MIN_POSITIVE, total_of(&values));
            for k in 0..3 {
                z[k] = z[k] + step[k];
            }
            // Derivatives that T may carry converge one iteration behind.
            if settled || (left < SETTLED && !T::CARRIES) || left == 0.0 {
                self.iterations = iteration;
                for (i, size) in self.size.iter_mut().enumerate() {
                    *size = sizes[i];
                    for k in 0..3 {
                        *size = *size + step[k] * T::constant(slopes[k][i]);
                    }
                }
                return true;
            }
            settled = left < SETTLED;
        }
        false
    }

    /// [`Self::solve`] for any number of joints and groups.
    ///
    /// Where Newton's method from the reactions without friction does not soon find the solution, as where friction takes most
    /// of a reaction away, it is followed from that without friction while the arms grow to their size.
    fn solve_any(&mut self, balance: &Balance<T>) -> Result<(), Locked> {
        /// Parts by which the arms grow at first and at least.
        const FIRST: f64 = 0.25;
        const LEAST: f64 = 1e-4;
        const MOST: u32 = 12;
        let n = self.arm.len();
        let groups = (self.unknown.len() - 1) / 2;
        // Unknown number 1 + axis + 2 g is the component of P_g.
        for j in 0..n {
            self.effect[j] = -(balance.influence[j] * self.arm[j]);
            for g in 0..groups {
                for axis in 0..2 {
                    self.effect[(1 + axis + 2 * g) * n + j] = -(balance.passed[axis][g * n + j] * self.arm[j]);
                }
            }
            self.size[j] = norm([balance.free[0][j], balance.free[1][j]]);
        }
        for (z, row) in self.unknown.iter_mut().zip(self.effect.chunks_exact(n)) {
            *z = total(row, &self.size);
        }
        if self.newton(balance, 1.0, FEW + u32::from(T::CARRIES)) {
            return Ok(());
        }
        self.unknown.fill(T::constant(0.0));
        let (mut part, mut more) = (0.0, FIRST);
        while part < 1.0 {
            self.before.copy_from_slice(&self.unknown);
            let next = f64::min(part + more, 1.0);
            if self.newton(balance, next, MOST) {
                (part, more) = (next, 2.0 * more);
            } else if more > LEAST {
                self.unknown.copy_from_slice(&self.before);
                more *= 0.25;
            } else {
                return Err(Locked);
            }
        }
        Ok(())
    }

    /// Newton's method from the present unknowns, with this part of the arms; false if it does not settle in so many
    /// iterations, or where a determinant is not positive.
    fn newton(&mut self, balance: &Balance<T>, part: f64, most: u32) -> bool {
        let (n, unknowns) = (self.arm.len(), self.unknown.len());
        let mut settled = false;
        for iteration in 1..=most {
            self.iterations = iteration;
            let mut scale = f64::MIN_POSITIVE;
            for i in 0..n {
                let of = 1 + 2 * balance.groups[i];
                let r = [0, 1].map(|axis| {
                    balance.free[axis][i] + balance.inertial[axis][i] * self.unknown[0] + self.unknown[of + axis]
                });
                self.size[i] = norm(r);
                let inverse = 1.0 / self.size[i].value().max(f64::MIN_POSITIVE);
                let unit = r.map(|r| r.value() * inverse);
                let along = unit[0] * balance.inertial[0][i].value() + unit[1] * balance.inertial[1][i].value();
                self.direction[i] = [along, unit[0], unit[1]];
                scale = scale.max(self.size[i].value());
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
            let mut left: f64 = 0.0;
            for i in 0..n {
                let of = 1 + 2 * balance.groups[i];
                let [along, x, y] = self.direction[i];
                let more = self.rest[0] * T::constant(along)
                    + self.rest[of] * T::constant(x)
                    + self.rest[of + 1] * T::constant(y);
                let step = [0, 1].map(|axis| {
                    balance.inertial[axis][i].value() * self.rest[0].value() + self.rest[of + axis].value()
                });
                let size = self.size[i].value().max(f64::MIN_POSITIVE);
                left = left.max((step[0] * step[0] + step[1] * step[1]) / (size * scale));
                self.size[i] = self.size[i] + more;
            }
            for (z, step) in self.unknown.iter_mut().zip(&self.rest) {
                *z = *z + *step;
            }
            if !left.is_finite() {
                return false;
            }
            if settled || (left < SETTLED && !T::CARRIES) || left == 0.0 {
                return true;
            }
            settled = left < SETTLED;
        }
        false
    }
}

/// Sum of the products.
fn total<T: Number>(a: &[T], b: &[T]) -> T {
    a.iter().zip(b).fold(T::constant(0.0), |sum, (a, b)| sum + *a * *b)
}

/// Sum of the products of a few numbers, those at even and at odd places apart.
#[inline]
fn dot<T: Number, const N: usize>(a: &[T; N], b: &[T; N]) -> T {
    let mut sums = [a[0] * b[0], if N > 1 { a[1] * b[1] } else { T::constant(0.0) }];
    for j in 2..N {
        sums[j % 2] = sums[j % 2] + a[j] * b[j];
    }
    sums[0] + sums[1]
}

/// Sum of a few numbers, those at even and at odd places apart.
#[inline]
fn total_of<const N: usize>(a: &[f64; N]) -> f64 {
    let mut sums = [0.0; 2];
    for j in 0..N {
        sums[j % 2] += a[j];
    }
    sums[0] + sums[1]
}

/// The greater of two numbers; the first, if the second is not a number.
#[inline]
fn greater(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

/// Solution of three equations by cofactors, and their determinant.
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

/// Gauss elimination with pivots in place; the solution replaces the right-hand side. Returns the determinant.
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
