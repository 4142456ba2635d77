//! Numbers with or without derivatives.
//!
//! In: a formula generic over [`Number`]. Out: its values, with or without exact derivatives. Must not know: the
//! formula.
use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Operations of a generic formula.
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
    /// Whether the type carries derivatives.
    const CARRIES: bool;
    /// Whether the type carries derivatives of derivatives, so that the second derivative of a function is needed.
    const CARRIES_SECOND: bool = false;
    /// A constant.
    fn constant(value: f64) -> Self;
    /// The value.
    fn value(self) -> f64;
    /// Whether all derivatives are 0.
    fn is_constant(self) -> bool;
    /// Square root of a value >= 0. At 0, the derivatives of the result are 0.
    fn sqrt(self) -> Self;
    /// A linear function of this number, from its value and its derivative.
    fn chain(self, value: f64, derivative: f64) -> Self;
    /// A function of this number, from its value and its first and second derivative.
    #[inline]
    fn compose(self, [value, first, _]: [f64; 3]) -> Self {
        self.chain(value, first)
    }
    /// Integer power.
    #[inline]
    fn powi(self, n: i32) -> Self {
        let (x, order) = (self.value(), f64::from(n));
        let second = if Self::CARRIES_SECOND { order * (order - 1.0) * x.powi(n - 2) } else { 0.0 };
        self.compose([x.powi(n), order * x.powi(n - 1), second])
    }

    /// Length of the vector (self, other). At length 0, the derivatives of the result are 0.
    #[inline]
    fn hypot(self, other: Self) -> Self {
        let (x, y) = (self.value(), other.value());
        let square = x * x + y * y;
        // The slower function is needed if the squares overflow or underflow.
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
    /// The independent variable with index `k`.
    pub fn variable(value: f64, k: usize) -> Self {
        let mut slope = [0.0; N];
        slope[k] = 1.0;
        Self { value, slope }
    }
}

impl<const N: usize> Add for Dual<N> {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, slope: std::array::from_fn(|i| self.slope[i] + other.slope[i]) }
    }
}

impl<const N: usize> Sub for Dual<N> {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl<const N: usize> Mul for Dual<N> {
    type Output = Self;
    // The product rule contains a sum.
    #[allow(clippy::suspicious_arithmetic_impl)]
    #[inline]
    fn mul(self, other: Self) -> Self {
        let slope = std::array::from_fn(|i| self.value * other.slope[i] + self.slope[i] * other.value);
        Self { value: self.value * other.value, slope }
    }
}

impl<const N: usize> Mul<f64> for Dual<N> {
    type Output = Self;
    #[inline]
    fn mul(self, factor: f64) -> Self {
        self.chain(self.value * factor, factor)
    }
}

impl<const N: usize> Div for Dual<N> {
    type Output = Self;
    // The quotient rule contains a difference.
    #[allow(clippy::suspicious_arithmetic_impl)]
    #[inline]
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self { value, slope: std::array::from_fn(|i| (self.slope[i] - value * other.slope[i]) / other.value) }
    }
}

impl<const N: usize> Neg for Dual<N> {
    type Output = Self;
    #[inline]
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
}

/// A value with its derivative along sigma, both with derivatives along a direction of state and inputs. Such numbers
/// are rarely needed, so their operations are not inlined.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nested {
    /// Value.
    pub value: Dual<1>,
    /// Derivative along sigma.
    pub slope: Dual<1>,
}

impl Add for Nested {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, slope: self.slope + other.slope }
    }
}

impl Sub for Nested {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Self { value: self.value - other.value, slope: self.slope - other.slope }
    }
}

impl Mul for Nested {
    type Output = Self;
    #[inline(never)]
    fn mul(self, other: Self) -> Self {
        Self { value: self.value * other.value, slope: self.value * other.slope + self.slope * other.value }
    }
}

impl Mul<f64> for Nested {
    type Output = Self;
    #[inline]
    fn mul(self, factor: f64) -> Self {
        Self { value: self.value * factor, slope: self.slope * factor }
    }
}

impl Div for Nested {
    type Output = Self;
    #[inline(never)]
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self { value, slope: (self.slope - value * other.slope) / other.value }
    }
}

impl Neg for Nested {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self { value: -self.value, slope: -self.slope }
    }
}

impl Number for Nested {
    const CARRIES: bool = true;
    const CARRIES_SECOND: bool = true;

    fn constant(value: f64) -> Self {
        Self { value: Dual::constant(value), slope: Dual::constant(0.0) }
    }

    fn value(self) -> f64 {
        self.value.value
    }

    fn is_constant(self) -> bool {
        self.value.is_constant() && self.slope.is_constant() && self.slope.value == 0.0
    }

    #[inline(never)]
    fn sqrt(self) -> Self {
        let value = self.value.sqrt();
        let slope = if value.value > 0.0 { self.slope * 0.5 / value } else { Dual::constant(0.0) };
        Self { value, slope }
    }

    fn chain(self, value: f64, derivative: f64) -> Self {
        self.compose([value, derivative, 0.0])
    }

    #[inline(never)]
    fn compose(self, [value, first, second]: [f64; 3]) -> Self {
        Self { value: self.value.chain(value, first), slope: self.slope * self.value.chain(first, second) }
    }

    #[inline(never)]
    fn hypot(self, other: Self) -> Self {
        let value = self.value.hypot(other.value);
        let power = self.value * self.slope + other.value * other.slope;
        let slope = if value.value > 0.0 { power / value } else { Dual::constant(0.0) };
        Self { value, slope }
    }
}

/// A number for which the derivative along sigma can be computed, in addition to the derivatives that it carries.
pub trait Differentiable: Number {
    /// This number with derivatives along sigma.
    type Along: Number;
    /// A number that is constant along sigma.
    fn held(self) -> Self::Along;
    /// The number as sigma itself.
    fn varied(self) -> Self::Along;
    /// Derivative along sigma.
    fn slope_of(number: Self::Along) -> Self;
}

impl Differentiable for f64 {
    type Along = Dual<1>;

    fn held(self) -> Dual<1> {
        Dual::constant(self)
    }

    fn varied(self) -> Dual<1> {
        Dual::variable(self, 0)
    }

    fn slope_of(number: Dual<1>) -> Self {
        number.slope[0]
    }
}

impl Differentiable for Dual<1> {
    type Along = Nested;

    fn held(self) -> Nested {
        Nested { value: self, slope: Self::constant(0.0) }
    }

    fn varied(self) -> Nested {
        Nested { value: self, slope: Self::constant(1.0) }
    }

    fn slope_of(number: Nested) -> Self {
        number.slope
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
    /// f(x, y) = (x^2 y / (1 + y^2))^(1/2) + hypot(x^3, y): derivatives by x, and the derivatives of these by y,
    /// compared with differences of the first derivatives.
    #[test]
    fn nested_numbers_carry_second_derivatives() {
        fn f<T: Number>(x: T, y: T) -> T {
            (x * x * y / (T::constant(1.0) + y.powi(2))).sqrt() + x.powi(3).hypot(-y) - y * 2.0
        }
        let (x, y) = (0.7, 1.3);
        let by_x = |x: f64, y: f64| f(Dual::<1>::variable(x, 0), Dual::constant(y)).slope[0];
        let h = 1e-5;
        let nested = f(Dual::<1>::constant(x).varied(), Dual::<1>::variable(y, 0).held());
        assert!((nested.slope.value - by_x(x, y)).abs() < 1e-15);
        assert!((nested.slope.slope[0] - (by_x(x, y + h) - by_x(x, y - h)) / (2.0 * h)).abs() < 1e-9);
        let twice = f(Dual::<1>::variable(x, 0).varied(), Dual::<1>::constant(y).held());
        assert!((twice.slope.slope[0] - (by_x(x + h, y) - by_x(x - h, y)) / (2.0 * h)).abs() < 1e-9);
        let sine = Dual::<1>::variable(x, 0).varied().compose([x.sin(), x.cos(), -x.sin()]);
        assert_eq!((sine.value.slope[0], sine.slope.slope[0]), (x.cos(), -x.sin()));
    }
}
