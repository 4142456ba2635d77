//! Gauss elimination for linear systems of a few rows, real or complex.
pub use nalgebra::Complex;
use std::ops::{Mul, Sub};

/// Number type of a linear system.
pub trait Scalar: Copy + Sub<Output = Self> + Mul<Output = Self> {
    /// The number 0.
    const ZERO: Self;
    /// Size for the choice of pivots: |re| + |im|.
    fn size(self) -> f64;
    /// The reciprocal.
    fn inverse(self) -> Self;
}

impl Scalar for f64 {
    const ZERO: Self = 0.0;
    fn size(self) -> f64 {
        self.abs()
    }
    fn inverse(self) -> Self {
        1.0 / self
    }
}

impl Scalar for Complex<f64> {
    const ZERO: Self = Complex { re: 0.0, im: 0.0 };
    fn size(self) -> f64 {
        self.re.abs() + self.im.abs()
    }
    // One division; the operator of the type needs two.
    fn inverse(self) -> Self {
        self.conj().scale(1.0 / self.norm_sqr())
    }
}

/// A = P^T L U with row interchanges, for a matrix with at most N rows.
#[derive(Clone, Copy, Debug)]
pub struct Factors<T, const N: usize> {
    /// L below the diagonal, U above it, the reciprocals of the diagonal of U on it; column by column.
    columns: [[T; N]; N],
    pivots: [usize; N],
    rows: usize,
}

impl<T: Scalar, const N: usize> Default for Factors<T, N> {
    fn default() -> Self {
        Self { columns: [[T::ZERO; N]; N], pivots: [0; N], rows: 0 }
    }
}

impl<T: Scalar, const N: usize> Factors<T, N> {
    /// Factorises a square matrix with this number of rows. `entry`: the entry in a row and a column. Returns false if
    /// a pivot is 0 or not finite.
    pub fn factor(&mut self, rows: usize, entry: impl Fn(usize, usize) -> T) -> bool {
        self.rows = rows;
        for (j, column) in self.columns[..rows].iter_mut().enumerate() {
            column[..rows].iter_mut().enumerate().for_each(|(i, own)| *own = entry(i, j));
        }
        self.eliminate()
    }

    /// Gauss elimination in place.
    #[inline(never)]
    fn eliminate(&mut self) -> bool {
        let rows = self.rows;
        for k in 0..rows {
            let (before, after) = self.columns[..rows].split_at_mut(k + 1);
            let column = &mut before[k][..rows];
            let mut pivot = k;
            for i in k + 1..rows {
                if column[i].size() > column[pivot].size() {
                    pivot = i;
                }
            }
            let size = column[pivot].size();
            if !(size > 0.0 && size.is_finite()) {
                return false;
            }
            self.pivots[k] = pivot;
            column.swap(k, pivot);
            column[k] = column[k].inverse();
            for i in k + 1..rows {
                column[i] = column[i] * column[k];
            }
            for other in after {
                other.swap(k, pivot);
                subtract(&mut other[..rows], k, &column[k + 1..]);
            }
            before[..k].iter_mut().for_each(|earlier| earlier.swap(k, pivot));
        }
        true
    }

    /// Solves A x = b in place. Components of b after the rows of A do not change.
    #[inline(never)]
    pub fn solve(&self, b: &mut [T; N]) {
        let b = &mut b[..self.rows];
        for (k, pivot) in self.pivots[..b.len()].iter().enumerate() {
            b.swap(k, *pivot);
        }
        for k in 0..b.len() {
            subtract(b, k, &self.columns[k][k + 1..b.len()]);
        }
        for k in (0..b.len()).rev() {
            b[k] = b[k] * self.columns[k][k];
            let (above, from) = b.split_at_mut(k);
            for (b, entry) in above.iter_mut().zip(&self.columns[k]) {
                *b = *b - *entry * from[0];
            }
        }
    }

    /// Copies the factors of `other`.
    pub fn copy_from(&mut self, other: &Self) {
        let rows = other.rows;
        for (own, other) in self.columns.iter_mut().zip(&other.columns[..rows]) {
            own[..rows].copy_from_slice(&other[..rows]);
        }
        (self.pivots, self.rows) = (other.pivots, rows);
    }
}

/// Subtracts multiples of component k of a vector from the components after it.
#[inline]
fn subtract<T: Scalar>(vector: &mut [T], k: usize, multiples: &[T]) {
    let (to, below) = vector.split_at_mut(k + 1);
    for (own, multiple) in below.iter_mut().zip(multiples) {
        *own = *own - *multiple * to[k];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::ops::Add;

    /// Factors of a matrix, if there are any.
    fn factored<T: Scalar, const N: usize>(a: [[T; N]; N]) -> Option<Factors<T, N>> {
        let mut factors = Factors::default();
        factors.factor(N, |i, j| a[i][j]).then_some(factors)
    }

    /// Backward stable: the residual is small for any condition number.
    fn is_solved<T: Scalar + Add<Output = T>>(a: [[T; 3]; 3], x: [T; 3], zero: T, rounding: f64) {
        let Some(factors) = factored(a) else { return };
        let b: [T; 3] = std::array::from_fn(|i| (0..3).fold(zero, |sum, j| sum + a[i][j] * x[j]));
        let mut y = b;
        factors.solve(&mut y);
        let size = y.iter().fold(1.0_f64, |m, y| m.max(y.size()));
        for i in 0..3 {
            let residual = (0..3).fold(b[i], |rest, j| rest - a[i][j] * y[j]).size();
            assert!(residual < rounding * size, "{residual}");
        }
    }

    proptest! {
        #[test]
        fn solutions_satisfy_their_systems(
            a in prop::array::uniform3(prop::array::uniform3(-1.0..1.0_f64)),
            im in prop::array::uniform3(prop::array::uniform3(-1.0..1.0_f64)),
            x in prop::array::uniform3(-1.0..1.0_f64),
        ) {
            is_solved(a, x, 0.0, 1e-14);
            let c = std::array::from_fn(|i| std::array::from_fn(|j| Complex::new(a[i][j], im[i][j])));
            is_solved(c, x.map(|x| Complex::new(x, 1.0 - x)), Complex::new(0.0, 0.0), 1e-13);
        }
    }

    /// A smaller matrix after a larger one in the same memory, and its copy.
    #[test]
    fn smaller_systems_use_the_same_memory() {
        let mut factors = Factors::<f64, 3>::default();
        assert!(factors.factor(3, |i, j| if i == j { 7.0 } else { 1.0 }));
        assert!(factors.factor(2, |i, j| [[0.0, 2.0], [4.0, 1.0]][i][j]));
        let mut copy = Factors::default();
        copy.copy_from(&factors);
        let mut b = [6.0, 11.0, 5.0];
        copy.solve(&mut b);
        assert_eq!(b, [2.0, 3.0, 5.0]);
    }

    #[test]
    fn a_singular_system_has_no_factors() {
        assert!(factored([[1.0, 2.0], [2.0, 4.0]]).is_none());
        assert!(factored([[f64::NAN, 2.0], [2.0, 4.0]]).is_none());
        assert!(factored([[1.0, 0.0], [2.0, 0.0]]).is_none());
    }
}
