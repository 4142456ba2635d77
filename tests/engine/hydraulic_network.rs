//! A mechanism with a hydraulic network of two cylinders, as a single system.

use crate::support::{Run, assert_rejected, assert_says, changed, refusal};
use linkage_fmu::mechanism::inspection::inspect;
use serde_json::json;

const ARM: &str = include_str!("../../modelDescription/LiftArm/resources/mechanism.json");
/// States of the arm and its network by an independent program: tests/networks/lift_arm.py, SciPy's DOP853 at 1e-12.
const EXPECTED: &str = include_str!("../networks/lift_arm.txt");

/// The arm under its commands, with this tolerance.
fn lifting(tolerance: f64) -> Run {
    Run::shared(ARM).with(&[("solver.tolerance", tolerance)]).started()
}

/// Name of the variable for a state of the independent program, and the size to which a relative error refers.
fn variable(name: &str, value: f64) -> Option<(String, f64)> {
    let (owner, part) = name.rsplit_once('.').unwrap_or((name, ""));
    Some(match part {
        "a" | "b" => (format!("{owner}.chamber_{part}.pressure"), value + 101_325.0),
        "" => (format!("{name}.pressure"), value + 101_325.0),
        "angle" => (name.to_owned(), 0.1),
        "speed" => (name.to_owned(), 0.1),
        "position" => (name.to_owned(), 0.6),
        _ => return None,
    })
}

#[test]
fn mechanism_and_network_agree_with_an_independent_integration() {
    for step in [1e-3, 1e-2] {
        let (mut arm, mut steps, mut largest) = (lifting(1e-12), 0, 0.0_f64);
        for line in EXPECTED.lines() {
            let [time, name, value] = line.split(' ').collect::<Vec<_>>()[..] else { panic!("{line}") };
            let [time, value] = [time, value].map(|number| number.parse::<f64>().unwrap());
            while f64::from(steps) * step < time - 1e-9 {
                arm.step(step);
                steps += 1;
            }
            let Some((name, size)) = variable(name, value) else { continue };
            let error = (arm.get(&name) - value).abs() / size;
            assert!(error < 1e-9, "{name} at {time} s in steps of {step} s: {error:e}");
            largest = largest.max(error);
        }
        let moved = arm.get("volume.from_reservoirs").abs().max(1e-4);
        assert!(arm.get("volume.balance").abs() < 1e-12 * moved, "{:e}", arm.get("volume.balance"));
        let throttled = arm.get("energy.throttling");
        assert!(arm.get("energy.balance").abs() < 1e-10 * throttled, "{:e}", arm.get("energy.balance"));
        // The arm gains the energy that the cylinders deliver.
        assert!(arm.get("energy.drift").abs() < 1e-9 * arm.get("energy.piston").abs(), "{}", arm.get("energy.drift"));
        println!("steps of {step} s: largest relative error {largest:.1e}");
    }
}

/// A run, its saved state and the bytes of the state continue with the same numbers.
#[test]
fn a_saved_state_continues_as_the_run() {
    let mut arm = lifting(1e-9);
    arm.steps(100, 0.1);
    arm.repeats(|arm| arm.steps(37, 0.05));
}

/// Time derivatives of outputs against finite differences.
#[test]
fn rates_of_outputs_are_those_of_differences() {
    let names = [
        "arm.angle",
        "arm.speed",
        "lift.force",
        "guy.force",
        "lift.chamber_a.pressure",
        "gallery.pressure",
        "pump.flow",
        "lift_valve.position",
        "lift_valve.flow_a",
        "hose.flow",
        "energy.throttling",
        "volume.from_reservoirs",
        "bottle.oil_volume",
        "guy.stiffness",
        "lift.stroke_position",
        "lift.holding_force",
    ];
    let mut arm = lifting(1e-12);
    arm.steps(60, 0.06);
    let h = 2e-5;
    let rates = names.map(|name| arm.derivative(name));
    let before = {
        let mut arm = lifting(1e-12);
        arm.steps(60, 0.06 - h);
        names.map(|name| arm.get(name))
    };
    arm.step(h);
    let after = names.map(|name| arm.get(name));
    for ((name, rate), (one, other)) in names.into_iter().zip(rates).zip(before.into_iter().zip(after)) {
        let difference = (other - one) / (2.0 * h);
        assert!((difference - rate).abs() <= 3e-4 * rate.abs().max(1e-3 * other.abs()), "{name}: {rate} {difference}");
    }
}

/// Derivatives with respect to the inputs of the network against central differences.
#[test]
fn derivatives_by_inputs_are_those_of_differences() {
    let mut arm = lifting(1e-9);
    arm.steps(60, 0.06);
    let find = |arm: &Run, name: &str| arm.variables().find(name).unwrap_or_else(|| panic!("{name}"));
    for (input, seed, outputs) in [
        ("tank.pressure", 1e3, &["lift_valve.return_flow", "pump.flow", "relief.flow", "tank.flow"][..]),
        ("pump.speed", 1e-4, &["pump.flow", "tank.flow"]),
    ] {
        let start = arm.get(input);
        let unknowns: Vec<_> = outputs.iter().map(|name| find(&arm, name)).collect();
        let mut exact = vec![0.0; outputs.len()];
        let known = find(&arm, input);
        arm.directional_derivative(&unknowns, &[known], &[1.0], &mut |i, value| exact[i] = value).unwrap();
        let mut at = |value: f64| {
            arm.set(input, value);
            outputs.iter().map(|name| arm.get(name)).collect::<Vec<_>>()
        };
        let (low, high) = (at(start - seed), at(start + seed));
        arm.set(input, start);
        for (((name, exact), low), high) in outputs.iter().zip(exact).zip(low).zip(high) {
            let difference = (high - low) / (2.0 * seed);
            assert!(
                (difference - exact).abs() <= 1e-5 * exact.abs() + 1e-20,
                "d {name}/d {input}: {exact} {difference}"
            );
        }
    }
}

/// The arm rises until the shorter cylinder reaches its end, rests there, and leaves the end under the opposite
/// command.
#[test]
fn the_ends_of_the_cylinders_hold_the_mechanism() {
    for restitution in [0.0, 0.4] {
        let mut arm = Run::new(changed(ARM, |arm| {
            arm["hydraulics"]["cylinders"]["lift"]["stroke"] = json!(0.36);
            arm["hydraulics"]["cylinders"]["lift"]["restitution"] = json!(restitution);
        }));
        arm.set_all(&[("lift_valve.command", 0.9), ("solver.tolerance", 1e-9)]);
        arm.initialize();
        arm.steps(100, 2.0);
        assert_eq!(arm.get("arm.speed"), 0.0);
        assert!((arm.get("lift.stroke_position") - 0.36).abs() < 1e-12, "{}", arm.get("lift.stroke_position"));
        let [oil, end, load] = ["lift.force", "lift.end_force", "lift.holding_force"].map(|name| arm.get(name));
        assert!(end < -1e3 && (oil + end - load).abs() < 1e-9 * oil, "{oil} {end} {load}");
        assert_eq!(arm.get("guy.end_force"), 0.0);
        assert!(arm.get("volume.balance").abs() < 1e-15 && arm.get("energy.balance").abs() < 1e-5);
        arm.set("lift_valve.command", -0.5);
        arm.steps(100, 0.5);
        assert!(arm.get("lift.stroke_position") < 0.35 && arm.get("lift.end_force") == 0.0);
    }
}

#[test]
fn faulty_networks_are_rejected_with_their_key() {
    assert_rejected("networks", ARM);
    let crowded = changed(ARM, |arm| {
        for k in 0..25 {
            arm["hydraulics"]["nodes"][format!("node{k}")] = json!({ "volume": 1e-4 });
        }
    });
    assert_says(refusal(crowded), &["hydraulics", "components of the state", "37", "two FMUs"]);
    // Numbers may be expressions of parameters.
    let mut arm = Run::new(changed(ARM, |arm| {
        arm["parameters"] = json!({ "size": 2.5e-4 });
        arm["hydraulics"]["nodes"]["gallery"]["volume"] = json!("2 * size");
    }));
    assert_eq!(arm.get("gallery.volume"), 5e-4);
    let mut arm = lifting(1e-9);
    arm.set("tank.pressure", -2e5);
    assert_says(arm.0.step(1e-3).unwrap_err(), &["tank.pressure", "fluid.ambient_pressure"]);
    arm.set("tank.pressure", 0.4e6);
    arm.set("pump.speed", -1.0);
    assert_says(arm.0.step(1e-3).unwrap_err(), &["pump.speed", "0"]);
    arm.set("pump.speed", 1.0);
    arm.set("lift_valve.command", -1.5);
    arm.step(1e-3);
    assert_says(arm.take_warning().unwrap(), &["lift_valve.command is -1.5", "clipped"]);
    arm.step(1e-3);
    assert_eq!(arm.take_warning(), None);
    assert!(arm.0.set("lift.force", 1.0).is_err());
    let warned = Run::new(changed(ARM, |arm| {
        arm["hydraulics"]["cylinders"]["lift"]["reduced_mass"] = json!(10);
        arm["hydraulics"]["solver"] = json!({ "tolerance": 1e-6 });
    }));
    let all = warned.warnings().join("\n");
    assert_says(all, &["hydraulics.cylinders.lift.reduced_mass", "hydraulics.solver", "no effect"]);
}

/// Two runs with different step sizes, and one whose commands change in time by derivatives.
#[test]
fn derivatives_of_inputs_count_and_steps_do_not() {
    let run = |steps: u32| {
        let mut arm = lifting(1e-11);
        let h = 0.2 / f64::from(steps);
        for k in 0..steps {
            // A command beyond its limit: the ramp 0.6 + 4 t is clipped at 1 from 0.1 s on.
            arm.set("lift_valve.command", 0.6 + 4.0 * h * f64::from(k));
            arm.set_derivative("lift_valve.command", 1, 4.0);
            arm.step(h);
        }
        [arm.get("arm.angle"), arm.get("lift.chamber_a.pressure"), arm.get("lift_valve.position")]
    };
    let (few, many) = (run(7), run(200));
    for (one, other) in few.into_iter().zip(many) {
        assert!((one / other - 1.0).abs() < 1e-9, "{few:?} {many:?}");
    }
}

/// An accumulator without oil gets one warning, also across a saved state.
#[test]
fn an_empty_accumulator_gets_one_warning() {
    let mut arm = Run::new(changed(ARM, |arm| {
        arm["hydraulics"].as_object_mut().unwrap().remove("name");
        arm["hydraulics"]["accumulators"]["bottle"]["precharge_pressure"] = json!(16.5e6);
    }));
    arm.set("pump.speed", 0.0);
    arm.initialize();
    arm.step(1e-3);
    assert_eq!(arm.take_warning(), None);
    let before = arm.saved();
    arm.steps(100, 0.5);
    assert_says(arm.take_warning().unwrap(), &["the accumulator bottle contains no oil", "16500000 Pa"]);
    let after = arm.saved();
    arm.steps(100, 0.5);
    assert_eq!(arm.take_warning(), None);
    for (state, warns) in [(after, false), (before, true)] {
        arm.take(&state);
        arm.steps(100, 0.5);
        assert_eq!(arm.take_warning().is_some(), warns);
    }
}

/// Findings of `check` for a network, including a pressure lock whose name is similar to the name of a lock.
#[test]
fn a_check_reports_the_network() {
    let found = inspect(&changed(ARM, |arm| {
        arm["stops"] = json!({ "low": { "body": "arm", "limit": "lower", "angle": 0.1 } });
        arm["locks"] = json!({ "Parking": { "stop": "low", "at": "arm.end", "engage": false } });
    }));
    let value = |topic: &str, of: &str, name: &str| {
        let facts = found.facts.iter().filter(|fact| fact.topic == topic && fact.of == of);
        facts.flat_map(|fact| &fact.quantities).find(|quantity| quantity.name == name).map(|quantity| quantity.value)
    };
    assert_eq!(value("Network", "elements", "cylinders"), Some(2.0));
    assert_eq!(value("Pump", "pump", "largest flow"), Some(2.5e-4));
    assert!(value("Cylinder", "lift", "force at the start").unwrap() > 1e4);
    assert!(value("Accumulator", "bottle", "oil at the start").unwrap() > 1e-4);
    let warnings: Vec<String> = found.findings.iter().map(|finding| finding.to_string()).collect();
    assert_says(warnings.join("\n"), &["hydraulics.pressure_locks.parking", "locks without a pressure lock: Parking"]);
}
