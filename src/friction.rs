//! Friction in the joints: the coefficient over slip speed, and the loop between reactions and friction.
//!
//! In: slip speeds, and reactions as affine functions of the friction. Out: the friction torques. It must not know what
//! bodies or joints are. Source: [HF08] section 4, eqs. (26), (27).
use crate::number::Number;
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
pub enum Band {
    /// |v| up to V_S: in proportion.
    Ramp,
    /// Between V_S and V_d: the cubic step; with the sign of v.
    Step(f64),
    /// Above V_d: constant; with the sign of v.
    Level(f64),
}

impl Law {
    /// The stretch in which v [m/s] lies.
    pub fn band(&self, v: f64) -> Band {
        let sign = if v < 0.0 { -1.0 } else { 1.0 };
        if v.abs() <= self.static_speed {
            Band::Ramp
        } else if v.abs() < self.kinetic_speed {
            Band::Step(sign)
        } else {
            Band::Level(sign)
        }
    }

    /// First and last v of a stretch [m/s].
    pub fn range(&self, band: Band) -> (f64, f64) {
        let (low, high) = (self.static_speed, self.kinetic_speed);
        match band {
            Band::Ramp => (-low, low),
            Band::Step(sign) if sign > 0.0 => (low, high),
            Band::Step(_) => (-high, -low),
            Band::Level(sign) if sign > 0.0 => (high, f64::INFINITY),
            Band::Level(_) => (f64::NEG_INFINITY, -high),
        }
    }

    /// The stretch next to `band` towards v.
    pub fn next(&self, band: Band, v: f64) -> Band {
        let (low, high) = self.range(band);
        let upward = v > 0.5 * (low.max(-f64::MAX) + high.min(f64::MAX));
        match band {
            Band::Ramp => Band::Step(if upward { 1.0 } else { -1.0 }),
            Band::Step(sign) if upward == (sign > 0.0) => Band::Level(sign),
            Band::Step(_) => Band::Ramp,
            Band::Level(sign) => Band::Step(sign),
        }
    }

    /// mu with the sign of v [1], at the slip speed v [m/s] of any sign; `band` is followed some way beyond its ends, for
    /// steps that try to go there before the end is found.
    pub fn signed<T: Number>(&self, v: T, band: Band) -> T {
        let (low, high) = (self.static_coefficient, self.kinetic_coefficient);
        match band {
            Band::Ramp => v * T::constant(low / self.static_speed),
            Band::Step(sign) => {
                let s = (v * T::constant(sign) - T::constant(self.static_speed))
                    * T::constant(1.0 / (self.kinetic_speed - self.static_speed));
                let step = s * s * (T::constant(3.0) - s * T::constant(2.0));
                (T::constant(low) + step * T::constant(high - low)) * T::constant(sign)
            }
            Band::Level(sign) => T::constant(sign * high),
        }
    }
}

/// The loop between the reactions R_i of n joints and their friction M_j = -m_j |R_j|, where R_i depends on every M_j:
///
///   R_i = free_i + sum_j effect_ij M_j,
///
/// with m_j = mu(v_j) r_j [m, or 1 in a prismatic joint]. R_i has two components [N]; where only the part normal to an axis
/// counts, the second is 0.
#[derive(Clone, Debug)]
pub struct Loop<T> {
    /// R_i without friction [N].
    pub free: Vec<[T; 2]>,
    /// effect_ij in row i, column j [N/(N.m), or 1].
    pub effect: Vec<[T; 2]>,
    /// m_j [m or 1], with the sign of the slip.
    pub arm: Vec<T>,
    /// Solution: |R_i| [N].
    pub size: Vec<T>,
    matrix: Vec<f64>,
    rest: Vec<T>,
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

impl<T: Number> Loop<T> {
    /// Room for n joints.
    pub fn new(n: usize) -> Self {
        let zero = T::constant(0.0);
        Self {
            free: vec![[zero; 2]; n],
            effect: vec![[zero; 2]; n * n],
            arm: vec![zero; n],
            size: vec![zero; n],
            matrix: vec![0.0; n * n],
            rest: vec![zero; n],
            iterations: 0,
        }
    }

    /// Forget the reactions and effects.
    pub fn clear(&mut self) {
        let none = [T::constant(0.0); 2];
        self.free.fill(none);
        self.effect.fill(none);
    }

    /// Friction M_j of the last solution.
    pub fn friction(&self, j: usize) -> T {
        -(self.arm[j] * self.size[j])
    }

    /// Solve for the sizes |R_i| by Newton's method from the reactions without friction, to rounding.
    ///
    /// The matrix is I + K, K_ij = u_i . effect_ij m_j with the direction u_i of R_i. For a few joints and a small K, as is
    /// usual, its inverse is I - K + K^2 near enough; else the matrix is solved. At small coefficients the solution is unique
    /// and the determinant near 1; where it is not positive, friction holds more than the reactions that cause it can explain.
    ///
    /// # Errors
    /// [`Locked`]: no solution, or none that is continuously connected with that without friction.
    pub fn solve(&mut self) -> Result<(), Locked> {
        let few = match self.arm.len() {
            1 => self.solve_few::<1>(),
            2 => self.solve_few::<2>(),
            3 => self.solve_few::<3>(),
            4 => self.solve_few::<4>(),
            _ => false,
        };
        if few { Ok(()) } else { self.solve_any() }
    }

    /// [`Self::solve`] for N joints and a small K; false if K is not small.
    fn solve_few<const N: usize>(&mut self) -> bool {
        /// Largest row sum of |K| that counts as small; with it the determinant is positive.
        const SMALL: f64 = 0.2;
        const MOST: u32 = 12;
        let (Some(free), Some(arm)) = (self.free.first_chunk::<N>(), self.arm.first_chunk::<N>()) else { return false };
        let zero = T::constant(0.0);
        let mut pull = [[[zero; 2]; N]; N];
        for (pull, effects) in pull.iter_mut().zip(self.effect.chunks_exact(N)) {
            for ((pull, effect), arm) in pull.iter_mut().zip(effects).zip(arm) {
                *pull = [-(effect[0] * *arm), -(effect[1] * *arm)];
            }
        }
        let mut size = free.map(norm);
        let mut settled = false;
        for iteration in 1..=MOST {
            let mut rest = [zero; N];
            let mut matrix = [[0.0; N]; N];
            let (mut scale, mut bound) = (f64::MIN_POSITIVE, 0.0);
            for i in 0..N {
                let mut r = free[i];
                for j in 0..N {
                    r = [r[0] + pull[i][j][0] * size[j], r[1] + pull[i][j][1] * size[j]];
                }
                let length = norm(r);
                rest[i] = length - size[i];
                scale = f64::max(scale, length.value());
                let inverse = 1.0 / length.value().max(f64::MIN_POSITIVE);
                let (x, y) = (r[0].value() * inverse, r[1].value() * inverse);
                let mut sum = 0.0;
                for j in 0..N {
                    matrix[i][j] = x * pull[i][j][0].value() + y * pull[i][j][1].value();
                    sum += matrix[i][j].abs();
                }
                bound = f64::max(bound, sum);
            }
            if bound.is_nan() || bound > SMALL {
                return false;
            }
            let times = |v: &[T; N]| -> [T; N] {
                std::array::from_fn(|i| {
                    let mut sum = rest[i];
                    for j in 0..N {
                        sum = sum + v[j] * T::constant(matrix[i][j]);
                    }
                    sum
                })
            };
            let step = times(&times(&rest));
            let mut change: f64 = 0.0;
            for i in 0..N {
                size[i] = size[i] + step[i];
                change = change.max(step[i].value().abs());
            }
            change /= scale;
            // What is left after this correction: Newton's method squares it, the series leaves its third power of K.
            // Derivatives that T may carry converge one iteration behind.
            let left = change * (change + bound * bound * bound);
            if settled || (left < 1e-16 && !T::CARRIES) || change == 0.0 {
                self.iterations = iteration;
                self.size.copy_from_slice(&size);
                return size.iter().all(|s| s.value() >= 0.0);
            }
            settled = left < 1e-16;
        }
        false
    }

    /// [`Self::solve`] for any number of joints and any K.
    fn solve_any(&mut self) -> Result<(), Locked> {
        const MOST: u32 = 60;
        let n = self.arm.len();
        for i in 0..n {
            self.size[i] = norm(self.free[i]);
        }
        let mut settled = false;
        for iteration in 1..=MOST {
            self.iterations = iteration;
            let mut scale = f64::MIN_POSITIVE;
            for i in 0..n {
                let mut r = self.free[i];
                for j in 0..n {
                    let (effect, friction) = (self.effect[i * n + j], self.friction(j));
                    r = [r[0] + effect[0] * friction, r[1] + effect[1] * friction];
                }
                let size = norm(r);
                let inverse = 1.0 / size.value().max(f64::MIN_POSITIVE);
                for j in 0..n {
                    let effect = self.effect[i * n + j];
                    let along = (r[0].value() * effect[0].value() + r[1].value() * effect[1].value()) * inverse;
                    self.matrix[i * n + j] = along * self.arm[j].value() + f64::from(u8::from(i == j));
                }
                self.rest[i] = size - self.size[i];
                scale = scale.max(size.value());
            }
            let determinant = eliminate(&mut self.matrix, &mut self.rest);
            let mut change: f64 = 0.0;
            for i in 0..n {
                change = change.max(self.rest[i].value().abs() / scale);
                self.size[i] = self.size[i] + self.rest[i];
            }
            if !change.is_finite() {
                return Err(Locked);
            }
            if settled || (change * change < 1e-16 && !T::CARRIES) || change == 0.0 {
                let sensible = determinant > 0.0 && self.size.iter().all(|s| s.value() >= 0.0);
                return if sensible { Ok(()) } else { Err(Locked) };
            }
            settled = change * change < 1e-16;
        }
        Err(Locked)
    }
}

fn norm<T: Number>(r: [T; 2]) -> T {
    let square = r[0] * r[0] + r[1] * r[1];
    if square.value() > 0.0 { square.sqrt() } else { T::constant(0.0) }
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
