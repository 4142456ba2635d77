//! Gauss elimination for linear systems of a few rows, real or complex.
use std::ops::{Add, Div, Mul, Sub};

/// A number that a linear system can be solved in.
pub trait Scalar: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> {
    /// A size to choose pivots by: |re| + |im|.
    fn size(self) -> f64;
}

impl Scalar for f64 {
    fn size(self) -> f64 {
        self.abs()
    }
}

/// re + i im.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Complex {
    /// Real part.
    pub re: f64,
    /// Imaginary part.
    pub im: f64,
}

impl Add for Complex {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        Self { re: self.re + b.re, im: self.im + b.im }
    }
}

impl Sub for Complex {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        Self { re: self.re - b.re, im: self.im - b.im }
    }
}

impl Mul for Complex {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        Self { re: self.re * b.re - self.im * b.im, im: self.re * b.im + self.im * b.re }
    }
}

impl Div for Complex {
    type Output = Self;
    fn div(self, b: Self) -> Self {
        let inverse = 1.0 / (b.re * b.re + b.im * b.im);
        let top = self * Self { re: b.re, im: -b.im };
        Self { re: top.re * inverse, im: top.im * inverse }
    }
}

impl Scalar for Complex {
    fn size(self) -> f64 {
        self.re.abs() + self.im.abs()
    }
}

/// A = P^T L U with row interchanges.
#[derive(Clone, Copy, Debug)]
pub struct Factors<T, const N: usize> {
    lu: [[T; N]; N],
    pivots: [usize; N],
}

impl<T: Scalar, const N: usize> Factors<T, N> {
    /// None if a pivot is 0 or not finite.
    pub fn new(mut a: [[T; N]; N]) -> Option<Self> {
        let mut pivots = [0; N];
        for k in 0..N {
            let mut pivot = k;
            for i in k + 1..N {
                if a[i][k].size() > a[pivot][k].size() {
                    pivot = i;
                }
            }
            let size = a[pivot][k].size();
            if !(size > 0.0 && size.is_finite()) {
                return None;
            }
            pivots[k] = pivot;
            a.swap(k, pivot);
            let row = a[k];
            for below in &mut a[k + 1..] {
                let factor = below[k] / row[k];
                below[k] = factor;
                for (entry, above) in below.iter_mut().zip(&row).skip(k + 1) {
                    *entry = *entry - factor * *above;
                }
            }
        }
        Some(Self { lu: a, pivots })
    }

    /// x with A x = b.
    pub fn solve(&self, mut b: [T; N]) -> [T; N] {
        for k in 0..N {
            b.swap(k, self.pivots[k]);
        }
        for k in 0..N {
            for i in k + 1..N {
                b[i] = b[i] - self.lu[i][k] * b[k];
            }
        }
        for k in (0..N).rev() {
            b[k] = b[k] / self.lu[k][k];
            for i in 0..k {
                b[i] = b[i] - self.lu[i][k] * b[k];
            }
        }
        b
    }
}

#[cfg(test)]
mod tests {
    use super::{Complex, Factors};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn solutions_satisfy_their_systems(
            a in prop::array::uniform3(prop::array::uniform3(-1.0..1.0_f64)),
            im in prop::array::uniform3(prop::array::uniform3(-1.0..1.0_f64)),
            x in prop::array::uniform3(-1.0..1.0_f64),
        ) {
            if let Some(factors) = Factors::new(a) {
                let b: [f64; 3] = std::array::from_fn(|i| (0..3).map(|j| a[i][j] * x[j]).sum());
                let y = factors.solve(b);
                // Backward stable: the residual is small whatever the condition.
                let size = y.iter().fold(1.0_f64, |m, y| m.max(y.abs()));
                for i in 0..3 {
                    let residual = b[i] - (0..3).map(|j| a[i][j] * y[j]).sum::<f64>();
                    prop_assert!(residual.abs() < 1e-14 * size, "{residual}");
                }
            }
            let c: [[Complex; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|j| Complex { re: a[i][j], im: im[i][j] }));
            if let Some(factors) = Factors::new(c) {
                let z = x.map(|x| Complex { re: x, im: 1.0 - x });
                let b: [Complex; 3] = std::array::from_fn(|i| {
                    (0..3).fold(Complex { re: 0.0, im: 0.0 }, |sum, j| sum + c[i][j] * z[j])
                });
                let y = factors.solve(b);
                let size = y.iter().fold(1.0_f64, |m, y| m.max(y.re.abs() + y.im.abs()));
                for i in 0..3 {
                    let residual = (0..3).fold(b[i], |sum, j| sum - c[i][j] * y[j]);
                    prop_assert!(residual.re.abs() + residual.im.abs() < 1e-13 * size, "{residual:?}");
                }
            }
        }
    }

    #[test]
    fn a_singular_system_has_no_factors() {
        assert!(Factors::new([[1.0, 2.0], [2.0, 4.0]]).is_none());
        assert!(Factors::new([[f64::NAN, 2.0], [2.0, 4.0]]).is_none());
    }
}
