//! Motions that a mechanism cannot make, and invalid definitions of a motion, are rejected with the name of the key.
use super::{gear, is_close, lift, opened, slider_crank, stroke};
use crate::support::{BUCKET, Run, assert_rejected, assert_says, changed, refusal};
use serde_json::{Value, json};

#[test]
fn a_prescribed_motion_ends_at_a_stop_and_is_rejected_beyond_it() {
    let motion = |distance: f64| json!({ "profile": "cycloidal", "duration": 0.5, "distance": distance });
    let mut up = gear(&motion(stroke()), |_| {}).started();
    up.set("uplock.engage", true);
    (0..10).for_each(|_| up.step(0.06));
    assert!(up.is("retracted"));
    assert_eq!(up.get("crank.speed"), 0.0);
    // With the motion off, the lock holds the gear against the forces.
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
    let words = ["actuator.length = 0.7", "upstop ends the travel at 0.736", "set `enabled` of the stop to false"];
    assert_says(refused.unwrap(), &words);
    let time = beyond.0.time();
    assert!(beyond.get("actuator.acting_force").is_finite() && time < 0.5);
}

#[test]
fn an_engaged_lock_cannot_be_overcome_by_a_prescribed_motion() {
    let motion = json!({ "profile": "cycloidal", "duration": 0.5, "distance": 0.2 });
    let mut gear = gear(&motion, |_| {}).started();
    gear.set("downlock.engage", true);
    assert_says(
        gear.0.step(0.1).unwrap_err(),
        &["actuator.length = ", "the motion leaves or passes downstop, whose lock is engaged", "disengage"],
    );
    gear.set("downlock.engage", false);
    gear.step(0.1);
}

#[test]
fn a_dead_centre_is_reported_and_the_call_returns() {
    // The piston drives the crank. Its motion reverses at 0.45 m.
    let definition = |motion: &Value| {
        let mut crank = slider_crank(&json!(null));
        crank["actuators"] = json!({ "ram": { "joint": "guide", "motion": motion } });
        crank
    };
    let mut crank = opened(&definition(&json!({ "position": 0.44 }))).started();
    crank.set("ram.motion.speed", 1.0);
    crank.step(0.005);
    let error = crank.0.step(1.0).unwrap_err();
    assert_says(error, &["ram.position = ", "a dead centre near 0.4", "end the motion before this position"]);
    crank.set("ram.motion.position", 0.46);
    assert!(crank.0.get("crank.angle").is_ok_and(f64::is_nan));
    assert_says(crank.undefined("crank.angle"), &["ram.position = 0.46", "dead centre"]);
    crank.set("ram.motion.position", 0.44);
    crank.set("ram.motion.speed", -0.5);
    crank.step(0.1);
    is_close(crank.get("guide.position"), 0.39, 1e-13);
    let error = refusal(definition(&json!({ "position": 0.6 })));
    assert_says(error, &["ram.position = 0.6", "dead centre"]);
}

/// A drive between points at constant distance, or in a joint that does not move, has no dead centre and cannot move
/// the mechanism.
#[test]
fn a_drive_that_never_moves_cannot_have_a_prescribed_motion() {
    for (ends, words) in [
        (json!({ "first": "ground.origin", "second": "crank.end" }), "m apart in every position"),
        (json!({ "joint": "twins" }), "the angle is 0 rad in every position"),
    ] {
        for position in [0.0, 0.1] {
            let mut crank = slider_crank(&json!(null));
            let length = crank["bodies"]["crank"]["length"].clone();
            crank["bodies"]["twin"] = json!({ "length": length });
            for (name, at) in [("axes", "origin"), ("twins", "end")] {
                let first = if at == "origin" { "ground.origin" } else { "crank.end" };
                crank["joints"][name] = json!({ "type": "revolute", "first": first, "second": format!("twin.{at}") });
            }
            crank["guess"]["twin"] = crank["guess"]["crank"].clone();
            crank["actuators"] = json!({ "ram": ends.clone() });
            crank["actuators"]["ram"]["motion"] = json!({ "position": position });
            let error = refusal(crank);
            assert_says(&error, &["ram.", "is prescribed", words, "give "]);
            assert!(!error.contains("dead"), "{error}");
        }
    }
}

#[test]
fn friction_that_locks_the_mechanism_against_its_drive_is_an_error() {
    let text = changed(BUCKET, |bucket| {
        let drives = bucket["actuators"].as_object_mut().unwrap();
        let name = drives.keys().next().unwrap().clone();
        drives[&name]["motion"] = json!({ "profile": "cycloidal", "duration": 2, "distance": 0.05 });
    });
    let mut bucket = Run::new(&text).started();
    for _ in 0..20 {
        match bucket.0.step(0.1) {
            Ok(()) => assert!(bucket.get("energy.drift").abs() < 1.0, "{}", bucket.get("energy.drift")),
            Err(error) => return assert_says(error, &["friction locks", "end the motion before this position"]),
        }
    }
}

#[test]
fn prescribed_motions_without_a_motion_are_rejected_with_their_name() {
    assert_rejected("motions", lift(&json!({ "position": 0.5 })));
    let mut two = slider_crank(&json!({ "position": 0.3 }));
    two["actuators"]["ram"] = json!({ "joint": "guide", "motion": { "position": 0.44 } });
    assert_says(refusal(two), &["motor already has a prescribed motion"]);
    let mut lift = opened(&lift(&json!({ "position": 0.5 }))).started();
    let error = lift.0.set_derivative("winch.motion.position", 1, 1.0).unwrap_err();
    assert_says(error, &["winch.motion.position", "set the input winch.motion.speed"]);
}

#[test]
fn a_prescribed_motion_that_starts_away_from_the_start_gives_a_warning() {
    let warned = |motion: &Value| opened(&lift(motion)).warnings();
    for (motion, words) in [
        (json!({ "position": 0.8 }), ["motion.position", "starts at 0.8", "the drive is at 0.5"]),
        (
            json!({ "profile": "table", "points": [[0, 0.7], [1, 1]] }),
            ["motion.points", "starts at 1.2", "start with 0 m at time 0"],
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
