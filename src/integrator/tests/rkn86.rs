//! RKN8(6): coefficients, orders, step-size control.
use super::{Oscillator, explicitly};
use crate::integrator::methods::rkn86::Rkn86;
use crate::integrator::methods::rkn86::tableau::{A, C, E, E_RATE, STAGES, WEIGHTS};
use crate::integrator::{Integrator, Method, Step, System};

/// y'' = -y as a system of second order.
struct Spring;
impl System<2> for Spring {
    const SECOND_ORDER: bool = true;
    fn derivative(&mut self, t: f64, y: &[f64; 2]) -> [f64; 2] {
        Oscillator.derivative(t, y)
    }
    fn scale(&mut self, _y: &[f64; 2], _f: &[f64; 2]) -> [f64; 2] {
        [1.0, 1.0]
    }
}

/// q'' = (d + 2) (d + 1) t^d: q = t^(d + 2).
struct Fall(i32);
impl System<2> for Fall {
    const SECOND_ORDER: bool = true;
    fn derivative(&mut self, t: f64, y: &[f64; 2]) -> [f64; 2] {
        [y[1], f64::from((self.0 + 2) * (self.0 + 1)) * t.powi(self.0)]
    }
    fn scale(&mut self, _y: &[f64; 2], _f: &[f64; 2]) -> [f64; 2] {
        [1.0, 1.0]
    }
}

fn attempt<S: System<2>>(system: &mut S, t: f64, y: &[f64; 2], h: f64) -> Step<2> {
    explicitly::<Rkn86, S, 2>(system, t, y, h)
}

#[test]
fn order_conditions_hold() {
    let row = |i: usize, power: i32| (0..i).map(|j| A[i][j] * C[j].powi(power)).sum::<f64>();
    for (i, c) in C.iter().enumerate().skip(1) {
        assert!((row(i, 0) - 0.5 * c * c).abs() < 1e-14, "row {i}");
        if i > 2 {
            // What the interpolant counts on.
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
    // The pair's other method has order 6.
    for power in 0..=5 {
        assert!(power > 4 || sum(&E, power).abs() < 1e-15, "q, degree {power}");
        assert!(sum(&E_RATE, power).abs() < 1e-15, "q', degree {power}");
    }
    assert!(sum(&E, 5).abs() > 1e-5 && sum(&E_RATE, 6).abs() > 1e-5);
}

#[test]
fn observed_order_is_eight() {
    let error = |steps: u32| {
        let (h, mut y) = (6.0 / f64::from(steps), [1.0, 0.0]);
        for i in 0..steps {
            y = attempt(&mut Spring, h * f64::from(i), &y, h).end;
        }
        (y[0] - 6f64.cos()).hypot(y[1] + 6f64.sin())
    };
    let slope = (error(10) / error(20)).log2();
    assert!((7.7..8.8).contains(&slope), "slope {slope}");
}

#[test]
fn interpolant_has_order_six_and_meets_the_ends() {
    let worst = |h: f64, n: usize| {
        let step = attempt(&mut Spring, 0.0, &[0.8, 0.6], h);
        let dense = step.dense(&mut Spring);
        assert_eq!(dense.at(0.0), step.start);
        let phase = 0.8f64.acos();
        let exact = |t: f64| [(t - phase).cos(), -(t - phase).sin()];
        assert!((0..2).all(|n| (dense.at(1.0)[n] - step.end[n]).abs() < 1e-15));
        let miss = |i: i32| (dense.at(f64::from(i) / 10.0)[n] - exact(h * f64::from(i) / 10.0)[n]).abs();
        (1..10).map(miss).fold(0.0, f64::max)
    };
    for (n, orders) in [(0, 6.5..8.5), (1, 5.5..7.5)] {
        let slope = (worst(0.4, n) / worst(0.2, n)).log2();
        assert!(orders.contains(&slope), "local order of component {n}: {slope}");
    }
    // A force along a polynomial of degree 5 gives one of degree 7, which the interpolant is.
    let step = attempt(&mut Fall(5), 0.0, &[0.0, 0.0], 1.0);
    let dense = step.dense(&mut Fall(5));
    assert!((1..10).all(|i| (dense.at(f64::from(i) / 10.0)[0] - (f64::from(i) / 10.0).powi(7)).abs() < 1e-14));
}

#[test]
fn error_follows_the_tolerance() {
    for exponent in 3..=13 {
        let tolerance = 10f64.powi(-exponent);
        let (mut integrator, mut y) = (Integrator::default(), [1.0, 0.0]);
        integrator.advance(&mut Spring, &mut y, 10.0, tolerance).unwrap();
        let error = (y[0] - 10f64.cos()).hypot(y[1] + 10f64.sin());
        assert!(error < 10.0 * tolerance + 2e-15, "tolerance {tolerance}: error {error}");
        assert_eq!(integrator.method(), Method::Rkn86);
        let mut other = Integrator::default();
        other.advance(&mut Oscillator, &mut [1.0, 0.0], 10.0, tolerance).unwrap();
        let (cost, dop853) = (integrator.statistics().evaluations, other.statistics().evaluations);
        assert!(exponent < 4 || 4 * cost < 3 * dop853, "tolerance {tolerance}: {cost} evaluations against {dop853}");
    }
}

#[test]
fn a_step_cut_short_is_the_step_of_that_size() {
    let (mut integrator, mut y, mut t) = (Integrator::default(), [1.0, 0.0], 0.0);
    for _ in 0..5 {
        let step = integrator.step(&mut Spring, t, &y, 100.0, 1e-12).unwrap();
        assert_eq!(step, attempt(&mut Spring, t, &y, step.h));
        let short = integrator.retake(&mut Spring, &step, 0.37 * step.h);
        assert_eq!(short, attempt(&mut Spring, t, &y, 0.37 * step.h));
        integrator.restart();
        (t, y) = (t + short.h, short.end);
    }
}

/// The steps shrink by a steady ratio towards the pole of q = 1 / (1 - t); that is foreseen, not found out by
/// rejections.
#[test]
fn shrinking_steps_are_foreseen() {
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
fn a_path_is_no_farther_out_than_its_bulge() {
    let mut straight = 0;
    for i in 0..120 {
        let phase = 0.053 * f64::from(i);
        let exact = |t: f64| (t + phase).cos();
        for h in [0.02, 0.3, 1.0, 1.8] {
            let step = attempt(&mut Spring, 0.0, &[phase.cos(), -phase.sin()], h);
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
