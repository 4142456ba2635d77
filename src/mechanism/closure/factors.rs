//! Sparse factors of the independent loop equations, with their null vector.
//!
//! In: the rows of the loop Jacobian J, one fewer than coordinates. Out: J = L U with U upper triangular up to the
//! order of its columns, the null vector z with J z = 0, and solutions on a plane across z. The pivot of a row is its
//! largest entry in a column without a pivot; the columns of earlier pivots are eliminated from the row. Rows of a
//! chain then stay short, and the cost grows with the number of entries. It must not know linkages.

/// An entry of a row of U (column, value) or of L (row that is subtracted, factor).
type Entry = (usize, f64);

/// Mark of a column without a pivot.
const FREE: usize = usize::MAX;

/// Factors of J, with scratch for factorisation.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Factors {
    /// Rows of U without pivots, one after another, and the end of each row.
    upper: Vec<Entry>,
    upper_ends: Vec<usize>,
    /// Rows of L without the unit diagonal, one after another, and the end of each row.
    lower: Vec<Entry>,
    lower_ends: Vec<usize>,
    /// Column and inverse of each row's pivot.
    pivots: Vec<Entry>,
    /// Row with its pivot in each column, or [`FREE`].
    pivot_rows: Vec<usize>,
    /// Null vector z: J z = 0, 1 in the column without a pivot.
    pub null: Vec<f64>,
    /// The row that is being eliminated: its entries by column, whether each column has one, the list of these columns,
    /// and the rows still to be subtracted, one bit each.
    entries: Vec<f64>,
    present: Vec<bool>,
    columns: Vec<usize>,
    waiting: Vec<u64>,
}

/// Entries of one row.
fn part<'a>(entries: &'a [Entry], ends: &[usize], row: usize) -> &'a [Entry] {
    &entries[if row == 0 { 0 } else { ends[row - 1] }..ends[row]]
}

impl Factors {
    /// Remove all rows and set the number of coordinates.
    pub fn clear(&mut self, columns: usize) {
        [&mut self.upper, &mut self.lower, &mut self.pivots].into_iter().for_each(Vec::clear);
        [&mut self.upper_ends, &mut self.lower_ends].into_iter().for_each(Vec::clear);
        self.pivot_rows.clear();
        self.pivot_rows.resize(columns, FREE);
        // Each row leaves these zeroed.
        self.entries.resize(columns, 0.0);
        self.present.resize(columns, false);
        self.waiting.resize(columns.div_ceil(64), 0);
    }

    /// Add a row; `weights` make its entries comparable. False if the row depends on earlier rows.
    pub fn push(&mut self, row: impl Iterator<Item = Entry>, weights: &[f64]) -> bool {
        for (column, value) in row {
            self.touch(column);
            self.entries[column] += value;
        }
        for word in 0..self.waiting.len() {
            while self.waiting[word] != 0 {
                let bit = self.waiting[word].trailing_zeros() as usize;
                self.waiting[word] &= self.waiting[word] - 1;
                self.subtract(64 * word + bit);
            }
        }
        self.lower_ends.push(self.lower.len());
        let mut best = (FREE, 0.0);
        for &column in &self.columns {
            let size = (self.entries[column] / weights[column]).abs();
            if self.pivot_rows[column] == FREE && size > best.1 {
                best = (column, size);
            }
        }
        let (pivot, size) = best;
        let regular = pivot != FREE && size.is_finite();
        if regular {
            self.pivot_rows[pivot] = self.pivots.len();
            self.pivots.push((pivot, 1.0 / self.entries[pivot]));
        }
        for &column in &self.columns {
            if regular && column != pivot && self.pivot_rows[column] == FREE && self.entries[column] != 0.0 {
                self.upper.push((column, self.entries[column]));
            }
            self.entries[column] = 0.0;
            self.present[column] = false;
        }
        self.columns.clear();
        self.upper_ends.push(self.upper.len());
        regular
    }

    /// [`Self::push`] of a row with an entry in every column, in their order: the same numbers, without a search for
    /// what is to be eliminated.
    pub fn push_whole(&mut self, row: &[f64], weights: &[f64]) -> bool {
        let Self { upper, upper_ends, lower, lower_ends, pivots, pivot_rows, entries, .. } = self;
        entries.copy_from_slice(row);
        for (index, &(pivot, inverse)) in pivots.iter().enumerate() {
            let factor = std::mem::take(&mut entries[pivot]) * inverse;
            if factor != 0.0 {
                lower.push((index, factor));
                for &(column, value) in part(upper, upper_ends, index) {
                    entries[column] -= factor * value;
                }
            }
        }
        lower_ends.push(lower.len());
        let mut best = (FREE, 0.0);
        for (column, ((entry, weight), pivot_row)) in entries.iter().zip(weights).zip(&*pivot_rows).enumerate() {
            let size = (entry / weight).abs();
            if *pivot_row == FREE && size > best.1 {
                best = (column, size);
            }
        }
        let (pivot, size) = best;
        let regular = pivot != FREE && size.is_finite();
        if regular {
            pivot_rows[pivot] = pivots.len();
            pivots.push((pivot, 1.0 / entries[pivot]));
            let others = entries.iter().zip(&*pivot_rows).enumerate();
            let others = others.filter(|(_, (entry, pivot_row))| **pivot_row == FREE && **entry != 0.0);
            upper.extend(others.map(|(column, (entry, _))| (column, *entry)));
        }
        upper_ends.push(upper.len());
        entries.fill(0.0);
        regular
    }

    /// Note that the current row has an entry in a column.
    fn touch(&mut self, column: usize) {
        if !self.present[column] {
            self.present[column] = true;
            self.columns.push(column);
            let row = self.pivot_rows[column];
            if row != FREE {
                self.waiting[row / 64] |= 1 << (row % 64);
            }
        }
    }

    /// Eliminate from the current row the column with the pivot of `row`.
    fn subtract(&mut self, row: usize) {
        let (pivot, inverse) = self.pivots[row];
        let factor = self.entries[pivot] * inverse;
        self.entries[pivot] = 0.0;
        if factor == 0.0 {
            return;
        }
        self.lower.push((row, factor));
        let first = if row == 0 { 0 } else { self.upper_ends[row - 1] };
        for k in first..self.upper_ends[row] {
            let (column, value) = self.upper[k];
            self.touch(column);
            self.entries[column] -= factor * value;
        }
    }

    /// Compute the null vector after the last row. False if the number of columns without a pivot is not one.
    pub fn finish(&mut self) -> bool {
        let columns = self.pivot_rows.len();
        let Some(free) = self.pivot_rows.iter().position(|t| *t == FREE) else { return false };
        if self.pivots.len() + 1 != columns {
            return false;
        }
        let mut null = std::mem::take(&mut self.null);
        null.clear();
        null.resize(columns, 0.0);
        null[free] = 1.0;
        for (row, &(pivot, inverse)) in self.pivots.iter().enumerate().rev() {
            let sum: f64 = part(&self.upper, &self.upper_ends, row).iter().map(|&(c, v)| v * null[c]).sum();
            null[pivot] = -sum * inverse;
        }
        self.null = null;
        self.null.iter().all(|v| v.is_finite())
    }

    /// Logarithm of the size of the determinant of J with the plane's normal as its last row.
    pub fn log_determinant(&self, normal: &[f64]) -> f64 {
        let inverses: f64 = self.pivots.iter().map(|(_, inverse)| inverse.abs().ln()).sum();
        dot(normal, &self.null).abs().ln() - inverses
    }

    /// Multiple of z with the inner product `along` with the plane's normal.
    pub fn tangent(&self, normal: &[f64], along: f64, out: &mut Vec<f64>) {
        let scale = along / dot(normal, &self.null);
        out.clear();
        out.extend(self.null.iter().map(|z| scale * z));
    }

    /// Changes x of coordinates for N right-hand sides: J x = `rows`, normal . x = `along`. `out`: one entry for each
    /// coordinate.
    pub fn solve<const N: usize>(
        &self,
        rows: impl Iterator<Item = [f64; N]>,
        normal: &[f64],
        along: [f64; N],
        out: &mut [[f64; N]],
    ) {
        out.fill([0.0; N]);
        // L y = rows, with y stored at the pivots' columns.
        for (row, mut values) in rows.enumerate() {
            for &(r, factor) in part(&self.lower, &self.lower_ends, row) {
                subtract_scaled(&mut values, factor, &out[self.pivots[r].0]);
            }
            out[self.pivots[row].0] = values;
        }
        for (row, &(pivot, inverse)) in self.pivots.iter().enumerate().rev() {
            let mut values = out[pivot];
            for &(column, factor) in part(&self.upper, &self.upper_ends, row) {
                subtract_scaled(&mut values, factor, &out[column]);
            }
            out[pivot] = values.map(|v| v * inverse);
        }
        let mut rest = along;
        for (n, values) in normal.iter().zip(&*out) {
            subtract_scaled(&mut rest, *n, values);
        }
        let across = 1.0 / dot(normal, &self.null);
        let scale = rest.map(|r| -r * across);
        for (values, z) in out.iter_mut().zip(&self.null) {
            subtract_scaled(values, *z, &scale);
        }
    }

    /// Multipliers m with J^T m + c normal = `right` for some c, for N right-hand sides; `right` is overwritten.
    pub fn solve_transposed<const N: usize>(&self, normal: &[f64], right: &mut [[f64; N]], out: &mut Vec<[f64; N]>) {
        let mut along = [0.0; N];
        for (z, values) in self.null.iter().zip(&*right) {
            subtract_scaled(&mut along, -z, values);
        }
        let across = 1.0 / dot(&self.null, normal);
        let scale = along.map(|a| a * across);
        for (values, n) in right.iter_mut().zip(normal) {
            subtract_scaled(values, *n, &scale);
        }
        out.clear();
        for (row, &(pivot, inverse)) in self.pivots.iter().enumerate() {
            let y = right[pivot].map(|r| r * inverse);
            for &(column, factor) in part(&self.upper, &self.upper_ends, row) {
                subtract_scaled(&mut right[column], factor, &y);
            }
            out.push(y);
        }
        for row in (0..out.len()).rev() {
            let values = out[row];
            for &(r, factor) in part(&self.lower, &self.lower_ends, row) {
                subtract_scaled(&mut out[r], factor, &values);
            }
        }
    }
}

/// Subtract `factor` times `values`.
fn subtract_scaled<const N: usize>(sums: &mut [f64; N], factor: f64, values: &[f64; N]) {
    for (sum, value) in sums.iter_mut().zip(values) {
        *sum -= factor * value;
    }
}

/// Inner product.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    /// Pseudo-random number in [-0.5, 0.5).
    fn noise(seed: &mut u64) -> f64 {
        *seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (*seed >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    }

    #[test]
    fn solutions_are_those_of_the_dense_bordered_matrix() {
        let mut seed = 1;
        for n in [2, 3, 7, 70] {
            let dense = DMatrix::from_fn(n, n, |r, c| {
                let near = r + 1 < n && c + 3 > r && c < r + 4;
                if near || r + 1 == n { noise(&mut seed) } else { 0.0 }
            });
            let normal: Vec<f64> = dense.row(n - 1).iter().copied().collect();
            let weights: Vec<f64> = (0..n).map(|i| 1.0 + (i % 3) as f64).collect();
            let mut factors = Factors::default();
            factors.clear(n);
            for r in 0..n - 1 {
                let row = dense.row(r);
                assert!(factors.push((0..n).filter(|c| row[*c] != 0.0).map(|c| (c, row[c])), &weights));
            }
            assert!(factors.finish());
            let right: Vec<f64> = (0..n).map(|_| noise(&mut seed)).collect();
            let mut out = Vec::new();
            let mut solutions = vec![[0.0; 2]; n];
            let rows = right[..n - 1].iter().map(|r| [*r, -0.5 * r]);
            factors.solve(rows, &normal, [right[n - 1], -0.5 * right[n - 1]], &mut solutions);
            // The amplification of a random band matrix is some 1e3.
            for (k, factor) in [1.0, -0.5].into_iter().enumerate() {
                let solution = DVector::from_iterator(n, solutions.iter().map(|s| s[k]));
                let miss = &dense * solution - factor * DVector::from_column_slice(&right);
                assert!(miss.norm() < 1e-11, "{n}: {miss}");
            }
            factors.tangent(&normal, 2.0, &mut out);
            let miss = &dense * DVector::from_column_slice(&out);
            assert!((miss[n - 1] - 2.0).abs() < 1e-11 && miss.rows(0, n - 1).norm() < 1e-11, "{n}: {miss}");
            let mut solutions = Vec::new();
            let mut rights: Vec<[f64; 2]> = right.iter().map(|r| [*r, -0.5 * r]).collect();
            factors.solve_transposed(&normal, &mut rights, &mut solutions);
            let normal = DVector::from_column_slice(&normal);
            for (k, factor) in [1.0, -0.5].into_iter().enumerate() {
                let solution = DVector::from_iterator(n - 1, solutions.iter().map(|s| s[k]));
                let rest = factor * DVector::from_column_slice(&right) - dense.rows(0, n - 1).transpose() * &solution;
                let along = rest.dot(&normal) / normal.norm_squared();
                assert!((rest - along * &normal).norm() < 1e-11 * solution.norm().max(1.0), "{n}");
            }
        }
    }

    /// Whole rows give the same bits by either way, zeros and dependent rows among them.
    #[test]
    fn whole_rows_are_rows() {
        let mut seed = 2;
        for case in 0..200 {
            let n = 2 + case % 5;
            let weights: Vec<f64> = (0..n).map(|i| 1.0 + (i % 3) as f64).collect();
            let [mut one, mut other] = [Factors::default(), Factors::default()];
            one.clear(n);
            other.clear(n);
            let mut rows: Vec<Vec<f64>> = Vec::new();
            for r in 0..n - 1 {
                let row: Vec<f64> = match rows.last() {
                    Some(last) if case % 7 == 0 => last.iter().map(|v| 2.0 * v).collect(),
                    _ => (0..n).map(|c| if (c + r + case) % 4 == 0 { 0.0 } else { noise(&mut seed) }).collect(),
                };
                let pushed = one.push(row.iter().copied().enumerate(), &weights);
                assert_eq!(other.push_whole(&row, &weights), pushed);
                if !pushed {
                    break;
                }
                rows.push(row);
            }
            assert_eq!(one.finish(), other.finish());
            assert_eq!(one, other);
        }
    }

    #[test]
    fn a_dependent_row_is_reported() {
        let mut factors = Factors::default();
        factors.clear(3);
        assert!(factors.push([(0, 1.0), (1, 2.0)].into_iter(), &[1.0; 3]));
        assert!(!factors.push([(0, 2.0), (1, 4.0)].into_iter(), &[1.0; 3]));
        assert!(!factors.finish());
    }
}
