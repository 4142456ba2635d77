//! RK4: order conditions, its choice, long runs of short steps.
use super::{Oscillator, explicitly};
use crate::integrator::methods::rk4::{B, C, E, Rk4};
use crate::integrator::{Integrator, Method, System};

/// y'' = -sin y as (y, y').
struct Pendulum;
impl System<2> for Pendulum {
    fn derivative(&mut self, _t: f64, y: &[f64; 2]) -> [f64; 2] {
        [y[1], -y[0].sin()]
    }
    fn scale(&mut self, _y: &[f64; 2], _f: &[f64; 2]) -> [f64; 2] {
        [1.0, 1.0]
    }
}

#[test]
fn order_conditions_hold() {
    let step = [B[0], B[1], B[2], B[3], 0.0];
    let embedded = [B[0], B[1], B[2], B[3] - E, E];
    // sum_j a_ij c_j^q, row by row; the fifth row is B.
    let inner = |i: usize, q: i32| match i {
        0 => 0.0,
        4 => (0..4).map(|j| B[j] * C[j].powi(q)).sum(),
        _ => C[i] * C[i - 1].powi(q),
    };
    let sum = |b: &[f64; 5], term: &dyn Fn(usize) -> f64| (0..5).map(|i| b[i] * term(i)).sum::<f64>();
    for b in [&step, &embedded] {
        for q in 1..=3 {
            assert!((sum(b, &|i| C[i].powi(q - 1)) - 1.0 / f64::from(q)).abs() < 1e-15);
        }
        assert!((sum(b, &|i| inner(i, 1)) - 1.0 / 6.0).abs() < 1e-15);
    }
    // Order 4, the trees of four nodes: t_41 to t_44.
    let tall = |i: usize| match i {
        0 => 0.0,
        4 => (0..4).map(|j| B[j] * inner(j, 1)).sum(),
        _ => C[i] * inner(i - 1, 1),
    };
    let fourth = |b: &[f64; 5]| {
        [
            sum(b, &|i| C[i].powi(3)) - 1.0 / 4.0,
            sum(b, &|i| C[i] * inner(i, 1)) - 1.0 / 8.0,
            sum(b, &|i| inner(i, 2)) - 1.0 / 12.0,
            sum(b, &tall) - 1.0 / 24.0,
        ]
    };
    assert!(fourth(&step).iter().all(|e| e.abs() < 1e-15));
    assert!(fourth(&embedded).iter().any(|e| e.abs() > 1e-3), "the embedded method must show an error");
}

#[test]
fn observed_orders_are_four_and_three() {
    let error = |steps: u32| {
        let (h, mut y) = (6.0 / f64::from(steps), [1.0, 0.0]);
        for _ in 0..steps {
            y = explicitly::<Rk4<2>, _, 2>(&mut Oscillator, 0.0, &y, h).end;
        }
        (y[0] - 6f64.cos()).hypot(y[1] + 6f64.sin())
    };
    let slope = (error(100) / error(200)).log2();
    assert!((3.9..4.1).contains(&slope), "slope {slope}");
    let worst = |h: f64| {
        let y = [1.0, 0.0];
        let step = explicitly::<Rk4<2>, _, 2>(&mut Oscillator, 0.0, &y, h);
        let dense = step.dense(&mut Oscillator);
        assert_eq!(dense.at(0.0), y);
        assert!((dense.at(1.0)[0] - step.end[0]).abs() < 1e-15);
        (1..20).map(|i| (dense.at(f64::from(i) / 20.0)[0] - (h * f64::from(i) / 20.0).cos()).abs()).fold(0.0, f64::max)
    };
    let slope = (worst(0.1) / worst(0.05)).log2();
    assert!((3.8..4.6).contains(&slope), "local order of the interpolant: {slope}");
}

#[test]
fn a_hundred_thousand_short_steps_keep_the_tolerance() {
    const STEPS: u32 = 100_000;
    for (tolerance, h) in [(1e-9, 1e-3), (1e-9, 1e-4), (1e-12, 1e-4), (1e-12, 1e-5)] {
        let end = f64::from(STEPS) * h;
        let (mut y, mut z, mut w) = ([1.0, 0.0], [1.0, 0.0], [1.0, 0.0]);
        let (mut oscillator, mut pendulum) = (Integrator::default(), Integrator::default());
        for _ in 0..STEPS {
            oscillator.advance(&mut Oscillator, &mut y, h, tolerance).unwrap();
            pendulum.advance(&mut Pendulum, &mut z, h, tolerance).unwrap();
        }
        Integrator::default().advance(&mut Pendulum, &mut w, end, 1e-14).unwrap();
        let errors = [(y[0] - end.cos()).hypot(y[1] + end.sin()), (z[0] - w[0]).hypot(z[1] - w[1])];
        let work = oscillator.statistics();
        println!("{tolerance:e}, h {h:e}: errors {errors:?}, {work:?}");
        // 1e-13: the reference, and the rounding of h over the steps.
        assert!(errors.iter().all(|e| *e < tolerance + 1e-13), "{tolerance}, h {h}: {errors:?}");
        assert!(work.accepted_by(Method::Rk4) > 99_000, "{work:?}");
        assert!(work.evaluations < 4 * u64::from(STEPS) + 2000, "{work:?}");
    }
}

#[test]
fn longer_spans_are_left_to_the_method_of_order_eight() {
    for h in [0.03, 0.3] {
        let (mut y, mut integrator) = ([1.0, 0.0], Integrator::default());
        for _ in 0..1000 {
            integrator.advance(&mut Oscillator, &mut y, h, 1e-11).unwrap();
        }
        let work = integrator.statistics();
        println!("h {h}: {work:?}");
        assert!(work.accepted_by(Method::Rk4) == 0 && work.rejected < 30, "trials are few: {work:?}");
        let end = 1000.0 * h;
        assert!((y[0] - end.cos()).hypot(y[1] + end.sin()) < 1e-8);
    }
}

#[test]
fn a_copied_memory_repeats_the_same_bits_through_changes_of_the_span() {
    let (mut y, mut integrator) = ([1.0, 0.0], Integrator::default());
    let mut seen = [false; 2];
    for i in 0..500 {
        let h = [1e-4, 2e-4, 0.05, 3e-3][i / 7 % 4];
        let (mut z, mut again) = (y, integrator);
        integrator.advance(&mut Pendulum, &mut y, h, 1e-10).unwrap();
        again.advance(&mut Pendulum, &mut z, h, 1e-10).unwrap();
        assert_eq!((y, integrator), (z, again));
        seen[usize::from(integrator.method() == Method::Rk4)] = true;
    }
    assert_eq!(seen, [true; 2], "both methods");
}

#[test]
fn a_short_step_retaken_whole_gives_the_same_bits() {
    let (mut y, mut integrator) = ([1.0, 0.0], Integrator::default());
    integrator.advance(&mut Pendulum, &mut y, 1e-4, 1e-10).unwrap();
    let step = integrator.step(&mut Pendulum, 0.0, &y, 1e-4, 1e-10).unwrap();
    assert_eq!(step.method(), Method::Rk4);
    assert_eq!(integrator.retake(&mut Pendulum, &step, step.h).end, step.end);
    let half = integrator.retake(&mut Pendulum, &step, 0.5 * step.h);
    let dense = step.dense(&mut Pendulum).at(0.5);
    assert!((half.end[0] - dense[0]).abs() < 1e-15 && (half.end[1] - dense[1]).abs() < 1e-15);
}
