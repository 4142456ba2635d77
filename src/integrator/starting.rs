//! The first step size.
use super::linear::largest_eigenvalue;
use super::reach::reach;
use super::{Statistics, System, dop853};

/// Of the explicit pairs.
const ORDER: f64 = 8.0;

/// First step size: Hairer, Norsett, Wanner, Solving ODEs I (1993), II.4, with the error of an explicit Euler step as the
/// guide; for a system that can be stiff, one at which DOP853 is stable. The point is (t, y, f(t, y)).
pub(super) fn starting_step<S: System<N>, const N: usize>(
    system: &mut S,
    (t, y, first): (f64, &[f64; N], &[f64; N]),
    scale: &[f64; N],
    rest: f64,
    tolerance: f64,
    statistics: &mut Statistics,
) -> f64 {
    let size = |v: &[f64; N]| (0..N).map(|i| (v[i] / scale[i]).powi(2)).sum::<f64>().sqrt();
    let slope = size(first);
    let h0 = if slope > 0.0 { (0.01 / slope).min(rest) } else { rest };
    let ahead = std::array::from_fn(|i| y[i] + h0 * first[i]);
    let second = system.derivative(t + h0, &ahead);
    statistics.evaluations += 1;
    let bend = size(&std::array::from_fn(|i| second[i] - first[i])) / h0;
    let largest = slope.max(bend);
    let h1 = if largest > 0.0 { reach(largest / (0.01 * tolerance), ORDER).min(rest) } else { rest };
    let mut h = h1.min(100.0 * h0);
    if S::CAN_BE_STIFF {
        statistics.jacobians += 1;
        let lambda = largest_eigenvalue(&system.jacobian(t, y));
        if h * lambda > dop853::STABLE_TO {
            h = dop853::STABLE_TO / lambda;
        }
    }
    h
}
