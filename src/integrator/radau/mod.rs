//! One step of the implicit Runge-Kutta method Radau IIA of order 5, L-stable, by collocation at three points.
//!
//! In: a system with its Jacobian, a point, a step size. Out: the step with its error estimate, or that Newton's method did
//! not converge; the collocation polynomial.
//! Source: Hairer, Wanner, Solving ODEs II (1996), IV.5 (method), IV.8 (Newton's method, starting values, error).
pub(super) mod coefficients;

use super::linear::{Complex, Factors};
use super::step::{self, Step, Trial, add_compensated};
use super::{Dense, Statistics, System};
use crate::codec::record::{Damaged, Record};
use coefficients::{ALPHA, BETA, C, E, GAMMA, STAGES, T, T_INVERSE};

/// Order of the error estimate plus 1: it falls as this power of the step size.
pub(super) const ERROR_POWER: f64 = 4.0;
/// Iterations after which a smaller step converges sooner.
pub(super) const ITERATIONS: u32 = 10;
/// Newton's method stops at this part of the tolerance.
const NEWTON: f64 = 0.01;

/// A change this small against its goal needs no second one to tell how fast they fall.
const NEGLIGIBLE: f64 = 0.1;

/// Increments over the start at the three nodes.
type Increments<const N: usize> = [[f64; N]; STAGES];

/// What a step leaves for its interpolant and for a shorter step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stages<const N: usize> {
    /// Increments at the two inner nodes.
    inner: [[f64; N]; 2],
    /// f at the start.
    pub first: [f64; N],
    /// Tolerance that the step was made for.
    pub tolerance: f64,
}

/// Where a step starts.
pub(super) struct Start<'a, const N: usize> {
    pub t: f64,
    pub y: &'a [f64; N],
    /// f(t, y).
    pub first: &'a [f64; N],
    /// df/dy.
    pub jacobian: &'a [[f64; N]; N],
    /// What the sums so far have lost to rounding.
    pub carry: &'a [f64; N],
    /// The step before.
    pub before: Option<&'a Before<N>>,
    pub scale: &'a [f64; N],
    pub tolerance: f64,
}

/// Collocation polynomial of a step, told by its increments; its continuation starts Newton's method of the next step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Before<const N: usize> {
    h: f64,
    z: Increments<N>,
}

impl<const N: usize> Before<N> {
    pub fn new(step: &Step<N>, stages: &Stages<N>) -> Self {
        let whole = std::array::from_fn(|n| step.end[n] - step.start[n]);
        Self { h: step.h, z: [stages.inner[0], stages.inner[1], whole] }
    }

    /// To be read into.
    pub fn blank() -> Self {
        Self { h: 0.0, z: [[0.0; N]; STAGES] }
    }

    /// All fields, written or read.
    ///
    /// # Errors
    /// A field is read that no step leaves.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        record.positive("last implicit step", &mut self.h)?;
        self.z.iter_mut().try_for_each(|z| record.all_finite("increments", z))
    }

    /// Increments of a step of size h from the part `from` of this one, 0 its start, 1 its end.
    fn guess(&self, from: f64, h: f64) -> Increments<N> {
        let terms = nested(&self.z);
        let value = |s: f64, n: usize| s * (terms[0][n] + (1.0 - s) * (terms[1][n] + s * terms[2][n]));
        std::array::from_fn(|i| {
            let s = from + C[i] * h / self.h;
            std::array::from_fn(|n| value(s, n) - value(from, n))
        })
    }
}

/// The cubic s (d + (1 - s) (e + s g)) through the increments at the nodes.
fn nested<const N: usize>(z: &Increments<N>) -> [[f64; N]; 3] {
    let mut terms = [[0.0; N]; 3];
    for n in 0..N {
        let d = z[2][n];
        let q1 = (z[0][n] / C[0] - d) / (1.0 - C[0]);
        let q2 = (z[1][n] / C[1] - d) / (1.0 - C[1]);
        let g = (q2 - q1) / (C[1] - C[0]);
        (terms[0][n], terms[1][n], terms[2][n]) = (d, q1 - C[0] * g, g);
    }
    terms
}

/// The collocation polynomial.
pub(super) fn dense<const N: usize>(step: &Step<N>, stages: &Stages<N>) -> Dense<N> {
    let mut terms = [[0.0; N]; super::dense::TERMS];
    terms[..3].copy_from_slice(&nested(&Before::new(step, stages).z));
    Dense::new(step.start, step.end, terms)
}

/// The step of size h with its error over the tolerance; none if Newton's method does not converge.
pub(super) fn attempt<S: System<N>, const N: usize>(
    system: &mut S,
    start: &Start<N>,
    h: f64,
    statistics: &mut Statistics,
) -> Option<(Trial<N>, f64)> {
    let guess = start.before.map_or([[0.0; N]; STAGES], |before| before.guess(1.0, h));
    let (z, real) = collocate(system, start, h, guess, ITERATIONS, statistics)?;
    let trial = trial(system, start, h, &z, statistics);
    Some((trial, error(start, h, &z, &real)))
}

/// The step of size h, shorter than `step` and from the same start. Where Newton's method does not converge, the
/// collocation polynomial of `step` is taken: it has met the tolerance.
pub(super) fn shorten<S: System<N>, const N: usize>(
    system: &mut S,
    step: &Step<N>,
    stages: &Stages<N>,
    h: f64,
    statistics: &mut Statistics,
) -> Trial<N> {
    let scale = system.scale(&step.start, &stages.first);
    let jacobian = system.jacobian(step.t, &step.start);
    statistics.jacobians += 1;
    let start = Start {
        t: step.t,
        y: &step.start,
        first: &stages.first,
        jacobian: &jacobian,
        carry: &step.carry,
        before: None,
        scale: &scale,
        tolerance: stages.tolerance,
    };
    let guess = Before::new(step, stages).guess(0.0, h);
    let z = collocate(system, &start, h, guess, 3 * ITERATIONS, statistics).map_or(guess, |(z, _)| z);
    trial(system, &start, h, &z, statistics)
}

/// The step with these increments.
fn trial<S: System<N>, const N: usize>(
    system: &mut S,
    start: &Start<N>,
    h: f64,
    z: &Increments<N>,
    statistics: &mut Statistics,
) -> Trial<N> {
    let (end, carry) = add_compensated(start.y, &z[2], start.carry);
    let last = system.derivative(start.t + h, &end);
    statistics.evaluations += 1;
    let stages = Stages { inner: [z[0], z[1]], first: *start.first, tolerance: start.tolerance };
    let stages = step::Stages::Radau(stages);
    let step = Step { t: start.t, h, reached: false, start: *start.y, end, carry: *start.carry, stages };
    Trial { step, carry, last }
}

/// (factor I - h J) / h.
fn shifted<const N: usize>(jacobian: &[[f64; N]; N], factor: f64, h: f64) -> [[f64; N]; N] {
    std::array::from_fn(|i| std::array::from_fn(|j| if i == j { factor / h } else { 0.0 } - jacobian[i][j]))
}

/// matrix times z, block by block.
fn transformed<const N: usize>(matrix: &[[f64; STAGES]; STAGES], z: &Increments<N>) -> Increments<N> {
    std::array::from_fn(|i| std::array::from_fn(|n| (0..STAGES).map(|j| matrix[i][j] * z[j][n]).sum()))
}

/// Solve the collocation equations z = h (A x I) F(y + z) by the simplified Newton method, transformed to one real and one
/// complex system; eqs. (8.4) to (8.13). Also the factors of the real one.
///
/// It stops when the estimated remaining error is below `NEWTON` of the tolerance or at rounding.
fn collocate<S: System<N>, const N: usize>(
    system: &mut S,
    start: &Start<N>,
    h: f64,
    mut z: Increments<N>,
    iterations: u32,
    statistics: &mut Statistics,
) -> Option<(Increments<N>, Factors<f64, N>)> {
    let real = Factors::new(shifted(start.jacobian, GAMMA, h))?;
    let diagonal = shifted(start.jacobian, ALPHA, h);
    let complex: Factors<Complex, N> = Factors::new(std::array::from_fn(|i| {
        std::array::from_fn(|j| Complex { re: diagonal[i][j], im: if i == j { BETA / h } else { 0.0 } })
    }))?;
    let stop: [f64; N] = std::array::from_fn(|n| {
        let rounding = 8.0 * f64::EPSILON * start.y[n].abs();
        (NEWTON * start.tolerance * start.scale[n]).max(rounding)
    });
    let mut w = transformed(&T_INVERSE, &z);
    let mut last = f64::INFINITY;
    for iteration in 0..iterations {
        let mut slopes = [[0.0; N]; STAGES];
        for i in 0..STAGES {
            let at = std::array::from_fn(|n| start.y[n] + z[i][n]);
            slopes[i] = system.derivative(start.t + C[i] * h, &at);
        }
        statistics.evaluations += STAGES as u64;
        statistics.newton_iterations += 1;
        let g = transformed(&T_INVERSE, &slopes);
        let first: [f64; N] = real.solve(std::array::from_fn(|n| g[0][n] - GAMMA / h * w[0][n]));
        let pair: [Complex; N] = complex.solve(std::array::from_fn(|n| Complex {
            re: g[1][n] - (ALPHA * w[1][n] - BETA * w[2][n]) / h,
            im: g[2][n] - (BETA * w[1][n] + ALPHA * w[2][n]) / h,
        }));
        let mut change = 0.0;
        for n in 0..N {
            let delta = [first[n], pair[n].re, pair[n].im];
            for (w, delta) in w.iter_mut().zip(delta) {
                w[n] += delta;
                change += (delta / stop[n]).powi(2);
            }
        }
        z = transformed(&T, &w);
        let change = (change / (STAGES * N) as f64).sqrt();
        if !change.is_finite() {
            return None;
        }
        if change <= NEGLIGIBLE {
            return Some((z, real));
        }
        if iteration > 0 {
            let rate = change / last;
            if rate >= 0.99 {
                // Rounding stops it a little above its goal; anything more is divergence.
                return (change <= 0.1 / NEWTON).then_some((z, real));
            }
            // The changes left sum to at most this, for all of them and for those after the last iteration.
            let rest = change * rate / (1.0 - rate);
            if rest <= 1.0 {
                return Some((z, real));
            }
            if rest * rate.powi((iterations - 1 - iteration) as i32) > 1.0 {
                return None;
            }
        }
        last = change;
    }
    None
}

/// Error over the tolerance: the embedded formula of order 3, damped as (gamma_0^-1 I / h - J)^-1, eq. (8.19). RADAU5
/// damps a second time after a rejection, eq. (8.20); here the estimate must hold for the slow error of a stiff component
/// too, which that makes h |lambda| times smaller than it is.
fn error<const N: usize>(start: &Start<N>, h: f64, z: &Increments<N>, real: &Factors<f64, N>) -> f64 {
    let norm = |e: &[f64; N]| {
        let sum: f64 = (0..N).map(|n| (e[n] / (start.tolerance * start.scale[n])).powi(2)).sum();
        (sum / N as f64).sqrt()
    };
    let defect: [f64; N] =
        std::array::from_fn(|n| start.first[n] + (0..STAGES).map(|i| E[i] * z[i][n]).sum::<f64>() / h);
    norm(&real.solve(defect))
}
