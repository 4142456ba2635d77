//! RKN8(6): coefficients, interpolant, step-size control.
use super::{SecondOrder, explicitly, miss, oscillator, run};
use crate::integrator::methods::rkn86::Rkn86;
use crate::integrator::methods::rkn86::tableau::{A, C, E, E_RATE, STAGES, WEIGHTS};
use crate::integrator::{Integrator, Method, Step, System};

fn attempt<S: System<2>>(system: &mut S, t: f64, y: &[f64; 2], h: f64) -> Step<2> {
    explicitly::<Rkn86, S, 2>(system, t, y, h)
}

#[test]
fn order_conditions_hold() {
    let row = |i: usize, power: i32| (0..i).map(|j| A[i][j] * C[j].powi(power)).sum::<f64>();
    for (i, c) in C.iter().enumerate().skip(1) {
        assert!((row(i, 0) - 0.5 * c * c).abs() < 1e-14, "row {i}");
        if i > 2 {
            // Conditions that the interpolant needs.
            assert!((row(i, 1) - c.powi(3) / 6.0).abs() < 1e-14, "row {i}, c");
            assert!((row(i, 2) - c.powi(4) / 12.0).abs() < 1e-14, "row {i}, c^2");
        }
    }
    let sum = |weights: &[f64], power: i32| weights.iter().zip(&C).map(|(w, c)| w * c.powi(power)).sum::<f64>();
    for power in 0..=6 {
        let exact = 1.0 / f64::from((power + 1) * (power + 2));
        assert!((sum(&A[STAGES - 1], power) - exact).abs() < 1e-15, "q, degree {power}");
    }
    for power in 0..=7 {
        assert!((sum(&WEIGHTS, power) - 1.0 / f64::from(power + 1)).abs() < 1e-15, "q', degree {power}");
    }
    // sum b'_i c_i^l a_ij c_j^m = 1 / ((m + 1) (m + 2) (l + m + 3)) up to order 8.
    for m in 0..=5 {
        for l in 0..=(5 - m) {
            let sum: f64 = (0..STAGES - 1).map(|i| WEIGHTS[i] * C[i].powi(l) * row(i, m)).sum();
            let exact = 1.0 / f64::from((m + 1) * (m + 2) * (l + m + 3));
            assert!((sum - exact).abs() < 1e-15, "m {m}, l {l}: {sum} against {exact}");
        }
    }
    // The other method of the pair has order 6.
    for power in 0..=5 {
        assert!(power > 4 || sum(&E, power).abs() < 1e-15, "q, degree {power}");
        assert!(sum(&E_RATE, power).abs() < 1e-15, "q', degree {power}");
    }
    assert!(sum(&E, 5).abs() > 1e-5 && sum(&E_RATE, 6).abs() > 1e-5);
}

#[test]
fn the_interpolant_is_exact_to_degree_seven() {
    // An acceleration that is a polynomial of degree 5 gives q of degree 7 and q' of degree 6.
    let mut fall = SecondOrder(|t: f64, y: &[f64; 2]| [y[1], 42.0 * t.powi(5)]);
    let dense = attempt(&mut fall, 0.0, &[0.0, 0.0], 1.0).dense(&mut fall);
    for s in (1..10).map(|i| f64::from(i) / 10.0) {
        let [q, rate] = dense.at(s);
        assert!((q - s.powi(7)).abs() < 1e-14 && (rate - 7.0 * s.powi(6)).abs() < 1e-13, "{s}: {q} {rate}");
    }
    // An acceleration of degree 6 gives q' of degree 7.
    let mut fall = SecondOrder(|t: f64, y: &[f64; 2]| [y[1], 56.0 * t.powi(6)]);
    let dense = attempt(&mut fall, 0.0, &[0.0, 0.0], 1.0).dense(&mut fall);
    for s in (1..10).map(|i| f64::from(i) / 10.0) {
        assert!((dense.at(s)[1] - 8.0 * s.powi(7)).abs() < 1e-13, "{s}: {}", dense.at(s)[1]);
    }
}

/// States within a step are as accurate as required at its end.
#[test]
fn the_interpolant_is_within_the_tolerance() {
    for exponent in 3..=12 {
        let tolerance = 10f64.powi(-exponent);
        let (mut system, mut integrator) = (SecondOrder(oscillator), Integrator::default());
        let (mut t, mut y) = (0.0, [1.0, 0.0]);
        let mut worst: f64 = 0.0;
        while t < 10.0 {
            let step = integrator.step(&mut system, t, &y, f64::INFINITY, tolerance).unwrap();
            assert_eq!(step.method(), Method::Rkn86);
            let dense = step.dense(&mut system);
            for s in (1..20).map(|i| f64::from(i) / 20.0) {
                // From the start of the step, so that errors of previous steps do not count.
                let (sin, cos) = (s * step.h).sin_cos();
                let exact = [y[0] * cos + y[1] * sin, y[1] * cos - y[0] * sin];
                worst = (0..2).fold(worst, |worst, n| worst.max((dense.at(s)[n] - exact[n]).abs()));
            }
            (t, y) = (t + step.h, step.end);
        }
        assert!(worst < tolerance + 2e-15, "tolerance {tolerance}: {worst}");
    }
}

#[test]
fn the_error_follows_the_tolerance_with_fewer_evaluations_than_dop853() {
    for exponent in 3..=13 {
        let tolerance = 10f64.powi(-exponent);
        let (y, integrator) = run(&mut SecondOrder(oscillator), 10.0, 1, tolerance);
        assert!(miss(&y, 10.0) < 10.0 * tolerance + 2e-15, "tolerance {tolerance}: error {}", miss(&y, 10.0));
        assert_eq!(integrator.method(), Method::Rkn86);
        let (y, other) = run(&mut oscillator, 10.0, 1, tolerance);
        assert!(miss(&y, 10.0) < 10.0 * tolerance + 1e-15, "DOP853, tolerance {tolerance}: error {}", miss(&y, 10.0));
        let (cost, dop853) = (integrator.statistics().evaluations, other.statistics().evaluations);
        assert!(exponent < 4 || 4 * cost < 3 * dop853, "tolerance {tolerance}: {cost} evaluations against {dop853}");
    }
}

/// A weak force that changes fast along a fast motion: q'' = a g'(q) with bumps of width 1/30, which contain at most
/// 1e-4 of the kinetic energy. The speed alone would allow steps beyond a bump. Reference: the energy integral v^2 / 2
/// = 1/2 + a g(q), g = 1 / (1 + (30 sin(q/2))^2).
#[test]
fn a_weak_force_that_changes_fast_is_resolved() {
    let (a, n) = (1e-4, 30.0);
    let potential = |q: f64| a / (1.0 + (n * (0.5 * q).sin()).powi(2));
    let force = |_t: f64, y: &[f64; 2]| {
        let bump = 1.0 + (n * (0.5 * y[0]).sin()).powi(2);
        [y[1], -a * 0.5 * n * n * y[0].sin() / (bump * bump)]
    };
    for exponent in 5..=12 {
        let tolerance = 10f64.powi(-exponent);
        let (mut integrator, mut y) = (Integrator::default(), [-1.0, 1.0]);
        let energy = 0.5 - potential(-1.0);
        integrator.advance(&mut SecondOrder(force), &mut y, 20.0, tolerance).unwrap();
        let miss = (0.5 * y[1] * y[1] - potential(y[0]) - energy).abs();
        assert!(miss < 5.0 * tolerance, "tolerance {tolerance}: energy off by {miss}");
    }
}

#[test]
fn a_step_cut_short_is_the_step_of_that_size() {
    let (mut integrator, mut y, mut t) = (Integrator::default(), [1.0, 0.0], 0.0);
    for _ in 0..5 {
        let step = integrator.step(&mut SecondOrder(oscillator), t, &y, 100.0, 1e-12).unwrap();
        assert_eq!(step, attempt(&mut SecondOrder(oscillator), t, &y, step.h));
        let short = integrator.retake(&mut SecondOrder(oscillator), &step, 0.37 * step.h);
        assert_eq!(short, attempt(&mut SecondOrder(oscillator), t, &y, 0.37 * step.h));
        integrator.restart();
        (t, y) = (t + short.h, short.end);
    }
}

/// The steps shrink by a constant ratio towards the pole of q = 1 / (1 - t). The control predicts the shrinking, so
/// that few steps are rejected.
#[test]
fn shrinking_steps_are_predicted() {
    struct Pole;
    impl System<2> for Pole {
        const SECOND_ORDER: bool = true;
        fn derivative(&mut self, _t: f64, y: &[f64; 2]) -> [f64; 2] {
            [y[1], 2.0 * y[0].powi(3)]
        }
        fn scale(&mut self, y: &[f64; 2], _f: &[f64; 2]) -> [f64; 2] {
            [y[0].abs(), y[1].abs()]
        }
    }
    let (mut integrator, mut y) = (Integrator::default(), [1.0, 1.0]);
    integrator.advance(&mut Pole, &mut y, 1.0 - 1e-3, 1e-10).unwrap();
    assert!((y[0] - 1e3).abs() < 1e3 * 1e-5, "{y:?}");
    let work = integrator.statistics();
    assert!(work.accepted > 15 && work.rejected <= 2, "{work:?}");
}

/// Starts at every phase of an oscillation, so that rate and force change their signs within some of the steps.
#[test]
fn a_path_stays_within_its_bulge() {
    let mut straight = 0;
    for i in 0..120 {
        let phase = 0.053 * f64::from(i);
        let exact = |t: f64| (t + phase).cos();
        for h in [0.02, 0.3, 1.0, 1.8] {
            let step = attempt(&mut SecondOrder(oscillator), 0.0, &[phase.cos(), -phase.sin()], h);
            let bulge = step.bulge(0);
            let (low, high) = (exact(0.0).min(exact(h)), exact(0.0).max(exact(h)));
            for k in 1..200 {
                let q = exact(h * f64::from(k) / 200.0);
                assert!((low - q).max(q - high) <= bulge + 1e-15, "phase {phase}, h {h}, part {k}: {q}, bulge {bulge}");
            }
            straight += u32::from(bulge == 0.0);
        }
    }
    assert!((100..400).contains(&straight), "{straight} steps without a turn");
}
