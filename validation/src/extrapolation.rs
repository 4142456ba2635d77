//! An integrator of high order, independent of the engine: extrapolation of the modified midpoint rule (Gragg,
//! Bulirsch, Stoer; Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, II.9).
//!
//! In: y' = f(t, y) and a span. Out: y at its end. Must not depend on the meaning of y.
use std::convert::Infallible;

/// Substeps of the midpoint rule in the columns of the extrapolation; n columns have the order 2 n.
const SUBSTEPS: [u32; 8] = [2, 4, 6, 8, 10, 12, 14, 16];

/// y at `t + h` by a method of order 12 in steps of at most `longest`.
pub fn integrate<const N: usize>(
    f: &mut impl FnMut(f64, &[f64; N]) -> [f64; N],
    t: f64,
    mut y: [f64; N],
    h: f64,
    longest: f64,
) -> [f64; N] {
    let count = (h / longest).ceil().max(1.0);
    let mut f = |t: f64, y: &[f64; N]| Ok::<_, Infallible>(f(t, y));
    for k in 0..count as u64 {
        let Ok((next, _)) = step(&mut f, t + h * k as f64 / count, &y, h / count, 6, |_, _| false);
        y = next;
    }
    y
}

/// y at `t + h` in one step, and whether the extrapolation converged: by the first three or more columns whose last two
/// values agree, otherwise by all `columns`.
pub fn step<const N: usize, E>(
    f: &mut impl FnMut(f64, &[f64; N]) -> Result<[f64; N], E>,
    t: f64,
    y: &[f64; N],
    h: f64,
    columns: usize,
    agree: impl Fn(&[f64; N], &[f64; N]) -> bool,
) -> Result<([f64; N], bool), E> {
    let slope = f(t, y)?;
    let mut last = [[0.0; N]; SUBSTEPS.len()];
    for (row, n) in SUBSTEPS.into_iter().enumerate().take(columns) {
        last[row] = midpoint(f, t, y, &slope, h, n)?;
        // Aitken-Neville scheme in (h/n)^2.
        for k in (0..row).rev() {
            let ratio = (f64::from(n) / f64::from(SUBSTEPS[k])).powi(2);
            let next = last[k + 1];
            for (old, next) in last[k].iter_mut().zip(next) {
                *old = next + (next - *old) / (ratio - 1.0);
            }
        }
        if row > 1 && agree(&last[0], &last[1]) {
            return Ok((last[0], true));
        }
    }
    Ok((last[0], false))
}

/// n substeps of the midpoint rule, the first by Euler's rule, without Gragg's smoothing as n is even.
fn midpoint<const N: usize, E>(
    f: &mut impl FnMut(f64, &[f64; N]) -> Result<[f64; N], E>,
    t: f64,
    y: &[f64; N],
    slope: &[f64; N],
    h: f64,
    n: u32,
) -> Result<[f64; N], E> {
    let d = h / f64::from(n);
    let (mut before, mut now) = (*y, std::array::from_fn(|i| y[i] + d * slope[i]));
    for k in 1..n {
        let slope = f(t + d * f64::from(k), &now)?;
        let next = std::array::from_fn(|i| before[i] + 2.0 * d * slope[i]);
        (before, now) = (now, next);
    }
    Ok(now)
}
