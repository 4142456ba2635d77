//! Chebyshev series of one fixed length: the building block of the traced curve and of every table.
//!
//! In: values at the Gauss nodes of [-1, 1]. Out: coefficients, values, antiderivatives, monomial coefficients.
//! Source: Trefethen, Approximation Theory and Approximation Practice (2013), chapters 2, 3 and 19.
use std::f64::consts::PI;

/// Number of nodes and of coefficients. Even, so that the middle of a panel is not a node.
pub const NODES: usize = 16;

/// Coefficients c_k of sum c_k T_k(x), k = 0 .. NODES - 1.
pub type Series = [f64; NODES];

/// Gauss nodes x_j = -cos(pi (j + 1/2) / NODES), ascending.
pub fn nodes() -> [f64; NODES] {
    std::array::from_fn(|j| -(PI * (j as f64 + 0.5) / NODES as f64).cos())
}

/// Transform from values at [`nodes`] to coefficients; the same for every fit, so built once.
#[derive(Clone, Debug)]
pub struct Transform {
    /// Nodes, ascending.
    pub nodes: [f64; NODES],
    /// T_k(x_j), row j.
    basis: [[f64; NODES]; NODES],
}

impl Transform {
    /// The transform for [`NODES`] nodes.
    pub fn new() -> Self {
        let nodes = nodes();
        let basis = std::array::from_fn(|j| {
            std::array::from_fn(|k| (PI * (k as f64) * ((NODES - 1 - j) as f64 + 0.5) / NODES as f64).cos())
        });
        Self { nodes, basis }
    }

    /// Coefficients of the polynomial through `values` at the nodes.
    pub fn fit(&self, values: &[f64; NODES]) -> Series {
        let mut out = [0.0; NODES];
        for (value, row) in values.iter().zip(&self.basis) {
            for (sum, t) in out.iter_mut().zip(row) {
                *sum += value * t;
            }
        }
        out.iter_mut().for_each(|c| *c *= 2.0 / NODES as f64);
        out[0] *= 0.5;
        out
    }
}

impl Default for Transform {
    fn default() -> Self {
        Self::new()
    }
}

/// Value at x in [-1, 1] by Clenshaw's recurrence; any number of coefficients.
pub fn value(series: &[f64], x: f64) -> f64 {
    let (mut b1, mut b2) = (0.0, 0.0);
    for &c in series[1..].iter().rev() {
        (b1, b2) = (c + 2.0 * x * b1 - b2, b1);
    }
    series[0] + x * b1 - b2
}

/// Values at x of an antiderivative and of its slope, side by side.
pub fn with_slope(antiderivative: &[f64; NODES + 1], slope: &Series, x: f64) -> (f64, f64) {
    let (mut b1, mut b2) = (antiderivative[NODES], 0.0);
    let (mut d1, mut d2) = (0.0, 0.0);
    for k in (1..NODES).rev() {
        (b1, b2) = (antiderivative[k] + 2.0 * x * b1 - b2, b1);
        (d1, d2) = (slope[k] + 2.0 * x * d1 - d2, d1);
    }
    (antiderivative[0] + x * b1 - b2, slope[0] + x * d1 - d2)
}

/// Antiderivative that vanishes at x = -1; one coefficient more than the series.
pub fn antiderivative(series: &Series) -> [f64; NODES + 1] {
    let c = |k: usize| if k < NODES { series[k] } else { 0.0 };
    let mut out = [0.0; NODES + 1];
    out[1] = c(0) - c(2) / 2.0;
    for (k, slot) in out.iter_mut().enumerate().skip(2) {
        *slot = (c(k - 1) - c(k + 1)) / (2.0 * k as f64);
    }
    out[0] = out.iter().enumerate().skip(1).map(|(k, a)| if k % 2 == 1 { *a } else { -*a }).sum();
    out
}

/// Derivative.
pub fn derivative(series: &Series) -> Series {
    let mut out = [0.0; NODES];
    for k in (1..NODES).rev() {
        out[k - 1] = if k + 1 < NODES { out[k + 1] } else { 0.0 } + 2.0 * k as f64 * series[k];
    }
    out[0] *= 0.5;
    out
}

/// Monomial coefficients of the Chebyshev polynomials: T_k = 2 x T_(k-1) - T_(k-2), coefficient by coefficient.
const MONOMIALS: [[f64; NODES]; NODES] = {
    let mut rows = [[0.0; NODES]; NODES];
    rows[0][0] = 1.0;
    rows[1][1] = 1.0;
    let mut k = 2;
    while k < NODES {
        let mut i = 0;
        while i < NODES {
            rows[k][i] = if i > 0 { 2.0 * rows[k - 1][i - 1] } else { 0.0 } - rows[k - 2][i];
            i += 1;
        }
        k += 1;
    }
    rows
};

/// Coefficients of 1, x, x^2, ... Accurate where the series decays faster than (1 + sqrt 2)^-k, as a resolved panel does.
pub fn monomials(series: &Series) -> Series {
    let mut out = [0.0; NODES];
    for (c, row) in series.iter().zip(&MONOMIALS) {
        for (sum, m) in out.iter_mut().zip(row) {
            *sum += c * m;
        }
    }
    out
}

/// Size of what a longer series would add: the largest of the last three coefficients.
pub fn tail(series: &Series) -> f64 {
    series[NODES - 3..].iter().fold(0.0, |a: f64, c| a.max(c.abs()))
}

/// The series without its last coefficients that are all of the size of its tail: there they are rounding, which
/// derivatives would amplify.
pub fn chopped(series: &Series) -> Series {
    const PLATEAU: f64 = 4.0;
    let level = PLATEAU * tail(series);
    let kept = series.iter().rposition(|c| c.abs() > level).map_or(1, |k| k + 1);
    std::array::from_fn(|k| if k < kept { series[k] } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fitted(f: impl Fn(f64) -> f64) -> Series {
        let t = Transform::new();
        t.fit(&t.nodes.map(f))
    }

    #[test]
    fn reproduces_an_entire_function() {
        let c = fitted(|x| (0.7 * x).exp());
        let m = monomials(&c);
        for i in 0..=40 {
            let x = -1.0 + f64::from(i) / 20.0;
            assert!((value(&c, x) - (0.7 * x).exp()).abs() < 1e-14);
            let horner = m.iter().rev().fold(0.0, |a, k| a * x + k);
            assert!((horner - (0.7 * x).exp()).abs() < 1e-14);
        }
        assert!(tail(&c) < 1e-13);
    }

    #[test]
    fn antiderivative_of_a_cosine_is_a_sine() {
        let a = antiderivative(&fitted(f64::cos));
        for i in 0..=20 {
            let x = -1.0 + f64::from(i) / 10.0;
            assert!((value(&a, x) - (x.sin() - (-1.0f64).sin())).abs() < 1e-14);
        }
    }

    #[test]
    fn derivative_of_a_sine_is_a_cosine() {
        // T_k has the slope k^2 at the ends, by which it amplifies the rounding of its coefficient: twice a mean of values.
        let allowed = (0..NODES).map(|k| (k * k) as f64).sum::<f64>() * 2.0 * f64::EPSILON;
        let d = derivative(&fitted(f64::sin));
        for i in 0..=20 {
            let x = -1.0 + f64::from(i) / 10.0;
            assert!((value(&d, x) - x.cos()).abs() < allowed);
        }
    }

    #[test]
    fn chopping_takes_the_rounding_off_a_straight_line() {
        let noisy: Series =
            std::array::from_fn(|k| [2.0, 1.0].get(k).copied().unwrap_or(1e-14 * (1.0 + k as f64).sin()));
        let line = chopped(&noisy);
        assert_eq!(line[..2], [2.0, 1.0]);
        assert!(line[2..].iter().all(|c| *c == 0.0));
    }

    #[test]
    fn tail_is_large_where_the_function_is_not_resolved() {
        assert!(tail(&fitted(f64::abs)) > 1e-3);
    }
}
