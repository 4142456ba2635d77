//! Prescribed motion of a drive: closed forms of kinematics and force, inverse against forward dynamics, the energy
//! balance, switches between motion and force, and what a mechanism cannot do.
use crate::support::{BUCKET, GEAR, Run, assert_says, changed};
use linkage_fmu::mechanism::Model;
use serde_json::{Value, json};
use std::f64::consts::{PI, TAU};

const MASS: f64 = 2.0;
const G: f64 = 9.81;

/// A mass on a vertical slide, lifted by a drive with this motion.
fn lift(motion: &Value) -> Value {
    json!({
        "name": "Lift",
        "bodies": { "ground": {}, "load": { "mass": MASS, "inertia": 1, "center": [0, 0] } },
        "joints": {
            "slide": {
                "type": "prismatic", "first": "ground.origin", "second": "load.origin", "axis_angle": PI / 2.0, "angle": 0,
            },
        },
        "actuators": { "winch": { "joint": "slide", "motion": motion } },
        "guess": { "slide": 0 },
        "start": { "joint": "slide", "position": 0.5, "speed": 0 },
        "gravity": { "acceleration": G, "up_angle": PI / 2.0 },
    })
}

/// A crank of radius 0.1 m with a rod of 0.35 m without mass and a piston of 3 kg, driven by a torque on the crank.
fn slider_crank(motion: &Value) -> Value {
    json!({
        "name": "SliderCrank",
        "bodies": {
            "ground": {},
            "crank": { "length": 0.1, "mass": 1.5, "shape": "uniform_rod" },
            "rod": { "length": 0.35, "mass": 0, "shape": "uniform_rod" },
            "piston": { "mass": 3, "inertia": 0, "center": [0, 0] },
        },
        "joints": {
            "bearing": { "type": "revolute", "first": "ground.origin", "second": "crank.origin" },
            "pin": { "type": "revolute", "first": "crank.end", "second": "rod.origin" },
            "wrist": { "type": "revolute", "first": "rod.end", "second": "piston.origin" },
            "slide": {
                "type": "prismatic", "first": "ground.origin", "second": "piston.origin", "axis_angle": 0, "angle": 0,
            },
        },
        "actuators": { "motor": { "joint": "bearing", "motion": motion } },
        "guess": { "crank": 0.3, "rod": -0.1, "slide": 0.44 },
        "start": { "body": "crank", "angle": 0.3, "speed": 0 },
    })
}

fn opened(definition: &Value) -> Run {
    Run::new(&definition.to_string())
}

/// The gear whose actuator has a motion, with more changes.
fn gear(motion: &Value, change: impl FnOnce(&mut Value)) -> Run {
    let text = changed(GEAR, |gear| {
        gear["actuators"]["actuator"]["motion"] = motion.clone();
        gear["solver"] = json!({ "tolerance": 1e-10 });
        change(gear);
    });
    Run::new(&text)
}

/// Length of the actuator from gear down to gear up.
fn stroke() -> f64 {
    let at = |angle| Run::gear().with(&[("crank.start_angle", angle)]).started().get("actuator.length");
    at(-1.3) - at(0.8)
}

#[track_caller]
fn is_close(value: f64, exact: f64, size: f64) {
    assert!((value - exact).abs() <= size, "{value} for {exact}: {:e}", value - exact);
}

#[test]
fn a_mass_lifted_by_a_cycloid_takes_m_times_g_plus_a() {
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
        is_close(crank.get("slide.position"), r * cos + root, 1e-13);
        is_close(crank.get("slide.speed"), first * omega, 1e-11);
        is_close(crank.get("slide.acceleration"), second * omega * omega, 1e-9);
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
            // The parabola that has the force at both ends of the step and its rate at the first.
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

#[test]
fn steps_of_any_size_give_the_same_motion_and_force() {
    let shapes = [
        json!({ "profile": "trapezoid", "distance": 0.25, "speed": 0.4, "acceleration": 2 }),
        json!({ "profile": "polynomial_345", "duration": 0.8, "distance": 0.25 }),
        json!({ "profile": "table", "points": [[0, 0], [0.3, 0.2], [0.5, 0.1], [0.8, 0.25], [0.9, 0.25]] }),
    ];
    for motion in shapes {
        let run = |steps: u32| {
            let mut gear = gear(&motion, |gear| gear["friction"]["enabled"] = json!(true)).started();
            (0..steps).for_each(|_| gear.step(0.75 / f64::from(steps)));
            let drift = gear.get("energy.drift");
            assert!(drift.abs() < 1e-5, "{motion} {steps}: {drift}");
            ["crank.angle", "crank.speed", "actuator.acting_force", "joint3.force"].map(|name| gear.get(name))
        };
        let [one, many] = [run(1), run(311)];
        for (a, b) in one.into_iter().zip(many) {
            is_close(a, b, 1e-9 * a.abs().max(1.0));
        }
    }
}

#[test]
fn a_trapezoid_has_the_acceleration_that_follows_at_its_kinks() {
    let motion = json!({ "profile": "trapezoid", "distance": -1, "speed": 1, "acceleration": 4, "start_time": 0.5 });
    let mut lift = opened(&lift(&motion)).started();
    let forces: Vec<f64> = (0..9)
        .map(|_| {
            let force = lift.get("winch.acting_force") / MASS - G;
            lift.step(0.25);
            force
        })
        .collect();
    for (k, (force, expected)) in forces.into_iter().zip([0.0, 0.0, -4.0, 0.0, 0.0, 0.0, 4.0, 0.0, 0.0]).enumerate() {
        is_close(force, expected, 1e-12 * (k as f64 + 10.0));
    }
    is_close(lift.get("slide.position"), -0.5, 1e-14);
}

#[test]
fn a_drive_is_switched_between_motion_and_force_in_a_run() {
    let mut lift = opened(&lift(&json!({ "position": 0.5 })));
    lift.set("winch.motion.speed", 1.0);
    let mut lift = lift.started();
    lift.listen(true, false);
    lift.step(0.5);
    is_close(lift.get("slide.position"), 1.0, 1e-14);
    // Without force: free fall from 1 m at 1 m/s.
    lift.set("winch.motion.enabled", false);
    lift.set("winch.force", 0.0);
    lift.step(0.25);
    let (position, speed) = (1.0 + 0.25 - 0.5 * G * 0.0625, 1.0 - G * 0.25);
    is_close(lift.get("slide.position"), position, 1e-12);
    is_close(lift.get("slide.speed"), speed, 1e-12);
    assert!(lift.get("energy.drift").abs() < 1e-10);
    // Caught at another speed: the impulse is told.
    let here = lift.get("slide.position");
    lift.set("winch.motion.enabled", true);
    lift.set("winch.motion.position", here);
    lift.set("winch.motion.speed", -0.2);
    is_close(lift.get("slide.speed"), -0.2, 1e-14);
    lift.step(0.1);
    let told: Vec<String> = lift.take_occurrences(0.75).into_iter().map(|line| line.text).collect();
    assert_says(&told[0], &["t = 0.75 s", "the motion of winch", "speed jumps by 1.2525 m/s", "2.505 N.s"]);
    is_close(lift.get("slide.position"), position - 0.02, 1e-12);
    assert!(lift.get("energy.drift").abs() < 1e-10, "{}", lift.get("energy.drift"));
    // Somewhere else than where the drive is: refused, and nothing has changed.
    lift.set("winch.motion.enabled", false);
    lift.step(0.01);
    let before = lift.get("slide.position");
    lift.set("winch.motion.enabled", true);
    lift.set("winch.motion.position", 7.0);
    assert!(lift.0.get("slide.position").is_ok_and(f64::is_nan));
    assert_says(
        lift.0.step(0.01).unwrap_err(),
        &["winch.position = 7", "the drive is at 0.92", "set winch.motion.position to this"],
    );
    lift.set("winch.motion.enabled", false);
    assert_eq!(lift.get("slide.position"), before);
    lift.step(0.01);
}

#[test]
fn a_motion_ends_at_a_stop_and_is_refused_beyond_it() {
    let motion = |distance: f64| json!({ "profile": "cycloidal", "duration": 0.5, "distance": distance });
    let mut up = gear(&motion(stroke()), |_| {}).started();
    up.set("uplock.engage", true);
    (0..10).for_each(|_| up.step(0.06));
    assert!(up.is("retracted"));
    assert_eq!(up.get("crank.speed"), 0.0);
    // The lock then holds the gear against the forces.
    up.set("actuator.motion.enabled", false);
    up.set("actuator.force", 0.0);
    up.step(0.5);
    assert!(up.is("retracted") && up.get("crank.speed") == 0.0);
    let mut beyond = gear(&motion(stroke() + 0.01), |_| {}).started();
    let mut refused = None;
    for _ in 0..10 {
        if let Err(error) = beyond.0.step(0.06) {
            refused = Some(error);
            break;
        }
    }
    let words = ["actuator.length = 0.7", "upstop ends the travel at 0.736", "set the stop's enabled to false"];
    assert_says(refused.unwrap(), &words);
    let time = beyond.0.time();
    assert!(beyond.get("actuator.acting_force").is_finite() && time < 0.5);
}

#[test]
fn a_lock_that_is_engaged_is_not_torn() {
    let motion = json!({ "profile": "cycloidal", "duration": 0.5, "distance": 0.2 });
    let mut gear = gear(&motion, |_| {}).started();
    gear.set("downlock.engage", true);
    assert_says(gear.0.step(0.1).unwrap_err(), &["actuator.length = ", "a lock at downstop is engaged", "disengage"]);
    gear.set("downlock.engage", false);
    gear.step(0.1);
}

#[test]
fn a_dead_point_is_told_and_nothing_hangs() {
    // The piston drives: it turns back at 0.45 m.
    let definition = |motion: &Value| {
        let mut crank = slider_crank(&json!(null));
        crank["actuators"] = json!({ "ram": { "joint": "slide", "motion": motion } });
        crank
    };
    let mut crank = opened(&definition(&json!({ "position": 0.44 }))).started();
    crank.set("ram.motion.speed", 1.0);
    crank.step(0.005);
    let error = crank.0.step(1.0).unwrap_err();
    assert_says(error, &["ram.position = ", "a dead point near 0.4", "let the motion end before"]);
    crank.set("ram.motion.position", 0.46);
    assert!(crank.0.get("crank.angle").is_ok_and(f64::is_nan));
    assert_says(crank.undefined("crank.angle"), &["ram.position = 0.46", "dead point"]);
    crank.set("ram.motion.position", 0.44);
    crank.set("ram.motion.speed", -0.5);
    crank.step(0.1);
    is_close(crank.get("slide.position"), 0.39, 1e-13);
    let error = Model::from_json(&definition(&json!({ "position": 0.6 })).to_string()).unwrap_err();
    assert_says(error, &["ram.position = 0.6", "dead point"]);
}

#[test]
fn bumpers_and_springs_are_in_the_force_and_in_the_balance() {
    let motion = json!({ "profile": "polynomial_345", "duration": 1, "distance": 0.6 });
    let mut definition = lift(&motion);
    definition["stops"] = json!({
        "buffer": { "joint": "slide", "limit": "upper", "position": 0.9, "rigid": false, "stiffness": 4000, "damping": 50 },
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

#[test]
fn friction_that_locks_the_mechanism_against_its_drive_is_told() {
    let text = changed(BUCKET, |bucket| {
        let drives = bucket["actuators"].as_object_mut().unwrap();
        let name = drives.keys().next().unwrap().clone();
        drives[&name]["motion"] = json!({ "profile": "cycloidal", "duration": 2, "distance": 0.05 });
    });
    let mut bucket = Run::new(&text).started();
    for _ in 0..20 {
        match bucket.0.step(0.1) {
            Ok(()) => assert!(bucket.get("energy.drift").abs() < 1.0, "{}", bucket.get("energy.drift")),
            Err(error) => return assert_says(error, &["friction locks", "let the motion end before"]),
        }
    }
}

#[test]
fn a_saved_state_goes_on_to_the_bit() {
    let motions = [
        json!({ "profile": "trapezoid", "distance": 0.3, "speed": 0.5, "acceleration": 3 }),
        json!({ "position": 0.45 }),
    ];
    for motion in motions {
        let mut gear = gear(&motion, |gear| gear["friction"]["enabled"] = json!(true));
        let by_inputs = motion.get("position").is_some();
        if by_inputs {
            gear.set("actuator.motion.acceleration", 0.4);
        }
        let mut gear = gear.started();
        let names = ["crank.angle", "crank.speed", "actuator.acting_force", "joint1.force_x", "energy.drift"];
        for n in 0..12 {
            let mut bytes = Vec::new();
            gear.snapshot().write(&mut bytes).unwrap();
            let mut twin = Run::new(&changed(GEAR, |definition| {
                definition["actuators"]["actuator"]["motion"] = motion.clone();
                definition["solver"] = json!({ "tolerance": 1e-10 });
                definition["friction"]["enabled"] = json!(true);
            }));
            let read = twin.read_snapshot(&bytes).unwrap();
            twin.restore(&read).unwrap();
            let mut quiet = gear.clone();
            for run in [&mut gear, &mut twin, &mut quiet] {
                if n == 5 {
                    run.set("actuator.motion.enabled", false);
                    run.set("actuator.force", 2e4);
                }
                if n == 6 {
                    let length = run.clone().get("actuator.length");
                    run.set("actuator.motion.enabled", true);
                    if by_inputs {
                        run.set("actuator.motion.position", length);
                    }
                }
                if n == 9 && by_inputs {
                    let position = run.clone().get("actuator.motion.position");
                    run.set("actuator.motion.position", position + 1e-5);
                }
            }
            // Reading before the step changes nothing.
            names.iter().for_each(|name| {
                gear.get(name);
            });
            [&mut gear, &mut twin, &mut quiet].into_iter().for_each(|run| Model::step(run, 0.013).unwrap());
            for name in names {
                let bits = [&mut gear, &mut twin, &mut quiet].map(|run| run.get(name).to_bits());
                assert!(bits[0] == bits[1] && bits[0] == bits[2], "{motion} {n} {name}: {bits:?}");
            }
        }
    }
}

#[test]
fn a_profile_begins_anew_where_the_drive_is_when_it_is_enabled_again() {
    let motion = json!({ "profile": "cycloidal", "duration": 0.5, "distance": 0.3, "enabled": false });
    let mut lift = opened(&lift(&motion));
    lift.set("winch.force", MASS * G);
    let mut lift = lift.started();
    lift.step(1.0);
    is_close(lift.get("slide.position"), 0.5, 1e-13);
    for stroke in 1..4 {
        lift.set("winch.motion.enabled", true);
        lift.step(0.6);
        is_close(lift.get("slide.position"), 0.5 + 0.3 * f64::from(stroke), 1e-12);
        lift.set("winch.motion.enabled", false);
        lift.step(0.1);
        assert!(lift.get("energy.drift").abs() < 1e-9);
    }
}

#[test]
fn definitions_that_make_no_motion_are_refused_by_name() {
    let refused = |motion: &Value, words: &[&str]| {
        assert_says(Model::from_json(&lift(motion).to_string()).unwrap_err(), words);
    };
    refused(&json!({}), &["actuators.winch.motion", "without a profile asks for position"]);
    refused(&json!({ "profile": "cycloidal", "duration": 1 }), &["this profile asks for distance"]);
    refused(&json!({ "profile": "cycloidal", "duration": 0, "distance": 1 }), &["motion.duration = 0", "> 0"]);
    refused(
        &json!({ "profile": "trapezoid", "distance": 1, "speed": 1, "acceleration": 1, "duration": 2 }),
        &["motion.duration", "a trapezoid does not use it"],
    );
    refused(&json!({ "profile": "table", "points": [[0, 0], [0, 1]] }), &["motion.points", "ascending times"]);
    refused(&json!({ "position": 1, "start_time": 1 }), &["motion.start_time", "does not use it"]);
    refused(&json!({ "profile": "sine" }), &["actuators.winch.motion.profile", "sine"]);
    let mut two = slider_crank(&json!({ "position": 0.3 }));
    two["actuators"]["ram"] = json!({ "joint": "slide", "motion": { "position": 0.44 } });
    assert_says(Model::from_json(&two.to_string()).unwrap_err(), &["motor has a motion already"]);
    let mut equilibrium = lift(&json!({ "position": 0.5 }));
    equilibrium["start"] = json!("equilibrium");
    assert_says(Model::from_json(&equilibrium.to_string()).unwrap_err(), &["the motion holds the mechanism"]);
    let mut lift = opened(&lift(&json!({ "position": 0.5 }))).started();
    let error = lift.0.set_derivative("winch.motion.position", 1, 1.0).unwrap_err();
    assert_says(error, &["winch.motion.position", "it is the input winch.motion.speed"]);
    assert!(lift.continuous_time().is_none());
    assert_says(lift.serve_exchange().unwrap_err(), &["motion of a drive", "use co-simulation"]);
}

/// A profile that takes a millisecond of a step of hours is resolved as in a step of its own.
#[test]
fn a_short_profile_in_a_long_step_keeps_the_energy() {
    let profile = json!({ "profile": "cycloidal", "distance": 2.5, "duration": 1e-3 });
    let mut crank = opened(&slider_crank(&profile)).started();
    let mut twin = opened(&slider_crank(&profile)).started();
    twin.step(5e-4);
    let most = twin.get("energy.kinetic");
    assert!(most > 1e4, "{most}");
    crank.step(1e4);
    is_close(crank.get("crank.angle"), 2.8, 1e-12);
    assert!(crank.get("energy.drift").abs() < 1e-8 * most, "{}", crank.get("energy.drift"));
}

/// Time has few digits left within a step that begins late; the motion within it does not show this.
#[test]
fn a_profile_that_begins_late_is_followed() {
    let profile = json!({ "profile": "polynomial_4567", "distance": 2.5, "duration": 0.8, "start_time": 1e8 });
    let mut crank = opened(&slider_crank(&profile)).started();
    crank.step(1e8);
    is_close(crank.get("crank.angle"), 0.3, 1e-12);
    crank.step(0.4);
    is_close(crank.get("crank.angle"), 0.3 + 1.25, 1e-12);
    crank.step(0.5);
    is_close(crank.get("crank.angle"), 2.8, 1e-12);
    assert!(crank.get("energy.drift").abs() < 1e-8);
}

/// A table may begin at any speed; until its time comes the drive is at rest.
#[test]
fn a_table_waits_at_rest_for_its_time() {
    let table = json!({ "profile": "table", "points": [[0, 0], [1, 2]], "start_time": 0.5 });
    let mut lift = opened(&lift(&table)).started();
    for _ in 0..2 {
        is_close(lift.get("slide.position"), 0.5, 1e-13);
        assert_eq!(lift.get("slide.speed"), 0.0);
        lift.step(0.2);
    }
    lift.step(0.6);
    is_close(lift.get("slide.position"), 0.5 + 2.0 * 0.5, 1e-12);
    is_close(lift.get("slide.speed"), 2.0, 1e-12);
    // The drive grips at 0.5 s: the mass gets its speed at once, which is work.
    assert!(lift.get("energy.drift").abs() < 1e-9, "{}", lift.get("energy.drift"));
}

#[test]
fn a_motion_that_begins_elsewhere_than_the_start_is_warned_of() {
    let warned = |motion: &Value| -> Vec<String> {
        opened(&lift(motion)).0.model().warnings().iter().map(ToString::to_string).collect()
    };
    for (motion, words) in [
        (json!({ "position": 0.8 }), ["motion.position", "begins at 0.8", "the drive at 0.5"]),
        (
            json!({ "profile": "table", "points": [[0, 0.7], [1, 1]] }),
            ["motion.points", "begins at 1.2", "be 0 at time 0"],
        ),
    ] {
        let all = warned(&motion);
        assert_eq!(all.len(), 1, "{all:?}");
        assert_says(&all[0], &words);
    }
    for motion in [
        json!({ "position": 0.5 }),
        json!({ "position": 0.8, "enabled": false }),
        json!({ "profile": "cycloidal", "distance": 0.3, "duration": 1 }),
    ] {
        assert_eq!(warned(&motion), Vec::<String>::new());
    }
}
