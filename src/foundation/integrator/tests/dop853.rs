//! DOP853: coefficients, step-size control.
use super::{explicitly, oscillator, power, run};
use crate::integrator::methods::dop853::Dop853;
use crate::integrator::methods::dop853::tableau::{A, C, D, E3, E5, EXTENDED, STAGES};
use crate::integrator::{IntegrationError, Integrator, System};

#[test]
fn row_sums_are_the_nodes() {
    for i in 1..EXTENDED {
        let sum: f64 = A[i].iter().sum();
        assert!((sum - C[i]).abs() < 2e-14, "row {i}: {sum} against {}", C[i]);
    }
}

#[test]
fn order_conditions_hold() {
    let b = &A[12];
    // Quadrature conditions sum b c^(q-1) = 1/q up to order 8.
    for q in 1..=8 {
        let sum: f64 = (0..STAGES).map(|i| b[i] * C[i].powi(q - 1)).sum();
        assert!((sum - 1.0 / f64::from(q)).abs() < 1e-14, "order {q}: {sum}");
    }
    // sum b_i c_i^p a_ij c_j^r = 1/((r + 1)(p + r + 2)) for the trees of height 3, up to order 8.
    for p in 0..=5 {
        for r in 1..=(6 - p) {
            let sum: f64 =
                (0..STAGES).map(|i| b[i] * C[i].powi(p) * (0..i).map(|j| A[i][j] * C[j].powi(r)).sum::<f64>()).sum();
            let exact = 1.0 / (f64::from(r + 1) * f64::from(p + r + 2));
            assert!((sum - exact).abs() < 1e-13, "p {p}, r {r}: {sum} against {exact}");
        }
    }
    // sum b_i c_i^p a_ij c_j^r a_jk c_k^s = 1/((s + 1)(s + r + 2)(s + r + p + 3)), up to order 8.
    for p in 0..=4i32 {
        for r in 0..=4 - p {
            for s in 1..=(5 - p - r) {
                let inner = |j: usize| (0..j).map(|k| A[j][k] * C[k].powi(s)).sum::<f64>();
                let middle = |i: usize| (0..i).map(|j| A[i][j] * C[j].powi(r) * inner(j)).sum::<f64>();
                let sum: f64 = (0..STAGES).map(|i| b[i] * C[i].powi(p) * middle(i)).sum();
                let exact = 1.0 / (f64::from(s + 1) * f64::from(s + r + 2) * f64::from(s + r + p + 3));
                assert!((sum - exact).abs() < 1e-13, "p {p}, r {r}, s {s}: {sum} against {exact}");
            }
        }
    }
}

#[test]
fn error_estimators_vanish_on_low_degrees() {
    for q in 1..=5 {
        let sum: f64 = (0..STAGES).map(|i| E5[i] * C[i].powi(q - 1)).sum();
        assert!(sum.abs() < 1e-14, "order 5 estimator, degree {q}: {sum}");
    }
    for q in 1..=3 {
        let sum: f64 = (0..STAGES).map(|i| E3[i] * C[i].powi(q - 1)).sum();
        assert!(sum.abs() < 1e-14, "order 3 estimator, degree {q}: {sum}");
    }
    assert!(D.iter().all(|row| row.iter().sum::<f64>().abs() < 1e-12));
}

#[test]
fn quadrature_is_exact_to_degree_seven() {
    let end = |degree| explicitly::<Dop853<1>, _, 1>(&mut power(degree), 0.0, &[0.0], 1.0).end[0];
    for degree in 0..=7 {
        assert!((end(degree) - 1.0 / f64::from(degree + 1)).abs() < 1e-14);
    }
    assert!((end(8) - 1.0 / 9.0).abs() > 1e-7, "degree 8 must show an error");
}

#[test]
fn splitting_keeps_the_step_size_and_the_result() {
    let (whole, _) = run(&mut oscillator, 10.0, 1, 1e-10);
    let (split, integrator) = run(&mut oscillator, 0.01, 1000, 1e-10);
    assert!((whole[0] - split[0]).abs() < 1e-10);
    let work = integrator.statistics();
    assert_eq!(work.accepted, 1000, "one step for each communication step");
    let trials = 4 * work.rejected;
    assert!(work.evaluations <= 12 * 1000 + 2 + trials, "the last derivative is used again: {work:?}");
    assert!(trials < 100, "RK4 is tried rarely: {work:?}");
}

#[test]
fn a_blow_up_is_an_error() {
    struct Blow;
    impl System<1> for Blow {
        fn derivative(&mut self, _t: f64, y: &[f64; 1]) -> [f64; 1] {
            [y[0] * y[0]]
        }
        fn scale(&mut self, y: &[f64; 1], _f: &[f64; 1]) -> [f64; 1] {
            [y[0].abs()]
        }
    }
    let mut y = [1.0];
    let result = Integrator::default().advance(&mut Blow, &mut y, 2.0, 1e-8);
    assert!(matches!(result, Err(IntegrationError::StepTooSmall { t, .. }) if (t - 1.0).abs() < 1e-6));
}
