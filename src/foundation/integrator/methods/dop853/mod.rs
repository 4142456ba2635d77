//! One step of the explicit Runge-Kutta pair of order 8 with an interpolant of order 7 (DOP853).
//!
//! In: a system, a point, a step size. Out: the step with its error estimate, its interpolant, an estimate of
//! stiffness.
//! Source: Hairer, Norsett, Wanner, Solving ODEs I (1993), II.5, II.6 (dense output), II.10 (error).
pub mod tableau;

use crate::integrator::dense::{TERMS, hermite};
use crate::integrator::pair::{Outcome, Pair, Path, Start, add_compensated, bulge, extremes, stage};
use crate::integrator::{Dense, Method, System};
use tableau::{A, C, D, E3, E5, EXTENDED, STAGES};

/// Approximate h |lambda| at the end of the interval of stability on the negative real axis; Solving ODEs II (1996),
/// IV.2.
pub const STABLE_TO: f64 = 6.1;

/// Lower limit of an error, relative to the square of the estimate of order 3. For a harmonic oscillation the limit
/// equals the error, so that it does not change the steps of smooth motions.
const LEAST: f64 = 1.0 / 32.0;

/// f at the 12 stages and at the end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dop853<const N: usize>([[f64; N]; STAGES + 1]);

impl<const N: usize> Path<N> for Dop853<N> {
    const METHOD: Method = Method::Dop853;

    fn first(&self, _y: &[f64; N]) -> [f64; N] {
        self.0[0]
    }

    fn dense_evaluations(&self) -> u64 {
        (EXTENDED - STAGES) as u64 - 1
    }

    fn interpolates(&self) -> bool {
        true
    }

    fn rates(&self) -> Option<[&[f64; N]; 2]> {
        Some([&self.0[0], &self.0[STAGES]])
    }

    fn bulge(&self, n: usize, h: f64, _ends: [&[f64; N]; 2]) -> f64 {
        bulge(h, extremes(self.0.iter().map(|f| f[n])))
    }

    /// Of order 7, with three evaluations at stages within the step.
    fn dense<S: System<N>>(&self, system: &mut S, t: f64, h: f64, ends: [&[f64; N]; 2]) -> Dense<N> {
        let mut k = [[0.0; N]; EXTENDED];
        let mut points = [[0.0; N]; EXTENDED - STAGES - 1];
        k[..=STAGES].copy_from_slice(&self.0);
        for (i, at) in (STAGES + 1..).zip(&mut points) {
            *at = std::array::from_fn(|n| {
                ends[0][n] + h * k[..i].iter().zip(&A[i]).map(|(stage, a)| a * stage[n]).sum::<f64>()
            });
            k[i] = system.derivative(t + C[i] * h, at);
        }
        let mut terms = [[0.0; N]; TERMS];
        for n in 0..N {
            [terms[0][n], terms[1][n], terms[2][n]] = hermite(h, ends.map(|y| y[n]), [k[0][n], k[STAGES][n]]);
            for (term, weights) in terms[3..].iter_mut().zip(&D) {
                term[n] = h * k.iter().zip(weights).map(|(stage, d)| d * stage[n]).sum::<f64>();
            }
        }
        let mut dense = Dense::new(*ends[0], *ends[1], terms, |_| 0.0);
        for (c, point) in C[STAGES + 1..].iter().zip(&points) {
            let there = dense.at(*c);
            for n in 0..N {
                dense.off[n] = dense.off[n].max((there[n] - point[n]).abs());
            }
        }
        dense
    }
}

impl<const N: usize> Pair<N> for Dop853<N> {
    const EVALUATIONS: u64 = STAGES as u64;
    /// Order of the error estimate plus 1.
    const ERROR_POWER: f64 = 8.0;

    fn attempt<S: System<N>>(system: &mut S, start: &Start<N>, h: f64) -> Outcome<Self, N> {
        let &Start { t, ref y, first, ref carry } = start;
        let mut k = [[0.0; N]; STAGES + 1];
        k[0] = first;
        macro_rules! stage {
            ($i:literal; $($j:literal)*) => { stage!($i derivative; $($j)*) };
            ($i:literal $rates:ident; $($j:literal)*) => {{
                let at = stage::<S, N>(y, |n| h * (0.0 $(+ A[$i][$j] * k[$j][n])*));
                k[$i] = system.$rates(t + C[$i] * h, &at);
            }};
        }
        // The end of the step and its interpolant do not depend on these stages; only later stages do.
        stage!(1 leading; 0);
        stage!(2 leading; 0 1);
        stage!(3 leading; 0 2);
        stage!(4 leading; 0 2 3);
        stage!(5; 0 3 4);
        stage!(6; 0 3 4 5);
        stage!(7; 0 3 4 5 6);
        stage!(8; 0 3 4 5 6 7);
        stage!(9; 0 3 4 5 6 7 8);
        stage!(10; 0 3 4 5 6 7 8 9);
        stage!(11; 0 3 4 5 6 7 8 9 10);
        macro_rules! weighted {
            ($n:ident; $($j:literal)*) => { h * (0.0 $(+ A[12][$j] * k[$j][$n])*) };
        }
        let increment = std::array::from_fn(|n| weighted!(n; 0 5 6 7 8 9 10 11));
        let (end, lost) = add_compensated(y, &increment, carry);
        k[STAGES] = system.derivative(t + h, &end);
        Outcome { last: Some(k[STAGES]), stages: Self(k), end, carry: lost }
    }

    /// Ratio of the error estimate to the tolerance: II.10, eq. (10.17), but at least [`LEAST`] times the square of the
    /// ratio of the estimate of order 3 to the tolerance, which is of the same order. The estimate of order 5 alone is
    /// useless if it passes 0 within a step.
    fn error<S: System<N>>(&self, h: f64, scale: &[f64; N], tolerance: f64) -> f64 {
        let (mut fifth, mut third) = (0.0, 0.0);
        for n in 0..S::LEADING {
            let (mut e5, mut e3) = (0.0, 0.0);
            for (j, stage) in self.0.iter().enumerate().take(STAGES) {
                e5 += E5[j] * stage[n];
                e3 += E3[j] * stage[n];
            }
            let weight = 1.0 / (tolerance * scale[n]);
            fifth += (e5 * weight).powi(2);
            third += (e3 * weight).powi(2);
        }
        let both = fifth + 0.01 * third;
        let error = if both == 0.0 { 0.0 } else { h * fifth / (both * N as f64).sqrt() };
        error.max(LEAST * h * h * third * tolerance / N as f64)
    }

    /// From the last stage and the end of the step, both at t + h: |f(end) - f(stage)| / |end - stage|; Solving ODEs II
    /// (1996), IV.2, eq. (2.26), with components relative to their scales.
    fn stiffness<S: System<N>>(&self, h: f64, [start, end]: [&[f64; N]; 2], scale: &[f64; N]) -> f64 {
        let (k, mut rates, mut points) = (&self.0, 0.0, 0.0);
        for n in 0..S::LEADING {
            let stage = start[n] + h * k[..11].iter().zip(&A[11]).map(|(k, a)| a * k[n]).sum::<f64>();
            rates += ((k[12][n] - k[11][n]) / scale[n]).powi(2);
            points += ((end[n] - stage) / scale[n]).powi(2);
        }
        if points > 0.0 { h * (rates / points).sqrt() } else { 0.0 }
    }
}
