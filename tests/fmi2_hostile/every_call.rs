//! Every function in every phase: the status, the log line, and an instance that is as it was.

use crate::calls::{self, Call, Target};
use crate::fmi2_host::Gear;
use crate::standard::{ALWAYS, PHASES, Phase, TABLE, is_legal};
use linkage_fmu::fmi2::types::Status;
use linkage_fmu::fmi2::*;
use std::collections::BTreeSet;
use std::ptr::null_mut;

const H: f64 = 1e-3;
/// A force under which no step of the integration meets the tolerance.
const ABSURD: f64 = 1e300;

/// An instance in a phase, the log emptied.
fn in_phase(phase: Phase) -> Gear {
    let gear = Gear::new();
    // SAFETY: the component is valid.
    unsafe {
        if phase != Phase::Instantiated {
            assert_eq!(fmi2SetupExperiment(gear.c, 0, 0.0, 0.0, 0, 0.0), Status::Ok);
            assert_eq!(fmi2EnterInitializationMode(gear.c), Status::Ok);
        }
        if matches!(phase, Phase::Step | Phase::Failed | Phase::Terminated) {
            assert_eq!(fmi2ExitInitializationMode(gear.c), Status::Ok);
        }
        match phase {
            Phase::Failed => {
                assert_eq!(gear.set("actuator.force", ABSURD), Status::Ok);
                assert_eq!(gear.step(0.0, H), Status::Error);
            }
            Phase::Terminated => assert_eq!(fmi2Terminate(gear.c), Status::Ok),
            _ => {}
        }
    }
    gear.log.take();
    gear
}

/// Every variable's status and bits.
fn snapshot(gear: &Gear) -> Vec<(Status, u64)> {
    let read = |reference: u32| {
        let mut value = 0.0;
        // SAFETY: one reference, room for one value.
        let status = unsafe { fmi2GetReal(gear.c, &reference, 1, &mut value) };
        (status, if status == Status::Ok { value.to_bits() } else { 0 })
    };
    let all = (0..gear.count()).map(read).collect();
    gear.log.take();
    all
}

/// What an instance does from here on: through the phases that are left, and after a reset.
fn rest_of_life(gear: &Gear, phase: Phase) -> Vec<Vec<(Status, u64)>> {
    let mut seen = Vec::new();
    // SAFETY: the component is valid.
    unsafe {
        for phase in [phase, Phase::Instantiated] {
            if phase == Phase::Instantiated {
                assert_eq!(fmi2Reset(gear.c), Status::Ok);
                assert_eq!(fmi2SetupExperiment(gear.c, 0, 0.0, 0.0, 0, 0.0), Status::Ok);
                assert_eq!(fmi2EnterInitializationMode(gear.c), Status::Ok);
            }
            if matches!(phase, Phase::Instantiated | Phase::Initialization) {
                assert_eq!(fmi2ExitInitializationMode(gear.c), Status::Ok);
            }
            if !matches!(phase, Phase::Failed | Phase::Terminated) {
                for n in 0..3 {
                    assert_eq!(gear.step(f64::from(n) * H, H), Status::Ok);
                }
            }
            seen.push(snapshot(gear));
        }
    }
    seen
}

fn expected(call: &Call, phase: Phase) -> Status {
    match call.statuses.as_bytes()[phase as usize] {
        b'O' => Status::Ok,
        b'D' => Status::Discard,
        _ => Status::Error,
    }
}

/// Call, and hold status and log against what the standard asks for.
fn check(call: &Call, phase: Phase, gear: &Gear) -> Status {
    let name = format!("{} ({}) in {phase:?}", call.function, call.what);
    let status = (call.run)(&Target::of(gear));
    assert_eq!(status, expected(call, phase), "{name}: {:?}", gear.log.take());
    let messages = gear.log.take();
    if status == Status::Ok {
        // Events and warnings only.
        assert!(messages.iter().all(|m| m.status < Status::Discard as i32), "{name}: {messages:?}");
        return status;
    }
    assert_eq!(messages.len(), 1, "{name}: {messages:?}");
    let category = if status == Status::Discard { "logStatusDiscard" } else { "logStatusError" };
    assert_eq!((messages[0].status, messages[0].category.as_str()), (status as i32, category), "{name}");
    assert!(messages[0].text.starts_with(&format!("{}: ", call.function)), "{name}: {messages:?}");
    assert!(!messages[0].text.contains('\n'), "{name}: {messages:?}");
    status
}

#[test]
fn every_function_is_called() {
    let called: BTreeSet<_> = calls::all().iter().map(|call| call.function).chain(ALWAYS).collect();
    let standard: BTreeSet<_> = TABLE.iter().map(|(name, _)| *name).chain(ALWAYS).collect();
    assert_eq!(called, standard);
    assert_eq!(calls::text_functions().map(|f| f().is_null()), [false; 2]);
}

/// The rows of the calls do not contradict the standard's table.
#[test]
fn nothing_is_expected_to_work_out_of_its_phase() {
    for call in calls::all() {
        for phase in PHASES {
            assert!(
                expected(&call, phase) == Status::Error || is_legal(call.function, phase),
                "{} ({}) in {phase:?}",
                call.function,
                call.what
            );
        }
    }
}

#[test]
fn a_refused_call_has_its_status_and_a_line_and_changes_nothing() {
    for phase in PHASES {
        let gear = in_phase(phase);
        let before = snapshot(&gear);
        for call in calls::all().iter().filter(|call| expected(call, phase) != Status::Ok) {
            check(call, phase, &gear);
            assert_eq!(snapshot(&gear), before, "{} ({}) in {phase:?}", call.function, call.what);
        }
        assert_eq!(rest_of_life(&gear, phase), rest_of_life(&in_phase(phase), phase), "{phase:?}");
    }
}

#[test]
fn an_accepted_call_has_its_status_and_no_complaint() {
    for phase in PHASES {
        for call in calls::all().iter().filter(|call| expected(call, phase) == Status::Ok) {
            check(call, phase, &in_phase(phase));
        }
    }
}

#[test]
fn reading_and_logging_change_nothing() {
    let harmless = |call: &&Call| call.function.starts_with("fmi2Get") || call.function == "fmi2SetDebugLogging";
    for phase in PHASES {
        let gear = in_phase(phase);
        for call in calls::all().iter().filter(harmless) {
            (call.run)(&Target::of(&gear));
        }
        assert_eq!(rest_of_life(&gear, phase), rest_of_life(&in_phase(phase), phase), "{phase:?}");
    }
}

#[test]
fn without_an_instance_every_call_is_an_error() {
    let gear = Gear::new();
    let foreign = [0_u64; 16];
    for c in [null_mut(), foreign.as_ptr().cast_mut().cast(), foreign.as_ptr().wrapping_byte_add(1).cast_mut().cast()] {
        let target = Target::of(&gear).with(c);
        for call in calls::all() {
            assert_eq!((call.run)(&target), Status::Error, "{} ({})", call.function, call.what);
        }
        // SAFETY: NULL, or a word that is none of an instance's.
        unsafe { fmi2FreeInstance(c) };
    }
    assert!(gear.log.take().iter().all(|message| message.category == "logEvents"));
}
