//! Functions of the present processor beyond the baseline of its family: fused multiply-add, four numbers at once.
//!
//! In: a task that is generic over its arithmetic. Out: its result, by the fastest code for this processor. Results are
//! bit-identical on all processors with fused multiply-add. Results on other processors differ by rounding errors. Must
//! not know: what is computed.
#![allow(unsafe_code)]

/// Rounding of a b + c.
pub trait Arithmetic {
    /// a b + c.
    fn multiply_add(a: f64, b: f64, c: f64) -> f64;

    /// [`Self::multiply_add`], element by element.
    #[inline(always)]
    fn multiply_add_each(a: &[f64; 4], b: &[f64; 4], c: &[f64; 4]) -> [f64; 4] {
        std::array::from_fn(|i| Self::multiply_add(a[i], b[i], c[i]))
    }
}

/// One rounding, of the sum. Private, because only [`run`] knows that the processor has the features.
struct Fused;

/// Two roundings, of the product and of the sum.
pub struct Separate;

impl Arithmetic for Fused {
    #[inline(always)]
    fn multiply_add(a: f64, b: f64, c: f64) -> f64 {
        a.mul_add(b, c)
    }

    /// One instruction. The compiler often finds only single or pairwise operations in the elements.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    fn multiply_add_each(a: &[f64; 4], b: &[f64; 4], c: &[f64; 4]) -> [f64; 4] {
        use std::arch::x86_64::{_mm256_fmadd_pd, _mm256_loadu_pd, _mm256_storeu_pd};
        let mut sums = [0.0; 4];
        // SAFETY: `run` has tested the features of the processor. Each pointer is that of four numbers. A closure would
        // be compiled without the features.
        unsafe {
            let (a, b, c) = (_mm256_loadu_pd(a.as_ptr()), _mm256_loadu_pd(b.as_ptr()), _mm256_loadu_pd(c.as_ptr()));
            _mm256_storeu_pd(sums.as_mut_ptr(), _mm256_fmadd_pd(a, b, c));
        }
        sums
    }
}

impl Arithmetic for Separate {
    #[inline(always)]
    fn multiply_add(a: f64, b: f64, c: f64) -> f64 {
        a * b + c
    }
}

/// A task that is compiled separately for each kind of processor. [`Task::run`] and the functions that it calls must be
/// inlined. Otherwise they are compiled for the baseline processor, on which a fused operation is a library call.
pub trait Task {
    /// Result of the task.
    type Result;

    /// Does the task with this arithmetic.
    fn run<A: Arithmetic>(self) -> Self::Result;
}

/// Does a task with the fastest code for this processor.
#[inline(always)]
pub fn run<T: Task>(task: T) -> T::Result {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma") {
        // SAFETY: the processor has the features for which the function is compiled.
        return unsafe { with_avx2_and_fma(task) };
    }
    // Every 64-bit ARM processor has fused multiply-add.
    if cfg!(target_arch = "aarch64") { task.run::<Fused>() } else { task.run::<Separate>() }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn with_avx2_and_fma<T: Task>(task: T) -> T::Result {
    task.run::<Fused>()
}
