//! One step of the classical Runge-Kutta method of order 4, for spans that are short against the motion.
//!
//! With f at the end of the step, which the next one starts with, as a fifth stage: four evaluations a step. Giving the
//! weight of the fourth stage to the fifth makes an embedded method of order 3. Coefficients: Hairer, Norsett, Wanner, Solving
//! ODEs I (1993), II.1, table 1.2; the pair's order conditions, II.1, theorem 2.1 and eq. (1.11), are tested.
use super::dense::TERMS;
use super::step::{Step, add_compensated};
use super::{Dense, System};

/// Evaluations of a step.
pub(super) const EVALUATIONS: u64 = 4;
/// Nodes c_i; a stage takes the one before it alone, a_{i,i-1} = c_i, the fifth takes `B`.
pub(super) const C: [f64; 5] = [0.0, 0.5, 0.5, 1.0, 1.0];
/// Weights b_i of the step.
pub(super) const B: [f64; 4] = [1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0];
/// What the embedded method gives less to the fourth stage and more to the fifth.
pub(super) const E: f64 = B[3];
/// Part of the tolerance that the estimate may use: at the largest such step the error of the harmonic oscillator grows as that
/// of long steps of DOP853, at 0.035 of the tolerance a radian.
const MARGIN: f64 = 0.04;

/// f at the start and at the end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Slopes<const N: usize> {
    pub first: [f64; N],
    pub last: [f64; N],
}

/// What a step gives.
pub(super) struct Outcome<const N: usize> {
    pub end: [f64; N],
    /// What the sums up to the end have lost to rounding.
    pub carry: [f64; N],
    /// f at the end.
    pub last: [f64; N],
    /// The fourth stage.
    fourth: [f64; N],
}

/// The step of size h from (t, y), where f(t, y) = `first` and the sums so far have lost `carry`.
#[inline]
pub(super) fn attempt<S: System<N>, const N: usize>(
    system: &mut S,
    t: f64,
    y: &[f64; N],
    first: &[f64; N],
    h: f64,
    carry: &[f64; N],
) -> Outcome<N> {
    let mut stage = |c: f64, before: &[f64; N]| {
        let at = std::array::from_fn(|n| y[n] + c * h * before[n]);
        system.derivative(t + c * h, &at)
    };
    let second = stage(C[1], first);
    let third = stage(C[2], &second);
    let fourth = stage(C[3], &third);
    let increment =
        std::array::from_fn(|n| h * (B[0] * first[n] + B[1] * second[n] + B[2] * third[n] + B[3] * fourth[n]));
    let (end, carry) = add_compensated(y, &increment, carry);
    let last = system.derivative(t + h, &end);
    Outcome { end, carry, last, fourth }
}

/// Whether a step of this size is good; if not, the size up to which it would be.
///
/// The estimate e, relative to the scales, is the local error of order 3: it falls as h^4, so the motion changes within
/// T = h / e^(1/4), and the step, of order 4, errs by about e h / T. The tolerance is meant for a step of about the length T;
/// of many short ones each has its share, tolerance h / T, so that the sum of their errors is that of a few long steps
/// however short they are. So e <= tolerance.
#[inline]
pub(super) fn judge<const N: usize>(h: f64, outcome: &Outcome<N>, scale: &[f64; N], tolerance: f64) -> Result<(), f64> {
    let sum: f64 = (0..N).map(|n| (E * h * (outcome.fourth[n] - outcome.last[n]) / scale[n]).powi(2)).sum();
    let square = sum / N as f64;
    let allowed = (MARGIN * tolerance).powi(2);
    if square <= allowed {
        return Ok(());
    }
    // h (allowed / e)^(1/4), the squares being compared.
    let reach = h * (allowed / square).sqrt().sqrt().sqrt();
    Err(if reach.is_finite() { reach } else { 0.1 * h })
}

/// Interpolant of order 3: Hermite's cubic, II.6, eq. (6.7).
pub(super) fn dense<const N: usize>(step: &Step<N>, slopes: &Slopes<N>) -> Dense<N> {
    let delta: [f64; N] = std::array::from_fn(|n| step.end[n] - step.start[n]);
    let mut terms = [[0.0; N]; TERMS];
    terms[0] = delta;
    terms[1] = std::array::from_fn(|n| step.h * slopes.first[n] - delta[n]);
    terms[2] = std::array::from_fn(|n| 2.0 * delta[n] - step.h * (slopes.last[n] + slopes.first[n]));
    Dense::new(step.start, step.end, terms)
}
