//! Scene S1 of the landing gear against reference values of a 34-digit energy quadrature.

use crate::support::{Run, assert_says};

/// theta2 [rad] at times [s]: F = 30 kN, load factor 3, from rest at 0.8 rad.
const REFERENCE: [(f64, f64); 4] = [
    (0.02, 0.754_575_037_883_200_4),
    (0.05, 0.509_301_986_703_906_5),
    (0.10, -0.409_135_231_200_168_4),
    (0.13, THETA_013),
];
/// theta2 at 0.13 s [rad].
pub const THETA_013: f64 = -1.237_711_726_689_136_7;
const SPEED_AT_013: f64 = -30.118_354_649_349_844;
/// Time [s] at which theta2 = -1.3 rad is reached, and the speed then [rad/s].
const RETRACTED: (f64, f64) = (0.132_059_852_744_259_7, -30.257_773_253_560_312);

fn gear(tolerance: f64) -> Run {
    Run::gear().with(&[("solver.tolerance", tolerance)]).started()
}

#[test]
fn the_crank_follows_the_reference_at_every_tolerance() {
    for (tolerance, allowed) in
        [(1e-13, 1e-11), (1e-4, 1e-2), (1e-6, 1e-4), (1e-8, 1e-6), (1e-10, 1e-8), (1e-12, 1e-10)]
    {
        let mut gear = gear(tolerance);
        let mut next = 0;
        for millisecond in 1..=130 {
            gear.step(1e-3);
            let (time, theta) = REFERENCE[next];
            if (f64::from(millisecond) * 1e-3 - time).abs() < 1e-9 {
                let error = (gear.get("crank.angle") - theta).abs();
                assert!(error <= allowed, "tolerance {tolerance:e}, t = {time}: error {error:e}");
                next = (next + 1) % 4;
            }
        }
        assert!((gear.get("crank.speed") - SPEED_AT_013).abs() <= 300.0 * allowed);
    }
}

#[test]
fn splitting_the_span_changes_less_than_the_tolerance() {
    for tolerance in [1e-6, 1e-9, 1e-12] {
        let end = |steps: u32| {
            let mut gear = gear(tolerance);
            gear.steps(steps, 0.13);
            (gear.get("crank.angle"), gear.get("crank.speed"))
        };
        let (whole, many, most) = (end(1), end(130), end(13_000));
        for (angle, speed) in [many, most] {
            assert!((angle - whole.0).abs() <= tolerance, "{tolerance:e}: {:e}", angle - whole.0);
            assert!((speed - whole.1).abs() <= tolerance * whole.1.abs() * 10.0);
        }
    }
}

#[test]
fn the_gear_is_up_at_the_reference_time() {
    let mut gear = gear(1e-13);
    // At this time the gear is exactly at the stop. Rounding would decide whether the impact has occurred.
    gear.set("upstop.enabled", false);
    gear.initialize();
    gear.step(RETRACTED.0);
    assert!((gear.get("crank.angle") + 1.3).abs() < 1e-11);
    assert!((gear.get("crank.speed") - RETRACTED.1).abs() < 1e-9);
    assert!((gear.get("actuator.length") - 0.73668).abs() < 1e-5, "open length, PHYSICS");
}

#[test]
fn energy_drifts_by_less_than_a_billionth_of_the_work() {
    let mut gear = gear(1e-12);
    let start = gear.get("actuator.length");
    assert!((start - 0.41849).abs() < 1e-5, "closed length, PHYSICS");
    for _ in 0..130 {
        gear.step(1e-3);
        let work = 30_000.0 * (gear.get("actuator.length") - start).abs();
        assert!(gear.get("energy.drift").abs() < 1e-9 * work.max(1.0), "{}", gear.get("energy.drift"));
    }
}

#[test]
fn changing_inputs_leaves_the_energy_balance_closed() {
    let mut gear = gear(1e-12);
    for k in 0..130 {
        let phase = f64::from(k) * 0.3;
        let (sin, cos) = phase.sin_cos();
        gear.set_all(&[("actuator.force", 30_000.0 + 9_000.0 * sin), ("load_factor", 3.0 + cos)]);
        gear.set_all(&[("wheel.force_x", 500.0 * cos), ("follower.torque", 80.0 * sin)]);
        gear.step(1e-3);
        assert!(gear.get("energy.drift").abs() < 1e-7, "{k}: {}", gear.get("energy.drift"));
    }
    assert!(gear.get("energy.kinetic") > 1e3);
}

#[test]
fn sizes_beyond_reason_give_reasons_not_numbers() {
    let mut gear = gear(1e-9);
    // Away from the stop, which would balance any force.
    gear.step(1e-3);
    let start = (gear.get("crank.angle"), gear.get("crank.speed"));
    gear.set_all(&[("actuator.force", 1e308), ("load_factor", -1e308)]);
    for name in ["crank.acceleration", "joint1.force", "wheel.acceleration_x"] {
        assert!(gear.0.get(name).unwrap().is_nan(), "{name}");
        assert_says(gear.0.undefined(name).unwrap().unwrap(), &["largest number", "check the values"]);
    }
    assert_says(gear.0.step(1e-3).unwrap_err(), &["1e308", "inputs", "exceeds"]);
    assert_eq!((gear.get("crank.angle"), gear.get("crank.speed")), start);
    gear.set_all(&[("actuator.force", 30_000.0), ("load_factor", 3.0)]);
    for (name, value) in [("crank.mass", 1e308), ("crank.length", 1e100), ("gravity.acceleration", 1e100)] {
        let mut gear = self::gear(1e-9);
        gear.set(name, value);
        // The start is rejected, or all outputs are finite.
        if gear.0.initialize().is_ok() {
            let acceleration = gear.0.get("crank.acceleration");
            assert!(acceleration.unwrap().is_finite() || gear.0.step(1e-3).is_err(), "{name}");
        }
    }
    let refused = self::gear(1e-9).0.set("gravity.acceleration", 1e200).unwrap_err();
    assert_says(refused, &["gravity.acceleration", "1e200", "<= 1e100"]);
}
