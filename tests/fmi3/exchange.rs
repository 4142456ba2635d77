//! Model exchange: derivatives against co-simulation, events at stops, directional derivatives, phases, rejected calls.
mod laws_that_switch;

use crate::events::update;
use crate::fmi2;
use crate::{Fmu, RETRACTED};
use linkage_fmu::fmi2::types::Status as Status2;
use linkage_fmu::fmi3::types::{Status, ValueReference};
use linkage_fmu::fmi3::*;
use linkage_fmu::numerics::bracket::bisect;
use linkage_fmu::simulation::Simulation;
use std::f64::consts::{PI, TAU};
use std::ptr::{null, null_mut};

const CURVES: &str = include_str!("../fixtures/curves.json");
/// A block of 2 kg that falls 0.5 m onto a floor with a restitution of 0.5, from rest.
const FALLING: &str = include_str!("../fixtures/falling_block.json");
/// An arm that a controlled drive with limits lifts against gravity and constant friction.
const LIMITED: &str = include_str!("../fixtures/limited_servo.json");
/// A disc cam that turns against the weight of its follower, and a cylinder with losses that drives the crank of a
/// slider-crank over its dead centres.
const BORDERS: &str = include_str!("../fixtures/cam_and_dead_centres.json");

/// An instance in continuous-time mode, after the first event.
fn started(definition: &str) -> Fmu {
    let fmu = Fmu::exchanging(definition);
    fmu.initialize(1e-9);
    changes(&fmu);
    assert_eq!(fmu.enter_continuous_time_mode(), Status::Ok);
    fmu
}

/// An instance in continuous-time mode, and a simulation of the same definition.
fn both(definition: &str) -> (Fmu, Simulation) {
    let mut run = Simulation::open(definition).unwrap();
    run.initialize().unwrap();
    (started(definition), run)
}

/// Variables have the values of the simulation, with this absolute and relative tolerance. Returns the values.
#[track_caller]
fn assert_same<const N: usize>(fmu: &Fmu, run: &mut Simulation, names: [&str; N], allowed: f64) -> [f64; N] {
    let values = fmu.get(names);
    for (name, value) in names.into_iter().zip(values) {
        let exact = run.get(name).unwrap();
        let time = run.time();
        assert!((value - exact).abs() < allowed * (1.0 + exact.abs()), "{time} s: {name} {value} {exact}");
    }
    values
}

fn gear() -> Fmu {
    started(&fmi2::mechanism())
}

/// Update the discrete states in event mode. Returns whether the continuous states have changed.
fn changes(fmu: &Fmu) -> bool {
    let (status, flags) = update(fmu);
    assert_eq!((status, flags[0], flags[1], flags[2], flags[4]), (Status::Ok, 0, 0, 0, 0));
    flags[3] == 1
}

pub fn states(fmu: &Fmu) -> [f64; 2] {
    let mut y = [f64::NAN; 2];
    assert_eq!(fmu.states(&mut y), Status::Ok);
    y
}

pub fn rates(fmu: &Fmu, y: [f64; 2]) -> [f64; 2] {
    let mut f = [f64::NAN; 2];
    assert_eq!((fmu.set_states(&y), fmu.rates(&mut f)), (Status::Ok, Status::Ok));
    f
}

/// All continuous states.
fn present(fmu: &Fmu) -> Vec<f64> {
    let mut y = vec![f64::NAN; fmu.description.state_count()];
    assert_eq!(fmu.states(&mut y), Status::Ok);
    y
}

/// Their rates.
fn slopes(fmu: &Fmu, y: &[f64]) -> Vec<f64> {
    let mut f = vec![f64::NAN; y.len()];
    assert_eq!((fmu.set_states(y), fmu.rates(&mut f)), (Status::Ok, Status::Ok));
    f
}

fn indicators(fmu: &Fmu) -> Vec<f64> {
    let mut z = vec![f64::NAN; fmu.description.indicator_count()];
    assert_eq!(fmu.indicators(&mut z), Status::Ok);
    z
}

/// One step of the classical Runge-Kutta method.
fn rk4(fmu: &Fmu, y: &[f64], h: f64) -> Vec<f64> {
    let add = |k: &[f64], part: f64| y.iter().zip(k).map(|(y, k)| y + part * h * k).collect::<Vec<_>>();
    let k1 = slopes(fmu, y);
    let k2 = slopes(fmu, &add(&k1, 0.5));
    let k3 = slopes(fmu, &add(&k2, 0.5));
    let k4 = slopes(fmu, &add(&k3, 1.0));
    (0..y.len()).map(|n| y[n] + h / 6.0 * (k1[n] + 2.0 * k2[n] + 2.0 * k3[n] + k4[n])).collect()
}

/// Integrate, with events located by bisection of the step. Returns the times of the events.
fn integrate(fmu: &Fmu, span: f64, h: f64) -> Vec<f64> {
    let (mut t, mut events) = (0.0, Vec::new());
    while t < span {
        let (y, before) = (present(fmu), indicators(fmu));
        let size = h.min(span - t);
        let mut crosses = |part: f64| {
            let end = rk4(fmu, &y, part * size);
            assert_eq!(fmu.set_states(&end), Status::Ok);
            indicators(fmu).iter().zip(&before).any(|(a, b)| a * b < 0.0)
        };
        let part = if crosses(1.0) { bisect(&mut crosses, 0.0, 1.0)[1] } else { 1.0 };
        let end = rk4(fmu, &y, part * size);
        t += part * size;
        assert_eq!((fmu.set_states(&end), fmu.set_time(t)), (Status::Ok, Status::Ok));
        let (status, enter) = fmu.complete_step();
        assert_eq!(status, Status::Ok);
        if part < 1.0 || enter {
            events.push(t);
            assert_eq!(fmu.enter_event_mode(), Status::Ok);
            changes(fmu);
            assert_eq!(fmu.enter_continuous_time_mode(), Status::Ok);
        }
        assert!(events.len() < 200);
    }
    events
}

#[test]
fn a_retraction_is_that_of_co_simulation() {
    let names = ["crank.angle", "crank.speed", "joint2.force"];
    let (fmu, other) = (gear(), Fmu::stepping());
    (0..100).for_each(|n| other.whole_step(f64::from(n) * 1e-3, 1e-3));
    integrate(&fmu, 0.1, 2e-5);
    for (one, two) in fmu.get(names).into_iter().zip(other.get(names)) {
        assert!((one - two).abs() < 1e-8 * (1.0 + two.abs()), "{one} {two}");
    }
}

#[test]
fn the_gear_comes_to_rest_at_its_up_stop() {
    let fmu = gear();
    let events = integrate(&fmu, 0.135, 2e-5);
    assert!((events[0] - RETRACTED.0).abs() < 1e-8, "{events:?}");
    assert_eq!((rates(&fmu, states(&fmu)), states(&fmu)[1]), ([0.0; 2], 0.0));
    assert!(indicators(&fmu).iter().all(|z| *z > 0.0));
}

/// Free fall with v = g t. The impact at t_1 = sqrt(2 h / g) halves the speed, and the next flight lasts t_1.
#[test]
fn a_block_falls_and_bounces() {
    let fmu = started(FALLING);
    let (g, height) = (9.806_65_f64, 0.5);
    let first = (2.0 * height / g).sqrt();
    let events = integrate(&fmu, 2.6 * first, 1e-3);
    // Times in t_1: 1, then 1 + 1, 1 + 1 + 1/2, ...
    for (event, flight) in events.iter().zip([1.0, 2.0, 2.5]) {
        assert!((event - flight * first).abs() < 1e-9, "{events:?}");
    }
    assert_eq!(events.len(), 3);
    // Kinetic energy in the kinetic metric: m v^2 = v_sigma^2.
    let late = 0.1 * first;
    let speed = 2.0_f64.sqrt() * g * (0.125 * first - late);
    assert!((states(&fmu)[1].abs() - speed.abs()).abs() < 1e-8, "{} {speed}", states(&fmu)[1]);
}

/// Directional derivatives of the state derivatives, with respect to the states and to an input that is raised by 1,
/// against differences.
fn check_slopes(fmu: &Fmu, input: &str) {
    let names = ["along_curve.position", "along_curve.speed", "along_curve.acceleration", input, "crank.angle"];
    let [x, v, a, force, angle] = fmu.vrs(names);
    let y = states(fmu);
    let exact = |known: ValueReference, unknown: ValueReference| {
        let mut slope = [f64::NAN];
        assert_eq!(fmu.derivative(false, &[unknown], &[known], &[1.0], &mut slope), Status::Ok);
        slope[0]
    };
    for (state, reference) in [(0, x), (1, v)] {
        let difference = |values: &dyn Fn() -> f64| {
            let at = |sign: f64| {
                let mut moved = y;
                moved[state] += sign * 1e-5;
                assert_eq!(fmu.set_states(&moved), Status::Ok);
                values()
            };
            let slope = (at(1.0) - at(-1.0)) / 2e-5;
            assert_eq!(fmu.set_states(&y), Status::Ok);
            slope
        };
        for unknown in [v, a, angle] {
            let (slope, other) = (exact(reference, unknown), difference(&|| fmu.read(&[unknown])[0]));
            assert!((slope - other).abs() < 1e-6 * (1.0 + other.abs()), "{state} {unknown}: {slope} {other}");
        }
    }
    let before = fmu.read(&[a, force]);
    let slope = exact(force, a);
    assert_eq!(fmu.set_reals(&[force], &[before[1] + 1.0]), Status::Ok);
    assert!((fmu.read(&[a])[0] - before[0] - slope).abs() < 1e-9 * before[0].abs());
}

#[test]
fn derivatives_of_derivatives_are_slopes() {
    let fmu = gear();
    integrate(&fmu, 0.05, 1e-3);
    check_slopes(&fmu, "actuator.force");
}

/// Drives, dampers, a torsional spring that winds up and a bumper with curves: the motion agrees with co-simulation,
/// through the contact and over more than a turn. The derivatives are exact.
#[test]
fn curves_are_exchanged() {
    let names = ["guide.position", "coil.torque", "buffer.force"];
    let (fmu, mut run) = both(CURVES);
    let (mut pushed, mut turned) = (false, false);
    for k in 1..=12 {
        integrate(&fmu, 0.05, 5e-5);
        run.step(0.05).unwrap();
        let ([x, torque, force], [x1, torque1, force1]) = (fmu.get(names), names.map(|name| run.get(name).unwrap()));
        assert!((x - x1).abs() < 1e-7 && (torque - torque1).abs() < 1e-6, "{k}: {x} {x1}, {torque} {torque1}");
        assert!((force - force1).abs() < 1e-3 * (1.0 + force.abs()), "{k}: {force} {force1}");
        pushed |= run.get("buffer.impact_count").unwrap() > 0.0;
        turned |= run.get("crank.angle").unwrap().abs() > 7.2;
    }
    assert!(pushed && turned);
    check_slopes(&fmu, "motor.command");
}

/// The force of a controller reaches and leaves its limits at events. Between the events the motion agrees with
/// co-simulation, and the derivatives are exact.
#[test]
fn limits_of_a_controller_are_events() {
    let (fmu, mut run) = both(LIMITED);
    let names = fmu.vrs(["servo.max_force_indicator", "servo.min_force_indicator", "crank.angle", "crank.speed"]);
    let (mut crossings, mut events) = (0, 0);
    for k in 1..=40 {
        let before = fmu.read(&names);
        events += integrate(&fmu, 0.02, 5e-5).len();
        run.step(0.02).unwrap();
        let after = fmu.read(&names);
        crossings += (0..2).filter(|&n| before[n] * after[n] < 0.0).count();
        let (angle, speed) = (run.get("crank.angle").unwrap(), run.get("crank.speed").unwrap());
        // At the reversal friction jumps by 3.8 rad/s2 within one step of this method.
        let allowed = if k <= 28 { 1e-8 } else { 3.8 * 5e-5 };
        assert!((after[2] - angle).abs() < allowed, "{k}: {} {angle}", after[2]);
        assert!((after[3] - speed).abs() < allowed, "{k}: {} {speed}", after[3]);
        assert!((after[0] < 0.0) == (k <= 11), "{k}: the upper limit is left between 0.22 s and 0.24 s");
    }
    assert!(crossings == 3 && events >= crossings, "{crossings} limits, {events} events");
    check_slopes(&fmu, "servo.torque");
}

/// Events are the borders of segments of a cam, and the positions at which the power of a drive with losses changes its
/// sign: the dead centres of the crank.
#[test]
fn borders_of_segments_and_changes_of_loss_are_events() {
    let (fmu, mut run) = both(BORDERS);
    let names = fmu.vrs(["disc.angle", "cylinder.loss_indicator"]);
    let mut met = Vec::new();
    for k in 1..=60 {
        let before = fmu.read(&names);
        let count = integrate(&fmu, 0.02, 1e-4).len();
        run.step(0.02).unwrap();
        let after = fmu.read(&names);
        assert!((after[0] - run.get("disc.angle").unwrap()).abs() < 1e-8, "{k}");
        let borders = [0.0, 1.5, 2.5, 4.5, PI].into_iter().flat_map(|u| [u, u + TAU, u + 2.0 * TAU]);
        let borders = borders.chain([0.0, TAU, 2.0 * TAU]);
        let expected = borders.filter(|u| before[0] < *u && *u < after[0]).count();
        // A dead centre at 0 and a border of a segment at 0 are two events at one position.
        assert!(
            count == expected || count + 1 == expected,
            "{k}: {count} events, {expected} borders, {before:?} {after:?}"
        );
        met.push(before[1] * after[1] < 0.0);
    }
    assert!(fmu.read(&names)[0] > 9.0);
    assert!(met.iter().filter(|met| **met).count() >= 2, "the loss changes");
}

/// A follower that loses contact gives a warning at the first completed step in which it does, with the flags of this
/// step.
#[test]
fn a_lift_off_is_reported_at_a_completed_step() {
    let text = include_str!("../../modelDescription/ValveTrain/resources/mechanism.json");
    let fmu = started(&text.replace("\"speed\": -40", "\"speed\": -130"));
    let (h, mut warnings) = (1e-4, 0);
    for k in 1..=500 {
        let end = rk4(&fmu, &present(&fmu), h);
        assert_eq!((fmu.set_time(f64::from(k) * h), fmu.set_states(&end)), (Status::Ok, Status::Ok));
        let (mut enter, mut terminate) = (7, 7);
        // SAFETY: the instance is valid, each pointer leads to one value.
        let status = unsafe { fmi3CompletedIntegratorStep(fmu.instance(), 1, &mut enter, &mut terminate) };
        assert_eq!((enter > 1, terminate), (false, 0));
        warnings += u32::from(status == Status::Warning);
        assert!(status == Status::Ok || status == Status::Warning, "{k}: {status:?}");
    }
    assert_eq!(warnings, 1);
}

#[test]
fn a_saved_state_continues_bit_identically() {
    let fmu = gear();
    integrate(&fmu, 0.05, 1e-3);
    let (y, mut saved) = (states(&fmu), fmu.save());
    let bytes = fmu.serialize(&saved).unwrap();
    integrate(&fmu, 0.02, 1e-3);
    let after = states(&fmu);
    let fresh = Fmu::exchanging(&fmi2::mechanism());
    let mut read = fresh.deserialize(&bytes).unwrap();
    assert_eq!((fresh.restore(&read), states(&fresh)), (Status::Ok, y));
    integrate(&fresh, 0.02, 1e-3);
    assert_eq!(states(&fresh), after);
    // An instance for co-simulation does not have this phase.
    assert_eq!(Fmu::gear(Default::default()).restore(&saved), Status::Error);
    assert_eq!((fmu.free(&mut saved), fresh.free(&mut read)), (Status::Ok, Status::Ok));
}

#[test]
fn calls_of_another_phase_or_interface_type_are_rejected_and_change_nothing() {
    use Status::{Discard, Error, Ok, Warning};
    let (fmu, other) = (gear(), Fmu::stepping());
    let (y, mut f, c) = (states(&fmu), [0.0; 3], fmu.instance());
    // Functions of co-simulation.
    assert_eq!((fmu.step(0.0, 1e-3).0, fmu.enter_step_mode()), (Error, Error));
    let exchanged = fmi2::description().exchange(None, false).unwrap();
    assert_eq!((exchanged.initialize(), exchanged.step(0.0, 1e-3)), (Status2::Ok, Status2::Error));
    // Functions of model exchange.
    assert_eq!((other.rates(&mut f[..2]), other.set_states(&y), other.set_time(0.1)), (Error, Error, Error));
    // Wrong lengths, NULL, invalid numbers.
    assert_eq!((fmu.set_states(&y[..1]), fmu.rates(&mut f)), (Error, Error));
    // SAFETY: the instance is valid; unreadable arguments are rejected before they are read.
    unsafe {
        assert_eq!(fmi3SetContinuousStates(c, null(), 2), Error);
        assert_eq!(fmi3SetContinuousStates(c, null(), 0), Error);
        assert_eq!(fmi3GetEventIndicators(c, f.as_mut_ptr(), usize::MAX), Error);
        assert_eq!(fmi3CompletedIntegratorStep(c, 1, null_mut(), null_mut()), Error);
    }
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert_eq!((fmu.set_states(&[bad, 0.0]), fmu.set_states(&[0.0, bad])), (Discard, Discard));
        assert_eq!(fmu.set_time(bad), Error);
    }
    // A discrete input in continuous-time mode.
    assert_eq!(fmu.set_boolean(fmu.vr("uplock.engage"), 1), Error);
    assert_eq!((fmu.set("actuator.force", 3e4), states(&fmu)), (Ok, y));
    // The energy drift is available in co-simulation only, which is reported once.
    for expected in [Warning, Ok, Ok] {
        assert_eq!(fmu.reals(&[fmu.vr("energy.drift")], &mut f[..1]), expected);
        assert!(f[0].is_nan());
    }
    // States far beyond the travel give values or a discarded call, and every call ends.
    for far in [1e3, -1e3, 1e12, 1e300, -1e300, f64::MAX] {
        if fmu.set_states(&[far, 1.0]) == Ok {
            assert_ne!(fmu.rates(&mut f[..2]), Status::Fatal);
            assert_eq!(states(&fmu)[0], far);
        }
    }
}

#[test]
fn both_versions_have_the_same_bits() {
    let (fmu, other) = (gear(), fmi2::description().exchange(None, false).unwrap());
    let mut f = [f64::NAN; 2];
    integrate(&fmu, 0.05, 1e-3);
    let y = states(&fmu);
    assert_eq!((other.set_up(Some(1e-9), 0.0, None), other.initialize()), (Status2::Ok, Status2::Ok));
    assert_eq!(other.update_discrete_states(), (Status2::Ok, false));
    assert_eq!(other.enter_continuous_time_mode(), Status2::Ok);
    assert_eq!(
        (other.set_time(0.01), other.set_states(&y), other.rates(&mut f)),
        (Status2::Ok, Status2::Ok, Status2::Ok)
    );
    assert_eq!(f, rates(&fmu, y));
    let mut z = vec![f64::NAN; indicators(&fmu).len()];
    assert_eq!((other.indicators(&mut z), z), (Status2::Ok, indicators(&fmu)));
    assert_eq!(other.complete_step(), (Status2::Ok, false));
}
