//! RK4 and DOPRI5: their choice, long runs of steps that are short for DOP853.
use super::{damped, miss, oscillator, pendulum, run};
use crate::integrator::{Integrator, Method};

#[test]
fn a_hundred_thousand_short_steps_keep_the_tolerance() {
    const STEPS: u32 = 100_000;
    for (tolerance, h) in [(1e-9, 1e-3), (1e-9, 1e-4), (1e-12, 1e-4), (1e-12, 1e-5)] {
        let end = f64::from(STEPS) * h;
        let (y, integrator) = run(&mut oscillator, h, STEPS, tolerance);
        let (z, _) = run(&mut pendulum, h, STEPS, tolerance);
        let (w, _) = run(&mut pendulum, end, 1, 1e-14);
        let errors = [miss(&y, end), (z[0] - w[0]).hypot(z[1] - w[1])];
        let work = integrator.statistics();
        // 1e-13: error of the reference, and rounding error of h, summed over the steps.
        assert!(errors.iter().all(|e| *e < tolerance + 1e-13), "{tolerance}, h {h}: {errors:?}");
        assert!(work.accepted_by(Method::Rk4) > 99_000, "{work:?}");
        assert!(work.evaluations < 4 * u64::from(STEPS) + 2000, "{work:?}");
    }
}

#[test]
fn longer_spans_are_left_to_the_method_of_order_eight() {
    for h in [0.03, 0.3] {
        let (y, integrator) = run(&mut oscillator, h, 1000, 1e-11);
        let work = integrator.statistics();
        assert!(work.accepted_by(Method::Rk4) == 0 && work.rejected < 30, "trials are few: {work:?}");
        assert!(miss(&y, 1000.0 * h) < 1e-8);
    }
}

#[test]
fn many_steps_keep_the_tolerance_for_half_the_evaluations() {
    for (tolerance, h, steps) in [(1e-6, 0.1, 1000u32), (1e-9, 0.02, 5000), (1e-12, 5e-3, 20_000)] {
        let (y, integrator) = run(&mut oscillator, h, steps, tolerance);
        let (mut z, mut of_damped, mut worst) = ([1.0, 0.0], Integrator::default(), 0.0_f64);
        let (mut w, mut reference) = ([1.0, 0.0], Integrator::default());
        for _ in 0..2000 {
            of_damped.advance(&mut damped, &mut z, h, tolerance).unwrap();
            reference.advance(&mut damped, &mut w, h, 1e-14).unwrap();
            worst = worst.max((z[0] - w[0]).hypot(z[1] - w[1]));
        }
        let (error, work) = (miss(&y, f64::from(steps) * h), integrator.statistics());
        // 1e-13: error of the reference, and rounding error of h, summed over the steps.
        assert!(error < tolerance + 1e-13 && worst < tolerance + 1e-13, "{tolerance}, h {h}: {error} {worst}");
        assert!(work.accepted_by(Method::Dopri5) > u64::from(steps) * 98 / 100, "{work:?}");
        assert!(work.evaluations < u64::from(steps) * 13 / 2 + 200, "{work:?}");
    }
}
