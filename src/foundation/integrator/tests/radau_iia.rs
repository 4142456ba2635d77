//! Radau IIA: coefficients, damping, stiff problems.
use super::{Stiff, implicitly, power};
use crate::integrator::methods::radau::coefficients::{A, ALPHA, BETA, C, E, GAMMA, STAGES, T, T_INVERSE};
use crate::integrator::{Integrator, Method, System};

type Matrix = [[f64; 3]; 3];

fn times(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

fn assert_close(a: &Matrix, b: &Matrix, tolerance: f64) {
    for (x, y) in a.iter().flatten().zip(b.iter().flatten()) {
        assert!((x - y).abs() < tolerance, "{a:?} against {b:?}");
    }
}

const IDENTITY: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

#[test]
fn nodes_are_the_roots_of_the_radau_polynomial() {
    // d^2/dx^2 (x^2 (x - 1)^3) = 2 (x - 1) (10 x^2 - 8 x + 1).
    for c in C {
        assert!(((c - 1.0) * (10.0 * c * c - 8.0 * c + 1.0)).abs() < 1e-15, "{c}");
    }
}

#[test]
fn collocation_and_quadrature_conditions_hold() {
    // C(3): sum_j a_ij c_j^(q-1) = c_i^q / q. B(5): sum_i b_i c_i^(q-1) = 1/q. IV.5.
    for q in 1..=3 {
        for i in 0..STAGES {
            let sum: f64 = (0..STAGES).map(|j| A[i][j] * C[j].powi(q - 1)).sum();
            assert!((sum - C[i].powi(q) / f64::from(q)).abs() < 1e-15, "C({q}), row {i}");
        }
    }
    let quadrature = |q: i32| (0..STAGES).map(|j| A[2][j] * C[j].powi(q - 1)).sum::<f64>() - 1.0 / f64::from(q);
    assert!((1..=5).all(|q| quadrature(q).abs() < 1e-15));
    assert!(quadrature(6).abs() > 1e-3, "order 6 must show an error");
}

#[test]
fn the_transformation_makes_two_blocks_of_the_inverse() {
    assert_close(&times(&T, &T_INVERSE), &IDENTITY, 1e-14);
    // T^-1 A^-1 T = block, that is A T block = T.
    let block = [[GAMMA, 0.0, 0.0], [0.0, ALPHA, -BETA], [0.0, BETA, ALPHA]];
    assert_close(&times(&A, &times(&T, &block)), &T, 1e-14);
}

#[test]
fn the_error_estimate_vanishes_up_to_degree_three() {
    // h f(start) + sum e_i z_i for y = t^q, h = 1: z_i = c_i^q.
    for q in 1..=3 {
        let slope = if q == 1 { 1.0 } else { 0.0 };
        let sum = slope + (0..STAGES).map(|i| E[i] * C[i].powi(q)).sum::<f64>();
        assert!(sum.abs() < 1e-14, "degree {q}: {sum}");
    }
    assert!((0..STAGES).map(|i| E[i] * C[i].powi(4)).sum::<f64>().abs() > 0.01, "degree 4 must show an error");
}

#[test]
fn the_stability_function_is_the_pade_approximant_and_tends_to_zero() {
    // y' = lambda y: R(h lambda) = 1 + h lambda b (I - h lambda A)^-1 (1, 1, 1) is the end of one step from 1.
    let end = |z: f64| {
        let mut linear = Stiff(|_: f64, y: &[f64; 1]| [z * y[0]], |_: f64, _: &[f64; 1]| [[z]]);
        implicitly(&mut linear, 0.0, &[1.0], 1.0).end[0]
    };
    // R(z) = (1 + 2z/5 + z^2/20) / (1 - 3z/5 + 3z^2/20 - z^3/60), IV.5.
    for z in [-0.1_f64, -1.0, -5.0, -30.0, 0.5] {
        let pade = (1.0 + 0.4 * z + 0.05 * z * z) / (1.0 - 0.6 * z + 0.15 * z * z - z.powi(3) / 60.0);
        let end = end(z);
        assert!((end - pade).abs() < 1e-14, "z {z}: {end} against {pade}");
    }
    for z in [-1e3_f64, -1e6, -1e9] {
        let end = end(z);
        assert!(end.abs() < 3.1 / z.abs(), "R({z}) = {end}: R tends to -3/z");
    }
}

#[test]
fn quadrature_is_exact_to_degree_four() {
    for degree in 0..=4 {
        let end = implicitly(&mut power(degree), 0.0, &[0.0], 1.0).end[0];
        assert!((end - 1.0 / f64::from(degree + 1)).abs() < 1e-14);
    }
}

#[test]
fn prothero_and_robinson_is_solved_at_every_stiffness() {
    // y' = lambda (y - sin t) + cos t; exact: sin t. IV.15, eq. (15.1).
    for lambda in [-1e2, -1e4, -1e7] {
        let derivative = |t: f64, y: &[f64; 1]| [lambda * (y[0] - t.sin()) + t.cos()];
        let mut system = Stiff(derivative, |_: f64, _: &[f64; 1]| [[lambda]]);
        for tolerance in [1e-6, 1e-9, 1e-12] {
            let (mut y, mut integrator) = ([0.0], Integrator::default());
            integrator.advance(&mut system, &mut y, 5.0, tolerance).unwrap();
            let error = (y[0] - 5f64.sin()).abs();
            println!("lambda {lambda:e}, tolerance {tolerance:e}: error {error:.1e}, {:?}", integrator.statistics());
            assert!(error < 10.0 * tolerance, "lambda {lambda}, tolerance {tolerance}: {error}");
            assert!(lambda > -1e3 || integrator.method() == Method::Radau);
        }
    }
}

/// eps y'' = (1 - y^2) y' - y as (y, y'), IV.1.
pub struct VanDerPol(pub f64);
impl System<2> for VanDerPol {
    const CAN_BE_STIFF: bool = true;
    fn derivative(&mut self, _t: f64, y: &[f64; 2]) -> [f64; 2] {
        [y[1], ((1.0 - y[0] * y[0]) * y[1] - y[0]) / self.0]
    }
    fn scale(&mut self, y: &[f64; 2], _f: &[f64; 2]) -> [f64; 2] {
        [1.0, y[1].abs().max(1.0)]
    }
    fn jacobian(&mut self, _t: f64, y: &[f64; 2]) -> [[f64; 2]; 2] {
        [[0.0, 1.0], [(-2.0 * y[0] * y[1] - 1.0) / self.0, (1.0 - y[0] * y[0]) / self.0]]
    }
}

#[test]
fn van_der_pol_agrees_with_the_reference() {
    // eps = 1e-6 from (2, 0) to t = 2: Hairer and Wanner's test set, IV.10, reference solution of their homepage.
    let reference = [1.706_167_732_170_483, -0.892_809_701_024_797_5];
    for tolerance in [1e-6, 1e-9, 1e-11] {
        let (mut y, mut integrator) = ([2.0, 0.0], Integrator::default());
        integrator.advance(&mut VanDerPol(1e-6), &mut y, 2.0, tolerance).unwrap();
        let error = (y[0] - reference[0]).abs().max((y[1] - reference[1]).abs());
        println!("{tolerance:e}: {y:?}, error {error:.1e}, {:?}", integrator.statistics());
        assert!(error < 100.0 * tolerance, "tolerance {tolerance}: error {error}");
    }
}

/// A system with the default Jacobian.
struct WithoutJacobian(VanDerPol);
impl System<2> for WithoutJacobian {
    fn derivative(&mut self, t: f64, y: &[f64; 2]) -> [f64; 2] {
        self.0.derivative(t, y)
    }
    fn scale(&mut self, y: &[f64; 2], f: &[f64; 2]) -> [f64; 2] {
        self.0.scale(y, f)
    }
}

#[test]
fn the_default_jacobian_is_close_to_the_exact_one() {
    let (mut exact, y) = (VanDerPol(1e-2), [1.7, -0.3]);
    let (a, b) = (exact.jacobian(0.0, &y), WithoutJacobian(VanDerPol(1e-2)).jacobian(0.0, &y));
    for (a, b) in a.iter().flatten().zip(b.iter().flatten()) {
        assert!((a - b).abs() < 1e-6 * a.abs().max(1.0), "{a} against {b}");
    }
}
