//! Every function in every phase: the status, the log line, and an unchanged instance after a rejected call.

use super::calls::{self, Call, Target};
use super::standard::{ALWAYS, PHASES, Phase, TABLE, is_legal};
use crate::host::Gear;
use linkage_fmu::fmi2::types::Status;
use linkage_fmu::fmi2::*;
use std::collections::BTreeSet;
use std::ptr::null_mut;

const H: f64 = 1e-3;
/// A force with which no step of the integration keeps the tolerance.
const ABSURD: f64 = 1e300;

/// An instance in a phase, with an empty log.
fn in_phase(phase: Phase) -> Gear {
    let gear = Gear::new();
    if phase != Phase::Instantiated {
        assert_eq!(gear.set_up(None, 0.0, None), Status::Ok);
        assert_eq!(gear.enter(), Status::Ok);
    }
    if matches!(phase, Phase::Step | Phase::Failed | Phase::Terminated) {
        assert_eq!(gear.exit(), Status::Ok);
    }
    match phase {
        Phase::Failed => {
            assert_eq!(gear.set("actuator.force", ABSURD), Status::Ok);
            assert_eq!(gear.step(0.0, H), Status::Error);
        }
        Phase::Terminated => assert_eq!(gear.terminate(), Status::Ok),
        _ => {}
    }
    gear.log.take();
    gear
}

/// All variables at the end of the remaining phases, and again after a reset.
fn remaining_phases(gear: &Gear, phase: Phase) -> [Vec<(Status, u64)>; 2] {
    [phase, Phase::Instantiated].map(|phase| {
        if phase == Phase::Instantiated {
            assert_eq!(gear.reset(), Status::Ok);
            assert_eq!(gear.set_up(None, 0.0, None), Status::Ok);
            assert_eq!(gear.enter(), Status::Ok);
        }
        if matches!(phase, Phase::Instantiated | Phase::Initialization) {
            assert_eq!(gear.exit(), Status::Ok);
        }
        if !matches!(phase, Phase::Failed | Phase::Terminated) {
            (0..3).for_each(|n| assert_eq!(gear.step(f64::from(n) * H, H), Status::Ok));
        }
        gear.all_bits()
    })
}

/// Parts of the message of a call that is rejected for its arguments.
fn names(call: &Call, gear: &Gear) -> Vec<String> {
    match call.what {
        "unknown" if call.function.ends_with("tReal") => vec![gear.count().to_string(), " to ".into()],
        "unknown" => vec![gear.count().to_string()],
        "largest reference" => vec![u32::MAX.to_string()],
        "a Real" => vec!["'actuator.force'".into(), "is a Real".into()],
        "NULL" | "NULL references" | "NULL values" | "NULL categories" => vec!["NULL".into()],
        _ => Vec::new(),
    }
}

/// Part of the message of a call in a wrong phase, for functions that are legal in another phase.
fn phase_of(call: &Call, phase: Phase) -> Vec<String> {
    let word = ["instantiated", "initialization mode", "step mode", "step failed", "terminated"][phase as usize];
    if call.statuses.contains('O') { vec![word.into()] } else { Vec::new() }
}

/// Make the call, and check its status and the log against the standard.
fn check(call: &Call, phase: Phase, gear: &Gear) -> Status {
    let name = format!("{} ({}) in {phase:?}", call.function, call.what);
    let status = (call.run)(&Target::of(gear));
    assert_eq!(status, call.expected(phase), "{name}: {:?}", gear.log.take());
    let messages = gear.log.take();
    if status == Status::Ok {
        // The log may contain events and warnings only.
        assert!(messages.iter().all(|m| m.status < Status::Discard as i32), "{name}: {messages:?}");
        return status;
    }
    assert_eq!(messages.len(), 1, "{name}: {messages:?}");
    let category = if status == Status::Discard { "logStatusDiscard" } else { "logStatusError" };
    assert_eq!((messages[0].status, messages[0].category.as_str()), (status as i32, category), "{name}");
    assert!(messages[0].text.starts_with(&format!("{}: ", call.function)), "{name}: {messages:?}");
    assert!(!messages[0].text.contains('\n'), "{name}: {messages:?}");
    if status == Status::Error {
        let named = if is_legal(call.function, phase) { names(call, gear) } else { phase_of(call, phase) };
        assert!(named.iter().all(|part| messages[0].text.contains(part)), "{name}: {messages:?} lacks {named:?}");
    }
    status
}

#[test]
fn every_function_is_called() {
    let called: BTreeSet<_> = calls::all().iter().map(|call| call.function).chain(ALWAYS).collect();
    let standard: BTreeSet<_> = TABLE.iter().map(|(name, _)| *name).chain(ALWAYS).collect();
    assert_eq!(called, standard);
    assert_eq!(calls::text_functions().map(|f| f().is_null()), [false; 2]);
}

/// The table of the calls does not contradict the standard's table.
#[test]
fn no_call_is_expected_to_succeed_outside_its_phase() {
    for call in calls::all() {
        for phase in PHASES {
            let fine = call.expected(phase) == Status::Error || is_legal(call.function, phase);
            assert!(fine, "{} ({}) in {phase:?}", call.function, call.what);
        }
    }
}

#[test]
fn a_rejected_call_has_its_status_and_a_message_and_changes_nothing() {
    for phase in PHASES {
        let gear = in_phase(phase);
        let before = gear.all_bits();
        for call in calls::all().iter().filter(|call| call.expected(phase) != Status::Ok) {
            check(call, phase, &gear);
            assert_eq!(gear.all_bits(), before, "{} ({}) in {phase:?}", call.function, call.what);
        }
        assert_eq!(remaining_phases(&gear, phase), remaining_phases(&in_phase(phase), phase), "{phase:?}");
    }
}

#[test]
fn an_accepted_call_has_its_status_and_no_error_message() {
    for phase in PHASES {
        for call in calls::all().iter().filter(|call| call.expected(phase) == Status::Ok) {
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
        assert_eq!(remaining_phases(&gear, phase), remaining_phases(&in_phase(phase), phase), "{phase:?}");
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
        // SAFETY: NULL, or an address that belongs to no instance.
        unsafe { fmi2FreeInstance(c) };
    }
    assert!(gear.log.take().iter().all(|message| message.category == "logEvents"));
}
