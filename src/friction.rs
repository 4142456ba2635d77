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

impl Law {
    /// mu with the sign of v [1], at the slip speed v [m/s] of any sign.
    pub fn signed<T: Number>(&self, v: T) -> T {
        let speed = v.value().abs();
        let sign = if v.value() < 0.0 { -1.0 } else { 1.0 };
        let (low, high) = (self.static_coefficient, self.kinetic_coefficient);
        if speed <= self.static_speed {
            v * T::constant(low / self.static_speed)
        } else if speed < self.kinetic_speed {
            let s = (v * T::constant(sign) - T::constant(self.static_speed))
                * T::constant(1.0 / (self.kinetic_speed - self.static_speed));
            let step = s * s * (T::constant(3.0) - s * T::constant(2.0));
            (T::constant(low) + step * T::constant(high - low)) * T::constant(sign)
        } else {
            T::constant(sign * high)
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
    /// At small coefficients the solution is unique and the determinant of Newton's matrix near 1; where it is not
    /// positive, friction holds more than the reactions that cause it can explain.
    ///
    /// # Errors
    /// [`Locked`]: no solution, or none that is continuously connected with that without friction.
    pub fn solve(&mut self) -> Result<(), Locked> {
        const MOST: u32 = 60;
        let n = self.arm.len();
        for i in 0..n {
            self.size[i] = norm(self.free[i]);
        }
        let mut last = f64::INFINITY;
        for iteration in 1..=MOST {
            self.iterations = iteration;
            let mut scale = f64::MIN_POSITIVE;
            for i in 0..n {
                let mut r = self.free[i];
                for j in 0..n {
                    let friction = self.friction(j);
                    let effect = self.effect[i * n + j];
                    r = [r[0] + effect[0] * friction, r[1] + effect[1] * friction];
                }
                let size = norm(r);
                let (x, y) = (r[0].value(), r[1].value());
                let length = size.value().max(f64::MIN_POSITIVE);
                for j in 0..n {
                    let effect = self.effect[i * n + j];
                    let along = (x * effect[0].value() + y * effect[1].value()) / length;
                    self.matrix[i * n + j] = along * self.arm[j].value() + f64::from(u8::from(i == j));
                }
                self.rest[i] = size - self.size[i];
                scale = scale.max(length);
            }
            let determinant = eliminate(&mut self.matrix, &mut self.rest);
            let mut change: f64 = 0.0;
            for i in 0..n {
                let step = self.rest[i];
                change = change.max(step.value().abs() / scale);
                self.size[i] = self.size[i] + step;
            }
            if !change.is_finite() {
                return Err(Locked);
            }
            // Newton's method squares the error: below this the new one is rounding. The derivatives that T may carry
            // need this step too, as they converge one step behind.
            if change < 1e-9 && last < 1e-3 || change == 0.0 {
                let sensible = determinant > 0.0 && self.size.iter().all(|s| s.value() >= 0.0);
                return if sensible { Ok(()) } else { Err(Locked) };
            }
            last = change;
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
