//! Event mode and early return: ends of steps, handling of events, legal calls.
use crate::{Fmu, RETRACTED};
use linkage_fmu::fmi2::host::State;
use linkage_fmu::fmi3::fmi3UpdateDiscreteStates;
use linkage_fmu::fmi3::host::{Host, Stepped, Wishes};
use linkage_fmu::fmi3::types::Status;
use std::ptr::null_mut;

const TOLERANCE: f64 = 1e-13;
const SPEED: [&str; 2] = ["crank.angle", "crank.speed"];
const WHOLE: Stepped = Stepped { event: false, terminate: false, early: false, last: 0.0 };

fn wishes(event_mode: bool, early_return: bool) -> Wishes {
    Wishes { event_mode, early_return, ..Wishes::default() }
}

/// An instance of the gear in step mode, with these start values.
fn started(wishes: Wishes, values: &[(&str, f64)]) -> Fmu {
    let event_mode = wishes.event_mode;
    let gear = Fmu::gear(wishes);
    assert_eq!(gear.enter(Some(TOLERANCE), 0.0, None), Status::Ok);
    values.iter().for_each(|(name, value)| assert_eq!(gear.set(name, *value), Status::Ok, "{name}"));
    assert_eq!(gear.exit(), Status::Ok);
    if event_mode {
        assert_eq!((update(&gear), gear.enter_step_mode()), ((Status::Ok, [0; 5]), Status::Ok));
    }
    gear
}

fn with_events(values: &[(&str, f64)]) -> Fmu {
    started(wishes(true, true), values)
}

/// `fmi3UpdateDiscreteStates`, with its flags: update needed, terminate, nominals changed, values changed, next event.
pub fn update(gear: &Fmu) -> (Status, [u8; 5]) {
    let (mut flags, mut next) = ([7; 5], 0.0);
    let [a, b, c, d, e] = &mut flags;
    // SAFETY: the instance is valid, each pointer leads to one value.
    (unsafe { fmi3UpdateDiscreteStates(gear.instance(), a, b, c, d, e, &mut next) }, flags)
}

/// Handle the event at which a step has ended. Returns whether the state has jumped.
fn handle_event(gear: &Fmu) -> bool {
    assert_eq!(gear.enter_event_mode(), Status::Ok);
    let (status, flags) = update(gear);
    assert_eq!((status, flags[0], flags[1], flags[2], flags[4]), (Status::Ok, 0, 0, 0, 0));
    assert_eq!(gear.enter_step_mode(), Status::Ok);
    flags[3] == 1
}

/// Steps to a time, with all events handled on the way. Returns the times of the events.
fn run(gear: &Fmu, mut point: f64, stop: f64) -> Vec<f64> {
    let mut events = Vec::new();
    while point < stop {
        let (status, stepped) = gear.step(point, stop - point);
        assert_eq!(status, Status::Ok);
        assert!(stepped.event == stepped.early || stepped.last >= stop, "{point} {stepped:?}");
        if stepped.event {
            assert!(handle_event(gear));
            events.push(stepped.last);
        }
        point = if stepped.early { stepped.last } else { stop };
    }
    events
}

#[test]
fn a_step_ends_at_the_stop_and_the_impact_follows_in_event_mode() {
    let record = ["upstop.impact_count", "upstop.impact_time", "time"];
    let gear = with_events(&[]);
    gear.whole_step(0.0, 0.1);
    let (status, Stepped { event, early, last, .. }) = gear.step(0.1, 0.1);
    assert_eq!((status, event, early), (Status::Ok, true, true));
    assert!((last - RETRACTED.0).abs() < 1e-12, "{:e}", last - RETRACTED.0);
    let before = gear.get(SPEED);
    assert!((before[0] + 1.3).abs() < 1e-12 && (before[1] - RETRACTED.1).abs() < 1e-9, "{before:?}");
    assert_eq!(gear.get(record), [0.0, -1.0, last]);
    assert!(handle_event(&gear));
    assert_eq!(gear.get(SPEED)[1], 0.0);
    assert_eq!(gear.get(record), [1.0, last, last]);
    let (_, stepped) = gear.step(last, 0.2 - last);
    assert!(!stepped.event && !stepped.early);
}

/// Bounces in event mode agree with the bounces within one step without event mode.
#[test]
fn bounces_are_those_of_a_step_without_event_mode() {
    let names = ["crank.angle", "crank.speed", "energy.drift", "upstop.impact_count", "upstop.impact_time"];
    let bouncing = [("upstop.restitution", 0.125)];
    let (gear, other) = (with_events(&bouncing), started(Wishes::default(), &bouncing));
    let (mut from, mut all) = (0.0, Vec::new());
    for stop in [0.14, 0.2, 0.4] {
        all.extend(run(&gear, from, stop));
        assert_eq!(other.step(from, stop - from).0, Status::Ok);
        let [[angle, speed, drift, count, time], others] = [&gear, &other].map(|fmu| fmu.get(names));
        assert!((angle - others[0]).abs() < 1e-11 && (speed - others[1]).abs() < 1e-8, "{stop}: {angle} {}", others[0]);
        assert!((drift - others[2]).abs() < 1e-7 && (time - others[4]).abs() < 1e-10, "{stop}: {drift} {time}");
        // Rounding decides whether the mechanism bounces once more or rests at the end of a series.
        assert!(all.len() as f64 == count && (count - others[3]).abs() <= if stop == 0.4 { 1.0 } else { 0.0 });
        from = stop;
    }
    assert!((all[0] - RETRACTED.0).abs() < 1e-12);
    assert!(gear.get(names)[3] > 5.0);
}

#[test]
fn a_lock_catches_in_event_mode() {
    let gear = with_events(&[("upstop.restitution", 0.9)]);
    assert_eq!(gear.set_boolean(gear.vr("uplock.engage"), 1), Status::Ok);
    let (_, Stepped { event, early, last, .. }) = gear.step(0.0, 0.2);
    assert!(event && early && (gear.get(SPEED)[1] - RETRACTED.1).abs() < 1e-9);
    assert!(handle_event(&gear));
    assert_eq!(gear.get(SPEED)[1], 0.0);
    let (_, stepped) = gear.step(last, 0.3);
    assert!(!stepped.event && !stepped.early && gear.get(SPEED)[1] == 0.0);
}

/// The pressure lock of the arm engages within a step. With event mode the step ends at this instant, and the output
/// changes when the event is handled, though no state jumps.
#[test]
fn a_pressure_lock_changes_in_event_mode() {
    const ARM: &str = include_str!("../../modelDescription/LiftArm/resources/mechanism.json");
    let is_engaged = |arm: &Fmu| {
        let mut engaged = 7;
        assert_eq!(arm.boolean(arm.vr("parking.engaged"), &mut engaged), Status::Ok);
        engaged
    };
    let arm = Fmu::of(ARM, wishes(true, true));
    arm.initialize(1e-9);
    assert_eq!((update(&arm), arm.enter_step_mode()), ((Status::Ok, [0; 5]), Status::Ok));
    assert_eq!(is_engaged(&arm), 0);
    let (status, stepped) = arm.step(0.0, 1.0);
    assert!(status == Status::Ok && stepped.event && stepped.early && stepped.last < 1.0, "{stepped:?}");
    let pressure = arm.get(["lift.chamber_a.pressure"])[0];
    assert!((pressure / 7e6 - 1.0).abs() < 1e-12, "{pressure}");
    assert_eq!(is_engaged(&arm), 0);
    assert!(!handle_event(&arm));
    assert_eq!(is_engaged(&arm), 1);
    // Without event mode the step continues.
    let other = Fmu::of(ARM, wishes(false, false));
    other.initialize(1e-9);
    other.whole_step(0.0, 1.0);
    assert_eq!(is_engaged(&other), 1);
}

#[test]
fn steps_are_whole_unless_both_are_used() {
    let ends = [(false, false), (true, false), (false, true)].map(|(event_mode, early_return)| {
        let gear = started(wishes(event_mode, early_return), &[("upstop.restitution", 0.3)]);
        (0..20).for_each(|n| gear.whole_step(0.01 * f64::from(n), 0.01));
        gear.get(["crank.angle", "crank.speed", "upstop.impact_time"]).map(f64::to_bits)
    });
    assert!(ends[0] == ends[1] && ends[0] == ends[2]);
}

#[test]
fn saved_states_of_every_phase_continue() {
    let names = ["crank.angle", "crank.speed", "upstop.impact_count", "time"];
    let (gear, plain) = (with_events(&[("upstop.restitution", 0.4)]), started(Wishes::default(), &[]));
    let mut last = gear.step(0.0, 0.2).1.last;
    // States saved before the event, in event mode before and after it is handled, and in step mode.
    for phase in 0..4 {
        let mut state = gear.save();
        let bytes = gear.serialize(&state).unwrap();
        let here = gear.get(names);
        let (mut ends, mut copy) = (Vec::new(), State::NONE);
        for way in 0..3 {
            match way {
                1 => assert_eq!(gear.restore(&state), Status::Ok),
                2 => {
                    assert_eq!(gear.reset(), Status::Ok);
                    copy = gear.deserialize(&bytes).unwrap();
                    assert_eq!(gear.restore(&copy), Status::Ok);
                    assert_eq!(gear.get(names), here);
                }
                _ => {}
            }
            match phase {
                0 => assert!(handle_event(&gear)),
                1 => assert_eq!(update(&gear).1[3], 1),
                2 => assert_eq!(update(&gear).1[3], 0),
                _ => {}
            }
            if matches!(phase, 1 | 2) {
                assert_eq!(gear.enter_step_mode(), Status::Ok);
            }
            let (status, stepped) = gear.step(last, 0.05);
            ends.push((status, stepped, gear.get(names).map(f64::to_bits)));
        }
        assert!(ends[0] == ends[1] && ends[0] == ends[2], "{phase}: {ends:?}");
        // An instance without event mode accepts only states of step mode without an event.
        let before = plain.get(names);
        assert_eq!(plain.restore(&state), if phase == 3 { Status::Ok } else { Status::Error }, "{phase}");
        assert!(phase == 3 || plain.get(names) == before);
        assert_eq!(gear.restore(&state), Status::Ok);
        assert_eq!((gear.free(&mut state), gear.free(&mut copy)), (Status::Ok, Status::Ok));
        match phase {
            0 => assert_eq!(gear.enter_event_mode(), Status::Ok),
            1 => assert_eq!(update(&gear).1[3], 1),
            2 => {
                assert_eq!(gear.enter_step_mode(), Status::Ok);
                assert_eq!(gear.step(last, 1e-3).0, Status::Ok);
                last += 1e-3;
            }
            _ => {}
        }
    }
}

/// A rejected call changes nothing.
#[test]
fn calls_are_legal_in_their_phases_only() {
    use Status::{Error, Ok};
    let names = ["crank.angle", "crank.speed", "time"];
    let gear = Fmu::gear(wishes(true, true));
    assert_eq!((gear.enter(Some(TOLERANCE), 0.0, None), gear.evaluate()), (Ok, Ok));
    assert_eq!((gear.enter_event_mode(), gear.enter_step_mode()), (Error, Error));
    assert_eq!((update(&gear), gear.exit()), ((Error, [7; 5]), Ok));
    // Calls in event mode.
    let before = gear.get(names);
    let [angle, acceleration, force] = gear.vrs(["crank.angle", "crank.acceleration", "actuator.force"]);
    assert_eq!((gear.step(0.0, 0.1).0, gear.enter_event_mode(), gear.evaluate()), (Error, Error, Ok));
    assert_eq!(gear.output_derivatives(&[angle], &[1], &mut [0.0]), Error);
    assert_eq!(gear.derivative(false, &[acceleration], &[force], &[1.0], &mut [0.0]), Ok);
    assert_eq!(gear.set("actuator.force", 30_000.0), Ok);
    let (mut flags, nowhere) = ([7; 5], null_mut());
    let [a, b, d, e, _] = &mut flags;
    // SAFETY: the instance is valid, each pointer that is not NULL leads to one value.
    assert_eq!(unsafe { fmi3UpdateDiscreteStates(gear.instance(), a, b, d, e, nowhere, &mut 0.0) }, Error);
    assert_eq!((flags, gear.get(names)), ([7; 5], before));
    assert_eq!((update(&gear).0, gear.enter_step_mode()), (Ok, Ok));
    // Calls in step mode, and after a step that ended at an event.
    assert_eq!((update(&gear).0, gear.enter_step_mode(), gear.evaluate()), (Error, Error, Error));
    let last = gear.step(0.0, 0.2).1.last;
    let before = gear.get(names);
    assert_eq!(gear.step(last, 0.1), (Error, Stepped { last, ..WHOLE }));
    assert_eq!((gear.enter_event_mode(), gear.enter_step_mode()), (Ok, Error));
    assert_eq!((gear.get(names), gear.terminate()), (before, Ok));
    assert_eq!((update(&gear).0, gear.enter_step_mode(), gear.enter_event_mode()), (Error, Error, Error));
    // Calls without event mode.
    let gear = started(Wishes::default(), &[]);
    assert_eq!((gear.enter_event_mode(), gear.step(0.0, 0.1).0), (Error, Ok));
}

/// A step of any length is made: at the start, later, and near an event. The event occurs at its time.
#[test]
fn a_step_of_any_length_is_done_in_event_mode() {
    let folder = |name: &str| concat!(env!("CARGO_MANIFEST_DIR"), "/modelDescription/").to_owned() + name;
    for (name, drive, value) in [
        ("LandingGearRetraction", "actuator.force", 30_000.0),
        ("LandingGearRetractionHydraulic", "valve.command", 1.0),
    ] {
        let description = linkage_fmu::fmi2::host::Description::read(folder(name).as_ref()).unwrap();
        let gear = Fmu { host: Host::new(&description, wishes(true, true)).unwrap(), description };
        if drive == "valve.command" {
            // Without the ramp, which would clip the command.
            assert_eq!(gear.set("command.ramp_amplitude", 0.0), Status::Ok);
        }
        assert_eq!((gear.enter(None, 0.0, None), gear.exit()), (Status::Ok, Status::Ok));
        assert_eq!(gear.set(drive, value), Status::Ok);
        assert_eq!((update(&gear), gear.enter_step_mode()), ((Status::Ok, [0; 5]), Status::Ok));
        let references = gear.vrs(["crank.angle", "crank.speed", "time"]);
        let (mut point, mut events) = (0.0, 0);
        for part in [0.0, 0.02, 10.0, 0.01, 10.0] {
            if part > 0.0 {
                let (status, stepped) = gear.step(point, part);
                assert_eq!(status, Status::Ok);
                (point, events) = (stepped.last, events + u32::from(stepped.event));
                if stepped.event {
                    // A step that ended at an event must be followed by event mode.
                    assert_eq!(gear.step(point, 5e-324).0, Status::Error);
                    handle_event(&gear);
                }
            }
            for exponent in [324, 310, 300, 200, 100, 51, 49, 30, 20] {
                let (before, h) = (gear.read(&references), 10_f64.powi(-exponent).max(5e-324));
                gear.whole_step(point, h);
                point += h;
                let after = gear.read(&references);
                let is_same = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-11 * (1.0 + a.abs());
                assert!(before.iter().zip(&after).all(is_same), "{h:e} at {point}: {before:?} {after:?}");
            }
        }
        assert!(events > 0);
    }
}
