//! One step of the classical Runge-Kutta method of order 4, for spans that are short compared with the motion.
//!
//! A fifth stage is f at the end of the step, which is the first stage of the next step: four evaluations a step. The
//! embedded method of order 3 gives the weight of the fourth stage to the fifth. Coefficients: Hairer, Norsett, Wanner,
//! Solving ODEs I (1993), II.1, table 1.2. The order conditions of the pair, II.1, theorem 2.1 and eq. (1.11), are
//! tested.
use crate::integrator::dense::{TERMS, hermite};
use crate::integrator::pair::{Outcome, Pair, Path, Start, add_compensated, bulge, extremes, mean_square, stage};
use crate::integrator::{Dense, Method, System};

/// Nodes c_i. A stage depends only on the previous stage, a_{i,i-1} = c_i; the fifth stage uses `B`.
pub const C: [f64; 5] = [0.0, 0.5, 0.5, 1.0, 1.0];
/// Weights b_i of the step.
pub const B: [f64; 4] = [1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0];
/// Weight that the embedded method moves from the fourth to the fifth stage.
pub const E: f64 = B[3];
/// Part of the tolerance that the estimate may use. With the largest such step, the error of the harmonic oscillator
/// grows like that of long steps of DOP853, by 0.035 of the tolerance per radian.
const MARGIN: f64 = 0.04;

/// f at the start, at the fourth stage and at the end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rk4<const N: usize> {
    first: [f64; N],
    fourth: [f64; N],
    last: [f64; N],
}

impl<const N: usize> Path<N> for Rk4<N> {
    const METHOD: Method = Method::Rk4;

    fn first(&self, _y: &[f64; N]) -> [f64; N] {
        self.first
    }

    fn rates(&self) -> Option<[&[f64; N]; 2]> {
        Some([&self.first, &self.last])
    }

    #[inline]
    fn bulge(&self, n: usize, h: f64, _ends: [&[f64; N]; 2]) -> f64 {
        bulge(h, extremes([self.first[n], self.last[n]]))
    }

    /// Of order 3: Hermite's cubic.
    fn dense<S: System<N>>(&self, _system: &mut S, _t: f64, h: f64, ends: [&[f64; N]; 2]) -> Dense<N> {
        let mut terms = [[0.0; N]; TERMS];
        for n in 0..N {
            [terms[0][n], terms[1][n], terms[2][n]] = hermite(h, ends.map(|y| y[n]), [self.first[n], self.last[n]]);
        }
        Dense::new(*ends[0], *ends[1], terms, |n| self.difference(n, h))
    }
}

impl<const N: usize> Pair<N> for Rk4<N> {
    const EVALUATIONS: u64 = 4;
    const ERROR_POWER: f64 = 8.0;

    #[inline(always)]
    fn attempt<S: System<N>>(system: &mut S, start: &Start<N>, h: f64) -> Outcome<Self, N> {
        let &Start { t, ref y, ref first, ref carry } = start;
        let mut rates = |c: f64, before: &[f64; N]| {
            let at = stage::<S, N>(y, |n| c * h * before[n]);
            system.derivative(t + c * h, &at)
        };
        let second = rates(C[1], first);
        let third = rates(C[2], &second);
        let fourth = rates(C[3], &third);
        let increment =
            std::array::from_fn(|n| h * (B[0] * first[n] + B[1] * second[n] + B[2] * third[n] + B[3] * fourth[n]));
        let (end, carry) = add_compensated(y, &increment, carry);
        let last = system.derivative(t + h, &end);
        Outcome { stages: Self { first: *first, fourth, last }, end, last: Some(last), carry }
    }

    /// Square of the ratio of the estimate e, relative to the scales, to the tolerance with a margin.
    ///
    /// e is the local error of order 3, proportional to h^4. The motion therefore changes within T = h / e^(1/4), and
    /// the step of order 4 has an error of about e h / T. The tolerance applies to a step of about the length T. Each
    /// short step has the share tolerance h / T, so that the sum of the errors of short steps equals that of a few long
    /// steps. Therefore e <= tolerance.
    #[inline]
    fn error<S: System<N>>(&self, h: f64, scale: &[f64; N], tolerance: f64) -> f64 {
        mean_square(S::LEADING, scale, |n| self.difference(n, h)) * (MARGIN * tolerance).powi(-2)
    }
}

impl<const N: usize> Rk4<N> {
    /// Difference of component n between the methods of the pair.
    #[inline(always)]
    fn difference(&self, n: usize, h: f64) -> f64 {
        E * h * (self.fourth[n] - self.last[n])
    }
}
