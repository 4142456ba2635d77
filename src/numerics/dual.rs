//! Numbers that may carry derivatives: formulas written once give values, or values and their exact derivatives.
use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// What a formula needs of a number.
pub trait Number:
    Copy
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Mul<f64, Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// Whether it carries derivatives.
    const CARRIES: bool;
    /// A constant.
    fn constant(value: f64) -> Self;
    /// The value.
    fn value(self) -> f64;
    /// Whether all derivatives are 0.
    fn is_constant(self) -> bool;
    /// Square root, for a value >= 0; at 0 without derivatives.
    fn sqrt(self) -> Self;
    /// A function of this number, given its value and its derivative.
    fn chain(self, value: f64, derivative: f64) -> Self;
    /// Functions of this number into `out`, given what writes their values, and their derivatives if it carries some.
    fn chain_all<const M: usize>(
        self,
        out: &mut [Self; M],
        values: impl FnOnce(&mut [f64; M]),
        derivatives: impl FnOnce(&mut [f64; M]),
    );

    /// Integer power.
    #[inline]
    fn powi(self, n: i32) -> Self {
        self.chain(self.value().powi(n), f64::from(n) * self.value().powi(n - 1))
    }

    /// Length of the vector (self, other); at length 0 without derivatives.
    #[inline]
    fn hypot(self, other: Self) -> Self {
        let (x, y) = (self.value(), other.value());
        let square = x * x + y * y;
        // Where the squares leave the range of numbers, the slower way.
        let length = if square.is_normal() { square.sqrt() } else { x.hypot(y) };
        let inverse = if length > 0.0 { 1.0 / length } else { 0.0 };
        self.chain(length, x * inverse) + other.chain(0.0, y * inverse)
    }
}

impl Number for f64 {
    const CARRIES: bool = false;

    fn constant(value: f64) -> Self {
        value
    }

    fn value(self) -> f64 {
        self
    }

    fn is_constant(self) -> bool {
        true
    }

    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }

    fn chain(self, value: f64, _derivative: f64) -> Self {
        value
    }

    #[inline]
    fn chain_all<const M: usize>(
        self,
        out: &mut [Self; M],
        values: impl FnOnce(&mut [f64; M]),
        _derivatives: impl FnOnce(&mut [f64; M]),
    ) {
        values(out);
    }
}

/// A value with its derivatives with respect to N quantities.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<const N: usize> {
    /// Value.
    pub value: f64,
    /// Derivatives.
    pub slope: [f64; N],
}

impl<const N: usize> Dual<N> {
    /// The quantity number `k` itself.
    pub fn variable(value: f64, k: usize) -> Self {
        let mut slope = [0.0; N];
        slope[k] = 1.0;
        Self { value, slope }
    }
}

impl<const N: usize> Add for Dual<N> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, slope: std::array::from_fn(|i| self.slope[i] + other.slope[i]) }
    }
}

impl<const N: usize> Sub for Dual<N> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl<const N: usize> Mul for Dual<N> {
    type Output = Self;
    // The product rule has a sum.
    #[allow(clippy::suspicious_arithmetic_impl)]
    fn mul(self, other: Self) -> Self {
        let slope = std::array::from_fn(|i| self.value * other.slope[i] + self.slope[i] * other.value);
        Self { value: self.value * other.value, slope }
    }
}

impl<const N: usize> Mul<f64> for Dual<N> {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        self.chain(self.value * factor, factor)
    }
}

impl<const N: usize> Div for Dual<N> {
    type Output = Self;
    // The quotient rule has a difference.
    #[allow(clippy::suspicious_arithmetic_impl)]
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self { value, slope: std::array::from_fn(|i| (self.slope[i] - value * other.slope[i]) / other.value) }
    }
}

impl<const N: usize> Neg for Dual<N> {
    type Output = Self;
    fn neg(self) -> Self {
        Self { value: -self.value, slope: self.slope.map(|s| -s) }
    }
}

impl<const N: usize> Number for Dual<N> {
    const CARRIES: bool = true;

    fn constant(value: f64) -> Self {
        Self { value, slope: [0.0; N] }
    }

    fn value(self) -> f64 {
        self.value
    }

    fn is_constant(self) -> bool {
        self.slope.iter().all(|slope| *slope == 0.0)
    }

    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, if root > 0.0 { 0.5 / root } else { 0.0 })
    }

    fn chain(self, value: f64, derivative: f64) -> Self {
        Self { value, slope: self.slope.map(|s| s * derivative) }
    }

    fn chain_all<const M: usize>(
        self,
        out: &mut [Self; M],
        values: impl FnOnce(&mut [f64; M]),
        derivatives: impl FnOnce(&mut [f64; M]),
    ) {
        let (mut of_self, mut slopes) = ([0.0; M], [0.0; M]);
        values(&mut of_self);
        derivatives(&mut slopes);
        for (out, (value, slope)) in out.iter_mut().zip(of_self.into_iter().zip(slopes)) {
            *out = self.chain(value, slope);
        }
    }
}

/// Whether two lists agree in every bit; no branch within, as they mostly do.
#[inline]
pub fn same_bits(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).fold(0, |differ, (a, b)| differ | (a.to_bits() ^ b.to_bits())) == 0
}

/// Make one list as long as the other the same: mostly it is, and to see that is cheaper than a copy.
#[inline]
pub fn become_same(own: &mut [f64], other: &[f64]) {
    if !same_bits(own, other) {
        own.copy_from_slice(other);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_those_of_the_closed_form() {
        let (x, y) = (Dual::<2>::variable(0.7, 0), Dual::variable(-1.3, 1));
        let f = (x * x * y - y * Dual::constant(2.0)) * (x * x + y * y).sqrt();
        let root = (0.49f64 + 1.69).sqrt();
        let outer = 0.49 * -1.3 + 2.6;
        assert!((f.value - outer * root).abs() < 1e-15);
        assert!((f.slope[0] - (2.0 * 0.7 * -1.3 * root + outer * 0.7 / root)).abs() < 1e-14);
        assert!((f.slope[1] - ((0.49 - 2.0) * root + outer * -1.3 / root)).abs() < 1e-14);
        let sine = x.chain(0.7f64.sin(), 0.7f64.cos());
        assert_eq!(sine.slope, [0.7f64.cos(), 0.0]);
        let quotient = x * 3.0 / y.powi(2);
        let expected = [3.0 / 1.69, -2.0 * 2.1 / -1.3f64.powi(3)];
        assert!((quotient.value - 2.1 / 1.69).abs() < 1e-15);
        assert!(quotient.slope.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-14));
        let length = x.hypot(y);
        assert!((length.value - root).abs() < 1e-15);
        assert!((length.slope[0] - 0.7 / root).abs() < 1e-15 && (length.slope[1] + 1.3 / root).abs() < 1e-15);
        let zero = (x * 0.0).hypot(y * 0.0);
        assert!(zero.is_constant() && zero.value == 0.0);
    }
}
