//! Rises from rest to rest: laws of motion without acceleration at their ends.
//!
//! With u = t / T and the distance D over the length T:
//!
//! ```text
//! cycloidal        s = D (u - sin(2 pi u) / (2 pi))
//! polynomial 345   s = D (10 u^3 - 15 u^4 + 6 u^5)
//! polynomial 4567  s = D (35 u^4 - 84 u^5 + 70 u^6 - 20 u^7)
//! ```
//!
//! Source: VDI 2143 part 1; Norton, Design of Machinery, chapter 8. In: t. Out: s with three derivatives. Must not
//! know: whether t is a time or the angle of a cam.
use std::f64::consts::TAU;

/// Coefficients of u^3 to u^7 of the polynomial 345.
const POLYNOMIAL_345: [f64; 5] = [10.0, -15.0, 6.0, 0.0, 0.0];
/// Coefficients of u^3 to u^7 of the polynomial 4567.
const POLYNOMIAL_4567: [f64; 5] = [0.0, 35.0, -84.0, 70.0, -20.0];

/// Law of a rise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rise {
    /// Second derivative: one period of a sine.
    Cycloidal,
    /// Polynomial of degree 5. The second derivative is 0 at the ends.
    Polynomial345,
    /// Polynomial of degree 7. The second and third derivatives are 0 at the ends.
    Polynomial4567,
}

impl Rise {
    /// s and its first, second and third derivative at t, for a length > 0. Before t = 0: at rest at 0. After the
    /// length: at rest at the distance. The second half is computed from the first half by symmetry, so that
    /// derivatives near the end are not small differences of large numbers.
    pub fn at(self, t: f64, distance: f64, length: f64) -> [f64; 4] {
        match t {
            t if t < 0.0 => [0.0; 4],
            t if t >= length => [distance, 0.0, 0.0, 0.0],
            t if t <= 0.5 * length => self.first_half(t, distance, length),
            t => {
                let [left, first, second, third] = self.first_half(length - t, distance, length);
                [distance - left, first, -second, third]
            }
        }
    }

    fn first_half(self, t: f64, distance: f64, length: f64) -> [f64; 4] {
        let coefficients = match self {
            Self::Cycloidal => {
                let (omega, mean) = (TAU / length, distance / length);
                let (sin, cos) = (omega * t).sin_cos();
                let half = (0.5 * omega * t).sin();
                return [
                    mean * (t - sin / omega),
                    2.0 * mean * half * half,
                    mean * omega * sin,
                    mean * omega * omega * cos,
                ];
            }
            Self::Polynomial345 => POLYNOMIAL_345,
            Self::Polynomial4567 => POLYNOMIAL_4567,
        };
        let u = t / length;
        let mut sum = [0.0; 4];
        for (c, power) in coefficients.iter().zip(3..) {
            let n = f64::from(power);
            let factors = [1.0, n, n * (n - 1.0), n * (n - 1.0) * (n - 2.0)];
            for (order, factor) in (0..).zip(factors) {
                sum[order as usize] += c * factor * u.powi(power - order);
            }
        }
        let mut unit = distance;
        sum.map(|derivative| {
            let value = unit * derivative;
            unit /= length;
            value
        })
    }
}
