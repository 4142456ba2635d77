//! Values, times and resets as a host uses them. The tests in `hostile` cover statuses and messages of all functions.

use crate::host::Gear;
use linkage_fmu::fmi2::types::Status;
use linkage_fmu::fmi2::*;
use std::ffi::CStr;
use std::ptr::null;

const H: f64 = 1e-3;

#[test]
fn any_number_but_zero_is_true() {
    let gear = Gear::stepping(0.0, None);
    let (engage, mut value) = (gear.vr("uplock.engage"), 7);
    // SAFETY: one reference and one value each.
    unsafe {
        assert_eq!(fmi2SetBoolean(gear.c, &engage, 1, &-1), Status::Ok);
        assert_eq!(fmi2GetBoolean(gear.c, &engage, 1, &mut value), Status::Ok);
        assert_eq!(fmi2SetReal(gear.c, &engage, 1, &1.0), Status::Error);
    }
    assert_eq!(value, 1);
}

#[test]
fn the_tolerance_of_the_experiment_wins_over_the_parameter() {
    let gear = Gear::new();
    assert_eq!(gear.set_up(Some(1e-8), -1.0, Some(1.0)), Status::Ok);
    assert_eq!(gear.get("solver.tolerance"), Ok(1e-8));
    assert_eq!(gear.set("solver.tolerance", 1e-3), Status::Ok);
    assert_eq!(gear.initialize(), Status::Ok);
    assert_eq!(gear.get("solver.tolerance"), Ok(1e-8));
}

/// Some importers pass the tolerance 0 if the user has stated none.
#[test]
fn a_tolerance_of_0_is_ignored_with_a_warning() {
    let gear = Gear::new();
    assert_eq!(gear.set("solver.tolerance", 1e-3), Status::Ok);
    gear.log.take();
    assert_eq!(gear.set_up(Some(0.0), 0.0, None), Status::Ok);
    let line = gear.log.take().pop().unwrap();
    assert!(format!("{line:?}").contains("tolerance is 0, which counts as no tolerance"), "{line:?}");
    assert_eq!(gear.initialize(), Status::Ok);
    assert_eq!(gear.get("solver.tolerance"), Ok(1e-3));
}

#[test]
fn enumerations_are_set_read_and_reset() {
    let gear = Gear::new();
    assert_eq!(gear.get_item("solver.method"), Ok("reduced"));
    assert_eq!(gear.set_item("solver.method", "rigid_fem"), Status::Ok);
    assert_eq!(gear.get_item("solver.method"), Ok("rigid_fem"));
    for bad in [0, -1, 3, i32::MIN, i32::MAX] {
        gear.log.take();
        assert_eq!(gear.set_number("solver.method", bad), Status::Error);
        let expected = format!("fmi2SetInteger: solver.method = {bad}: must be 1 (reduced) or 2 (rigid_fem)");
        assert_eq!(gear.refusal(), expected);
    }
    let method = gear.vr("solver.method");
    // SAFETY: every array has the length that is passed.
    unsafe {
        // All values are set or none: a valid number before a Real, an unknown reference, a computed Enumeration, an
        // invalid number.
        for (second, number) in
            [(gear.vr("crank.length"), 1), (gear.count(), 1), (gear.vr("contact.mode"), 1), (method, 7)]
        {
            assert_eq!(fmi2SetInteger(gear.c, [method, second].as_ptr(), 2, [1, number].as_ptr()), Status::Error);
        }
        assert_eq!(gear.get_item("solver.method"), Ok("rigid_fem"));
        assert_eq!(
            fmi2GetInteger(gear.c, [method, gear.vr("crank.angle")].as_ptr(), 2, [0; 2].as_mut_ptr()),
            Status::Error
        );
        assert_eq!(fmi2GetReal(gear.c, &method, 1, &mut 0.0), Status::Error);
        assert_eq!(fmi2SetReal(gear.c, &method, 1, &0.0), Status::Error);
        assert_eq!(gear.initialize(), Status::Ok);
        gear.log.take();
        assert_eq!(gear.set_item("solver.method", "reduced"), Status::Error);
        assert!(gear.refusal().contains("'solver.method'"));
        assert_eq!(gear.step(0.0, H), Status::Ok);
        assert_eq!(gear.get_item("solver.method"), Ok("rigid_fem"));
        assert_eq!(gear.reset(), Status::Ok);
    }
    assert_eq!(gear.get_item("solver.method"), Ok("reduced"));
}

#[test]
fn time_starts_at_any_sign_and_is_reported() {
    for start in [-5.0, 0.0, 3.5] {
        let gear = Gear::stepping(start, None);
        assert_eq!(gear.step(start, H), Status::Ok);
        let (mut time, mut status, mut terminated) = (f64::NAN, Status::Fatal, 7);
        // SAFETY: room for one value each.
        unsafe {
            assert_eq!(fmi2GetRealStatus(gear.c, 2, &mut time), Status::Ok);
            assert_eq!(fmi2GetStatus(gear.c, 0, &mut status), Status::Ok);
            assert_eq!(fmi2GetBooleanStatus(gear.c, 3, &mut terminated), Status::Ok);
            assert_eq!((time, status, terminated), (start + H, Status::Ok, 0));
            assert_eq!(fmi2GetRealStatus(gear.c, 0, &mut time), Status::Discard);
            assert_eq!(fmi2GetIntegerStatus(gear.c, 2, &mut 0), Status::Discard);
            assert_eq!(fmi2GetStringStatus(gear.c, 1, &mut null()), Status::Discard);
            assert_eq!(fmi2GetStatus(gear.c, 17, &mut status), Status::Error);
            assert_eq!(fmi2CancelStep(gear.c), Status::Error);
        }
    }
}

#[test]
fn impossible_parameters_are_rejected_and_can_be_corrected() {
    let gear = Gear::new();
    let length = gear.get("crank.length").unwrap();
    assert_eq!(gear.set("crank.length", 100.0), Status::Ok);
    assert_eq!(gear.enter(), Status::Ok);
    assert_eq!(gear.get("crank.angle"), Err(Status::Error));
    assert_eq!(gear.exit(), Status::Error);
    assert_eq!(gear.set("crank.length", length), Status::Ok);
    assert_eq!(gear.exit(), Status::Ok);
    assert_eq!(gear.step(0.0, H), Status::Ok);
}

#[test]
fn reset_gives_a_fresh_instance() {
    let (gear, fresh) = (Gear::stepping(2.0, Some(2.5)), Gear::stepping(0.0, None));
    assert_eq!(gear.set("actuator.force", 1.0), Status::Ok);
    assert_eq!(gear.step(2.0, H), Status::Ok);
    assert_eq!(gear.reset(), Status::Ok);
    assert_eq!(gear.step(0.0, H), Status::Error);
    assert_eq!(gear.initialize(), Status::Ok);
    for n in 0..5 {
        assert_eq!((gear.step(f64::from(n) * H, H), fresh.step(f64::from(n) * H, H)), (Status::Ok, Status::Ok));
    }
    assert_eq!(gear.get("actuator.force"), fresh.get("actuator.force"));
    assert_eq!(gear.get("crank.angle"), fresh.get("crank.angle"));
}

#[test]
fn static_strings_are_those_of_the_headers() {
    // SAFETY: both are static strings.
    unsafe {
        assert_eq!(CStr::from_ptr(fmi2GetTypesPlatform()), c"default");
        assert_eq!(CStr::from_ptr(fmi2GetVersion()), c"2.0");
    }
}
