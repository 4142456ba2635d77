//! Functions side by side: several polynomials for little more than one.
//!
//! In: monomial coefficients on a panel. Out: the same in rows of [`ROW`], as a processor reads them, their sums and values.
use super::Table;
use crate::numerics::chebyshev::{NODES, Series};
use crate::numerics::dual::Number;

/// Number of functions in a row.
pub const ROW: usize = 4;

/// Monomial coefficients of [`ROW`] functions, power by power; aligned, so that two are read at once.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(16))]
pub struct Row([f64; NODES * ROW]);

impl Row {
    /// Functions that are 0.
    pub const ZERO: Self = Self([0.0; NODES * ROW]);

    /// The coefficients of each power.
    fn powers(&self) -> &[[f64; ROW]] {
        self.0.as_chunks().0
    }
}

/// Functions that are read together, on each panel side by side; zeros fill the last row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bundle {
    /// Rows of a panel.
    rows: usize,
    coefficients: Vec<Row>,
}

impl Bundle {
    /// Number of rows of so many functions.
    pub fn rows(functions: usize) -> usize {
        functions.div_ceil(ROW)
    }

    /// Coefficients on one panel.
    #[inline]
    pub fn panel(&self, panel: usize) -> &[Row] {
        &self.coefficients[panel * self.rows..(panel + 1) * self.rows]
    }
}

/// Functions on one panel side by side, appended to `out`.
pub fn side_by_side<'a>(functions: impl IntoIterator<Item = &'a Series>, out: &mut Vec<Row>) {
    for (i, series) in functions.into_iter().enumerate() {
        if i % ROW == 0 {
            out.push(Row::ZERO);
        }
        if let Some(row) = out.last_mut() {
            for (place, c) in row.0[i % ROW..].iter_mut().step_by(ROW).zip(series) {
                *place = *c;
            }
        }
    }
}

/// Add functions side by side, each times `size`.
pub fn add_side_by_side(sums: &mut [Row], size: f64, rows: &[Row]) {
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
        x.chain_all(values, |values| polynomials(row, x.value(), values), |values| slopes(row, x.value(), values));
    }
}

/// Horner's scheme in x^4 for each of four residues of the power, which overlap.
// Not inlined: in a loop over rows a compiler would gather one lane of several rows in place of the lanes of one.
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

/// Horner's scheme for the derivatives.
fn slopes(row: &Row, x: f64, sums: &mut [f64; ROW]) {
    sums.fill(0.0);
    for (k, power) in row.powers().iter().enumerate().skip(1).rev() {
        for (sum, c) in sums.iter_mut().zip(power) {
            *sum = *sum * x + k as f64 * c;
        }
    }
}

impl Table {
    /// Components, to be read together.
    pub fn bundle(&self, components: impl Iterator<Item = usize> + Clone) -> Bundle {
        let mut coefficients = Vec::new();
        for panel in self.coefficients.chunks_exact(self.components.max(1)) {
            side_by_side(components.clone().map(|component| &panel[component]), &mut coefficients);
        }
        Bundle { rows: Bundle::rows(components.count()), coefficients }
    }
}
