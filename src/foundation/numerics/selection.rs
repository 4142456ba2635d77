//! Quadrature for a family of functions with few nodes.
//!
//! In: some functions of a family, each by its values at the nodes of a fine rule. Out: nodes with weights for the
//! integral of any function of the family, and weights that check whether a function belongs to the family. Must not
//! know: what the functions mean.
//! Source: Barrault, Maday, Nguyen, Patera, An empirical interpolation method (2004), equations (3) to (8).

/// Largest interpolation error of a function with the selected nodes, relative to its mean.
const TOLERANCE: f64 = 1e-13;
/// Largest number of selected nodes.
const MOST: usize = 40;
/// Number of nodes at which the interpolant is checked.
pub const CHECKS: usize = 2;

/// A node of the fine rule, with its weight in the integral and in the errors of the interpolant at [`CHECKS`] nodes.
pub type Selected = (usize, f64, [f64; CHECKS]);

/// Nodes for the integrals of a family. `functions`: values at the nodes of a rule with these weights; each function
/// has the mean 1. Nodes with weight 0, which only check the interpolant, are the last. None if the family needs more
/// than [`MOST`] nodes.
pub fn select(mut functions: Vec<Vec<f64>>, weights: &[f64]) -> Option<Vec<Selected>> {
    // Each basis function is 1 at its node and 0 at the nodes before.
    let (mut nodes, mut basis): (Vec<usize>, Vec<Vec<f64>>) = (Vec::new(), Vec::new());
    loop {
        let all = functions.iter().flat_map(|function| function.iter().enumerate().map(move |found| (function, found)));
        let (function, (node, value)) = all.max_by(|a, b| a.1.1.abs().total_cmp(&b.1.1.abs()))?;
        if value.abs() <= TOLERANCE {
            break;
        }
        if nodes.len() == MOST {
            return None;
        }
        let own: Vec<f64> = function.iter().map(|other| other / value).collect();
        for function in &mut functions {
            let size = function[node];
            function.iter_mut().zip(&own).for_each(|(value, own)| *value -= size * own);
            function[node] = 0.0;
        }
        nodes.push(node);
        basis.push(own);
    }
    // Weights at the selected nodes for a linear form, from its values for the basis functions.
    let weights_of = |values: &dyn Fn(&[f64]) -> f64| {
        let mut own = vec![0.0; nodes.len()];
        for k in (0..nodes.len()).rev() {
            let after: f64 = (k + 1..nodes.len()).map(|i| basis[k][nodes[i]] * own[i]).sum();
            own[k] = values(&basis[k]) - after;
        }
        own
    };
    let integral = weights_of(&|function| function.iter().zip(weights).map(|(value, weight)| value * weight).sum());
    let mut selected: Vec<Selected> =
        nodes.iter().zip(integral).map(|(node, weight)| (*node, weight, [0.0; CHECKS])).collect();
    for check in 0..CHECKS {
        // The node farthest from all selected nodes.
        let distance = |node: usize| selected.iter().map(|(other, ..)| node.abs_diff(*other)).min();
        let node = (0..weights.len()).max_by_key(|node| distance(*node))?;
        for (own, weight) in selected.iter_mut().zip(weights_of(&|function| function[node])) {
            own.2[check] = -weight;
        }
        let mut own = [0.0; CHECKS];
        own[check] = 1.0;
        selected.push((node, 0.0, own));
    }
    Some(selected)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::legendre;

    /// exp(-a x) on [-1, 1] has the integral 2 sinh(a) / a.
    #[test]
    fn few_nodes_give_the_integrals_of_exponentials_and_detect_other_functions() {
        let rule = legendre::rule(100);
        let weights: Vec<f64> = rule.iter().map(|[_, weight]| 0.5 * weight).collect();
        let exponential = |a: f64| move |x: f64| (-a * x).exp() * a / a.sinh();
        let sample = |function: &dyn Fn(f64) -> f64| rule.iter().map(|[x, _]| function(*x)).collect::<Vec<_>>();
        let family = (1..=40).map(|k| sample(&exponential(0.1 * f64::from(k)))).collect();
        let selected = select(family, &weights).unwrap();
        assert!(selected.len() < 20, "{}", selected.len());
        let sum = |function: &dyn Fn(f64) -> f64, of: &dyn Fn(&Selected) -> f64| {
            selected.iter().map(|own| of(own) * function(rule[own.0][0])).sum::<f64>()
        };
        let error = |function: &dyn Fn(f64) -> f64| {
            (0..CHECKS).map(|k| sum(function, &|own| own.2[k]).abs()).fold(0.0, f64::max)
        };
        for a in [0.13, 1.234, 3.999] {
            let mean = sum(&exponential(a), &|own| own.1);
            assert!((mean - 1.0).abs() < 1e-12, "{a}: {:e}", mean - 1.0);
            assert!(error(&exponential(a)) < 1e-12, "{a}: {:e}", error(&exponential(a)));
        }
        assert!(error(&|x: f64| (x - 0.3).abs()) > 1e-4);
        assert!(error(&exponential(12.0)) > 1e-11);
    }

    #[test]
    fn functions_that_are_proportional_need_one_node() {
        let weights = [0.25; 4];
        let selected = select(vec![vec![0.5, 1.5, 0.8, 1.2]; 3], &weights).unwrap();
        assert_eq!(selected.len(), 1 + CHECKS);
        assert_eq!((selected[0].0, selected[0].1), (1, 1.0 / 1.5));
    }
}
