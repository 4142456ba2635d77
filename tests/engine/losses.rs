//! Couplings with an efficiency, against closed forms: power in both directions, holding, trains, reversal of the
//! power.

use crate::support::definition::{With, block};
use crate::support::numeric::runge_kutta;
use crate::support::{Run, assert_near, assert_says, refusal};
use serde_json::{Value, json};
use std::f64::consts::PI;

/// A shaft with gears to a second shaft, a belt to a third shaft and a rack to a table, all with losses.
pub const TRAIN: &str = include_str!("../fixtures/train_with_losses.json");
const ETA: f64 = 0.8;
const I: f64 = -17.0 / 43.0;
const J1: f64 = 0.02;
const J2: f64 = 0.5;

/// Two shafts 0.3 m apart with gears of efficiency 0.8, under these torques.
pub fn shafts(motor: f64, load: f64) -> Value {
    json!({ "name": "Losses",
        "bodies": { "ground": { "points": { "far": [0.3, 0] } }, "one": { "mass": 2, "inertia": J1 }, "two": {
            "mass": 5, "inertia": J2 } },
        "joints": { "a": { "type": "revolute", "first": "ground.origin", "second": "one.origin" },
            "b": { "type": "revolute", "first": "ground.far", "second": "two.origin" } },
        "couplings": { "mesh": { "type": "gears", "first": "one.origin", "second": "two.origin", "first_teeth": 17,
            "second_teeth": 43, "efficiency": ETA } },
        "torques": { "motor": { "on": "one", "torque": motor }, "load": { "on": "two", "torque": load } },
        "start": { "body": "one", "angle": 0.4, "speed": 0 }, "guess": { "one": 0.4, "two": 1.1 } })
}

/// Acceleration of the first shaft if power flows to the second shaft, and if power flows back.
fn forward_and_back(motor: f64, load: f64) -> [f64; 2] {
    [ETA, 1.0 / ETA].map(|eta| (motor + I * load / eta) / (J1 + I * I * J2 / eta))
}

/// Acceleration for a direction of motion: power flows to the second shaft if the torque X2 on this shaft drives it.
fn accelerates(motor: f64, load: f64, direction: f64) -> f64 {
    let [forward, back] = forward_and_back(motor, load);
    let drives = |a: f64| (J2 * I * a - load) * I * direction;
    match (drives(forward) >= 0.0, drives(back) >= 0.0) {
        (true, true) => forward,
        (false, false) => back,
        other => panic!("{motor} {load} {direction}: {other:?}"),
    }
}

#[test]
fn two_shafts_accelerate_by_the_power_less_losses() {
    for (motor, load, speed) in
        [(3.0, -1.0, 0.0), (0.1, -5.0, 0.0), (3.0, -1.0, -80.0), (-2.0, 4.0, 300.0), (0.0, 1.0, 60.0), (-3.0, 0.0, 0.0)]
    {
        let mut text = shafts(motor, load);
        text["start"]["speed"] = json!(speed);
        let mut run = Run::new(&text).started();
        let direction = if speed == 0.0 { (motor + I * load).signum() } else { f64::signum(speed) };
        let a = accelerates(motor, load, direction);
        let size = 10.0 * (1.0 + a.abs());
        assert_near(run.get("one.acceleration"), a, 1e-13 * size, "acceleration");
        // The transmitted force acts on the first shaft. The force on the second shaft includes the loss.
        let arm = 0.3 * 43.0 / 60.0;
        let transmitted = (motor - J1 * a) / (I * arm);
        assert_near(run.get("mesh.transmitted_force"), transmitted, 1e-12 * size, "transmitted force");
        let loss = J2 * I * a - load - transmitted * arm;
        assert_near(run.get("mesh.loss_torque"), loss, 1e-12 * size, "loss");
        let pressed = transmitted.abs() * (PI / 9.0).tan();
        assert_near(run.get("b.force"), transmitted.hypot(pressed), 1e-12 * size, "bearing");
        let (mut t, mut power) = (0.0, 0.0);
        while t < 0.3 {
            run.step(0.01);
            t += 0.01;
            power = run.get("mesh.loss_torque") * run.get("two.speed");
            let drift = run.get("energy.drift");
            assert!(drift.abs() < 1e-9 * run.get("energy.kinetic").max(1.0), "{drift}");
        }
        assert_near(run.get("one.speed"), speed + a * t, 1e-9 * size, "speed");
        assert!(power < 0.0, "the loss takes power: {power}");
        // In both directions the loss is a fifth of the input power.
        let [first, second] = [-(J1 * a - motor) * run.get("one.speed"), (J2 * I * a - load) * run.get("two.speed")];
        let [goes_in, comes_out] = if first > 0.0 { [first, second] } else { [-second, -first] };
        assert_near(comes_out, ETA * goes_in, 1e-9 * goes_in.abs(), "efficiency");
        assert_near(-power, (1.0 - ETA) * goes_in, 1e-9 * goes_in.abs(), "power lost");
    }
}

#[test]
fn self_locking_gears_hold_a_load_that_neither_side_overcomes() {
    // The shafts start forward above M eta = -i L, and backward below M = -i L eta.
    for (part, moves) in [(0.75, 1.0), (0.82, 0.0), (1.0, 0.0), (1.2, 0.0), (1.3, -1.0)] {
        let load = -3.0 * part / I;
        let mut run = Run::new(shafts(3.0, load)).started();
        assert_eq!(run.0.boolean("friction.sticking").unwrap(), moves == 0.0, "{part}");
        let start = run.get("one.angle");
        run.steps(20, 1.0);
        let speed = run.get("one.speed");
        if moves == 0.0 {
            assert_eq!((run.get("one.angle"), speed), (start, 0.0), "held to the bit");
        } else {
            let a = accelerates(3.0, load, moves);
            assert!(a * moves > 0.0);
            assert_near(speed, a, 1e-8 * a.abs(), "speed after 1 s");
        }
    }
}

#[test]
fn the_flow_turns_round_in_a_swing() {
    // A spring on the second shaft stores energy that flows into the first shaft and back, each time with a loss.
    let mut text = shafts(0.0, 0.0);
    text["springs"] = json!({ "coil": { "joint": "b", "stiffness": 40, "free_angle": 1.1 } });
    text["start"]["speed"] = json!(20);
    text["solver"] = json!({ "tolerance": 1e-11 });
    let mut run = Run::new(&text).started();
    let rate = |[x, v]: [f64; 2], direction: f64| [v, accelerates(0.0, -40.0 * I * (x - 0.4), direction)];
    let rk4 = |y, direction: f64, h: f64| runge_kutta(|_, y| rate(y, direction), y, h, 1);
    let (mut y, steps) = ([0.4, 20.0], 200);
    let (mut reversals, mut direction) = (0, 1.0);
    for k in 1..=120 {
        run.step(0.01);
        let h = 0.01 / f64::from(steps);
        for _ in 0..steps {
            let end = rk4(y, direction, h);
            if end[1] * direction >= 0.0 {
                y = end;
                continue;
            }
            // One step up to the reversal of the power, and the rest of the step.
            let (mut low, mut high) = (0.0, h);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                let turned = rk4(y, direction, middle)[1] * direction < 0.0;
                (low, high) = if turned { (low, middle) } else { (middle, high) };
            }
            y = [rk4(y, direction, low)[0], 0.0];
            (direction, reversals) = (-direction, reversals + 1);
            y = rk4(y, direction, h - low);
        }
        // The reference uses steps of 5e-5 s, also across reversals of the power, where the acceleration has a kink.
        assert_near(run.get("one.angle"), y[0], 1e-8, &format!("angle at step {k}"));
        assert_near(run.get("one.speed"), y[1], 1e-6, &format!("speed at step {k}"));
        let drift = run.get("energy.drift");
        assert!(drift.abs() < 1e-9, "{drift}");
    }
    assert!(reversals >= 3, "{reversals}");
}

#[test]
fn a_train_has_the_product_of_its_efficiencies() {
    let text: Value = serde_json::from_str(TRAIN).unwrap();
    for direction in [1.0, -1.0] {
        let mut text = text.clone();
        // The motor drives the table, and a force on the table drives the motor.
        text["torques"]["motor"]["torque"] = json!(if direction > 0.0 { 3.0 } else { 0.01 });
        text["start"]["speed"] = json!(0);
        text["forces"]["push"]["force"][0] = json!(if direction > 0.0 { 10.0 } else { 200.0 });
        let mut run = Run::new(&text).started();
        let (motor, push) = if direction > 0.0 { (3.0, 10.0) } else { (0.01, 200.0) };
        let (i2, i3) = (0.5 * I, 0.1 * 0.5 * I);
        let [e1, e2, e3] = [ETA, 0.9, 0.7].map(|eta: f64| eta.powf(direction));
        let inertia = J1 + I * I * J2 / e1 + i2 * i2 * 0.7 / (e1 * e2) + i3 * i3 * 40.0 / (e1 * e2 * e3);
        let a = (motor + i3 * push / (e1 * e2 * e3)) / inertia;
        assert_near(run.get("one.acceleration"), a, 1e-12 * (1.0 + a.abs()), "acceleration");
        // The table: mass x acceleration = push + rack force with its loss.
        let on_table = run.get("rack.transmitted_force") + run.get("rack.loss_force") + push;
        assert_near(on_table, 40.0 * i3 * a, 1e-11 * (1.0 + on_table.abs()), "table");
        run.steps(10, 0.2);
        assert_near(run.get("one.speed"), 0.2 * a, 1e-8 * (1.0 + a.abs()), "speed");
        assert!(run.get("energy.drift").abs() < 1e-9 * run.get("energy.kinetic").max(1.0));
    }
}

#[test]
fn an_efficiency_is_a_parameter_and_rejected_out_of_range() {
    let mut run = Run::new(shafts(3.0, -1.0));
    run.set("mesh.efficiency", 1.0);
    let mut run = run.started();
    let a = (3.0 - I) / (J1 + I * I * J2);
    assert_near(run.get("one.acceleration"), a, 1e-12 * a.abs(), "without loss");
    let refused = |change: &dyn Fn(&mut Value), pieces: &[&str]| {
        let mut text = shafts(3.0, -1.0);
        change(&mut text);
        assert_says(refusal(text), pieces);
    };
    refused(&|m| m["couplings"]["mesh"]["efficiency"] = json!(1.2), &["couplings.mesh.efficiency", "1.2"]);
    refused(&|m| m["couplings"]["mesh"]["efficiency"] = json!(0), &["couplings.mesh.efficiency"]);
    refused(
        &|m| {
            m["friction"] = json!({ "static_coefficient": 0.2, "kinetic_coefficient": 0.1 });
            m["couplings"]["mesh"]["pressure_angle"] = json!(0);
        },
        &["couplings.mesh.efficiency", "stick"],
    );
}

/// Where power flows back, the backward efficiency counts, and the efficiency elsewhere.
#[test]
fn a_backward_efficiency_counts_where_power_flows_back() {
    let backward = 0.3;
    for (motor, load, speed) in [(3.0, -1.0, 0.0), (0.1, -5.0, 0.0), (3.0, -1.0, -80.0), (-2.0, 4.0, 300.0)] {
        let mut text = shafts(motor, load);
        text["couplings"]["mesh"]["backward_efficiency"] = json!(backward);
        text["start"]["speed"] = json!(speed);
        let mut run = Run::new(&text).started();
        let direction = if speed == 0.0 { (motor + I * load).signum() } else { f64::signum(speed) };
        let [forward, back] = [ETA, 1.0 / backward].map(|eta| (motor + I * load / eta) / (J1 + I * I * J2 / eta));
        let a = if (J2 * I * forward - load) * I * direction >= 0.0 { forward } else { back };
        assert_near(run.get("one.acceleration"), a, 1e-12 * (1.0 + a.abs()), "acceleration");
        for _ in 0..10 {
            run.step(0.01);
            let drift = run.get("energy.drift");
            assert!(drift.abs() < 1e-9 * run.get("energy.kinetic").max(1.0), "{drift}");
        }
        assert_near(run.get("one.speed"), speed + 0.1 * a, 1e-9 * (1.0 + a.abs()), "speed");
    }
    // Without a loss forward.
    let mut text = shafts(-2.0, 4.0);
    text["couplings"]["mesh"]["efficiency"] = json!(1);
    text["couplings"]["mesh"]["backward_efficiency"] = json!(backward);
    text["start"]["speed"] = json!(300);
    let mut run = Run::new(&text).started();
    let [forward, back] = [1.0, 1.0 / backward].map(|eta| (-2.0 + I * 4.0 / eta) / (J1 + I * I * J2 / eta));
    let flows_on = (J2 * I * forward - 4.0) * I >= 0.0;
    assert_near(run.get("one.acceleration"), if flows_on { forward } else { back }, 1e-11 * forward.abs(), "lossless");
    text["couplings"]["mesh"].as_object_mut().unwrap().remove("efficiency");
    assert_says(refusal(&text), &["couplings.mesh.backward_efficiency", "add the key `efficiency`"]);
}

/// A worm: little of the load's torque arrives at the first shaft, where a constant friction holds it.
#[test]
fn a_small_backward_efficiency_and_a_seal_hold_a_load() {
    let held = |backward: f64, load: f64| {
        let mut text = shafts(0.0, load);
        text["couplings"]["mesh"]["backward_efficiency"] = json!(backward);
        text["joints"]["a"]["frictionloss"] = json!(0.05);
        let mut run = Run::new(&text).started();
        let sticks = run.is("friction.sticking");
        run.step(0.2);
        assert_eq!(run.get("one.speed") == 0.0, sticks, "{backward} {load}");
        sticks
    };
    // The torque that arrives is 0.02 * 17 / 43 * load.
    let most = 0.05 / (0.02 * -I);
    assert!(held(0.02, 0.999 * most) && held(0.02, -0.999 * most));
    assert!(!held(0.02, 1.001 * most) && !held(0.8, 0.05 * most));
}

/// A load on the second shaft never drives the first one, at rest and in motion; the motor drives both.
#[test]
fn a_gear_that_locks_itself_holds_any_load() {
    let gear = |motor: f64, load: f64, speed: f64| {
        let mut text = shafts(motor, load);
        text["couplings"]["mesh"]["backward_efficiency"] = json!(0);
        text["start"]["speed"] = json!(speed);
        text["solver"] = json!({ "tolerance": 1e-12 });
        Run::new(&text).started()
    };
    for load in [5.0, -5.0, 1e-3, 1e5] {
        let mut run = gear(0.0, load, 0.0);
        assert!(run.is("friction.sticking"), "{load}");
        let names = ["one.angle", "one.speed"];
        let before = run.bits(names);
        run.step(0.5);
        assert_eq!(run.bits(names), before, "{load}");
        run.near("mesh.transmitted_force", 0.0, 1e-6 * load.abs());
        run.near("mesh.loss_torque", -load, 1e-8 * load.abs());
    }
    // With the load the motor accelerates its own shaft only, against the load both.
    for (motor, load, speed) in [(0.3, -5.0, 0.0), (0.0, -5.0, 20.0), (-0.4, 5.0, 0.0), (3.0, 1.0, 0.0)] {
        let mut run = gear(motor, load, speed);
        let direction = if speed == 0.0 { f64::signum(motor) } else { f64::signum(speed) };
        let a = if I * load * direction > 0.0 { motor / J1 } else { accelerates(motor, load, direction) };
        run.near("one.acceleration", a, 1e-9 * (1.0 + a.abs()));
        run.step(0.1);
        run.near("one.speed", speed + 0.1 * a, 1e-8 * (1.0 + a.abs()));
        let allowed = 1e-8 * run.get("energy.kinetic").max(1.0);
        run.near("energy.drift", 0.0, allowed);
    }
    // A worm that is driven into rest stays there.
    let mut run = gear(-0.2, -5.0, 8.0);
    run.step(2.0);
    let rest = run.get("one.speed");
    assert!(rest.abs() < 1e-9 || rest < 0.0, "{rest}");
    // Without an inertia at the worm it transmits nothing, which a warning states.
    let warned = |inertia: f64| {
        let mut text = shafts(0.0, 5.0);
        text["couplings"]["mesh"]["backward_efficiency"] = json!(0);
        text["bodies"]["one"] = json!({ "inertia": inertia });
        let all = Run::new(&text).warnings();
        all.iter().any(|text| text.contains("mesh.backward_efficiency") && text.contains("has a moment of inertia"))
    };
    assert!(warned(0.0) && !warned(1e-4));
}

/// A drive with two efficiencies on a block of 3 kg.
#[test]
fn a_drive_has_an_efficiency_for_each_direction() {
    for (force, speed, delivered) in
        [(2.0, 1.0, 1.6), (2.0, -1.0, 4.0), (-2.0, 1.0, -4.0), (-2.0, -1.0, -1.6), (2.0, 0.0, 1.6)]
    {
        let text = block(3.0).with(json!({
            "actuators": { "ram": { "joint": "slide", "force": force, "efficiency": 0.8, "backward_efficiency": 0.5 } },
            "start": { "speed": speed },
        }));
        let mut run = Run::new(text).started();
        run.near("slide.acceleration", delivered / 3.0, 1e-13);
        run.set("ram.demanded_acceleration", delivered / 3.0);
        run.near("ram.required_force", force, 1e-12);
        run.step(0.1);
        run.near("slide.speed", speed + 0.1 * delivered / 3.0, 1e-12);
        run.near("energy.drift", 0.0, 1e-12);
    }
    // Only where power flows back.
    let ram = json!({ "joint": "slide", "force": 2, "backward_efficiency": 0.5 });
    let text = block(3.0).with(json!({ "actuators": { "ram": ram } }));
    Run::new(text.clone()).started().near("slide.acceleration", 2.0 / 3.0, 1e-13);
    Run::new(text.with(json!({ "start": { "speed": -1 } }))).started().near("slide.acceleration", 4.0 / 3.0, 1e-13);
}

/// Inverse dynamics of the present acceleration gives the present torque, whichever way power flows in the coupling.
#[test]
fn a_drive_needs_the_torque_that_it_has() {
    for (motor, load, speed) in [(3.0, -1.0, 10.0), (3.0, -1.0, -10.0), (-2.0, 4.0, 10.0), (0.1, -5.0, -10.0)] {
        let mut text = shafts(0.0, load);
        text["torques"].as_object_mut().unwrap().remove("motor");
        let text = text.with(json!({
            "actuators": { "motor": { "joint": "a", "torque": motor } }, "start": { "speed": speed },
        }));
        let mut run = Run::new(text).started();
        let acceleration = run.get("motor.acceleration");
        run.set("motor.demanded_acceleration", acceleration);
        run.near("motor.required_force", motor, 1e-10);
    }
}
