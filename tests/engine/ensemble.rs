//! Many runs on several threads: each run is bit-identical to a separate simulation. A failed run does not affect
//! others.

use crate::support::{GEAR, HYDRAULIC_GEAR};
use linkage_fmu::component::Component;
use linkage_fmu::simulation::{Ensemble, Simulation, SimulationError};

const INPUTS: [&str; 2] = ["actuator.force", "load_factor"];
const OUTPUTS: [&str; 3] = ["crank.angle", "retracted", "upstop.impact_time"];

/// Forces [N] and load factors of 150 runs, which are more than two chunks for each of three threads.
fn rows() -> Vec<f64> {
    (0..150).flat_map(|k| [1.5e4 + 200.0 * f64::from(k), 1.0 + 0.01 * f64::from(k % 7)]).collect()
}

fn alone(row: &[f64], stop_time: f64) -> Vec<u64> {
    let mut gear = Simulation::open(GEAR).unwrap();
    gear.set("friction.enabled", true).unwrap();
    gear.set("actuator.force", row[0]).unwrap();
    gear.set("load_factor", row[1]).unwrap();
    gear.initialize().unwrap();
    gear.step(stop_time).unwrap();
    let flag = f64::from(u8::from(gear.boolean("retracted").unwrap()));
    [gear.get("crank.angle").unwrap(), flag, gear.get("upstop.impact_time").unwrap()].map(f64::to_bits).to_vec()
}

#[test]
fn each_run_is_bit_identical_to_a_separate_simulation() {
    let mut gear = Simulation::open(GEAR).unwrap();
    gear.set("friction.enabled", true).unwrap();
    let rows = rows();
    let runs = [1, 3].map(|threads| gear.run_many(&INPUTS, &rows, 0.14, &OUTPUTS, threads).unwrap());
    for (row, values) in rows.chunks(2).zip(runs[0].values.chunks(3)) {
        assert_eq!(values.iter().map(|value| value.to_bits()).collect::<Vec<_>>(), alone(row, 0.14), "{row:?}");
    }
    let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&runs[0].values), bits(&runs[1].values));
    assert!(runs[0].values[1] == 0.0 && runs[0].values[3 * 149 + 1] == 1.0 && runs[0].remarks.is_empty());
}

#[test]
fn an_output_without_a_value_is_named() {
    let mut gear = Simulation::open(GEAR).unwrap();
    gear.set("friction.enabled", true).unwrap();
    let outputs = ["actuator.breakaway_force_forward", "crank.angle"];
    let runs = gear.run_many(&["friction.static_coefficient"], &[0.2, 8.0], 0.0, &outputs, 1).unwrap();
    assert!(runs.values[0].is_finite() && runs.values[2].is_nan() && runs.values[1] == runs.values[3]);
    let [(1, why)] = &runs.remarks[..] else { panic!("{:?}", runs.remarks) };
    assert!(why.starts_with("actuator.breakaway_force_forward: friction locks the mechanism"), "{why}");
}

#[test]
fn a_run_that_fails_harms_no_other() {
    let gear = Simulation::open(GEAR).unwrap();
    let mut rows = rows();
    rows[2 * 70] = f64::NAN;
    let runs = gear.run_many(&INPUTS, &rows, 0.14, &OUTPUTS[..2], 2).unwrap();
    assert!(runs.values[2 * 70].is_nan() && runs.values[2 * 70 + 1].is_nan());
    assert!(runs.remarks.len() == 1 && runs.remarks[0].0 == 70, "{:?}", runs.remarks);
    assert!(runs.remarks[0].1.contains("actuator.force"), "{:?}", runs.remarks);
    rows[2 * 70] = rows[2 * 71];
    let whole = gear.run_many(&INPUTS, &rows, 0.14, &OUTPUTS[..2], 2).unwrap();
    assert_eq!(runs.values[2 * 71..], whole.values[2 * 71..]);
}

#[test]
fn outputs_at_the_start_need_no_step() {
    let gear = Simulation::open(GEAR).unwrap();
    let outputs = ["actuator.holding_force", "crank.angle"];
    let runs = gear.run_many(&["load_factor"], &[1.0, 2.0, 3.0], 0.0, &outputs, 2).unwrap();
    let [one, _, two, _, three, _] = runs.values[..] else { panic!("{runs:?}") };
    // The holding force is linear in the load factor.
    assert!(one != two && ((three - two) / (two - one) - 1.0).abs() < 1e-9, "{runs:?}");
    assert!(runs.values[1] == runs.values[5] && runs.remarks.is_empty());
}

#[test]
fn impossible_variations_are_rejected_immediately() {
    let gear = Simulation::open(GEAR).unwrap();
    let run = |inputs: &[&str], rows: &[f64], stop| gear.run_many(inputs, rows, stop, &["crank.angle"], 1).unwrap_err();
    assert!(matches!(run(&["crank.angle"], &[1.0], 0.1), SimulationError::Refused(why) if why.contains("crank.angle")));
    assert!(matches!(run(&["friction.enabled"], &[1.0], 0.1), SimulationError::Refused(_)));
    assert!(matches!(run(&["actuator.forces"], &[1.0], 0.1), SimulationError::Name { .. }));
    assert!(matches!(run(&INPUTS, &[1.0; 3], 0.1), SimulationError::Rows { values: 3, inputs: 2 }));
    assert!(matches!(run(&["load_factor"], &[1.0], -0.1), SimulationError::Span { .. }));
}

#[test]
fn runs_end_on_request() {
    let mut model = Component::from_definition("mechanism.json", HYDRAULIC_GEAR).unwrap();
    model.initialize().unwrap();
    let interface = model.interface();
    let [command, angle] = ["valve.command", "crank.angle"].map(|name| interface.find(name).unwrap());
    let ensemble = Ensemble { model: &model, varied: &[command], outputs: &[angle], stop_time: 1e-3 };
    let rows = vec![1.0; 100_000];
    let runs = ensemble.run(&rows, 2, |finished| finished > 0).unwrap();
    assert!(runs.values[0].is_finite() && runs.values[99_999].is_nan());
}
