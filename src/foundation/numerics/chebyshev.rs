//! Chebyshev series of one fixed length.
//!
//! In: values at the Gauss nodes of [-1, 1]. Out: Chebyshev coefficients, monomial coefficients, values. Must not know:
//! what the functions mean.
//! Source: Trefethen, Approximation Theory and Approximation Practice (2013), chapters 2, 3 and 19.
use super::processor::{self, Arithmetic, Task};
use std::f64::consts::PI;

/// Number of nodes and of coefficients. Even, so that the middle of a panel is not a node.
pub const NODES: usize = 16;

/// Coefficients c_k of sum c_k T_k(x), k = 0 .. NODES - 1.
pub type Series = [f64; NODES];

/// Transform from values at the nodes to Chebyshev coefficients.
#[derive(Clone, Debug)]
pub struct Transform {
    /// Gauss nodes x_j = -cos(pi (j + 1/2) / NODES), ascending.
    pub nodes: [f64; NODES],
    /// T_k(x_j) in row j, for the nodes below 0. The others follow from T_k(-x) = (-1)^k T_k(x).
    basis: [[f64; NODES]; NODES / 2],
}

impl Default for Transform {
    fn default() -> Self {
        // T_k(x_j) = (-1)^k cos(pi k (j + 1/2) / NODES); angles are reduced modulo 2 pi before rounding.
        let basis = std::array::from_fn(|j| {
            std::array::from_fn(|k| {
                let angle = (k * (2 * j + 1 + 2 * NODES)) % (4 * NODES);
                (PI * angle as f64 / (2 * NODES) as f64).cos()
            })
        });
        Self { nodes: std::array::from_fn(|j| -(PI * (j as f64 + 0.5) / NODES as f64).cos()), basis }
    }
}

impl Transform {
    /// Coefficients of the polynomial through `values` at the nodes.
    pub fn fit(&self, values: &[f64; NODES]) -> Series {
        let mut out = [0.0; NODES];
        for (j, row) in self.basis.iter().enumerate() {
            let (value, mirrored) = (values[j], values[NODES - 1 - j]);
            let (even, odd) = (value + mirrored, value - mirrored);
            for (sums, t) in out.chunks_exact_mut(2).zip(row.chunks_exact(2)) {
                sums[0] += even * t[0];
                sums[1] += odd * t[1];
            }
        }
        out.iter_mut().for_each(|c| *c *= 2.0 / NODES as f64);
        out[0] *= 0.5;
        out
    }
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

/// [`MONOMIALS`] by pairs of an even and an odd k: T_k contains only powers with the parity of k.
const PAIRS: [[f64; NODES]; NODES / 2] = {
    let mut rows = [[0.0; NODES]; NODES / 2];
    let mut i = 0;
    while i < NODES * NODES / 2 {
        let (pair, power) = (i / NODES, i % NODES);
        rows[pair][power] = MONOMIALS[2 * pair + power % 2][power];
        i += 1;
    }
    rows
};

/// Coefficients of 1, x, x^2, ... Accurate if the series decays faster than (1 + sqrt 2)^-k, as on a resolved panel.
pub fn monomials(series: &Series) -> Series {
    let mut out = [0.0; NODES];
    for (c, row) in series.chunks_exact(2).zip(&PAIRS) {
        for (sums, m) in out.chunks_exact_mut(2).zip(row.chunks_exact(2)) {
            sums[0] += c[0] * m[0];
            sums[1] += c[1] * m[1];
        }
    }
    out
}

/// Value of a polynomial with monomial coefficients, by Estrin's scheme for even and odd powers, which are loaded in
/// pairs.
#[inline]
pub fn polynomial(c: &Series, x: f64) -> f64 {
    let y = x * x;
    let (y2, y4) = (y * y, (y * y) * (y * y));
    let pair = |k: usize| [c[k] + c[k + 2] * y, c[k + 1] + c[k + 3] * y];
    let four = |k: usize| {
        let (low, high) = (pair(k), pair(k + 4));
        [low[0] + high[0] * y2, low[1] + high[1] * y2]
    };
    let (low, high) = (four(0), four(8));
    (low[0] + high[0] * y4) + x * (low[1] + high[1] * y4)
}

/// Values of polynomials with monomial coefficients at one x, by the fastest code for this processor: results on
/// different processors differ by rounding errors.
#[inline(always)]
pub fn polynomials<const K: usize>(series: &[Series; K], x: f64) -> [f64; K] {
    processor::run(Evaluation { series, x })
}

/// Polynomials to evaluate.
struct Evaluation<'a, const K: usize> {
    series: &'a [Series; K],
    x: f64,
}

impl<const K: usize> Task for Evaluation<'_, K> {
    type Result = [f64; K];

    #[inline(always)]
    fn run<A: Arithmetic>(self) -> Self::Result {
        std::array::from_fn(|k| by_residues::<A>(&self.series[k], self.x))
    }
}

/// Value of the first polynomial as [`polynomial`] computes it, and values of the others as [`polynomials`] does.
#[inline(always)]
pub fn polynomial_and_others<A: Arithmetic, const K: usize>(series: &[Series; K], x: f64) -> [f64; K] {
    let mut values = [0.0; K];
    for (k, (value, series)) in values.iter_mut().zip(series).enumerate() {
        *value = if k == 0 { polynomial(series, x) } else { by_residues::<A>(series, x) };
    }
    values
}

/// Value at x: four independent Horner schemes in x^4, one for each residue of the power modulo 4.
#[inline(always)]
fn by_residues<A: Arithmetic>(c: &Series, x: f64) -> f64 {
    let (x2, (fours, _)) = (x * x, c.as_chunks::<4>());
    let mut sums = fours[NODES / 4 - 1];
    for four in fours[..NODES / 4 - 1].iter().rev() {
        sums = std::array::from_fn(|k| A::multiply_add(sums[k], x2 * x2, four[k]));
    }
    let [even, odd] = std::array::from_fn(|k| A::multiply_add(sums[k + 2], x2, sums[k]));
    A::multiply_add(odd, x, even)
}

/// Values of a polynomial with monomial coefficients and of its derivative, by Horner's scheme for even and odd powers
/// side by side: c(x) = e(x^2) + x o(x^2), c'(x) = o(x^2) + 2 x (e'(x^2) + x o'(x^2)).
#[inline]
pub fn polynomial_and_slope(c: &Series, x: f64) -> [f64; 2] {
    let y = x * x;
    let (mut values, mut slopes) = ([c[NODES - 2], c[NODES - 1]], [0.0; 2]);
    for pair in c[..NODES - 2].rchunks_exact(2) {
        for k in 0..2 {
            slopes[k] = slopes[k] * y + values[k];
            values[k] = values[k] * y + pair[k];
        }
    }
    [values[0] + x * values[1], values[1] + 2.0 * x * (slopes[0] + x * slopes[1])]
}

/// Monomial coefficients of the derivative.
#[inline]
pub fn slopes_of(c: &Series) -> Series {
    let mut slopes = [0.0; NODES];
    for k in 1..NODES {
        slopes[k - 1] = k as f64 * c[k];
    }
    slopes
}

/// Monomial coefficients of c(middle + half x), by Horner's scheme with polynomials as values.
pub fn composed(c: &Series, middle: f64, half: f64) -> Series {
    let mut out = [0.0; NODES];
    for c in c.iter().rev() {
        for k in (0..NODES).rev() {
            out[k] = middle * out[k] + if k > 0 { half * out[k - 1] } else { *c };
        }
    }
    out
}

/// Estimate of the truncation error: the largest of the last three coefficients.
pub fn tail(series: &Series) -> f64 {
    series[NODES - 3..].iter().fold(0.0, |a: f64, c| a.max(c.abs()))
}

/// The series without its last coefficients of the size of the tail. These are rounding errors, which differentiation
/// would amplify.
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
        let t = Transform::default();
        t.fit(&t.nodes.map(f))
    }

    #[test]
    fn value_and_slope_are_those_of_the_polynomial_and_its_derivative() {
        let m = monomials(&fitted(|x| (1.3 * x).exp()));
        for x in [-1.0, -0.6, -1e-3, 0.0, 0.2, 0.7, 1.0] {
            let [value, slope] = polynomial_and_slope(&m, x);
            assert!((value - polynomial(&m, x)).abs() < 1e-14, "{x}");
            assert!((slope - polynomial(&slopes_of(&m), x)).abs() < 1e-13, "{x}");
        }
    }

    #[test]
    fn the_fastest_code_differs_by_rounding() {
        let series = [0.9, 1.3].map(|factor| monomials(&fitted(|x| (factor * x).exp())));
        for x in [-1.0, -0.6, -1e-3, 0.0, 0.2, 0.7, 1.0] {
            let values = polynomials(&series, x);
            assert!((0..2).all(|k| (values[k] - polynomial(&series[k], x)).abs() < 1e-14), "{x}");
        }
    }

    #[test]
    fn reproduces_an_entire_function() {
        let c = fitted(|x| (0.7 * x).exp());
        let m = monomials(&c);
        for i in 0..=40 {
            let x = -1.0 + f64::from(i) / 20.0;
            let chebyshev: f64 = c.iter().enumerate().map(|(k, c)| c * (k as f64 * x.acos()).cos()).sum();
            assert!((chebyshev - (0.7 * x).exp()).abs() < 1e-14);
            assert!((polynomial(&m, x) - (0.7 * x).exp()).abs() < 1e-14);
        }
        assert!(tail(&c) < 1e-13);
    }

    #[test]
    fn derivative_of_a_sine_is_a_cosine() {
        // T_k has the slope k^2 at the ends, which amplifies the rounding error of its coefficient: twice a mean of
        // values.
        let allowed = (0..NODES).map(|k| (k * k) as f64).sum::<f64>() * 2.0 * f64::EPSILON;
        let d = slopes_of(&monomials(&fitted(f64::sin)));
        for i in 0..=20 {
            let x = -1.0 + f64::from(i) / 10.0;
            assert!((polynomial(&d, x) - x.cos()).abs() < allowed);
        }
    }

    #[test]
    fn a_composed_series_is_the_function_on_a_part() {
        let whole = monomials(&fitted(|x| (0.7 * x).exp()));
        let part = composed(&whole, 0.3, 0.6);
        for i in 0..=10 {
            let x = -1.0 + f64::from(i) / 5.0;
            assert!((polynomial(&part, x) - (0.7 * (0.3 + 0.6 * x)).exp()).abs() < 1e-14);
        }
    }

    #[test]
    fn chopping_removes_rounding_errors_from_a_straight_line() {
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
