//! Under unchanged inputs an internal step may extend beyond the communication point. Values read from its interpolant
//! are as exact as values of steps that end there. A changed input acts at once.

use super::one_element::slider::{MASS, Slider};
use crate::support::{Run, SLIDER_CRANK, changed};
use linkage_fmu::mechanism::Statistics;
use serde_json::json;

const SPAN: f64 = 0.13;

/// The gear with friction at its start.
fn gear(values: &[(&str, f64)]) -> Run {
    gear_with(true, values)
}

/// The gear with or without friction at its start.
fn gear_with(friction: bool, values: &[(&str, f64)]) -> Run {
    Run::gear().with(&[("friction.enabled", friction)]).with(values).started()
}

/// Work of `steps` steps over the span, largest error of the angle [rad], and largest energy drift [J]. The reference
/// for the angle is one step to each time at a tolerance of 1e-13.
fn work_and_errors(friction: bool, tolerance: f64, steps: u32) -> (Statistics, f64, f64) {
    let mut run = gear_with(friction, &[("solver.tolerance", tolerance)]);
    let h = SPAN / f64::from(steps);
    let (mut error, mut drift) = (0.0_f64, 0.0_f64);
    for n in 1..=steps {
        run.step(h);
        if n % (steps / 65).max(1) == 0 {
            let mut exact = gear_with(friction, &[("solver.tolerance", 1e-13)]);
            exact.step(h * f64::from(n));
            error = error.max((run.get("crank.angle") - exact.get("crank.angle")).abs());
        }
        drift = drift.max(run.get("energy.drift").abs());
    }
    (run.statistics(), error, drift)
}

/// With friction, and without losses. Without losses the Nystroem pair steps ahead and needs four evaluations per
/// interpolant.
#[test]
fn many_short_steps_cost_what_one_long_one_costs() {
    for (friction, interpolant, drifts) in [(true, 3, 4e4), (false, 4, 1e5)] {
        for (tolerance, steps) in [(1e-6, 130), (1e-6, 1300), (1e-9, 130), (1e-9, 13_000), (1e-12, 1300)] {
            let (long, ..) = work_and_errors(friction, tolerance, 1);
            let (work, error, drift) = work_and_errors(friction, tolerance, steps);
            // Additional work: interpolants of all steps instead of only those with an event, and the first short
            // steps. Near the rounding limit some steps are repeated.
            let again = if tolerance < 1e-11 { long.evaluations } else { 0 };
            let most = long.evaluations + interpolant * work.accepted + 60 + again;
            assert!(work.evaluations <= most, "{work:?} {long:?}");
            // Energies are some 10 kJ. Without losses the energy error is twice the speed error, which is up to 4 times
            // the tolerance.
            assert!(error < 2.0 * tolerance && drift < drifts * tolerance, "{error:e} rad, {drift:e} J");
        }
    }
}

#[test]
fn inputs_that_change_every_time_cost_no_more_than_a_short_step() {
    let mut run = gear(&[]);
    for n in 0..130 {
        run.set("actuator.force", 30_000.0 + f64::from(n));
        run.step(1e-3);
    }
    let work = run.statistics();
    assert!(work.evaluations <= 8 * 130, "{work:?}");
}

/// A force that changes within internal steps, against one step for each constant force.
#[test]
fn a_change_takes_effect_at_once() {
    let forces = [30_000.0, 20_000.0, 45_000.0, -5_000.0, 12_345.0];
    let (mut short, mut long) = (gear(&[]), gear(&[("solver.tolerance", 1e-12)]));
    for (k, force) in forces.into_iter().enumerate() {
        let parts = 7 + 12 * k;
        [&mut short, &mut long].into_iter().for_each(|run| run.set("actuator.force", force));
        (0..parts).for_each(|_| short.step(2e-4));
        long.step(2e-4 * parts as f64);
        for (name, bound) in [("crank.angle", 1e-9), ("crank.speed", 1e-7), ("energy.drift", 1e-6)] {
            let difference = (short.get(name) - long.get(name)).abs();
            assert!(difference < bound, "{name}, {force}: {difference:e}");
        }
    }
}

#[test]
fn a_stop_is_reached_at_its_time_and_never_passed() {
    let mut run = gear(&[("upstop.restitution", 0.5)]);
    let mut before = (0.0, false);
    let mut bounces = 0;
    for _ in 0..16_000 {
        run.step(5e-5);
        let (angle, speed) = (run.get("crank.angle"), run.get("crank.speed"));
        assert!((-1.3 - 1e-14..=0.8 + 1e-14).contains(&angle), "{angle}");
        bounces += u32::from(before.0 < 0.0 && speed > 0.0);
        before = (speed, run.is("retracted"));
    }
    assert!(bounces >= 3 && before == (0.0, true), "{bounces} {before:?}");
    assert!(run.get("energy.drift").abs() < 1e-5);
}

#[test]
fn a_lock_engaged_in_between_catches() {
    let engaged_late = |late: bool| {
        let mut run = gear(&[("upstop.restitution", 0.5)]);
        for n in 0..2000 {
            if late && n == 1335 {
                // The present step ahead ends with an impact on the stop.
                run.set("uplock.engage", true);
            }
            run.step(1e-4);
            if n == 1400 {
                return (run.get("crank.speed"), run.get("energy.drift"));
            }
        }
        unreachable!()
    };
    let ((free, _), (caught, drift)) = (engaged_late(false), engaged_late(true));
    assert!(free > 0.0 && caught == 0.0 && drift.abs() < 1e-5, "{free} {caught} {drift:e}");
}

/// If friction locks the mechanism further on, the error occurs in the communication step that reaches this position,
/// and not when a step ahead reaches it.
#[test]
fn friction_that_locks_further_on_stops_no_step_before() {
    let radii = ["joint1", "joint2", "joint3", "joint4"].map(|joint| format!("{joint}.pin_radius"));
    let radii = radii.each_ref().map(|name| (name.as_str(), 0.1));
    let rising = [("static_coefficient", 1e-3), ("kinetic_coefficient", 3.0), ("kinetic_speed", 20.0)];
    let rising = rising.map(|(name, value)| (format!("friction.{name}"), value));
    let rising = rising.each_ref().map(|(name, value)| (name.as_str(), *value));
    let passed = |h: f64| {
        let mut run = gear(&[]).with(&radii).with(&rising).started();
        let passed = (0..).take_while(|_| run.0.step(h).is_ok()).count();
        let error = run.0.step(h).unwrap_err().to_string();
        assert!(error.contains("friction locks the mechanism"), "{error}");
        passed
    };
    // Friction locks between 0.1349 s and 0.135 s, for any size of the steps ahead.
    assert_eq!((passed(1e-3), passed(1e-4), passed(1e-5) / 10), (134, 1349, 1349));
}

#[test]
fn whole_turns_are_counted_through() {
    let crank = Run::new(changed(SLIDER_CRANK, |m| {
        for joint in ["bearing", "crankpin", "wristpin"] {
            m["joints"][joint]["pin_radius"] = json!(0.01);
        }
        m["friction"] = json!({
            "enabled": true, "static_coefficient": 0.1, "kinetic_coefficient": 0.05,
            "static_speed": 0.01, "kinetic_speed": 0.5
        });
    }));
    let turned = |parts: u32, tolerance: f64| {
        let mut run = crank.clone().with(&[("solver.tolerance", tolerance)]).started();
        run.steps(parts, 0.5);
        (run.get("crank.angle"), run.get("energy.drift"))
    };
    let (exact, one, many) = (turned(1, 1e-13), turned(1, 1e-9), turned(5000, 1e-9));
    let [error_of_one, error_of_many] = [one, many].map(|run| (run.0 - exact.0).abs());
    assert!(exact.0 > 60.0 && error_of_many < 1e-6_f64.max(3.0 * error_of_one), "{error_of_one:e} {error_of_many:e}");
    // The kinetic energy is some 300 J.
    assert!(many.1.abs() < 1e-6, "{many:?}");
}

/// x'' = -2 zeta omega x' - omega^2 x. With strong damping one part of the motion decays much faster than the other,
/// and stability limits explicit steps.
#[test]
fn a_motion_that_fades_fast_is_read_as_exactly() {
    let omega: f64 = 12.0;
    for zeta in [0.1, 1.0, 3.0, 10.0, 40.0] {
        for tolerance in [1e-6, 1e-9, 1e-12] {
            let stiffness = MASS * omega * omega;
            let slider = Slider { stiffness, damping: 2.0 * zeta * omega * MASS, ..Slider::default() };
            let start = [("slide.start_position", 0.4), ("slide.start_speed", -2.0)];
            let mut run = slider.run(tolerance).with(&start).started();
            let mut exact = run.clone().with(&[("solver.tolerance", 1e-13)]).started();
            let mut errors = [0.0_f64; 2];
            for n in 1..=4000 {
                run.step(5e-4);
                if n % 10 == 0 {
                    exact.step(5e-3);
                    for (error, name) in errors.iter_mut().zip(["slide.position", "slide.speed"]) {
                        *error = error.max((run.get(name) - exact.get(name)).abs());
                    }
                }
            }
            // The tolerance of the speed is relative to the speed that the forces can give: up to some 30 m/s.
            let near = errors[0] < 2.0 * tolerance && errors[1] < 200.0 * tolerance;
            assert!(near, "zeta {zeta}, {tolerance:e}: {errors:?}");
        }
    }
}
