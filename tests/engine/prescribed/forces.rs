//! The drive force of a prescribed motion: closed forms, forward simulation, exact derivatives.
use super::{G, MASS, gear, is_close, lift, opened, slider_crank, stroke};
use crate::support::Run;
use serde_json::{Value, json};
use std::f64::consts::TAU;

#[test]
fn a_mass_lifted_by_a_cycloid_needs_the_force_m_times_g_plus_a() {
    let (distance, duration) = (1.7, 0.8_f64);
    let motion = json!({ "profile": "cycloidal", "start_time": 0.1, "duration": duration, "distance": distance });
    for h in [0.003, 0.05, 0.3] {
        let mut lift = opened(&lift(&motion)).started();
        let mut t = 0.0_f64;
        while t < 1.2 {
            let u = ((t - 0.1) / duration).clamp(0.0, 1.0);
            let s = distance * (u - (TAU * u).sin() / TAU);
            let a = distance * TAU / duration.powi(2) * (TAU * u).sin();
            is_close(lift.get("slide.position"), 0.5 + s, 1e-13);
            is_close(lift.get("slide.acceleration"), a, 1e-11);
            is_close(lift.get("winch.acting_force"), MASS * (G + a), 1e-10);
            assert!(lift.get("energy.drift").abs() < 1e-10, "{t} {}", lift.get("energy.drift"));
            lift.step(h);
            t += h;
        }
    }
}

#[test]
fn a_slider_crank_at_constant_speed_has_the_torque_of_its_piston() {
    let omega = 40.0;
    let mut crank = opened(&slider_crank(&json!({ "position": 0.3 })));
    crank.set("motor.motion.speed", omega);
    let mut crank = crank.started();
    let (r, l, m) = (0.1_f64, 0.35_f64, 3.0);
    let h = 0.01;
    for n in 0..100 {
        let phi = 0.3 + omega * h * f64::from(n);
        let (sin, cos) = phi.sin_cos();
        let root = (l * l - (r * sin).powi(2)).sqrt();
        // x = r cos + root, with derivatives along phi.
        let first = -r * sin - r * r * sin * cos / root;
        let second = -r * cos - r * r * (cos * cos - sin * sin) / root - (r * r * sin * cos).powi(2) / root.powi(3);
        is_close(crank.get("crank.angle"), phi, 1e-12 * phi);
        is_close(crank.get("guide.position"), r * cos + root, 1e-13);
        is_close(crank.get("guide.speed"), first * omega, 1e-11);
        is_close(crank.get("guide.acceleration"), second * omega * omega, 1e-9);
        is_close(crank.get("motor.acting_torque"), m * first * second * omega * omega, 1e-9);
        assert!(crank.get("energy.drift").abs() < 1e-8, "{}", crank.get("energy.drift"));
        crank.step(h);
    }
}

#[test]
fn the_force_of_a_smooth_motion_makes_the_same_motion_in_the_forward_model() {
    let motion = json!({ "profile": "polynomial_4567", "duration": 1.0, "distance": stroke() - 1e-3 });
    for friction in [false, true] {
        let change = |gear: &mut Value| gear["friction"]["enabled"] = json!(friction);
        let mut driven = gear(&motion, change).started();
        let mut forward = Run::gear().with(&[("solver.tolerance", 1e-10)]);
        forward.set("friction.enabled", friction);
        let mut forward = forward.started();
        let (h, steps) = (5e-4, 1400);
        let mut worst = 0.0_f64;
        for _ in 0..steps {
            let [force, rate] = [driven.get("actuator.acting_force"), driven.derivative("actuator.acting_force")];
            is_close(driven.get("actuator.acting_force"), force, 0.0);
            driven.step(h);
            let next = driven.get("actuator.acting_force");
            forward.set("actuator.force", force);
            forward.set_derivative("actuator.force", 1, rate);
            // The parabola with the force at both ends of the step and its rate at the start.
            forward.set_derivative("actuator.force", 2, 2.0 * (next - force - rate * h) / (h * h));
            forward.step(h);
            worst = worst.max((driven.get("crank.angle") - forward.get("crank.angle")).abs());
        }
        assert!(worst < 1e-6, "{friction}: {worst:e}");
        assert!(driven.get("energy.drift").abs() < 1e-6, "{friction}: {}", driven.get("energy.drift"));
    }
}

#[test]
fn required_force_with_the_prescribed_acceleration_is_the_acting_force() {
    let motion = json!({ "profile": "cycloidal", "duration": 1.0, "distance": stroke() });
    let mut gear = gear(&motion, |gear| {
        gear["friction"]["enabled"] = json!(true);
        gear["actuators"]["actuator"]["efficiency"] = json!(0.8);
        gear["air"]["airspeed"] = json!(70);
    });
    gear.set("actuator.force", 0.0);
    let mut gear = gear.started();
    for _ in 0..9 {
        gear.step(0.1);
        let (force, acceleration) = (gear.get("actuator.acting_force"), gear.get("actuator.acceleration"));
        gear.set("actuator.demanded_acceleration", acceleration);
        is_close(gear.get("actuator.required_force"), force, 1e-9 * force.abs());
        assert!(gear.get("energy.drift").abs() < 2e-6, "{}", gear.get("energy.drift"));
    }
    gear.step(0.1);
    assert!(gear.is("retracted"));
}

#[test]
fn each_output_has_its_exact_derivatives_by_the_motion() {
    let mut gear = gear(&json!({ "position": 0.55 }), |gear| gear["friction"]["enabled"] = json!(true));
    let given = [("actuator.motion.speed", 0.4), ("actuator.motion.acceleration", -1.2)];
    given.iter().for_each(|(name, value)| gear.set(name, *value));
    let mut gear = gear.started();
    let inputs = ["position", "speed", "acceleration"].map(|word| format!("actuator.motion.{word}"));
    let outputs = ["crank.angle", "crank.speed", "crank.acceleration", "actuator.acting_force", "joint2.force_x"];
    for input in &inputs {
        let known = gear.0.reference(input).unwrap();
        let now = gear.get(input);
        for output in outputs {
            let unknown = gear.0.reference(output).unwrap();
            let mut exact = f64::NAN;
            gear.directional_derivative(&[unknown], &[known], &[1.0], &mut |_, d| exact = d).unwrap();
            let h = 1e-5;
            let mut at = |value| {
                gear.set(input, value);
                gear.get(output)
            };
            let difference = (at(now + h) - at(now - h)) / (2.0 * h);
            at(now);
            let size = difference.abs().max(1e-3 * gear.get(output).abs()).max(1e-3);
            assert!((exact - difference).abs() < 1e-6 * size, "{output} by {input}: {exact} {difference}");
        }
    }
    // Rates in time, under a jerk.
    gear.set_derivative(&inputs[2], 1, 7.0);
    let h = 1e-5;
    let rates = outputs.map(|output| gear.derivative(output));
    let before = outputs.map(|output| gear.get(output));
    let mut middle = gear.clone();
    middle.step(h);
    gear.step(2.0 * h);
    for (k, output) in outputs.iter().enumerate() {
        let rate = (4.0 * middle.get(output) - 3.0 * before[k] - gear.get(output)) / (2.0 * h);
        let size = rate.abs().max(before[k].abs());
        assert!((rates[k] - rate).abs() < 1e-4 * size, "{output}: {} {rate}", rates[k]);
    }
}

/// Also where the outputs were read before the jerk was set, and where the jerk ends as the acceleration is set.
#[test]
fn the_rate_of_the_force_follows_the_jerk_of_the_inputs() {
    let mut lift = opened(&lift(&json!({ "position": 0.5 }))).started();
    lift.set("winch.motion.acceleration", 1.0);
    is_close(lift.get("winch.acting_force"), MASS * (G + 1.0), 1e-12);
    lift.set_derivative("winch.motion.acceleration", 1, 7.0);
    is_close(lift.derivative("winch.acting_force"), MASS * 7.0, 1e-12);
    lift.step(0.01);
    is_close(lift.derivative("winch.acting_force"), MASS * 7.0, 1e-12);
    let acceleration = lift.get("winch.motion.acceleration");
    lift.set("winch.motion.acceleration", acceleration);
    is_close(lift.derivative("winch.acting_force"), 0.0, 1e-12);
}

#[test]
fn bumpers_and_springs_are_in_the_force_and_in_the_balance() {
    let motion = json!({ "profile": "polynomial_345", "duration": 1, "distance": 0.6 });
    let mut definition = lift(&motion);
    definition["stops"] = json!({
        "buffer": { "joint": "slide", "limit": "upper", "position": 0.9, "rigid": false, "stiffness": 4000,
            "damping": 50 },
    });
    definition["springs"] =
        json!({ "spring": { "joint": "slide", "stiffness": 100, "damping": 20, "free_length": 0.2 } });
    let mut lift = opened(&definition).started();
    for n in 0..100 {
        let [s, v, a] = ["slide.position", "slide.speed", "slide.acceleration"].map(|name| lift.get(name));
        let push = if s > 0.9 { (4000.0 * (s - 0.9) + 50.0 * v).max(0.0) } else { 0.0 };
        let exact = MASS * (G + a) + 100.0 * (s - 0.2) + 20.0 * v + push;
        is_close(lift.get("winch.acting_force"), exact, 1e-9);
        assert!(lift.get("energy.drift").abs() < 1e-4, "{n}: {}", lift.get("energy.drift"));
        lift.step(0.01);
    }
    assert!(lift.get("slide.position") > 1.09);
}
