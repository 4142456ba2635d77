//! Locks that engage by the force of their stop: closed forms of the instant and of the motion after it, saved states,
//! rejected definitions.
use crate::support::definition::{With, arm, block};
use crate::support::{Run, assert_near, assert_says, refusal};
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
            let (h, mut lines) = (3.0 / f64::from(count), Vec::new());
            for k in 0..count {
                let t = h * f64::from(k);
                run.set("pull.force_x", most * t * (t - 2.0));
                run.set_derivative("pull.force_x", 1, most * (2.0 * t - 2.0));
                run.set_derivative("pull.force_x", 2, 2.0 * most);
                assert_eq!(run.is("latch.engaged"), holds && t > 0.99, "{t}");
                run.step(h);
                lines.extend(run.take_occurrences(t).into_iter().map(|line| line.text));
            }
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
    let detent = latch(json!({ "locks": { "latch": { "release_force": 5 } } }));
    assert_says(refusal(detent), &["locks.latch.engage_force", "remove engage_force or release_force"]);
    let two = latch(json!({ "locks": { "other": { "stop": "end", "at": "block.origin" } } }));
    assert_says(refusal(two), &["locks.latch.engage_force", "another lock"]);
    let none = latch(json!({ "locks": { "latch": { "engage_force": 0 } } }));
    assert_says(refusal(none), &["locks.latch.engage_force", "> 0"]);
}
