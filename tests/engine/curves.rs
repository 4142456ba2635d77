//! Dampers and drives with a curve over the speed, bumpers with a curve over the depth, springs with a curve over several
//! revolutions: against closed forms, Runge-Kutta's method, the energy, and constant loads of the same size.

use crate::support::{CURVES, FOUR_BAR, Run, assert_says, changed, reals, values};
use linkage_fmu::mechanism::Model;
use linkage_fmu::numerics::monotone::monotone;
use linkage_fmu::numerics::piecewise::Piecewise;
use linkage_fmu::simulation::Simulation;
use linkage_fmu::variables::Causality;
use serde_json::{Value, json};

/// Mass of the carriage [kg], moment of inertia of the wheel [kg.m2].
const MASS: f64 = 3.0;

/// A carriage on a level rail, or a wheel on a bearing, with a start position and a start speed.
fn body(is_rotary: bool, [start, speed]: [f64; 2]) -> Value {
    let (joint, mass, at) = match is_rotary {
        true => (json!({ "type": "revolute" }), json!({ "mass": 1, "inertia": MASS }), json!({ "body": "part" })),
        false => (json!({ "type": "prismatic", "axis_angle": 0 }), json!({ "mass": MASS }), json!({ "joint": "way" })),
    };
    let (mut joint, mut at) = (joint, at);
    (joint["first"], joint["second"]) = (json!("ground.origin"), json!("part.origin"));
    at[if is_rotary { "angle" } else { "position" }] = json!(start);
    at["speed"] = json!(speed);
    let guess = if is_rotary { json!({ "part": start }) } else { json!({ "way": start }) };
    json!({
        "name": "Part", "bodies": { "ground": {}, "part": mass }, "joints": { "way": joint }, "start": at, "guess": guess,
        "solver": { "tolerance": 1e-12 },
    })
}

/// Names of position and speed.
fn names(is_rotary: bool) -> [&'static str; 2] {
    if is_rotary { ["part.angle", "part.speed"] } else { ["way.position", "way.speed"] }
}

/// A state after a time by the classical Runge-Kutta method, in so many steps.
fn runge_kutta<const N: usize>(
    rate: impl Fn(f64, [f64; N]) -> [f64; N],
    start: [f64; N],
    span: f64,
    steps: u32,
) -> [f64; N] {
    let (mut y, h) = (start, span / f64::from(steps));
    for step in 0..steps {
        let t = h * f64::from(step);
        let add = |k: [f64; N], part: f64| std::array::from_fn(|i| y[i] + part * h * k[i]);
        let k1 = rate(t, y);
        let k2 = rate(t + 0.5 * h, add(k1, 0.5));
        let k3 = rate(t + 0.5 * h, add(k2, 0.5));
        let k4 = rate(t + h, add(k3, 1.0));
        y = std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
    }
    y
}

/// A damper that is soft at low speeds, with another law backward.
const DAMPER: [[f64; 2]; 6] = [[-4.0, -80.0], [-1.0, -5.0], [0.0, 0.0], [0.5, 1.0], [1.0, 8.0], [4.0, 30.0]];

#[test]
fn points_of_a_damper_on_a_line_are_its_damping() {
    for is_rotary in [false, true] {
        let mut text = body(is_rotary, [0.2, 5.0]);
        text["springs"] = json!({ "d": { "joint": "way", "damping_points": [[-1, -6], [0, 0], [0.5, 3], [2, 12]] } });
        let mut run = Run::new(&text.to_string()).started();
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
fn a_damper_with_a_curve_moves_and_dissipates_as_its_law_says() {
    let law = monotone(&DAMPER).unwrap();
    let rate = |_: f64, [x, v, _]: [f64; 3]| {
        let force = law.at(v)[0];
        [v, -(force + 300.0 * (x - 0.1)) / MASS, force * v]
    };
    for is_rotary in [false, true] {
        let mut text = body(is_rotary, [0.5, 6.0]);
        let free = if is_rotary { "free_angle" } else { "free_length" };
        let mut spring = json!({ "joint": "way", "stiffness": 300, "damping_points": DAMPER });
        spring[free] = json!(0.1);
        text["springs"] = json!({ "strut": spring });
        let mut run = Run::new(&text.to_string()).started();
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
    text["actuators"] = json!({ "motor": { "joint": "way", "points": [[0, 12], [10, 7], [24, 0]] } });
    let mut run = Run::new(&text.to_string()).started();
    assert_eq!(run.get("motor.command"), 1.0);
    for command in [1.0, 0.25] {
        run.set("motor.command", command);
        run.initialize();
        let tau = MASS / (0.5 * command);
        for k in 1..=20 {
            run.step(0.5);
            let speed = 24.0 * (1.0 - (-0.5 * f64::from(k) / tau).exp());
            assert!((run.get("part.speed") - speed).abs() < 1e-10, "{} {speed}", run.get("part.speed"));
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
    text["actuators"] = json!({ "ram": { "joint": "way", "force": 2, "command": 0, "points": points } });
    let mut run = Run::new(&text.to_string()).started();
    for _ in 0..8 {
        run.set_derivative("ram.command", 1, 0.5);
        run.set_derivative("ram.command", 2, -0.3);
        run.set_derivative("ram.force", 1, 1.5);
        let (c, f) = (run.get("ram.command"), run.get("ram.force"));
        let start = [run.get("way.position"), run.get("way.speed"), 0.0];
        let rate = |t: f64, [_, v, _]: [f64; 3]| {
            let force = f + 1.5 * t + (c + 0.5 * t - 0.15 * t * t) * law.at(v)[0];
            [v, force / MASS, force * v]
        };
        let energy = run.get("energy.kinetic");
        run.step(0.5);
        let [x, v, work] = runge_kutta(rate, start, 0.5, 2000);
        assert!((run.get("way.position") - x).abs() < 1e-9 && (run.get("way.speed") - v).abs() < 1e-9);
        assert!((run.get("energy.kinetic") - energy - work).abs() < 1e-8);
        assert!(run.get("energy.drift").abs() < 1e-9, "{:e}", run.get("energy.drift"));
    }
}

/// Step with which the contact with the bumper is looked for [s].
const CONTACT: f64 = 2e-3;

/// In any state a curve acts like a constant load of the present size: all outputs that both models have are the same.
#[test]
fn curves_act_like_constant_loads_of_their_size() {
    for (friction, angle, speed, command, h) in [
        (false, 0.9, 14.0, 0.8, 0.0),
        (true, 0.9, 14.0, 0.8, 0.0),
        (true, 2.5, -9.0, 0.4, 0.0),
        (true, 5.8, -33.0, -0.7, 0.0),
        // On the bumper.
        (false, 0.9, -14.0, 0.0, CONTACT),
        (true, 0.9, -14.0, 0.8, CONTACT),
    ] {
        let flags = [("friction.enabled", friction)];
        let start = [("crank.start_angle", angle), ("crank.start_speed", speed), ("motor.command", command)];
        let demands = [("motor.demanded_acceleration", 40.0), ("ram.demanded_acceleration", -3.0)];
        let mut curves = Run::new(CURVES).with(&flags).with(&start).with(&demands).started();
        while h > 0.0 && curves.get("buffer.force") == 0.0 {
            curves.step(h);
        }
        let forces = ["motor.acting_torque", "ram.acting_force", "damper.force", "coil.torque", "rod_damper.torque"];
        let [torque, ram, damper, coil, rod] = forces.map(|name| curves.get(name));
        let push = -curves.get("buffer.force");
        assert_eq!(push > 0.0, h > 0.0, "{push}");
        let start =
            [("crank.start_angle", curves.get("crank.angle")), ("crank.start_speed", curves.get("crank.speed"))];
        let mut plain = Run::new(&changed(CURVES, |m| {
            m["actuators"] = json!({ "motor": { "joint": "bearing", "torque": torque, "efficiency": 0.9 },
                                     "ram": { "joint": "guide", "force": ram } });
            m["springs"] = json!({ "damper": { "joint": "guide", "preload": damper },
                                   "coil": { "joint": "bearing", "preload": coil },
                                   "rod_damper": { "joint": "pin", "preload": rod },
                                   "push": { "joint": "guide", "preload": push } });
            m.as_object_mut().unwrap().remove("stops");
        }))
        .with(&flags)
        .with(&start)
        .with(&demands)
        .started();
        let mut compared = 0;
        for reference in reals(&plain, Causality::Output) {
            let name = plain.variables().get(reference).unwrap().name.clone();
            // At rest, dampers give nothing, and drives another force.
            if name.contains("holding")
                || name.starts_with("energy")
                || name.starts_with("breakaway")
                || name.contains(".breakaway")
            {
                continue;
            }
            let Ok(other) = curves.0.reference(&name) else { continue };
            let (a, b) = (plain.real(reference).unwrap(), curves.real(other).unwrap());
            assert!((a - b).abs() <= 1e-9 * (1.0 + a.abs()) || (a.is_nan() && b.is_nan()), "{name}: {a} {b}");
            compared += 1;
        }
        assert!(compared > 50, "{compared}");
    }
}

/// At rest a drive gives what its curve does there; the terms of one element know it.
#[test]
fn a_drive_at_rest_and_its_required_force_know_the_curve() {
    let mut run = Run::new(&changed(CURVES, |m| {
        m["actuators"]["motor"].as_object_mut().unwrap().remove("efficiency");
        m["start"]["speed"] = json!(0);
    }))
    .started();
    // What holds, given as the force besides the curve, leaves the mechanism at rest.
    let holding = run.get("motor.holding_torque");
    run.set("motor.torque", holding - 0.8 * 8.0);
    run.initialize();
    assert!((run.get("motor.acting_torque") - holding).abs() < 1e-12);
    assert!(run.get("crank.acceleration").abs() < 1e-9, "{:e}", run.get("crank.acceleration"));
    // What the demanded acceleration requires is what acts, where that is the acceleration; with losses and friction too.
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

/// Derivative of the holding torque along the drive against differences: the other drive's curve at rest takes part.
#[test]
fn the_derivative_of_what_holds_is_that_of_differences() {
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

const BUFFER: [[f64; 2]; 5] = [[0.0, 0.0], [0.02, 15.0], [0.05, 90.0], [0.06, 90.0], [0.1, 800.0]];

#[test]
fn a_progressive_bumper_gives_back_what_it_takes() {
    let law = monotone(&BUFFER).unwrap();
    for (is_rotary, limit, sign) in [(false, "upper", 1.0), (false, "lower", -1.0), (true, "upper", 1.0)] {
        for speed in [0.4, 1.7, 4.0] {
            let mut text = body(is_rotary, [0.0, sign * speed]);
            let value = if is_rotary { "angle" } else { "position" };
            let mut stop = json!({ "joint": "way", "limit": limit, "rigid": false, "points": BUFFER });
            stop[value] = json!(sign * 0.3);
            text["stops"] = json!({ "buffer": stop });
            let mut run = Run::new(&text.to_string()).started();
            let [position, rate] = names(is_rotary);
            let (mut deepest, mut h) = (0.0_f64, 0.0);
            while run.get(rate) * sign > -0.5 * speed || run.get(position) * sign > 0.3 {
                run.step(1e-3);
                h += 1e-3;
                let depth = run.get(position) * sign - 0.3;
                deepest = deepest.max(depth);
                let push = run.get(if is_rotary { "buffer.torque" } else { "buffer.force" });
                assert!((push + sign * law.at(depth)[0] * f64::from(u8::from(depth > 0.0))).abs() < 1e-6, "{push}");
                // Kinetic energy less that at the start is what the curve has stored.
                let stored = if depth > 0.0 { law.integral(depth) } else { 0.0 };
                let kinetic = run.get("energy.kinetic");
                assert!((kinetic + stored - 0.5 * MASS * speed * speed).abs() < 1e-9, "{depth}");
                assert!(h < 5.0);
            }
            assert!((run.get(rate) + sign * speed).abs() < 1e-9, "{}", run.get(rate));
            assert_eq!(run.get("buffer.impact_count"), 1.0);
            assert!((run.get("buffer.impact_time") - 0.3 / speed).abs() < 1e-9);
            assert!(run.get("energy.drift").abs() < 1e-10, "{:e}", run.get("energy.drift"));
            assert!(deepest > 0.01, "{deepest}");
        }
    }
}

#[test]
fn a_damped_bumper_with_a_curve_lets_go_where_its_push_ends() {
    let law = monotone(&BUFFER).unwrap();
    let mut text = body(false, [0.3, 2.0]);
    text["stops"] = json!({ "buffer": { "joint": "way", "limit": "upper", "position": 0.3, "rigid": false, "damping": 25,
                                        "stiffness": 40, "points": BUFFER } });
    let mut run = Run::new(&text.to_string()).started();
    let (mut y, h) = ([0.0, 2.0], 1e-5);
    let mut pushes = true;
    let rate = |pushes: bool| {
        move |_: f64, [x, v]: [f64; 2], law: &Piecewise| {
            let push = if pushes { law.at(x)[0] + 40.0 * x + 25.0 * v } else { 0.0 };
            [v, -push / MASS]
        }
    };
    for k in 1..=200 {
        run.step(2e-3);
        for _ in 0..200 {
            y = runge_kutta(|t, y| rate(pushes)(t, y, &law), y, h, 1);
            pushes &= law.at(y[0])[0] + 40.0 * y[0] + 25.0 * y[1] > 0.0;
        }
        // The end of contact is found to a step of the method.
        assert!((run.get("way.position") - 0.3 - y[0]).abs() < 1e-6, "{k} {} {}", run.get("way.position") - 0.3, y[0]);
        assert!((run.get("way.speed") - y[1]).abs() < 1e-5, "{k} {} {}", run.get("way.speed"), y[1]);
    }
    assert!(!pushes && run.get("buffer.force") == 0.0 && run.get("way.position") > 0.3 - 2.0 && y[1] < -0.1);
    assert!(run.get("energy.drift").abs() < 1e-9);
}

/// Torque over five turns: soft, a plateau, stiff.
const COIL: [[f64; 2]; 6] = [[-10.0, -9.0], [-3.0, -1.0], [4.0, 2.0], [12.0, 2.0], [20.0, 11.0], [31.0, 40.0]];

#[test]
fn a_torsional_curve_winds_up_over_several_turns() {
    let law = monotone(&COIL).unwrap();
    let mut text = body(true, [1.0, 11.0]);
    text["springs"] = json!({ "coil": { "joint": "way", "preload": 0.5, "stiffness": 0.1, "points": COIL } });
    let mut run = Run::new(&text.to_string()).started();
    let (mut most, mut least) = (f64::MIN, f64::MAX);
    let before = run.get("energy.kinetic") + run.get("energy.potential");
    for k in 1..=60 {
        run.step(0.2);
        let rate = |_: f64, [x, v]: [f64; 2]| [v, -(law.at(x)[0] + 0.5 + 0.1 * x) / MASS];
        let [x, v] = runge_kutta(rate, [1.0, 11.0], 0.2 * f64::from(k), 4000 * k);
        let [angle, speed] = names(true).map(|name| run.get(name));
        (most, least) = (most.max(angle), least.min(angle));
        assert!((angle - x).abs() < 1e-8 && (speed - v).abs() < 1e-8, "{k}: {angle} {x} {speed} {v}");
        assert!((run.get("coil.torque") - law.at(x)[0] - 0.5 - 0.1 * x).abs() < 1e-7);
        let energy = run.get("energy.kinetic") + run.get("energy.potential");
        assert!((energy - before).abs() < 1e-8, "{:e}", energy - before);
        assert!(run.get("energy.drift").abs() < 1e-8, "{:e}", run.get("energy.drift"));
    }
    assert!(most > 3.0 * std::f64::consts::TAU && least < -std::f64::consts::TAU, "{least} {most}");
}

#[test]
fn a_four_bar_with_a_coil_keeps_its_energy_over_turns_both_ways() {
    let text = changed(FOUR_BAR, |m| {
        m["springs"] = json!({ "coil": { "joint": "S", "points": COIL } });
        m["solver"] = json!({ "tolerance": 1e-11 });
        m["start"]["speed"] = json!(60);
    });
    let law = monotone(&COIL).unwrap();
    let mut run = Run::new(&text).started();
    let (mut worst, mut most) = (0.0_f64, 0.0_f64);
    let (at_rest, stored) = (law.integral(0.0), |angle: f64| law.integral(angle));
    let gravity = run.get("energy.potential") - (stored(run.get("coil.angle")) - at_rest);
    assert!(gravity.is_finite());
    for _ in 0..400 {
        run.step(5e-3);
        worst = worst.max(run.get("energy.drift").abs());
        most = most.max(run.get("coil.angle").abs());
        assert!((run.get("coil.torque") - law.at(run.get("coil.angle"))[0]).abs() < 1e-9);
    }
    assert!(most > 2.0 * std::f64::consts::TAU, "{most}");
    assert!(worst < 1e-7, "{worst:e}");
    // A saved state goes on to the bit.
    let mut other = run.clone();
    let saved = run.snapshot();
    run.steps(20, 0.1);
    other.steps(3, 0.07);
    other.restore(&saved).unwrap();
    other.steps(20, 0.1);
    let all = reals(&run, Causality::Output);
    let [a, b] = [&mut run, &mut other].map(|run| values(run, &all).into_iter().map(f64::to_bits).collect::<Vec<_>>());
    assert_eq!(a, b);
}

#[test]
fn a_wound_spring_has_its_equilibrium_turns_away() {
    let mut text = body(true, [0.0, 0.0]);
    text["springs"] = json!({ "coil": { "joint": "way", "points": [[0, -3], [10, -1], [16, 0.5], [30, 9]] } });
    text["start"] = json!("equilibrium");
    let mut run = Run::new(&text.to_string()).started();
    let angle = run.get("part.angle");
    let law = monotone(&[[0.0, -3.0], [10.0, -1.0], [16.0, 0.5], [30.0, 9.0]]).unwrap();
    assert!(angle > 10.0 && angle < 16.0 && law.at(angle)[0].abs() < 1e-9, "{angle}");
}

#[test]
fn what_is_no_curve_is_refused_by_name() {
    let damper = |points: Value| json!({ "springs": { "d": { "joint": "way", "damping_points": points } } });
    let motor = |drive: Value| json!({ "actuators": { "m": drive } });
    let buffer = |points: Value| json!({ "stops": { "b": { "joint": "way", "limit": "upper", "position": 1, "rigid": false, "points": points } } });
    let rigid =
        json!({ "stops": { "b": { "joint": "way", "limit": "upper", "position": 1, "points": [[0, 0], [1, 1]] } } });
    for (more, pieces) in [
        (damper(json!([[0, 0]])), &["springs.d.damping_points", "1 of the 2 or more points [speed, force]"][..]),
        (damper(json!([[-1, -1], [1, 1]])), &["springs.d.damping_points", "add the point [0, 0]"]),
        (damper(json!([[-1, 1], [0, 0], [1, 1]])), &["damping_points[0]", "the force 1 at the speed -1 drives"]),
        (damper(json!([[0, 0], [1, 5], [2, 3]])), &["damping_points", "beyond the speed 2", "no smaller"]),
        (damper(json!([[-2, -1], [-1, -5], [0, 0], [1, 5]])), &["damping_points", "beyond the speed -2", "no smaller"]),
        (damper(json!([[1, 1], [0, 0]])), &["damping_points[1]", "speed = 0 does not follow speed = 1"]),
        (motor(json!({ "joint": "way", "points": [[0, 1]] })), &["actuators.m.points", "1 of the 2"]),
        (motor(json!({ "joint": "way", "command": 0.5 })), &["actuators.m.command", "add points [speed, force]"]),
        (
            motor(json!({ "joint": "way", "points": [[0, 1], [1, 0]], "motion": { "position": 0 } })),
            &["actuators.m.points", "remove points, or motion"],
        ),
        (buffer(json!([[0, 1], [1, 2]])), &["stops.b.points[0]", "begin with [0, 0]"]),
        (buffer(json!([[0, 0], [1, 2], [2, 1]])), &["stops.b.points[2]", "the push 1 is less than 2 before"]),
        (rigid, &["stops.b.points", "a rigid stop has none", "\"rigid\": false"]),
    ] {
        let mut text = body(false, [0.0, 0.0]);
        text.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        let error = Model::from_json(&text.to_string()).map(drop).expect_err(&text.to_string());
        assert_says(error, pieces);
    }
    let fem = changed(FOUR_BAR, |m| {
        m["actuators"] = json!({ "motor": { "joint": "S", "points": [[0, 1], [9, 0]] } });
        m["solver"] = json!({ "tolerance": 1e-9, "method": "rigid_fem" });
        for (_, body) in m["bodies"].as_object_mut().unwrap().iter_mut().filter(|(name, _)| *name != "ground") {
            body["axial_stiffness"] = json!(1e8);
        }
    });
    let error = Simulation::open(&fem).map(drop).expect_err("rigid finite elements take a drive with a curve");
    assert_says(error, &["actuators.motor.points", "rigid_fem", "give a torque or a force"]);
}

/// The finite elements know dampers with a curve and springs that wind up.
#[test]
fn the_finite_elements_move_with_dampers_and_coils_of_curves() {
    let coil = json!([[-10, -0.09], [-3, -0.01], [4, 0.02], [12, 0.02], [20, 0.11]]);
    let damper = json!([[-60, -0.3], [0, 0], [20, 0.02], [60, 0.2]]);
    let text = |method: &str| {
        changed(FOUR_BAR, |m| {
            m["springs"] = json!({ "coil": { "joint": "S", "points": coil },
                                   "damper": { "joint": "S", "damping_points": damper } });
            m["solver"] = json!({ "method": method, "fem_step": 2e-5, "tolerance": 1e-10 });
            m["start"]["speed"] = json!(40);
            for (body, length) in [("crank", 0.1), ("rocker", 0.25)] {
                m["bodies"][body] = json!({ "length": length, "mass": 0.5, "shape": "uniform_rod" });
            }
            for (_, body) in m["bodies"].as_object_mut().unwrap().iter_mut().filter(|(name, _)| *name != "ground") {
                body["axial_stiffness"] = json!(1e9);
            }
        })
    };
    let [mut one, mut other] = ["reduced", "rigid_fem"].map(|method| Run::new(&text(method)).started());
    let names = ["coil.angle", "coil.torque", "damper.torque", "energy.potential", "energy.kinetic"];
    let mut largest = [0.0_f64; 5];
    for _ in 0..30 {
        one.step(0.01);
        other.step(0.01);
        for (name, largest) in names.into_iter().zip(&mut largest) {
            let (a, b) = (one.get(name), other.get(name));
            *largest = largest.max(a.abs());
            // The finite elements' error in time is of the second order.
            assert!((a - b).abs() < 1e-3 * *largest, "{name}: {a} {b}");
        }
    }
    assert!(one.get("coil.angle").abs() > 6.3, "{}", one.get("coil.angle"));
}

#[test]
fn lengths_of_points_have_the_unit_of_the_file() {
    let mut text = body(false, [100.0, 0.0]);
    text["units"] = json!({ "length": "mm" });
    text["springs"] = json!({ "s": { "joint": "way", "points": [[0, 0], [100, 5], [200, 10]],
                                     "damping_points": [[0, 0], [1, 2]] } });
    text["stops"] = json!({ "b": { "joint": "way", "limit": "upper", "position": 95, "rigid": false,
                                   "points": [[0, 0], [10, 1], [20, 4]] } });
    text["stops"]["b"]["enabled"] = json!(false);
    let mut run = Run::new(&text.to_string()).started();
    assert!((run.get("s.force") - 5.0).abs() < 1e-12, "{}", run.get("s.force"));
}

/// Far from the guess panels are wide: all points of a curve may lie between two nodes of one, and each is a border.
#[test]
fn a_spring_far_from_the_guess_has_its_curve() {
    for (at, guess) in [(3000.0, 0.0), (400.0, 0.0), (1000.0, 0.0), (0.0, 500.0), (0.0, 700.0), (0.0, 1e4), (0.0, 1e6)]
    {
        let points = [[-0.3, -50.0], [-0.1, -1.0], [0.0, 0.0], [0.05, 0.0], [0.1, 30.0], [0.3, 31.0]];
        let text = json!({
            "name": "Slide",
            "bodies": { "ground": {}, "block": { "mass": 2 } },
            "joints": { "s": { "type": "prismatic", "first": "ground.origin", "second": "block.origin" } },
            "springs": { "k": { "joint": "s", "points": points.map(|[s, force]| [at + s, force]) } },
            "start": { "joint": "s", "position": at + 0.3 },
            "guess": { "s": guess },
        });
        let mut run = Run::new(&text.to_string());
        run.initialize();
        let acceleration = run.get("s.acceleration");
        assert!((acceleration + 15.5).abs() < 1e-5, "{at}, {guess}: {acceleration} m/s2");
        for _ in 0..20 {
            run.step(0.05);
            let drift = run.get("energy.drift");
            assert!(drift.abs() < 1e-5, "{at}, {guess}: {drift} J");
        }
    }
}
