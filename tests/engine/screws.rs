//! Screw drives against closed forms: a carriage, and a jib that a spindle between two points lifts.

use crate::support::definition::{With, arm, block, weight};
use crate::support::{Run, Vec2, assert_near, assert_rejected, assert_says, changed, refusal, turned};
use serde_json::{Value, json};
use std::f64::consts::{FRAC_PI_2, TAU};

const SLIDER_CRANK: &str = include_str!("../../modelDescription/SlCrank/resources/mechanism.json");

/// A carriage of 30 kg on a slope of 0.4 rad, driven by a screw with a lead of 5 mm and an inertia of 2e-4 kg.m2.
fn carriage() -> Value {
    block(30.0).with(json!({
        "gravity": weight(), "joints": { "slide": { "axis_angle": 0.4 } },
        "actuators": { "motor": { "joint": "slide", "torque": 0.4, "screw": { "lead": 0.005, "inertia": 2e-4 } } },
        "start": { "position": 0.1 }, "guess": { "slide": 0.1 },
    }))
}

#[test]
fn a_screw_moves_a_carriage_with_its_reflected_inertia() {
    for efficiency in [1.0, 0.6] {
        let text = changed(carriage(), |m| m["actuators"]["motor"]["efficiency"] = json!(efficiency));
        let mut run = Run::new(&text).started();
        let ratio = TAU / 0.005;
        let (mass, weight) = (30.0 + 2e-4 * ratio * ratio, 30.0 * 9.81 * 0.4_f64.sin());
        let acceleration = (efficiency * ratio * 0.4 - weight) / mass;
        run.steps(10, 0.5);
        assert!(acceleration > 0.0);
        assert_near(run.get("slide.acceleration"), acceleration, 1e-13 * ratio * 0.4 / mass, "acceleration");
        let travel = 0.125 * acceleration;
        assert_near(run.get("slide.position"), 0.1 + travel, 1e-9 * travel, "position");
        assert_near(run.get("motor.angle"), ratio * run.get("slide.position"), 1e-12 * ratio, "angle of the screw");
        assert_near(run.get("motor.speed"), ratio * run.get("slide.speed"), 1e-12 * ratio, "speed of the screw");
        let energy = 0.5 * mass * run.get("slide.speed").powi(2);
        assert_near(run.get("energy.kinetic"), energy, 1e-12 * energy, "energy with that of the screw");
        // Inertia at the motor, before the losses.
        let inertia = mass / ratio / ratio / efficiency;
        assert_near(run.get("motor.reduced_inertia"), inertia, 1e-14, "inertia on the screw");
        assert!(run.get("energy.drift").abs() < 1e-9);
    }
}

/// A jib of 2 m and 80 kg with a hinge at the origin, lifted by a spindle from (1, -0.3) to its middle.
fn jib(screw: Value) -> Value {
    let spindle = json!({ "first": "ground.foot", "second": "arm.middle", "torque": 3.0, "screw": screw });
    arm(2.0, 80.0, 0.3).with(json!({
        "gravity": weight(), "actuators": { "spindle": spindle }, "solver": { "tolerance": 1e-12 },
        "bodies": { "ground": { "points": { "foot": [1.0, -0.3] } }, "arm": { "points": { "middle": [1.0, 0.1] } } },
        "start": { "speed": 0.5 },
    }))
}

#[test]
fn a_spindle_between_two_points_obeys_lagrange_and_newton() {
    let mut run = Run::new(jib(json!({ "lead": 0.01, "inertia": 0.003 }))).started();
    let ratio = TAU / 0.01;
    let reflected = 0.003 * ratio * ratio;
    let foot = Vec2::new(1.0, -0.3);
    let spindle = |theta: f64| (turned(Vec2::new(1.0, 0.1), theta) - foot, turned(Vec2::new(-0.1, 1.0), theta));
    for step in 0..40 {
        run.step(0.02);
        run.set("spindle.torque", 3.0 + 0.1 * f64::from(step));
        let [theta, omega, alpha] = ["angle", "speed", "acceleration"].map(|o| run.get(&format!("arm.{o}")));
        let (between, across) = spindle(theta);
        let along = between.normalize();
        // s' = e . r', and s'' by a central difference.
        let slope = |theta: f64| {
            let (between, across) = spindle(theta);
            between.normalize().dot(&across)
        };
        let h = 1e-4;
        let curvature = (slope(theta + h) - slope(theta - h)) / (2.0 * h);
        let s1 = along.dot(&across);
        let inertia = 80.0 * 4.0 / 3.0;
        let second = s1 * alpha + curvature * omega * omega;
        let push = ratio * (3.0 + 0.1 * f64::from(step)) - reflected * second;
        let weight = -80.0 * 9.81 * theta.cos();
        assert_near(inertia * alpha, push * s1 + weight, 1e-5 * (push.abs() + 1000.0), "moments about the pin");
        assert_near(run.get("spindle.acceleration"), ratio * second, 1e-6 * ratio * second.abs().max(1.0), "spindle");
        assert_near(run.get("spindle.angle"), ratio * between.norm(), 1e-11 * ratio, "angle of the spindle");
        // The pin carries the difference of inertia, weight and spindle force. The spindle force follows from the
        // second derivative of the spindle's length.
        let push = ratio * (3.0 + 0.1 * f64::from(step)) - reflected * run.get("spindle.acceleration") / ratio;
        let (tip, normal) = (Vec2::new(theta.cos(), theta.sin()), Vec2::new(-theta.sin(), theta.cos()));
        let acceleration = alpha * normal - omega * omega * tip;
        let need = 80.0 * (acceleration + Vec2::new(0.0, 9.81)) - push * along;
        let pin = run.force("pivot");
        assert!((pin - need).norm() < 1e-11 * (push.abs() + 1e4), "step {step}: {pin} {need}");
        let energy = run.get("energy.kinetic");
        let expected = 0.5 * (inertia + reflected * s1 * s1) * omega * omega;
        assert_near(energy, expected, 1e-12 * expected.max(1.0), "kinetic energy");
        assert!(run.get("energy.drift").abs() < 1e-9 * energy.max(100.0), "{}", run.get("energy.drift"));
    }
}

#[test]
fn a_spindle_between_two_moving_bodies_obeys_newton() {
    let text = changed(SLIDER_CRANK, |m| {
        m["springs"] = json!({});
        m["actuators"] = json!({ "spindle": {
            "first": "crank.middle", "second": "slider.origin", "torque": 0.02,
            "screw": { "lead": 0.1, "inertia": 2e-4 },
        } });
        m["start"]["angle"] = json!(0.7);
    });
    let mut run = Run::new(&text).started();
    let ratio = TAU / 0.1;
    let length = |theta: f64| {
        let slider = 0.5 * theta.cos() + (1.0 - 0.25 * theta.sin().powi(2)).sqrt();
        Vec2::new(slider - 0.25 * theta.cos(), -0.25 * theta.sin())
    };
    for step in 0..30 {
        run.step(0.1);
        let [theta, omega, alpha] = ["angle", "speed", "acceleration"].map(|o| run.get(&format!("crank.{o}")));
        let h = 1e-4;
        let [low, here, high] = [-h, 0.0, h].map(|h| length(theta + h).norm());
        let second = (high - low) / (2.0 * h) * alpha + (high - 2.0 * here + low) / (h * h) * omega * omega;
        let of_spindle = run.get("spindle.acceleration") / ratio;
        assert_near(of_spindle, second, 1e-6 * (alpha.abs() + omega * omega), "acceleration of the length");
        let push = ratio * 0.02 - 2e-4 * ratio * ratio * of_spindle;
        let along = length(theta).normalize();
        let need = run.get("slide.acceleration") - push * along.x;
        assert_near(
            run.get("wrist.force_x"),
            need,
            1e-9 * (1.0 + push.abs()),
            &format!("step {step}: force on the slider"),
        );
    }
}

#[test]
fn without_inertia_a_screw_is_a_force() {
    let mut screw = Run::new(jib(json!({ "lead": 0.01 }))).started();
    let force = changed(jib(json!(null)), |m| {
        let spindle = m["actuators"]["spindle"].as_object_mut().unwrap();
        spindle.remove("screw");
        spindle.remove("torque");
        spindle.insert("force".into(), json!(3.0 * TAU / 0.01));
    });
    let mut force = Run::new(&force).started();
    for _ in 0..20 {
        screw.step(0.02);
        force.step(0.02);
        for name in ["arm.angle", "arm.acceleration", "pivot.force_x", "pivot.force_y"] {
            let [a, b] = [screw.get(name), force.get(name)];
            assert!((a - b).abs() < 1e-11 * b.abs().max(1.0), "{name}: {a} {b}");
        }
    }
}

#[test]
fn wrong_screws_are_rejected() {
    assert_rejected("screws", carriage());
    let other_formulation = changed(jib(json!({ "lead": 0.01 })), |m| {
        m["solver"] = json!({ "method": "rigid_fem", "tolerance": 1e-9, "fem_step": 1e-5 });
        m["bodies"]["arm"]["axial_stiffness"] = json!(1e9);
    });
    assert_says(refusal(other_formulation), &["screw", "solver.method = \"reduced\""]);
}

/// The carriage on a screw of efficiency 0.35 that locks itself, with this torque and speed of the carriage.
pub fn locking(torque: f64, speed: f64) -> Value {
    carriage().with(json!({
        "start": { "speed": speed },
        "actuators": { "motor": { "torque": torque, "efficiency": 0.35, "backward_efficiency": 0 } },
    }))
}

/// A screw that locks itself: upward the nut gets the efficiency times the force of motor and inertia; downward with
/// the load the motor turns the screw alone, and the load moves with it. The second runs have the load upward.
#[test]
fn a_screw_that_locks_itself_carries_its_load() {
    let (eta, inertia, ratio) = (0.35, 2e-4, TAU / 0.005);
    let (screw, load) = (inertia * ratio * ratio, 30.0 * 9.81 * 0.4_f64.sin());
    let limit = load / (eta * ratio);
    for side in [1.0, -1.0] {
        for (torque, speed, expected) in [
            (0.0, 0.0, 0.0),
            (0.99 * limit, 0.0, 0.0),
            (1.5 * limit, 0.0, (1.5 - 1.0) * load / (30.0 + eta * screw)),
            (0.0, 0.2, -load / (30.0 + eta * screw)),
            (0.0, -0.02, 0.0),
            (-0.1, 0.0, -0.1 * ratio / screw),
            (0.05, -0.3, 0.05 * ratio / screw),
        ] {
            let gravity = json!({ "gravity": { "up_angle": side * FRAC_PI_2 } });
            let mut run = Run::new(locking(side * torque, side * speed).with(gravity)).started();
            let what = format!("torque {torque}, speed {speed}, side {side}");
            let a = side * expected;
            assert_near(run.get("slide.acceleration"), a, 1e-9 * load / 30.0, &what);
            let motion = [torque, expected, speed].iter().any(|x| *x != 0.0) && (expected, speed) != (0.0, 0.0);
            assert_eq!(run.is("friction.sticking"), !motion, "{what}");
            // Force on the nut, and that of motor and inertia; the loss is their difference.
            let [on_nut, of_motor] = [30.0 * expected + load, ratio * torque - screw * expected];
            if motion {
                assert_near(run.get("motor.loss_force"), side * (on_nut - of_motor), 1e-8 * load, &what);
                assert_near(on_nut * (of_motor - eta.recip() * on_nut) * of_motor, 0.0, 1e-8 * load.powi(3), &what);
            }
            if speed == 0.0 && torque == 0.0 {
                let [up, down] = ["forward", "backward"].map(|way| run.get(&format!("motor.breakaway_torque_{way}")));
                let [up, down] = if side > 0.0 { [up, down] } else { [-down, -up] };
                assert_near(up, limit, 1e-10 * limit, &what);
                assert_near(down, 0.0, 1e-10 * limit, &what);
            }
            run.repeats(|run| run.steps(5, 0.05));
            let start = 0.1 + side * speed * 0.05 + 0.5 * a * 0.05 * 0.05;
            assert_near(run.get("slide.position"), start, 1e-9, &what);
            assert!(run.get("energy.drift").abs() < 1e-9, "{what}");
        }
    }
}

/// The torque that a prescribed motion needs moves the screw in the same way.
#[test]
fn a_screw_that_locks_itself_follows_a_motion() {
    let (eta, inertia, ratio) = (0.35, 2e-4, TAU / 0.005);
    let (screw, load) = (inertia * ratio * ratio, 30.0 * 9.81 * 0.4_f64.sin());
    for distance in [20.0, -20.0] {
        let motion = json!({ "profile": "cycloidal", "duration": 1, "distance": distance });
        let mut text = carriage().with(json!({
            "actuators": { "motor": { "efficiency": eta, "backward_efficiency": 0, "motion": motion } },
        }));
        text["actuators"]["motor"].as_object_mut().unwrap().remove("torque");
        let mut run = Run::new(text).started();
        for k in 1..20 {
            run.step(0.05);
            let a = distance * TAU * (TAU * 0.05 * f64::from(k)).sin() / ratio;
            run.near("slide.acceleration", a, 1e-9);
            let on_nut = 30.0 * a + load;
            let of_motor = if distance > 0.0 { on_nut / eta } else { 0.0 };
            run.near("motor.acting_torque", (of_motor + screw * a) / ratio, 1e-10);
            run.near("energy.drift", 0.0, 1e-9);
        }
    }
}
