//! One step of the explicit Runge-Kutta pair of order 8 with an interpolant of order 7 (DOP853).
//!
//! In: a system, a point, a step size. Out: the step with its error estimate, its interpolant, what it feels of stiffness.
//! Source: Hairer, Norsett, Wanner, Solving ODEs I (1993), II.5, II.6 (dense output), II.10 (error).
pub(super) mod tableau;

use super::pair::Outcome;
use super::step::{Step, add_compensated};
use super::{Dense, System};
use tableau::{A, C, D, E3, E5, EXTENDED, STAGES};

/// Derivatives of the 12 stages, then the one at the end.
pub(super) type Slopes<const N: usize> = [[f64; N]; STAGES + 1];

/// Order of the error estimate plus 1: it falls as this power of the step size.
pub(super) const ERROR_POWER: f64 = 8.0;
/// The interval of stability on the negative real axis ends at about this h lambda; Solving ODEs II (1996), IV.2.
pub(super) const STABLE_TO: f64 = 6.1;

/// The step of size h from (t, y), where f(t, y) = `first` and the sums so far have lost `carry`.
pub(super) fn attempt<S: System<N>, const N: usize>(
    system: &mut S,
    t: f64,
    y: &[f64; N],
    first: &[f64; N],
    h: f64,
    carry: &[f64; N],
) -> Outcome<Slopes<N>, N> {
    let mut k = [[0.0; N]; STAGES + 1];
    k[0] = *first;
    macro_rules! stage {
        ($i:literal; $($j:literal)*) => {{
            let at = std::array::from_fn(|n| y[n] + h * (0.0 $(+ A[$i][$j] * k[$j][n])*));
            k[$i] = system.derivative(t + C[$i] * h, &at);
        }};
    }
    stage!(1; 0);
    stage!(2; 0 1);
    stage!(3; 0 2);
    stage!(4; 0 2 3);
    stage!(5; 0 3 4);
    stage!(6; 0 3 4 5);
    stage!(7; 0 3 4 5 6);
    stage!(8; 0 3 4 5 6 7);
    stage!(9; 0 3 4 5 6 7 8);
    stage!(10; 0 3 4 5 6 7 8 9);
    stage!(11; 0 3 4 5 6 7 8 9 10);
    let increment = std::array::from_fn(|n| {
        let mut sum = A[12][0] * k[0][n];
        for (j, stage) in k.iter().enumerate().take(STAGES).skip(5) {
            sum += A[12][j] * stage[n];
        }
        h * sum
    });
    let (end, lost) = add_compensated(y, &increment, carry);
    k[STAGES] = system.derivative(t + h, &end);
    Outcome { last: k[STAGES], stages: k, end, carry: lost }
}

/// Error estimate over the tolerance, II.10, eq. (10.17): below 1 the step is good.
pub(super) fn error<const N: usize>(k: &Slopes<N>, h: f64, scale: &[f64; N], tolerance: f64) -> f64 {
    let (mut fifth, mut third) = (0.0, 0.0);
    for n in 0..N {
        let (mut e5, mut e3) = (0.0, 0.0);
        for (j, stage) in k.iter().enumerate().take(STAGES) {
            e5 += E5[j] * stage[n];
            e3 += E3[j] * stage[n];
        }
        let weight = 1.0 / (tolerance * scale[n]);
        fifth += (e5 * weight).powi(2);
        third += (e3 * weight).powi(2);
    }
    let both = fifth + 0.01 * third;
    if both == 0.0 { 0.0 } else { h * fifth / (both * N as f64).sqrt() }
}

/// h |lambda| as the last stage and the end of the step show it, both at t + h: |f(end) - f(stage)| / |end - stage|;
/// Solving ODEs II (1996), IV.2, eq. (2.26), components over their scales.
pub(super) fn stiffness<const N: usize>(
    start: &[f64; N],
    end: &[f64; N],
    k: &Slopes<N>,
    h: f64,
    scale: &[f64; N],
) -> f64 {
    let (mut slopes, mut points) = (0.0, 0.0);
    for n in 0..N {
        let stage = start[n] + h * k[..11].iter().zip(&A[11]).map(|(k, a)| a * k[n]).sum::<f64>();
        slopes += ((k[12][n] - k[11][n]) / scale[n]).powi(2);
        points += ((end[n] - stage) / scale[n]).powi(2);
    }
    if points > 0.0 { h * (slopes / points).sqrt() } else { 0.0 }
}

/// Interpolant of order 7; costs three evaluations, at stages within the step.
pub(super) fn dense<S: System<N>, const N: usize>(step: &Step<N>, slopes: &Slopes<N>, system: &mut S) -> Dense<N> {
    let mut k = [[0.0; N]; EXTENDED];
    let mut points = [[0.0; N]; EXTENDED - STAGES - 1];
    k[..=STAGES].copy_from_slice(slopes);
    for (i, at) in (STAGES + 1..).zip(&mut points) {
        *at = std::array::from_fn(|n| {
            step.start[n] + step.h * k[..i].iter().zip(&A[i]).map(|(stage, a)| a * stage[n]).sum::<f64>()
        });
        k[i] = system.derivative(step.t + C[i] * step.h, at);
    }
    let mut terms = [[0.0; N]; 7];
    for n in 0..N {
        let delta = step.end[n] - step.start[n];
        terms[0][n] = delta;
        terms[1][n] = step.h * k[0][n] - delta;
        terms[2][n] = 2.0 * delta - step.h * (k[STAGES][n] + k[0][n]);
        for (term, weights) in terms[3..].iter_mut().zip(&D) {
            term[n] = step.h * k.iter().zip(weights).map(|(stage, d)| d * stage[n]).sum::<f64>();
        }
    }
    let mut dense = Dense::new(step.start, step.end, terms);
    let mut off = [0.0_f64; N];
    for (c, point) in C[STAGES + 1..].iter().zip(&points) {
        let there = dense.at(*c);
        for n in 0..N {
            off[n] = off[n].max((there[n] - point[n]).abs());
        }
    }
    dense.off = Some(off);
    dense
}
