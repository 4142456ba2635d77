//! Small dense systems by Gaussian elimination with pivoting.

/// The leading rows and columns of a matrix as LU factors, with the order of its rows.
pub struct Factors<const N: usize> {
    matrix: [[f64; N]; N],
    order: [usize; N],
    count: usize,
}

impl<const N: usize> Factors<N> {
    pub fn of(mut matrix: [[f64; N]; N], count: usize) -> Self {
        let mut order = std::array::from_fn(|i| i);
        for k in 0..count {
            let pivot = (k..count).max_by(|&a, &b| matrix[a][k].abs().total_cmp(&matrix[b][k].abs())).unwrap_or(k);
            matrix.swap(k, pivot);
            order.swap(k, pivot);
            for r in k + 1..count {
                matrix[r][k] /= matrix[k][k];
                for c in k + 1..count {
                    matrix[r][c] -= matrix[r][k] * matrix[k][c];
                }
            }
        }
        Self { matrix, order, count }
    }

    pub fn solve(&self, right: &[f64; N]) -> [f64; N] {
        let mut x = [0.0; N];
        for r in 0..self.count {
            x[r] = right[self.order[r]] - (0..r).map(|c| self.matrix[r][c] * x[c]).sum::<f64>();
        }
        for r in (0..self.count).rev() {
            let known: f64 = (r + 1..self.count).map(|c| self.matrix[r][c] * x[c]).sum();
            x[r] = (x[r] - known) / self.matrix[r][r];
        }
        x
    }
}
