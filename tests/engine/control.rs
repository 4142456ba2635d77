//! Drives with a controller: closed forms of linear motions and of motions at a limit of the force, equivalent springs
//! and dampers, breakaway under a rising command, linearisation, saved states, rejected definitions.
use crate::stiction;
use crate::support::definition::{self, G, With, arm, block, rod, slider_crank, weight};
use crate::support::{Run, assert_near, assert_says, refusal};
use linkage_fmu::component::{Component, Linearisation};
use linkage_fmu::numerics::bracket::bisect;
use serde_json::{Value, json};

const MASS: f64 = 3.0;
const GAIN: f64 = 120.0;
const SPEED_GAIN: f64 = 9.0;

/// A carriage on a level rail at 0 with a controlled drive, integrated to 1e-12.
fn carriage(control: Value) -> Value {
    block(MASS).with(json!({
        "actuators": { "motor": { "joint": "slide", "force": 0, "control": control } },
        "solver": { "tolerance": 1e-12 },
    }))
}

/// The motion of m x'' = f - k x - c x', from x and v, after a time: closed form, with less than critical damping.
fn free([k, c, f]: [f64; 3], [x, v]: [f64; 2], t: f64) -> [f64; 2] {
    if k == 0.0 && c == 0.0 {
        return [x + t * (v + 0.5 * t * f / MASS), v + t * f / MASS];
    }
    let (decay, rest) = (0.5 * c / MASS, f / k);
    let omega = (k / MASS - decay * decay).sqrt();
    let (a, b) = (x - rest, (v + decay * (x - rest)) / omega);
    let (sin, cos) = (omega * t).sin_cos();
    let shrunk = (-decay * t).exp();
    let (wave, rate) = (a * cos + b * sin, omega * (b * cos - a * sin));
    [rest + shrunk * wave, shrunk * (rate - decay * wave)]
}

#[test]
fn a_position_drive_follows_its_second_order_response() {
    let control = json!({ "position_gain": GAIN, "speed_gain": SPEED_GAIN, "command": 0.4, "command_speed": 0.1 });
    for count in [1, 7, 40] {
        let mut run = Run::new(carriage(control.clone())).with(&[("motor.force", 6.0)]).started();
        for k in 1..=count {
            let h = 2.0 / f64::from(count);
            run.step(h);
            let force = 6.0 + GAIN * 0.4 + SPEED_GAIN * 0.1;
            let [x, v] = free([GAIN, SPEED_GAIN, force], [0.0; 2], h * f64::from(k));
            run.near("slide.position", x, 1e-11);
            run.near("slide.speed", v, 1e-10);
            run.near("motor.acting_force", force - GAIN * x - SPEED_GAIN * v, 1e-9);
            run.near("slide.acceleration", (force - GAIN * x - SPEED_GAIN * v) / MASS, 1e-9);
            run.near("energy.drift", 0.0, 1e-10);
        }
    }
}

#[test]
fn a_speed_drive_approaches_its_speed_exponentially() {
    let mut run = Run::new(carriage(json!({ "speed_gain": SPEED_GAIN, "command_speed": 2 }))).started();
    for k in 1..=10 {
        run.step(0.2);
        let t = 0.2 * f64::from(k);
        run.near("slide.speed", 2.0 * (1.0 - (-SPEED_GAIN * t / MASS).exp()), 1e-10);
        run.near("energy.drift", 0.0, 1e-10);
    }
}

/// The commands of position and speed are quadratic and linear in time within a step: x follows the parabola of the
/// command with the offset -m c'' / k.
#[test]
fn derivatives_of_commands_are_exact_within_a_step() {
    let control = json!({ "position_gain": GAIN, "speed_gain": SPEED_GAIN });
    let mut run = Run::new(carriage(control)).started();
    let [first, second] = [0.3, 0.8];
    run.set_derivative("motor.command", 1, first);
    run.set_derivative("motor.command", 2, second);
    run.set("motor.command_speed", first);
    run.set_derivative("motor.command_speed", 1, second);
    run.step(1.5);
    // x - (c(t) - m c'' / k) is a free motion.
    let lag = MASS * second / GAIN;
    let [x, v] = free([GAIN, SPEED_GAIN, 0.0], [lag, -first], 1.5);
    run.near("slide.position", 1.5 * (first + 0.75 * second) - lag + x, 1e-11);
    run.near("slide.speed", first + 1.5 * second + v, 1e-10);
    run.near("energy.drift", 0.0, 1e-10);
}

/// A controlled motion of the carriage from rest at 0 to the command 1, in pieces: at a limit the force is constant,
/// between the limits the motion is that of a spring and a damper. Returns the times at which the force reaches or
/// leaves a limit, and position and speed at the end.
fn limited([least, most]: [f64; 2], span: f64) -> (Vec<f64>, [f64; 2]) {
    let demanded = |[x, v]: [f64; 2]| GAIN * (1.0 - x) - SPEED_GAIN * v;
    let piece = |force: f64| if force > most { 1 } else { -i32::from(force < least) };
    let (mut t, mut state, mut at, mut times) = (0.0, [0.0; 2], 1, Vec::new());
    loop {
        let law = match at {
            1 => [0.0, 0.0, most],
            -1 => [0.0, 0.0, least],
            _ => [GAIN, SPEED_GAIN, GAIN],
        };
        let changes = |after: f64| piece(demanded(free(law, state, after))) != at;
        let first = (1..=40_000).map(|k| 1e-4 * f64::from(k)).find(|&after| changes(after));
        let Some(first) = first.filter(|first| t + first < span) else { return (times, free(law, state, span - t)) };
        let [_, after] = bisect(changes, first - 1e-4, first);
        state = free(law, state, after);
        at = piece(demanded(free(law, state, 1e-9)));
        t += after;
        times.push(t);
    }
}

#[test]
fn a_force_at_its_limit_is_constant_and_leaves_it_at_the_instant() {
    let limits = [-15.0, 40.0];
    let control = json!({ "position_gain": GAIN, "speed_gain": SPEED_GAIN, "command": 1, "min_force": limits[0],
        "max_force": limits[1] });
    let span = 3.0;
    let (times, [x, v]) = limited(limits, span);
    assert!(times.len() >= 3, "the force leaves a limit and reaches the other one: {times:?}");
    for count in [1, 13, 300] {
        let mut run = Run::new(carriage(control.clone())).started();
        run.near("motor.acting_force", 40.0, 0.0);
        run.steps(count, span);
        run.near("slide.position", x, 2e-11);
        run.near("slide.speed", v, 2e-10);
        run.near("energy.drift", 0.0, 1e-9);
    }
    // While the force is at its limit, the speed is that of a constant force.
    let mut run = Run::new(carriage(control)).started();
    run.step(0.9 * times[0]);
    run.near("slide.speed", 40.0 / MASS * 0.9 * times[0], 1e-12);
}

/// The limits apply to the sum of feed-forward and feedback. One limit alone may be given.
#[test]
fn the_limit_counts_the_force_of_the_input() {
    let control = json!({ "position_gain": GAIN, "command": 0.5, "max_force": 25 });
    let mut run = Run::new(carriage(control)).with(&[("motor.force", 100.0)]).started();
    run.near("slide.acceleration", 25.0 / MASS, 1e-12);
    run.set("motor.force", -200.0);
    run.near("slide.acceleration", -140.0 / MASS, 1e-12);
    run.set("motor.force", 0.0);
    run.step(0.1);
    assert_near(run.get("slide.speed"), 2.5 / MASS, 1e-12, "speed under the limit");
}

/// A crank that rotates fully under gravity, with a drive between points and a drive in a joint.
fn machine(elements: Value) -> Value {
    let bodies = [rod(0.1, 1.2), rod(0.3, 0.9), json!({ "mass": 0.5 })];
    slider_crank(bodies, 0.7).with(elements).with(json!({
        "gravity": weight(), "bodies": { "ground": { "points": { "eye": [0.6, 0.05] } } },
        "start": { "speed": 40 }, "solver": { "tolerance": 1e-12 },
    }))
}

/// A controller gain acts like a spring or a damper: over whole revolutions, and for a length.
#[test]
fn gains_are_springs_and_dampers() {
    let control = |on: Value, gains: [f64; 2], command: f64| {
        on.with(json!({ "control": { "position_gain": gains[0], "speed_gain": gains[1], "command": command } }))
    };
    let spring = |on: Value, gains: [f64; 2], free: &str, command: f64| {
        on.with(json!({ "stiffness": gains[0], "damping": gains[1], free: command }))
    };
    let (turn, reach) = (json!({ "joint": "bearing" }), json!({ "first": "ground.eye", "second": "slider.origin" }));
    let (a, b) = ([0.05, 0.004], [200.0, 1.0]);
    let mut controlled = Run::new(machine(json!({ "actuators": {
        "servo": control(turn.clone(), a, 3.0), "ram": control(reach.clone(), b, 0.25) } })))
    .started();
    let mut sprung = Run::new(machine(json!({ "springs": {
        "servo": spring(turn, a, "free_angle", 3.0), "ram": spring(reach, b, "free_length", 0.25) } })))
    .started();
    for _ in 0..60 {
        [&mut controlled, &mut sprung].into_iter().for_each(|run| run.step(0.02));
        for name in ["crank.angle", "crank.speed", "slider.x", "pin.force"] {
            if let Ok(expected) = sprung.0.get(name) {
                controlled.near(name, expected, 1e-8 * (1.0 + expected.abs()));
            }
        }
        let torque = -sprung.get("servo.torque");
        controlled.near("servo.acting_torque", torque, 1e-8);
        controlled.near("energy.drift", 0.0, 1e-8);
    }
    assert!(controlled.get("crank.angle") > 7.0, "the crank turns round: {}", controlled.get("crank.angle"));
}

/// A drive's own controller is neither part of its static load nor of the stiffness in its other one-element outputs.
#[test]
fn the_holding_force_and_its_derivative_are_without_the_controller() {
    let with = |control: Value| {
        machine(
            json!({ "actuators": { "servo": json!({ "joint": "bearing" }).with(control) }, "start": { "speed": 0 } }),
        )
    };
    let control = json!({ "control": { "position_gain": 5, "command": 1.2, "max_force": 3 } });
    let (mut plain, mut own) = (Run::new(with(json!({}))).started(), Run::new(with(control)).started());
    for name in ["holding_torque", "holding_torque_derivative", "static_load", "required_force", "reduced_inertia"] {
        let name = format!("servo.{name}");
        let expected = plain.get(&name);
        assert!(expected != 0.0 || name == "servo.required_force", "{name}");
        own.near(&name, expected, 1e-11 * (1.0 + expected.abs()));
    }
    // The controller of another drive acts like a spring: the derivative agrees with a finite difference.
    let both = json!({ "servo": { "joint": "bearing" }, "ram": { "joint": "guide", "control": {
        "position_gain": 300, "command": 0.3 } } });
    let at = |angle: f64| {
        let text = machine(json!({ "actuators": both, "start": { "speed": 0, "angle": angle } }));
        Run::new(text).started()
    };
    let h = 1e-4;
    let [low, high] = [-h, h].map(|shift| at(0.7 + shift).get("servo.holding_torque"));
    at(0.7).near("servo.holding_torque_derivative", (high - low) / (2.0 * h), 1e-6);
}

/// The block stays exactly at rest until the drive force reaches static friction, at an instant that follows from the
/// command.
#[test]
fn a_rising_command_breaks_static_friction_at_the_instant() {
    let text = stiction::block(0.0, 0.0).with(json!({ "actuators": { "motor": { "joint": "slide", "control": {
        "position_gain": GAIN, "speed_gain": SPEED_GAIN, "max_force": 7 } } } }));
    let normal = 2.0 * G;
    let (rate, breakaway) = (0.25, 0.3 * normal);
    let time = breakaway / (GAIN * rate);
    let mut run = Run::new(&text).started();
    let at_rest = [run.get("slide.position"), 0.0];
    run.set_derivative("motor.command", 1, rate);
    run.step(0.999 * time);
    assert_eq!([run.get("slide.position"), run.get("slide.speed")], at_rest);
    run.set_derivative("motor.command", 1, rate);
    run.step(0.011 * time);
    assert!(run.get("slide.position") > 1e-9);
    // At the limit 5 N, which is below the static friction, the block stays.
    let mut held = Run::new(text).with(&[("motor.control.max_force", 5.0), ("motor.command", 8.0)]).started();
    held.set_derivative("motor.command", 1, rate);
    held.steps(3, 10.0);
    assert_eq!([held.get("slide.position"), held.get("slide.speed")], at_rest);
}

/// With an efficiency eta the mechanism receives eta times the controller's force.
#[test]
fn an_efficiency_applies_to_the_controllers_force() {
    let text = carriage(json!({ "position_gain": GAIN, "command": 0.5 }))
        .with(json!({ "actuators": { "motor": { "efficiency": 0.8 } }, "start": { "speed": 0.1 } }));
    let mut run = Run::new(text).with(&[("motor.force", 20.0)]).started();
    run.near("motor.acting_force", 80.0, 1e-12);
    run.near("slide.acceleration", 0.8 * 80.0 / MASS, 1e-12);
    run.step(0.05);
    // m x'' = eta (F + K (c - x)).
    let [x, v] = free([0.8 * GAIN, 1e-300, 64.0], [0.0, 0.1], 0.05);
    run.near("slide.position", x, 1e-12);
    run.near("slide.speed", v, 1e-11);
    run.near("energy.drift", 0.0, 1e-10);
}

#[test]
fn a_controlled_pendulum_has_its_eigenvalues_and_gains() {
    let (gain, speed_gain, mass, length) = (30.0, 1.5, 2.0, 0.5);
    let text = arm(length, mass, -1.2).with(json!({
        "gravity": weight(), "linearisation": true, "actuators": { "motor": { "joint": "pivot", "control": {
            "position_gain": gain, "speed_gain": speed_gain, "command": -1.0 } } },
        "start": { "equilibrium": true },
    }));
    let mut run = Run::new(&text).started();
    let theta = run.get("arm.angle");
    let pull = 0.5 * mass * G * length;
    // K (c - theta) = m g l / 2 cos theta.
    assert_near(gain * (-1.0 - theta), pull * theta.cos(), 1e-10, "balance of torques");
    let inertia = mass * length * length / 3.0;
    let stiffness = gain - pull * theta.sin();
    run.near("linearisation.eigenfrequency", (stiffness / inertia).sqrt() / std::f64::consts::TAU, 1e-10);
    run.near("linearisation.damping_ratio", 0.5 * speed_gain / (stiffness * inertia).sqrt(), 1e-10);
    let mut model = Component::from_definition("mechanism.json", &text.to_string()).unwrap();
    let find = |name: &str| model.interface().find(name).unwrap();
    let asked = Linearisation {
        coordinate: find("arm.angle"),
        inputs: vec![find("motor.command"), find("motor.command_speed"), find("motor.torque")],
        outputs: vec![find("motor.acting_torque")],
        held_by: None,
    };
    let at = model.linearise_here(&asked).unwrap();
    for (value, expected) in [
        (at.a[1][0], -stiffness / inertia),
        (at.a[1][1], -speed_gain / inertia),
        (at.b[0][1], gain / inertia),
        (at.b[1][1], speed_gain / inertia),
        (at.b[2][1], 1.0 / inertia),
        (at.c[0][0], -gain),
        (at.c[0][1], -speed_gain),
        (at.d[0][0], gain),
        (at.d[0][1], speed_gain),
        (at.d[0][2], 1.0),
    ] {
        assert_near(value, expected, 1e-9 * (1.0 + expected.abs()), "linearisation");
    }
}

#[test]
fn a_saved_state_continues_at_a_limit() {
    let control = json!({ "position_gain": GAIN, "speed_gain": SPEED_GAIN, "command": 1, "max_force": 40 });
    let mut run = Run::new(carriage(control)).started();
    for _ in 0..6 {
        run.step(0.11);
        let saved = run.saved();
        run.steps(3, 0.3);
        let names = ["slide.position", "slide.speed", "motor.acting_force"];
        let expected = run.bits(names);
        run.take(&saved);
        run.steps(3, 0.3);
        assert_eq!(run.bits(names), expected);
        run.take(&saved);
    }
}

/// Gains and limits may change between two steps. The energy balance includes the effect of the change.
#[test]
fn gains_and_limits_are_tunable() {
    let control = json!({ "position_gain": GAIN, "speed_gain": SPEED_GAIN, "command": 3, "max_force": 4000 });
    let mut run = Run::new(carriage(control)).started();
    run.step(0.2);
    let before = [run.get("slide.position"), run.get("slide.speed")];
    run.set_all(&[("motor.control.position_gain", 300.0), ("motor.control.max_force", 10.0)]);
    run.near("motor.acting_force", 10.0, 1e-12);
    run.step(0.05);
    let [x, v] = free([0.0, 0.0, 10.0], before, 0.05);
    run.near("slide.position", x, 1e-11);
    run.near("slide.speed", v, 1e-11);
    run.near("energy.drift", 0.0, 1e-9);
}

#[test]
fn wrong_controllers_are_rejected() {
    for (control, pieces) in [
        (json!({}), &["actuators.motor.control", "needs a gain"][..]),
        (json!({ "speed_gain": 1, "command": 2 }), &["control.command", "add `position_gain`"]),
        (json!({ "position_gain": 1, "command_speed": 2 }), &["control.command_speed", "add `speed_gain`"]),
        (json!({ "position_gain": -1 }), &["control.position_gain", "-1", ">= 0"]),
        (
            json!({ "position_gain": 1, "min_force": 5, "max_force": 5 }),
            &["actuators.motor.control.max_force", "5", "greater than min_force = 5"],
        ),
    ] {
        assert_says(refusal(carriage(control)), pieces);
    }
    for more in [json!({ "points": [[0, 1], [1, 0]] }), json!({ "motion": { "enabled": true } })] {
        let name = more.as_object().unwrap().keys().next().unwrap().clone();
        let text = carriage(json!({ "position_gain": 1 })).with(json!({ "actuators": { "motor": more } }));
        assert_says(refusal(text), &["actuators.motor.control", "cannot have", &name]);
    }
    let fem = definition::four_bar([0.4, 0.15, 0.4, 0.3], [1.0, 0.3, 1.4]).with(json!({
        "actuators": { "motor": { "joint": "a", "control": { "speed_gain": 1 } } },
        "solver": { "method": "rigid_fem", "tolerance": 1e-9 },
    }));
    assert_says(refusal(fem), &["actuators.motor.control", "a controller"]);
}
