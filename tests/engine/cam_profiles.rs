//! Profiles of cams and pitch curves of elliptic gears: curvature against finite differences, drawn curves, warnings.

use crate::cams::{ROLLER, elliptic, oscillating, parsed, translating};
use crate::support::{Run, assert_says, changed};
use linkage_fmu::mechanism::definition::Mechanism;
use linkage_fmu::mechanism::inspection::Scene;
use linkage_fmu::mechanism::linkage::{Kind, Linkage};
use nalgebra::{Matrix3, Vector3};
use serde_json::json;
use std::f64::consts::TAU;

fn linkage(text: &str) -> Linkage {
    Linkage::new(&Mechanism::from_json(text).unwrap()).unwrap()
}

#[test]
fn the_radius_of_curvature_is_that_of_the_profile() {
    let h = 1e-4;
    let flat = || json!({ "follower": "flat" });
    let law = "polynomial_4567";
    for text in [
        translating(law, parsed(ROLLER)),
        translating(law, flat()),
        oscillating(law, parsed(ROLLER)),
        oscillating(law, flat()),
    ] {
        let linkage = linkage(&text);
        let coupling = &linkage.couplings[0];
        let Kind::Cam(cam) = &coupling.kind else { panic!("a cam") };
        let point = |u1: f64| {
            let [u2, slope, _] = coupling.law.at(u1);
            cam.profile(u1, [u2, slope])
        };
        let mut compared = 0;
        for k in 0..400 {
            let u1 = TAU * f64::from(k) / 400.0;
            if coupling.law.next_knot(u1 - 3.0 * h, true, 0.0) < 6.0 * h {
                continue;
            }
            let [before, now, after] = [-h, 0.0, h].map(|h| point(u1 + h));
            let (first, second) = ((after - before) / (2.0 * h), (after - 2.0 * now + before) / (h * h));
            let curvature = first.perp(&second).abs() / first.norm().powi(3);
            let radius = (cam.radius_of_curvature(coupling.law.at(u1)) - cam.roller).abs();
            if radius < 2e-3 {
                continue;
            }
            assert!((curvature - 1.0 / radius).abs() < 1e-3 / radius.min(1.0), "{u1}: {} {radius}", 1.0 / curvature);
            compared += 1;
        }
        assert!(compared > 300, "{compared}");
    }
}

#[test]
fn impossible_cam_profiles_give_a_warning() {
    let warnings_of = |text: &str| {
        let all = Run::new(text).started().warnings();
        all.into_iter().filter(|line| line.contains("couplings")).collect::<Vec<_>>()
    };
    let with = |follower: serde_json::Value| translating("polynomial_345", follower);
    assert!(warnings_of(&with(parsed(ROLLER))).is_empty());
    assert!(warnings_of(&with(json!({ "follower": "flat" }))).is_empty());
    let sharp = warnings_of(&with(json!({ "follower": "roller", "roller_radius": 0.018, "base_radius": 0.004 })));
    assert_eq!(sharp.len(), 2, "{sharp:?}");
    assert_says(&sharp[0], &["couplings.cam", "undercut", "0.018 m", "base_radius"]);
    assert_says(&sharp[1], &["couplings.cam", "pressure angle", "30 deg"]);
    let hollow = warnings_of(&with(json!({ "follower": "flat", "base_radius": 0.02 })));
    assert_says(&hollow[0], &["undercut", "flat face"]);
}

#[test]
fn pitch_curves_of_elliptic_gears_are_ellipses_about_a_focus() {
    let e = 0.4;
    let text = elliptic(json!({ "eccentricity": e }));
    let mechanism = Mechanism::from_json(&text).unwrap();
    let scene = Scene::new(&mechanism, &Linkage::new(&mechanism).unwrap()).unwrap();
    assert_eq!(scene.outlines.len(), 2);
    for (wheel, outline) in scene.outlines.iter().enumerate() {
        // 1 / r = (1 + e cos(psi - vertex)) / p of an ellipse about a focus, with p = a (1 - e^2), is linear in the
        // direction.
        let rows: Vec<Vector3<f64>> =
            outline.points.iter().map(|[x, y]| Vector3::new(1.0, x / x.hypot(*y), y / x.hypot(*y))).collect();
        let inverse: Vec<f64> = outline.points.iter().map(|[x, y]| 1.0 / x.hypot(*y)).collect();
        let chosen = [0, 50, 120];
        let matrix = Matrix3::from_rows(&chosen.map(|k| rows[k].transpose()));
        let known = matrix.try_inverse().unwrap() * Vector3::from(chosen.map(|k| inverse[k]));
        assert!((known[0] * 0.15 * (1.0 - e * e) - 1.0).abs() < 1e-12, "{known}");
        assert!((known[1].hypot(known[2]) / known[0] - e).abs() < 1e-12, "{known}");
        assert!(wheel == 1 || known[2].abs() < 1e-12 && known[1] > 0.0, "the nearest vertex is on the x axis");
        for (row, inverse) in rows.iter().zip(&inverse) {
            assert!((row.dot(&known) - inverse).abs() < 1e-11, "{wheel}: {row} {inverse}");
        }
    }
    let cam = Mechanism::from_json(&translating("cycloidal", parsed(ROLLER))).unwrap();
    let scene = Scene::new(&cam, &Linkage::new(&cam).unwrap()).unwrap();
    let least = scene.outlines[0].points.iter().map(|[x, y]| x.hypot(*y)).fold(f64::INFINITY, f64::min);
    assert!((least - 0.04).abs() < 1e-14, "the base circle is the least of the profile: {least}");
}

#[test]
fn racks_and_belts_are_drawn_where_they_touch_their_wheels() {
    let winch = include_str!("../../modelDescription/GearTrain/resources/mechanism.json");
    let outlines = |text: &str| {
        let mechanism = Mechanism::from_json(text).unwrap();
        Scene::new(&mechanism, &Linkage::new(&mechanism).unwrap()).unwrap().outlines
    };
    let named = |text: &str, name: &str| outlines(text).into_iter().filter(|o| o.name == name).collect::<Vec<_>>();
    // The drum is at x = 0.12 and has the radius 0.09. All bodies have the angle 0, except a turned rail.
    for (x, side, at) in [(0.21, "right", 0.0), (0.25, "left", -0.22), (0.25, "right", -0.04)] {
        let text = changed(winch, |m| {
            m["bodies"]["ground"]["points"]["rail"][0] = json!(x);
            m["couplings"]["lift"]["side"] = json!(side);
        });
        let [wheel, rack] = &named(&text, "lift")[..] else { panic!() };
        assert!(wheel.points[1..].iter().all(|[x, y]| (x.hypot(*y) - 0.09).abs() < 1e-15));
        assert!(rack.points.iter().all(|[x, _]| (x - at).abs() < 1e-15), "{side}: {:?}", rack.points);
    }
    let [one, two] = &named(winch, "first_stage")[..] else { panic!() };
    for (wheel, radius) in [(one, 0.03), (two, 0.09)] {
        assert!(wheel.points[1..].iter().all(|[x, y]| (x.hypot(*y) - radius).abs() < 1e-15));
    }
    for crossed in [false, true] {
        let text = changed(winch, |m| {
            m["couplings"]["second_stage"] = json!({ "type": "belt", "first": "layshaft.origin",
                "second": "drum.origin",
                "first_radius": 0.04, "second_radius": 0.06, "crossed": crossed });
        });
        let all = named(&text, "second_stage");
        assert_eq!(all.len(), 4);
        for span in &all[2..] {
            let [[ax, ay], [bx, by]] = span.points[..] else { panic!() };
            // The line is tangent to both pulleys: the radii at its ends have the right lengths and are normal to the
            // line.
            for ([x, y], [cx, cy], radius) in [([ax, ay], [0.12, 0.0], 0.04), ([bx, by], [0.12, 0.18], 0.06)] {
                assert!(((x - cx).hypot(y - cy) - radius).abs() < 1e-15);
                assert!(((x - cx) * (bx - ax) + (y - cy) * (by - ay)).abs() < 1e-16);
            }
            let side = |x: f64| (x - 0.12).signum();
            assert_eq!(side(ax) == side(bx), !crossed);
        }
    }
}
