//! The choice between the methods.
use super::radau_iia::VanDerPol;
use super::{Stiff, miss, oscillator, pendulum, run};
use crate::integrator::control::stiffness::largest_eigenvalue;
use crate::integrator::{Integrator, Method, System};

/// Rate of y' = -rate(t) (y - cos t) - sin t with the exact solution cos t. Stiff in the first and last third of 0 <= t
/// <= 30.
fn rate(t: f64) -> f64 {
    let bump = |x: f64| 0.5 * (1.0 + (4.0 * x).tanh());
    1e6 * (1.0 - bump(t - 10.0) + bump(t - 20.0)) + 0.1
}

#[test]
fn the_method_follows_the_stiffness_both_ways() {
    let derivative = |t: f64, y: &[f64; 1]| [-rate(t) * (y[0] - t.cos()) - t.sin()];
    let mut phases = Stiff(derivative, |t: f64, _: &[f64; 1]| [[-rate(t)]]);
    for tolerance in [1e-6, 1e-9, 1e-12] {
        let (mut t, mut y, mut integrator) = (0.0, [1.0], Integrator::default());
        let (mut changes, mut last, mut seen) = (0, Method::Dop853, Vec::new());
        while t < 30.0 {
            let step = integrator.step(&mut phases, t, &y, 30.0, tolerance).unwrap();
            (t, y) = (t + step.h, step.end);
            assert!((y[0] - t.cos()).abs() < 100.0 * tolerance, "t {t}: {:e}", y[0] - t.cos());
            if integrator.method() != last {
                last = integrator.method();
                changes += 1;
                seen.push((t, last));
            }
            if step.reached {
                break;
            }
        }
        println!("{tolerance:e}: {:?} {seen:?}", integrator.statistics());
        let methods: Vec<Method> = seen.iter().map(|(_, method)| *method).collect();
        assert!(methods.starts_with(&[Method::Radau, Method::Dop853]) && methods.ends_with(&[Method::Radau]));
        assert!(changes <= 7, "{changes} changes: {seen:?}");
    }
}

#[test]
fn a_moderately_stiff_problem_rarely_changes_the_method() {
    // Neither method is much better. Changes are rare compared with steps.
    for stiffness in [1e-1, 1e-2, 1e-3] {
        for tolerance in [1e-5, 1e-8, 1e-11] {
            let (mut t, mut y, mut integrator) = (0.0, [2.0, -0.66], Integrator::default());
            let (mut changes, mut last) = (0, Method::Dop853);
            while t < 20.0 {
                let step = integrator.step(&mut VanDerPol(stiffness), t, &y, 20.0, tolerance).unwrap();
                (t, y) = (t + step.h, step.end);
                changes += u32::from(integrator.method() != last);
                last = integrator.method();
                if step.reached {
                    break;
                }
            }
            println!("eps {stiffness}, tolerance {tolerance:e}: {changes} changes, {:?}", integrator.statistics());
            assert!(u64::from(changes) * 10 < integrator.statistics().accepted);
        }
    }
}

/// A copy of the memory gives identical results.
fn advance_twice(system: &mut impl System<2>, y: &mut [f64; 2], integrator: &mut Integrator<2>, h: f64) {
    let (mut z, mut again) = (*y, integrator.clone());
    integrator.advance(system, y, h, 1e-10).unwrap();
    again.advance(system, &mut z, h, 1e-10).unwrap();
    assert_eq!((*y, &*integrator), (z, &again));
}

#[test]
fn a_copied_memory_repeats_the_same_bits() {
    // A body on a rough plane, pushed by sin t, friction with a ramp: v' = sin t - 0.7 sat(v / width); (x, v).
    const WIDTH: f64 = 1e-6;
    let derivative = |t: f64, y: &[f64; 2]| [y[1], t.sin() - 0.7 * (y[1] / WIDTH).clamp(-1.0, 1.0)];
    let slope = |v: f64| if v.abs() < WIDTH { -0.7 / WIDTH } else { 0.0 };
    let mut ramp = Stiff(derivative, |_: f64, y: &[f64; 2]| [[0.0, 1.0], [0.0, slope(y[1])]]);
    let (mut y, mut integrator) = ([0.0, 0.0], Integrator::default());
    (0..200).for_each(|_| advance_twice(&mut ramp, &mut y, &mut integrator, 1e-3));
    // With changes of the span.
    let (mut y, mut integrator, mut seen) = ([1.0, 0.0], Integrator::default(), [false; 2]);
    for i in 0..500 {
        advance_twice(&mut pendulum, &mut y, &mut integrator, [1e-4, 2e-4, 0.05, 3e-3][i / 7 % 4]);
        seen[usize::from(integrator.method() == Method::Rk4)] = true;
    }
    assert_eq!(seen, [true; 2], "RK4 and another method");
}

#[test]
fn a_system_that_cannot_be_stiff_needs_no_jacobian() {
    struct Explicit;
    impl System<1> for Explicit {
        fn derivative(&mut self, _t: f64, y: &[f64; 1]) -> [f64; 1] {
            [-1e4 * y[0]]
        }
        fn scale(&mut self, _y: &[f64; 1], _f: &[f64; 1]) -> [f64; 1] {
            [1.0]
        }
        fn jacobian(&mut self, _t: f64, _y: &[f64; 1]) -> [[f64; 1]; 1] {
            panic!("asked for a Jacobian")
        }
    }
    let mut integrator = Integrator::default();
    integrator.advance(&mut Explicit, &mut [1.0], 1.0, 1e-6).unwrap();
    assert_eq!(integrator.statistics().accepted_by(Method::Radau), 0);
}

/// For every span, 100 rad in many steps are as accurate as in a few steps.
#[test]
fn short_spans_are_as_accurate_as_long_steps() {
    for tolerance in [1e-6, 1e-9, 1e-12] {
        let run = |steps: u32| {
            let h = 100.0 / f64::from(steps);
            let (y, integrator) = run(&mut oscillator, h, steps, tolerance);
            (miss(&y, h * f64::from(steps)), integrator.statistics())
        };
        let (long, _) = run(1);
        let mut seen = [false; 3];
        for k in 0..40 {
            let (error, work) = run((200.0 * 1.2f64.powi(k)) as u32);
            // 1e-13: rounding error of h, summed over the steps.
            assert!(error < 1.3 * long + 1e-13, "{tolerance:e}: {error:e}, in one call {long:e}, {work:?}");
            for (seen, method) in seen.iter_mut().zip([Method::Rk4, Method::Dopri5, Method::Dop853]) {
                *seen |= work.accepted_by(method) > work.accepted / 2;
            }
        }
        assert_eq!(seen, [true; 3], "{tolerance:e}: all methods have been tried");
    }
}

#[test]
fn the_largest_eigenvalue_depends_on_no_units() {
    // (sigma, sigma_dot, energy): eigenvalues of [[0, 1], [-k, -d]] and 0. The energy's unit changes only its row.
    for (k, d, unit) in [(4.0, 1e7, 1.0), (1e6, 3e4, 1e9), (1.0, 1e3, 1e-12)] {
        let a = [[0.0, 1.0, 0.0], [-k, -d, 0.0], [0.3 * unit, 2.0 * d * unit, 0.0]];
        let exact = 0.5 * d + f64::sqrt(0.25 * d * d - k);
        let found = largest_eigenvalue(&a, a.len());
        assert!(found >= 0.999 * exact && found <= 1.15 * exact, "{found} against {exact}");
    }
}
