//! Travel without limits: an open curve extends as far as the motion, and a limit on one side leaves the other side
//! free.

use crate::support::definition::{G, With, block, friction, pin, rod, slide, weight};
use crate::support::{FOUR_BAR, GEAR, Run, SLIDER_CRANK, assert_says, changed};
use linkage_fmu::mechanism::definition::Mechanism;
use linkage_fmu::mechanism::reduced::Reduced;
use serde_json::{Value, json};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_6};

/// A carriage of 20 mm on a straight rail, with a force along the rail and these additional keys.
fn carriage(further: Value) -> Value {
    let carriage = block(3.0).with(json!({
        "bodies": { "block": { "length": 0.02, "inertia": 0.01 } }, "actuators": { "push": { "joint": "slide" } },
        "start": { "position": 0.5 },
    }));
    carriage.with(further)
}

/// A block on a slope of 30 degrees, with friction that is independent of the speed above 0.1 m/s.
fn on_slope() -> Value {
    block(2.0).with(json!({
        "gravity": weight(), "friction": friction([0.2, 0.2], [0.01, 0.1]),
        "bodies": { "block": { "length": 0.4, "inertia": 0.1 } }, "joints": { "slide": { "axis_angle": -FRAC_PI_6 } },
        "markers": { "nose": { "at": "block.end" } }, "start": { "speed": 1 },
    }))
}

/// An arm about the origin through a block on a vertical rail at x = 1. Its angle is the arc tangent of the block's
/// height.
fn arm(further: Value) -> Value {
    let arm = json!({
        "name": "Arm",
        "bodies": { "ground": { "points": { "rail": [1, 0] } }, "arm": { "length": 1, "inertia": 4 },
            "block": { "mass": 3 }, "eye": {} },
        "joints": { "pivot": pin("ground.origin", "arm.origin"), "pin": pin("eye.origin", "block.origin"),
            "rail": slide("ground.rail", "block.origin", FRAC_PI_2), "slot": slide("arm.origin", "eye.origin", 0.0) },
        "actuators": { "push": { "joint": "rail" } },
        "start": { "joint": "rail", "position": 0.5, "speed": 2 },
        "guess": { "arm": 0.4, "rail": 0.4, "slot": 1.1 },
    });
    arm.with(further)
}

/// Two carriages connected by a rod: a loop that moves far away from the origin.
fn train() -> Value {
    json!({
        "name": "Train",
        "bodies": { "ground": {}, "front": { "mass": 2 }, "rear": { "mass": 3 }, "rod": rod(0.5, 1.0) },
        "joints": { "rail": slide("ground.origin", "front.origin", 0.0),
            "other": slide("ground.origin", "rear.origin", 0.0), "hook": pin("rear.origin", "rod.origin"),
            "eye": pin("rod.end", "front.origin") },
        "actuators": { "push": { "joint": "rail" } },
        "start": { "joint": "rail", "position": 0.5 }, "guess": { "rail": 0.5, "other": 0, "rod": 0 },
    })
}

/// Number of computed stretches, of loop closures for tracing them, and of panels of the influences.
fn made(run: &mut Run) -> [usize; 3] {
    let reduced = run.reduced().unwrap();
    let all = || std::iter::once(&**reduced).chain(reduced.stretches());
    [all().count(), all().map(|s| s.curve().closed).sum(), all().map(|s| s.influence().panels()).sum()]
}

#[test]
fn a_carriage_moves_a_million_metres() {
    for speed in [1e4, -1e4] {
        let mut run = Run::new(carriage(json!({})));
        run.place(("slide.start_position", 0.5), ("slide.start_speed", speed));
        let before = made(&mut run);
        assert_eq!(before[0], 1, "nothing is traced where the motion does not go");
        for k in 1..=100 {
            run.step(1.0);
            let exact = 0.5 + speed * f64::from(k);
            let error = (run.get("slide.position") - exact).abs();
            assert!(error <= 8.0 * f64::EPSILON * exact.abs(), "{k}: {error:e} m");
            assert!((run.get("slide.speed") / speed - 1.0).abs() <= 4.0 * f64::EPSILON);
        }
        let after = made(&mut run);
        println!("{before:?} {after:?}");
        // 5e7 sizes of the mechanism are 1e2 times 8^7. A straight stretch has a few panels.
        assert_eq!(after[0], 8);
        assert!(after[1] - before[1] < 7 * 60 && after[2] - before[2] <= 7 * 4, "{before:?} {after:?}");
    }
}

#[test]
fn a_pushed_carriage_and_one_on_a_spring_move_as_in_closed_form() {
    let mut run = Run::new(carriage(json!({}))).with(&[("push.force", 600.0)]).started();
    for k in 1..=100 {
        run.step(1.0);
        let exact = 0.5 + 100.0 * f64::from(k * k);
        let error = (run.get("slide.position") - exact).abs();
        assert!(error <= 1e-14 * exact, "{k}: {error:e} m");
        assert!(run.get("energy.drift").abs() <= 1e-13 * run.get("energy.kinetic"));
    }
    // Many times across the borders of stretches and back, with and without damping.
    for damping in [0.0, 0.02] {
        let spring = json!({ "joint": "slide", "stiffness": 12, "damping": damping });
        let mut run =
            Run::new(carriage(json!({ "springs": { "spring": spring } }))).with(&[("solver.tolerance", 1e-10)]);
        run.place(("slide.start_position", 300.0), ("slide.start_speed", 0.0));
        let decay = damping / 6.0;
        let omega = f64::sqrt(4.0 - decay * decay);
        for k in 1..=200 {
            run.step(0.1);
            let t = 0.1 * f64::from(k);
            let (sin, cos) = (omega * t).sin_cos();
            let exact = 300.0 * (-decay * t).exp() * (cos + decay / omega * sin);
            let error = (run.get("slide.position") - exact).abs();
            assert!(error < 300.0 * 1e-8, "{t}: {error:e} m");
        }
    }
}

#[test]
fn a_block_slides_a_kilometre_and_more() {
    let mut run = Run::new(on_slope()).with(&[("solver.tolerance", 1e-10)]).started();
    let (sin, cos) = (-FRAC_PI_6).sin_cos();
    let a = G * (-sin - 0.2 * cos);
    for k in 1..=100 {
        run.step(0.5);
        let t = 0.5 * f64::from(k);
        let (s, v) = (t + 0.5 * a * t * t, 1.0 + a * t);
        run.near("slide.position", s, 1e-12 * s);
        assert!((run.get("slide.speed") - v).abs() < 1e-12 * v);
        assert!((run.get("slide.friction_force") + 0.2 * 2.0 * G * cos).abs() < 1e-11);
        assert!((run.get("nose.x") - (0.4 + s * cos)).abs() < 1e-12 * s);
        assert!((run.get("nose.y") - s * sin).abs() < 1e-12 * s);
        assert!((run.get("slide.force") - 2.0 * G * cos).abs() < 1e-11);
    }
    assert!(run.get("slide.position") > 4000.0);
    assert!(made(&mut run)[0] > 2);
}

#[test]
fn a_guess_is_as_good_as_any_other() {
    let mut far = Run::new(changed(carriage(json!({})), |m| {
        m["guess"]["slide"] = json!(150);
        m["start"]["position"] = json!(150.5);
    }));
    let mut near = Run::new(carriage(json!({})));
    for run in [&mut far, &mut near] {
        run.set("push.force", 2.0);
        run.initialize();
    }
    for _ in 0..50 {
        far.step(1.0);
        near.step(1.0);
        assert!(
            (far.get("slide.position") - near.get("slide.position") - 150.0).abs() < 1e-12 * far.get("slide.position")
        );
    }
    // Starts far from the guess, on both sides.
    for position in [1234.5, -1234.5, 1e6] {
        far.place(("slide.start_position", position), ("slide.start_speed", 0.0));
        assert!((far.get("slide.position") - position).abs() < 1e-15 * position.abs());
    }
}

#[test]
fn an_arm_follows_its_block_along_the_asymptote() {
    let mut run = Run::new(arm(json!({}))).with(&[("solver.tolerance", 1e-11)]).started();
    // T = 1/2 (m + I / (1 + s^2)^2) s_dot^2.
    let mass = |s: f64| 3.0 + 4.0 / (1.0 + s * s).powi(2);
    let energy = mass(0.5) * 4.0;
    for h in [1.0, 10.0, 1e2, 1e3, 1e4, 1e5] {
        for _ in 0..10 {
            run.step(h);
            let s = run.get("rail.position");
            let kinetic = mass(s) * run.get("rail.speed").powi(2);
            assert!((kinetic / energy - 1.0).abs() < 1e-11, "{s}: {kinetic} {energy}");
            assert!((run.get("arm.angle") - s.atan()).abs() < 1e-13, "{s}: {}", run.get("arm.angle") - s.atan());
            assert!((run.get("slot.position") - s.hypot(1.0)).abs() < 1e-13 * s);
            let rate = run.get("rail.speed") / (1.0 + s * s);
            assert!((run.get("arm.speed") - rate).abs() < 1e-12, "{s}");
        }
    }
    println!("{} {:?}", run.get("rail.position"), made(&mut run));
    assert!(run.get("rail.position") > 2e6);
}

#[test]
fn a_train_keeps_together_far_away() {
    let mut run = Run::new(train()).with(&[("push.force", 12.0)]).started();
    for k in 1..=100 {
        run.step(10.0);
        let t = 10.0 * f64::from(k);
        let s = 0.5 + t * t;
        assert!((run.get("rail.position") - s).abs() < 1e-12 * s, "{s}");
        assert!((run.get("rail.position") - run.get("other.position") - 0.5).abs() < 1e-14 * s);
        assert!(run.get("rod.angle").abs() < 1e-14 * s);
        assert!((run.get("hook.force") - 6.0).abs() < 1e-11 * s.max(1.0), "{s} {}", run.get("hook.force"));
    }
}

/// With a single stop the crank may turn away from the stop without end, in either direction of the curve.
#[test]
fn a_crank_turns_away_from_its_one_stop_for_many_turns() {
    for (limit, value, side) in [("upper", -1.0, -1.0), ("lower", -2.0, 1.0)] {
        let text = changed(SLIDER_CRANK, |m| {
            m["stops"]["end"] = json!({ "body": "crank", "angle": value, "limit": limit, "restitution": 0.5 });
            m["gravity"]["acceleration"] = json!(0);
            m["forces"]["piston"]["force"] = json!([0, 0]);
        });
        let (mut stopped, mut free) = (
            Run::new(&text),
            Run::new(changed(&text, |m| {
                m["stops"]["end"]["enabled"] = json!(false);
            })),
        );
        for run in [&mut stopped, &mut free] {
            run.set("drive.torque", 3.0 * side);
            run.place(("crank.start_angle", -1.5), ("crank.start_speed", 10.0 * side));
        }
        for _ in 0..200 {
            stopped.step(0.05);
            free.step(0.05);
            let (a, b) = (stopped.get("crank.angle"), free.get("crank.angle"));
            assert!((a - b).abs() < 1e-6 * b.abs(), "{a} {b}");
        }
        assert!(free.get("crank.angle").abs() > 1000.0, "{}", free.get("crank.angle"));
        // Back over all turns: the crank stops at the stop.
        stopped.set("drive.torque", -3000.0 * side);
        stopped.steps(100, 10.0);
        assert!((stopped.get("crank.angle") - value).abs() < 1e-9, "{}", stopped.get("crank.angle"));
        assert!(stopped.is("end.reached"));
    }
}

#[test]
fn a_four_bar_turns_away_from_its_one_stop() {
    for (limit, value, side) in [("upper", 1.5, -1.0), ("lower", 0.5, 1.0)] {
        let text = changed(FOUR_BAR, |m| {
            m["stops"]["end"] = json!({ "body": "crank", "angle": value, "limit": limit });
        });
        let mut run = Run::new(&text).with(&[("drive.torque", 0.5 * side)]);
        run.place(("crank.start_angle", 1.0), ("crank.start_speed", 30.0 * side));
        run.steps(200, 20.0);
        assert!(run.get("crank.angle") * side > 100.0, "{}", run.get("crank.angle"));
        let energy = run.get("energy.kinetic");
        assert!(run.get("energy.drift").abs() < 1e-5 * energy, "{} of {energy}", run.get("energy.drift"));
    }
}

/// A rigid stop far beyond the first stretch of the curve.
#[test]
fn a_far_stop_is_reached() {
    let elastic = json!({ "joint": "slide", "restitution": 1 });
    let stop = |limit: &str, at: f64| elastic.clone().with(json!({ "limit": limit, "position": at }));
    for is_between in [false, true] {
        let mut stops = json!({ "high": stop("upper", 1e3) });
        if is_between {
            stops["low"] = stop("lower", -1e4);
        }
        let mut run = Run::new(carriage(json!({ "stops": stops })));
        run.place(("slide.start_position", 0.0), ("slide.start_speed", 100.0));
        run.step(9.0);
        assert!((run.get("slide.position") - 900.0).abs() < 1e-10);
        run.step(2.0);
        assert!((run.get("slide.position") - 900.0).abs() < 1e-9, "{}", run.get("slide.position"));
        run.step(105.0);
        assert!((run.get("slide.position") + 9600.0).abs() < 1e-8);
        run.step(8.0);
        let exact = if is_between { -9600.0 } else { -10400.0 };
        assert!((run.get("slide.position") - exact).abs() < 1e-7, "{}", run.get("slide.position"));
    }
    let buffer = json!({ "joint": "slide", "limit": "upper", "position": 500, "rigid": false, "stiffness": 1200 });
    let mut run = Run::new(carriage(json!({ "stops": { "buffer": buffer } })));
    run.place(("slide.start_position", 0.0), ("slide.start_speed", 100.0));
    run.step(5.05);
    // Half a period in the bumper, with omega = sqrt(1200 / 3) = 20 rad/s.
    let exact = 500.0 + 5.0 * f64::sin(1.0);
    assert!((run.get("slide.position") - exact).abs() < 1e-6, "{} {exact}", run.get("slide.position"));
    run.step(10.0);
    let exact = 500.0 - 100.0 * (10.05 - std::f64::consts::PI / 20.0);
    assert!((run.get("slide.position") - exact).abs() < 1e-5, "{} {exact}", run.get("slide.position"));
}

/// Bits of outputs of all kinds.
fn bits(run: &mut Run) -> Vec<u64> {
    let names = ["rail.position", "rail.speed", "arm.angle", "arm.speed", "pin.force", "push.required_force"];
    names.iter().map(|name| run.get(name).to_bits()).collect()
}

#[test]
fn models_with_different_traced_parts_are_bit_identical() {
    let spring = json!({
        "springs": { "spring": { "joint": "rail", "stiffness": 0.004, "damping": 0.001 } },
        "friction": { "enabled": true, "static_coefficient": 0.02, "kinetic_coefficient": 0.01 },
    });
    for further in [json!({}), spring] {
        let text = arm(further);
        let start = || {
            let mut run = Run::new(&text).with(&[("push.force", 0.3)]);
            run.place(("rail.start_position", 0.5), ("rail.start_speed", 40.0));
            run
        };
        let (mut one, mut other) = (start(), start());
        let (mut saved, mut seen) = (Vec::new(), Vec::new());
        for _ in 0..40 {
            one.step(2.5);
            saved.push(one.saved());
            seen.push(bits(&mut one));
        }
        assert!(made(&mut one)[0] >= 3, "{:?}", made(&mut one));
        // A new instance restores any saved state and continues like the instance that saved it.
        for k in [35, 12, 20, 3] {
            let mut fresh = Run::new(&text).started();
            fresh.take(&saved[k]);
            assert_eq!(bits(&mut fresh), seen[k]);
            // An instance that has moved to the other side restores the state too.
            other.place(("rail.start_position", -5000.0), ("rail.start_speed", -3.0));
            other.set("push.force", -1.0);
            other.step(1.0);
            other.take(&saved[k]);
            for (step, seen) in seen[k + 1..].iter().take(4).enumerate() {
                for run in [&mut fresh, &mut other] {
                    run.step(2.5);
                    assert_eq!(bits(run), *seen, "{step} steps after {k}");
                }
            }
        }
        let mut clone = one.clone();
        one.step(100.0);
        clone.step(100.0);
        assert_eq!(bits(&mut one), bits(&mut clone));
    }
}

#[test]
fn an_absurd_state_is_rejected() {
    let mut run = Run::new(arm(json!({}))).started();
    run.step(0.1);
    let sigma = run.saved();
    // sigma is somewhere in the bytes: every position is overwritten with absurd numbers.
    let before = bits(&mut run);
    let mut refused = 0;
    for at in 0..sigma.len() - 8 {
        for absurd in [1e300, -1e300, 1e30, f64::MAX] {
            let mut record = sigma.clone();
            record[at..at + 8].copy_from_slice(&f64::to_le_bytes(absurd));
            match run.read_snapshot(&record) {
                Ok(read) => {
                    let mut other = run.clone();
                    if other.restore(&read).is_ok() {
                        let _ = other.0.get("rail.position");
                        let _ = other.0.step(0.1);
                    }
                }
                Err(error) => refused += usize::from(error.to_string().contains("sigma =")),
            }
        }
    }
    assert!(refused >= 4, "{refused}");
    assert_eq!(bits(&mut run), before);
}

#[test]
fn a_motion_beyond_all_numbers_ends_with_an_error() {
    let mut run = Run::new(carriage(json!({}))).with(&[("push.force", 1e9)]).started();
    let before = run.get("slide.position");
    let error = run.0.step(1e4).unwrap_err();
    assert_says(
        error,
        &["past the end of its travel", "the rounding errors of positions are larger than the mechanism", "add a stop"],
    );
    assert_eq!(run.get("slide.position"), before);
    run.step(1e-3);
    run.place(("slide.start_position", 0.5), ("slide.start_speed", -1e7));
    run.set("push.force", 0.0);
    run.step(200.0);
    assert!((run.get("slide.position") / -2e9 - 1.0).abs() < 1e-9);
    let error = run.0.step(100.0).unwrap_err();
    assert_says(error, &["past the end of its travel", "2e9 m from the guess"]);
    let refusal = Run::new(arm(json!({}))).with(&[("rail.start_position", 1e300)]).refusal();
    assert_says(refusal, &["rail.start_position", "cannot be reached"]);
}

/// Far from the guess the outputs depend only on the state: with and without tables, and in their derivatives.
#[test]
fn far_out_the_tables_agree_with_the_exact_evaluator() {
    let [mut with, mut without] = [true, false].map(|tables| {
        let friction = json!({ "enabled": true, "static_coefficient": 0.1, "kinetic_coefficient": 0.05 });
        let mut run = Run::new(arm(json!({ "friction": friction })));
        run.set("solver.tables", tables);
        run.place(("rail.start_position", 170.0), ("rail.start_speed", 20.0));
        run
    });
    for _ in 0..10 {
        for run in [&mut with, &mut without] {
            run.step(1.0);
        }
        for name in ["rail.position", "arm.angle", "arm.speed", "slot.friction_force", "rail.force"] {
            let (a, b) = (with.get(name), without.get(name));
            assert!((a - b).abs() <= 1e-9 * a.abs().max(1e-3), "{name}: {a} {b}");
        }
        let (rate, speed) = (with.derivative("rail.position"), with.get("rail.speed"));
        assert!((rate / speed - 1.0).abs() < 1e-11);
        let (rate, acceleration) = (with.derivative("arm.speed"), with.get("arm.acceleration"));
        assert!((rate - acceleration).abs() < 1e-12 + 1e-9 * acceleration.abs());
    }
}

/// A guess beyond a stop selects the branch. The motion and the length of the traced curve are the same as for a guess
/// within the travel. For a guess far beyond, the whole curve is traced.
#[test]
fn a_guess_beyond_a_stop_names_the_branch() {
    let stated = r#""guess": { "crank": 0.8, "#;
    let within = Reduced::new(&Mechanism::from_json(GEAR).unwrap()).unwrap();
    let mut reference = Run::gear();
    reference.set("actuator.force", 28_000.0);
    reference.initialize();
    reference.step(0.11);
    for (guess, is_near) in [(0.85, true), (1.2, true), (-1.5, true), (2.6, false)] {
        let text = GEAR.replace(stated, &format!(r#""guess": {{ "crank": {guess}, "#));
        assert_ne!(text, GEAR);
        let reduced = Reduced::new(&Mechanism::from_json(&text).unwrap()).unwrap();
        let (panels, of_travel) = (reduced.influence().panels(), within.influence().panels());
        assert_eq!(panels < of_travel + 4, is_near, "guess {guess}: {panels} panels, within the travel {of_travel}");
        if !is_near {
            // This guess closes on another branch.
            continue;
        }
        let mut run = Run::new(&text);
        run.set("actuator.force", 28_000.0);
        run.initialize();
        run.step(0.11);
        for name in ["crank.angle", "crank.speed", "joint3.force", "actuator.length", "energy.potential"] {
            let (own, expected) = (run.get(name), reference.get(name));
            assert!(
                (own - expected).abs() < 1e-9 * expected.abs().max(1.0),
                "guess {guess}: {name} = {own}, not {expected}"
            );
        }
    }
}
