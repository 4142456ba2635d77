//! Locks that engage by the force of their stop: closed forms of the instant and of the motion after it, saved states,
//! rejected definitions.
use crate::support::definition::{G, With, arm, block, friction, weight};
use crate::support::{Run, assert_near, assert_rejected};
use serde_json::{Value, json};

const MASS: f64 = 3.0;
const FORCE: f64 = 12.0;

/// A block at a lower stop at 0, with a latch there.
fn latch(more: Value) -> Value {
    block(MASS)
        .with(json!({
            "forces": { "pull": { "at": "block.origin", "force": [0, 0] } },
            "stops": { "end": { "joint": "slide", "limit": "lower", "position": 0 } },
            "locks": { "latch": { "stop": "end", "at": "block.origin", "engage": true, "engage_force": FORCE } },
            "solver": { "tolerance": 1e-12 },
        }))
        .with(more)
}

/// A push against the stop that grows to a largest value after 1 s and becomes a pull after 2 s, in one step or in
/// many. The latch engages only if the push exceeds its force.
#[test]
fn a_latch_engages_when_it_is_pressed_harder_than_its_force() {
    for (most, holds) in [(FORCE * (1.0 - 1e-9), false), (FORCE * (1.0 + 1e-9), true)] {
        for count in [1, 3, 50] {
            let mut run = Run::new(latch(json!({}))).started();
            run.listen(true, false);
            assert!(!run.is("latch.engaged"));
            let mut lines = Vec::new();
            run.follow("pull.force_x", [0.0, -2.0 * most, 2.0 * most], (count, 3.0), |run, t| {
                assert_eq!(run.is("latch.engaged"), holds && t > 0.99, "{t}");
                lines.extend(run.take_occurrences(t).into_iter().map(|line| line.text));
            });
            assert_eq!(run.is("latch.engaged"), holds);
            assert_eq!(lines.iter().filter(|line| line.contains("its lock engages")).count(), usize::from(holds));
            run.set("pull.force_x", 3.0 * most);
            if holds {
                assert_eq!((run.get("slide.position"), run.get("slide.speed")), (0.0, 0.0));
                run.near("latch.force", 3.0 * most, 1e-10);
            } else {
                // Of the pull most (t^2 - 2 t) from 2 s on.
                run.near("slide.speed", most * (9.0 - 9.0 - 8.0 / 3.0 + 4.0) / MASS, 1e-9);
                run.near("latch.force", 0.0, 0.0);
            }
            run.near("energy.drift", 0.0, 1e-9);
        }
    }
}

/// Static friction carries its part of the load: the force of the stop is the rest, in the output and for the latch.
#[test]
fn static_friction_carries_a_part_of_the_contact_force() {
    let rough = latch(json!({
        "gravity": weight(), "friction": friction([0.4, 0.2], [0.0; 2]).with(json!({ "law": "stick" })),
    }));
    let carried = 0.4 * MASS * G;
    for (rest, holds) in [(0.999 * FORCE, false), (1.001 * FORCE, true)] {
        let mut run = Run::new(&rough).with(&[("pull.force_x", -(carried + rest))]).started();
        run.near("slide.friction_force", carried, 1e-10);
        run.near("end.force", rest, 1e-10);
        run.step(0.1);
        assert_eq!(run.is("latch.engaged"), holds, "{rest}");
    }
}

/// The input releases the latch, which needs its force again; a saved state keeps it engaged.
#[test]
fn the_input_releases_a_latch() {
    let mut run = Run::new(latch(json!({}))).with(&[("pull.force_x", -20.0)]).started();
    assert!(!run.is("latch.engaged"));
    run.step(0.1);
    assert!(run.is("latch.engaged"));
    run.near("end.force", 20.0, 1e-12);
    run.near("latch.force", 0.0, 0.0);
    run.set("pull.force_x", 5.0);
    run.step(0.1);
    run.near("latch.force", 5.0, 1e-12);
    let bytes = run.saved();
    let mut other = Run::new(latch(json!({}))).started();
    other.take(&bytes);
    for run in [&mut run, &mut other] {
        assert!(run.is("latch.engaged"));
        run.step(0.1);
        assert_eq!(run.get("slide.speed"), 0.0);
        run.set("latch.engage", false);
        assert!(!run.is("latch.engaged"));
        run.step(0.2);
        run.near("slide.speed", 1.0 / MASS, 1e-12);
        // Back at the stop, without the force of the latch.
        run.set_all(&[("pull.force_x", -5.0)]);
        run.set("latch.engage", true);
        run.step(2.0);
        assert_eq!(run.get("slide.position"), 0.0);
        assert!(!run.is("latch.engaged"));
        run.set("pull.force_x", 1.0);
        run.step(0.3);
        run.near("slide.speed", 0.1, 1e-12);
    }
    // The force may change during the run.
    let mut run =
        Run::new(latch(json!({}))).with(&[("pull.force_x", -20.0)]).with(&[("latch.engage_force", 30.0)]).started();
    run.step(0.1);
    assert!(!run.is("latch.engaged"));
    run.set("latch.engage_force", 10.0);
    run.step(0.1);
    assert!(run.is("latch.engaged"));
}

/// A block comes to a bumper without damping. The push is largest where the block turns back, with v sqrt(k m). Beyond
/// the force of the latch, the block is caught where it leaves the bumper.
#[test]
fn a_latch_at_a_bumper_engages_within_the_contact() {
    let (stiffness, speed) = (4e3, 0.8);
    let most = speed * f64::sqrt(stiffness * MASS);
    let omega = f64::sqrt(stiffness / MASS);
    for (part, catches) in [(1.0 + 1e-7, false), (1.0 - 1e-7, true), (0.3, true)] {
        let definition = latch(json!({
            "stops": { "end": { "rigid": false, "stiffness": stiffness } },
            "locks": { "latch": { "engage_force": part * most } },
            "start": { "position": 0.4, "speed": -speed },
        }));
        for count in [1, 40] {
            let mut run = Run::new(&definition).started();
            run.listen(true, false);
            let mut time = None;
            let h = 0.7 / f64::from(count);
            for k in 0..count {
                run.step(h);
                let lines = run.take_occurrences(h * f64::from(k));
                let line = lines.into_iter().map(|line| line.text).find(|line| line.contains("its lock engages"));
                time = time.or(line);
            }
            assert_eq!((time.is_some(), run.is("latch.engaged")), (catches, catches), "{part}");
            if let Some(line) = time {
                let expected = 0.5 + part.asin() / omega;
                let number = |word: &str| word.trim_matches(|c: char| !c.is_ascii_digit()).parse::<f64>().ok();
                let found = line.split_whitespace().filter_map(number).find(|t| (t - expected).abs() < 1e-5);
                assert!(found.is_some(), "{line}: {expected}");
                run.near("slide.position", 0.0, 1e-15);
                assert_eq!(run.get("slide.speed"), 0.0);
                run.set("pull.force_x", 50.0);
                run.near("latch.force", 50.0, 1e-11);
            } else {
                run.near("slide.speed", speed, 1e-10);
            }
            run.near("energy.drift", 0.0, 1e-10);
        }
    }
    // A damper pushes at once.
    let damped = latch(json!({
        "stops": { "end": { "rigid": false, "stiffness": stiffness, "damping": 50 } },
        "locks": { "latch": { "engage_force": 39.0 } }, "start": { "position": 0.4, "speed": -speed },
    }));
    let mut run = Run::new(damped).started();
    run.step(0.5 + 1e-6);
    assert!(run.is("latch.engaged"));
    run.step(0.2);
    assert_eq!(run.get("slide.speed"), 0.0);
}

/// A latch at a bumper whose input becomes true while the mechanism rests at a rigid stop behind the bumper.
#[test]
fn a_latch_at_a_bumper_engages_at_rest_at_another_stop() {
    let mut run = Run::new(latch(json!({
        "stops": {
            "end": { "rigid": false, "stiffness": 4e3 },
            "back": { "joint": "slide", "limit": "lower", "position": -0.01, "restitution": 0 },
        },
        "locks": { "latch": { "engage": false } },
    })))
    .with(&[("pull.force_x", -100.0)])
    .started();
    run.step(1.0);
    run.near("slide.position", -0.01, 1e-15);
    run.near("end.force", 40.0, 1e-9);
    run.set("latch.engage", true);
    run.step(0.1);
    assert!(run.is("latch.engaged"));
    run.set("pull.force_x", 50.0);
    run.step(1.0);
    run.near("slide.position", 0.0, 1e-15);
    assert_eq!(run.get("slide.speed"), 0.0);
}

/// The input releases a latch under a prescribed motion too.
#[test]
fn the_input_releases_a_latch_under_a_prescribed_motion() {
    let mut run = Run::new(latch(json!({
        "actuators": { "ram": { "joint": "slide", "motion": { "position": 0 } } },
    })));
    run.set("ram.motion.enabled", false);
    run.set("pull.force_x", -20.0);
    let mut run = run.started();
    run.step(0.1);
    assert!(run.is("latch.engaged"));
    run.set("latch.engage", false);
    run.set("ram.motion.enabled", true);
    run.set_all(&[("ram.motion.position", 0.0), ("ram.motion.speed", 1.0)]);
    run.step(0.1);
    run.near("slide.position", 0.1, 1e-12);
    run.set("latch.engage", true);
    run.step(0.1);
    assert!(!run.is("latch.engaged"));
}

/// The friction of a belt presses the block against the stop, with belt speed and load as parabolas in time. The
/// largest force within a step decides, though the friction is no polynomial of degree 4 in time.
#[test]
fn a_latch_engages_by_the_friction_of_a_belt() {
    let parabola = |[a, b, c]: [f64; 3], t: f64| a + t * (b + 0.5 * t * c);
    for (speed, load) in [
        ([0.996614, -3.545362, 7.606388], [3.705009, 7.327718, -32.195845]),
        ([1.278725, -3.452358, 6.830212], [4.75986, -3.788115, -39.321068]),
    ] {
        let press = |t: f64| {
            let s = (parabola(speed, t) - 0.1).min(1.0);
            (0.6 - 0.5 * s * s * (3.0 - 2.0 * s)) * (MASS * G - parabola(load, t))
        };
        let most = (0..=2000).map(|k| press(f64::from(k) / 2000.0)).fold(0.0, f64::max);
        for (part, engages) in [(0.999, true), (1.001, false)] {
            let mut run = Run::new(latch(json!({
                "gravity": weight(), "friction": friction([0.6, 0.1], [0.1, 1.1]),
                "joints": { "slide": { "surface_speed": -speed[0] } },
                "locks": { "latch": { "engage_force": part * most } },
            })))
            .with(&[("pull.force_y", load[0])])
            .started();
            for order in [1, 2] {
                run.set_derivative("slide.surface_speed", order, -speed[order as usize]);
                run.set_derivative("pull.force_y", order, load[order as usize]);
            }
            run.step(1.0);
            assert_eq!(run.is("latch.engaged"), engages, "{speed:?} {part}");
        }
    }
}

/// A belt presses the block against the stop. The friction vanishes for a moment within a step, as the load lifts the
/// block, so that a small pull takes the block off the stop.
#[test]
fn a_block_leaves_a_stop_where_the_friction_of_its_belt_vanishes() {
    let weight_of_block = MASS * G;
    let lift = weight_of_block / 0.4;
    let after = |count: u32| {
        let belt = json!({
            "gravity": weight(), "friction": friction([0.3, 0.2], [1.0, 2.0]),
            "joints": { "slide": { "surface_speed": -0.5 } },
        });
        let mut run = Run::new(latch(belt)).with(&[("pull.force_x", 0.3)]).started();
        run.follow("pull.force_y", [0.0, lift, 0.0], (count, 0.45), |_, _| {});
        run.get("slide.position")
    };
    let many = after(450);
    assert!(many > 1e-5, "{many}");
    for count in [1, 7, 45] {
        assert_near(after(count), many, 1e-9, "position");
    }
}

/// A drive with losses holds a block on a belt, until the belt is so slow that its friction overcomes the drive.
#[test]
fn a_belt_that_slows_down_overcomes_a_drive_with_losses() {
    let after = |count: u32| {
        let belt = json!({
            "gravity": weight(), "friction": friction([0.4, 0.2], [0.1, 0.6]),
            "joints": { "slide": { "surface_speed": 1.5 } },
            "actuators": { "ram": { "joint": "slide", "force": -7, "efficiency": 0.8 } },
        });
        let mut run = Run::new(block(MASS).with(belt).with(json!({ "solver": { "tolerance": 1e-12 } }))).started();
        run.follow("slide.surface_speed", [1.5, -1.4, 0.0], (count, 1.0), |_, _| {});
        run.get("slide.position")
    };
    let many = after(500);
    assert!(many > 1e-3, "{many}");
    for count in [1, 7] {
        assert_near(after(count), many, 1e-8, "position");
    }
}

/// At the stop of an angle the force is a torque, of a deg file too.
#[test]
fn a_latch_at_an_angle_engages_at_a_torque() {
    let definition = arm(0.6, 2.0, 0.0).with(json!({
        "units": { "angle": "deg" },
        "actuators": { "motor": { "joint": "pivot", "torque": 0 } },
        "stops": { "up": { "body": "arm", "limit": "upper", "angle": 0 } },
        "locks": { "catch": { "stop": "up", "at": "arm.end", "engage": true, "engage_force": 1.5 } },
    }));
    for (torque, engages) in [(1.5 * (1.0 - 1e-9), false), (1.5 * (1.0 + 1e-9), true)] {
        let mut run = Run::new(&definition).with(&[("motor.torque", torque)]).started();
        run.step(0.1);
        run.near("up.torque", -torque, 1e-12);
        assert_eq!(run.is("catch.engaged"), engages);
        run.set("motor.torque", -1.0);
        run.step(0.1);
        assert_eq!(run.get("arm.speed") == 0.0, engages);
    }
    assert_near(Run::new(&definition).get("catch.engage_force"), 1.5, 0.0, "the unit of a torque is no angle");
}

#[test]
fn a_latch_with_a_release_force_or_another_lock_is_rejected() {
    assert_rejected("latches", latch(json!({})));
}
