//! Gauss's quadrature with any number of nodes.
//!
//! In: the number of nodes. Out: nodes, weights, values of Legendre's polynomials. Must not know: the integrand.
//! Source: Trefethen, Approximation Theory and Approximation Practice (2013), chapters 17 and 19.
use std::f64::consts::PI;

/// Number of Newton steps from the asymptotic nodes, more than enough for the rounding error.
const ITERATIONS: usize = 8;

/// P_n(x) for n = 0 .. count - 1, by the recurrence n P_n = (2n - 1) x P_(n-1) - (n - 1) P_(n-2).
pub fn polynomials(x: f64, count: usize) -> Vec<f64> {
    let mut values = vec![1.0, x];
    for n in 2..count {
        let order = n as f64;
        values.push(((2.0 * order - 1.0) * x * values[n - 1] - (order - 1.0) * values[n - 2]) / order);
    }
    values.truncate(count);
    values
}

/// Nodes of [-1, 1], ascending, each with its weight. The sum of the weights is 2.
pub fn rule(count: usize) -> Vec<[f64; 2]> {
    let n = count as f64;
    let node = |k: usize| {
        let mut x = -(PI * (k as f64 + 0.75) / (n + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..ITERATIONS {
            let values = polynomials(x, count + 1);
            slope = n * (x * values[count] - values[count - 1]) / (x * x - 1.0);
            x -= values[count] / slope;
        }
        [x, 2.0 / ((1.0 - x * x) * slope * slope)]
    };
    (0..count).map(node).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_are_integrated_up_to_the_degree_of_the_rule() {
        for count in [1, 2, 5, 16, 64] {
            let rule = rule(count);
            let integral = |power: usize| rule.iter().map(|[x, weight]| weight * x.powi(power as i32)).sum::<f64>();
            for power in 0..2 * count {
                let exact = if power % 2 == 0 { 2.0 / (power + 1) as f64 } else { 0.0 };
                assert!(
                    (integral(power) - exact).abs() < 1e-14,
                    "{count} nodes, {power}: {:e}",
                    integral(power) - exact
                );
            }
            assert!(count > 16 || (integral(2 * count) - 2.0 / (2 * count + 1) as f64).abs() > 1e-13);
        }
    }
}
