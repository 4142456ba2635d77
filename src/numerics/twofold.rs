//! Numbers of twice the precision of `f64`: unevaluated sums of two.
//!
//! It must not know what the numbers mean.
//! Source: T. J. Dekker, A floating-point technique for extending the available precision, Numerische Mathematik 18
//! (1971) 224-242; D. E. Knuth, The Art of Computer Programming 2, 4.2.2.
use std::ops::{Add, Mul, Neg, Sub};

/// The sum high + low, |low| at most half a unit in the last place of high.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Twofold {
    high: f64,
    low: f64,
}

/// pi / 2 as the sum of three numbers.
const QUARTER: [f64; 3] = [std::f64::consts::FRAC_PI_2, 6.123_233_995_736_766e-17, -1.497_384_904_859_169_8e-33];

/// a + b exactly, for |a| >= |b| or a = 0.
fn fast_sum(a: f64, b: f64) -> Twofold {
    let high = a + b;
    Twofold { high, low: b - (high - a) }
}

/// a + b exactly.
fn sum(a: f64, b: f64) -> Twofold {
    let high = a + b;
    let part = high - a;
    Twofold { high, low: (a - (high - part)) + (b - part) }
}

/// a b exactly.
fn product(a: f64, b: f64) -> Twofold {
    let high = a * b;
    Twofold { high, low: a.mul_add(b, -high) }
}

impl Twofold {
    /// The nearest `f64`.
    pub fn rounded(self) -> f64 {
        self.high
    }

    /// Cosine and sine, with an error of some 1e-31, for an angle of at most 1e6 rad.
    pub fn cos_sin(self) -> (Self, Self) {
        /// Number of terms; the next one is below 1e-32 at pi / 4.
        const TERMS: u32 = 14;
        let quarters = (self.high / QUARTER[0]).round();
        let rest = QUARTER.into_iter().fold(self, |rest, part| rest - product(quarters, part));
        let square = rest * rest;
        // Horner's scheme of 1 - y/(1 2) (1 - y/(3 4) (1 - ...)) and of 1 - y/(2 3) (1 - y/(4 5) (1 - ...)).
        let series = |first: u32| {
            let one = Self::from(1.0);
            (0..TERMS).rev().fold(one, |inner, k| {
                let n = f64::from(first + 2 * k);
                one - (square * inner).over(n * (n + 1.0))
            })
        };
        let (cos, sin) = (series(1), rest * series(2));
        match quarters.rem_euclid(4.0) as u8 {
            0 => (cos, sin),
            1 => (-sin, cos),
            2 => (-cos, -sin),
            _ => (sin, -cos),
        }
    }

    /// This number over an integer.
    fn over(self, divisor: f64) -> Self {
        let high = self.high / divisor;
        let rest = self - product(high, divisor);
        fast_sum(high, rest.high / divisor)
    }
}

impl From<f64> for Twofold {
    fn from(value: f64) -> Self {
        Self { high: value, low: 0.0 }
    }
}

impl Add for Twofold {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let (high, low) = (sum(self.high, other.high), sum(self.low, other.low));
        let first = fast_sum(high.high, high.low + low.high);
        fast_sum(first.high, first.low + low.low)
    }
}

impl Neg for Twofold {
    type Output = Self;
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Sub for Twofold {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Twofold {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let p = product(self.high, other.high);
        fast_sum(p.high, p.low + (self.high * other.low + self.low * other.high))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn difference(a: Twofold, b: Twofold) -> f64 {
        (a - b).high
    }

    #[test]
    fn sums_and_products_keep_what_rounding_drops() {
        let (one, small) = (Twofold::from(1.0), Twofold::from(1e-25));
        assert_eq!((one + small - one).rounded(), 1e-25);
        // (1 + 1e-25)^2 - 1 - 2e-25 = 1e-50.
        assert!(difference((one + small) * (one + small), one + small + small).abs() < 1e-32);
    }

    #[test]
    fn cosine_and_sine_agree_with_those_of_f64_and_with_their_laws() {
        for k in -40..=40 {
            let angle = Twofold::from(0.37 * f64::from(k)) + Twofold::from(1e-20);
            let (cos, sin) = angle.cos_sin();
            assert!((cos.rounded() - angle.rounded().cos()).abs() < 2e-16);
            assert!((sin.rounded() - angle.rounded().sin()).abs() < 2e-16);
            assert!(difference(cos * cos + sin * sin, Twofold::from(1.0)).abs() < 1e-30);
            // sin(2 a) = 2 sin(a) cos(a).
            let (_, twice) = (angle + angle).cos_sin();
            let product = sin * cos;
            assert!(difference(twice, product + product).abs() < 1e-30, "{k}");
        }
    }

    #[test]
    fn the_sine_of_pi_rounded_is_what_rounding_dropped() {
        // pi = 3.14159265358979311600 + 1.2246467991473531772e-16 (both to twenty digits).
        let (_, sin) = Twofold::from(std::f64::consts::PI).cos_sin();
        assert!((sin.rounded() / 1.224_646_799_147_353_2e-16 - 1.0).abs() < 1e-15);
    }
}
