//! One step of the implicit Runge-Kutta method Radau IIA of order 5, L-stable, by collocation at three points.
//!
//! In: a system with its Jacobian, a point, a step size. Out: the step with its error estimate, or None if Newton's
//! method did not converge; the collocation polynomial.
//! Source: Hairer, Wanner, Solving ODEs II (1996), IV.5 (method), IV.8 (Newton's method, starting values, error).
pub mod coefficients;

use crate::codec::record::{Damaged, Record};
use crate::integrator::dense::TERMS;
use crate::integrator::kept::Kept;
use crate::integrator::pair::{BULGE_MARGIN, Outcome, Path, Start, add_compensated, mean_square};
use crate::integrator::{Dense, Method, Statistics, System};
use crate::numerics::gauss::Complex;
use coefficients::{ALPHA, BETA, C, E, GAMMA, STAGES, T, T_INVERSE};

/// Order of the error estimate plus 1. The estimate is proportional to this power of the step size.
pub const ERROR_POWER: f64 = 4.0;
/// Number of Newton iterations after which a smaller step is cheaper.
const ITERATIONS: u32 = 10;
/// Part of the tolerance at which Newton's method stops.
const NEWTON: f64 = 0.01;
/// Rate of convergence up to which a Jacobian is kept for the next step. A new Jacobian costs about as much as three
/// iterations.
const KEEP: f64 = 0.03;
/// Ratio of a correction to the goal of Newton's method, below which the rate of convergence need not be estimated.
const NEGLIGIBLE: f64 = 0.1;

/// Increments from the start to the three nodes.
type Increments<const N: usize> = [[f64; N]; STAGES];

/// Stages of a step, for its interpolant and for a shorter step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Radau<const N: usize> {
    /// Increments at the two inner nodes.
    inner: [[f64; N]; 2],
    /// f at the start.
    first: [f64; N],
    /// Tolerance of the step.
    tolerance: f64,
    /// Error of the collocation polynomial.
    error: [f64; N],
}

/// Newton's method of a step: the scales, the tolerance, and the previous step, from which it starts.
pub struct Newton<'a, const N: usize> {
    pub scale: &'a [f64; N],
    pub tolerance: f64,
    /// The previous step, if it was a Radau step.
    pub before: Option<&'a Collocation<N>>,
}

/// Collocation polynomial of a step, as its increments. Its extrapolation is the start of Newton's method in the next
/// step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collocation<const N: usize> {
    h: f64,
    z: Increments<N>,
}

impl<const N: usize> Collocation<N> {
    /// A polynomial for [`Self::record`] to fill.
    pub fn blank() -> Self {
        Self { h: 0.0, z: [[0.0; N]; STAGES] }
    }

    /// Writes or reads all fields.
    ///
    /// # Errors
    /// A field that was read has a value that no step can produce.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        record.positive("last implicit step", &mut self.h)?;
        self.z.iter_mut().try_for_each(|z| record.all_finite("increments", z))
    }

    /// Increments of a step of size h that starts at the part `from` of this step: 0 its start, 1 its end.
    fn guess(&self, from: f64, h: f64) -> Increments<N> {
        let terms = self.terms();
        let value = |s: f64, n: usize| s * (terms[0][n] + (1.0 - s) * (terms[1][n] + s * terms[2][n]));
        std::array::from_fn(|i| {
            let s = from + C[i] * h / self.h;
            std::array::from_fn(|n| value(s, n) - value(from, n))
        })
    }

    /// The cubic s (terms[0] + (1 - s) (terms[1] + s terms[2])) through the increments at the nodes.
    fn terms(&self) -> [[f64; N]; 3] {
        let (z, mut terms) = (&self.z, [[0.0; N]; 3]);
        for n in 0..N {
            let d = z[2][n];
            let q1 = (z[0][n] / C[0] - d) / (1.0 - C[0]);
            let q2 = (z[1][n] / C[1] - d) / (1.0 - C[1]);
            let g = (q2 - q1) / (C[1] - C[0]);
            (terms[0][n], terms[1][n], terms[2][n]) = (d, q1 - C[0] * g, g);
        }
        terms
    }
}

impl<const N: usize> Path<N> for Radau<N> {
    const METHOD: Method = Method::Radau;

    fn first(&self, _y: &[f64; N]) -> [f64; N] {
        self.first
    }

    /// From the Bernstein coefficients of the collocation polynomial, which are its bounds, and its error.
    fn bulge(&self, n: usize, h: f64, ends: [&[f64; N]; 2]) -> f64 {
        let [t0, t1, t2] = self.collocation(h, ends).terms().map(|term| term[n]);
        let inner = [(t0 + t1) / 3.0, (2.0 * t0 + t1 + t2) / 3.0];
        let beyond = inner.map(|b| (t0.min(0.0) - b).max(b - t0.max(0.0)));
        BULGE_MARGIN * (beyond[0].max(beyond[1]).max(0.0) + self.error[n])
    }

    /// The collocation polynomial, of order 3. Its deviation from the motion is the filtered defect at its start, as in
    /// the error estimate of the step.
    fn dense<S: System<N>>(&self, _system: &mut S, _t: f64, h: f64, ends: [&[f64; N]; 2]) -> Dense<N> {
        let mut terms = [[0.0; N]; TERMS];
        terms[..3].copy_from_slice(&self.collocation(h, ends).terms());
        Dense::new(*ends[0], *ends[1], terms, |n| self.error[n])
    }
}

impl<const N: usize> Radau<N> {
    /// Collocation polynomial of the step of size h between the states `ends`.
    pub fn collocation(&self, h: f64, [start, end]: [&[f64; N]; 2]) -> Collocation<N> {
        Collocation { h, z: [self.inner[0], self.inner[1], std::array::from_fn(|n| end[n] - start[n])] }
    }

    /// The step of size h with the ratio of its error to the tolerance. None if Newton's method does not converge with
    /// the Jacobian in `kept`. The Jacobian stays useful only if Newton's method converges fast enough.
    pub fn attempt<S: System<N>>(
        system: &mut S,
        start: &Start<N>,
        (newton, kept): (&Newton<N>, &mut Kept<N>),
        h: f64,
        statistics: &mut Statistics,
    ) -> Option<(Outcome<Self, N>, f64)> {
        let guess = newton.before.map_or([[0.0; N]; STAGES], |before| before.guess(1.0, h));
        let solved = kept.factored(h).and_then(|kept| {
            let found = collocate(system, start, (newton, kept), h, guess, ITERATIONS, statistics)?;
            Some((found, error(start, h, &found.0, kept)))
        });
        kept.is_useful = solved.as_ref().is_some_and(|((_, rate), _)| *rate <= KEEP);
        let ((z, _), e) = solved?;
        let norm = mean_square(N, &newton.scale.map(|scale| newton.tolerance * scale), |n| e[n]).sqrt();
        Some((Self::outcome(start, newton.tolerance, (&z, e)), norm))
    }

    /// The step of size h, shorter than the step of these stages and from the same start. `whole` is the collocation
    /// polynomial of the longer step. It has met the tolerance, so it is used if Newton's method does not converge.
    pub fn shorten<S: System<N>>(
        &self,
        system: &mut S,
        start: &Start<N>,
        whole: &Collocation<N>,
        h: f64,
        statistics: &mut Statistics,
    ) -> Outcome<Self, N> {
        let (scale, jacobian) = (system.scale(&start.y, &start.first), system.jacobian(start.t, &start.y));
        statistics.jacobians += 1;
        let newton = Newton { scale: &scale, tolerance: self.tolerance, before: None };
        let guess = whole.guess(0.0, h);
        let mut kept = Kept::default();
        kept.take(&jacobian, system.leading_components(), 0.0);
        let kept = kept.factored(h);
        let found = kept.and_then(|f| collocate(system, start, (&newton, f), h, guess, 3 * ITERATIONS, statistics));
        let z = found.map_or(guess, |(z, _)| z);
        Self::outcome(start, self.tolerance, (&z, self.error))
    }

    /// The step with the increments z and the error of their polynomial.
    fn outcome(start: &Start<N>, tolerance: f64, (z, error): (&Increments<N>, [f64; N])) -> Outcome<Self, N> {
        let (end, carry) = add_compensated(&start.y, &z[2], &start.carry);
        Outcome { stages: Self { inner: [z[0], z[1]], first: start.first, tolerance, error }, end, last: None, carry }
    }
}

/// `matrix` times z, block by block, in the leading components.
#[inline]
fn transformed<const N: usize>(matrix: &[[f64; STAGES]; STAGES], z: &Increments<N>, leading: usize) -> Increments<N> {
    let mut all = [[0.0; N]; STAGES];
    for (own, row) in all.iter_mut().zip(matrix) {
        for (n, own) in own[..leading].iter_mut().enumerate() {
            *own = row[0] * z[0][n] + row[1] * z[1][n] + row[2] * z[2][n];
        }
    }
    all
}

/// Solves the collocation equations z = h (A x I) F(y + z) by the simplified Newton method, transformed to one real and
/// one complex system; eqs. (8.4) to (8.13). Also returns the rate of convergence, or 0 if one correction was
/// sufficient.
///
/// Newton's method stops when the estimated remaining error is below `NEWTON` times the tolerance or at the rounding
/// error. It solves for the leading components. The other components follow from their rates.
fn collocate<S: System<N>, const N: usize>(
    system: &mut S,
    start: &Start<N>,
    (newton, kept): (&Newton<N>, &Kept<N>),
    h: f64,
    mut z: Increments<N>,
    iterations: u32,
    statistics: &mut Statistics,
) -> Option<(Increments<N>, f64)> {
    let leading = kept.leading;
    let mut stop = [0.0; N];
    for (n, stop) in stop[..leading].iter_mut().enumerate() {
        let rounding = 8.0 * f64::EPSILON * start.y[n].abs();
        *stop = (NEWTON * newton.tolerance * newton.scale[n]).max(rounding);
    }
    let mut w = transformed(&T_INVERSE, &z, leading);
    let (mut last, mut rate) = (f64::INFINITY, 0.0);
    for iteration in 0..iterations {
        let mut slopes = [[0.0; N]; STAGES];
        for (i, slopes) in slopes.iter_mut().enumerate() {
            let mut at = start.y;
            at[..leading].iter_mut().zip(&z[i]).for_each(|(at, z)| *at += z);
            *slopes = system.derivative(start.t + C[i] * h, &at);
        }
        statistics.evaluations += STAGES as u64;
        statistics.newton_iterations += 1;
        let g = transformed(&T_INVERSE, &slopes, N);
        let (mut first, mut pair) = ([0.0; N], [Complex { re: 0.0, im: 0.0 }; N]);
        for n in 0..leading {
            first[n] = g[0][n] - GAMMA / h * w[0][n];
            pair[n].re = g[1][n] - (ALPHA * w[1][n] - BETA * w[2][n]) / h;
            pair[n].im = g[2][n] - (BETA * w[1][n] + ALPHA * w[2][n]) / h;
        }
        kept.real.solve(&mut first);
        kept.complex.solve(&mut pair);
        let mut change = 0.0;
        for n in 0..leading {
            let delta = [first[n], pair[n].re, pair[n].im];
            for (w, delta) in w.iter_mut().zip(delta) {
                w[n] += delta;
                change += (delta / stop[n]).powi(2);
            }
        }
        let change = (change / (STAGES * N) as f64).sqrt();
        if !change.is_finite() {
            return None;
        }
        if iteration > 0 {
            rate = change / last;
        }
        let mut is_solved = change <= NEGLIGIBLE;
        if iteration > 0 && !is_solved {
            // The sum of the remaining changes is at most `rest`, now and after the last iteration.
            let rest = change * rate / (1.0 - rate);
            // Rounding errors can stop the iteration slightly above its goal. A larger change is divergence.
            is_solved = if rate >= 0.99 { change <= 0.1 / NEWTON } else { rest <= 1.0 };
            let is_hopeless = rest * rate.powi((iterations - 1 - iteration) as i32) > 1.0;
            if !is_solved && (rate >= 0.99 || is_hopeless) {
                return None;
            }
        }
        if is_solved {
            integrals(kept, h, &g, (&first, &pair), &mut w);
            return Some((transformed(&T, &w, N), rate));
        }
        z = transformed(&T, &w, leading);
        last = change;
    }
    None
}

/// The transformed increments of the components after the leading ones. They follow from the rates g at the last stages
/// and the last correction of the leading components. They equal the result of Newton's method for the whole system.
fn integrals<const N: usize>(
    kept: &Kept<N>,
    h: f64,
    g: &Increments<N>,
    (first, pair): (&[f64; N], &[Complex<f64>; N]),
    w: &mut Increments<N>,
) {
    let scale = h / (ALPHA * ALPHA + BETA * BETA);
    for (n, row) in kept.rows().enumerate().skip(kept.leading) {
        let mut rates = [g[0][n], g[1][n], g[2][n]];
        for (entry, (first, pair)) in row.iter().zip(first.iter().zip(pair)) {
            rates[0] += entry * first;
            rates[1] += entry * pair.re;
            rates[2] += entry * pair.im;
        }
        w[0][n] = h / GAMMA * rates[0];
        w[1][n] = scale * (ALPHA * rates[1] + BETA * rates[2]);
        w[2][n] = scale * (ALPHA * rates[2] - BETA * rates[1]);
    }
}

/// Error of the leading components: the embedded formula of order 3, damped as (gamma_0^-1 I / h - J)^-1, eq. (8.19).
/// RADAU5 damps a second time after a rejection, eq. (8.20). A second damping would reduce the estimate of the slow
/// error of a stiff component by the factor h |lambda|. It is not used here.
fn error<const N: usize>(start: &Start<N>, h: f64, z: &Increments<N>, kept: &Kept<N>) -> [f64; N] {
    let mut defect = [0.0; N];
    for (n, defect) in defect[..kept.leading].iter_mut().enumerate() {
        *defect = start.first[n] + (0..STAGES).map(|i| E[i] * z[i][n]).sum::<f64>() / h;
    }
    kept.real.solve(&mut defect);
    defect.map(f64::abs)
}
