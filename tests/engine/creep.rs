//! Creep under viscous friction, far slower than the speed that the loads could give without friction: closed form.

use crate::support::Run;
use crate::support::definition::{G, With, arm, block, friction, weight};
use serde_json::json;

const MASS: f64 = 2.0;
/// mu_S. Below V_S [m/s] the friction is c v, with c = mu_S m g / V_S.
const COEFFICIENT: f64 = 0.3;
const STATIC_SPEED: f64 = 1e-3;

/// A block on a horizontal slide, pushed from rest by a force [N]. `floor` is `solver.speed_floor`.
fn pushed(force: f64, floor: Option<f64>) -> Run {
    let mut definition = block(MASS).with(json!({
        "gravity": weight(), "solver": { "tolerance": 1e-9 },
        "actuators": { "push": { "joint": "slide", "force": force } },
        "friction": friction([COEFFICIENT; 2], [STATIC_SPEED, 1.0]),
    }));
    if let Some(floor) = floor {
        definition["solver"]["speed_floor"] = json!(floor);
    }
    Run::new(definition).started()
}

/// Largest relative error of the speed, from a tenth of the time constant on.
fn error(force: f64, floor: Option<f64>) -> f64 {
    let (rate, last) = (COEFFICIENT * G / STATIC_SPEED, force * STATIC_SPEED / (COEFFICIENT * MASS * G));
    let mut run = pushed(force, floor);
    let h = 0.1 / rate;
    let mut largest: f64 = 0.0;
    for k in 1..=200 {
        run.step(h);
        let exact = -last * (-0.1 * f64::from(k)).exp_m1();
        largest = largest.max((run.get("slide.speed") / exact - 1.0).abs());
    }
    largest
}

/// Closed form of the speed: v = (F / c) (1 - exp(-c t / m)). By default the tolerance of the speed is relative to the
/// speed that the force would give over 1 m without friction. With a floor it is relative to the present speed.
#[test]
fn a_floor_of_the_speed_makes_creep_exact() {
    for force in [1e-2, 1e-4] {
        let speed = force * STATIC_SPEED / (COEFFICIENT * MASS * G);
        let possible = (2.0 * force / MASS).sqrt();
        let (plain, floored) = (error(force, None), error(force, Some(1e-9)));
        println!("{force} N, {speed:.1e} m/s of {possible:.1e} m/s: {plain:.1e}, with the floor {floored:.1e}");
        assert!(plain > 100.0 * floored, "{plain:e} {floored:e}");
        // 100 x tolerance, relative to the present speed.
        assert!(floored <= 1e-7, "{floored:e}");
    }
}

/// The value 1 is the default and gives identical results. The floor is a parameter.
#[test]
fn a_floor_of_1_changes_nothing() {
    let mut runs = [pushed(1e-3, None), pushed(1e-3, Some(1.0)), pushed(1e-3, Some(0.5))];
    runs[2].set("solver.speed_floor", 1.0);
    runs[2].initialize();
    let speeds = runs.each_mut().map(|run| {
        run.steps(50, 0.01);
        (run.get("slide.speed").to_bits(), run.get("slide.position").to_bits(), run.statistics().evaluations)
    });
    assert_eq!(speeds[0], speeds[1]);
    assert_eq!(speeds[0], speeds[2]);
    for wrong in [0.0, -1.0, 1.5, f64::NAN] {
        assert!(runs[0].0.set("solver.speed_floor", wrong).is_err(), "{wrong}");
    }
}

/// A pendulum with friction comes to rest after many turning points, where the speed is 0. With any floor the
/// integration continues and the energy balance holds.
#[test]
fn turning_points_are_passed_with_any_floor() {
    let definition = arm(0.5, 1.0, 0.0).with(json!({
        "gravity": weight(), "joints": { "pivot": { "pin_radius": 0.01 } },
        "friction": friction([0.2, 0.1], [1e-3, 0.1]), "solver": { "tolerance": 1e-9 },
    }));
    let mut ends = Vec::new();
    for floor in [1.0, 1e-3, 1e-6, 1e-12, 1e-300] {
        let mut run = Run::new(&definition).with(&[("solver.speed_floor", floor)]).started();
        run.steps(400, 20.0);
        let drift = run.get("energy.drift").abs();
        // The energy at the start is 2.5 J.
        assert!(drift < 1e-7, "{floor:e}: {drift:e}");
        ends.push((run.get("arm.angle"), run.statistics().evaluations));
    }
    println!("{ends:?}");
    assert!(ends.iter().all(|end| (end.0 - ends[0].0).abs() < 1e-5), "{ends:?}");
}
