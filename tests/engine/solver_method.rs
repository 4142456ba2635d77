//! One mechanism, two formulations: what `solver.method` changes, and what it does not.

#[path = "../fmi2_host/mod.rs"]
mod fmi2_host;

use fmi2_host::Gear;
use linkage_fmu::fmi2::types::Status;
use linkage_fmu::mechanism::Model;
use linkage_fmu::variables::{Causality, Kind};
use serde_json::{Value, json};

const GEAR: &str = include_str!("../../modelDescription/LandingGearRetraction/resources/mechanism.json");
const CHAIN: &str = include_str!("../../modelDescription/FourBarChain/resources/mechanism.json");
const FOUR_BAR: &str = include_str!("../../modelDescription/FourBar/resources/mechanism.json");
const SLIDER: &str = include_str!("../../modelDescription/SliderCrank/resources/mechanism.json");

/// theta2 at 0.13 s with elastic rods less that with rigid ones [rad]: tests/rigid_fem.rs.
const ELASTIC_LIMIT: f64 = 1.389_484e-4;
/// theta2 at 0.13 s of scene S1 [rad]: PHYSICS.
const THETA_013: f64 = -1.237_711_726_689_136_7;
/// E A of the gear's bodies [N].
const STIFFNESS: [(&str, f64); 3] = [("crank", 2.1e9), ("coupler", 8.937_60e7), ("follower", 3.049_20e8)];

fn changed(text: &str, change: impl Fn(&mut Value)) -> String {
    let mut value: Value = serde_json::from_str(text).unwrap();
    change(&mut value);
    value.to_string()
}

fn get(model: &mut Model, name: &str) -> f64 {
    let reference = model.variables().find(name).unwrap_or_else(|| panic!("no variable {name}"));
    model.real(reference).unwrap_or_else(|e| panic!("{name}: {e}"))
}

fn set(model: &mut Model, name: &str, value: f64) {
    let reference = model.variables().find(name).unwrap_or_else(|| panic!("no variable {name}"));
    model.set_real(reference, value).unwrap();
}

fn choose(model: &mut Model, method: &str) {
    let reference = model.variables().find("solver.method").unwrap();
    model.set_text(reference, method).unwrap();
}

fn switch(model: &mut Model, name: &str, value: bool) {
    let reference = model.variables().find(name).unwrap();
    model.set_boolean(reference, value).unwrap();
}

/// The gear by rigid finite elements, E A times `factor`.
fn gear(factor: f64, fem_step: f64) -> Model {
    let mut model = Model::from_json(GEAR).unwrap();
    choose(&mut model, "rigid_fem");
    set(&mut model, "solver.fem_step", fem_step);
    for (body, stiffness) in STIFFNESS {
        set(&mut model, &format!("{body}.axial_stiffness"), factor * stiffness);
    }
    model
}

/// theta2 at 0.13 s of scene S1 through the C interface, less the exact one of rigid links [rad].
fn through_fmi(factor: f64, fem_step: f64) -> f64 {
    let gear = Gear::new();
    assert_eq!(gear.set_text("solver.method", "rigid_fem"), Status::Ok);
    assert_eq!(gear.set("solver.fem_step", fem_step), Status::Ok);
    for (body, stiffness) in STIFFNESS {
        assert_eq!(gear.set(&format!("{body}.axial_stiffness"), factor * stiffness), Status::Ok);
    }
    assert_eq!(gear.initialize(), Status::Ok, "{:?}", gear.log.take());
    for n in 0..130 {
        assert_eq!(gear.step(f64::from(n) * 1e-3, 1e-3), Status::Ok, "{:?}", gear.log.take());
    }
    gear.get("crank.angle").unwrap() - THETA_013
}

#[test]
fn the_formulations_differ_by_the_stretch_of_the_rods() {
    let differs = through_fmi(1.0, 1e-5);
    // The step's error is below 4e2 h^2.
    assert!((differs - ELASTIC_LIMIT).abs() < 4e-8 + 1e-9, "{differs:e}");
    let stiffer = through_fmi(10.0, 1e-5);
    println!("differ by {differs:e}, with ten times the stiffness by {stiffer:e}");
    // The step's error again, and the next term of the stretch.
    assert!((10.0 * stiffer - differs).abs() < 4e-7 + 3e-3 * differs, "{stiffer:e}");
}

#[test]
fn the_order_in_the_step_is_two() {
    let [coarse, middle, fine] = [5e-4, 2.5e-4, 1.25e-4].map(|h| through_fmi(1.0, h));
    let order = ((coarse - middle) / (middle - fine)).log2();
    println!("order {order}");
    assert!((order - 2.0).abs() < 0.05, "{order}");
    // A step of the host that is shorter than fem_step is one step.
    assert_eq!(through_fmi(1.0, 1.0).to_bits(), through_fmi(1.0, 1e-3).to_bits());
}

/// Every Real output: name, largest value so far, largest difference so far.
fn compare(one: &mut Model, other: &mut Model, seen: &mut Vec<(String, f64, f64)>) {
    let list = one.variables().list().to_vec();
    let outputs = list.iter().filter(|v| v.kind == Kind::Real && v.causality == Causality::Output);
    for (i, v) in outputs.enumerate() {
        let (a, b) = (get(one, &v.name), get(other, &v.name));
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
        let spring = json!({ "first": "ground.end", "second": "wheel.origin", "stiffness": 4e3, "damping": 60,
            "free_length": 0.6, "preload": 50 });
        m["springs"] = json!({ "strut": spring, "hinge": { "joint": "joint3", "stiffness": 90, "damping": 3 } });
        m["stops"]["downstop"]["enabled"] = json!(false);
        m["solver"]["tolerance"] = json!(1e-12);
    });
    let worst = |factor: f64| {
        let mut rigid = Model::from_json(&text).unwrap();
        let mut elastic = rigid.clone();
        choose(&mut elastic, "rigid_fem");
        for (body, stiffness) in STIFFNESS {
            set(&mut elastic, &format!("{body}.axial_stiffness"), factor * stiffness);
        }
        let mut seen = Vec::new();
        for model in [&mut rigid, &mut elastic] {
            set(model, "crank.torque", 300.0);
            model.initialize().unwrap();
        }
        for step in 0..100 {
            if step % 10 == 0 {
                compare(&mut rigid, &mut elastic, &mut seen);
            }
            rigid.step(1e-3).unwrap();
            elastic.step(1e-3).unwrap();
        }
        seen
    };
    let (soft, stiff) = (worst(10.0), worst(1000.0));
    for ((name, size, far), (.., near)) in soft.iter().zip(&stiff) {
        println!("{name}: {size:e}, differs by {far:e}, then {near:e}");
        if name == "energy.drift" {
            // Of some 1e4 J; 2nd order, and rounding in stiff rods.
            assert!(*far < 1e-3 && *near < 1e-2, "{name}: {far:e} {near:e}");
            continue;
        }
        if name.contains("acceleration") || name.starts_with("joint") {
            // Newmark's method damps nothing: accelerations of vibrations that the step does not resolve change sign from
            // step to step, in proportion to h^2.
            assert!(*near < 5e-4 * size.max(1e-6), "{name}: {near:e} of {size:e}");
            continue;
        }
        // The elastic part falls by a hundred; the rest is the step's, some 4e2 h^2 of the angles.
        assert!(*near < 0.02 * far + 2e-6 * size.max(1e-3), "{name}: {far:e}, then {near:e} of {size:e}");
        assert!(*near < 1e-4 * size.max(1e-6), "{name}: {near:e} of {size:e}");
    }
}

#[test]
fn outputs_follow_an_input_at_once() {
    let mut elastic = gear(1e5, 1e-4);
    let mut rigid = elastic.clone();
    choose(&mut rigid, "reduced");
    for model in [&mut rigid, &mut elastic] {
        model.initialize().unwrap();
        model.step(0.05).unwrap();
        set(model, "actuator.force", 33_000.0);
        set(model, "load_factor", 2.0);
        set(model, "actuator.demanded_acceleration", 4.0);
    }
    let mut seen = Vec::new();
    compare(&mut rigid, &mut elastic, &mut seen);
    for (name, size, differs) in seen.iter().filter(|(name, ..)| name != "energy.drift") {
        // Vibrations that the step does not resolve take (h omega / 2)^-2 of the jump in the accelerations that the bodies
        // would have without rods: 1e-5 of some 1e3 rad/s2.
        assert!(*differs < 1e-3 * size.max(1e-3), "{name}: {differs:e} of {size:e}");
    }
    let accelerations = ["crank.acceleration", "joint2.force"].map(|name| get(&mut elastic, name));
    for model in [&mut rigid, &mut elastic] {
        model.step(0.05).unwrap();
    }
    assert_ne!(accelerations, ["crank.acceleration", "joint2.force"].map(|name| get(&mut elastic, name)));
    let differs = get(&mut rigid, "crank.angle") - get(&mut elastic, "crank.angle");
    // 4e2 h^2.
    assert!(differs.abs() < 4e-6, "{differs:e}");
    // The work of the jump is booked: what is left is the step's error, of 1e4 J.
    assert!(get(&mut elastic, "energy.drift").abs() < 1.0, "{}", get(&mut elastic, "energy.drift"));
}

#[test]
fn a_whole_turn_is_counted_and_sigma_found() {
    let heavy = changed(FOUR_BAR, |m| {
        for (body, length) in [("crank", 0.1), ("rocker", 0.25)] {
            m["bodies"][body] = json!({ "length": length, "mass": 0.5, "shape": "uniform_rod" });
        }
        for body in ["crank", "coupler", "rocker"] {
            m["bodies"][body]["axial_stiffness"] = json!(1e10);
        }
        m["actuators"]["drive"].as_object_mut().unwrap().remove("efficiency");
        m["start"]["speed"] = json!(25);
        m["solver"] = json!({ "tolerance": 1e-11, "method": "reduced" });
    });
    let mut rigid = Model::from_json(&heavy).unwrap();
    let mut elastic = rigid.clone();
    choose(&mut elastic, "rigid_fem");
    let start = get(&mut rigid, "crank.angle");
    rigid.initialize().unwrap();
    elastic.initialize().unwrap();
    // One step of the host, over which sigma is followed through more than a turn.
    rigid.step(0.4).unwrap();
    elastic.step(0.4).unwrap();
    let turned = get(&mut elastic, "crank.angle") - start;
    assert!(turned.abs() > 6.3, "{turned}");
    for name in ["crank.angle", "drive.reduced_inertia", "drive.additional_torque"] {
        let (a, b) = (get(&mut rigid, name), get(&mut elastic, name));
        assert!((a - b).abs() < 1e-3 * a.abs().max(1e-3), "{name}: {a} {b}");
    }
}

fn refused(model: &mut Model) -> String {
    let message = model.initialize().unwrap_err().to_string();
    println!("{message}");
    message
}

#[test]
fn what_the_finite_elements_have_not_is_refused_at_the_start() {
    for (flag, name) in
        [("friction.enabled", "friction.enabled = true"), ("air.relative_wind", "air.relative_wind = true")]
    {
        let mut model = gear(1.0, 1e-5);
        switch(&mut model, flag, true);
        let message = refused(&mut model);
        assert!(message.starts_with(name) && message.contains("reduced"), "{message}");
        switch(&mut model, flag, false);
        model.initialize().unwrap();
    }
    let mut model = gear(1.0, 1e-5);
    set(&mut model, "airspeed", 70.0);
    assert!(refused(&mut model).starts_with("airspeed = 70: "));
    choose(&mut model, "reduced");
    model.initialize().unwrap();

    let mut model = gear(1.0, 1e-5);
    switch(&mut model, "downlock.engage", true);
    assert!(refused(&mut model).starts_with("downlock.engage = true: "));
    switch(&mut model, "downlock.engage", false);
    switch(&mut model, "uplock.engage", true);
    model.initialize().unwrap();
    model.step(1e-3).unwrap();

    let bare = changed(GEAR, |m| {
        m["bodies"]["coupler"].as_object_mut().unwrap().remove("axial_stiffness");
    });
    let mut model = Model::from_json(&bare).unwrap();
    choose(&mut model, "rigid_fem");
    assert!(refused(&mut model).starts_with("bodies.coupler.axial_stiffness: "));

    let method = |m: &mut Value| m["solver"] = json!({ "tolerance": 1e-9, "method": "rigid_fem" });
    let message = Model::from_json(&changed(SLIDER, method)).unwrap_err().to_string();
    assert!(message.contains("prismatic"), "{message}");
    let lossy = changed(GEAR, |m| m["actuators"]["actuator"]["efficiency"] = json!(0.9));
    let mut model = Model::from_json(&lossy).unwrap();
    choose(&mut model, "rigid_fem");
    let message = refused(&mut model);
    assert!(message.contains("actuator = 0.9") && message.contains("set it to 1"), "{message}");
    set(&mut model, "actuator.efficiency", 1.0);
    model.initialize().unwrap();
    let ternary = Model::from_json(&changed(CHAIN, method)).unwrap_err().to_string();
    assert!(ternary.starts_with("bodies.") && ternary.contains("axial_stiffness"), "{ternary}");
}

#[test]
fn what_begins_to_act_later_is_refused_in_that_step() {
    // The up stop, at 0.1320598 s for rigid links.
    let mut model = gear(1.0, 1e-5);
    model.initialize().unwrap();
    model.step(0.13).unwrap();
    let flag = |model: &mut Model, name: &str| {
        let reference = model.variables().find(name).unwrap();
        model.boolean(reference).unwrap()
    };
    assert!(!flag(&mut model, "retracted"));
    let before: Vec<u64> = ["crank.angle", "crank.acceleration", "joint2.force", "energy.drift"]
        .map(|name| get(&mut model, name).to_bits())
        .to_vec();
    let message = model.step(5e-3).unwrap_err().to_string();
    println!("{message}");
    let time: f64 = message.split("reached ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    // 1e-3 rad of stretch at 30 rad/s.
    assert!(message.starts_with("upstop.angle = -1.3: ") && (time - 0.002_059_8).abs() < 3e-5, "{message}");
    let after: Vec<u64> = ["crank.angle", "crank.acceleration", "joint2.force", "energy.drift"]
        .map(|name| get(&mut model, name).to_bits())
        .to_vec();
    assert_eq!(before, after);
    model.step(1e-3).unwrap();

    // Pressed against the down stop from the start.
    let mut model = gear(1.0, 1e-5);
    set(&mut model, "actuator.force", -30_000.0);
    model.initialize().unwrap();
    assert!(flag(&mut model, "extended"));
    let message = model.step(1e-3).unwrap_err().to_string();
    println!("{message}");
    assert!(message.starts_with("downstop.angle = 0.8: "), "{message}");
    // Away from it.
    let mut model = gear(1.0, 1e-5);
    model.initialize().unwrap();
    assert!(flag(&mut model, "extended"));
    model.step(1e-2).unwrap();
    assert!(!flag(&mut model, "extended"));
    // Air that begins to flow.
    set(&mut model, "airspeed", 1.0);
    assert!(model.step(1e-3).unwrap_err().to_string().starts_with("airspeed = 1: "));
    set(&mut model, "airspeed", 0.0);
    model.step(1e-3).unwrap();
}
