//! Laws of the lift: borders of segments in panels and steps, tables of lift, parameters.
use super::{ROLLER, parsed, translating};
use crate::support::{Run, assert_near, changed};
use linkage_fmu::mechanism::definition::Mechanism;
use linkage_fmu::mechanism::reduced::Reduced;
use serde_json::json;
use std::f64::consts::TAU;

#[test]
fn panels_of_a_cam_end_at_its_segments() {
    let text = translating("polynomial_345", parsed(ROLLER));
    let reduced = Reduced::new(&Mechanism::from_json(&text).unwrap()).unwrap();
    let knots = reduced.curve().law_knots();
    assert_eq!(knots.len(), 4, "one for each border of a segment: {knots:?}");
    let coordinate = reduced.linkage().coordinates.iter().position(|name| name == "disc").unwrap();
    for (sigma, border) in knots.iter().zip([0.0, 1.6, 2.3, 4.5]) {
        let angle = reduced.curve().configuration(*sigma).q[coordinate] - 0.5;
        assert!((angle - border).abs() < 1e-12, "{angle} {border}");
    }
    assert!(reduced.curve().closed < 3000, "{} positions", reduced.curve().closed);
}

#[test]
fn energy_drifts_by_the_tolerance_across_the_borders_of_segments() {
    // Steps end at the borders of segments, where the jerk jumps. The error estimate of a step then contains no jump.
    for law in ["cycloidal", "polynomial_345", "polynomial_4567"] {
        for (tolerance, most) in [(1e-8, 1e-6), (1e-11, 1e-9), (1e-14, 1e-11)] {
            let text = changed(translating(law, parsed(ROLLER)), |m| m["solver"]["tolerance"] = json!(tolerance));
            let mut run = Run::new(&text).started();
            for _ in 0..150 {
                run.step(0.01);
                let drift = run.get("energy.drift");
                assert!(drift.abs() < most, "{law} {tolerance}: {drift}");
            }
        }
    }
}

#[test]
fn borders_end_the_steps_of_a_motion_that_turns_back_or_coasts() {
    // Without a motor the weight of the disc swings the disc across the borders. Without gravity the disc rotates
    // without end.
    for (gravity, speed) in [(9.81, 3.0), (0.0, 40.0)] {
        let text = changed(translating("polynomial_345", parsed(ROLLER)), |m| {
            m["gravity"]["acceleration"] = json!(gravity);
            m["torques"]["motor"]["torque"] = json!(0);
            m["start"]["speed"] = json!(speed);
            m["bodies"]["disc"]["center"] = json!([0.05, 0.0]);
            m["solver"]["tolerance"] = json!(1e-10);
        });
        let mut run = Run::new(&text).started();
        let (mut turned_back, mut other) = (false, run.clone());
        for _ in 0..100 {
            run.step(0.05);
            turned_back |= run.get("disc.speed") < 0.0;
            let drift = run.get("energy.drift");
            assert!(drift.abs() < 1e-8, "{gravity}: {drift}");
        }
        assert_eq!(turned_back, gravity > 0.0);
        // One long step skips whole periods and ends in the same state.
        other.step(5.0);
        for name in ["disc.angle", "disc.speed"] {
            let (one, two) = (run.get(name), other.get(name));
            assert!((one - two).abs() < 1e-6 * one.abs().max(1.0), "{gravity} {name}: {one} {two}");
        }
    }
}

#[test]
fn a_table_lifts_through_its_points_and_comes_back() {
    let points = json!([[0.0, 0.0], [0.8, 0.004], [1.6, 0.015], [2.4, 0.02], [3.2, 0.02], [4.0, 0.008], [5.0, 0.001]]);
    let text = changed(translating("cycloidal", parsed(ROLLER)), |m| {
        let cam = m["couplings"]["cam"].as_object_mut().unwrap();
        cam.remove("segments");
        cam.insert("points".into(), points.clone());
    });
    let height = f64::sqrt(0.05 * 0.05 - 0.012 * 0.012);
    for point in points.as_array().unwrap() {
        let [angle, lift] = [0, 1].map(|k| point[k].as_f64().unwrap());
        let mut run = Run::new(changed(&text, |m| m["start"]["angle"] = json!(angle + 0.5 + TAU))).started();
        assert_near(run.get("guide.position"), -0.14 + height + lift, 1e-14, "position");
    }
    let mut run = Run::new(&text).started();
    for _ in 0..100 {
        run.step(0.01);
        let drift = run.get("energy.drift");
        assert!(drift.abs() < 1e-10 * run.get("energy.kinetic").max(1.0), "{drift}");
    }
}

#[test]
fn parameters_of_a_cam_change_it() {
    let mut run = Run::new(translating("polynomial_345", parsed(ROLLER)));
    run.set("cam.base_radius", 0.06);
    run.set("cam.roller_radius", 0.02);
    run.set("cam.start_angle", 0.1);
    let mut run = run.started();
    let height = f64::sqrt(0.08 * 0.08 - 0.012 * 0.012);
    assert_near(run.get("guide.position"), -0.14 + height, 1e-14, "position");
}
