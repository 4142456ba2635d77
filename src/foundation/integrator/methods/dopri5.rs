//! One step of Dormand and Prince's pair of order 5(4), for spans that are too long for RK4 but short compared with the
//! motion.
//!
//! The last stage is f at the end of the step, which is the first stage of the next step: six evaluations a step.
//! Coefficients and interpolant: Hairer, Norsett, Wanner, Solving ODEs I (1993), II.5, table 5.2, and II.6, CONTD5.
//! Their order conditions are tested.
use crate::integrator::dense::TERMS;
use crate::integrator::pair::{Outcome, Pair, Path, Start, add_compensated, bulge, extremes, mean_square, stage};
use crate::integrator::{Dense, Method, System};

/// Number of stages. The last stage is at the end of the step.
pub const STAGES: usize = 7;
/// Nodes c_i.
pub const C: [f64; STAGES] = [0.0, 1.0 / 5.0, 3.0 / 10.0, 4.0 / 5.0, 8.0 / 9.0, 1.0, 1.0];
/// a_ij. The last row contains the weights b_j of the step.
#[rustfmt::skip]
pub const A: [[f64; STAGES - 1]; STAGES] = [
    [0.0; STAGES - 1],
    [1.0 / 5.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0, 0.0],
    [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0, 0.0],
    [19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0, 0.0, 0.0],
    [9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0, 0.0],
    [35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];
/// Weights of the step minus those of the embedded method of order 4.
#[rustfmt::skip]
pub const E: [f64; STAGES] = [
    71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339200.0, 22.0 / 525.0, -1.0 / 40.0,
];
/// Weights of the interpolant's last term.
#[rustfmt::skip]
pub const D: [f64; STAGES] = [
    -12715105075.0 / 11282082432.0, 0.0, 87487479700.0 / 32700410799.0, -10690763975.0 / 1880347072.0,
    701980252875.0 / 199316789632.0, -1453857185.0 / 822651844.0, 69997945.0 / 29380423.0,
];
/// Part of the tolerance that the estimate may use, chosen like that of RK4.
const MARGIN: f64 = 0.07;

/// f at the stages.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dopri5<const N: usize>([[f64; N]; STAGES]);

impl<const N: usize> Path<N> for Dopri5<N> {
    const METHOD: Method = Method::Dopri5;

    fn first(&self, _y: &[f64; N]) -> [f64; N] {
        self.0[0]
    }

    fn interpolates(&self) -> bool {
        true
    }

    fn rates(&self) -> Option<[&[f64; N]; 2]> {
        Some([&self.0[0], &self.0[STAGES - 1]])
    }

    #[inline]
    fn bulge(&self, n: usize, h: f64, _ends: [&[f64; N]; 2]) -> f64 {
        bulge(h, extremes(self.0.iter().map(|f| f[n])))
    }

    /// Of order 4, without an evaluation: II.6, CONTD5.
    fn dense<S: System<N>>(&self, _system: &mut S, _t: f64, h: f64, [start, end]: [&[f64; N]; 2]) -> Dense<N> {
        let k = &self.0;
        let delta: [f64; N] = std::array::from_fn(|n| end[n] - start[n]);
        let mut terms = [[0.0; N]; TERMS];
        terms[0] = delta;
        terms[1] = std::array::from_fn(|n| h * k[0][n] - delta[n]);
        terms[2] = std::array::from_fn(|n| delta[n] - h * k[STAGES - 1][n] - terms[1][n]);
        terms[3] = std::array::from_fn(|n| h * (0..STAGES).map(|j| D[j] * k[j][n]).sum::<f64>());
        Dense::new(*start, *end, terms, |n| self.difference(n, h))
    }
}

impl<const N: usize> Pair<N> for Dopri5<N> {
    const EVALUATIONS: u64 = STAGES as u64 - 1;
    const ERROR_POWER: f64 = 10.0;

    fn attempt<S: System<N>>(system: &mut S, start: &Start<N>, h: f64) -> Outcome<Self, N> {
        let &Start { t, ref y, first, ref carry } = start;
        let mut k = [first; STAGES];
        macro_rules! stage {
            ($i:literal; $($j:literal)*) => {{
                let at = stage::<S, N>(y, |n| h * (0.0 $(+ A[$i][$j] * k[$j][n])*));
                k[$i] = system.derivative(t + C[$i] * h, &at);
            }};
        }
        stage!(1; 0);
        stage!(2; 0 1);
        stage!(3; 0 1 2);
        stage!(4; 0 1 2 3);
        stage!(5; 0 1 2 3 4);
        let last = &A[STAGES - 1];
        let weighted = |n: usize| last[0] * k[0][n] + last[2] * k[2][n] + last[3] * k[3][n] + last[4] * k[4][n];
        let increment = std::array::from_fn(|n| h * (weighted(n) + last[5] * k[5][n]));
        let (end, lost) = add_compensated(y, &increment, carry);
        k[STAGES - 1] = system.derivative(t + h, &end);
        Outcome { last: Some(k[STAGES - 1]), stages: Self(k), end, carry: lost }
    }

    /// As for RK4. The estimate is the local error of order 4, which is proportional to h^5.
    fn error<S: System<N>>(&self, h: f64, scale: &[f64; N], tolerance: f64) -> f64 {
        mean_square(S::LEADING, scale, |n| self.difference(n, h)) * (MARGIN * tolerance).powi(-2)
    }
}

impl<const N: usize> Dopri5<N> {
    /// Difference of component n between the methods of the pair.
    #[inline(always)]
    fn difference(&self, n: usize, h: f64) -> f64 {
        let k = &self.0;
        let first = E[0] * k[0][n] + E[2] * k[2][n] + E[3] * k[3][n] + E[4] * k[4][n];
        h * (first + E[5] * k[5][n] + E[6] * k[6][n])
    }
}
