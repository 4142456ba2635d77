//! Dense LU factors with row pivoting, in place and without allocation.

/// A square matrix, row by row, and its factors after [`Lu::factor`].
#[derive(Clone, Debug, PartialEq)]
pub struct Lu {
    n: usize,
    entries: Vec<f64>,
    pivots: Vec<usize>,
}

impl Lu {
    /// An n by n matrix of zeros.
    pub fn new(n: usize) -> Self {
        Self { n, entries: vec![0.0; n * n], pivots: vec![0; n] }
    }

    /// Set all entries to 0.
    pub fn clear(&mut self) {
        self.entries.fill(0.0);
    }

    /// Add to an entry.
    pub fn add(&mut self, row: usize, column: usize, value: f64) {
        self.entries[row * self.n + column] += value;
    }

    /// Replace the matrix by its factors P A = L U. False if the matrix is singular or not finite.
    pub fn factor(&mut self) -> bool {
        let n = self.n;
        for k in 0..n {
            let size = |row: usize| self.entries[row * n + k].abs();
            let pivot = (k + 1..n).fold(k, |best, row| if size(row) > size(best) { row } else { best });
            let value = self.entries[pivot * n + k];
            if !value.is_finite() || value == 0.0 {
                return false;
            }
            self.pivots[k] = pivot;
            if pivot != k {
                for column in 0..n {
                    self.entries.swap(k * n + column, pivot * n + column);
                }
            }
            let (above, below) = self.entries.split_at_mut((k + 1) * n);
            let upper = &above[k * n..];
            for row in below.chunks_exact_mut(n) {
                let factor = row[k] / value;
                row[k] = factor;
                if factor != 0.0 {
                    row[k + 1..].iter_mut().zip(&upper[k + 1..]).for_each(|(r, u)| *r -= factor * u);
                }
            }
        }
        true
    }

    /// Solve A x = b; x replaces b.
    pub fn solve(&self, b: &mut [f64]) {
        let n = self.n;
        for k in 0..n {
            b.swap(k, self.pivots[k]);
        }
        for row in 0..n {
            let (known, rest) = b.split_at_mut(row);
            let line = &self.entries[row * n..row * n + row];
            rest[0] -= line.iter().zip(&*known).map(|(l, x)| l * x).sum::<f64>();
        }
        for row in (0..n).rev() {
            let (rest, known) = b.split_at_mut(row + 1);
            let line = &self.entries[row * n..(row + 1) * n];
            let sum: f64 = line[row + 1..].iter().zip(&*known).map(|(u, x)| u * x).sum();
            rest[row] = (rest[row] - sum) / line[row];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_system_that_needs_pivots_is_solved() {
        let a = [[0.0, 2.0, 1.0], [4.0, 1.0, -3.0], [8.0, 2.0, 5.0]];
        let x = [1.0, -2.0, 3.0];
        let mut lu = Lu::new(3);
        let mut b = [0.0; 3];
        for (i, row) in a.iter().enumerate() {
            for (j, value) in row.iter().enumerate() {
                lu.add(i, j, *value);
                b[i] += value * x[j];
            }
        }
        assert!(lu.factor());
        lu.solve(&mut b);
        for (found, expected) in b.iter().zip(&x) {
            assert!((found - expected).abs() < 1e-14);
        }
        lu.clear();
        assert!(!lu.factor());
    }
}
