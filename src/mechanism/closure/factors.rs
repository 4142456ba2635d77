//! The independent loop equations linearised: a sparse factorisation with its null vector.
//!
//! In: the rows of the loop Jacobian J, one fewer than coordinates. Out: J = L U with U upper triangular up to the order of
//! its columns, the direction z with J z = 0, and solutions on a plane across it. Each row takes the column of its largest
//! entry as pivot and is rid of the columns that earlier rows took, so that the rows of a chain stay short and the cost
//! grows with the number of entries. It must not know linkages.

/// An entry of a row: its column, or for L the row that is subtracted.
type Entry = (usize, f64);

/// No row has taken this column.
const FREE: usize = usize::MAX;

/// Factors of J, with room for the next ones.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Factors {
    /// Rows of U without their pivots, and of L without its unit diagonal, one after another; where each row ends.
    upper: Vec<Entry>,
    upper_ends: Vec<usize>,
    lower: Vec<Entry>,
    lower_ends: Vec<usize>,
    /// Of each row, the column of its pivot and the pivot's inverse.
    pivots: Vec<Entry>,
    /// The row that has taken each column.
    taken: Vec<usize>,
    /// z: J z = 0, 1 in the column that no row has taken.
    pub null: Vec<f64>,
    /// The row at work: its entries by column, the columns they are in, and the rows still to be subtracted, as bits.
    entries: Vec<f64>,
    present: Vec<bool>,
    columns: Vec<usize>,
    waiting: Vec<u64>,
}

fn part<'a>(entries: &'a [Entry], ends: &[usize], row: usize) -> &'a [Entry] {
    &entries[if row == 0 { 0 } else { ends[row - 1] }..ends[row]]
}

impl Factors {
    /// Forget the last factors, for `columns` coordinates.
    pub fn clear(&mut self, columns: usize) {
        for list in [&mut self.upper, &mut self.lower, &mut self.pivots] {
            list.clear();
        }
        for ends in [&mut self.upper_ends, &mut self.lower_ends] {
            ends.clear();
        }
        self.taken.clear();
        self.taken.resize(columns, FREE);
        // Every row leaves these as they were: empty.
        self.entries.resize(columns, 0.0);
        self.present.resize(columns, false);
        self.waiting.resize(columns.div_ceil(64), 0);
    }

    /// Add a row; `weights` makes its entries comparable. False if it follows from earlier rows.
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
            if self.taken[column] == FREE && size > best.1 {
                best = (column, size);
            }
        }
        let (pivot, size) = best;
        let regular = pivot != FREE && size.is_finite();
        if regular {
            self.taken[pivot] = self.pivots.len();
            self.pivots.push((pivot, 1.0 / self.entries[pivot]));
        }
        for &column in &self.columns {
            if regular && column != pivot && self.taken[column] == FREE && self.entries[column] != 0.0 {
                self.upper.push((column, self.entries[column]));
            }
            self.entries[column] = 0.0;
            self.present[column] = false;
        }
        self.columns.clear();
        self.upper_ends.push(self.upper.len());
        regular
    }

    /// A column of the row at work has an entry.
    fn touch(&mut self, column: usize) {
        if !self.present[column] {
            self.present[column] = true;
            self.columns.push(column);
            let row = self.taken[column];
            if row != FREE {
                self.waiting[row / 64] |= 1 << (row % 64);
            }
        }
    }

    /// Rid the row at work of the column that `row` has taken.
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

    /// All rows are in: find the null vector. False if there is not one free column.
    pub fn finish(&mut self) -> bool {
        let columns = self.taken.len();
        let Some(free) = self.taken.iter().position(|t| *t == FREE) else { return false };
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

    /// Multiple of z that is `along` on the plane's normal.
    pub fn tangent(&self, normal: &[f64], along: f64, out: &mut Vec<f64>) {
        let scale = along / dot(normal, &self.null);
        out.clear();
        out.extend(self.null.iter().map(|z| scale * z));
    }

    /// The changes of coordinates for several changes of the rows at once, told row by row, and `along` on the plane's
    /// normal. `out` has a place for each coordinate.
    pub fn solve<const N: usize>(
        &self,
        rows: impl Iterator<Item = [f64; N]>,
        normal: &[f64],
        along: [f64; N],
        out: &mut [[f64; N]],
    ) {
        out.fill([0.0; N]);
        // L y = rows; y is kept at the pivots' columns.
        for (row, mut values) in rows.enumerate() {
            for &(r, factor) in part(&self.lower, &self.lower_ends, row) {
                take(&mut values, factor, &out[self.pivots[r].0]);
            }
            out[self.pivots[row].0] = values;
        }
        for (row, &(pivot, inverse)) in self.pivots.iter().enumerate().rev() {
            let mut values = out[pivot];
            for &(column, factor) in part(&self.upper, &self.upper_ends, row) {
                take(&mut values, factor, &out[column]);
            }
            out[pivot] = values.map(|v| v * inverse);
        }
        let mut rest = along;
        for (n, values) in normal.iter().zip(&*out) {
            take(&mut rest, *n, values);
        }
        let across = 1.0 / dot(normal, &self.null);
        let scale = rest.map(|r| -r * across);
        for (values, z) in out.iter_mut().zip(&self.null) {
            take(values, *z, &scale);
        }
    }

    /// Factors of the rows whose sum, with a multiple of the plane's normal, gives each `right`; these are used up.
    pub fn solve_transposed<const N: usize>(&self, normal: &[f64], right: &mut [[f64; N]], out: &mut Vec<[f64; N]>) {
        let mut along = [0.0; N];
        for (z, values) in self.null.iter().zip(&*right) {
            take(&mut along, -z, values);
        }
        let across = 1.0 / dot(&self.null, normal);
        let scale = along.map(|a| a * across);
        for (values, n) in right.iter_mut().zip(normal) {
            take(values, *n, &scale);
        }
        out.clear();
        for (row, &(pivot, inverse)) in self.pivots.iter().enumerate() {
            let y = right[pivot].map(|r| r * inverse);
            for &(column, factor) in part(&self.upper, &self.upper_ends, row) {
                take(&mut right[column], factor, &y);
            }
            out.push(y);
        }
        for row in (0..out.len()).rev() {
            let values = out[row];
            for &(r, factor) in part(&self.lower, &self.lower_ends, row) {
                take(&mut out[r], factor, &values);
            }
        }
    }
}

/// Less `factor` times `values`.
fn take<const N: usize>(sums: &mut [f64; N], factor: f64, values: &[f64; N]) {
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

    /// Numbers that look random.
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

    #[test]
    fn a_row_that_follows_from_others_is_told() {
        let mut factors = Factors::default();
        factors.clear(3);
        assert!(factors.push([(0, 1.0), (1, 2.0)].into_iter(), &[1.0; 3]));
        assert!(!factors.push([(0, 2.0), (1, 4.0)].into_iter(), &[1.0; 3]));
        assert!(!factors.finish());
    }
}
