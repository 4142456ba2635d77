//! Polynomials side by side, in rows of [`ROW`] that a processor evaluates at once.
//!
//! In: monomial coefficients. Out: rows of coefficients, their sums and values. It must not know what the functions
//! mean.
use super::chebyshev::{NODES, Series};
use super::dual::Number;
use super::table::Table;

/// Number of functions in a row.
pub const ROW: usize = 4;

/// Monomial coefficients of [`ROW`] functions, power by power; aligned for loads of two numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(16))]
pub struct Row([f64; NODES * ROW]);

impl Row {
    /// Coefficients of [`ROW`] functions that vanish.
    pub const ZERO: Self = Self([0.0; NODES * ROW]);

    /// The coefficients of each power.
    fn powers(&self) -> &[[f64; ROW]] {
        self.0.as_chunks().0
    }
}

/// Functions of a table side by side, panel by panel; zeros fill the last row of a panel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bundle {
    /// Number of rows of a panel.
    rows: usize,
    coefficients: Vec<Row>,
}

impl Bundle {
    /// Side by side, the functions that are these components of a table.
    pub fn new(table: &Table, components: impl Iterator<Item = usize> + Clone) -> Self {
        let mut coefficients = Vec::new();
        for panel in 0..table.panels() {
            side_by_side(components.clone().map(|component| table.series(panel, component)), &mut coefficients);
        }
        Self { rows: Self::rows(components.count()), coefficients }
    }

    /// Number of rows for a number of functions.
    pub fn rows(functions: usize) -> usize {
        functions.div_ceil(ROW)
    }

    /// Coefficients on one panel.
    #[inline]
    pub fn panel(&self, panel: usize) -> &[Row] {
        &self.coefficients[panel * self.rows..(panel + 1) * self.rows]
    }
}

/// Append the coefficients of functions on one panel, side by side, to `out`.
pub fn side_by_side<'a>(functions: impl IntoIterator<Item = &'a Series>, out: &mut Vec<Row>) {
    for (i, series) in functions.into_iter().enumerate() {
        if i % ROW == 0 {
            out.push(Row::ZERO);
        }
        if let Some(row) = out.last_mut() {
            for (entry, c) in row.0[i % ROW..].iter_mut().step_by(ROW).zip(series) {
                *entry = *c;
            }
        }
    }
}

/// Add `size` times the functions in `rows` to `sums`, which is empty or has as many.
pub fn add_side_by_side(sums: &mut Vec<Row>, size: f64, rows: &[Row]) {
    if sums.is_empty() {
        sums.extend(rows.iter().map(|row| Row(row.0.map(|c| size * c))));
        return;
    }
    for (sum, row) in sums.iter_mut().zip(rows) {
        for (sum, c) in sum.0.iter_mut().zip(&row.0) {
            *sum += size * c;
        }
    }
}

/// Values of functions side by side at x, with derivatives if x carries some.
#[inline]
pub fn side_by_side_at<T: Number>(rows: &[Row], x: T, values: &mut [[T; ROW]]) {
    for (values, row) in values.iter_mut().zip(rows) {
        let (at, first, second) = (x.value(), slopes, curvatures);
        x.compose_all(values, |out| polynomials(row, at, out), |out| first(row, at, out), |out| second(row, at, out));
    }
}

/// Values at x: four independent Horner schemes in x^4, one for each residue of the power modulo 4.
// Not inlined: in a loop over rows the compiler would vectorise across rows instead of within one.
#[inline(never)]
fn polynomials(row: &Row, x: f64, values: &mut [f64; ROW]) {
    let x2 = x * x;
    let x4 = x2 * x2;
    let powers = row.powers();
    let mut sums = [powers[NODES - 4], powers[NODES - 3], powers[NODES - 2], powers[NODES - 1]];
    for four in powers[..NODES - 4].rchunks_exact(4) {
        for (sum, c) in sums.iter_mut().zip(four) {
            for (sum, c) in sum.iter_mut().zip(c) {
                *sum = *sum * x4 + c;
            }
        }
    }
    for (i, value) in values.iter_mut().enumerate() {
        *value = (sums[0][i] + sums[2][i] * x2) + (sums[1][i] + sums[3][i] * x2) * x;
    }
}

/// Derivatives at x, by Horner's scheme.
fn slopes(row: &Row, x: f64, sums: &mut [f64; ROW]) {
    sums.fill(0.0);
    for (k, power) in row.powers().iter().enumerate().skip(1).rev() {
        for (sum, c) in sums.iter_mut().zip(power) {
            *sum = *sum * x + k as f64 * c;
        }
    }
}

/// Second derivatives at x, by Horner's scheme.
fn curvatures(row: &Row, x: f64, sums: &mut [f64; ROW]) {
    sums.fill(0.0);
    for (k, power) in row.powers().iter().enumerate().skip(2).rev() {
        for (sum, c) in sums.iter_mut().zip(power) {
            *sum = *sum * x + (k * (k - 1)) as f64 * c;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::dual::Dual;
    use crate::numerics::table::polynomial_at;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn values_and_slopes_are_those_of_horner(x in -1.0..1.0f64, c in proptest::array::uniform16(-1.0..1.0f64)) {
            let value = c.iter().rev().fold(0.0, |sum, c| sum * x + c);
            let slope = c.iter().enumerate().skip(1).map(|(k, c)| k as f64 * c * x.powi(k as i32 - 1)).sum::<f64>();
            let dual = polynomial_at(&c, Dual::<1>::variable(x, 0));
            // Sixteen terms, the largest slope times 15.
            prop_assert!((polynomial_at(&c, x) - value).abs() < 1e-14);
            prop_assert!((dual.value - value).abs() < 1e-14 && (dual.slope[0] - slope).abs() < 2e-13);
            let mut rows = Vec::new();
            side_by_side([&[1.0; NODES], &c], &mut rows);
            let mut values = [[Dual::<1>::constant(1.0); ROW]];
            side_by_side_at(&rows, Dual::<1>::variable(x, 0), &mut values);
            prop_assert!((values[0][1].value - value).abs() < 1e-14 && (values[0][1].slope[0] - slope).abs() < 2e-13);
            prop_assert_eq!(values[0][2].value, 0.0);
        }
    }
}
