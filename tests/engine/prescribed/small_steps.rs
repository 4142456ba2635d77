//! Small steps under a prescribed motion: each step uses its part of an energy that is integrated beyond the step.
use super::{gear, is_close, stroke};
use linkage_fmu::mechanism::Model;
use serde_json::{Value, json};

/// Outputs for position, speed, force and energy balance.
const NAMES: [&str; 4] = ["crank.angle", "crank.speed", "actuator.acting_force", "energy.drift"];

fn with_friction(gear: &mut Value) {
    gear["friction"]["enabled"] = json!(true);
}

/// The drift shows any power that counts in a wrong step, under a load that has changed since, or twice.
#[test]
fn the_balance_holds_whatever_changes_between_small_steps() {
    let motion =
        json!({ "profile": "trapezoid", "distance": 0.3, "speed": 0.5, "acceleration": 3, "start_time": 0.05 });
    for friction in [false, true] {
        let mut gear = gear(&motion, |gear| gear["friction"]["enabled"] = json!(friction)).started();
        let mut time = 0.0;
        for n in 0..900 {
            match n {
                200 => gear.set("wheel.force_x", 3000.0),
                350 => gear.set("airspeed", 60.0),
                500 => gear.set("load_factor", 1.0),
                600 => gear.set_derivative("wheel.force_x", 1, -2e5),
                700 => gear.set("actuator.motion.enabled", false),
                720 => gear.set("actuator.motion.enabled", true),
                _ => {}
            }
            let h = [1e-4, 2e-3, 5e-4][n % 3];
            gear.step(h);
            time += h;
            let drift = gear.get("energy.drift");
            assert!(drift.abs() < 1e-6, "{friction} {n} {time}: {drift:e}");
        }
    }
}

#[test]
fn small_steps_end_where_one_large_step_does() {
    let motion = json!({ "profile": "cycloidal", "duration": 0.5, "distance": stroke() - 1e-3 });
    let run = |steps: u32| {
        let mut gear = gear(&motion, with_friction).started();
        (0..steps).for_each(|_| gear.step(0.4 / f64::from(steps)));
        NAMES.map(|name| gear.get(name))
    };
    let whole = run(1);
    for steps in [7, 400, 40_000] {
        for (value, whole) in run(steps).into_iter().zip(whole) {
            is_close(value, whole, 1e-8 * (1.0 + whole.abs()));
        }
    }
}

/// A failed step changes nothing, although the energy is integrated beyond its start.
#[test]
fn the_balance_is_correct_after_a_rejected_step() {
    let motion = json!({ "profile": "cycloidal", "duration": 0.5, "distance": stroke() + 0.01 });
    let mut gear = gear(&motion, with_friction).started();
    let failed = (0..5000).any(|_| {
        let before = gear.bits(NAMES);
        let is_made = gear.0.step(1e-4).is_ok();
        assert!(is_made || gear.bits(NAMES) == before);
        !is_made
    });
    assert!(failed);
    assert!(gear.get("energy.drift").abs() < 1e-6, "{:e}", gear.get("energy.drift"));
    gear.set("actuator.motion.enabled", false);
    gear.step(1e-4);
    assert!(gear.get("energy.drift").abs() < 1e-6, "{:e}", gear.get("energy.drift"));
}

#[test]
fn two_models_in_small_steps_are_bit_identical() {
    for motion in
        [json!({ "profile": "polynomial_345", "duration": 0.3, "distance": 0.3 }), json!({ "position": 0.45 })]
    {
        let mut gear = gear(&motion, with_friction);
        let fresh = gear.clone();
        if motion.get("position").is_some() {
            gear.set("actuator.motion.acceleration", 0.4);
        }
        let mut gear = gear.started();
        for n in 0..300 {
            let mut twin = (n % 10 == 3).then(|| {
                let mut twin = fresh.clone();
                twin.take(&gear.saved());
                twin
            });
            Model::step(&mut gear, 7e-4).unwrap();
            if let Some(twin) = &mut twin {
                Model::step(twin, 7e-4).unwrap();
                assert_eq!(twin.bits(NAMES), gear.bits(NAMES), "{motion} {n}");
            }
        }
    }
}
