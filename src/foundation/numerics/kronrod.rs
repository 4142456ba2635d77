//! Quadrature with an estimate of its error.
//!
//! In: values of a function at seven nodes of an interval. Out: its integral by Kronrod's rule of degree 11, and by
//! Gauss's rule of degree 5 at three of the nodes. Source: Kronrod, Nodes and Weights of Quadrature Formulas (1965).
//! Must not know: what the function means.

/// Distances of the nodes from the middle of the interval from 0 to 1.
const A: f64 = 0.217_121_874_673_401_28;
const B: f64 = 0.387_298_334_620_741_7;
const C: f64 = 0.480_245_634_354_010_2;

/// Nodes of the interval from 0 to 1, ascending.
pub const NODES: [f64; 7] = [0.5 - C, 0.5 - B, 0.5 - A, 0.5, 0.5 + A, 0.5 + B, 0.5 + C];

/// Weights of Kronrod's rule; their sum is 1.
const KRONROD: [f64; 7] = [
    0.052_328_113_013_233_63,
    0.134_244_044_934_166_7,
    0.200_698_707_387_981_1,
    0.225_458_269_329_237_07,
    0.200_698_707_387_981_1,
    0.134_244_044_934_166_7,
    0.052_328_113_013_233_63,
];

/// Weights of Gauss's rule at every other node.
const GAUSS: [f64; 3] = [5.0 / 18.0, 4.0 / 9.0, 5.0 / 18.0];

/// Means of a function over an interval by Kronrod's and Gauss's rule, and the mean of its magnitude.
pub fn means(values: &[f64; 7]) -> [f64; 3] {
    let sum = |of: fn(f64) -> f64| KRONROD.iter().zip(values).map(|(w, v)| w * of(*v)).sum();
    let gauss = GAUSS.iter().zip(values.iter().skip(1).step_by(2)).map(|(w, v)| w * v).sum();
    [sum(|v| v), gauss, sum(f64::abs)]
}

/// Coefficients of the polynomial of degree 6 with these values at the nodes, in ascending powers of x = 2 u - 1. Its
/// integral over the interval is that of Kronrod's rule.
pub fn interpolant(values: &[f64; 7]) -> [f64; 7] {
    let x = [2.0 * A, 2.0 * B, 2.0 * C];
    let [a, b, c] = x.map(|x| x * x);
    let pair = |k: usize| [values[3 - k], values[3 + k]];
    let even = |k: usize| 0.5 * (pair(k)[1] + pair(k)[0]);
    let odd = |k: usize| 0.5 * (pair(k)[1] - pair(k)[0]) / x[k - 1];
    let even = newton([0.0, a, b, c], [values[3], even(1), even(2), even(3)]);
    let odd = newton([a, b, c], [odd(1), odd(2), odd(3)]);
    [even[0], odd[0], even[1], odd[1], even[2], odd[2], even[3]]
}

/// Coefficients of the polynomial through values f at z, in ascending powers of z, by Newton's divided differences.
fn newton<const N: usize>(z: [f64; N], mut f: [f64; N]) -> [f64; N] {
    for k in 1..N {
        for i in (k..N).rev() {
            f[i] = (f[i] - f[i - 1]) / (z[i] - z[i - k]);
        }
    }
    for k in (0..N - 1).rev() {
        for i in k..N - 1 {
            f[i] -= z[k] * f[i + 1];
        }
    }
    f
}

/// Error estimate of Kronrod's rule (QUADPACK), relative to the larger of the mean magnitude and `size`.
pub fn relative_error([kronrod, gauss, magnitude]: [f64; 3], size: f64) -> f64 {
    let size = magnitude.max(size);
    if size == 0.0 { 0.0 } else { (200.0 * (kronrod - gauss).abs() / size).powf(1.5) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_are_integrated_up_to_the_degree_of_each_rule() {
        for power in 0..=12 {
            let exact = 1.0 / f64::from(power + 1);
            let [kronrod, gauss, _] = means(&NODES.map(|u| u.powi(power)));
            assert_eq!((kronrod - exact).abs() < 2e-16, power <= 11, "{power}: {:e}", kronrod - exact);
            assert_eq!((gauss - exact).abs() < 2e-16, power <= 5, "{power}: {:e}", gauss - exact);
        }
    }

    #[test]
    fn the_interpolant_is_a_polynomial_of_degree_6_and_has_the_integral_of_the_rule() {
        let polynomial = [0.3, -1.0, 2.0, 0.7, -0.2, 1.1, -3.0];
        let found = interpolant(&NODES.map(|u| polynomial.iter().rev().fold(0.0, |sum, c| sum * (2.0 * u - 1.0) + c)));
        for (found, exact) in found.iter().zip(polynomial) {
            assert!((found - exact).abs() < 1e-13, "{found} {exact}");
        }
        let values = NODES.map(|u| (3.0 * u).exp());
        let mean: f64 = interpolant(&values).iter().zip(1..).step_by(2).map(|(c, n)| c / f64::from(n)).sum();
        assert!((mean - means(&values)[0]).abs() < 1e-13);
    }

    #[test]
    fn the_estimate_bounds_the_error_of_a_wave() {
        for omega in [1.0_f64, 2.0, 4.0, 8.0] {
            let all = means(&NODES.map(|u| (omega * u).sin()));
            let exact = (1.0 - omega.cos()) / omega;
            assert!((all[0] - exact).abs() <= relative_error(all, 0.0) * all[2], "{omega}");
        }
    }
}
