use super::*;
use crate::mechanism::GEAR;
use crate::mechanism::definition::Mechanism;
use crate::numerics::plane::Vec2;
use crate::numerics::twofold::Twofold;

/// A slider in a turning slot, connected to a rocker: every kind of branch, and a loop with a prismatic joint.
const SLOT: &str = r#"{
  "name": "Slot",
  "bodies": {
    "ground": { "length": 1.0 },
    "arm": { "length": 1.0, "mass": 1, "shape": "uniform_rod" },
    "block": { "mass": 0.3, "inertia": 0.1, "center": [0.1, 0.2], "points": { "pin": [0.2, -0.1] } },
    "rocker": { "length": 0.4, "mass": 2, "shape": "uniform_rod" }
  },
  "joints": {
    "a": { "type": "revolute", "first": "ground.origin", "second": "arm.origin" },
    "slide": { "type": "prismatic", "first": "arm.origin", "second": "block.origin", "axis_angle": 0.3, "angle": 0.2 },
    "b": { "type": "revolute", "first": "block.pin", "second": "rocker.end" },
    "c": { "type": "revolute", "first": "ground.end", "second": "rocker.origin" }
  },
  "start": { "body": "rocker", "angle": 1.0 },
  "guess": { "arm": 0.2, "slide": 0.8, "rocker": 1.0 }
}"#;

fn linkage(text: &str) -> Linkage {
    Linkage::new(&Mechanism::from_json(text).unwrap()).unwrap()
}

#[test]
fn the_gear_has_three_angles_and_one_loop() {
    let gear = linkage(GEAR);
    assert_eq!(gear.coordinates, ["crank", "coupler", "follower"]);
    assert_eq!((gear.angles, gear.rows(), gear.cuts.len()), (3, 2, 1));
    let crank = &gear.bodies[1];
    assert!((crank.mass - (13.689 + 36.8 + 19.5)).abs() < 1e-12);
    // About the pivot A: m2 l2^2/3 + (m5/3 + m5k) l5^2 (PHYSICS, equation of motion in the crank angle).
    let about_pivot = crank.inertia + crank.mass * crank.center.norm_squared();
    let expected = 13.689 * 0.1755f64.powi(2) / 3.0 + (36.8 / 3.0 + 19.5) * 0.759f64.powi(2);
    assert!((about_pivot - expected).abs() < 1e-12 * expected);
}

#[test]
fn a_slot_turns_with_its_slider() {
    let slot = linkage(SLOT);
    assert_eq!(slot.coordinates, ["arm", "rocker", "slide"]);
    let p = slot.positions(&[0.5, 1.0, 0.8]);
    assert!((p.angle[2] - 0.7).abs() < 1e-15, "the block turns with the arm, 0.2 rad ahead");
    let expected = Vec2::new(0.8 * 0.8f64.cos(), 0.8 * 0.8f64.sin());
    assert!((p.origin[2] - expected).norm() < 1e-15, "0.8 m along the axis at 0.5 + 0.3 rad");
}

/// Every rate against a central difference along a random motion q(s) = q0 + s v + s^2 a / 2.
fn rates_are_derivatives(linkage: &Linkage, q: &[f64], v: &[f64], a: &[f64]) {
    let at = |s: f64| -> Vec<f64> { (0..q.len()).map(|i| q[i] + s * v[i] + 0.5 * s * s * a[i]).collect() };
    let h = 1e-5;
    let (before, here, after) = (at(-h), at(0.0), at(h));
    let (p0, p, p1) = (linkage.positions(&before), linkage.positions(&here), linkage.positions(&after));
    let rates = linkage.rates(&p, &here, v);
    let mut second = Rates::default();
    linkage.second_rates_into(&p, &rates, [&here, v, a], &mut second);
    // Error of the differences: h^2 for the first, plus round-off / h^2 = 1e-6 for the second.
    for b in 0..linkage.bodies.len() {
        let point = Point { body: b, local: Vec2::new(0.3, -0.2) };
        let (x0, x, x1) = (p0.point(point), p.point(point), p1.point(point));
        assert!((p.velocity(&rates, point) - (x1 - x0) / (2.0 * h)).norm() < 1e-8);
        assert!((p.acceleration(&rates, &second, point) - (x1 - 2.0 * x + x0) / (h * h)).norm() < 1e-4);
    }
    let (g0, g, g1) = (linkage.gaps(&p0), linkage.gaps(&p), linkage.gaps(&p1));
    let first = linkage.jacobian(&p, &here) * nalgebra::DVector::from_column_slice(v);
    let mut twice = Vec::new();
    linkage.gap_second_rates(&p, (&rates, &second), [v, a], &mut twice);
    for i in 0..g.len() {
        assert!((first[i] - (g1[i] - g0[i]) / (2.0 * h)).abs() < 1e-8);
        assert!((twice[i] - (g1[i] - 2.0 * g[i] + g0[i]) / (h * h)).abs() < 1e-4);
    }
}

#[test]
fn rates_are_derivatives_with_every_kind_of_joint() {
    rates_are_derivatives(&linkage(GEAR), &[0.8, 0.4, 2.4], &[0.3, -0.7, 0.2], &[0.1, 0.2, -0.5]);
    rates_are_derivatives(&linkage(SLOT), &[0.2, 1.0, 0.8], &[0.9, -0.7, 0.4], &[0.1, 0.2, -0.5]);
    // Named the other way round, the slider carries the axis.
    let swapped = SLOT.replace(
        "\"first\": \"arm.origin\", \"second\": \"block.origin\"",
        "\"first\": \"block.pin\", \"second\": \"arm.end\"",
    );
    rates_are_derivatives(&linkage(&swapped), &[0.2, 1.0, 0.8], &[0.9, -0.7, 0.4], &[0.1, 0.2, -0.5]);
    // A prismatic joint that closes a loop of its own: two wedges.
    let wedges = r#"{ "name": "Wedges",
      "bodies": { "ground": {}, "a": { "mass": 1 }, "b": { "mass": 1, "points": { "p": [0.1, 0.3] } } },
      "joints": { "x": { "type": "prismatic", "first": "ground.origin", "second": "a.origin" },
        "y": { "type": "prismatic", "first": "ground.origin", "second": "b.origin", "axis_angle": 1.5 },
        "z": { "type": "prismatic", "first": "a.origin", "second": "b.p", "axis_angle": 0.6 } },
      "start": { "joint": "x", "position": 0 }, "guess": { "x": 0, "y": 0 } }"#;
    let wedges = linkage(wedges);
    assert_eq!((wedges.angles, wedges.rows()), (0, 1));
    rates_are_derivatives(&wedges, &[0.2, 0.4], &[0.9, -0.7], &[0.1, 0.2]);
}

#[test]
fn a_body_that_nothing_holds_is_named() {
    let text = GEAR
        .replace(
            "\"first\": \"crank.end\", \"second\": \"coupler.origin\"",
            "\"first\": \"ground.origin\", \"second\": \"crank.end\"",
        )
        .replace("\"first\": \"coupler.end\"", "\"first\": \"crank.end\"");
    let error = Linkage::new(&Mechanism::from_json(&text).unwrap()).unwrap_err().to_string();
    assert!(error.contains("bodies.coupler") && error.contains("joint"), "{error}");
}

#[test]
fn precise_gaps_are_the_gaps() {
    for (linkage, q) in [(linkage(SLOT), [0.5, 1.0, 0.8]), (linkage(GEAR), [0.8, 1.1, 2.0])] {
        let gaps = linkage.gaps(&linkage.positions(&q));
        let precise = linkage.precise_gaps(&q.map(Twofold::from));
        assert_eq!(gaps.len(), precise.len());
        for (gap, precise) in gaps.iter().zip(&precise) {
            assert!((gap - precise).abs() < 4e-16 && gap.abs() > 1e-3, "{gap} {precise}");
        }
    }
}
