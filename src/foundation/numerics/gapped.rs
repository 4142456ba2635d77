//! Polynomials through values outside a gap in the middle of an interval.
//!
//! In: values at nodes of [-1, 1] outside a gap around 0. Out: monomial coefficients on [-1, 1]. Must not know: what
//! the functions mean.
//!
//! With y = x^2, an analytic function is f(x) = even(y) + x odd(y). Both parts are interpolated at the Gauss nodes of
//! [GAP^2, 1], which contains the squares of the nodes +-sqrt(y), and extrapolated to y = 0. At y = 0 the value of T_7,
//! which is at most 1 on the nodes, is 2.2.
use super::chebyshev::{NODES, Series};
use std::f64::consts::PI;

/// Half the width of the gap.
pub const GAP: f64 = 0.1;
/// Number of coefficients of the even and of the odd part.
const HALF: usize = NODES / 2;
/// Middle and half length of the interval of y.
const MIDDLE: f64 = 0.5 * (1.0 + GAP * GAP);
const RADIUS: f64 = 0.5 * (1.0 - GAP * GAP);

/// Interpolation through nodes outside the gap.
#[derive(Clone, Debug)]
pub struct Gapped {
    /// Nodes +-sqrt(y_k), ascending; y_k = MIDDLE + RADIUS t_k at the Gauss nodes t_k.
    pub nodes: [f64; NODES],
    /// T_m(t_k) in row k.
    basis: [[f64; HALF]; HALF],
}

impl Default for Gapped {
    fn default() -> Self {
        let angle = |k: usize| PI * (k as f64 + 0.5) / HALF as f64;
        let root = |k: usize| (MIDDLE + RADIUS * angle(k).cos()).sqrt();
        Self {
            nodes: std::array::from_fn(|j| if j < HALF { -root(j) } else { root(NODES - 1 - j) }),
            basis: std::array::from_fn(|k| std::array::from_fn(|m| (m as f64 * angle(k)).cos())),
        }
    }
}

impl Gapped {
    /// Monomial coefficients in x of the function with these values at the nodes, and the tail. The tail is the largest
    /// of the last two Chebyshev coefficients of the even and the odd part. It is a truncation or rounding error.
    /// Coefficients of that size are omitted, because extrapolation and differentiation would amplify them.
    pub fn fit(&self, values: &[f64; NODES]) -> (Series, f64) {
        let pair = |k: usize| (values[NODES - 1 - k], values[k]);
        let even = self.part(|k| 0.5 * (pair(k).0 + pair(k).1));
        let odd = self.part(|k| 0.5 * (pair(k).0 - pair(k).1) / self.nodes[NODES - 1 - k]);
        let tail = [&even, &odd].iter().flat_map(|c| &c[HALF - 2..]).fold(0.0, |a: f64, c| a.max(c.abs()));
        let [even, odd] = [even, odd].map(|c| monomials(c, 2.0 * tail));
        (std::array::from_fn(|k| if k % 2 == 0 { even[k / 2] } else { odd[k / 2] }), tail)
    }

    /// Chebyshev coefficients in t of the part with these values at y_k.
    fn part(&self, value: impl Fn(usize) -> f64) -> [f64; HALF] {
        let mut out = [0.0; HALF];
        for (k, row) in self.basis.iter().enumerate() {
            let value = value(k) * 2.0 / HALF as f64;
            out.iter_mut().zip(row).for_each(|(c, t)| *c += value * t);
        }
        out[0] *= 0.5;
        out
    }
}

/// Monomial coefficients in y of a Chebyshev series in t = (y - MIDDLE) / RADIUS, by Clenshaw's recurrence with
/// polynomials as values. The last coefficients that do not exceed `level` are omitted.
fn monomials(series: [f64; HALF], level: f64) -> [f64; HALF] {
    let kept = series.iter().rposition(|c| c.abs() > level).map_or(1, |k| k + 1);
    let (mut next, mut after) = ([0.0; HALF], [0.0; HALF]);
    for m in (0..kept).rev() {
        // c_m + 2 t next - after; for m = 0: c_0 + t next - after.
        let factor = if m == 0 { 1.0 } else { 2.0 } / RADIUS;
        let mut sum: [f64; HALF] = std::array::from_fn(|i| {
            let shifted = if i > 0 { next[i - 1] } else { 0.0 };
            factor * (shifted - MIDDLE * next[i]) - after[i]
        });
        sum[0] += series[m];
        (after, next) = (next, sum);
    }
    next
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::chebyshev::polynomial;

    #[test]
    fn an_entire_function_is_continued_into_the_gap() {
        let gapped = Gapped::default();
        assert!(gapped.nodes.windows(2).all(|n| n[0] < n[1]) && gapped.nodes.iter().all(|x| x.abs() > GAP));
        let f = |x: f64| (0.35 * x).exp() * (1.0 + 0.5 * x).cos();
        let (series, tail) = gapped.fit(&gapped.nodes.map(f));
        assert!(tail < 1e-14, "{tail:e}");
        for i in 0..=40 {
            let x = -1.0 + f64::from(i) / 20.0;
            assert!((polynomial(&series, x) - f(x)).abs() < 2e-14, "{x} {:e}", polynomial(&series, x) - f(x));
        }
    }

    #[test]
    fn rounding_of_a_straight_line_is_left_out() {
        let gapped = Gapped::default();
        let mut k = 0.0;
        let values = gapped.nodes.map(|x| {
            k += 1.0;
            2.0 - 3.0 * x + 1e-12 * f64::sin(37.0 * k)
        });
        let (series, tail) = gapped.fit(&values);
        assert!(tail > 1e-14 && tail < 1e-11);
        for x in [-1.0, -0.2, 0.0, 0.1, 1.0] {
            assert!((polynomial(&series, x) - (2.0 - 3.0 * x)).abs() < 1e-11);
        }
    }

    #[test]
    fn a_pole_in_the_gap_shows_in_the_tail() {
        let gapped = Gapped::default();
        assert!(gapped.fit(&gapped.nodes.map(|x| 1e-6 / x)).1 > 1e-9);
    }
}
