//! Switches of a drive between motion and force, and saved states of both.
use super::{G, MASS, gear, is_close, lift, opened};
use crate::support::assert_says;
use linkage_fmu::mechanism::Model;
use serde_json::json;

#[test]
fn a_drive_is_switched_between_motion_and_force_in_a_run() {
    let mut lift = opened(&lift(&json!({ "position": 0.5 })));
    lift.set("winch.motion.speed", 1.0);
    let mut lift = lift.started();
    lift.listen(true, false);
    lift.step(0.5);
    is_close(lift.get("slide.position"), 1.0, 1e-14);
    // With the drive off: free fall from 1 m at 1 m/s.
    lift.set("winch.motion.enabled", false);
    lift.set("winch.force", 0.0);
    lift.step(0.25);
    let (position, speed) = (1.0 + 0.25 - 0.5 * G * 0.0625, 1.0 - G * 0.25);
    is_close(lift.get("slide.position"), position, 1e-12);
    is_close(lift.get("slide.speed"), speed, 1e-12);
    assert!(lift.get("energy.drift").abs() < 1e-10);
    // The drive is switched on at another speed: the impulse is reported.
    let here = lift.get("slide.position");
    lift.set("winch.motion.enabled", true);
    lift.set("winch.motion.position", here);
    lift.set("winch.motion.speed", -0.2);
    is_close(lift.get("slide.speed"), -0.2, 1e-14);
    lift.step(0.1);
    let lines: Vec<String> = lift.take_occurrences(0.75).into_iter().map(|line| line.text).collect();
    assert_says(&lines[0], &["t = 0.75 s", "motion of the drive winch", "jumps by 1.2525 m/s", "2.505 N.s"]);
    is_close(lift.get("slide.position"), position - 0.02, 1e-12);
    assert!(lift.get("energy.drift").abs() < 1e-10, "{}", lift.get("energy.drift"));
    // The prescribed position differs from the drive's position: an error, and nothing changes.
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
fn a_saved_state_continues_bit_identically() {
    let motions = [
        json!({ "profile": "trapezoid", "distance": 0.3, "speed": 0.5, "acceleration": 3 }),
        json!({ "position": 0.45 }),
    ];
    for motion in motions {
        let mut gear = gear(&motion, |gear| gear["friction"]["enabled"] = json!(true));
        let fresh = gear.clone();
        let by_inputs = motion.get("position").is_some();
        if by_inputs {
            gear.set("actuator.motion.acceleration", 0.4);
        }
        let mut gear = gear.started();
        let names = ["crank.angle", "crank.speed", "actuator.acting_force", "joint1.force_x", "energy.drift"];
        for n in 0..12 {
            let mut twin = fresh.clone();
            twin.take(&gear.saved());
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
            // Reading outputs before the step changes nothing.
            gear.bits(names);
            [&mut gear, &mut twin, &mut quiet].into_iter().for_each(|run| Model::step(run, 0.013).unwrap());
            let bits = [&mut gear, &mut twin, &mut quiet].map(|run| run.bits(names));
            assert!(bits[0] == bits[1] && bits[0] == bits[2], "{motion} {n}: {bits:?}");
        }
    }
}

#[test]
fn a_profile_restarts_at_the_drives_position_when_it_is_enabled_again() {
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
