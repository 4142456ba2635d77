//! Joint friction of the gear of [HF08]: slip speeds, time of retraction, errors at kinks, stiffness; a rod with
//! friction.

use crate::support::{MAIN_GEAR, Run};
use linkage_fmu::integrator::Method;

fn gear(values: &[(&str, f64)]) -> Run {
    Run::gear().with(&[("friction.enabled", true)]).with(values).started()
}

/// Time at which the crank reaches this angle: one step to an estimate, then Newton's method on new runs.
fn time_at(angle: f64, first: f64, values: &[(&str, f64)]) -> f64 {
    let mut t = first;
    for _ in 0..20 {
        let mut gear = gear(values);
        gear.step(t);
        let step = (angle - gear.get("crank.angle")) / gear.get("crank.speed");
        t += step;
        if step.abs() < 1e-13 {
            break;
        }
    }
    t
}

/// Slip speed = pin radius x relative angular speed, with friction enabled or not. The pin of joint 1 has 35 mm, the
/// others 30 mm (PHYSICS).
#[test]
fn pins_slip_at_their_radius_times_the_relative_angular_speed() {
    for enabled in [false, true] {
        let mut gear = gear(&[]).with(&[("friction.enabled", enabled)]).started();
        gear.step(0.1);
        let [crank, coupler, follower] =
            ["crank", "coupler", "follower"].map(|body| gear.get(&format!("{body}.speed")));
        let expected = [0.0175 * crank, 0.015 * (coupler - crank), 0.015 * (follower - coupler), 0.015 * follower];
        for (joint, expected) in (1..).zip(expected) {
            gear.near(&format!("joint{joint}.slip_speed"), expected, 1e-13 * expected.abs().max(0.1));
        }
    }
}

#[test]
fn the_gear_takes_as_long_as_the_reference() {
    // PHYSICS: mu 0.19 and 0.026, V_S 0.01, V_d 1.0 m/s, pins of 35 and 30 mm: 0.134488353 s.
    let stops = [("upstop.angle", -1.31), ("solver.tolerance", 1e-11)];
    let t = time_at(-1.3, 0.1344, &stops);
    assert!((t - 0.134488353).abs() < 1e-8, "{t}");
}

/// Kinks of the friction law are events. The error therefore follows the tolerance for every V_S.
#[test]
fn errors_stay_within_the_tolerance_at_every_static_speed() {
    for static_speed in [1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0] {
        let start = gear(&[("friction.static_speed", static_speed), ("friction.kinetic_speed", 2.0)]);
        let run = |tolerance: f64| {
            let mut gear = start.clone().with(&[("solver.tolerance", tolerance)]).started();
            gear.step(0.13);
            let work = 30_000.0 * (gear.get("actuator.length") - 0.418_49);
            (gear.get("crank.angle"), gear.get("energy.drift") / work)
        };
        let tight = run(1e-13).0;
        for tolerance in [1e-4, 1e-6, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12] {
            let (angle, drift) = run(tolerance);
            let error = (angle - tight).abs();
            assert!(error < 100.0 * tolerance, "V_S {static_speed}, tolerance {tolerance:e}: {error:e}");
            assert!(tolerance > 1e-12 || drift.abs() < 1e-9, "V_S {static_speed}: {drift:e}");
        }
    }
}

/// The drive does not overcome static friction, so that the gear creeps on the steep ramp of the law for a second. The
/// ramp's friction balances the drive, and the integration uses the implicit method.
#[test]
fn creeping_in_the_ramp_is_stiff_and_is_integrated_implicitly() {
    let start = gear(&[("friction.static_speed", 1e-6), ("crank.start_angle", 0.3)]);
    let mut at_rest = start.clone();
    let [forward, backward, hold] = ["breakaway_force_forward", "breakaway_force_backward", "holding_force"]
        .map(|force| at_rest.get(&format!("actuator.{force}")));
    assert!(backward < hold && hold < forward);
    let mut gear = start.with(&[("actuator.force", 0.5 * (hold + forward))]).started();
    gear.step(1.0);
    let statistics = gear.statistics();
    let moved = gear.get("crank.angle") - 0.3;
    // A pin of 15 mm that slips at less than 1e-6 m/s rotates by less than 1e-4 rad per second.
    assert!(moved < 0.0 && moved > -1e-4, "{moved}");
    assert!(statistics.accepted_by(Method::Radau) > 0, "{statistics:?}");
    assert!(statistics.evaluations < 20_000, "{statistics:?}");
}

/// The gear creeps to rest within 1000 s, at a hundredth less than the holding force. Near rest the motion in a step is
/// smaller than its rounding, which must not shorten the steps (34 steps; 40 000 when each step was searched).
#[test]
fn creeping_to_rest_needs_few_steps() {
    let start = gear(&[
        ("friction.static_speed", 1e-4),
        ("friction.static_coefficient", 1.0),
        ("crank.start_angle", 0.0),
        ("solver.tolerance", 1e-6),
    ]);
    let hold = start.clone().get("actuator.holding_force");
    let mut gear = start.with(&[("actuator.force", 0.99 * hold)]).started();
    gear.step(1000.0);
    let statistics = gear.statistics();
    assert!(statistics.accepted < 100, "{statistics:?}");
}

/// A rod between a light slider with friction and a heavy slider on a vertical guide without friction. Where the heavy
/// slider falls, friction can reduce most of the reaction that causes it. With N = N_0 + k |N|, k < -1, the reaction is
/// still N_0 / (1 - k).
#[test]
fn friction_that_relieves_its_reaction_does_not_lock() {
    const TRAMMEL: &str = include_str!("../fixtures/trammel.json");
    let (light, heavy, rod, g, mu) = (0.1, 5.0, 0.1, 9.81, 0.5);
    let trammel = Run::new(TRAMMEL);
    let mut relieved = 0;
    for i in 0..=60 {
        let theta = 2.2 - 0.01 * f64::from(i);
        let mut run = trammel.clone().with(&[("rod.start_angle", theta)]).started();
        let (sin, cos) = theta.sin_cos();
        // M alpha + M' / 2 = -(heavy + rod / 2) g cos + mu |N| sin, N = weight + (heavy + rod / 2) (cos alpha - sin).
        let (inertia, lever) = (light * sin * sin + heavy * cos * cos + rod / 3.0, heavy + 0.5 * rod);
        let free = (-(light - heavy) * sin * cos - lever * g * cos) / inertia;
        let normal = (light + heavy + rod) * g + lever * (cos * free - sin);
        let k = lever * cos * mu * sin / inertia;
        let size = if normal > 0.0 { normal / (1.0 - k) } else { -normal / (1.0 + k) };
        relieved += usize::from(normal > 0.0 && k < -1.0);
        let (acceleration, exact) = (run.get("rod.acceleration"), free + mu * size * sin / inertia);
        assert!((acceleration - exact).abs() < 1e-10 * exact.abs(), "{theta}: {acceleration}, not {exact}; k {k}");
    }
    assert!(relieved > 20, "{relieved}");
    // Through this region, until the rod creeps.
    let mut run = trammel.with(&[("rod.start_angle", 1.95)]).started();
    (0..100).for_each(|_| run.step(1e-3));
    let (drift, speed) = (run.get("energy.drift"), run.get("rod.speed"));
    assert!(speed.abs() < 1e-3 && drift.abs() < 1e-9, "{speed}, drift {drift:e}");
}

/// The slowest doStep of a landing gear limits real-time use. While its brace passes the dead centre, seven joints rest
/// at one instant, friction changes its regime up to four times in 1 ms, and two reactions pass near 0.
#[test]
fn no_step_of_a_landing_gear_needs_many_evaluations() {
    let mut gear = Run::new(MAIN_GEAR).started();
    let needed: Vec<u64> = (0..30)
        .map(|_| {
            let before = gear.statistics().evaluations;
            gear.step(1e-3);
            gear.statistics().evaluations - before
        })
        .collect();
    // 95 and 740 where a step does not end near the next change.
    assert!(needed.iter().all(|needed| *needed <= 83), "{needed:?}");
    assert!(needed.iter().sum::<u64>() <= 615, "{needed:?}");
}
