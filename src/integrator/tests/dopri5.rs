//! DOPRI5: order conditions, its choice, long runs of steps that are short for DOP853.
use super::{Oscillator, explicitly};
use crate::integrator::methods::dopri5::{A, C, Dopri5, E, STAGES};
use crate::integrator::{Integrator, Method, System};

/// y'' = -sin y - y'/10 as (y, y').
struct Damped;
impl System<2> for Damped {
    fn derivative(&mut self, _t: f64, y: &[f64; 2]) -> [f64; 2] {
        [y[1], -y[0].sin() - 0.1 * y[1]]
    }
    fn scale(&mut self, _y: &[f64; 2], _f: &[f64; 2]) -> [f64; 2] {
        [1.0, 1.0]
    }
}

type Column = [f64; STAGES];

/// sum_j a_ij v_j.
fn inner(v: &Column) -> Column {
    std::array::from_fn(|i| (0..STAGES - 1).map(|j| A[i][j] * v[j]).sum())
}

fn product(a: &Column, b: &Column) -> Column {
    std::array::from_fn(|i| a[i] * b[i])
}

/// What sum b_i (...)_i must be for each rooted tree, order by order: Solving ODEs I (1993), II.2, table 2.2.
fn trees() -> Vec<Vec<(Column, f64)>> {
    let one = [1.0; STAGES];
    let c2 = product(&C, &C);
    let (c3, c4) = (product(&c2, &C), product(&c2, &c2));
    let (ac, ac2, ac3) = (inner(&C), inner(&c2), inner(&c3));
    let aac = inner(&ac);
    vec![
        vec![(one, 1.0)],
        vec![(C, 2.0)],
        vec![(c2, 3.0), (ac, 6.0)],
        vec![(c3, 4.0), (product(&C, &ac), 8.0), (ac2, 12.0), (aac, 24.0)],
        vec![
            (c4, 5.0),
            (product(&c2, &ac), 10.0),
            (product(&ac, &ac), 20.0),
            (product(&C, &ac2), 15.0),
            (ac3, 20.0),
            (product(&C, &aac), 30.0),
            (inner(&product(&C, &ac)), 40.0),
            (inner(&ac2), 60.0),
            (inner(&aac), 120.0),
        ],
    ]
}

#[test]
fn order_conditions_hold() {
    for (row, c) in A.iter().zip(C) {
        assert!((row.iter().sum::<f64>() - c).abs() < 1e-14);
    }
    let step: Column = std::array::from_fn(|i| if i < STAGES - 1 { A[STAGES - 1][i] } else { 0.0 });
    let embedded: Column = std::array::from_fn(|i| step[i] - E[i]);
    let error = |b: &Column, (v, gamma): &(Column, f64)| {
        let sum: f64 = b.iter().zip(v).map(|(b, v)| b * v).sum();
        (sum - 1.0 / gamma).abs()
    };
    for (order, trees) in (1..).zip(&trees()) {
        for tree in trees {
            assert!(error(&step, tree) < 1e-14, "order {order}: {}", error(&step, tree));
            if order < 5 {
                assert!(error(&embedded, tree) < 1e-14, "embedded, order {order}: {}", error(&embedded, tree));
            }
        }
    }
    assert!(trees()[4].iter().any(|tree| error(&embedded, tree) > 1e-4), "the embedded method must show an error");
}

#[test]
fn observed_orders_are_five_and_four() {
    let error = |steps: u32| {
        let (h, mut y) = (6.0 / f64::from(steps), [1.0, 0.0]);
        for _ in 0..steps {
            y = explicitly::<Dopri5<2>, _, 2>(&mut Oscillator, 0.0, &y, h).end;
        }
        (y[0] - 6f64.cos()).hypot(y[1] + 6f64.sin())
    };
    let slope = (error(100) / error(200)).log2();
    assert!((4.9..5.1).contains(&slope), "slope {slope}");
    let worst = |h: f64| {
        let y = [1.0, 0.0];
        let step = explicitly::<Dopri5<2>, _, 2>(&mut Oscillator, 0.0, &y, h);
        let dense = step.dense(&mut Oscillator);
        assert_eq!(dense.at(0.0), y);
        assert!((dense.at(1.0)[0] - step.end[0]).abs() < 1e-15);
        (1..20).map(|i| (dense.at(f64::from(i) / 20.0)[0] - (h * f64::from(i) / 20.0).cos()).abs()).fold(0.0, f64::max)
    };
    let slope = (worst(0.2) / worst(0.1)).log2();
    assert!((4.7..6.3).contains(&slope), "local order of the interpolant: {slope}");
}

#[test]
fn many_steps_keep_the_tolerance_for_half_the_evaluations() {
    for (tolerance, h, steps) in [(1e-6, 0.1, 1000u32), (1e-9, 0.02, 5000), (1e-12, 5e-3, 20_000)] {
        let (mut y, mut z, mut integrator) = ([1.0, 0.0], [1.0, 0.0], Integrator::default());
        for _ in 0..steps {
            integrator.advance(&mut Oscillator, &mut y, h, tolerance).unwrap();
        }
        let mut damped = Integrator::default();
        let mut worst: f64 = 0.0;
        let (mut w, mut reference) = ([1.0, 0.0], Integrator::default());
        for _ in 0..2000 {
            damped.advance(&mut Damped, &mut z, h, tolerance).unwrap();
            reference.advance(&mut Damped, &mut w, h, 1e-14).unwrap();
            worst = worst.max((z[0] - w[0]).hypot(z[1] - w[1]));
        }
        let end = f64::from(steps) * h;
        let error = (y[0] - end.cos()).hypot(y[1] + end.sin());
        let work = integrator.statistics();
        println!("{tolerance:e}, h {h:e}: errors {error:e} {worst:e}, {work:?}");
        // 1e-13: the reference, and the rounding of h over the steps.
        assert!(error < tolerance + 1e-13 && worst < tolerance + 1e-13, "{tolerance}, h {h}: {error} {worst}");
        assert!(work.accepted_by(Method::Dopri5) > u64::from(steps) * 98 / 100, "{work:?}");
        assert!(work.evaluations < u64::from(steps) * 13 / 2 + 200, "{work:?}");
    }
}

#[test]
fn a_step_retaken_whole_gives_the_same_bits() {
    let (mut y, mut integrator) = ([1.0, 0.0], Integrator::default());
    integrator.advance(&mut Damped, &mut y, 1e-2, 1e-10).unwrap();
    let step = integrator.step(&mut Damped, 0.0, &y, 1e-2, 1e-10).unwrap();
    assert_eq!(step.method(), Method::Dopri5);
    assert_eq!(integrator.retake(&mut Damped, &step, step.h).end, step.end);
    let half = integrator.retake(&mut Damped, &step, 0.5 * step.h);
    let dense = step.dense(&mut Damped).at(0.5);
    assert!((half.end[0] - dense[0]).abs() < 1e-11 && (half.end[1] - dense[1]).abs() < 1e-11);
}
