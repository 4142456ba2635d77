//! Long motions against closed forms: a pendulum swings and turns with periods that elliptic integrals give.

use crate::support::Run;
use crate::support::definition::{With, arm};
use serde_json::{Value, json};
use std::f64::consts::{PI, TAU};

/// theta'' = -sin theta: a rod of unit length on a pivot, with 3 g / (2 l) = 1. Start (angle, speed), tolerance.
fn pendulum([angle, speed]: [f64; 2], tolerance: f64, more: Value) -> Run {
    let swing = json!({
        "gravity": { "acceleration": 2.0 / 3.0, "up_angle": PI }, "start": { "speed": speed },
        "solver": { "tolerance": tolerance, "max_steps": 1e8 },
    });
    Run::new(arm(1.0, 1.0, angle).with(swing).with(more)).started()
}

/// Elastic stops at these angles.
fn between(low: f64, high: f64) -> Value {
    let stop = |limit: &str, angle: f64| json!({ "body": "arm", "angle": angle, "limit": limit, "restitution": 1 });
    json!({ "stops": { "low": stop("lower", low), "high": stop("upper", high) } })
}

/// Complete elliptic integral of the first kind K(k), by the arithmetic-geometric mean.
fn complete_elliptic(k: f64) -> f64 {
    let (mut a, mut g) = (1.0_f64, (1.0 - k * k).sqrt());
    for _ in 0..20 {
        (a, g) = (0.5 * (a + g), (a * g).sqrt());
    }
    0.5 * PI / a
}

/// Period of the swing or of the turn through the lowest point at this speed.
fn period(speed: f64) -> f64 {
    let k = 0.5 * speed;
    if k < 1.0 { 4.0 * complete_elliptic(k) } else { 2.0 / k * complete_elliptic(1.0 / k) }
}

/// Angle and speed after `span` [s], and the steps of the integration.
fn coast(mut run: Run, span: f64) -> ([f64; 2], u64) {
    run.step(span);
    let statistics = run.statistics();
    (["arm.angle", "arm.speed"].map(|name| run.get(name)), statistics.accepted + statistics.rejected)
}

#[test]
fn a_swing_and_a_turn_end_where_elliptic_integrals_say() {
    for speed in [0.1, 1.0, 1.9, 1.999, 2.001, 2.1, 3.0, 30.0] {
        let turns = speed > 2.0;
        // Relative change of the period for one of the speed.
        let sensitivity = (period(speed * (1.0 + 1e-6)) / period(speed) - 1.0).abs() * 1e6;
        for tolerance in [1e-9, 1e-13] {
            let start = pendulum([0.0, speed], tolerance, json!({}));
            for count in [1e4, 1e6] {
                // From the lowest point to the lowest point.
                let ([angle, _], steps) = coast(start.clone(), count * period(speed));
                let angle = angle - if turns { TAU * count } else { 0.0 };
                let phase = (angle / speed / period(speed)).abs();
                println!("{speed}, {tolerance:e}: {count:e} periods of {:.3} s: {phase:.1e}, {steps}", period(speed));
                // The steps before err by the tolerance, which changes the period; the period by a part in 1e12.
                let bound = count * (100.0 * tolerance * sensitivity + 1e-12) + 1e4 * tolerance;
                assert!(phase < bound, "{speed}, {tolerance:e}: {phase:e} of a period, above {bound:e}");
                // Whole periods take no steps.
                assert!(steps < 4000, "{steps}");
            }
        }
    }
}

#[test]
fn ten_thousand_turns_end_where_the_period_says() {
    // From 0.3 rad at 2.5 rad/s over whole periods and 0.3 s: the same as 0.3 s alone, 1e4 revolutions on.
    let speed = (2.5_f64.powi(2) + 2.0 * (1.0 - 0.3_f64.cos())).sqrt();
    let start = pendulum([0.3, 2.5], 1e-13, json!({}));
    let (end, steps) = coast(start.clone(), 1e4 * period(speed) + 0.3);
    let ([angle, rate], _) = coast(start, 0.3);
    let error = [end[0] - TAU * 1e4 - angle, end[1] - rate];
    assert!(error.iter().all(|e| e.abs() < 1e-8) && steps < 4000, "{error:?} {steps}");
}

#[test]
fn what_may_touch_a_stop_is_integrated_step_by_step() {
    let span = 1000.0 * period(1.0);
    // An amplitude of 60 degrees between stops that it does not reach, and one that it does.
    let (free, steps) = coast(pendulum([0.0, 1.0], 1e-9, between(-1.1, 1.1)), span);
    assert!(steps < 3000 && (free[1] - 1.0).abs() < 1e-6, "{steps} {free:?}");
    let (_, steps) = coast(pendulum([0.0, 1.0], 1e-9, between(-1.1, 1.0)), span);
    assert!(steps > 10_000, "{steps}");
}

#[test]
fn the_bound_ends_a_motion_that_has_no_period() {
    let bounded = |most: u64| json!({ "solver": { "max_steps": most } });
    // It bounces on a stop.
    let mut bouncing = pendulum([0.0, 1.0], 1e-9, between(-1.1, 0.5).with(bounded(5000)));
    assert!(bouncing.0.step(1e6).is_err());
    let taken = bouncing.statistics().accepted + bouncing.statistics().rejected;
    assert!(taken <= 5001, "{taken}");
    // Work without a period: the angle grows without bound.
    let motor = json!({ "torques": { "motor": { "on": "arm", "torque": 1e-6 } } });
    let mut turning = pendulum([0.0, 3.0], 1e-9, motor.with(bounded(2000)));
    assert!(turning.0.step(1e6).is_err());
    let taken = turning.statistics().accepted + turning.statistics().rejected;
    let angle = turning.get("arm.angle");
    assert!(taken <= 2000 && angle > 0.0 && angle < 3e3, "{taken} {angle}");
}
