//! Model exchange under a prescribed motion: outputs agree with co-simulation at any time, kinks are time events, and
//! the force has values on both sides of a jump. Also motion by inputs, switching the drive off and on, saved states,
//! rejected calls.
use crate::Fmu;
use crate::definition::{With, rod, slider_crank};
use crate::exchange::{rates, states};
use crate::fmi2::Folder;
use linkage_fmu::fmi2::types::Status as Status2;
use linkage_fmu::fmi3::host::Wishes;
use linkage_fmu::fmi3::types::Status::{Discard, Error, Ok, Warning};
use serde_json::{Value, json};
use std::f64::consts::PI;

const SMOOTH: &str = include_str!("../../modelDescription/SmoothRetraction/resources/mechanism.json");
const MASS: f64 = 2.0;
const G: f64 = 9.806_65;

/// A mass that a winch lifts from 0.5 m, between a floor at 0 m and a top at 2 m.
fn lift(motion: &Value) -> String {
    let mut lift: Value = serde_json::from_str(include_str!("../fixtures/falling_block.json")).unwrap();
    let slide = lift["joints"].as_object().unwrap().keys().next().unwrap().clone();
    lift["actuators"] = json!({ "winch": { "joint": slide, "motion": motion } });
    lift["stops"]["top"] = json!({ "joint": slide, "limit": "upper", "position": 2 });
    lift.to_string()
}

/// From 0.1 s on over 1 m in 0.5 s: 8 m/s2 for 1/4 s, then -8 m/s2. The kink in the middle is at the speed of 2 m/s.
fn trapezoid() -> String {
    lift(&json!({ "profile": "trapezoid", "distance": 1, "speed": 4, "acceleration": 16, "start_time": 0.1 }))
}

/// An instance in continuous-time mode that starts at a time [s], and the time of its first event.
fn started(definition: &str, start: f64) -> (Fmu, Option<f64>) {
    let fmu = Fmu::exchanging(definition);
    assert_eq!((fmu.enter(Some(1e-9), start, None), fmu.exit()), (Ok, Ok));
    let next = event(&fmu);
    (fmu, next)
}

/// From event mode to continuous-time mode. Returns the time of the next event.
fn event(fmu: &Fmu) -> Option<f64> {
    let (status, _, next) = fmu.update();
    assert_eq!((status, fmu.enter_continuous_time_mode()), (Ok, Ok));
    next
}

/// A completed step of Heun's method.
fn step(fmu: &Fmu, t: f64, h: f64) {
    let (y, begin) = (states(fmu), rates(fmu, states(fmu)));
    assert_eq!(fmu.set_time(t + h), Ok);
    let end = rates(fmu, [0, 1].map(|k| y[k] + h * begin[k]));
    let mean = [0, 1].map(|k| y[k] + 0.5 * h * (begin[k] + end[k]));
    assert_eq!((fmu.set_states(&mean), fmu.complete_step()), (Ok, (Ok, false)));
}

#[test]
fn a_smooth_retraction_is_that_of_co_simulation_at_any_time() {
    let names = ["crank.angle", "crank.speed", "actuator.acting_force", "joint2.force", "wheel.acceleration_x"];
    let start = -3.0;
    let (fmu, next) = started(SMOOTH, start);
    let other = Fmu::of(SMOOTH, Wishes::default());
    assert_eq!((other.enter(Some(1e-9), 0.0, None), other.exit()), (Ok, Ok));
    assert_eq!(next, Some(start + 1.0));
    let (mut t, mut largest) = (0.0, [0.0_f64; 5]);
    for k in 1..=110 {
        other.whole_step(t, 0.01);
        t += 0.01;
        // Trial states and the order of times do not matter.
        let back = start + t - 0.004 * f64::from(k % 3);
        assert_eq!((fmu.set_time(back), fmu.set_states(&[7.0, -1e9])), (Ok, Ok));
        fmu.get(names);
        assert_eq!((fmu.set_time(start + t), fmu.complete_step()), (Ok, (Ok, false)));
        if k == 100 {
            assert_eq!((fmu.set_time(start + 1.0), fmu.enter_event_mode()), (Ok, Ok));
            assert_eq!(event(&fmu), None);
        }
        for ((one, two), largest) in fmu.get(names).into_iter().zip(other.get(names)).zip(&mut largest) {
            *largest = largest.max(two.abs());
            assert!((one - two).abs() < 1e-11 * *largest, "{k}: {one} {two}");
        }
    }
}

/// m (g + a) before the kink, m (g - a) after it. The host's integration agrees in position and speed at all kinks.
#[test]
fn kinks_are_events_with_both_sides_of_the_force() {
    let start = 5.0;
    let (fmu, mut next) = started(&trapezoid(), start);
    let (mut t, mut met) = (start, Vec::new());
    let force = |fmu: &Fmu| fmu.get(["winch.acting_force"])[0] / MASS - G;
    while let Some(at) = next {
        let (h, begin) = ((at - t) / 8.0, t);
        (0..8).for_each(|k| step(&fmu, begin + f64::from(k) * h, h));
        assert_eq!(fmu.set_time(at), Ok);
        let (before, reached) = (force(&fmu), states(&fmu));
        assert_eq!((fmu.complete_step(), fmu.enter_event_mode()), ((Ok, false), Ok));
        (next, t) = (event(&fmu), at);
        let exact = states(&fmu);
        assert!((0..2).all(|k| (reached[k] - exact[k]).abs() < 1e-9), "{reached:?} {exact:?}");
        met.push((at - start, before, force(&fmu), fmu.get(["winch.position", "winch.speed"])));
    }
    let expected = [(0.1, 0.0, 16.0, [0.5, 0.0]), (0.35, 16.0, -16.0, [1.0, 4.0]), (0.6, -16.0, 0.0, [1.5, 0.0])];
    assert_eq!(met.len(), expected.len(), "{met:?}");
    for (met, expected) in met.iter().zip(&expected) {
        let close = |one: f64, two: f64| (one - two).abs() < 1e-9;
        assert!(close(met.0, expected.0) && close(met.1, expected.1) && close(met.2, expected.2), "{met:?}");
        assert!(close(met.3[0], expected.3[0]) && close(met.3[1], expected.3[1]), "{met:?}");
    }
}

/// s = 0.5 + 0.2 sin 3 t: at each instant the inputs determine the motion, and the force is m (g + s_ddot). The
/// derivatives agree with this law. When the drive is switched off, the mass falls. The drive can be switched on only
/// at the position of the mass.
#[test]
fn a_motion_by_inputs_lets_go_and_grips() {
    let (fmu, next) = started(&lift(&json!({ "position": 0.5 })), 0.0);
    assert_eq!(next, None);
    let inputs = fmu.vrs(["winch.motion.position", "winch.motion.speed", "winch.motion.acceleration"]);
    let [force, x, v, a] =
        fmu.vrs(["winch.acting_force", "along_curve.position", "along_curve.speed", "along_curve.acceleration"]);
    let motion = |t: f64| {
        let (sin, cos) = (3.0 * t).sin_cos();
        [0.5 + 0.2 * sin, 0.6 * cos, -1.8 * sin]
    };
    let slope = |known, unknown| {
        let mut slope = [f64::NAN];
        assert_eq!(fmu.derivative(false, &[unknown], &[known], &[1.0], &mut slope), Ok);
        slope[0]
    };
    let release = 0.4;
    for k in 1..=40 {
        let t = release * f64::from(k) / 40.0;
        assert_eq!((fmu.set_time(t), fmu.set_reals(&inputs, &motion(t))), (Ok, Ok));
        let [position, speed, acceleration] = motion(t);
        let [one, two, three] = fmu.get(["winch.position", "winch.speed", "winch.acting_force"]);
        assert!((one - position).abs() < 1e-12 && (two - speed).abs() < 1e-12);
        assert!((three - MASS * (G + acceleration)).abs() < 1e-11);
        // In the kinetic metric sigma_ddot^2 = m s_ddot^2.
        assert!((rates(&fmu, states(&fmu))[1] - MASS.sqrt() * acceleration).abs() < 1e-11);
        assert!((slope(inputs[2], force) - MASS).abs() < 1e-11 && slope(inputs[0], force).abs() < 1e-11);
        assert!((slope(inputs[2], a) - MASS.sqrt()).abs() < 1e-12);
        assert_eq!(
            [slope(v, v), slope(x, v), slope(inputs[1], v), slope(x, force), slope(v, a)],
            [1.0, 0.0, 0.0, 0.0, 0.0]
        );
        assert_eq!(fmu.complete_step(), (Ok, false));
    }
    let enabled = fmu.vr("winch.motion.enabled");
    assert_eq!((fmu.set_boolean(enabled, 0), fmu.enter_event_mode()), (Error, Ok));
    assert_eq!(fmu.set_boolean(enabled, 0), Ok);
    assert_eq!(event(&fmu), None);
    let [s, v0, _] = motion(release);
    assert_eq!(
        fmu.get(["winch.position", "winch.speed"]).map(|value| (value * 1e12).round()),
        [s, v0].map(|value| (value * 1e12).round())
    );
    (0..10).for_each(|k| step(&fmu, release + 0.01 * f64::from(k), 0.01));
    let fallen = s + 0.1 * v0 - 0.005 * G;
    assert!((fmu.get(["winch.position"])[0] - fallen).abs() < 1e-12);
    assert_eq!(fmu.enter_event_mode(), Ok);
    assert_eq!(fmu.set_boolean(enabled, 1), Ok);
    // At another position the call returns an error until the inputs state the position of the drive.
    assert_eq!(fmu.update().0, Error);
    let here = states(&fmu);
    assert_eq!(fmu.set_reals(&inputs, &[fallen, 0.25, 0.0]), Ok);
    assert_eq!(event(&fmu), None);
    assert!((states(&fmu)[0] - here[0]).abs() < 1e-12 && (states(&fmu)[1] - 0.25 * MASS.sqrt()).abs() < 1e-12);
}

/// A position that the motion cannot reach gives a discarded call, and an earlier time has values again. A bumper acts
/// on contact.
#[test]
fn a_step_to_an_unreachable_position_is_discarded() {
    let far = lift(&json!({ "profile": "cycloidal", "distance": 3, "duration": 1 }));
    let (fmu, _) = started(&far, 0.0);
    let (mut f, mut value) = ([0.0; 2], [0.0]);
    let length = [fmu.vr("winch.position")];
    for (t, reached) in [(0.3, true), (0.9, false), (1e300, false), (0.4, true), (-1e300, true)] {
        assert_eq!(fmu.set_time(t), Ok);
        let expected = if reached { [Ok, Ok] } else { [Discard, Warning] };
        assert_eq!([fmu.rates(&mut f), fmu.reals(&length, &mut value)], expected, "{t}");
        assert_eq!(value[0].is_finite(), reached);
        assert_ne!(fmu.complete_step().0, linkage_fmu::fmi3::types::Status::Fatal);
    }
    assert_eq!((fmu.set_time(f64::NAN), fmu.set_states(&[f64::NAN, 0.0])), (Error, Discard));
    assert_eq!((fmu.set_states(&[1e300, -4.0]), states(&fmu)), (Ok, [1e300, -4.0]));
    let soft = trapezoid().replace("\"position\":2", "\"position\":0.8,\"rigid\":false,\"stiffness\":1e3");
    let (fmu, _) = started(&soft, 0.0);
    for (t, beyond) in [(0.2, 0.0), (0.35, 0.2), (0.5, 0.7 - 8.0 * 0.01), (0.21, 0.0)] {
        assert_eq!(fmu.set_time(t), Ok);
        let push = fmu.get(["top.force"])[0].abs();
        assert!((push - 1e3 * beyond).abs() < 1e-8, "{t}: {push} {beyond}");
    }
}

#[test]
fn a_saved_state_continues_bit_identically_and_both_versions_agree() {
    let names = ["winch.position", "winch.acting_force"];
    let (fmu, next) = started(&trapezoid(), 0.0);
    assert_eq!((fmu.set_time(0.1), fmu.complete_step(), fmu.enter_event_mode()), (Ok, (Ok, false), Ok));
    assert_eq!(next, Some(0.1));
    let after = event(&fmu);
    assert_eq!((fmu.set_time(0.2), fmu.complete_step()), (Ok, (Ok, false)));
    let mut saved = fmu.save();
    let bytes = fmu.serialize(&saved).unwrap();
    let (fresh, _) = started(&trapezoid(), 0.0);
    let mut read = fresh.deserialize(&bytes).unwrap();
    assert_eq!((fresh.restore(&read), fresh.get(names)), (Ok, fmu.get(names)));
    let folder = Folder::new("prescribed");
    let other = folder.described(&trapezoid()).exchange(None, false).unwrap();
    assert_eq!((other.set_up(Some(1e-9), 0.0, None), other.initialize()), (Status2::Ok, Status2::Ok));
    assert_eq!(other.update(), (Status2::Ok, false, Some(0.1)));
    assert_eq!(other.enter_continuous_time_mode(), Status2::Ok);
    assert_eq!((other.set_time(0.1), other.complete_step()), (Status2::Ok, (Status2::Ok, false)));
    assert_eq!((other.enter_event_mode(), other.update().2), (Status2::Ok, after));
    assert_eq!((other.enter_continuous_time_mode(), other.set_time(0.2)), (Status2::Ok, Status2::Ok));
    assert_eq!(other.complete_step(), (Status2::Ok, false));
    for t in [0.23, 0.34] {
        let mut values = [f64::NAN; 2];
        assert_eq!((fmu.set_time(t), fresh.set_time(t), other.set_time(t)), (Ok, Ok, Status2::Ok));
        assert_eq!(other.reals(&fmu.vrs(names), &mut values), Status2::Ok);
        assert_eq!(fmu.get(names), fresh.get(names));
        assert_eq!(fmu.get(names), values);
        let y = states(&fmu);
        assert_eq!(rates(&fmu, y), rates(&fresh, y));
    }
    assert_eq!((fmu.free(&mut saved), fresh.free(&mut read)), (Ok, Ok));
    // A closed curve: more than one turn of a crank, whose position counts whole turns.
    let turns = json!({ "profile": "cycloidal", "distance": 5.0 * PI, "duration": 2 });
    let (crank, _) = started(&crank(&turns), 0.0);
    assert_eq!(crank.set_time(2.0 - 1e-9), Ok);
    assert!((crank.get(["motor.angle"])[0] - 0.3 - 5.0 * PI).abs() < 1e-9);
    assert_eq!((crank.complete_step(), crank.set_time(0.0)), ((Ok, false), Ok));
    assert!((crank.get(["motor.angle"])[0] - 0.3).abs() < 1e-12);
}

/// A slider-crank with a driven crank.
fn crank(motion: &Value) -> String {
    slider_crank([rod(0.1, 1.5), json!({ "length": 0.35 }), json!({ "mass": 3 })], 0.3)
        .with(json!({ "actuators": { "motor": { "joint": "bearing", "motion": motion } } }))
        .to_string()
}
