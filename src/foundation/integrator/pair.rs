//! Interfaces of one step of any method: to the control of step sizes and to the search for events.
//!
//! In: a system, a start, a step size. Out: the end of the step, its error, its path. Must not know: any method.
use super::{Dense, Method, System};

/// Start of a step.
#[derive(Clone, Copy, Debug)]
pub struct Start<const N: usize> {
    /// Time since the start of the span [s].
    pub t: f64,
    /// State.
    pub y: [f64; N],
    /// f(t, y).
    pub first: [f64; N],
    /// Sum of the rounding errors of the sums so far (compensation).
    pub carry: [f64; N],
}

/// Attempt at a step, which is not yet accepted.
pub struct Outcome<K, const N: usize> {
    /// Stages of the method.
    pub stages: K,
    /// State at the end.
    pub end: [f64; N],
    /// f at the end, if the method has evaluated it.
    pub last: Option<[f64; N]>,
    /// Sum of the rounding errors of the sums up to the end (compensation).
    pub carry: [f64; N],
}

/// Stages of a step, which determine the path between its start and its end.
pub trait Path<const N: usize> {
    /// Method that made the step.
    const METHOD: Method;

    /// [`Self::METHOD`].
    fn method(&self) -> Method {
        Self::METHOD
    }

    /// Number of evaluations of [`Self::dense`].
    fn dense_evaluations(&self) -> u64 {
        0
    }

    /// Whether the error of the interpolant is within the tolerance of the step.
    fn interpolates(&self) -> bool {
        false
    }

    /// f at the start y of the step.
    fn first(&self, y: &[f64; N]) -> [f64; N];

    /// f at the start and at the end of an explicit step of a first-order system.
    fn rates(&self) -> Option<[&[f64; N]; 2]> {
        None
    }

    /// Largest distance of component n, within a step of size h, from the range between its values at start and end.
    /// Infinite if unknown, for methods whose interpolant needs no evaluation.
    fn bulge(&self, _n: usize, _h: f64, _ends: [&[f64; N]; 2]) -> f64 {
        f64::INFINITY
    }

    /// Interpolant over the step of size h from time t, between the states `ends`.
    fn dense<S: System<N>>(&self, system: &mut S, t: f64, h: f64, ends: [&[f64; N]; 2]) -> Dense<N>;
}

/// An explicit method with an error estimate, as the stages of one step. Its last f is the first stage of the next.
pub trait Pair<const N: usize>: Path<N> + Sized {
    /// Number of evaluations of a step.
    const EVALUATIONS: u64;
    /// The result of [`Self::error`] is proportional to this power of the step size.
    const ERROR_POWER: f64;

    /// The step of size h.
    fn attempt<S: System<N>>(system: &mut S, start: &Start<N>, h: f64) -> Outcome<Self, N>;

    /// A power of the ratio of the error estimate to the tolerance. The step is accepted up to 1. Components after the
    /// leading ones of `S` have no weight.
    fn error<S: System<N>>(&self, h: f64, scale: &[f64; N], tolerance: f64) -> f64;

    /// h |lambda| of the stiffest component in a step between the states `ends`. 0 for a pair that is not used for
    /// stiff systems.
    fn stiffness<S: System<N>>(&self, _h: f64, _ends: [&[f64; N]; 2], _scale: &[f64; N]) -> f64 {
        0.0
    }
}

/// Mean square of the components of an error over their scales. Only the first `leading` components have weight.
#[inline]
pub fn mean_square<const N: usize>(leading: usize, scale: &[f64; N], error: impl Fn(usize) -> f64) -> f64 {
    (0..leading).map(|n| (error(n) / scale[n]).powi(2)).sum::<f64>() / N as f64
}

/// State of a stage: y plus `increment` in the leading components of the system.
#[inline(always)]
pub fn stage<S: System<N>, const N: usize>(y: &[f64; N], increment: impl Fn(usize) -> f64) -> [f64; N] {
    let mut at = *y;
    for (n, at) in at.iter_mut().enumerate().take(S::LEADING) {
        *at += increment(n);
    }
    at
}

/// y + increment + carry, and the rounding error of that sum, by Knuth's two-sum.
#[inline]
pub fn add_compensated<const N: usize>(y: &[f64; N], increment: &[f64; N], carry: &[f64; N]) -> ([f64; N], [f64; N]) {
    let (mut end, mut lost) = ([0.0; N], [0.0; N]);
    for n in 0..N {
        let delta = increment[n] + carry[n];
        end[n] = y[n] + delta;
        let back = end[n] - y[n];
        lost[n] = (y[n] - (end[n] - back)) + (delta - back);
    }
    (end, lost)
}

/// Factor on [`bulge`], because the rates between the stages are not known.
pub const BULGE_MARGIN: f64 = 1.5;

/// [`Path::bulge`] from the smallest and the largest rate. A path with rates between f_1 and f_2 deviates by at most h
/// (f_2 - f_1) / 4 from the straight line between its ends.
#[inline]
pub fn bulge(h: f64, [least, most]: [f64; 2]) -> f64 {
    BULGE_MARGIN * 0.25 * h * (most - least)
}

/// The smallest and the largest of some numbers.
#[inline]
pub fn extremes(values: impl IntoIterator<Item = f64>) -> [f64; 2] {
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    for value in values {
        least = if value < least { value } else { least };
        most = if value > most { value } else { most };
    }
    [least, most]
}
