//! What the present processor can do beyond the least of its family: fused multiply-add, four numbers at once.
//!
//! In: a task that is generic over its arithmetic. Out: its result, by the fastest code that this processor runs.
//! Results are the same bits on all processors with fused multiply-add, and differ by rounding from those of the
//! others. It must not know what is computed.
#![allow(unsafe_code)]

/// How a b + c is rounded.
pub trait Arithmetic {
    /// a b + c.
    fn multiply_add(a: f64, b: f64, c: f64) -> f64;
}

/// One rounding, for the sum.
pub struct Fused;

/// Two roundings: of the product, then of the sum.
pub struct Separate;

impl Arithmetic for Fused {
    #[inline(always)]
    fn multiply_add(a: f64, b: f64, c: f64) -> f64 {
        a.mul_add(b, c)
    }
}

impl Arithmetic for Separate {
    #[inline(always)]
    fn multiply_add(a: f64, b: f64, c: f64) -> f64 {
        a * b + c
    }
}

/// A task worth code of its own for each kind of processor. [`Task::run`] and what it calls are to be inlined: code
/// that is not is compiled for the least processor, and a fused operation there is a call of a library.
pub trait Task {
    /// Result of the task.
    type Result;

    /// Do it in this arithmetic.
    fn run<A: Arithmetic>(self) -> Self::Result;
}

/// Do a task by the fastest code that this processor runs.
#[inline(always)]
pub fn run<T: Task>(task: T) -> T::Result {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma") {
        // SAFETY: the processor has what the function is compiled for.
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
