//! Gauss elimination for linear systems of a few rows, real or complex.
pub use nalgebra::Complex;
use std::ops::{Mul, Sub};

/// A number that a linear system can be solved in.
pub trait Scalar: Copy + Sub<Output = Self> + Mul<Output = Self> {
    /// A size to choose pivots by: |re| + |im|.
    fn size(self) -> f64;
    /// Quotient of this number and a divisor.
    fn over(self, divisor: Self) -> Self;
}

impl Scalar for f64 {
    fn size(self) -> f64 {
        self.abs()
    }
    fn over(self, divisor: Self) -> Self {
        self / divisor
    }
}

impl Scalar for Complex<f64> {
    fn size(self) -> f64 {
        self.re.abs() + self.im.abs()
    }
    // One division, where the operator of the type takes two.
    fn over(self, divisor: Self) -> Self {
        (self * divisor.conj()).scale(1.0 / divisor.norm_sqr())
    }
}

/// A = P^T L U with row interchanges.
#[derive(Clone, Copy, Debug)]
pub struct Factors<T, const N: usize> {
    lu: [[T; N]; N],
    pivots: [usize; N],
    /// Columns from this one on have their diagonal entry only.
    leading: usize,
}

/// Largest number of rows for which the elimination is compiled apart, with its loops unrolled.
const FEW: usize = 4;

impl<T: Scalar, const N: usize> Factors<T, N> {
    /// Of a matrix whose columns after the first `leading` have no entry but that on the diagonal. None if a pivot is 0
    /// or not finite.
    pub fn new(mut a: [[T; N]; N], leading: usize) -> Option<Self> {
        let mut pivots: [usize; N] = std::array::from_fn(|k| k);
        let (rows, places) = (a.as_flattened_mut(), &mut pivots[..]);
        let factor = if N > FEW { factor_any } else { factor };
        factor(rows, places, leading).then_some(Self { lu: a, pivots, leading })
    }

    /// x with A x = b.
    pub fn solve(&self, mut b: [T; N]) -> [T; N] {
        let solve = if N > FEW { solve_any } else { solve };
        solve(self.lu.as_flattened(), &self.pivots, self.leading, &mut b);
        b
    }
}

#[inline(never)]
fn factor_any<T: Scalar>(a: &mut [T], pivots: &mut [usize], leading: usize) -> bool {
    factor(a, pivots, leading)
}

#[inline(never)]
fn solve_any<T: Scalar>(lu: &[T], pivots: &[usize], leading: usize, b: &mut [T]) {
    solve(lu, pivots, leading, b);
}

/// Factor a matrix, row by row, in its place; false if a pivot is 0 or not finite.
#[inline(always)]
fn factor<T: Scalar>(a: &mut [T], pivots: &mut [usize], leading: usize) -> bool {
    let n = pivots.len();
    if (leading..n).any(|k| !is_pivot(a[k * n + k])) {
        return false;
    }
    for k in 0..leading {
        let mut pivot = k;
        for i in k + 1..leading {
            if a[i * n + k].size() > a[pivot * n + k].size() {
                pivot = i;
            }
        }
        if !is_pivot(a[pivot * n + k]) {
            return false;
        }
        pivots[k] = pivot;
        if pivot != k {
            (0..n).for_each(|j| a.swap(k * n + j, pivot * n + j));
        }
        let (above, below) = a.split_at_mut((k + 1) * n);
        let row = &above[k * n..];
        for below in below.chunks_exact_mut(n) {
            let factor = below[k].over(row[k]);
            below[k] = factor;
            for (entry, above) in below.iter_mut().zip(row).take(leading).skip(k + 1) {
                *entry = *entry - factor * *above;
            }
        }
    }
    true
}

/// Solve a system with these factors in the place of its right-hand side.
#[inline(always)]
fn solve<T: Scalar>(lu: &[T], pivots: &[usize], leading: usize, b: &mut [T]) {
    let n = pivots.len();
    for (k, pivot) in pivots.iter().enumerate().take(leading) {
        b.swap(k, *pivot);
    }
    for k in 0..leading {
        for i in k + 1..n {
            b[i] = b[i] - lu[i * n + k] * b[k];
        }
    }
    for k in leading..n {
        b[k] = b[k].over(lu[k * n + k]);
    }
    for k in (0..leading).rev() {
        b[k] = b[k].over(lu[k * n + k]);
        for i in 0..k {
            b[i] = b[i] - lu[i * n + k] * b[k];
        }
    }
}

/// Whether a number can be divided by.
fn is_pivot<T: Scalar>(pivot: T) -> bool {
    let size = pivot.size();
    size > 0.0 && size.is_finite()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::ops::Add;

    /// Backward stable: the residual is small whatever the condition.
    fn is_solved<T: Scalar + Add<Output = T>>(a: [[T; 3]; 3], x: [T; 3], zero: T, rounding: f64) {
        let leading =
            (0..3).rfind(|column| (0..*column).any(|i| a[i][*column].size() > 0.0)).map_or(0, |last| last + 1);
        let Some(factors) = Factors::new(a, leading) else { return };
        let b: [T; 3] = std::array::from_fn(|i| (0..3).fold(zero, |sum, j| sum + a[i][j] * x[j]));
        let y = factors.solve(b);
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
            // The last component is an integral beside the others.
            is_solved([[a[0][0], a[0][1], 0.0], [a[1][0], a[1][1], 0.0], a[2]], x, 0.0, 1e-13);
            let c = std::array::from_fn(|i| std::array::from_fn(|j| Complex::new(a[i][j], im[i][j])));
            is_solved(c, x.map(|x| Complex::new(x, 1.0 - x)), Complex::new(0.0, 0.0), 1e-13);
        }
    }

    #[test]
    fn a_singular_system_has_no_factors() {
        assert!(Factors::new([[1.0, 2.0], [2.0, 4.0]], 2).is_none());
        assert!(Factors::new([[f64::NAN, 2.0], [2.0, 4.0]], 2).is_none());
        assert!(Factors::new([[1.0, 0.0], [2.0, 0.0]], 1).is_none());
    }
}
