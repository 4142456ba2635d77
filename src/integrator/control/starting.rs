//! The first step size.
use super::inverse_root::inverse_root;
use super::memory::Begin;
use super::stiffness::largest_eigenvalue;
use crate::integrator::methods::dop853::STABLE_TO;
use crate::integrator::pair::Start;
use crate::integrator::{IntegrationError, Statistics, System};

/// Order of the explicit pairs.
const ORDER: f64 = 8.0;

/// First step size: Hairer, Norsett, Wanner, Solving ODEs I (1993), II.4, with the error of an explicit Euler step as
/// the guide; for a system that can be stiff, one at which DOP853 is stable.
///
/// # Errors
/// The rates are so large that the step vanishes.
// Called rarely: kept out of the path of every step.
#[inline(never)]
pub fn starting_step<S: System<N>, const N: usize>(
    system: &mut S,
    begin: &Begin<N>,
    tolerance: f64,
    statistics: &mut Statistics,
) -> Result<f64, IntegrationError> {
    let &Begin { start: Start { t, ref y, ref first, .. }, ref scale, rest, .. } = begin;
    let weight = scale.map(|s| 1.0 / s);
    let square = |v: &[f64; N]| (0..N).map(|i| (v[i] * weight[i]).powi(2)).sum::<f64>();
    let slope = square(first);
    let h0 = if slope > 0.0 { (0.01 / slope.sqrt()).min(rest) } else { rest };
    let ahead = std::array::from_fn(|i| y[i] + h0 * first[i]);
    let second = system.derivative(t + h0, &ahead);
    statistics.evaluations += 1;
    let curvature = square(&std::array::from_fn(|i| second[i] - first[i])) * (1.0 / (h0 * h0));
    let largest = slope.max(curvature);
    let share = 1.0 / (0.01 * tolerance).powi(2);
    let h1 = if largest > 0.0 { inverse_root(largest * share, 2.0 * ORDER).min(rest) } else { rest };
    let mut h = h1.min(100.0 * h0);
    if S::CAN_BE_STIFF {
        statistics.jacobians += 1;
        let lambda = largest_eigenvalue(&system.jacobian(t, y));
        if h * lambda > STABLE_TO {
            h = STABLE_TO / lambda;
        }
    }
    if h > 0.0 { Ok(h) } else { Err(IntegrationError::StepTooSmall { t, step: h }) }
}
