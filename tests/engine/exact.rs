//! The motion without tables: each evaluation closes the loops and balances the forces anew.

use linkage_fmu::mechanism::Model;

macro_rules! mechanism {
    ($name:literal) => {
        include_str!(concat!("../../modelDescription/", $name, "/resources/mechanism.json"))
    };
}

fn start(text: &str, tables: bool, flags: &[&str], values: &[(&str, f64)]) -> Model {
    let mut model = Model::from_json(text).unwrap();
    let find = |model: &Model, name: &str| model.variables().find(name).unwrap();
    let reference = find(&model, "solver.tables");
    assert!(model.boolean(reference).unwrap(), "tables are the default");
    model.set_boolean(reference, tables).unwrap();
    for flag in flags {
        let reference = find(&model, flag);
        model.set_boolean(reference, true).unwrap();
    }
    for (name, value) in values {
        let reference = find(&model, name);
        model.set_real(reference, *value).unwrap();
    }
    model.initialize().unwrap();
    model
}

fn get(model: &mut Model, name: &str) -> f64 {
    let reference = model.variables().find(name).unwrap();
    model.real(reference).unwrap()
}

/// Both ways, in ten steps over `span`: these outputs agree within `miss` of their size.
fn agree(text: &str, flags: &[&str], values: &[(&str, f64)], span: f64, outputs: &[&str], miss: f64) {
    let values = [values, &[("solver.tolerance", 1e-12)]].concat();
    let mut with = start(text, true, flags, &values);
    let mut without = start(text, false, flags, &values);
    for _ in 0..10 {
        with.step(0.1 * span).unwrap();
        without.step(0.1 * span).unwrap();
        for name in outputs {
            let (a, b) = (get(&mut with, name), get(&mut without, name));
            assert!((a - b).abs() < miss * a.abs().max(1.0), "{name}: {a} with tables, {b} without");
        }
    }
}

const GEAR: &str = mechanism!("LandingGearRetraction");

#[test]
fn the_gear_moves_alike() {
    agree(GEAR, &[], &[], 0.13, &["crank.angle", "crank.speed", "joint2.force"], 1e-11);
    // It is another computation: the last digits differ.
    let mut both = [true, false].map(|tables| start(GEAR, tables, &[], &[]));
    let differ = (0..10).any(|_| {
        both.iter_mut().for_each(|model| model.step(0.01).unwrap());
        let [with, without] = both.each_mut().map(|model| get(model, "crank.speed").to_bits());
        with != without
    });
    assert!(differ);
}

#[test]
fn so_it_does_with_all_that_a_state_decides() {
    let flags = ["friction.enabled", "air.relative_wind"];
    agree(GEAR, &flags, &[("airspeed", 70.0)], 0.13, &["crank.angle", "crank.speed", "joint2.force"], 1e-9);
    // To the up stop and back from it; static friction is stiff at V_S = 1e-5 m/s.
    let slow = [("friction.static_speed", 1e-5), ("upstop.restitution", 0.5)];
    agree(GEAR, &flags[..1], &slow, 0.3, &["crank.angle"], 1e-9);
}

#[test]
fn other_mechanisms_move_alike() {
    let outputs = ["energy.kinetic"];
    agree(mechanism!("AndrewsSqueezer"), &[], &[], 0.03, &outputs, 1e-7);
    agree(mechanism!("SlCrank"), &[], &[], 1.0, &outputs, 1e-9);
    agree(mechanism!("FourBarChain"), &[], &[], 1.0, &outputs, 1e-9);
    agree(mechanism!("CraneJib"), &[], &[], 0.1, &outputs, 1e-9);
    // Full turns of a closed curve.
    agree(mechanism!("FourBar"), &[], &[], 2.0, &outputs, 1e-9);
}

#[test]
fn inputs_that_change_within_a_step_and_saved_states_do_too() {
    let run = |tables: bool| {
        let mut model = start(GEAR, tables, &[], &[("solver.tolerance", 1e-12)]);
        let force = model.variables().find("actuator.force").unwrap();
        model.set_input_derivative(force, 1, -1e5).unwrap();
        model.step(0.03).unwrap();
        let saved = model.snapshot();
        model.step(0.05).unwrap();
        let first = get(&mut model, "crank.angle");
        model.restore(&saved).unwrap();
        model.step(0.05).unwrap();
        assert_eq!(first, get(&mut model, "crank.angle"));
        first
    };
    assert!((run(true) - run(false)).abs() < 1e-11);
}
