//! Directional derivatives and derivatives of outputs, against differences and closed forms.

use crate::cams::{ROLLER, oscillating, parsed};
use crate::characteristics::{POINTS, carriage, gas as gas_spring};
use crate::conveyor;
use crate::couplings::{GEARS, shafts};
use crate::friction_contacts::TEETH;
use crate::losses;
use crate::screws;
use crate::slots;
use crate::support::definition::{With, friction};
use crate::support::{
    ANDREWS, CRANE, CURVES, FOUR_BAR, GEAR, HYDRAULIC_GEAR, JIB, Run, SL_CRANK, SLIDER_CRANK, TWO_DRIVES, changed,
    reals, values,
};
use linkage_fmu::mechanism::Model;
use linkage_fmu::variables::{Causality, Reference};
use serde_json::{Value, json};

fn directional(model: &mut Model, unknowns: &[Reference], knowns: &[Reference], seeds: &[f64]) -> Vec<f64> {
    let mut values = vec![f64::NAN; unknowns.len()];
    model.directional_derivative(unknowns, knowns, seeds, &mut |i, value| values[i] = value).unwrap();
    values
}

/// A slider-crank with a controlled drive with losses, a second controlled drive, a rotor and constant friction.
fn controlled(speed: f64) -> String {
    changed(TWO_DRIVES, |m| {
        m["actuators"]["ram"]["control"] = json!({ "position_gain": 900, "speed_gain": 20, "command": 0.3 });
        m["actuators"]["servo"]["efficiency"] = json!(0.8);
        m["actuators"]["servo"]["control"] =
            json!({ "position_gain": 4, "speed_gain": 0.3, "command": 2.5, "max_force": 9 });
        m["joints"]["pin"]["armature"] = json!(0.004);
        m["joints"]["pin"]["frictionloss"] = json!(0.2);
        m["joints"]["wrist"]["frictionloss"] = json!(0.1);
        m["friction"]["law"] = json!("stick");
        m["start"]["speed"] = json!(speed);
    })
}

/// A spring and a drive between two bodies without a common joint.
fn between_bodies() -> Value {
    json!({
        "springs": { "band": { "first_body": "ground", "second_body": "coupler", "stiffness": 3, "damping": 0.2 },
            "along": { "joint": "c", "stiffness": 20, "damping": 0.1 } },
        "actuators": { "gear": { "first_body": "coupler", "second_body": "ground", "torque": 0.3, "efficiency": 0.8 } },
    })
}

/// States at which derivatives are compared.
fn states() -> Vec<(String, Run)> {
    let mut all = Vec::new();
    let texts = [GEAR, ANDREWS, SLIDER_CRANK, CRANE, FOUR_BAR, JIB, SL_CRANK];
    for (name, text) in "gear squeezer slider-crank crane four-bar jib SlCrank".split(' ').zip(texts) {
        let mut run = Run::new(text).started();
        all.push((format!("{name} at its start"), run.clone()));
        // A state well within the travel.
        run.step(0.013);
        all.push((format!("{name} in motion"), run));
    }
    for (name, friction, wind, airspeed) in
        [("friction", true, false, 0.0), ("wind", false, true, 40.0), ("friction and wind", true, true, -30.0)]
    {
        let flags = [("friction.enabled", friction), ("air.relative_wind", wind)];
        let mut run = Run::gear().with(&flags).with(&[("airspeed", airspeed)]).started();
        for (what, h) in [("start", 1e-6), ("middle", 0.05), ("fast", 0.05)] {
            run.step(h);
            all.push((format!("gear, {name}, {what}"), run.clone()));
        }
    }
    // Drives with an efficiency: driving, driven back, and holding the gear at rest. A bumper in contact.
    let gear = Run::new(GEAR.replace("\"force\": 30000", "\"force\": 30000, \"efficiency\": 0.6"));
    for (what, force, h) in [("driving", 30_000.0, 0.05), ("driven back", -500.0, 0.05), ("holding", -2_500.0, 0.01)] {
        let settings = [("crank.start_angle", 0.5), ("load_factor", 3.0), ("actuator.force", force)];
        let mut run = gear.clone().with(&settings).started();
        run.step(h);
        all.push((format!("gear with an efficiency, {what}"), run));
    }
    // A drive with losses next to another drive: held by the losses, in motion, with friction.
    let two = Run::new(changed(TWO_DRIVES, |m| {
        m["actuators"]["ram"]["efficiency"] = json!(0.5);
        m["friction"] = json!({ "static_coefficient": 0.1, "kinetic_coefficient": 0.08 });
    }));
    for (what, torque, demand, friction, speed) in [
        ("held", 4.0, 20.0, false, 0.0),
        ("held, pulled", 6.0, -20.0, true, 0.0),
        ("in motion", 5.0, 20.0, false, 3.0),
        ("in motion with friction", 5.0, 20.0, true, -3.0),
    ] {
        let demands = [("servo.demanded_acceleration", demand), ("ram.demanded_acceleration", demand)];
        let start = [("servo.torque", torque), ("crank.start_speed", speed)];
        let run = two.clone().with(&start).with(&demands).with(&[("friction.enabled", friction)]).started();
        all.push((format!("two drives, {what}"), run));
    }
    // Drives, dampers, a torsional spring and a bumper with curves, without and with friction.
    for (what, friction, speed, h) in [
        ("ahead", false, 14.0, 0.02),
        ("on the bumper", false, -14.0, 0.045),
        ("on the bumper with friction", true, -14.0, 0.045),
        ("after turns", true, 60.0, 0.7),
    ] {
        let mut run =
            Run::new(CURVES).with(&[("crank.start_speed", speed)]).with(&[("friction.enabled", friction)]).started();
        run.step(h);
        all.push((format!("curves, {what}"), run));
    }
    let pressed = [("downstop.stiffness", 1e5), ("actuator.force", -30_000.0)];
    let mut run = Run::gear().with(&[("downstop.rigid", false)]).with(&pressed).started();
    run.step(0.005);
    assert!(run.get("downstop.torque") < -1.0);
    all.push(("gear on its bumper".into(), run));
    // Cams, gears without and with losses, a gas spring, a spring curve, a hydraulic circuit with friction.
    let gas = |spring: Value| {
        changed(carriage(spring, 0.28), |m| {
            m["start"]["speed"] = json!(0.7);
            m["stops"] = json!({ "near": { "joint": "slide", "limit": "lower", "position": 0.25 } });
        })
    };
    let lossy = losses::shafts(0.0, 0.0).with(json!({ "start": { "speed": 20 },
    "springs": { "coil": { "joint": "b", "stiffness": 40, "free_angle": 1.1 } } }));
    let law = json!({ "friction": friction([0.3, 0.1], [0.05, 0.4]) });
    let flat = json!({ "follower": "flat", "kinetic_coefficient": 0.2 });
    let rubbing = parsed(&oscillating("cycloidal", flat)).with(law.clone()).to_string();
    let circuit = changed(HYDRAULIC_GEAR, |m| {
        m["stops"]["downstop"]["enabled"] = json!(false);
        m["friction"]["enabled"] = json!(true);
        m["actuators"]["actuator"]["hydraulics"]["command"] = json!({ "ramp_amplitude": 0.65, "ramp_time": 0.1 });
        m["solver"]["tolerance"] = json!(1e-13);
    });
    for (what, text, spans) in [
        ("cam with a roller", oscillating("polynomial_4567", parsed(ROLLER)), [0.013, 0.05]),
        ("cam with a flat face", oscillating("cycloidal", json!({ "follower": "flat" })), [0.026, 0.04]),
        ("gears", shafts(GEARS), [0.1, 0.3]),
        ("gears with losses", lossy.to_string(), [0.11, 0.15]),
        ("gas", gas(gas_spring()), [1e-6, 0.01]),
        ("curve", gas(json!({ "joint": "slide", "points": POINTS })), [1e-6, 0.01]),
        ("circuit", circuit, [0.0793, 1.0]),
        ("controllers", controlled(14.0), [0.02, 0.03]),
        ("controllers at rest", controlled(0.0), [1e-6, 1e-4]),
        ("teeth on pins with friction", TEETH.into(), [0.02, 0.2]),
        ("cam with friction", rubbing, [0.013, 0.05]),
        ("conveyor", conveyor::machine(1.5, json!({})).to_string(), [0.013, 0.2]),
        ("conveyor at its end", conveyor::machine(-3.0, json!({ "start": { "speed": 0 } })).to_string(), [1e-6, 0.3]),
        ("screw that locks itself", screws::locking(0.05, -0.3).to_string(), [0.02, 0.2]),
        ("slot with friction", slots::arc(json!({ "static_coefficient": 0.2 })).with(law).to_string(), [0.013, 0.2]),
        ("arc slot", slots::arc(json!({})).with(between_bodies()).to_string(), [0.013, 0.2]),
        ("spline slot", slots::track(slots::on_arc(7), between_bodies()).to_string(), [0.013, 0.2]),
    ] {
        let mut run = Run::new(text).started();
        for span in spans {
            run.step(span);
            all.push((format!("{what} after {span} s"), run.clone()));
        }
    }
    // Held by the down stop, by the lock at the down stop, and by up stop and lock.
    for (lock, force, h) in [("uplock", -3_000.0, 0.01), ("downlock", 30_000.0, 0.01), ("uplock", 30_000.0, 0.3)] {
        let engage = format!("{lock}.engage");
        let mut run = Run::gear().with(&[("actuator.force", force)]).with(&[(engage.as_str(), true)]).started();
        run.step(h);
        assert_eq!(run.get("crank.speed"), 0.0);
        all.push((format!("gear, held by {lock}, {force} N"), run));
    }
    all
}

#[test]
fn directional_derivatives_are_those_of_central_differences() {
    let mut compared = 0;
    for (name, model) in states() {
        let (outputs, inputs) = (reals(&model, Causality::Output), reals(&model, Causality::Input));
        for &input in &inputs {
            let mut model = model.clone();
            let value = model.real(input).unwrap();
            let slopes = directional(&mut model, &outputs, &[input], &[1.0]);
            // A width at which rounding and the third derivative are both small.
            let width = 1e-4 * value.abs().max(1.0);
            // The drag is proportional to v |v|, whose second derivative jumps at 0.
            let still = model.variables().list()[input as usize].name == "airspeed" && value == 0.0;
            let width = if still { 1e-4 * width } else { width };
            for (&output, slope) in outputs.iter().zip(slopes) {
                let v = model.variables().list()[output as usize].clone();
                let text = format!("{name}: d {} / d {}", v.name, model.variables().list()[input as usize].name);
                let mut at = |value: f64| {
                    model.set_real(input, value).unwrap();
                    model.real(output).unwrap()
                };
                let (low, high) = (at(value - width), at(value + width));
                if !v.dependencies.contains(&input) {
                    assert_eq!(slope, 0.0, "{text}");
                    assert!((high - low).abs() <= 1e-10 * (1.0 + high.abs()), "{text}: {low} {high}");
                    at(value);
                    continue;
                }
                let here = at(value);
                // The direction of a force that is 0 except for rounding is meaningless.
                if v.name.ends_with(".force") && here.abs() < 1e-12 {
                    continue;
                }
                let difference = (high - low) / (2.0 * width);
                let one_sided = [(high - here) / width, (here - low) / width];
                let near =
                    |d: f64| (slope - d).abs() <= 1e-6 * d.abs().max(slope.abs()) + 1e-11 * (1.0 + here.abs()) / width;
                assert!(
                    near(difference) || (one_sided.iter().any(|d| near(*d)) && !near(one_sided[0] * 2.0)),
                    "{text} = {slope}, differences {difference} {one_sided:?}, value {here}"
                );
                compared += usize::from(slope != 0.0);
            }
        }
    }
    assert!(compared > 500, "{compared}");
}

#[test]
fn several_knowns_give_the_sum_of_single_ones() {
    for (name, mut model) in states() {
        let (outputs, inputs) = (reals(&model, Causality::Output), reals(&model, Causality::Input));
        let seeds: Vec<f64> = (0..inputs.len()).map(|i| 0.7 - 0.9 * i as f64).collect();
        let all = directional(&mut model, &outputs, &inputs, &seeds);
        let mut sum = vec![0.0; outputs.len()];
        let mut size = vec![0.0; outputs.len()];
        for (input, seed) in inputs.iter().zip(&seeds) {
            for (i, one) in directional(&mut model, &outputs, &[*input], &[*seed]).into_iter().enumerate() {
                sum[i] += one;
                size[i] += one.abs();
            }
        }
        for i in 0..outputs.len() {
            let v = &model.variables().list()[outputs[i] as usize].name;
            assert!((all[i] - sum[i]).abs() <= 1e-10 * size[i] + 1e-12, "{name}: {v} {} {}", all[i], sum[i]);
        }
    }
}

#[test]
fn rates_of_outputs_are_those_of_central_differences_in_time() {
    let mut compared = 0;
    for (name, model) in states() {
        for moving in [false, true] {
            let mut start = model.clone();
            let inputs = reals(&start, Causality::Input);
            let h = 2e-6;
            let rates: Vec<f64> =
                inputs.iter().map(|i| if moving { 40.0 * start.real(*i).unwrap() } else { 0.0 }).collect();
            let drive = |model: &mut Run| {
                for (input, rate) in inputs.iter().zip(&rates) {
                    model.set_input_derivative(*input, 1, *rate).unwrap();
                }
            };
            let outputs = reals(&start, Causality::Output);
            // Values at five points, the rate at the third.
            let mut slopes = Vec::new();
            let mut points = Vec::new();
            for point in 0..5 {
                drive(&mut start);
                if point == 2 {
                    slopes = outputs.iter().map(|o| start.output_derivative(*o, 1).unwrap()).collect::<Vec<f64>>();
                }
                points.push(values(&mut start, &outputs));
                start.step(h);
            }
            for i in 0..outputs.len() {
                let text = format!("{name}, {moving}: {}", start.variables().list()[outputs[i] as usize].name);
                let at = |point: usize| points[point][i];
                let difference = (8.0 * (at(3) - at(1)) - (at(4) - at(0))) / (12.0 * h);
                let scale = points.iter().fold(0.0, |m: f64, v| m.max(v[i].abs()));
                // Allowance for rounding. Kinks occur where a drive or a stop acts.
                let tolerance = 1e-6 * difference.abs().max(slopes[i].abs()) + 2e-10 * (1.0 + scale) / h;
                let kink = (at(3) - 2.0 * at(2) + at(1)).abs() > 0.5 * (at(3) - at(1)).abs();
                assert!((slopes[i] - difference).abs() <= tolerance || kink, "{text}: {} {difference}", slopes[i]);
                compared += usize::from(slopes[i] != 0.0);
            }
        }
    }
    assert!(compared > 500, "{compared}");
}

#[test]
fn rates_of_positions_and_speeds_are_speeds_and_accelerations() {
    let mut gear = Run::gear().started();
    gear.step(0.05);
    for (output, rate) in [
        ("crank.angle", "crank.speed"),
        ("crank.speed", "crank.acceleration"),
        ("actuator.length", "actuator.speed"),
        ("actuator.speed", "actuator.acceleration"),
        ("wheel.x", "wheel.velocity_x"),
        ("wheel.velocity_y", "wheel.acceleration_y"),
    ] {
        let (derivative, expected) = (gear.derivative(output), gear.get(rate));
        assert!((derivative - expected).abs() <= 1e-12 * expected.abs(), "{output}: {derivative} {expected}");
    }
    // The power of all forces is the rate of the kinetic energy.
    let of_actuator = gear.get("actuator.force") * gear.get("actuator.speed");
    let lost = gear.derivative("energy.kinetic") + gear.derivative("energy.potential") - of_actuator;
    assert!(lost.abs() < 1e-9 * of_actuator.abs(), "{lost}");
}

#[test]
fn variables_without_a_derivative_are_rejected_with_their_name() {
    let mut model = Run::gear().started();
    let find = |name: &str| model.0.reference(name).unwrap();
    let (force, length, angle) = (find("actuator.force"), find("crank.length"), find("crank.angle"));
    let flag = find("retracted");
    let mut none = |_: usize, _: f64| {};
    let mut refused = |unknown: Reference, known: Reference, seed: f64, name: &str| {
        let error = model.directional_derivative(&[unknown], &[known], &[seed], &mut none).unwrap_err().to_string();
        assert!(error.contains(name), "{error}");
    };
    refused(force, force, 1.0, "actuator.force");
    refused(flag, force, 1.0, "retracted");
    refused(angle, length, 1.0, "crank.length");
    refused(angle, angle, 1.0, "crank.angle");
    refused(angle, force, f64::NAN, "actuator.force");
    refused(9999, force, 1.0, "9999");
    for order in [0, 2, -1] {
        assert!(model.output_derivative(angle, order).unwrap_err().to_string().contains("crank.angle"));
    }
    assert!(model.output_derivative(flag, 1).is_err() && model.output_derivative(force, 1).is_err());
    model.set("solver.method", "rigid_fem");
    let error = model.directional_derivative(&[angle], &[force], &[1.0], &mut |_, _| {}).unwrap_err();
    assert!(error.to_string().contains("rigid_fem"), "{error}");
    assert!(model.output_derivative(angle, 1).unwrap_err().to_string().contains("rigid_fem"));
}
