//! Steps of Radau that share a Jacobian.
use super::*;

/// y' = -L (y^3 - cos^3 t) - sin t, with the solution cos t: stiff where y is not near 0.
struct Stiff;

impl System<1> for Stiff {
    const CAN_BE_STIFF: bool = true;

    fn derivative(&mut self, t: f64, y: &[f64; 1]) -> [f64; 1] {
        [-1e5 * (y[0].powi(3) - t.cos().powi(3)) - t.sin()]
    }

    fn scale(&mut self, _y: &[f64; 1], _f: &[f64; 1]) -> [f64; 1] {
        [1.0]
    }
}

/// Spans of 10 ms from 0 to 1 s: error and Jacobians.
fn run(mut integrator: Integrator<1>) -> (f64, u64) {
    let (mut t, mut y) = (0.0, [1.0]);
    for k in 1..=100 {
        let end = f64::from(k) * 0.01;
        while t < end {
            let step = integrator.step(&mut Stiff, t, &y, end, 1e-6).unwrap();
            (y, t) = (step.end, if step.reached { end } else { t + step.h });
        }
    }
    ((y[0] - t.cos()).abs(), integrator.statistics().jacobians)
}

#[test]
fn a_jacobian_that_is_kept_serves_many_steps_as_exactly() {
    let ((error, each), (error_kept, kept)) = (run(Integrator::default()), run(Integrator::keeping()));
    println!("{error:e} with {each}, {error_kept:e} with {kept}");
    assert!(error < 1e-6 && error_kept < 1e-6, "{error:e} {error_kept:e}");
    assert!(each > 90 && kept * 3 < each, "{each} {kept}");
}
