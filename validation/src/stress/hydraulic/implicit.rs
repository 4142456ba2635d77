//! A stiff integrator, independent of the engine: extrapolation of the linearly implicit Euler rule (Deuflhard 1985;
//! Hairer, Wanner, Solving Ordinary Differential Equations II, IV.9).
//!
//! In: y' = f(t, y), a span, a tolerance. Out: y at its end. Must not depend on the meaning of y.

use crate::linear::Factors;

/// Number of columns of the extrapolation, with 1, 2, 3 and more substeps; equals the order.
const COLUMNS: usize = 7;
/// Greatest number of steps of one call.
const MOST: usize = 2_000_000;

/// y at `t + span`, each step to `tolerance` relative to `scale(y)`. Components from `driving` on do not occur in f.
pub fn integrate<const N: usize>(
    f: &mut impl FnMut(f64, &[f64; N]) -> [f64; N],
    scale: &impl Fn(&[f64; N]) -> [f64; N],
    driving: usize,
    start: f64,
    mut y: [f64; N],
    span: f64,
    tolerance: f64,
) -> Result<[f64; N], String> {
    let (mut t, mut h) = (0.0, 1e-3 * span);
    for _ in 0..MOST {
        let last = t + h * (1.0 + 1e-9) >= span;
        let d = if last { span - t } else { h };
        let weights = scale(&y);
        let jacobian = jacobian(f, driving, start + t, &y, &weights);
        let (next, before) = step(f, &Start { t: start + t, y: &y, jacobian: &jacobian, driving }, d);
        let error = (0..driving).map(|i| ((next[i] - before[i]) / (weights[i] * tolerance)).abs());
        let error = error.fold(0.0, |worst: f64, e| if e.is_finite() { worst.max(e) } else { f64::INFINITY });
        if error <= 1.0 {
            (t, y) = (t + d, next);
            if last {
                return Ok(y);
            }
        }
        let factor = 0.8 * error.max(1e-12).powf(-1.0 / COLUMNS as f64);
        h = d * if factor.is_finite() { factor.clamp(0.1, 4.0) } else { 0.1 };
    }
    Err(format!("the second integration stands at {t} s of {span} s"))
}

fn jacobian<const N: usize>(
    f: &mut impl FnMut(f64, &[f64; N]) -> [f64; N],
    driving: usize,
    t: f64,
    y: &[f64; N],
    weights: &[f64; N],
) -> [[f64; N]; N] {
    let mut columns = [[0.0; N]; N];
    for j in 0..driving {
        let d = 1e-6 * weights[j];
        let [mut above, mut below] = [*y, *y];
        (above[j], below[j]) = (y[j] + d, y[j] - d);
        let (above, below) = (f(t, &above), f(t, &below));
        (0..N).for_each(|i| columns[i][j] = (above[i] - below[i]) / (2.0 * d));
    }
    columns
}

/// The state at the start of a step.
struct Start<'a, const N: usize> {
    t: f64,
    y: &'a [f64; N],
    jacobian: &'a [[f64; N]; N],
    driving: usize,
}

/// One step: the last two values on the diagonal of the extrapolation.
fn step<const N: usize>(
    f: &mut impl FnMut(f64, &[f64; N]) -> [f64; N],
    start: &Start<'_, N>,
    h: f64,
) -> ([f64; N], [f64; N]) {
    let mut columns = [[0.0; N]; COLUMNS];
    let mut before = *start.y;
    for row in 0..COLUMNS {
        let n = row + 1;
        columns[row] = euler(f, start, h, n);
        for k in (0..row).rev() {
            let ratio = n as f64 / (k + 1) as f64;
            let next = columns[k + 1];
            for (old, next) in columns[k].iter_mut().zip(next) {
                *old = next + (next - *old) / (ratio - 1.0);
            }
        }
        if row + 2 == COLUMNS {
            before = columns[0];
        }
    }
    (columns[0], before)
}

/// n substeps: (1 - d J) (y_(i+1) - y_i) = d f(t_(i+1), y_i).
fn euler<const N: usize>(
    f: &mut impl FnMut(f64, &[f64; N]) -> [f64; N],
    &Start { t, y, jacobian, driving }: &Start<'_, N>,
    h: f64,
    n: usize,
) -> [f64; N] {
    let d = h / n as f64;
    let matrix: [[f64; N]; N] =
        std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j)) - d * jacobian[i][j]));
    let factors = Factors::of(matrix, driving);
    let mut y = *y;
    for k in 1..=n {
        let slope = f(t + d * k as f64, &y);
        let change = factors.solve(&slope.map(|slope| d * slope));
        let mut rest = change;
        // The other components follow from the driving ones.
        for i in driving..N {
            rest[i] = d * slope[i] + (0..driving).map(|j| d * jacobian[i][j] * change[j]).sum::<f64>();
        }
        (0..N).for_each(|i| y[i] += rest[i]);
    }
    y
}

#[cfg(test)]
mod tests {
    use super::*;

    /// y' = -1e6 (y - cos t) - sin t has y = cos t; z' = y is a quadrature.
    #[test]
    fn a_stiff_equation_has_its_exact_solution() {
        let mut f = |t: f64, y: &[f64; 2]| [-1e6 * (y[0] - t.cos()) - t.sin(), y[0]];
        let y = integrate(&mut f, &|_| [1.0; 2], 1, 0.0, [1.0, 0.0], 2.0, 1e-11).unwrap();
        assert!((y[0] - 2f64.cos()).abs() < 1e-10 && (y[1] - 2f64.sin()).abs() < 1e-9, "{y:?}");
    }

    /// A damped oscillator that is not stiff, in closed form.
    #[test]
    fn an_oscillator_has_its_exact_solution() {
        let mut f = |_: f64, y: &[f64; 2]| [y[1], -101.0 * y[0] - 2.0 * y[1]];
        let y = integrate(&mut f, &|_| [1.0, 10.0], 2, 0.0, [1.0, -1.0], 1.0, 1e-11).unwrap();
        assert!((y[0] - (-1f64).exp() * 10f64.cos()).abs() < 1e-9, "{y:?}");
    }
}
