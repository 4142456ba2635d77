//! Curves over speed: dampers and drives.
use super::{MASS, body, joint, names};
use crate::support::numeric::runge_kutta;
use crate::support::{CURVES, Run, changed};
use linkage_fmu::numerics::monotone::monotone;
use serde_json::json;

/// A damper that is soft at low speeds, with another law backward.
const DAMPER: [[f64; 2]; 6] = [[-4.0, -80.0], [-1.0, -5.0], [0.0, 0.0], [0.5, 1.0], [1.0, 8.0], [4.0, 30.0]];

#[test]
fn points_of_a_damper_on_a_line_are_its_damping() {
    for is_rotary in [false, true] {
        let mut text = body(is_rotary, [0.2, 5.0]);
        text["springs"] =
            json!({ "d": { "joint": joint(is_rotary), "damping_points": [[-1, -6], [0, 0], [0.5, 3], [2, 12]] } });
        let mut run = Run::new(&text).started();
        for k in 1..=20 {
            run.step(0.1);
            let speed = 5.0 * (-6.0 * 0.1 * f64::from(k) / MASS).exp();
            let [position, rate] = names(is_rotary).map(|name| run.get(name));
            assert!((rate - speed).abs() < 1e-11, "{k}: {rate} {speed}");
            assert!((position - (0.2 + (5.0 - speed) * MASS / 6.0)).abs() < 1e-11);
            assert!(run.get("energy.drift").abs() < 1e-11, "{:e}", run.get("energy.drift"));
        }
    }
}

#[test]
fn motion_and_dissipation_with_a_damper_curve_follow_its_law() {
    let law = monotone(&DAMPER).unwrap();
    let rate = |_: f64, [x, v, _]: [f64; 3]| {
        let force = law.at(v)[0];
        [v, -(force + 300.0 * (x - 0.1)) / MASS, force * v]
    };
    for is_rotary in [false, true] {
        let mut text = body(is_rotary, [0.5, 6.0]);
        let free = if is_rotary { "free_angle" } else { "free_length" };
        let mut spring = json!({ "joint": joint(is_rotary), "stiffness": 300, "damping_points": DAMPER });
        spring[free] = json!(0.1);
        text["springs"] = json!({ "strut": spring });
        let mut run = Run::new(&text).started();
        let before = run.get("energy.kinetic") + run.get("energy.potential");
        for k in 1..=30 {
            run.step(0.05);
            let [x, v, lost] = runge_kutta(rate, [0.5, 6.0, 0.0], 0.05 * f64::from(k), 2000 * k);
            let [position, speed] = names(is_rotary).map(|name| run.get(name));
            assert!((position - x).abs() < 1e-10 && (speed - v).abs() < 1e-9, "{k}: {position} {x}, {speed} {v}");
            let energy = run.get("energy.kinetic") + run.get("energy.potential");
            assert!((before - energy - lost).abs() < 1e-8, "{k}: {:e}", before - energy - lost);
            assert!(run.get("energy.drift").abs() < 1e-9, "{:e}", run.get("energy.drift"));
            let force = if is_rotary { "strut.torque" } else { "strut.force" };
            assert!((run.get(force) - 300.0 * (x - 0.1) - law.at(v)[0]).abs() < 1e-7);
        }
    }
}

#[test]
fn a_motor_on_a_line_of_torque_over_speed_has_its_closed_form() {
    let mut text = body(true, [0.0, 0.0]);
    text["actuators"] = json!({ "motor": { "joint": "hub", "points": [[0, 12], [10, 7], [24, 0]] } });
    let mut run = Run::new(&text).started();
    assert_eq!(run.get("motor.command"), 1.0);
    for command in [1.0, 0.25] {
        run.set("motor.command", command);
        run.initialize();
        let tau = MASS / (0.5 * command);
        for k in 1..=20 {
            run.step(0.5);
            let speed = 24.0 * (1.0 - (-0.5 * f64::from(k) / tau).exp());
            assert!((run.get("wheel.speed") - speed).abs() < 1e-10, "{} {speed}", run.get("wheel.speed"));
            assert!((run.get("motor.acting_torque") - command * (12.0 - 0.5 * speed)).abs() < 1e-10);
            assert!(run.get("energy.drift").abs() < 1e-9);
        }
    }
}

#[test]
fn a_command_that_ramps_scales_the_curve_within_the_step() {
    let points = [[-5.0, 14.0], [0.0, 12.0], [8.0, 10.0], [20.0, 0.0], [30.0, -5.0]];
    let law = monotone(&points).unwrap();
    let mut text = body(false, [0.0, 0.0]);
    text["actuators"] = json!({ "ram": { "joint": "slide", "force": 2, "command": 0, "points": points } });
    let mut run = Run::new(&text).started();
    for _ in 0..8 {
        run.set_derivative("ram.command", 1, 0.5);
        run.set_derivative("ram.command", 2, -0.3);
        run.set_derivative("ram.force", 1, 1.5);
        let (c, f) = (run.get("ram.command"), run.get("ram.force"));
        let start = [run.get("slide.position"), run.get("slide.speed"), 0.0];
        let rate = |t: f64, [_, v, _]: [f64; 3]| {
            let force = f + 1.5 * t + (c + 0.5 * t - 0.15 * t * t) * law.at(v)[0];
            [v, force / MASS, force * v]
        };
        let energy = run.get("energy.kinetic");
        run.step(0.5);
        let [x, v, work] = runge_kutta(rate, start, 0.5, 2000);
        assert!((run.get("slide.position") - x).abs() < 1e-9 && (run.get("slide.speed") - v).abs() < 1e-9);
        assert!((run.get("energy.kinetic") - energy - work).abs() < 1e-8);
        assert!(run.get("energy.drift").abs() < 1e-9, "{:e}", run.get("energy.drift"));
    }
}

/// A drive at rest exerts the force of its curve at speed 0. The one-element outputs include this force.
#[test]
fn a_drive_at_rest_and_its_required_force_know_the_curve() {
    let mut run = Run::new(changed(CURVES, |m| {
        m["actuators"]["motor"].as_object_mut().unwrap().remove("efficiency");
        m["start"]["speed"] = json!(0);
    }))
    .started();
    // The holding force as an input, in addition to the curve, keeps the mechanism at rest.
    let holding = run.get("motor.holding_torque");
    run.set("motor.torque", holding - 0.8 * 8.0);
    run.initialize();
    assert!((run.get("motor.acting_torque") - holding).abs() < 1e-12);
    assert!(run.get("crank.acceleration").abs() < 1e-9, "{:e}", run.get("crank.acceleration"));
    // If the demanded acceleration is the present one, the required force is the acting force, also with losses and
    // friction.
    for efficiency in [None, Some(0.7)] {
        let text = changed(CURVES, |m| {
            let motor = m["actuators"]["motor"].as_object_mut().unwrap();
            motor.remove("efficiency");
            motor.extend(efficiency.map(|eta| ("efficiency".to_owned(), json!(eta))));
            m["friction"]["enabled"] = json!(true);
        });
        for speed in [6.0, -7.0, 25.0, 37.0] {
            let mut run = Run::new(&text).with(&[("crank.start_speed", speed)]).started();
            for (drive, acting) in [("motor", "motor.acting_torque"), ("ram", "ram.acting_force")] {
                let acceleration = run.get(&format!("{drive}.acceleration"));
                run.set(&format!("{drive}.demanded_acceleration"), acceleration);
                let (required, acting) = (run.get(&format!("{drive}.required_force")), run.get(acting));
                assert!(
                    (required - acting).abs() < 1e-8 * (1.0 + acting.abs()),
                    "{drive} {speed}: {required} {acting}"
                );
            }
        }
    }
}

/// The derivative of the holding torque along the drive against finite differences. The other drive's curve at rest
/// counts.
#[test]
fn the_derivative_of_the_holding_force_is_that_of_differences() {
    let at = |angle: f64| {
        let mut run = Run::new(CURVES).with(&[("crank.start_angle", angle)]).started();
        [run.get("motor.holding_torque"), run.get("motor.holding_torque_derivative")]
    };
    for angle in [0.5, 0.9, 2.0, 4.4] {
        let [before, now, after] = [-1e-5, 0.0, 1e-5].map(|d| at(angle + d));
        let slope = (after[0] - before[0]) / 2e-5;
        assert!((slope - now[1]).abs() < 1e-6 * (1.0 + slope.abs()), "{angle}: {slope} {}", now[1]);
    }
}
