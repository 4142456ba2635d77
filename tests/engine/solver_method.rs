//! One mechanism in two formulations, the reduced model and rigid finite elements, selected by `solver.method`.

use super::gear_retraction::THETA_013;
use super::rigid_fem::{ELASTIC_LIMIT, heavy_four_bar, strut};
use crate::support::{CHAIN, GEAR, Run, SLIDER_CRANK, assert_says, changed};
use linkage_fmu::mechanism::Model;
use linkage_fmu::variables::{Causality, Kind};
use serde_json::{Value, json};

/// E A of the gear's bodies [N].
const STIFFNESS: [(&str, f64); 3] = [("crank", 2.1e9), ("coupler", 8.937_60e7), ("follower", 3.049_20e8)];

/// The mechanism by rigid finite elements. The E A of the gear is multiplied by `factor`.
fn by_rigid_fem(mut run: Run, factor: f64) -> Run {
    run.set("solver.method", "rigid_fem");
    for (body, stiffness) in STIFFNESS {
        run.set(&format!("{body}.axial_stiffness"), factor * stiffness);
    }
    run
}

fn gear(factor: f64, fem_step: f64) -> Run {
    by_rigid_fem(Run::gear(), factor).with(&[("solver.fem_step", fem_step)])
}

/// theta2 at 0.13 s of scene S1 in steps of 1 ms, minus the exact value for rigid links [rad].
fn deviation(factor: f64, fem_step: f64) -> f64 {
    let mut gear = gear(factor, fem_step).started();
    (0..130).for_each(|_| gear.step(1e-3));
    gear.get("crank.angle") - THETA_013
}

#[test]
fn the_formulations_differ_by_the_strain_of_the_rods() {
    let differs = deviation(1.0, 1e-5);
    // The error of the step is below 4e2 h^2.
    assert!((differs - ELASTIC_LIMIT).abs() < 4e-8 + 1e-9, "{differs:e}");
    let stiffer = deviation(10.0, 1e-5);
    // The error of the step, and the next term of the strain.
    assert!((10.0 * stiffer - differs).abs() < 4e-7 + 3e-3 * differs, "{stiffer:e}");
}

#[test]
fn the_order_in_the_step_is_two() {
    let [coarse, middle, fine] = [5e-4, 2.5e-4, 1.25e-4].map(|h| deviation(1.0, h));
    let order = ((coarse - middle) / (middle - fine)).log2();
    assert!((order - 2.0).abs() < 0.05, "{order}");
    // A step of the host that is shorter than fem_step is made as one step.
    assert_eq!(deviation(1.0, 1.0).to_bits(), deviation(1.0, 1e-3).to_bits());
}

/// For every Real output: name, largest value and largest difference up to now.
fn compare(one: &mut Run, other: &mut Run, seen: &mut Vec<(String, f64, f64)>) {
    let list = one.variables().list().to_vec();
    let outputs = list.iter().filter(|v| v.kind == Kind::Real && v.causality == Causality::Output);
    for (i, v) in outputs.enumerate() {
        let (a, b) = (one.get(&v.name), other.get(&v.name));
        if seen.len() <= i {
            seen.push((v.name.clone(), 0.0, 0.0));
        }
        seen[i].1 = seen[i].1.max(a.abs());
        seen[i].2 = seen[i].2.max((a - b).abs());
    }
}

#[test]
fn every_output_tends_to_that_of_rigid_links() {
    let text = changed(GEAR, |m| {
        let hinge = json!({ "joint": "joint3", "stiffness": 90, "damping": 3 });
        let gas = json!({ "pressure": 2e6, "area": 1e-4, "volume": 7e-5, "exponent": 1.4 });
        let gas = json!({ "first": "ground.origin", "second": "leg.end", "free_length": 0.8, "gas": gas });
        let detent = json!({ "joint": "joint1", "points": [[-3, -60], [-1, -40], [0.2, -20], [0.4, 70], [0.9, 70]] });
        m["springs"] = json!({ "strut": strut(), "hinge": hinge, "gas": gas, "detent": detent });
        m["stops"]["downstop"]["enabled"] = json!(false);
        m["solver"]["tolerance"] = json!(1e-12);
    });
    let worst = |factor: f64| {
        let mut rigid = Run::new(&text).with(&[("crank.torque", 300.0)]).started();
        let mut elastic = by_rigid_fem(rigid.clone(), factor).started();
        let mut seen = Vec::new();
        for _ in 0..10 {
            compare(&mut rigid, &mut elastic, &mut seen);
            [&mut rigid, &mut elastic].into_iter().for_each(|run| run.steps(10, 1e-2));
        }
        seen
    };
    let (soft, stiff) = (worst(10.0), worst(1000.0));
    for ((name, size, far), (.., near)) in soft.iter().zip(&stiff) {
        if name == "energy.drift" {
            // Relative to 1e4 J: error of 2nd order, and rounding in stiff rods.
            assert!(*far < 1e-3 && *near < 1e-2, "{name}: {far:e} {near:e}");
            continue;
        }
        if name.contains("acceleration") || name.starts_with("joint") {
            // Newmark's method without damping: accelerations of vibrations that the step does not resolve change sign
            // in each step, in proportion to h^2.
            assert!(*near < 5e-4 * size.max(1e-6), "{name}: {near:e} of {size:e}");
            continue;
        }
        // The elastic part decreases by a factor of 100. The rest is the error of the step, some 4e2 h^2 of the angles.
        assert!(*near < 0.02 * far + 2e-6 * size.max(1e-3), "{name}: {far:e}, then {near:e} of {size:e}");
        assert!(*near < 1e-4 * size.max(1e-6), "{name}: {near:e} of {size:e}");
    }
}

#[test]
fn outputs_follow_an_input_immediately() {
    let mut elastic = gear(1e5, 1e-4);
    let mut rigid = elastic.clone();
    rigid.set("solver.method", "reduced");
    for model in [&mut rigid, &mut elastic] {
        model.initialize();
        model.step(0.05);
        model.set_all(&[("actuator.force", 33e3), ("load_factor", 2.0), ("actuator.demanded_acceleration", 4.0)]);
    }
    let mut seen = Vec::new();
    compare(&mut rigid, &mut elastic, &mut seen);
    for (name, size, differs) in seen.iter().filter(|(name, ..)| name != "energy.drift") {
        // Accelerations of vibrations that the step does not resolve have an error of (h omega / 2)^-2 of the jump:
        // 1e-5 of some 1e3 rad/s2.
        assert!(*differs < 1e-3 * size.max(1e-3), "{name}: {differs:e} of {size:e}");
    }
    let accelerations = ["crank.acceleration", "joint2.force"].map(|name| elastic.get(name));
    [&mut rigid, &mut elastic].into_iter().for_each(|model| model.step(0.05));
    assert_ne!(accelerations, ["crank.acceleration", "joint2.force"].map(|name| elastic.get(name)));
    let differs = rigid.get("crank.angle") - elastic.get("crank.angle");
    // The difference is some 4e2 h^2.
    assert!(differs.abs() < 4e-6, "{differs:e}");
    // The energy balance includes the work of the jump. The rest is the error of the step, relative to 1e4 J.
    assert!(elastic.get("energy.drift").abs() < 1.0, "{}", elastic.get("energy.drift"));
}

#[test]
fn a_whole_turn_is_counted_and_sigma_found() {
    let heavy = changed(heavy_four_bar(), |m| {
        for body in ["crank", "coupler", "rocker"] {
            m["bodies"][body]["axial_stiffness"] = json!(1e10);
        }
        m["actuators"]["drive"].as_object_mut().unwrap().remove("efficiency");
        m["solver"] = json!({ "tolerance": 1e-11, "method": "reduced" });
    });
    let mut rigid = Run::new(&heavy).started();
    let mut elastic = rigid.clone().with(&[("solver.method", "rigid_fem")]).started();
    let start = rigid.get("crank.angle");
    // One step of the host, in which sigma increases by more than one turn.
    rigid.step(0.4);
    elastic.step(0.4);
    let turned = elastic.get("crank.angle") - start;
    assert!(turned.abs() > 6.3, "{turned}");
    for name in ["crank.angle", "drive.reduced_inertia", "drive.additional_torque"] {
        let (a, b) = (rigid.get(name), elastic.get(name));
        assert!((a - b).abs() < 1e-3 * a.abs().max(1e-3), "{name}: {a} {b}");
    }
}

#[test]
fn laws_without_finite_elements_are_rejected_at_the_start() {
    for flag in ["friction.enabled", "air.relative_wind"] {
        let mut model = gear(1.0, 1e-5).with(&[(flag, true)]);
        let message = model.refusal();
        assert!(message.starts_with(&format!("{flag} = true")) && message.contains("reduced"), "{message}");
        model.set(flag, false);
        model.initialize();
    }
    let mut model = gear(1.0, 1e-5).with(&[("airspeed", 70.0)]);
    assert!(model.refusal().starts_with("airspeed = 70: "));
    model.set("solver.method", "reduced");
    model.initialize();

    let mut model = gear(1.0, 1e-5).with(&[("downlock.engage", true)]);
    assert!(model.refusal().starts_with("downlock.engage = true: "));
    model.set("downlock.engage", false);
    model.set("uplock.engage", true);
    model.initialize();
    model.step(1e-3);

    let by_rigid_fem = |text: &str| Run::new(text).with(&[("solver.method", "rigid_fem")]);
    let bare = changed(GEAR, |m| drop(m["bodies"]["coupler"].as_object_mut().unwrap().remove("axial_stiffness")));
    assert!(by_rigid_fem(&bare).refusal().starts_with("bodies.coupler.axial_stiffness: "));

    let method = |m: &mut Value| m["solver"] = json!({ "tolerance": 1e-9, "method": "rigid_fem" });
    assert_says(Model::from_json(&changed(SLIDER_CRANK, method)).unwrap_err(), &["prismatic"]);
    let mut model = by_rigid_fem(&changed(GEAR, |m| m["actuators"]["actuator"]["efficiency"] = json!(0.9)));
    assert_says(model.refusal(), &["actuator = 0.9", "set the efficiency to 1"]);
    model.set("actuator.efficiency", 1.0);
    model.initialize();
    let ternary = Model::from_json(&changed(CHAIN, method)).unwrap_err().to_string();
    assert!(ternary.starts_with("bodies.") && ternary.contains("axial_stiffness"), "{ternary}");
}

#[test]
fn laws_that_become_active_later_are_rejected_in_that_step() {
    // The up stop is reached at 0.1320598 s with rigid links.
    let mut model = gear(1.0, 1e-5).started();
    model.step(0.13);
    assert!(!model.is("retracted"));
    let bits = |model: &mut Run| {
        ["crank.angle", "crank.acceleration", "joint2.force", "energy.drift"].map(|name| model.get(name).to_bits())
    };
    let before = bits(&mut model);
    let message = model.0.step(5e-3).unwrap_err().to_string();
    let time: f64 = message.split("reaches this stop ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    // A strain of 1e-3 rad at 30 rad/s.
    assert!(message.starts_with("upstop.angle = -1.3 rad: ") && (time - 0.002_059_8).abs() < 3e-5, "{message}");
    assert_eq!(bits(&mut model), before);
    model.step(1e-3);

    // The actuator presses the gear against the down stop from the start on.
    let mut model = gear(1.0, 1e-5).with(&[("actuator.force", -30_000.0)]).started();
    assert!(model.is("extended"));
    let message = model.0.step(1e-3).unwrap_err().to_string();
    assert!(message.starts_with("downstop.angle = 0.8 rad: "), "{message}");
    // The actuator moves the gear off the stop.
    let mut model = gear(1.0, 1e-5).started();
    assert!(model.is("extended"));
    model.step(1e-2);
    assert!(!model.is("extended"));
    // The airspeed becomes nonzero.
    model.set("airspeed", 1.0);
    assert!(model.0.step(1e-3).unwrap_err().to_string().starts_with("airspeed = 1: "));
    model.set("airspeed", 0.0);
    model.step(1e-3);
}
