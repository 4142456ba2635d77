//! Springs, drives and stops on the angle between two bodies: closed forms of geared shafts, the same torques as
//! external loads, the same elements in a joint, refusals.
use crate::support::definition::{With, four_bar, pin, weight};
use crate::support::{Run, assert_near, assert_rejected};
use serde_json::{Value, json};

/// Moments of inertia of the two shafts [kg.m2].
const INERTIAS: [f64; 2] = [0.2, 0.03];
/// Moment of inertia reduced to the first shaft: the second one turns by -2 for each turn of the first.
const REDUCED: f64 = INERTIAS[0] + 4.0 * INERTIAS[1];

/// Two shafts with a pair of gears, on which elements act between the two shafts.
fn shafts(elements: Value) -> Value {
    json!({
        "name": "Shafts",
        "bodies": { "ground": { "points": { "far": [0.3, 0] } }, "one": { "inertia": INERTIAS[0] },
            "two": { "inertia": INERTIAS[1] }, "flange": { "fixed_to": "two.origin", "angle": 0.4 } },
        "joints": { "a": pin("ground.origin", "one.origin"), "b": pin("ground.far", "two.origin") },
        "couplings": { "mesh": { "type": "gears", "first": "one.origin", "second": "two.origin",
            "first_teeth": 40, "second_teeth": 20 } },
        "start": { "body": "one", "angle": 0 }, "guess": { "one": 0, "two": 0 }, "solver": { "tolerance": 1e-12 },
    })
    .with(elements)
}

fn between(first: &str, second: &str, more: Value) -> Value {
    json!({ "first_body": first, "second_body": second }).with(more)
}

/// The angle of the spring is -3 times that of the first shaft.
#[test]
fn a_spring_between_shafts_swings_as_its_closed_form() {
    let (k, c, free) = (8.0, 0.05, 0.6);
    for (second, shift) in [("two", 0.0), ("flange", 0.4)] {
        let keys = json!({ "stiffness": k, "damping": c, "free_angle": free + shift });
        let mut run = Run::new(shafts(json!({ "springs": { "coil": between("one", second, keys) } }))).started();
        let (decay, rest) = (0.5 * 9.0 * c / REDUCED, -free / 3.0);
        let omega = (9.0 * k / REDUCED - decay * decay).sqrt();
        for step in 1..=40 {
            run.step(0.05);
            let t = 0.05 * f64::from(step);
            let (sin, cos) = (omega * t).sin_cos();
            let shrunk = -rest * (-decay * t).exp();
            let angle = rest + shrunk * (cos + decay / omega * sin);
            let speed = -shrunk * (omega + decay * decay / omega) * sin;
            run.near("one.angle", angle, 1e-10);
            run.near("one.speed", speed, 1e-9);
            run.near("coil.angle", shift - 3.0 * angle, 1e-10);
            run.near("coil.torque", k * (-3.0 * angle - free) - 3.0 * c * speed, 1e-8);
            run.near("energy.drift", 0.0, 1e-10);
        }
    }
}

#[test]
fn a_drive_between_shafts_turns_both() {
    let motor = between("one", "two", json!({ "torque": 5, "efficiency": 0.8, "by_body": true }));
    let mut run = Run::new(shafts(json!({ "actuators": { "motor": motor } }))).started();
    run.near("motor.reduced_inertia", REDUCED / 9.0 / 0.8, 1e-13);
    run.near("motor.one.reduced_inertia", INERTIAS[0] / 9.0 / 0.8, 1e-13);
    run.near("motor.two.reduced_inertia", 4.0 * INERTIAS[1] / 9.0 / 0.8, 1e-13);
    run.near("one.acceleration", -3.0 * 0.8 * 5.0 / REDUCED, 1e-11);
    run.step(0.5);
    run.near("motor.angle", 0.125 * 9.0 * 4.0 / REDUCED, 1e-11);
    run.near("motor.speed", 0.5 * 9.0 * 4.0 / REDUCED, 1e-11);
    run.near("energy.drift", 0.0, 1e-10);
    // A controller on the angle between the shafts: the same rates as a spring.
    let control = json!({ "control": { "position_gain": 8, "command": 0.6 } });
    let mut servo = Run::new(shafts(json!({ "actuators": { "motor": between("one", "two", control) } }))).started();
    let coil = between("one", "two", json!({ "stiffness": 8, "free_angle": 0.6 }));
    let mut spring = Run::new(shafts(json!({ "springs": { "coil": coil } }))).started();
    // A torque-speed curve that is a line: the same as a damper with a constant torque.
    let curve = json!({ "points": [[-100, 15], [100, -5]] });
    let mut starter = Run::new(shafts(json!({ "actuators": { "motor": between("one", "two", curve) } }))).started();
    for step in 1..=20 {
        [&mut servo, &mut spring, &mut starter].into_iter().for_each(|run| run.step(0.07));
        servo.near("one.angle", spring.get("one.angle"), 1e-10);
        servo.near("motor.acting_torque", -spring.get("coil.torque"), 1e-8);
        let rate = 0.9 / REDUCED;
        starter.near("motor.speed", 50.0 * (1.0 - (-rate * 0.07 * f64::from(step)).exp()), 1e-9);
    }
    // A prescribed angle.
    let motion = json!({ "motion": { "profile": "constant_speed", "speed": 0.9 } });
    let mut led = Run::new(shafts(json!({ "actuators": { "motor": between("one", "two", motion) } }))).started();
    led.step(2.0);
    led.near("one.angle", -0.6, 1e-12);
    led.near("two.angle", 1.2, 1e-12);
}

#[test]
fn a_stop_between_shafts_limits_their_angle() {
    let stop = between("one", "two", json!({ "limit": "upper", "angle": 0.5 }));
    let motor = between("one", "two", json!({ "torque": 5 }));
    let text = shafts(json!({ "stops": { "end": stop }, "actuators": { "motor": motor } }));
    let mut run = Run::new(text).started();
    let time = (2.0 * 0.5 * REDUCED / 9.0 / 5.0_f64).sqrt();
    run.step(2.0 * time);
    assert!(run.is("end.reached"));
    run.near("end.impact_time", time, 1e-10);
    run.near("end.impact_impulse", time * 5.0, 1e-9);
    run.near("motor.angle", 0.5, 1e-12);
    run.near("end.torque", -5.0, 1e-10);
}

/// A four-bar with gravity and these elements, moving.
fn machine(elements: Value) -> Value {
    four_bar([0.5, 0.15, 0.4, 0.3], [1.1, 0.35, 1.6])
        .with(json!({ "gravity": weight(), "start": { "speed": 7 }, "solver": { "tolerance": 1e-12 } }))
        .with(elements)
}

/// The torque on the rocker and its opposite on the crank are external torques of the same sizes.
#[test]
fn torques_on_two_bodies_are_those_of_the_spring() {
    let coil = json!({ "stiffness": 3, "damping": 0.1, "free_angle": 0.2, "preload": 0.4,
        "points": [[-2, 1], [0, 0.2], [2, -1.5]], "damping_points": [[-5, -1], [0, 0], [3, 0.4]] });
    let spring = machine(json!({ "springs": { "coil": between("crank", "rocker", coil) } }));
    let torques = json!({ "one": { "on": "crank" }, "other": { "on": "rocker" } });
    let mut run = Run::new(spring).started();
    let mut loaded = Run::new(machine(json!({ "torques": torques })));
    for _ in 0..30 {
        run.step(0.031);
        run.near("energy.drift", 0.0, 1e-9);
        let torque = run.get("coil.torque");
        assert_near(run.get("coil.angle"), run.get("rocker.angle") - run.get("crank.angle"), 1e-13, "angle");
        let [angle, speed] = ["crank.angle", "crank.speed"].map(|name| run.get(name));
        loaded.set_all(&[("one.torque", torque), ("other.torque", -torque)]);
        loaded.place(("crank.start_angle", angle), ("crank.start_speed", speed));
        for name in ["crank.acceleration", "a.force_x", "a.force_y", "b.force_x", "c.force_y", "d.force_x"] {
            let expected = loaded.get(name);
            run.near(name, expected, 1e-8 * expected.abs().max(1.0));
        }
    }
}

/// In a joint and between its two bodies an element is the same.
#[test]
fn between_the_bodies_of_a_joint_an_element_acts_as_in_the_joint() {
    let keys = json!({ "stiffness": 3, "damping": 0.1, "free_angle": 0.2 });
    let drive = json!({ "torque": 0.7, "efficiency": 0.9 });
    let place = |place: Value| {
        let (spring, drive) = (place.clone().with(keys.clone()), place.with(drive.clone()));
        Run::new(machine(json!({ "springs": { "coil": spring }, "actuators": { "motor": drive } }))).started()
    };
    let mut joint = place(json!({ "joint": "b" }));
    let mut bodies = place(between("crank", "coupler", json!({})));
    for _ in 0..10 {
        [&mut joint, &mut bodies].into_iter().for_each(|run| run.step(0.05));
        let names = ["crank.angle", "coil.torque", "motor.angle", "motor.required_force", "c.force_x", "energy.drift"];
        assert_eq!(joint.bits(names), bodies.bits(names));
    }
}

#[test]
fn places_that_are_none_are_refused() {
    let coil = between("one", "two", json!({ "stiffness": 1 }));
    assert_rejected("between bodies", shafts(json!({ "springs": { "coil": coil } })));
}
