//! Friction against closed forms, against the reactions of the model, and in balance with other losses.

use crate::support::definition::{G, With, block, friction, weight};
use crate::support::numeric::simpson;
use crate::support::{ANDREWS, GEAR, Run, TWO_DRIVES, assert_says, changed, without_stops};
use proptest::prelude::*;
use serde_json::{Value, json};

/// Tight tolerance of these runs.
const TIGHT: f64 = 1e-12;

/// mu(v) according to [HF08] section 4.
pub fn coefficient([low, high]: [f64; 2], [first, last]: [f64; 2], v: f64) -> f64 {
    if v <= first {
        low * v / first
    } else if v >= last {
        high
    } else {
        let s = (v - first) / (last - first);
        low + (high - low) * (3.0 * s * s - 2.0 * s * s * s)
    }
}

const MU: [f64; 2] = [0.3, 0.2];
const SPEEDS: [f64; 2] = [0.05, 0.5];

/// A block on a slide of the ground with this upward slope.
fn on_slope(slope: f64) -> Run {
    Run::new(block(2.5).with(json!({
        "gravity": weight(), "joints": { "slide": { "axis_angle": slope } },
        "actuators": { "pull": { "joint": "slide" } }, "friction": friction(MU, SPEEDS),
        "solver": { "tolerance": TIGHT },
    })))
}

/// Above V_d the deceleration is mu_d g cos minus the part of gravity along the slope. Below V_S the speed decays
/// exponentially.
#[test]
fn a_block_slides_as_the_closed_forms() {
    for (slope, speed) in [(0.0, 4.0), (0.0, -4.0), (0.15, 4.0), (0.15, -4.0), (-0.15, 4.0)] {
        let mut run = on_slope(slope).with(&[("slide.start_speed", speed)]).started();
        let sign = speed.signum();
        let a = -G * slope.sin() - sign * MU[1] * G * slope.cos();
        assert!((run.get("slide.acceleration") - a).abs() < 1e-12 * a.abs());
        let (normal, friction) = (2.5 * G * slope.cos(), run.get("slide.friction_force"));
        assert!((friction + sign * MU[1] * normal).abs() < 1e-12 * normal, "{friction}");
        // The reaction excludes the friction: it is normal to the slide.
        let along = run.get("slide.force_x") * slope.cos() + run.get("slide.force_y") * slope.sin();
        assert!(along.abs() < 1e-12 * normal && (run.get("slide.force") - normal).abs() < 1e-12 * normal);
        let t = 0.5;
        run.step(t);
        let (v, s) = (speed + a * t, speed * t + 0.5 * a * t * t);
        // Constant acceleration: any method of order 2 is exact.
        assert!((run.get("slide.speed") - v).abs() < 1e-13 * speed.abs(), "{} {v}", run.get("slide.speed"));
        assert!((run.get("slide.position") - s).abs() < 1e-13 * s.abs(), "{} {s}", run.get("slide.position"));
    }
    let (speed, rate) = (0.04, MU[0] * G / SPEEDS[0]);
    let mut run = on_slope(0.0).with(&[("slide.start_speed", speed)]).started();
    for i in 1..=10 {
        run.step(0.01);
        let v = speed * (-rate * 0.01 * f64::from(i)).exp();
        assert!((run.get("slide.speed") - v).abs() < 100.0 * TIGHT * speed, "{} {v}", run.get("slide.speed"));
    }
}

/// Deceleration from above V_d to V_S: the time is the integral of dv / (mu(v) g), by Simpson's rule. Steps end at the
/// borders of the law.
#[test]
fn a_block_passes_through_the_whole_law() {
    let from = 1.5;
    let within = simpson(|v| (G * coefficient(MU, SPEEDS, v)).recip(), SPEEDS[0], SPEEDS[1], 20_000);
    let t = (from - SPEEDS[1]) / (G * MU[1]) + within;
    for parts in [1, 7, 1000] {
        let mut run = on_slope(0.0).with(&[("slide.start_speed", from)]).started();
        run.steps(parts, t);
        let v = run.get("slide.speed");
        // 100 x tolerance, relative to the initial speed.
        assert!((v - SPEEDS[0]).abs() < 100.0 * TIGHT * from, "{v} {parts}");
    }
}

/// On a slope: m g sin is the holding force, the breakaway forces differ from it by mu_S m g cos.
#[test]
fn a_block_breaks_away_as_the_closed_form() {
    for slope in [-0.4, 0.0, 0.2] {
        let mut run = on_slope(slope).started();
        let (weight, friction) = (2.5 * G * slope.sin(), MU[0] * 2.5 * G * slope.cos());
        for (name, expected) in [
            ("pull.holding_force", weight),
            ("pull.breakaway_force_forward", weight + friction),
            ("pull.breakaway_force_backward", weight - friction),
        ] {
            assert!((run.get(name) - expected).abs() < 1e-12 * friction, "{name} {} {expected}", run.get(name));
        }
    }
}

fn set_coefficients(joint: &mut Value, [low, high]: [f64; 2]) {
    joint["static_coefficient"] = json!(low);
    joint["kinetic_coefficient"] = json!(high);
}

/// A slider-crank with friction in all joints, each with different coefficients.
fn slider_crank() -> Run {
    Run::shared(&changed(TWO_DRIVES, |m| {
        m["gravity"]["up_angle"] = json!(1.2);
        for (joint, radius, mu) in [("bearing", 0.01, BEARING), ("pin", 0.02, PIN), ("wrist", 0.008, WRIST)] {
            m["joints"][joint]["pin_radius"] = json!(radius);
            set_coefficients(&mut m["joints"][joint], mu);
        }
        m["actuators"] = json!({});
        m["torques"] = json!({ "motor": { "on": "crank", "torque": 2.0 } });
        m["forces"] = json!({ "load": { "at": "slider.origin", "force": [-5.0, 3.0] } });
        m["friction"] = json!({ "enabled": true, "static_coefficient": COMMON[0], "kinetic_coefficient": COMMON[1] });
        m["start"]["angle"] = json!(0.5);
        m["guess"] = json!({ "crank": 0.5, "rod": -0.16, "guide": 0.38 });
    }))
}

const BEARING: [f64; 2] = [0.3, 0.1];
const PIN: [f64; 2] = [0.15, 0.2];
const WRIST: [f64; 2] = [0.05, 0.01];
/// Coefficients of the key `friction`, which apply to the guide.
const COMMON: [f64; 2] = [0.19, 0.026];
const SLOW_FAST: [f64; 2] = [0.01, 1.0];

/// The gear without stops. Its second joint has separate coefficients. `relative`: whether the velocities of leg and
/// wheel count in the wind.
fn gear(relative: bool) -> Run {
    gear_with(relative, |_| ())
}

/// The same gear with a change of its definition.
fn gear_with(relative: bool, change: impl FnOnce(&mut Value)) -> Run {
    Run::shared(&changed(without_stops(), |m| {
        set_coefficients(&mut m["joints"]["joint2"], BEARING);
        m["friction"]["enabled"] = json!(true);
        m["air"]["relative_wind"] = json!(relative);
        change(m);
    }))
}

/// Joints of Andrews' squeezer between the bodies K1 to K7; 0 is the ground.
const SQUEEZER: [(&str, usize, usize); 10] = [
    ("O", 0, 1),
    ("P", 1, 2),
    ("B", 0, 3),
    ("A5", 0, 5),
    ("A7", 0, 7),
    ("G", 5, 4),
    ("H", 7, 6),
    ("E3", 2, 3),
    ("E4", 2, 4),
    ("E6", 2, 6),
];
const PIN_RADIUS: f64 = 1e-4;

/// Andrews' squeezer with pins in those joints whose bit is set in `which`.
fn squeezer(which: u32) -> Run {
    Run::new(changed(ANDREWS, |m| {
        for (k, (joint, ..)) in SQUEEZER.iter().enumerate() {
            if which & (1 << k) != 0 {
                m["joints"][joint]["pin_radius"] = json!(PIN_RADIUS);
            }
        }
        m["friction"] = friction(COMMON, SLOW_FAST);
    }))
}

/// Compare the friction of the model with friction recomputed from `slip` [m/s] with its rounding, `arm` [m or 1], the
/// size of the reaction and the largest reaction of all joints [N]. Friction and reaction come from two tables, each
/// with an error in proportion to its largest value.
fn same(
    reported: f64,
    mu: [f64; 2],
    slip: f64,
    rounding: f64,
    arm: f64,
    [size, largest]: [f64; 2],
) -> Result<(), TestCaseError> {
    let expected = -coefficient(mu, SLOW_FAST, slip.abs()) * slip.signum() * arm * size;
    // 1e-12 of the largest friction of this reaction, and the effect of the rounding of the slip at the steepest slope.
    let allowed = mu[0].max(mu[1]) * arm * (size * (1e-12 + rounding / SLOW_FAST[0]) + 1e-13 * largest);
    let error = (reported - expected).abs();
    prop_assert!(error <= allowed, "{reported} {expected} {:e}", error / allowed);
    Ok(())
}

/// Error of a table of speeds: 1e-13 of the largest rate.
const SPEED: f64 = 1e-13;

fn speeds() -> impl Strategy<Value = f64> {
    (prop_oneof![Just(-1.0), Just(1.0)], -4.0..1.7f64).prop_map(|(sign, power)| sign * 10_f64.powf(power))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn friction_of_the_gear_is_that_of_its_reactions(
        angle in -1.3..1.3f64, speed in speeds(), force in -4e4..4e4f64, factor in -5.0..5.0f64,
            airspeed in -80.0..80.0f64,
    ) {
        let mut run = gear(false)
            .with(&[("crank.start_angle", angle), ("crank.start_speed", speed), ("actuator.force", force)])
            .with(&[("load_factor", factor), ("airspeed", airspeed)])
            .started();
        let [w2, w3, w4] = ["crank.speed", "coupler.speed", "follower.speed"].map(|n| run.get(n));
        let largest = (1..5).map(|joint| run.get(&format!("joint{joint}.force"))).fold(0.0, f64::max);
        for (joint, first, second, radius, mu) in [
            (1, 0.0, w2, 0.0175, COMMON),
            (2, w2, w3, 0.015, BEARING),
            (3, w3, w4, 0.015, COMMON),
            (4, 0.0, w4, 0.015, COMMON),
        ] {
            let reported = run.get(&format!("joint{joint}.friction_torque"));
            let size = run.get(&format!("joint{joint}.force"));
            let rounding = SPEED * radius * (w2.abs() + w3.abs() + w4.abs());
            same(reported, mu, radius * (second - first), rounding, radius, [size, largest])?;
        }
    }

    #[test]
    fn friction_of_the_slider_crank_is_that_of_its_reactions(
        angle in -3.0..3.0f64, speed in speeds(), torque in -20.0..20.0f64, load in [-50.0..50.0f64, -50.0..50.0f64],
    ) {
        let mut run = slider_crank()
            .with(&[("crank.start_angle", angle), ("crank.start_speed", speed), ("motor.torque", torque)])
            .with(&[("load.force_x", load[0]), ("load.force_y", load[1])])
            .started();
        let (w1, w2, v) = (run.get("crank.speed"), run.get("rod.speed"), run.get("guide.speed"));
        let largest = ["bearing", "pin",
            "wrist"].map(|joint| run.get(&format!("{joint}.force"))).into_iter().fold(0.0, f64::max);
        for (joint, slip, radius, mu) in
            [("bearing", w1, 0.01, BEARING), ("pin", w2 - w1, 0.02, PIN), ("wrist", -w2, 0.008, WRIST)]
        {
            let (reported, size) = (run.get(&format!("{joint}.friction_torque")), run.get(&format!("{joint}.force")));
            same(reported, mu, radius * slip, SPEED * radius * (w1.abs() + w2.abs()), radius, [size, largest])?;
        }
        let (reported, normal) = (run.get("guide.friction_force"), run.get("guide.force_y").abs());
        same(reported, COMMON, v, SPEED * 0.1 * w1.abs(), 1.0, [normal, largest])?;
        // Newton's law of the slider along the guide, with the rod's force at the wrist and the friction in the guide.
        let needed = 0.5 * (run.get("guide.acceleration") + G * 1.2_f64.cos());
        let given = run.get("wrist.force_x") + load[0] + reported;
        let largest = run.get("wrist.force").max(normal) + load[0].abs();
        prop_assert!((needed - given).abs() < 1e-10 * largest, "{needed} {given}");
    }

    /// Inverse dynamics, then forward dynamics: the required force gives the demanded acceleration.
    #[test]
    fn the_required_force_gives_what_was_demanded(
        angle in -1.3..0.8f64, speed in speeds(), demand in -300.0..300.0f64, airspeed in -80.0..80.0f64,
        force in -4e4..4e4f64, relative in any::<bool>(),
    ) {
        let mut run = gear(relative)
            .with(&[("crank.start_angle", angle), ("crank.start_speed", speed), ("airspeed", airspeed)])
            .with(&[("actuator.demanded_acceleration", demand), ("actuator.force", force)])
            .started();
        let (required, mass) = (run.get("actuator.required_force"), run.get("actuator.reduced_mass"));
        run.set("actuator.force", required);
        let given = run.get("actuator.acceleration");
        let size = demand.abs().max(required.abs() / mass).max(run.get("actuator.additional_force").abs() / mass);
        prop_assert!((given - demand).abs() < 1e-10 * size, "{given} {demand} {size}");
    }

    /// The breakaway force forward is at least the holding force, the one backward at most.
    #[test]
    fn breakaway_brackets_holding(
        angle in -1.3..0.8f64, factor in -5.0..5.0f64, airspeed in -80.0..80.0f64, load in -3e3..3e3f64,
    ) {
        let state =
            [("crank.start_angle", angle), ("load_factor", factor), ("airspeed", airspeed), ("wheel.force_x", load)];
        let mut run = gear(false).with(&state).started();
        let holding = run.get("actuator.holding_force");
        let (forward, backward) =
            (run.get("actuator.breakaway_force_forward"), run.get("actuator.breakaway_force_backward"));
        // The present force of the drive, 30 kN, is subtracted from the loads before the holding force is computed.
        let rounding = 1e-14 * run.get("actuator.force").abs();
        prop_assert!(backward < holding + rounding && holding < forward + rounding, "{backward} {holding} {forward}");
        let without_static = |m: &mut Value| {
            m["friction"]["static_coefficient"] = json!(0);
            m["joints"]["joint2"]["static_coefficient"] = json!(0);
        };
        let mut smooth = gear_with(false, without_static).with(&state).started();
        for name in ["actuator.breakaway_force_forward", "actuator.breakaway_force_backward"] {
            let slack = 1e-12 * (holding.abs() + forward.abs() + backward.abs()) + rounding;
            prop_assert!((smooth.get(name) - holding).abs() <= slack, "{} {holding}", smooth.get(name));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 80, failure_persistence: None, ..ProptestConfig::default() })]

    /// Three loops with one to ten pins. Some pins form pairs that transmit one force.
    #[test]
    fn friction_of_andrews_squeezer_is_that_of_its_reactions(
        angle in -0.5..0.5f64, speed in speeds(), torque in -0.1..0.1f64, which in 1u32..1024,
    ) {
        let mut run = squeezer(which).with(&[("drive.torque", torque)]);
        run.set_all(&[("K1.start_angle", -0.06 + 0.3 * angle), ("K1.start_speed", 20.0 * speed)]);
        let mut run = run.started();
        let speeds: Vec<f64> = std::iter::once(0.0).chain((1..8).map(|k| run.get(&format!("K{k}.speed")))).collect();
        let fastest = speeds.iter().fold(0.0, |a: f64, w| a.max(w.abs()));
        let sizes: Vec<f64> = SQUEEZER.iter().map(|(joint, ..)| run.get(&format!("{joint}.force"))).collect();
        let largest = sizes.iter().copied().fold(0.0, f64::max);
        for (k, (joint, first, second)) in SQUEEZER.into_iter().enumerate() {
            if which & (1 << k) == 0 {
                continue;
            }
            let reported = run.get(&format!("{joint}.friction_torque"));
            let rounding = 10.0 * SPEED * PIN_RADIUS * fastest;
            let slip = PIN_RADIUS * (speeds[second] - speeds[first]);
            same(reported, COMMON, slip, rounding, PIN_RADIUS, [sizes[k], largest])?;
        }
    }
}

/// Friction, drag in relative wind, a bumper and dampers together: `energy.drift` stays below 1e-9 of the work at the
/// tolerance 1e-12, in one step and in many, before and after contact with the bumper.
#[test]
fn all_losses_together_are_booked() {
    let text = changed(GEAR, |m| {
        m["springs"] = json!({
            "damper": { "first": "crank.actuator", "second": "follower.actuator", "damping": 300.0 },
            "turning": { "joint": "joint4", "stiffness": 50.0, "damping": 2.0 }
        });
    });
    for parts in [1, 300] {
        let mut run = Run::new(&text)
            .with(&[("friction.enabled", true), ("air.relative_wind", true), ("upstop.rigid", false)])
            .with(&[("airspeed", 70.0), ("upstop.angle", -1.2), ("upstop.stiffness", 1e6), ("upstop.damping", 5e3)])
            .with(&[("solver.tolerance", TIGHT)])
            .started();
        let (length, mut pressed) = (run.get("actuator.length"), false);
        for _ in 0..parts {
            run.step(0.3 / f64::from(parts));
            pressed |= run.get("upstop.torque") > 0.0;
            let work = 30_000.0 * (run.get("actuator.length") - length).abs();
            let drift = run.get("energy.drift");
            assert!(drift.abs() < 1e-9 * work.max(1000.0), "drift {drift:e} of {work}");
        }
        assert!(pressed);
    }
}

/// Pins so large that friction locks the mechanism: an error with a message. The state stays unchanged.
#[test]
fn self_locking_is_rejected() {
    let radii = ["joint1", "joint2", "joint3", "joint4"].map(|j| format!("{j}.pin_radius"));
    let radii: Vec<(&str, f64)> = radii.iter().map(|n| (n.as_str(), 1.5)).collect();
    let more = [("friction.kinetic_coefficient", 0.19), ("crank.start_speed", -10.0)];
    let mut run = gear(false).with(&radii).with(&more).started();
    let before = (run.get("crank.angle"), run.get("crank.speed"));
    let says = ["friction locks the mechanism near", "crank = 0.8"];
    let refused = run.0.step(0.1).unwrap_err().to_string();
    assert_says(&refused, &[says[0], says[1], "pin radii", "reduce the coefficients or pin radii"]);
    assert!(run.0.get("crank.acceleration").unwrap().is_nan());
    assert_says(run.0.undefined("crank.acceleration").unwrap().unwrap(), &says);
    assert_eq!((run.get("crank.angle"), run.get("crank.speed")), before);
    // From rest a solution exists, below V_S at every pin: the mechanism creeps.
    let mut run = run.with(&[("crank.start_speed", 0.0)]).started();
    run.step(0.1);
    assert!(1.5 * run.get("crank.speed").abs() < SLOW_FAST[0], "{}", run.get("crank.speed"));
}
