//! Numerical methods of the tests, independent of those of the engine.

use nalgebra::{SMatrix, SVector};

/// A state after a time by the classical Runge-Kutta method with this number of steps. The rate is a function of time
/// and state.
pub fn runge_kutta<const N: usize>(
    rate: impl Fn(f64, [f64; N]) -> [f64; N],
    start: [f64; N],
    span: f64,
    steps: u32,
) -> [f64; N] {
    let (mut y, h) = (start, span / f64::from(steps));
    for step in 0..steps {
        let t = h * f64::from(step);
        let add = |k: [f64; N], part: f64| std::array::from_fn(|i| y[i] + part * h * k[i]);
        let k1 = rate(t, y);
        let k2 = rate(t + 0.5 * h, add(k1, 0.5));
        let k3 = rate(t + 0.5 * h, add(k2, 0.5));
        let k4 = rate(t + h, add(k3, 1.0));
        y = std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
    }
    y
}

/// exp(A) y by Taylor's series in shares of A whose terms fall like 1 / (2^k k!).
pub fn exponential<const N: usize>(a: SMatrix<f64, N, N>, y: SVector<f64, N>) -> SVector<f64, N> {
    let shares = (2.0 * a.norm()).ceil().max(1.0);
    (0..shares as u32).fold(y, |y, _| {
        let (mut sum, mut term) = (y, y);
        for k in 1..=15 {
            term = a * term / (shares * f64::from(k));
            sum += term;
        }
        sum
    })
}

/// The integral of a function by Simpson's rule on this even number of panels.
pub fn simpson(f: impl Fn(f64) -> f64, from: f64, to: f64, panels: u32) -> f64 {
    let h = (to - from) / f64::from(panels);
    let inner = (1..panels).map(|k| f64::from(2 + 2 * (k % 2)) * f(from + h * f64::from(k)));
    h / 3.0 * (f(from) + inner.sum::<f64>() + f(to))
}

/// Pseudo-random numbers from 0 to 1: a linear congruential generator.
pub fn pseudo_random(mut seed: u64) -> impl FnMut() -> f64 {
    move || {
        seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (seed >> 11) as f64 / (1u64 << 53) as f64
    }
}
