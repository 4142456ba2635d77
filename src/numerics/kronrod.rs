//! Quadrature with an estimate of its error.
//!
//! In: values of a function at seven nodes of an interval. Out: its integral by Kronrod's rule of degree 11, and that
//! by the rule of Gauss of degree 5 at three of the nodes. Source: Kronrod, Nodes and Weights of Quadrature Formulas
//! (1965). It must not know what the function means.

/// Nodes of the interval from 0 to 1, ascending.
pub const NODES: [f64; 7] = [
    0.5 - 0.480_245_634_354_010_2,
    0.5 - 0.387_298_334_620_741_7,
    0.5 - 0.217_121_874_673_401_28,
    0.5,
    0.5 + 0.217_121_874_673_401_28,
    0.5 + 0.387_298_334_620_741_7,
    0.5 + 0.480_245_634_354_010_2,
];

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

/// Weights of the rule of Gauss at every other node.
const GAUSS: [f64; 3] = [5.0 / 18.0, 4.0 / 9.0, 5.0 / 18.0];

/// Mean of a function over an interval, by both rules, from its values at the nodes; and the mean of its magnitude.
pub fn means(values: &[f64; 7]) -> [f64; 3] {
    let sum = |of: fn(f64) -> f64| KRONROD.iter().zip(values).map(|(w, v)| w * of(*v)).sum();
    let gauss = GAUSS.iter().zip(values.iter().skip(1).step_by(2)).map(|(w, v)| w * v).sum();
    [sum(|v| v), gauss, sum(f64::abs)]
}

/// Part of the mean magnitude by which Kronrod's rule may err, from the difference of both rules (QUADPACK's estimate).
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
    fn the_estimate_bounds_the_error_of_a_wave() {
        for omega in [1.0_f64, 2.0, 4.0, 8.0] {
            let all = means(&NODES.map(|u| (omega * u).sin()));
            let exact = (1.0 - omega.cos()) / omega;
            assert!((all[0] - exact).abs() <= relative_error(all, 0.0) * all[2], "{omega}");
        }
    }
}
