//! Bounds of functions on intervals, up to rounding errors.
//!
//! In: bounds of the arguments. Out: bounds of sums, products and polynomials, of their values and slopes. Must not
//! know: what the functions mean.
//! Source: Moore, Kearfott, Cloud, Introduction to Interval Analysis (2009), chapters 5 and 6. Arithmetic is not
//! rounded outward: the bounds of the exact functions have rounding errors.
use super::chebyshev::{NODES, Series};
use std::ops::{Add, Mul, Neg};

/// All numbers from `low` to `high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The smallest number.
    pub low: f64,
    /// The largest number.
    pub high: f64,
}

/// Bounds of the values and of the slopes of a function on an interval of its argument.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Enclosure {
    /// Bounds of the values.
    pub value: Interval,
    /// Bounds of the derivative.
    pub slope: Interval,
}

impl Interval {
    /// All numbers at most `radius` from `middle`.
    #[inline]
    pub fn around(middle: f64, radius: f64) -> Self {
        Self { low: middle - radius, high: middle + radius }
    }

    /// One number.
    pub fn point(value: f64) -> Self {
        Self { low: value, high: value }
    }

    /// The smallest interval that contains all these numbers.
    pub fn of(numbers: impl IntoIterator<Item = f64>) -> Self {
        let none = Self { low: f64::INFINITY, high: f64::NEG_INFINITY };
        numbers.into_iter().fold(none, |all, x| Self {
            low: if x < all.low { x } else { all.low },
            high: if x > all.high { x } else { all.high },
        })
    }

    /// The smallest interval that contains both intervals.
    #[inline]
    pub fn hull(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }
}

impl Add for Interval {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self { low: self.low + other.low, high: self.high + other.high }
    }
}

impl Neg for Interval {
    type Output = Self;

    #[inline]
    fn neg(self) -> Self {
        Self { low: -self.high, high: -self.low }
    }
}

impl Mul for Interval {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        let Self { low, high } = self;
        Self::of([low * other.low, low * other.high, high * other.low, high * other.high])
    }
}

impl Enclosure {
    /// A constant function.
    pub fn constant(value: f64) -> Self {
        Self { value: Interval::point(value), slope: Interval::point(0.0) }
    }

    /// The larger of two functions.
    pub fn max(self, other: Self) -> Self {
        if self.value.low >= other.value.high {
            self
        } else if other.value.low >= self.value.high {
            other
        } else {
            let (a, b) = (self.value, other.value);
            let value = Interval { low: a.low.max(b.low), high: a.high.max(b.high) };
            Self { value, slope: self.slope.hull(other.slope) }
        }
    }

    /// The smaller of two functions.
    pub fn min(self, other: Self) -> Self {
        -(-self).max(-other)
    }

    /// A function of this function. The arguments are bounds of the values and of the derivative of the outer function.
    #[inline]
    pub fn chain(self, [value, derivative]: [Interval; 2]) -> Self {
        Self { value, slope: derivative * self.slope }
    }
}

impl Add for Enclosure {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, slope: self.slope + other.slope }
    }
}

impl Neg for Enclosure {
    type Output = Self;

    #[inline]
    fn neg(self) -> Self {
        Self { value: -self.value, slope: -self.slope }
    }
}

impl Mul for Enclosure {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        Self { value: self.value * other.value, slope: self.slope * other.value + self.value * other.slope }
    }
}

impl Mul<f64> for Enclosure {
    type Output = Self;

    #[inline]
    fn mul(self, factor: f64) -> Self {
        let times = |i: Interval| Interval::of([i.low * factor, i.high * factor]);
        Self { value: times(self.value), slope: times(self.slope) }
    }
}

/// Bounds of a polynomial with monomial coefficients and of its derivative on an interval, from the terms of Taylor's
/// series about the middle.
pub fn polynomial_bounds(c: &Series, x: Interval) -> [Interval; 2] {
    let (middle, radius) = (0.5 * (x.low + x.high), 0.5 * (x.high - x.low));
    let mut taylor = *c;
    for first in 0..NODES {
        for k in (first..NODES - 1).rev() {
            taylor[k] += middle * taylor[k + 1];
        }
    }
    let (mut value, mut slope) = (0.0, 0.0);
    for (k, t) in taylor.iter().enumerate().skip(1).rev() {
        value = (value + t.abs()) * radius;
        slope = if k > 1 { (slope + k as f64 * t.abs()) * radius } else { slope };
    }
    [Interval::around(taylor[0], value), Interval::around(taylor[1], slope)]
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::numerics::chebyshev::polynomial;
    use proptest::prelude::*;

    #[test]
    fn bounds_of_a_parabola() {
        let mut c = [0.0; NODES];
        (c[0], c[1], c[2]) = (1.0, -2.0, 3.0);
        // About 1: 2 + 4 u + 3 u^2.
        let [value, slope] = polynomial_bounds(&c, Interval { low: 0.9, high: 1.1 });
        assert!((value.low - 1.57).abs() < 1e-14 && (value.high - 2.43).abs() < 1e-14, "{value:?}");
        assert!((slope.low - 3.4).abs() < 1e-14 && (slope.high - 4.6).abs() < 1e-14, "{slope:?}");
    }

    proptest! {
        /// Every value and every slope is within the bounds, for polynomials, products, maximum and minimum.
        #[test]
        fn all_values_are_within_the_bounds(
            a in proptest::array::uniform16(-1.0..1.0f64),
            b in proptest::array::uniform16(-1.0..1.0f64),
            low in -1.0..0.9f64,
            width in 0.0..0.1f64,
            part in 0.0..=1.0f64,
        ) {
            let x = Interval { low, high: low + width };
            let identity = Enclosure { value: x, slope: Interval::point(1.0) };
            let [f, g] = [a, b].map(|c| identity.chain(polynomial_bounds(&c, x)));
            let at = low + part * width;
            let slope = |c: &Series| (1..NODES).map(|k| k as f64 * c[k] * at.powi(k as i32 - 1)).sum::<f64>();
            let ([u, v], [u1, v1]) = ([polynomial(&a, at), polynomial(&b, at)], [slope(&a), slope(&b)]);
            let larger = if u > v { (u, u1) } else { (v, v1) };
            let smaller = if u > v { (v, v1) } else { (u, u1) };
            for (bounds, (value, slope)) in [
                (f, (u, u1)),
                (f * g, (u * v, u1 * v + u * v1)),
                (f + -g, (u - v, u1 - v1)),
                (f.max(g), larger),
                (f.min(g), smaller),
            ] {
                let within = |i: Interval, y: f64| i.low - 1e-13 <= y && y <= i.high + 1e-13;
                prop_assert!(within(bounds.value, value) && within(bounds.slope, slope), "{bounds:?} {value} {slope}");
            }
        }
    }
}
