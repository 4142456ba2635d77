//! Numbers with twice the precision of `f64`: unevaluated sums of two numbers.
//!
//! Must not know: what the numbers mean.
//! Source: T. J. Dekker, A floating-point technique for extending the available precision, Numerische Mathematik 18
//! (1971) 224-242; D. E. Knuth, The Art of Computer Programming 2, 4.2.2.
use std::ops::{Add, Mul, Neg, Sub};

/// The sum high + low. |low| is at most half a unit in the last place of high.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Twofold {
    high: f64,
    low: f64,
}

/// pi / 2 as the sum of three numbers.
const QUARTER: [f64; 3] = [std::f64::consts::FRAC_PI_2, 6.123_233_995_736_766e-17, -1.497_384_904_859_169_8e-33];

/// 1 / n! for n = 2, 4, ... 10 and n = 3, 5, ... 11.
const EVEN: [Twofold; 5] = [
    Twofold { high: 0.5, low: 0.0 },
    Twofold { high: 0.041666666666666664, low: 2.3129646346357427e-18 },
    Twofold { high: 0.001388888888888889, low: -5.300543954373577e-20 },
    Twofold { high: 2.48015873015873e-05, low: 2.1511947866775882e-23 },
    Twofold { high: 2.755731922398589e-07, low: 2.3767714622250297e-23 },
];
const ODD: [Twofold; 5] = [
    Twofold { high: 0.16666666666666666, low: 9.25185853854297e-18 },
    Twofold { high: 0.008333333333333333, low: 1.1564823173178714e-19 },
    Twofold { high: 0.0001984126984126984, low: 1.7209558293420705e-22 },
    Twofold { high: 2.7557319223985893e-06, low: -1.858393274046472e-22 },
    Twofold { high: 2.505210838544172e-08, low: -1.448814070935912e-24 },
];
/// 1 / n! for n = 12, 14, 16 and n = 13, 15, 17, 19. The next terms are below 1e-32 at pi / 32.
const EVEN_LAST: [f64; 3] = [2.08767569878681e-09, 1.1470745597729725e-11, 4.779477332387385e-14];
const ODD_LAST: [f64; 4] =
    [1.6059043836821613e-10, 7.647163731819816e-13, 2.8114572543455206e-15, 8.22063524662433e-18];

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

    /// This number times a power of two.
    fn scaled(self, power: f64) -> Self {
        Self { high: power * self.high, low: power * self.low }
    }

    /// The alternating series c0 - y (c1 - y (c2 - ...)). Its last terms need no twofold sums.
    fn series(self, first: &[Self], last: &[f64]) -> Self {
        let rest = last.iter().rev().fold(0.0, |rest, c| c - self.high * rest);
        first.iter().rev().fold(Self::from(rest), |rest, c| *c - self * rest)
    }

    /// Cosine and sine with an error of about 1e-31, for an angle of at most 1e6 rad.
    pub fn cos_sin(self) -> (Self, Self) {
        /// Number of times that the angle is halved.
        const HALVINGS: i32 = 3;
        let quarters = (self.high / QUARTER[0]).round();
        let rest = QUARTER.into_iter().fold(self, |rest, part| rest - product(quarters, part));
        let small = rest.scaled(0.5_f64.powi(HALVINGS));
        let square = small * small;
        // Doubling formulas for v = 1 - cos, which keeps its digits near 0, and s = sin: 2 v (2 - v) and 2 s (1 - v).
        let one = Self::from(1.0);
        let (mut versine, mut sin) =
            (square * square.series(&EVEN, &EVEN_LAST), small - small * (square * square.series(&ODD, &ODD_LAST)));
        for _ in 0..HALVINGS {
            (versine, sin) = ((versine.scaled(2.0) - versine * versine).scaled(2.0), (sin - sin * versine).scaled(2.0));
        }
        let cos = one - versine;
        match quarters.rem_euclid(4.0) as u8 {
            0 => (cos, sin),
            1 => (-sin, cos),
            2 => (-cos, -sin),
            _ => (sin, -cos),
        }
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
    fn sums_and_products_have_twice_the_precision() {
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
    fn cosine_and_sine_agree_with_series_of_ninety_digits() {
        for (angle, cos, sin) in [
            (1.0, [0.5403023058681398, -4.760954612604417e-17], [0.8414709848078965, 1.776845092935536e-18]),
            (0.75, [0.7316888688738209, -1.0475824306512768e-17], [0.6816387600233341, 4.410467313197903e-17]),
            (100.0, [0.8623188722876839, 4.334809858136501e-17], [-0.5063656411097588, -3.050947053792115e-18]),
        ] {
            let found = Twofold::from(angle).cos_sin();
            for (found, [high, low]) in [(found.0, cos), (found.1, sin)] {
                assert!(difference(found, Twofold { high, low }).abs() < 2e-31, "{angle}: {found:?}");
            }
        }
    }

    #[test]
    fn the_sine_of_rounded_pi_is_its_rounding_error() {
        // pi = 3.14159265358979311600 + 1.2246467991473531772e-16 (both to twenty digits).
        let (_, sin) = Twofold::from(std::f64::consts::PI).cos_sin();
        assert!((sin.rounded() / 1.224_646_799_147_353_2e-16 - 1.0).abs() < 1e-15);
    }
}
