//! Event mode and early return: where steps end, what happens there, which calls are legal.
use super::*;

/// Time [s] at which the retraction of PHYSICS.md reaches the up stop, and the speed of the crank there [rad/s].
const RETRACTED: (f64, f64) = (0.132_059_852_744_259_7, -30.257_773_253_560_312);
const WITH_EVENTS: Usage =
    Usage { event_mode: true, early_return: true, intermediate_update: false, model_exchange: false };
const TOLERANCE: f64 = 1e-13;

/// An instance in initialization mode.
fn initializing(usage: Usage) -> Instance {
    let c = gear_for(usage);
    // SAFETY: the instance is valid.
    unsafe { assert_eq!(fmi3EnterInitializationMode(c, 1, TOLERANCE, 0.0, 0, 0.0), Status::Ok) };
    c
}

/// An instance in step mode, with these Reals set before.
fn started(usage: Usage, values: &[(&str, f64)]) -> Instance {
    let c = initializing(usage);
    for (name, value) in values {
        let [vr] = references([*name]);
        // SAFETY: the instance is valid, the arrays have one element.
        unsafe { assert_eq!(fmi3SetFloat64(c, &vr, 1, value, 1), Status::Ok, "{name}") };
    }
    // SAFETY: the instance is valid.
    unsafe { assert_eq!(fmi3ExitInitializationMode(c), Status::Ok) };
    if usage.event_mode {
        assert_eq!(update(c), (Status::Ok, [0; 5]));
        // SAFETY: the instance is valid.
        unsafe { assert_eq!(fmi3EnterStepMode(c), Status::Ok) };
    }
    c
}

/// `fmi3UpdateDiscreteStates`, with its flags: update needed, terminate, nominals changed, values changed, next event.
fn update(c: Instance) -> (Status, [u8; 5]) {
    let (mut flags, mut next) = ([7; 5], 0.0);
    let [a, b, c1, d, e] = &mut flags;
    // SAFETY: the instance is valid, each pointer leads to one value.
    (unsafe { fmi3UpdateDiscreteStates(c, a, b, c1, d, e, &mut next) }, flags)
}

/// A step: whether an event is to be handled, whether the step returned early, the time reached.
fn advance(c: Instance, point: f64, h: f64) -> (Status, [u8; 2], f64) {
    let (mut flags, mut last) = ([7; 3], f64::NAN);
    let [event, terminate, early] = &mut flags;
    // SAFETY: the instance is valid, each pointer leads to one value.
    let status = unsafe { fmi3DoStep(c, point, h, 1, event, terminate, early, &mut last) };
    (status, [flags[0], flags[2]], last)
}

/// Handle the event at which a step has ended; whether the state has jumped.
fn handle_event(c: Instance) -> bool {
    // SAFETY: the instance is valid.
    unsafe { assert_eq!(fmi3EnterEventMode(c), Status::Ok) };
    let (status, flags) = update(c);
    assert_eq!((status, flags[0], flags[1], flags[2], flags[4]), (Status::Ok, 0, 0, 0, 0));
    // SAFETY: the instance is valid.
    unsafe { assert_eq!(fmi3EnterStepMode(c), Status::Ok) };
    flags[3] == 1
}

/// Step to a time, with all events on the way handled; their times.
fn run(c: Instance, mut point: f64, stop: f64) -> Vec<f64> {
    let mut events = Vec::new();
    while point < stop {
        let (status, [event, early], last) = advance(c, point, stop - point);
        assert_eq!(status, Status::Ok);
        assert!(event == early || last >= stop, "{point} {last}");
        if event == 1 {
            assert!(handle_event(c));
            events.push(last);
        }
        point = if early == 1 { last } else { stop };
    }
    events
}

fn free(c: Instance) {
    // SAFETY: the instance is not used again.
    unsafe { fmi3FreeInstance(c) }
}

#[test]
fn a_step_ends_at_the_stop_and_the_impact_follows_in_event_mode() {
    let speed = references(["crank.angle", "crank.speed"]);
    let record = references(["upstop.impact_count", "upstop.impact_time", "time"]);
    let c = started(WITH_EVENTS, &[]);
    assert_eq!(advance(c, 0.0, 0.1), (Status::Ok, [0, 0], 0.1));
    let (status, flags, last) = advance(c, 0.1, 0.1);
    assert_eq!((status, flags), (Status::Ok, [1, 1]));
    assert!((last - RETRACTED.0).abs() < 1e-12, "{:e}", last - RETRACTED.0);
    let before = get(c, &speed);
    assert!((before[0] + 1.3).abs() < 1e-12 && (before[1] - RETRACTED.1).abs() < 1e-9, "{before:?}");
    assert_eq!(get(c, &record), [0.0, -1.0, last]);
    assert!(handle_event(c));
    assert_eq!(get(c, &speed)[1], 0.0);
    assert_eq!(get(c, &record), [1.0, last, last]);
    assert_eq!(advance(c, last, 0.2 - last).1, [0, 0]);
    free(c);
}

/// The same bounces as without event mode, which handles them within one step.
#[test]
fn bounces_are_those_of_a_step_without_event_mode() {
    let names = references(["crank.angle", "crank.speed", "energy.drift", "upstop.impact_count", "upstop.impact_time"]);
    let bouncing = [("upstop.restitution", 0.125)];
    let (c, other) = (started(WITH_EVENTS, &bouncing), started(Usage::default(), &bouncing));
    let (mut from, mut all) = (0.0, Vec::new());
    for stop in [0.14, 0.2, 0.4] {
        all.extend(run(c, from, stop));
        assert_eq!(step(other, from, stop - from).0, Status::Ok);
        let [[angle, speed, drift, count, time], others] = [c, other].map(|c| get(c, &names));
        assert!((angle - others[0]).abs() < 1e-11 && (speed - others[1]).abs() < 1e-8, "{stop}: {angle} {}", others[0]);
        assert!((drift - others[2]).abs() < 1e-7 && (time - others[4]).abs() < 1e-10, "{stop}: {drift} {time}");
        // Whether the last of a series is a bounce or comes to rest is a matter of rounding.
        assert!(all.len() as f64 == count && (count - others[3]).abs() <= if stop == 0.4 { 1.0 } else { 0.0 });
        from = stop;
    }
    assert!((all[0] - RETRACTED.0).abs() < 1e-12);
    assert!(get(c, &names)[3] > 5.0);
    free(c);
    free(other);
}

#[test]
fn a_lock_catches_in_event_mode() {
    let [engage, caught] = references(["uplock.engage", "uplock.engage"]);
    let speed = references(["crank.angle", "crank.speed"]);
    let c = started(WITH_EVENTS, &[("upstop.restitution", 0.9)]);
    // SAFETY: the instance is valid, the arrays have one element.
    unsafe { assert_eq!(fmi3SetBoolean(c, &engage, 1, &1, 1), Status::Ok) };
    let (_, flags, last) = advance(c, 0.0, 0.2);
    assert_eq!(flags, [1, 1]);
    assert!((get(c, &speed)[1] - RETRACTED.1).abs() < 1e-9);
    assert!(handle_event(c));
    assert_eq!(get(c, &speed)[1], 0.0);
    assert_eq!((advance(c, last, 0.3).1, get(c, &speed)[1]), ([0, 0], 0.0));
    assert_eq!(caught, engage);
    free(c);
}

/// Neither event mode alone nor early return alone ends a step at an event, and the bits stay.
#[test]
fn steps_are_whole_unless_both_are_used() {
    let names = references(["crank.angle", "crank.speed", "upstop.impact_time"]);
    let ends = [(false, false), (true, false), (false, true)].map(|(event_mode, early_return)| {
        let c = started(Usage { event_mode, early_return, ..Usage::default() }, &[("upstop.restitution", 0.3)]);
        for n in 0..20 {
            let (point, h) = (0.01 * f64::from(n), 0.01);
            assert_eq!(advance(c, point, h), (Status::Ok, [0, 0], point + h));
        }
        let end = get(c, &names).map(f64::to_bits);
        free(c);
        end
    });
    assert!(ends[0] == ends[1] && ends[0] == ends[2]);
}

#[test]
fn states_of_every_phase_go_on() {
    let names = references(["crank.angle", "crank.speed", "upstop.impact_count", "time"]);
    let (c, plain) = (started(WITH_EVENTS, &[("upstop.restitution", 0.4)]), started(Usage::default(), &[]));
    let mut last = advance(c, 0.0, 0.2).2;
    // Before the event is handled, in event mode before it and after it, in step mode.
    for phase in 0..4 {
        // SAFETY: the instances and states are valid until they are freed.
        unsafe {
            let (mut state, mut copy, mut size): (FmuState, FmuState, usize) = (null_mut(), null_mut(), 0);
            assert_eq!(fmi3GetFMUState(c, &mut state), Status::Ok);
            assert_eq!(fmi3SerializedFMUStateSize(c, state, &mut size), Status::Ok);
            let mut bytes = vec![0u8; size];
            assert_eq!(fmi3SerializeFMUState(c, state, bytes.as_mut_ptr(), size), Status::Ok);
            let here = get(c, &names);
            let mut ends = Vec::new();
            for way in 0..3 {
                match way {
                    1 => assert_eq!(fmi3SetFMUState(c, state), Status::Ok),
                    2 => {
                        assert_eq!(fmi3Reset(c), Status::Ok);
                        assert_eq!(fmi3DeserializeFMUState(c, bytes.as_ptr(), size, &mut copy), Status::Ok);
                        assert_eq!(fmi3SetFMUState(c, copy), Status::Ok);
                        assert_eq!(get(c, &names), here);
                    }
                    _ => {}
                }
                match phase {
                    0 => assert!(handle_event(c)),
                    1 => assert_eq!(update(c).1[3], 1),
                    2 => assert_eq!(update(c).1[3], 0),
                    _ => {}
                }
                if matches!(phase, 1 | 2) {
                    assert_eq!(fmi3EnterStepMode(c), Status::Ok);
                }
                let end = advance(c, last, 0.05);
                ends.push((end.0, end.1, end.2.to_bits(), get(c, &names).map(f64::to_bits)));
            }
            assert!(ends[0] == ends[1] && ends[0] == ends[2], "{phase}: {ends:?}");
            // An instance without event mode takes none but states of step mode without an event.
            let before = get(plain, &names);
            assert_eq!(fmi3SetFMUState(plain, state), if phase == 3 { Status::Ok } else { Status::Error }, "{phase}");
            assert!(phase == 3 || get(plain, &names) == before);
            assert_eq!(fmi3SetFMUState(c, state), Status::Ok);
            assert_eq!(fmi3FreeFMUState(c, &mut state), Status::Ok);
            assert_eq!(fmi3FreeFMUState(c, &mut copy), Status::Ok);
            match phase {
                0 => assert_eq!(fmi3EnterEventMode(c), Status::Ok),
                1 => assert_eq!(update(c).1[3], 1),
                2 => {
                    assert_eq!(fmi3EnterStepMode(c), Status::Ok);
                    assert_eq!(advance(c, last, 1e-3).0, Status::Ok);
                    last += 1e-3;
                }
                _ => {}
            }
        }
    }
    free(c);
    free(plain);
}

/// A refused call changes nothing.
#[test]
fn calls_are_legal_in_their_phases_only() {
    let names = references(["crank.angle", "crank.speed", "time"]);
    let [force] = references(["actuator.force"]);
    let c = initializing(WITH_EVENTS);
    // SAFETY: the instance is valid until it is freed, all arrays have the lengths told.
    unsafe {
        assert_eq!(fmi3EvaluateDiscreteStates(c), Status::Ok);
        assert_eq!((fmi3EnterEventMode(c), fmi3EnterStepMode(c)), (Status::Error, Status::Error));
        assert_eq!(update(c), (Status::Error, [7; 5]));
        assert_eq!(fmi3ExitInitializationMode(c), Status::Ok);
        // Event mode.
        let before = get(c, &names);
        assert_eq!(advance(c, 0.0, 0.1).0, Status::Error);
        assert_eq!((fmi3EnterEventMode(c), fmi3EvaluateDiscreteStates(c)), (Status::Error, Status::Ok));
        assert_eq!(fmi3GetOutputDerivatives(c, &names[0], 1, &1, &mut 0.0, 1), Status::Error);
        assert_eq!(fmi3GetDirectionalDerivative(c, &names[1], 1, &force, 1, &1.0, 1, &mut 0.0, 1), Status::Ok);
        assert_eq!(fmi3SetFloat64(c, &force, 1, &30_000.0, 1), Status::Ok);
        let (mut flags, nowhere) = ([7; 5], null_mut());
        let [a, b, d, e, _] = &mut flags;
        assert_eq!(fmi3UpdateDiscreteStates(c, a, b, d, e, nowhere, &mut 0.0), Status::Error);
        assert_eq!((flags, get(c, &names)), ([7; 5], before));
        assert_eq!(update(c).0, Status::Ok);
        assert_eq!(fmi3EnterStepMode(c), Status::Ok);
        // Step mode, and after a step that has ended at an event.
        assert_eq!(
            (update(c).0, fmi3EnterStepMode(c), fmi3EvaluateDiscreteStates(c)),
            (Status::Error, Status::Error, Status::Error)
        );
        let last = advance(c, 0.0, 0.2).2;
        let before = get(c, &names);
        assert_eq!(advance(c, last, 0.1), (Status::Error, [0, 0], last));
        assert_eq!(fmi3EnterEventMode(c), Status::Ok);
        assert_eq!(fmi3EnterStepMode(c), Status::Error);
        assert_eq!(get(c, &names), before);
        assert_eq!(fmi3Terminate(c), Status::Ok);
        assert_eq!(
            (update(c).0, fmi3EnterStepMode(c), fmi3EnterEventMode(c)),
            (Status::Error, Status::Error, Status::Error)
        );
        free(c);
        // Without event mode.
        let c = started(Usage::default(), &[]);
        assert_eq!(fmi3EnterEventMode(c), Status::Error);
        assert_eq!(advance(c, 0.0, 0.1).0, Status::Ok);
        free(c);
    }
}

/// However short a step is, it is done: at the start, on the way, and next to an event, which comes with its time.
#[test]
fn a_step_of_any_length_is_done_in_event_mode() {
    const HYDRAULIC: &str =
        include_str!("../../../modelDescription/LandingGearRetractionHydraulic/resources/mechanism.json");
    // Without the ramp, on which the command would be clipped.
    let hydraulic = HYDRAULIC.replace("\"ramp_amplitude\": 0.65", "\"ramp_amplitude\": 0");
    for (definition, drive, value) in [(GEAR, "actuator.force", 30_000.0), (&hydraulic, "valve.command", 1.0)] {
        let load = || Ok(Component::from_definition("mechanism.json", definition)?.into());
        let c = handle::instantiate(VERSION, "instantiate", c"gear", Logger::new(None, false), WITH_EVENTS, load);
        let names = references_of(definition, ["crank.angle", "crank.speed", "time"]);
        let drive = references_of(definition, [drive]);
        // SAFETY: the instance is valid.
        unsafe {
            assert_eq!(fmi3EnterInitializationMode(c, 0, 0.0, 0.0, 0, 0.0), Status::Ok);
            assert_eq!(fmi3ExitInitializationMode(c), Status::Ok);
            assert_eq!(fmi3SetFloat64(c, drive.as_ptr(), 1, &value, 1), Status::Ok);
            assert_eq!((update(c), fmi3EnterStepMode(c)), ((Status::Ok, [0; 5]), Status::Ok));
        }
        let (mut point, mut events) = (0.0, 0);
        for part in [0.0, 0.02, 10.0, 0.01, 10.0] {
            if part > 0.0 {
                let (status, [event, _], last) = advance(c, point, part);
                assert_eq!(status, Status::Ok);
                (point, events) = (last, events + u32::from(event));
                if event == 1 {
                    // Nothing comes before an event, however short.
                    assert_eq!(advance(c, point, 5e-324).0, Status::Error);
                    handle_event(c);
                }
            }
            for exponent in [324, 310, 300, 200, 100, 51, 49, 30, 20] {
                let (before, h) = (get(c, &names), 10_f64.powi(-exponent).max(5e-324));
                assert_eq!(advance(c, point, h), (Status::Ok, [0; 2], point + h), "{h:e} at {point}");
                point += h;
                let after = get(c, &names);
                let is_same = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-11 * (1.0 + a.abs());
                assert!(before.iter().zip(&after).all(is_same), "{h:e} at {point}: {before:?} {after:?}");
            }
        }
        assert!(events > 0);
        free(c);
    }
}
