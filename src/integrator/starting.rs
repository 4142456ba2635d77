//! The first step size.
use super::linear::largest_eigenvalue;
use super::reach::reach;
use super::{Statistics, System, dop853};

/// Of the explicit pairs.
const ORDER: f64 = 8.0;

/// First step size: Hairer, Norsett, Wanner, Solving ODEs I (1993), II.4, with the error of an explicit Euler step as the
/// guide; for a system that can be stiff, one at which DOP853 is stable. The point is (t, y, f(t, y)).
// Asked for once in a while; what every step begins with is short without it.
#[inline(never)]
pub(super) fn starting_step<S: System<N>, const N: usize>(
    system: &mut S,
    (t, y, first): (f64, &[f64; N], &[f64; N]),
    scale: &[f64; N],
    rest: f64,
    tolerance: f64,
    statistics: &mut Statistics,
) -> f64 {
    let weight = scale.map(|s| 1.0 / s);
    let square = |v: &[f64; N]| (0..N).map(|i| (v[i] * weight[i]).powi(2)).sum::<f64>();
    let slope = square(first);
    let h0 = if slope > 0.0 { (0.01 / slope.sqrt()).min(rest) } else { rest };
    let ahead = std::array::from_fn(|i| y[i] + h0 * first[i]);
    let second = system.derivative(t + h0, &ahead);
    statistics.evaluations += 1;
    let bend = square(&std::array::from_fn(|i| second[i] - first[i])) * (1.0 / (h0 * h0));
    let largest = slope.max(bend);
    let share = 1.0 / (0.01 * tolerance).powi(2);
    let h1 = if largest > 0.0 { reach(largest * share, 2.0 * ORDER).min(rest) } else { rest };
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
