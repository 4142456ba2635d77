//! Many runs by the energy integral: closed forms, the reference to 34 digits, the steps of the integration.
use crate::support::definition::{With, arm};
use crate::support::{BUCKET, CRANE, FOUR_BAR, GEAR, JIB, SLIDER_CRANK, TWO_DRIVES, changed, reals, without_stops};
use linkage_fmu::simulation::{Runs, Simulation};
use linkage_fmu::variables::Causality;
use serde_json::{Value, json};

const INPUTS: [&str; 2] = ["actuator.force", "load_factor"];

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}

/// Whether each row is at this time, or before at a stop, without steps.
fn are_found(model: &Simulation, inputs: &[&str], rows: &[f64], until: f64) -> Vec<bool> {
    let mut model = model.clone();
    model.initialize().unwrap();
    let references: Vec<_> = inputs.iter().map(|name| model.reference(name).unwrap()).collect();
    let Some(of) = model.model().fast_forward(&references) else { return Vec::new() };
    let mut states = vec![None; rows.len() / inputs.len()];
    of.states(rows, until, &mut states);
    states.iter().map(Option::is_some).collect()
}

/// The same outputs from one step of a simulation of its own, at this tolerance.
fn by_steps(model: &Simulation, inputs: &[&str], row: &[f64], stop: f64, outputs: &[&str], tolerance: f64) -> Vec<f64> {
    let mut own = model.clone();
    own.set("solver.tolerance", tolerance).unwrap();
    inputs.iter().zip(row).for_each(|(name, value)| own.set(name, *value).unwrap());
    own.initialize().unwrap();
    own.step(stop).unwrap();
    outputs.iter().map(|name| own.get(name).unwrap()).collect()
}

fn many(model: &Simulation, inputs: &[&str], rows: &[f64], stop: f64, outputs: &[&str]) -> Runs {
    let runs = model.run_many(inputs, rows, stop, outputs, 1).unwrap();
    assert!(runs.remarks.is_empty(), "{:?}", runs.remarks);
    runs
}

/// The gear at two times of the reference in validation/README.md.
#[test]
fn the_retraction_agrees_with_the_reference_of_34_digits() {
    let gear = Simulation::open(GEAR).unwrap();
    let outputs = ["upstop.impact_time", "crank.angle"];
    let whole = many(&gear, &INPUTS, &[30e3, 3.0], 0.2, &outputs);
    assert!((whole.values[0] - 0.132_059_852_744_259_7).abs() < 1e-15 && whole.values[1] == -1.3, "{whole:?}");
    let part = many(&gear, &INPUTS, &[30e3, 3.0], 0.05, &outputs);
    assert!((part.values[1] - 0.509_301_986_703_906_5).abs() < 1e-14 && part.values[0] == -1.0, "{part:?}");
}

/// A rod under a constant torque turns by t^2 / 2 times its acceleration, in both directions; beyond a revolution by
/// steps. Of an input that is named twice the last value holds.
#[test]
fn a_rod_turns_under_constant_torques() {
    let rod = arm(0.6, 2.0, 0.3).with(json!({ "torques": { "drive": { "on": "arm" } } }));
    let rod = Simulation::open(&rod.to_string()).unwrap();
    let (torques, inertia, stop) = ([0.1, 2.9, 3.1, 9.0, 0.0, -0.7, -2.9, -40.0], 2.0 * 0.6 * 0.6 / 3.0, 1.0);
    let found = are_found(&rod, &["drive.torque"], &torques, stop);
    assert_eq!(found, torques.map(|torque: f64| torque != 0.0 && torque.abs() < 3.0));
    let runs = many(&rod, &["drive.torque"], &torques, stop, &["arm.angle", "arm.speed", "energy.drift"]);
    for (torque, values) in torques.iter().zip(runs.values.chunks(3)) {
        let (angle, speed) = (0.3 + 0.5 * torque / inertia, torque / inertia);
        assert!((values[0] - angle).abs() < 1e-12 * (1.0 + angle.abs()), "{torque}: {values:?} {angle}");
        assert!((values[1] - speed).abs() < 1e-12 * (1.0 + speed.abs()), "{torque}: {values:?} {speed}");
        assert!(values[2].abs() < 1e-12 * (1.0 + torque * torque), "{torque}: {values:?}");
    }
    let twice = many(&rod, &["drive.torque"; 2], &[1.0, 2.0], stop, &["arm.angle"]);
    assert!((twice.values[0] - 0.3 - 0.5 * 2.0 / inertia).abs() < 1e-9, "{twice:?}");
}

/// Scenes with and without stops, with a stop that gives speed back, with a lock at the stop, a spring, an unequal
/// start: outputs agree with steps at the least tolerance, before and after the impact and where a run turns back.
#[test]
fn outputs_are_those_of_the_steps() {
    let spring = changed(GEAR, |gear| {
        gear["springs"] = json!({ "aid": { "first": "crank.actuator", "second": "follower.actuator",
            "stiffness": 2e4, "free_length": 0.5 } });
        gear["start"]["angle"] = json!(0.6);
    });
    let bouncing = changed(GEAR, |gear| gear["stops"]["upstop"]["restitution"] = json!(0.4));
    let locked = changed(GEAR, |gear| gear["locks"]["uplock"]["engage"] = json!(true));
    let rows: Vec<f64> = (0..40).flat_map(|k| [-2e4 + 1.5e3 * f64::from(k), f64::from(k * 11 % 40) / 12.0]).collect();
    let outputs = ["crank.angle", "crank.speed", "joint1.force", "actuator.length", "energy.drift"];
    for (scene, definition) in [GEAR.to_owned(), without_stops(), spring, bouncing, locked].iter().enumerate() {
        let mut model = Simulation::open(definition).unwrap();
        // Behind an impact there are steps.
        model.set("solver.tolerance", 1e-12).unwrap();
        let mut found = 0;
        for stop in [0.02, 0.1, 0.134, 0.3] {
            let runs = many(&model, &INPUTS, &rows, stop, &outputs);
            let is_found = are_found(&model, &INPUTS, &rows, stop);
            found += is_found.iter().filter(|found| **found).count();
            for ((row, values), is_found) in rows.chunks(2).zip(runs.values.chunks(5)).zip(is_found) {
                let tolerance = if is_found { 1e-14 } else { 1e-12 };
                let exact = by_steps(&model, &INPUTS, row, stop, &outputs, tolerance);
                if !is_found {
                    assert_eq!(bits(values), bits(&exact), "scene {scene}, {stop}, {row:?}");
                    continue;
                }
                // rad, rad/s, N, m, J.
                for ((value, exact), allowed) in values.iter().zip(&exact).zip([1e-12, 1e-10, 1e-6, 1e-12, 1e-8]) {
                    assert!((value - exact).abs() < allowed, "scene {scene}, {stop}, {row:?}: {values:?} {exact:?}");
                }
            }
        }
        println!("scene {scene}: {found} of 160 found");
        assert!(found > 50, "scene {scene}: {found}");
    }
}

/// The bits of a run depend neither on its place among the others, nor on their number, nor on the threads.
#[test]
fn a_run_does_not_depend_on_the_others() {
    let gear = Simulation::open(GEAR).unwrap();
    let rows: Vec<f64> = (0..131).flat_map(|k| [1e4 + 250.0 * f64::from(k), 0.02 * f64::from(k * 7 % 131)]).collect();
    let outputs = ["crank.angle", "crank.speed"];
    let all = many(&gear, &INPUTS, &rows, 0.1, &outputs);
    let threads = gear.run_many(&INPUTS, &rows, 0.1, &outputs, 3).unwrap();
    assert_eq!(bits(&all.values), bits(&threads.values));
    let reversed: Vec<f64> = rows.chunks(2).rev().flatten().copied().collect();
    let reversed = many(&gear, &INPUTS, &reversed, 0.1, &outputs);
    for (k, (row, values)) in rows.chunks(2).zip(all.values.chunks(2)).enumerate() {
        assert_eq!(bits(values), bits(&reversed.values[2 * (130 - k)..][..2]), "{k}");
        assert_eq!(bits(values), bits(&many(&gear, &INPUTS, row, 0.1, &outputs).values), "{k}");
    }
}

/// Near the stop rounding would decide, and loads without bounds have no motion: these runs are made by steps. A coarse
/// tolerance of the integration changes nothing.
#[test]
fn runs_that_rounding_would_decide_are_made_by_steps() {
    let mut gear = Simulation::open(GEAR).unwrap();
    let met = 0.132_059_852_744_259_7;
    for (until, is_found) in
        [(met * (1.0 + 1e-10), false), (met * (1.0 + 1e-8), true), (met * (1.0 - 1e-8), true), (1e-60, false)]
    {
        assert_eq!(are_found(&gear, &INPUTS, &[30e3, 3.0], until), [is_found], "{until}");
    }
    let rows = [1e300, 3.0, f64::NAN, 1.0, 30e3, f64::INFINITY, 0.0, 0.0];
    assert_eq!(are_found(&gear, &INPUTS, &rows, 0.2), [false; 4]);
    gear.set("solver.tolerance", 1e-3).unwrap();
    let coarse = many(&gear, &INPUTS, &[30e3, 3.0], 0.2, &["upstop.impact_time"]);
    assert!((coarse.values[0] - met).abs() < 1e-15, "{coarse:?}");
}

/// Loads that the state decides, a start in motion, a lock that holds, inputs that size no load: no function.
#[test]
fn where_the_integral_does_not_hold_there_is_no_function() {
    let gear = Simulation::open(GEAR).unwrap();
    let is_there = |gear: &Simulation, input: &str| !are_found(gear, &[input], &[3e4], 0.1).is_empty();
    assert!(is_there(&gear, "actuator.force") && !is_there(&gear, "airspeed") && !is_there(&gear, "crank.mass"));
    let mut moving = gear.clone();
    moving.set("crank.start_speed", -0.1).unwrap();
    let mut windy = gear.clone();
    windy.set("airspeed", 80.0).unwrap();
    let mut rough = gear.clone();
    rough.set("friction.enabled", true).unwrap();
    let mut held = gear.clone();
    held.set("downlock.engage", true).unwrap();
    for (k, other) in [moving, windy, rough, held].iter().enumerate() {
        assert!(!is_there(other, "actuator.force"), "{k}");
    }
}

/// Runs of other mechanisms without losses agree with steps in all outputs.
#[test]
fn runs_of_other_mechanisms_agree_with_steps_in_all_outputs() {
    let all = [BUCKET, CRANE, FOUR_BAR, JIB, SLIDER_CRANK, TWO_DRIVES].into_iter().zip(0..);
    let mut served = 0;
    for (definition, scene) in all {
        let lossless = changed(definition, |own| {
            if let Some(friction) = own.get_mut("friction") {
                friction["enabled"] = json!(false);
            }
            own["start"]["speed"] = json!(0);
            for drive in own.get_mut("actuators").and_then(Value::as_object_mut).into_iter().flatten() {
                drive.1.as_object_mut().unwrap().remove("efficiency");
            }
        });
        let mut model = Simulation::open(&lossless).unwrap();
        model.set("solver.tolerance", 1e-12).unwrap();
        let name = |reference: u32| model.model().variables().get(reference).unwrap().name.clone();
        let inputs: Vec<String> = reals(model.model(), Causality::Input).into_iter().map(name).collect();
        let outputs: Vec<String> = reals(model.model(), Causality::Output).into_iter().map(name).collect();
        let (outputs, before): (Vec<&str>, _) = (outputs.iter().map(String::as_str).collect(), served);
        for input in inputs {
            let mut own = model.clone();
            let size = own.get(&input).unwrap();
            let rows = [0.0, 0.5, 1.0, 1.5, -1.0].map(|factor| if size == 0.0 { 10.0 * factor } else { size * factor });
            for stop in [1e-3, 0.03, 0.2] {
                let found = are_found(&own, &[&input], &rows, stop);
                if !found.contains(&true) {
                    continue;
                }
                let runs = own.run_many(&[&input], &rows, stop, &outputs, 1).unwrap();
                for (k, row) in rows.iter().enumerate().filter(|(k, _)| found[*k]) {
                    served += 1;
                    let exact = by_steps(&own, &[&input], &[*row], stop, &outputs, 1e-13);
                    for ((value, exact), name) in runs.values[k * outputs.len()..].iter().zip(&exact).zip(&outputs) {
                        let is_near = (value - exact).abs() < 1e-8 * (1.0 + exact.abs());
                        assert!(
                            is_near || value.is_nan() && exact.is_nan(),
                            "scene {scene}, {input} = {row}, {stop}: {name} {value} {exact}"
                        );
                    }
                }
            }
        }
        println!("scene {scene}: {} runs without steps", served - before);
    }
    assert!(served > 100, "{served}");
}
