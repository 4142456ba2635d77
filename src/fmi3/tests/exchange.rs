//! Model exchange: the derivatives against co-simulation, events at stops, derivatives of derivatives, phases,
//! refusals.
use super::*;
use crate::fmi::exchange::served;
use crate::fmi2::types::EventInfo;
use crate::fmi2::{
    fmi2CompletedIntegratorStep, fmi2DoStep, fmi2EnterContinuousTimeMode, fmi2GetDerivatives, fmi2GetEventIndicators,
    fmi2NewDiscreteStates, fmi2SetContinuousStates, fmi2SetTime,
};
use crate::simulation::Simulation;

const CURVES: &str = include_str!("../../../tests/fixtures/curves.json");

/// Time [s] at which the retraction of PHYSICS.md reaches the up stop.
const RETRACTED: f64 = 0.132_059_852_744_259_7;

/// A block of 2 kg that falls 0.5 m onto a floor with a restitution of 0.5, from rest.
const FALLING: &str = r#"{ "name": "Falling",
    "gravity": { "acceleration": 9.80665, "up_angle": 1.5707963267948966 },
    "bodies": { "ground": {}, "block": { "mass": 2, "inertia": 0.1 } },
    "joints": {
        "line": {
            "type": "prismatic", "first": "ground.origin", "second": "block.origin", "axis_angle": 1.5707963267948966
        }
    },
    "stops": { "floor": { "joint": "line", "limit": "lower", "position": 0, "restitution": 0.5 } },
    "start": { "joint": "line", "position": 0.5 }, "guess": { "line": 0.5 } }"#;

fn exchanging(definition: &'static str) -> Instance {
    let load = || served(Component::from_definition("mechanism.json", definition)?.into());
    handle::instantiate(VERSION, "instantiate", c"me", Logger::new(None, false), Usage::MODEL_EXCHANGE, load)
}

/// An instance in continuous-time mode, after the first event.
fn started(definition: &'static str) -> Instance {
    let c = exchanging(definition);
    assert!(!c.is_null());
    // SAFETY: the instance is valid.
    unsafe {
        assert_eq!(fmi3EnterInitializationMode(c, 1, 1e-9, 0.0, 0, 0.0), Status::Ok);
        assert_eq!(fmi3ExitInitializationMode(c), Status::Ok);
        update(c);
        assert_eq!(fmi3EnterContinuousTimeMode(c), Status::Ok);
    }
    c
}

/// Discrete states, in event mode; whether the states have changed.
fn update(c: Instance) -> bool {
    let (mut flags, mut next) = ([7; 5], 0.0);
    let [a, b, c1, d, e] = &mut flags;
    // SAFETY: the instance is valid, each pointer leads to one value.
    assert_eq!(unsafe { fmi3UpdateDiscreteStates(c, a, b, c1, d, e, &mut next) }, Status::Ok);
    assert_eq!([flags[0], flags[1], flags[2], flags[4]], [0; 4]);
    flags[3] == 1
}

fn set(c: Instance, y: [f64; 2]) -> Status {
    // SAFETY: the instance is valid, the array has two elements.
    unsafe { fmi3SetContinuousStates(c, y.as_ptr(), 2) }
}

fn states(c: Instance) -> [f64; 2] {
    let mut y = [f64::NAN; 2];
    // SAFETY: the instance is valid, the array has two elements.
    assert_eq!(unsafe { fmi3GetContinuousStates(c, y.as_mut_ptr(), 2) }, Status::Ok);
    y
}

fn rates(c: Instance, y: [f64; 2]) -> [f64; 2] {
    assert_eq!(set(c, y), Status::Ok);
    let mut f = [f64::NAN; 2];
    // SAFETY: the instance is valid, the array has two elements.
    assert_eq!(unsafe { fmi3GetContinuousStateDerivatives(c, f.as_mut_ptr(), 2) }, Status::Ok);
    f
}

fn indicators(c: Instance) -> Vec<f64> {
    let mut count = 0;
    // SAFETY: the instance is valid, the array has as many elements as are told.
    unsafe {
        assert_eq!(fmi3GetNumberOfEventIndicators(c, &mut count), Status::Ok);
        let mut z = vec![f64::NAN; count];
        assert_eq!(fmi3GetEventIndicators(c, z.as_mut_ptr(), count), Status::Ok);
        z
    }
}

/// One step of the classical method of Runge and Kutta.
fn rk4(c: Instance, y: [f64; 2], h: f64) -> [f64; 2] {
    let add = |k: [f64; 2], part: f64| [y[0] + part * h * k[0], y[1] + part * h * k[1]];
    let k1 = rates(c, y);
    let k2 = rates(c, add(k1, 0.5));
    let k3 = rates(c, add(k2, 0.5));
    let k4 = rates(c, add(k3, 1.0));
    std::array::from_fn(|n| y[n] + h / 6.0 * (k1[n] + 2.0 * k2[n] + 2.0 * k3[n] + k4[n]))
}

/// Integrate with events located by bisection of the step; times of the events.
fn integrate(c: Instance, span: f64, h: f64) -> Vec<f64> {
    let (mut t, mut events) = (0.0, Vec::new());
    while t < span {
        let (y, before) = (states(c), indicators(c));
        let size = h.min(span - t);
        let mut crosses = |part: f64| {
            let end = rk4(c, y, part * size);
            assert_eq!(set(c, end), Status::Ok);
            indicators(c).iter().zip(&before).any(|(a, b)| a * b < 0.0)
        };
        let part = if crosses(1.0) { crate::numerics::bracket::bisect(&mut crosses, 0.0, 1.0)[1] } else { 1.0 };
        let end = rk4(c, y, part * size);
        t += part * size;
        assert_eq!(set(c, end), Status::Ok);
        let (mut enter, mut terminate) = (7, 7);
        // SAFETY: the instance is valid, each pointer leads to one value.
        unsafe {
            assert_eq!(fmi3SetTime(c, t), Status::Ok);
            assert_eq!(fmi3CompletedIntegratorStep(c, 1, &mut enter, &mut terminate), Status::Ok);
            assert_eq!(terminate, 0);
            if part < 1.0 || enter == 1 {
                events.push(t);
                assert_eq!(fmi3EnterEventMode(c), Status::Ok);
                update(c);
                assert_eq!(fmi3EnterContinuousTimeMode(c), Status::Ok);
            }
        }
        assert!(events.len() < 200);
    }
    events
}

#[test]
fn a_retraction_is_that_of_co_simulation() {
    let names = references(["crank.angle", "crank.speed", "joint2.force"]);
    let (c, other) = (started(GEAR), initialized());
    for n in 0..100 {
        assert_eq!(step(other, f64::from(n) * 1e-3, 1e-3).0, Status::Ok);
    }
    integrate(c, 0.1, 2e-5);
    for (one, two) in get(c, &names).into_iter().zip(get(other, &names)) {
        assert!((one - two).abs() < 1e-8 * (1.0 + two.abs()), "{one} {two}");
    }
    // SAFETY: the instances are valid and not used again.
    unsafe {
        fmi3FreeInstance(c);
        fmi3FreeInstance(other);
    }
}

#[test]
fn the_gear_comes_to_rest_at_its_up_stop() {
    let c = started(GEAR);
    let events = integrate(c, 0.135, 2e-5);
    assert!((events[0] - RETRACTED).abs() < 1e-8, "{events:?}");
    assert_eq!((rates(c, states(c)), states(c)[1]), ([0.0; 2], 0.0));
    assert!(indicators(c).iter().all(|z| *z > 0.0));
    // SAFETY: the instance is valid and not used again.
    unsafe { fmi3FreeInstance(c) };
}

/// v = g t; after the impact at t_1 = sqrt(2 h / g) half the speed, and in the air for t_1.
#[test]
fn a_block_falls_and_bounces() {
    let c = started(FALLING);
    let (g, height) = (9.806_65_f64, 0.5);
    let first = (2.0 * height / g).sqrt();
    let events = integrate(c, 2.6 * first, 1e-3);
    // 1, then 1 + 1, 1 + 1 + 1/2, ...
    for (event, flight) in events.iter().zip([1.0, 2.0, 2.5]) {
        assert!((event - flight * first).abs() < 1e-9, "{events:?}");
    }
    assert_eq!(events.len(), 3);
    // Kinetic energy in the kinetic metric: m v^2 = v_sigma^2.
    let late = 0.1 * first;
    let speed = 2.0_f64.sqrt() * g * (0.125 * first - late);
    assert!((states(c)[1].abs() - speed.abs()).abs() < 1e-8, "{} {speed}", states(c)[1]);
    // SAFETY: the instance is valid and not used again.
    unsafe { fmi3FreeInstance(c) };
}

/// Derivatives of the derivatives along the states, and along an input that is raised by 1, against differences.
fn check_slopes(c: Instance, definition: &str, input: &str) {
    let names = ["along_curve.position", "along_curve.speed", "along_curve.acceleration", input, "crank.angle"];
    let [x, v, a, force, angle] = references_of(definition, names);
    let y = states(c);
    let exact = |known: ValueReference, unknown: ValueReference| {
        let mut slope = f64::NAN;
        // SAFETY: the instance is valid, all arrays have one element.
        let status = unsafe { fmi3GetDirectionalDerivative(c, &unknown, 1, &known, 1, &1.0, 1, &mut slope, 1) };
        assert_eq!(status, Status::Ok);
        slope
    };
    for (state, reference) in [(0, x), (1, v)] {
        let difference = |values: &dyn Fn() -> f64| {
            let at = |sign: f64| {
                let mut moved = y;
                moved[state] += sign * 1e-5;
                assert_eq!(set(c, moved), Status::Ok);
                values()
            };
            let slope = (at(1.0) - at(-1.0)) / 2e-5;
            assert_eq!(set(c, y), Status::Ok);
            slope
        };
        for unknown in [v, a, angle] {
            let (slope, other) = (exact(reference, unknown), difference(&|| get(c, &[unknown])[0]));
            assert!((slope - other).abs() < 1e-6 * (1.0 + other.abs()), "{state} {unknown}: {slope} {other}");
        }
    }
    let before = get(c, &[a, force]);
    let slope = exact(force, a);
    // SAFETY: the instance is valid, the arrays have one element.
    unsafe { assert_eq!(fmi3SetFloat64(c, &force, 1, &(before[1] + 1.0), 1), Status::Ok) };
    assert!((get(c, &[a])[0] - before[0] - slope).abs() < 1e-9 * before[0].abs());
}

#[test]
fn derivatives_of_derivatives_are_slopes() {
    let c = started(GEAR);
    integrate(c, 0.05, 1e-3);
    check_slopes(c, GEAR, "actuator.force");
    // SAFETY: the instance is valid and not used again.
    unsafe { fmi3FreeInstance(c) };
}

/// Drives, dampers, a coil that winds up and a bumper with curves: the motion is that of co-simulation, over the
/// contact and over more than a turn, and its derivatives are exact.
#[test]
fn curves_are_exchanged() {
    let [position, coil, push] = references_of(CURVES, ["guide.position", "coil.torque", "buffer.force"]);
    let c = started(CURVES);
    let mut run = Simulation::open(CURVES).unwrap();
    run.initialize().unwrap();
    let (mut pushed, mut turned) = (false, false);
    for k in 1..=12 {
        integrate(c, 0.05, 5e-5);
        run.step(0.05).unwrap();
        let [x, torque, force] = get(c, &[position, coil, push]);
        let [x1, torque1, force1] =
            ["guide.position", "coil.torque", "buffer.force"].map(|name| run.get(name).unwrap());
        assert!((x - x1).abs() < 1e-7 && (torque - torque1).abs() < 1e-6, "{k}: {x} {x1}, {torque} {torque1}");
        assert!((force - force1).abs() < 1e-3 * (1.0 + force.abs()), "{k}: {force} {force1}");
        pushed |= run.get("buffer.impact_count").unwrap() > 0.0;
        turned |= run.get("crank.angle").unwrap().abs() > 7.2;
    }
    assert!(pushed && turned);
    check_slopes(c, CURVES, "motor.command");
    // SAFETY: the instance is valid and not used again.
    unsafe { fmi3FreeInstance(c) };
}

/// A disc cam that turns against the weight of its follower, and a cylinder with losses that pushes the crank of a
/// slider-crank over its dead centres.
const BORDERS: &str = r#"{ "name": "Borders",
    "bodies": { "ground": { "points": { "guide": [0.0, 0.2], "far": [0.9, 0.0] } }, "disc": { "length": 0.1,
        "mass": 1, "inertia": 0.02 },
        "stem": { "mass": 0.4, "points": { "tip": [0.0, -0.1] } }, "rod": { "length": 0.3, "mass": 0.1,
            "inertia": 0.001 },
        "slider": { "mass": 0.1 } },
    "joints": { "bearing": { "type": "revolute", "first": "ground.origin", "second": "disc.origin" },
        "guide": { "type": "prismatic", "first": "ground.guide", "second": "stem.origin",
            "axis_angle": 1.5707963267948966 },
        "pin": { "type": "revolute", "first": "disc.end", "second": "rod.origin" },
        "wrist": { "type": "revolute", "first": "rod.end", "second": "slider.origin" },
        "slide": { "type": "prismatic", "first": "ground.origin", "second": "slider.origin" } },
    "couplings": { "cam": { "type": "cam", "first": "disc.origin", "joint": "guide", "follower": "roller",
        "contact": "stem.tip", "base_radius": 0.04, "roller_radius": 0.01, "grooved": true, "segments": [
            { "law": "cycloidal", "angle": 1.5, "rise": 0.02 }, { "law": "dwell", "angle": 1.0 },
            { "law": "polynomial_345", "angle": 2.0, "rise": -0.02 }, { "law": "dwell" } ] } },
    "actuators": { "cylinder": { "joint": "slide", "force": 0.5, "efficiency": 0.8 } },
    "start": { "body": "disc", "angle": 0.2, "speed": 10 }, "guess": { "disc": 0.2, "guide": -0.05, "rod": -0.07,
        "slide": 0.397 } }"#;

/// The borders of segments of a cam are events, and so are the positions at which the force of a drive with losses
/// changes its sign along the motion: at the dead centres of the crank.
#[test]
fn borders_of_segments_and_changes_of_loss_are_events() {
    let [angle, loss] = references_of(BORDERS, ["disc.angle", "cylinder.loss_indicator"]);
    let c = started(BORDERS);
    let mut run = Simulation::open(BORDERS).unwrap();
    run.initialize().unwrap();
    let mut met = Vec::new();
    for k in 1..=60 {
        let before = get(c, &[angle, loss]);
        let count = integrate(c, 0.02, 1e-4).len();
        run.step(0.02).unwrap();
        let after = get(c, &[angle, loss]);
        assert!((after[0] - run.get("disc.angle").unwrap()).abs() < 1e-8, "{k}");
        use std::f64::consts::{PI, TAU};
        let borders = [0.0, 1.5, 2.5, 4.5, PI].into_iter().flat_map(|u| [u, u + TAU, u + 2.0 * TAU]);
        let borders = borders.chain([0.0, TAU, 2.0 * TAU]);
        let expected = borders.filter(|u| before[0] < *u && *u < after[0]).count();
        // A dead centre at 0 and a border of a segment there are two events at one place.
        assert!(
            count == expected || count + 1 == expected,
            "{k}: {count} events, {expected} borders, {before:?} {after:?}"
        );
        met.push(before[1] * after[1] < 0.0);
    }
    assert!(get(c, &[angle])[0] > 9.0);
    assert!(met.iter().filter(|met| **met).count() >= 2, "the loss changes");
    // SAFETY: the instance is valid and not used again.
    unsafe { fmi3FreeInstance(c) };
}

/// A follower that lifts off is a warning of the completed step at which it first does, with the flags of that step.
#[test]
fn a_lift_off_is_told_at_a_completed_step() {
    let text = include_str!("../../../modelDescription/ValveTrain/resources/mechanism.json");
    let text = text.replace("\"speed\": -40", "\"speed\": -130").leak();
    let c = started(text);
    let (h, mut warnings) = (1e-4, 0);
    for k in 1..=500 {
        let end = rk4(c, states(c), h);
        let (mut enter, mut terminate) = (7, 7);
        // SAFETY: the instance is valid, each pointer leads to one value.
        let status = unsafe {
            assert_eq!(fmi3SetTime(c, f64::from(k) * h), Status::Ok);
            assert_eq!(set(c, end), Status::Ok);
            fmi3CompletedIntegratorStep(c, 1, &mut enter, &mut terminate)
        };
        assert_eq!((enter > 1, terminate), (false, 0));
        warnings += u32::from(status == Status::Warning);
        assert!(status == Status::Ok || status == Status::Warning, "{k}: {status:?}");
    }
    assert_eq!(warnings, 1);
    // SAFETY: the instance is valid and not used again.
    unsafe { fmi3FreeInstance(c) };
}

#[test]
fn a_saved_state_goes_on_to_the_bit() {
    let c = started(GEAR);
    integrate(c, 0.05, 1e-3);
    let (y, mut saved, mut size) = (states(c), null_mut(), 0);
    // SAFETY: the instance and the states are valid, the bytes have the length told.
    unsafe {
        assert_eq!(fmi3GetFMUState(c, &mut saved), Status::Ok);
        assert_eq!(fmi3SerializedFMUStateSize(c, saved, &mut size), Status::Ok);
        let mut bytes = vec![0; size];
        assert_eq!(fmi3SerializeFMUState(c, saved, bytes.as_mut_ptr(), size), Status::Ok);
        integrate(c, 0.02, 1e-3);
        let after = states(c);
        let (fresh, mut read) = (exchanging(GEAR), null_mut());
        assert_eq!(fmi3DeserializeFMUState(fresh, bytes.as_ptr(), size, &mut read), Status::Ok);
        assert_eq!(fmi3SetFMUState(fresh, read), Status::Ok);
        assert_eq!(states(fresh), y);
        integrate(fresh, 0.02, 1e-3);
        assert_eq!(states(fresh), after);
        // An instance for co-simulation has no such phase.
        let other = gear();
        assert_eq!(fmi3SetFMUState(other, saved), Status::Error);
        for state in [&mut saved, &mut read] {
            assert_eq!(fmi3FreeFMUState(c, state), Status::Ok);
        }
        [c, fresh, other].into_iter().for_each(|c| fmi3FreeInstance(c));
    }
}

#[test]
fn what_is_not_of_this_phase_or_kind_is_refused_and_changes_nothing() {
    let [force, stop, drift] = references(["actuator.force", "uplock.engage", "energy.drift"]);
    let (c, other) = (started(GEAR), initialized());
    let (y, mut f, mut time) = (states(c), [0.0; 2], 0.0);
    // SAFETY: both instances are valid until they are freed, all arrays have the lengths told.
    unsafe {
        // Of co-simulation.
        let (mut flags, mut last) = ([7; 3], f64::NAN);
        let [event, terminate, early] = &mut flags;
        assert_eq!(fmi3DoStep(c, 0.0, 1e-3, 1, event, terminate, early, &mut last), Status::Error);
        assert_eq!(fmi3EnterStepMode(c), Status::Error);
        assert_eq!(fmi2DoStep(c, 0.0, 1e-3, 1), Status2::Error);
        // Of model exchange.
        assert_eq!(fmi3GetContinuousStateDerivatives(other, f.as_mut_ptr(), 2), Status::Error);
        assert_eq!(fmi3SetContinuousStates(other, y.as_ptr(), 2), Status::Error);
        assert_eq!(fmi3SetTime(other, 0.1), Status::Error);
        // Lengths, NULL, numbers.
        assert_eq!(fmi3SetContinuousStates(c, y.as_ptr(), 1), Status::Error);
        assert_eq!(fmi3SetContinuousStates(c, null(), 2), Status::Error);
        assert_eq!(fmi3SetContinuousStates(c, null(), 0), Status::Error);
        assert_eq!(fmi3GetContinuousStateDerivatives(c, f.as_mut_ptr(), 3), Status::Error);
        assert_eq!(fmi3GetEventIndicators(c, f.as_mut_ptr(), usize::MAX), Status::Error);
        assert_eq!(fmi3CompletedIntegratorStep(c, 1, null_mut(), null_mut()), Status::Error);
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!((set(c, [bad, 0.0]), set(c, [0.0, bad])), (Status::Discard, Status::Discard));
            assert_eq!(fmi3SetTime(c, bad), Status::Error);
        }
        // A discrete input in continuous-time mode.
        assert_eq!(fmi3SetBoolean(c, &stop, 1, &1, 1), Status::Error);
        assert_eq!(fmi3SetFloat64(c, &force, 1, &3e4, 1), Status::Ok);
        assert_eq!(states(c), y);
        // What the steps of co-simulation book is not known here, which is reported once.
        for expected in [Status::Warning, Status::Ok, Status::Ok] {
            assert_eq!(fmi3GetFloat64(c, &drift, 1, &mut time, 1), expected);
            assert!(time.is_nan());
        }
        // States far beyond the travel: values or a discarded call, and no call runs for ever.
        for far in [1e3, -1e3, 1e12, 1e300, -1e300, f64::MAX] {
            if set(c, [far, 1.0]) == Status::Ok {
                assert_ne!(fmi3GetContinuousStateDerivatives(c, f.as_mut_ptr(), 2), Status::Fatal);
                assert_eq!(states(c)[0], far);
            }
        }
        [c, other].into_iter().for_each(|c| fmi3FreeInstance(c));
    }
}

#[test]
fn both_versions_have_the_same_bits() {
    let (c, other) = (started(GEAR), exchanging(GEAR));
    let mut info = EventInfo { values_changed: 7, ..EventInfo::default() };
    let (mut enter, mut terminate, mut f) = (7, 7, [f64::NAN; 2]);
    integrate(c, 0.05, 1e-3);
    let y = states(c);
    // SAFETY: both instances are valid until they are freed, all arrays have the lengths told.
    unsafe {
        assert_eq!(fmi2SetupExperiment(other, 1, 1e-9, 0.0, 0, 0.0), Status2::Ok);
        assert_eq!(fmi2EnterInitializationMode(other), Status2::Ok);
        assert_eq!(fmi2ExitInitializationMode(other), Status2::Ok);
        assert_eq!(fmi2NewDiscreteStates(other, &mut info), Status2::Ok);
        assert_eq!(info, EventInfo::default());
        assert_eq!(fmi2EnterContinuousTimeMode(other), Status2::Ok);
        assert_eq!(fmi2SetTime(other, 0.01), Status2::Ok);
        assert_eq!(fmi2SetContinuousStates(other, y.as_ptr(), 2), Status2::Ok);
        assert_eq!(fmi2GetDerivatives(other, f.as_mut_ptr(), 2), Status2::Ok);
        assert_eq!(f, rates(c, y));
        let mut z = vec![f64::NAN; indicators(c).len()];
        assert_eq!(fmi2GetEventIndicators(other, z.as_mut_ptr(), z.len()), Status2::Ok);
        assert_eq!(z, indicators(c));
        assert_eq!(fmi2CompletedIntegratorStep(other, 1, &mut enter, &mut terminate), Status2::Ok);
        assert_eq!((enter, terminate), (0, 0));
        [c, other].into_iter().for_each(|c| fmi3FreeInstance(c));
    }
}
