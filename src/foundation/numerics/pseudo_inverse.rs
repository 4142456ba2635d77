//! The pseudo-inverse of a matrix.
use nalgebra::DMatrix;

/// The pseudo-inverse of a matrix by its singular values, where values up to `cut` count as 0. Products are computed
/// column by column, because products of whole matrices would add kernels for large matrices to each library. The
/// function is compiled where it is called, so that a library has one copy of nalgebra's decomposition.
#[inline]
pub fn pseudo_inverse(matrix: DMatrix<f64>, cut: f64) -> DMatrix<f64> {
    let (rows, columns) = matrix.shape();
    let inverse = matrix.svd(true, true).solve(&DMatrix::identity(rows, rows), cut);
    inverse.unwrap_or_else(|_| DMatrix::zeros(columns, rows))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_satisfies_the_conditions_of_moore_and_penrose_without_full_rank() {
        // Rank 2, with 4 rows and 7 columns.
        let matrix = DMatrix::from_fn(4, 7, |i, k| (i as f64 + 1.0) * (k as f64 - 2.0) + (i * i) as f64);
        let inverse = pseudo_inverse(matrix.clone(), 1e-9);
        let (left, right) = (&matrix * &inverse, &inverse * &matrix);
        assert!((&left * &matrix - &matrix).amax() < 1e-12 * matrix.amax());
        assert!((&right * &inverse - &inverse).amax() < 1e-12 * inverse.amax());
        assert!((left.transpose() - left).amax() < 1e-13 && (right.transpose() - right).amax() < 1e-13);
    }
}
