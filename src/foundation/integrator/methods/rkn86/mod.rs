//! One step of the explicit Runge-Kutta-Nystroem pair of order 8(6) for q'' = f(t, q), with an interpolant.
//!
//! Without forces that depend on the speed, order 8 needs eight evaluations instead of the twelve of DOP853, and half
//! the sums of stages. In: a system of that kind, a point, a step size. Out: the step with its error estimate and its
//! interpolant.
pub mod tableau;

use crate::integrator::dense::{TERMS, hermite};
use crate::integrator::pair::{BULGE_MARGIN, Outcome, Pair, Path, Start, add_compensated, bulge, extremes};
use crate::integrator::{Dense, Method, System};
use tableau::{A, C, E, E_RATE, FROM_SLOPES, PLACES, STAGES, WEIGHTS};

/// Accelerations at the stages and at the end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rkn86([f64; STAGES]);

impl<const N: usize> Path<N> for Rkn86 {
    const METHOD: Method = Method::Rkn86;

    fn first(&self, y: &[f64; N]) -> [f64; N] {
        let mut first = *y;
        (first[0], first[1]) = (y[1], self.0[0]);
        first
    }

    fn dense_evaluations(&self) -> u64 {
        PLACES.len() as u64
    }

    fn interpolates(&self) -> bool {
        true
    }

    #[inline]
    fn bulge(&self, n: usize, h: f64, [start, end]: [&[f64; N]; 2]) -> f64 {
        if n != 0 {
            return f64::INFINITY;
        }
        let [least, most] = extremes(self.0);
        let margin = 0.5 * (BULGE_MARGIN - 1.0) * (most - least);
        if (least - margin >= 0.0 || most + margin <= 0.0) && start[1] * end[1] >= 0.0 {
            // The rate is monotone and does not change its sign, so the path is monotone.
            return 0.0;
        }
        // The rate changes by at most h times the largest acceleration.
        bulge(h, [0.0, h * most.max(-least)])
    }

    /// Of degree 7, within the tolerance of the step, with four evaluations. A first interpolant of q uses the values,
    /// rates and accelerations at both ends, and the accelerations of the stages at 0.3 h and 0.5 h. These are accurate
    /// to h^5 (row sums with c^2 hold there). Accelerations at four places on the first interpolant are accurate to
    /// h^9, relative to those of the motion. The interpolant of q' uses all four, with the values and rates at both
    /// ends. The interpolant of q uses the outer two instead of those of the stages.
    fn dense<S: System<N>>(&self, system: &mut S, t: f64, h: f64, ends: [&[f64; N]; 2]) -> Dense<N> {
        let k = &self.0;
        let first = self.position(h, ends, [(C[3], k[3]), (C[4], k[4])]);
        let mut dense = Dense::new(*ends[0], *ends[1], with_component([[0.0; N]; TERMS], 0, first), |_| 0.0);
        let displacements = PLACES.map(|s| dense.component(0, s) - ends[0][0]);
        let mut accelerations = [0.0; 4];
        for ((acceleration, s), displacement) in accelerations.iter_mut().zip(PLACES).zip(displacements) {
            *acceleration = system.acceleration(t + s * h, ends[0], displacement);
        }
        let outer = [0, 3].map(|i| (PLACES[i], accelerations[i]));
        let terms = with_component(dense.terms, 0, self.position(h, ends, outer));
        dense.terms = with_component(terms, 1, self.rate(h, ends, &accelerations));
        for (s, displacement) in PLACES.into_iter().zip(displacements) {
            dense.off[0] = dense.off[0].max((dense.component(0, s) - ends[0][0] - displacement).abs());
        }
        dense
    }
}

impl Rkn86 {
    /// Terms of the interpolant of q, from the ends and the accelerations at two places.
    fn position<const N: usize>(
        &self,
        h: f64,
        [start, end]: [&[f64; N]; 2],
        [(a, k_a), (b, k_b)]: [(f64, f64); 2],
    ) -> [f64; TERMS] {
        let (k, last) = (&self.0, self.0[STAGES - 1]);
        // The terms after Hermite's cubic have the factor w = s^2 (1 - s)^2, w'' = 2 at both ends.
        let [t0, t1, t2] = hermite(h, [start[0], end[0]], [start[1], end[1]]);
        let square = h * h;
        let t3 = 0.5 * square * k[0] + t1 - t2;
        let t4 = 0.5 * square * last + t1 + 2.0 * t2 - t3;
        // Rest of the acceleration at s: h^2 k minus the acceleration of all terms so far. The factors are second
        // derivatives of s^i (1 - s)^j.
        let left = |k: f64, s: f64| {
            let third = 2.0 + s * (12.0 * s - 12.0);
            let fourth = s * (6.0 + s * (20.0 * s - 24.0));
            square * k - (t2 * (2.0 - 6.0 * s) - 2.0 * t1 + t3 * third + t4 * fourth)
        };
        let fifth = |s: f64| s * (6.0 + s * (s * (60.0 - 30.0 * s) - 36.0));
        let sixth = |s: f64| s * s * (12.0 + s * (s * (90.0 - 42.0 * s) - 60.0));
        let (at_a, at_b) = (left(k_a, a), left(k_b, b));
        let determinant = fifth(a) * sixth(b) - fifth(b) * sixth(a);
        let t5 = (at_a * sixth(b) - at_b * sixth(a)) / determinant;
        let t6 = (at_b * fifth(a) - at_a * fifth(b)) / determinant;
        [t0, t1, t2, t3, t4, t5, t6]
    }

    /// Terms of the interpolant of q', from the ends and the accelerations at [`PLACES`].
    fn rate<const N: usize>(&self, h: f64, [start, end]: [&[f64; N]; 2], accelerations: &[f64; 4]) -> [f64; TERMS] {
        let [t0, t1, t2] = hermite(h, [start[1], end[1]], [self.0[0], self.0[STAGES - 1]]);
        let left: [f64; 4] = std::array::from_fn(|i| {
            let s = PLACES[i];
            h * accelerations[i] - (t0 + t1 * (1.0 - 2.0 * s) + t2 * s * (2.0 - 3.0 * s))
        });
        let [t3, t4, t5, t6] = FROM_SLOPES.map(|row| row.iter().zip(&left).map(|(weight, left)| weight * left).sum());
        [t0, t1, t2, t3, t4, t5, t6]
    }
}

/// Replaces the terms of component n.
fn with_component<const N: usize>(mut terms: [[f64; N]; TERMS], n: usize, own: [f64; TERMS]) -> [[f64; N]; TERMS] {
    for (term, own) in terms.iter_mut().zip(own) {
        term[n] = own;
    }
    terms
}

impl<const N: usize> Pair<N> for Rkn86 {
    const EVALUATIONS: u64 = STAGES as u64 - 1;
    /// The power 9 of the step size in the error estimate, times 14.
    const ERROR_POWER: f64 = 126.0;

    #[inline]
    fn attempt<S: System<N>>(system: &mut S, start: &Start<N>, h: f64) -> Outcome<Self, N> {
        let &Start { t, ref y, ref first, ref carry } = start;
        let mut k = [0.0; STAGES];
        k[0] = first[1];
        let (displacement, square) = (h * y[1], h * h);
        // The time of a step is the latency from one acceleration to the next, so the previous acceleration is added
        // last.
        macro_rules! stage {
            ($i:literal; $($j:literal)*; $before:literal) => {{
                let known = C[$i] * displacement + square * (0.0 $(+ A[$i][$j] * k[$j])*);
                k[$i] = system.acceleration(t + C[$i] * h, y, known + (square * A[$i][$before]) * k[$before]);
            }};
        }
        stage!(1; ; 0);
        stage!(2; 0; 1);
        stage!(3; 0 1; 2);
        stage!(4; 0 1 2; 3);
        stage!(5; 0 1 2 3; 4);
        stage!(6; 0 1 2 3 4; 5);
        stage!(7; 0 1 2 3 4 5; 6);
        let mut increment = [0.0; N];
        // q does not depend on the last stage, so the acceleration at the end need not wait for this stage.
        increment[0] = displacement + square * sum(&A[STAGES - 1][..STAGES - 2], &k);
        increment[1] = h * sum(&WEIGHTS, &k);
        let (end, lost) = add_compensated(y, &increment, carry);
        let last = system.derivative(t + h, &end);
        k[STAGES - 1] = last[1];
        Outcome { stages: Self(k), end, last: Some(last), carry: lost }
    }

    /// Ratio of the error estimate to the tolerance, to the power of 14. The difference e of the pair, relative to the
    /// scales, is the error of order 6, proportional to h^7. w is the contribution of the accelerations to the step,
    /// relative to the scales. The accelerations therefore change within h / (e / w)^(1/7), and the step of order 8 has
    /// an error of about e (e / w)^(2/7). The power of 14 avoids roots: only the square of e is needed. A w above 1
    /// counts as 1.
    #[inline]
    fn error<S: System<N>>(&self, h: f64, scale: &[f64; N], tolerance: f64) -> f64 {
        // Quotients that do not wait for the accelerations.
        let (weight, weight_rate) = (h * h / scale[0], h / scale[1]);
        let (e, e_rate) = (weight * sum(&E, &self.0), weight_rate * sum(&E_RATE, &self.0));
        let square = 0.5 * (e * e + e_rate * e_rate);
        let error = square.powi(9) * tolerance.powi(-14);
        let [least, most] = extremes(self.0);
        let strength = weight_rate * most.max(-least);
        // If the strength is so small that its power is 0, the error is 0 too.
        if error > 0.0 && strength < 1.0 { error / (strength * strength).powi(2) } else { error }
    }
}

/// Weighted sum of the first accelerations, as two sums that the processor computes in parallel.
#[inline]
fn sum(weights: &[f64], k: &[f64; STAGES]) -> f64 {
    let mut sums = [0.0; 2];
    for (i, (w, k)) in weights.iter().zip(k).enumerate() {
        sums[i % 2] += w * k;
    }
    sums[0] + sums[1]
}
