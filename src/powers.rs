//! Powers of one x, shared by many polynomials of that x.
//!
//! In: x. Out: values of polynomials with monomial coefficients, and their derivatives if x carries some. It must not know
//! what the polynomials mean.
use crate::chebyshev::{NODES, Series};
use crate::number::Number;
use crate::table::{ROW, Row, polynomials};

/// Powers of x, and where derivatives are asked for, their derivatives along x.
#[derive(Clone, Copy, Debug)]
pub struct Powers<T> {
    x: T,
    powers: [f64; NODES],
    slopes: [f64; NODES],
}

impl<T: Number> Powers<T> {
    /// Of x.
    #[inline]
    pub fn new(x: T) -> Self {
        let value = x.value();
        let mut powers = [1.0; NODES];
        powers[1] = value;
        for k in 2..NODES {
            // Short chains: x^k from two factors of about half the degree.
            powers[k] = powers[k / 2] * powers[k - k / 2];
        }
        let mut slopes = [0.0; NODES];
        if T::CARRIES {
            for k in 1..NODES {
                slopes[k] = k as f64 * powers[k - 1];
            }
        }
        Self { x, powers, slopes }
    }

    /// Polynomials at x, row by row.
    #[inline]
    pub fn bundle(&self, rows: &[Row], values: &mut [T]) {
        for (values, row) in values.chunks_exact_mut(ROW).zip(rows) {
            let sums = polynomials(row, self.x.value());
            let slopes = if T::CARRIES { products(row, &self.slopes) } else { [0.0; ROW] };
            for (value, (sum, slope)) in values.iter_mut().zip(sums.into_iter().zip(slopes)) {
                *value = self.x.chain(sum, slope);
            }
        }
    }

    /// A polynomial at x.
    #[inline]
    pub fn at(&self, series: &Series) -> T {
        let slope = if T::CARRIES { product(series, &self.slopes) } else { 0.0 };
        self.x.chain(product(series, &self.powers), slope)
    }
}

/// Sum of the products, in four sums that overlap.
#[inline]
fn product(a: &Series, b: &Series) -> f64 {
    let mut sums = [0.0; 4];
    for (a, b) in a.chunks_exact(4).zip(b.chunks_exact(4)) {
        for k in 0..4 {
            sums[k] += a[k] * b[k];
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}

/// The same for a row of functions.
#[inline]
fn products(row: &Row, weights: &[f64; NODES]) -> [f64; ROW] {
    let mut sums = [0.0; ROW];
    for (lanes, weight) in row.iter().zip(weights) {
        for k in 0..ROW {
            sums[k] += lanes.0[k] * weight;
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::Dual;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn values_and_slopes_are_those_of_horner(x in -1.0..1.0f64, c in proptest::array::uniform16(-1.0..1.0f64)) {
            let value = c.iter().rev().fold(0.0, |sum, c| sum * x + c);
            let slope = c.iter().enumerate().skip(1).rev().fold(0.0, |sum, (k, c)| sum * x + k as f64 * c);
            let dual = Powers::new(Dual::<1>::variable(x, 0)).at(&c);
            let mut side_by_side = Vec::new();
            crate::table::side_by_side(&[[1.0; NODES], c], &mut side_by_side);
            let mut bundle = [Dual::<1>::constant(0.0); ROW];
            Powers::new(Dual::<1>::variable(x, 0)).bundle(&side_by_side, &mut bundle);
            prop_assert!((bundle[1].value - value).abs() < 1e-14 && (bundle[1].slope[0] - slope).abs() < 2e-13);
            prop_assert_eq!(bundle[2].value, 0.0);
            // Sixteen terms, the largest slope times 15.
            prop_assert!((Powers::new(x).at(&c) - value).abs() < 1e-14);
            prop_assert!((dual.value - value).abs() < 1e-14 && (dual.slope[0] - slope).abs() < 2e-13);
        }
    }
}
