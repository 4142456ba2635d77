//! Tables of cams and of prescribed motions, compared with the law whose points they contain. Acceleration and force
//! converge to those of the law, rests are exact, and a monotone curve is monotone.
use crate::cams::{ROLLER, lift, parsed, translating};
use crate::support::definition::{With, block};
use crate::support::{Run, assert_says, changed, refusal};
use serde_json::{Value, json};
use std::f64::consts::TAU;

/// The cam with points of its law instead of the law.
fn tabulated(law: &str, count: u32, keys: &Value) -> String {
    let points: Vec<_> =
        (0..count).map(|k| TAU * f64::from(k) / f64::from(count)).map(|u| json!([u, lift(law, 0.02, u)[0]])).collect();
    changed(translating(law, parsed(ROLLER)), |m| {
        let cam = m["couplings"]["cam"].as_object_mut().unwrap();
        cam.remove("segments");
        cam.insert("points".into(), points.into());
        cam.extend(keys.as_object().unwrap().clone());
    })
}

/// Largest error of the follower's acceleration with a table at constant cam speed, relative to the largest
/// acceleration of the law.
fn error_of_table(law: &str, count: u32, keys: &Value) -> f64 {
    let mut run = Run::new(tabulated(law, count, keys));
    let mut acceleration = |angle: f64| {
        run.set("disc.start_angle", angle + 0.5);
        run.initialize();
        // s'' w^2, without the part from the cam's own acceleration.
        let slope = run.get("guide.speed") / run.get("disc.speed");
        run.get("guide.acceleration") - slope * run.get("disc.acceleration")
    };
    let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
    for k in 0..180 {
        let angle = TAU * (f64::from(k) + 0.37) / 180.0;
        let exact = lift(law, 0.02, angle)[2] * 40.0 * 40.0;
        worst = worst.max((acceleration(angle) - exact).abs());
        largest = largest.max(exact.abs());
    }
    worst / largest
}

#[test]
fn the_acceleration_of_a_cam_by_points_tends_to_that_of_its_law() {
    // At the borders of segments the third derivative of the cycloid and the fourth derivative of the 4567 polynomial
    // jump.
    for (law, finest, order) in [("polynomial_4567", 5e-4, 1.5), ("cycloidal", 2e-2, 0.8)] {
        let errors = [60, 120, 240].map(|count| error_of_table(law, count, &json!({})));
        println!("{law}: {errors:?}");
        assert!(errors[2] < finest, "{law}: {errors:?}");
        assert!(errors[0] > errors[2] * f64::powf(4.0, order), "{law}: {errors:?}");
    }
    // With a monotone curve the acceleration does not converge.
    let error = error_of_table("polynomial_4567", 240, &json!({ "interpolation": "monotone" }));
    println!("monotone: {error}");
    assert!(error > 0.1, "{error}");
}

/// A mass of 2 kg on a horizontal slide, moved as the drive prescribes.
fn servo_text(motion: &Value) -> Value {
    block(2.0).with(json!({ "actuators": { "servo": { "joint": "slide", "motion": motion } } }))
}

fn servo(motion: &Value) -> Run {
    Run::new(servo_text(motion)).started()
}

#[test]
fn the_force_of_a_motion_by_points_tends_to_that_of_its_law() {
    // Position and acceleration of a 4567 polynomial over 0.8 s, with a rest of 0.1 s before and a rest after it.
    let law = |t: f64| {
        let u = ((t - 0.1) / 0.8).clamp(0.0, 1.0);
        let s = u.powi(4) * (35.0 - 84.0 * u + 70.0 * u * u - 20.0 * u.powi(3));
        [0.3 * s, 0.3 / 0.64 * 420.0 * (u * (1.0 - u)).powi(2) * (1.0 - 2.0 * u)]
    };
    let errors = [20, 40, 80].map(|count: i32| {
        let points: Vec<_> = (0..=count).map(|k| f64::from(k) / f64::from(count)).map(|t| [t, law(t)[0]]).collect();
        let mut run = servo(&json!({ "profile": "table", "points": points }));
        let mut worst = 0.0_f64;
        for k in 1..=100 {
            run.step(0.01);
            worst = worst.max((run.get("servo.acting_force") - 2.0 * law(0.01 * f64::from(k))[1]).abs());
        }
        worst
    });
    println!("{errors:?}");
    // Relative to 7 N.
    assert!(errors[2] < 1e-5, "{errors:?}");
    assert!(errors[0] > 100.0 * errors[2], "{errors:?}");
}

#[test]
fn a_table_is_flat_between_equal_points_and_monotone_on_request() {
    let points = json!([[0, 0], [0.2, 0], [0.3, 1], [0.5, 1], [0.9, 1], [1.0, 0.4], [1.6, 0.2]]);
    let mut run = servo(&json!({ "profile": "table", "points": points }));
    let mut least = f64::INFINITY;
    for k in 1..=150 {
        run.step(0.01);
        let t = 0.01 * f64::from(k);
        let [position, speed, force] =
            ["slide.position", "slide.speed", "servo.acting_force"].map(|name| run.get(name));
        for (from, to, value) in [(0.0, 0.2, 0.0), (0.3, 0.9, 1.0)] {
            if from + 1e-9 < t && t < to - 1e-9 {
                assert!((position - value).abs() < 1e-14 && speed.abs() < 1e-11 && force.abs() < 1e-9, "{t}: {force}");
            }
        }
        least = least.min(position);
    }
    assert!(least < -0.01, "the spline goes beyond its points: {least}");
    let mut run = servo(&json!({ "profile": "table", "points": points, "interpolation": "monotone" }));
    for _ in 1..=150 {
        run.step(0.01);
        let position = run.get("slide.position");
        assert!((-1e-15..=1.0 + 1e-15).contains(&position), "{position}");
    }
}

#[test]
fn a_curve_without_points_is_rejected() {
    let text =
        changed(translating("cycloidal", parsed(ROLLER)), |m| m["couplings"]["cam"]["interpolation"] = json!("spline"));
    assert_says(refusal(&text), &["couplings.cam.interpolation", "this cam has no points"]);
    for (value, pieces) in [("spline", ["motion.interpolation", "this profile"]), ("cubic", ["cubic", "monotone"])] {
        let text = servo_text(&json!({ "profile": "cycloidal", "duration": 1, "distance": 1, "interpolation": value }));
        assert_says(refusal(&text), &pieces);
    }
}
