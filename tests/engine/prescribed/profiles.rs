//! Prescribed motions by inputs and by profiles: steps of any size, kinks, short and late profiles, tables.
use super::{G, MASS, gear, is_close, lift, opened, slider_crank};
use serde_json::json;

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

/// Derivatives of the acceleration apply to one step. The motion is the integral of their polynomial.
#[test]
fn a_motion_by_inputs_ends_a_step_where_its_acceleration_leads() {
    let given = [("winch.motion.speed", 0.2), ("winch.motion.acceleration", -0.4)];
    let mut lift = opened(&lift(&json!({ "position": 0.5 }))).with(&given).started();
    lift.set_derivative("winch.motion.acceleration", 1, 3.0);
    lift.set_derivative("winch.motion.acceleration", 2, -5.0);
    let h = 0.5;
    lift.step(h);
    let travel = h * (0.2 + h * (-0.4 / 2.0 + h * (3.0 / 6.0 - h * 5.0 / 24.0)));
    is_close(lift.get("slide.position"), 0.5 + travel, 1e-13);
    is_close(lift.get("slide.speed"), 0.2 + h * (-0.4 + h * (3.0 / 2.0 - h * 5.0 / 6.0)), 1e-13);
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

/// A profile of 1 ms within a step of hours is integrated as exactly as in a separate step.
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

/// At a late start, time has few digits within a step. The motion within the profile stays exact.
#[test]
fn a_profile_with_a_late_start_is_followed() {
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

/// A table may start with any speed. Before its start time the drive is at rest.
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
    // At 0.5 s the mass gets the start speed of the table at once. This is work of the drive.
    assert!(lift.get("energy.drift").abs() < 1e-9, "{}", lift.get("energy.drift"));
}
