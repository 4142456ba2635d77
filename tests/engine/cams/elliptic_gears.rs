//! Elliptic gears: closed form of the ratio, and balance of both wheels.
use super::elliptic;
use crate::support::{Run, Vec2, assert_near, turned};
use serde_json::json;
use std::f64::consts::{PI, TAU};

#[test]
fn elliptic_gears_obey_their_closed_form() {
    for (e, lobes, alpha, vertex) in [(0.4, 1.0, 0.35, 0.0), (0.6, 1.0, 0.0, 0.7), (0.2, 2.0, 0.35, -1.0)] {
        let keys = json!({ "eccentricity": e, "lobes": lobes, "pressure_angle": alpha, "vertex_angle": vertex });
        let mut run = Run::new(elliptic(keys)).started();
        // Angles of the first and the second wheel at which the nearest vertex of the first wheel is on the line of
        // centres.
        let theta0 = 0.4 - vertex;
        let gap = |theta: f64, psi: f64| {
            let (a, b) = (0.5 * lobes * theta, 0.5 * lobes * psi);
            b.sin() * a.cos() - (1.0 - e) / (1.0 + e) * a.sin() * b.cos()
        };
        let mated = |theta: f64| 2.0 / lobes * ((1.0 - e) / (1.0 + e) * (0.5 * lobes * theta).tan()).atan();
        let second0 = 2.0 + mated(0.4 - theta0);
        let (mut both, across) = ([false; 2], Vec2::new(0.4_f64.cos(), 0.4_f64.sin()));
        for step in 0..120 {
            run.step(0.05);
            let [theta, psi] = [run.get("one.angle") - theta0, second0 - run.get("two.angle")];
            assert!(gap(theta, psi).abs() < 1e-13 * theta.abs().max(1.0), "{e} {lobes} {theta} {psi}");
            // Speed ratio by the pitch radii: r1 = d (1 - e^2) / (2 (1 + e cos)).
            let (sin, cos) = (lobes * theta).sin_cos();
            let r1 = 0.15 * (1.0 - e * e) / (1.0 + e * cos);
            let ratio = -r1 / (0.3 - r1);
            let (omega, speed) = (run.get("one.speed"), run.get("two.speed"));
            assert_near(speed, ratio * omega, 1e-13 * omega.abs().max(1.0) / (1.0 - e).powi(2), "speed");
            // Euler's equation of each wheel. The lever arms are the pitch radii.
            let [first, second] = ["one", "two"].map(|body| run.get(&format!("{body}.acceleration")));
            let t = run.get("mesh.transmitted_force");
            let size = 50.0 + t.abs() + 0.05 * second.abs() / r1;
            assert_near(0.02 * first, 0.8 + t * r1, 1e-12 * size, "first wheel");
            assert_near(0.05 * second, -0.3 + t * (0.3 - r1), 1e-12 * size, "second wheel");
            // The tangent of the ellipse at the pitch point, and the normal of the flank in contact. A force along the
            // tangent turns the second wheel clockwise.
            let slope = -lobes * e * sin / (1.0 + e * cos);
            let tangent = (turned(across, PI / 2.0) + slope * across).normalize();
            let driven = -t;
            let normal = turned(tangent * driven.signum(), -driven.signum() * alpha);
            let expected = normal * (driven / normal.dot(&turned(across, PI / 2.0)));
            let mesh = run.force("mesh");
            assert!((mesh - expected).norm() < 1e-11 * size, "step {step}: {mesh} {expected}");
            assert!((run.force("a") - mesh).norm() < 1e-11 * size);
            assert!((run.force("b") + mesh).norm() < 1e-11 * size);
            both[usize::from(t > 0.0)] = true;
            let kinetic = run.get("energy.kinetic");
            assert!(run.get("energy.drift").abs() < 1e-10 * kinetic.max(1.0), "{}", run.get("energy.drift"));
        }
        assert_eq!(both, [true; 2], "both flanks bear");
        assert!(run.get("one.angle").abs() > 3.0 * TAU, "several revolutions");
    }
}
