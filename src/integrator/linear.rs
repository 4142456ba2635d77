//! Linear algebra of a few rows: the systems of an implicit step, real and complex, and the largest eigenvalue.
use std::ops::{Add, Div, Mul, Sub};

/// A number that a linear system can be solved in.
pub(super) trait Scalar:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
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
pub(super) struct Complex {
    pub re: f64,
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
pub(super) struct Factors<T, const N: usize> {
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

/// The largest |eigenvalue| of a real matrix, from the trace of its eighth power: at most the factor N^(1/8) too large.
/// It needs no scaling of the components, as a trace does not depend on their units. Too small where the largest are a
/// complex pair whose eighth powers are nearly imaginary: oscillation, which is not stiffness.
pub(super) fn largest_eigenvalue<const N: usize>(a: &[[f64; N]; N]) -> f64 {
    let square = |m: &[[f64; N]; N]| -> [[f64; N]; N] {
        std::array::from_fn(|i| std::array::from_fn(|j| (0..N).map(|k| m[i][k] * m[k][j]).sum()))
    };
    let fourth = square(&square(a));
    let trace: f64 = (0..N).map(|i| (0..N).map(|j| fourth[i][j] * fourth[j][i]).sum::<f64>()).sum();
    trace.abs().sqrt().sqrt().sqrt()
}
