//! One step: what every method leaves of it.
use super::pair::{Outcome, Pair};
use super::{Dense, Method, System, dop853, dopri5, radau, rk4, rkn86};

/// One accepted step from t to t + h.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step<const N: usize> {
    /// Start of the step since the start of the span [s].
    pub t: f64,
    /// Step size [s].
    pub h: f64,
    /// Whether it ends at the end of the span.
    pub reached: bool,
    /// State at the start.
    pub start: [f64; N],
    /// State at the end.
    pub end: [f64; N],
    /// What the sums up to the start had lost to rounding.
    pub(super) carry: [f64; N],
    pub(super) stages: Stages<N>,
}

/// What the interpolant and a shorter step from the same start need, method by method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Stages<const N: usize> {
    Dop853(dop853::Slopes<N>),
    Dopri5(dopri5::Slopes<N>),
    Rk4(rk4::Slopes<N>),
    Rkn86(rkn86::Accelerations),
    Radau(radau::Stages<N>),
}

/// A step of which the error is not known yet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Trial<const N: usize> {
    pub step: Step<N>,
    /// What the sums up to the end have lost to rounding.
    pub carry: [f64; N],
    /// f at the end.
    pub last: [f64; N],
}

impl<const N: usize> Trial<N> {
    /// A step of an explicit pair of size h from (t, start), where the sums had lost `carry`.
    #[inline]
    pub fn explicit<P: Pair<N>>(
        t: f64,
        start: &[f64; N],
        h: f64,
        carry: &[f64; N],
        outcome: Outcome<P::Stages, N>,
    ) -> Self {
        let Outcome { stages, end, last, carry: lost } = outcome;
        let step = Step { t, h, reached: false, start: *start, end, carry: *carry, stages: P::stages(stages) };
        Self { step, carry: lost, last }
    }
}

impl<const N: usize> Step<N> {
    /// The method that made the step.
    pub fn method(&self) -> Method {
        match self.stages {
            Stages::Dop853(_) => Method::Dop853,
            Stages::Dopri5(_) => Method::Dopri5,
            Stages::Rk4(_) => Method::Rk4,
            Stages::Rkn86(_) => Method::Rkn86,
            Stages::Radau(_) => Method::Radau,
        }
    }

    /// Rates at the start and at the end, of an explicit step of a system of first order.
    pub fn rates(&self) -> Option<[&[f64; N]; 2]> {
        match &self.stages {
            Stages::Dop853(slopes) => Some([&slopes[0], &slopes[dop853::tableau::STAGES]]),
            Stages::Dopri5(slopes) => Some([&slopes[0], &slopes[dopri5::STAGES - 1]]),
            Stages::Rk4(slopes) => Some([&slopes.first, &slopes.last]),
            _ => None,
        }
    }

    /// How far component n can be, within the step, outside the range of its start and its end: a path whose rate is from
    /// f_1 to f_2 is at most h (f_2 - f_1) / 4 off the straight line between its ends. With some room, as the rates of the
    /// stages are not all there are; unknown, so infinite, where the interpolant costs nothing.
    pub fn bulge(&self, n: usize) -> f64 {
        const ROOM: f64 = 1.5;
        let range = |least: f64, most: f64| ROOM * 0.25 * self.h * (most - least);
        let of_all = |slopes: &[[f64; N]]| {
            let start = (f64::INFINITY, f64::NEG_INFINITY);
            let (least, most) = slopes.iter().fold(start, |(a, b), f| (a.min(f[n]), b.max(f[n])));
            range(least, most)
        };
        match &self.stages {
            Stages::Dop853(slopes) => of_all(slopes),
            Stages::Dopri5(slopes) => of_all(slopes),
            Stages::Rk4(slopes) => range(slopes.first[n].min(slopes.last[n]), slopes.first[n].max(slopes.last[n])),
            Stages::Rkn86(accelerations) if n == 0 => {
                let (mut least, mut most) = (accelerations[0], accelerations[0]);
                for &f in accelerations {
                    least = if f < least { f } else { least };
                    most = if f > most { f } else { most };
                }
                let room = 0.5 * (ROOM - 1.0) * (most - least);
                if (least - room >= 0.0 || most + room <= 0.0) && self.start[1] * self.end[1] >= 0.0 {
                    // The rate goes from its start straight to its end, without a change of sign: so does the path.
                    return 0.0;
                }
                // The rate itself changes by no more than h times the largest acceleration.
                range(0.0, self.h * most.max(-least))
            }
            _ => f64::INFINITY,
        }
    }

    /// Evaluations that [`Self::dense`] takes.
    pub fn dense_evaluations(&self) -> u64 {
        match self.stages {
            Stages::Dop853(_) => (dop853::tableau::EXTENDED - dop853::tableau::STAGES) as u64 - 1,
            _ => 0,
        }
    }

    /// Whether the interpolant errs no more than the tolerance of the step: those of the explicit pairs of first order do.
    pub fn interpolates(&self) -> bool {
        matches!(self.stages, Stages::Dop853(_) | Stages::Dopri5(_))
    }

    /// Interpolant over this step: of order 7 after DOP853, for three evaluations; of order 6 after the Nystroem pair; of
    /// order 4 after the pair of order 5; of order 3 after RK4 (Hermite's cubic) and after Radau (the collocation polynomial).
    pub fn dense<S: System<N>>(&self, system: &mut S) -> Dense<N> {
        match &self.stages {
            Stages::Dop853(slopes) => dop853::dense(self, slopes, system),
            Stages::Dopri5(slopes) => dopri5::dense(self, slopes),
            Stages::Rk4(slopes) => rk4::dense(self, slopes),
            Stages::Rkn86(accelerations) => rkn86::dense(self, accelerations),
            Stages::Radau(stages) => radau::dense(self, stages),
        }
    }
}

/// y + increment + carry, and what that sum loses to rounding: Knuth's two-sum.
pub(super) fn add_compensated<const N: usize>(
    y: &[f64; N],
    increment: &[f64; N],
    carry: &[f64; N],
) -> ([f64; N], [f64; N]) {
    let (mut end, mut lost) = ([0.0; N], [0.0; N]);
    for n in 0..N {
        let delta = increment[n] + carry[n];
        end[n] = y[n] + delta;
        let back = end[n] - y[n];
        lost[n] = (y[n] - (end[n] - back)) + (delta - back);
    }
    (end, lost)
}
