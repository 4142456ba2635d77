//! Inputs that change within a step: order, exactness, energy, and release from a stop or a drive within the step.

use crate::support::{GEAR, Run, replaced};

const FORCE: &str = "\"force\": 30000";

/// The gear at its start with these values. The flags are set to true. The flag `efficiency` gives the drive the
/// efficiency 0.6.
fn gear(values: &[(&str, f64)], flags: &[&str]) -> Run {
    let changed = format!("{FORCE}, \"efficiency\": 0.6");
    let mut gear =
        if flags.contains(&"efficiency") { Run::new(replaced(GEAR, &[(FORCE, &changed)])) } else { Run::gear() };
    flags.iter().filter(|flag| **flag != "efficiency").for_each(|flag| gear.set(flag, true));
    gear.with(values).started()
}

/// Angle and speed at the end of a ramp of the actuator force: from `force` at this rate over `span`.
fn ramped(mut gear: Run, force: f64, rate: f64, span: f64) -> [f64; 2] {
    gear.set("actuator.force", force);
    gear.set_derivative("actuator.force", 1, rate);
    gear.step(span);
    state(&mut gear)
}

fn state(gear: &mut Run) -> [f64; 2] {
    ["crank.angle", "crank.speed"].map(|name| gear.get(name))
}

/// The error of the integration is small compared with the error from the inputs.
const TIGHT: (&str, f64) = ("solver.tolerance", 1e-13);
const SPAN: f64 = 0.08;

/// Run with F = 30 kN + 10 kN sin(300 t), set with this many derivatives at each communication point.
fn sampled(steps: usize, derivatives: i32, flags: &[&str]) -> Run {
    let (amplitude, omega) = (1e4, 300.0);
    let mut gear = gear(&[TIGHT], flags);
    let h = SPAN / steps as f64;
    for n in 0..steps {
        let (sine, cosine) = (omega * n as f64 * h).sin_cos();
        gear.set("actuator.force", 3e4 + amplitude * sine);
        if derivatives > 0 {
            gear.set_derivative("actuator.force", 1, amplitude * omega * cosine);
        }
        if derivatives > 1 {
            gear.set_derivative("actuator.force", 2, -amplitude * omega * omega * sine);
        }
        gear.step(h);
    }
    gear
}

#[test]
fn each_derivative_raises_the_order_by_one() {
    for flags in [&[][..], &["friction.enabled"]] {
        let exact = state(&mut sampled(8000, 2, flags));
        for derivatives in 0..=2 {
            let error = |steps| {
                let mut gear = sampled(steps, derivatives, flags);
                assert!(gear.get("energy.drift").abs() < 1e-7, "{}", gear.get("energy.drift"));
                (state(&mut gear)[0] - exact[0]).abs()
            };
            let errors = [40, 80, 160].map(error);
            let order = (errors[1] / errors[2]).log2();
            // In this run the leading error terms of orders 1 and 3 are small, so the next terms dominate.
            let above = order - f64::from(derivatives + 1);
            assert!(-0.25 < above && above < 0.8, "{derivatives} {errors:?}");
        }
    }
}

#[test]
fn one_step_under_a_parabola_is_as_good_as_many() {
    // All inputs that act change in time, with wind and gravity.
    let inputs = [
        ("actuator.force", [3e4, -4e4, 3e6]),
        ("load_factor", [3.0, -20.0, 100.0]),
        ("wheel.force_x", [0.0, 5e3, 0.0]),
    ];
    let wind = ("airspeed", [0.0, 400.0, 1e3]);
    for (flags, winds) in [
        (&[][..], false),
        (&["friction.enabled"][..], false),
        (&[][..], true),
        (&["friction.enabled", "air.relative_wind"][..], true),
        (&["efficiency"][..], false),
        (&["efficiency", "friction.enabled"][..], true),
    ] {
        let inputs: Vec<_> = inputs.into_iter().chain(winds.then_some(wind)).collect();
        let run = |steps: usize| {
            let mut gear = gear(&[TIGHT], flags);
            let h = SPAN / steps as f64;
            for n in 0..steps {
                let t = n as f64 * h;
                for (name, [zeroth, first, second]) in &inputs {
                    gear.set(name, zeroth + first * t + 0.5 * second * t * t);
                    gear.set_derivative(name, 1, first + second * t);
                    gear.set_derivative(name, 2, *second);
                }
                gear.step(h);
            }
            for (name, [zeroth, first, second]) in &inputs {
                let end = zeroth + first * SPAN + 0.5 * second * SPAN * SPAN;
                assert!((gear.get(name) - end).abs() <= 1e-12 * end.abs(), "{name}");
            }
            let drift = gear.get("energy.drift");
            assert!(drift.abs() < 2e-8, "{flags:?} {winds} {steps}: {drift}");
            state(&mut gear)
        };
        let (one, many) = (run(1), run(97));
        for i in 0..2 {
            assert!((one[i] - many[i]).abs() < 1e-10 * many[1].abs(), "{flags:?} {winds}: {one:?} {many:?}");
        }
    }
}

#[test]
fn derivatives_hold_for_one_step_and_the_input_stays_where_it_came_to() {
    let mut gear = gear(&[], &[]);
    gear.set_derivative("actuator.force", 1, 1e6);
    gear.step(1e-3);
    assert_eq!(gear.get("actuator.force"), 31_000.0);
    gear.step(1e-3);
    assert_eq!(gear.get("actuator.force"), 31_000.0);
    let mut other = self::gear(&[], &[]);
    // Value and derivative may be set in any order.
    other.set_derivative("actuator.force", 1, 1e6);
    other.set("actuator.force", 30_000.0);
    other.step(1e-3);
    other.step(1e-3);
    assert_eq!(state(&mut gear), state(&mut other));
}

#[test]
fn a_ramp_releases_the_gear_from_the_down_stop_at_the_exact_time() {
    for flags in [&[][..], &["friction.enabled"]] {
        let mut gear = gear(&[("actuator.force", 0.0), TIGHT], flags);
        let holding = gear.get("actuator.holding_force");
        let release = 0.0312;
        let start = holding - 5_000.0;
        let rate = 5_000.0 / release;
        gear.set("actuator.force", start);
        assert!(gear.get("downstop.torque") < 0.0);
        gear.set_derivative("actuator.force", 1, rate);
        gear.step(0.999 * release);
        assert!((state(&mut gear)[0] - 0.8).abs() < 1e-14 && state(&mut gear)[1] == 0.0);
        // One long step across the release, against a start at the release.
        let rest = 0.01;
        let long = ramped(self::gear(&[("actuator.force", start), TIGHT], flags), start, rate, release + rest);
        let short = ramped(self::gear(&[("actuator.force", holding), TIGHT], flags), holding, rate, rest);
        assert!(short[1] < -1e-3);
        for i in 0..2 {
            assert!((long[i] - short[i]).abs() < 1e-9 * short[1].abs(), "{flags:?}: {long:?} {short:?}");
        }
    }
}

#[test]
fn a_ramp_overcomes_the_drive_that_holds_the_gear_at_rest() {
    let at = [("crank.start_angle", 0.5), TIGHT];
    let mut gear = gear(&at, &["efficiency"]);
    let holding = gear.get("actuator.holding_force");
    // The drive moves forward above the holding force / efficiency, backward below holding force x efficiency. In
    // between it holds the gear.
    let [first, last] = if holding < 0.0 { [holding, 0.2 * holding] } else { [holding, 3.0 * holding] };
    let limit = if holding < 0.0 { 0.6 * holding } else { holding / 0.6 };
    let release = 0.0312;
    let rate = (limit - first) / release;
    let rest = (last - limit).abs().min(500.0) / rate.abs();
    let long = ramped(self::gear(&at, &["efficiency"]), first, rate, release + rest);
    let short = ramped(self::gear(&at, &["efficiency"]), limit, rate, rest);
    assert!(short[1].abs() > 1e-6, "{short:?}");
    for i in 0..2 {
        assert!((long[i] - short[i]).abs() < 1e-8 * short[1].abs(), "{long:?} {short:?}");
    }
}

#[test]
fn a_ramp_that_turns_brings_the_gear_back_to_its_stop() {
    let mut gear = gear(&[("actuator.force", 3e4)], &[]);
    gear.set_derivative("actuator.force", 1, -2e6);
    gear.step(0.1);
    let [angle, speed] = state(&mut gear);
    assert!((angle - 0.8).abs() < 1e-14 && speed == 0.0, "{angle} {speed}");
    let drift = gear.get("energy.drift");
    assert!(drift.abs() < 1e-4, "{drift}");
}

#[test]
fn an_input_derivative_out_of_range_is_rejected() {
    let mut gear = gear(&[], &[]);
    let (force, angle) = (0, gear.0.reference("crank.angle").unwrap());
    for (reference, order, value) in
        [(force, 0, 1.0), (force, 3, 1.0), (force, 1, f64::NAN), (angle, 1, 1.0), (9999, 1, 1.0)]
    {
        assert!(gear.set_input_derivative(reference, order, value).is_err());
    }
    gear.set_derivative("actuator.force", 2, f64::MAX);
    let before = state(&mut gear);
    let error = gear.0.step(10.0).unwrap_err().to_string();
    assert!(error.contains("actuator.force"), "{error}");
    assert_eq!(state(&mut gear), before);
    gear.set("solver.method", "rigid_fem");
    assert!(gear.set_input_derivative(force, 1, 1.0).unwrap_err().to_string().contains("rigid_fem"));
}
