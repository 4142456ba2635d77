//! The functions of FMI 3.0 as a host calls them, against the same calls of FMI 2.0.
#![allow(clippy::unwrap_used)]
mod events;
mod exchange;
mod messages;
mod updates;
mod vectors;

use super::types::{FmuState, Instance, Status, ValueReference};
use super::*;
use crate::component::Component;
use crate::fmi::{event_mode::Usage, handle, logger::Logger};
use crate::fmi2::types::Status as Status2;
use crate::fmi2::{
    fmi2DoStep, fmi2EnterInitializationMode, fmi2ExitInitializationMode, fmi2FreeInstance,
    fmi2GetDirectionalDerivative, fmi2GetReal, fmi2SetReal, fmi2SetupExperiment,
};
use crate::mechanism::GEAR;
use std::ptr::{null, null_mut};

/// An instance of the landing gear, without event mode.
fn gear() -> Instance {
    gear_for(Usage::default())
}

/// An instance of the landing gear for a host of this usage.
fn gear_for(usage: Usage) -> Instance {
    let load = || Ok(Component::from_definition("mechanism.json", GEAR)?.into());
    handle::instantiate(VERSION, "instantiate", c"gear", Logger::new(None, false), usage, load)
}

/// Value references of variables of the landing gear; the time's is the number of variables, and vectors follow.
fn references<const N: usize>(names: [&str; N]) -> [ValueReference; N] {
    references_of(GEAR, names)
}

fn references_of<const N: usize>(definition: &str, names: [&str; N]) -> [ValueReference; N] {
    let model = Component::from_definition("mechanism.json", definition).unwrap();
    let list = model.interface().list();
    let vectors = model.vectors();
    let all = list.iter().map(|v| &*v.name).chain(["time"]).chain(vectors.iter().map(|vector| &*vector.name));
    let all: Vec<&str> = all.collect();
    names.map(|name| all.iter().position(|other| *other == name).unwrap() as ValueReference)
}

fn get<const N: usize>(c: Instance, references: &[ValueReference; N]) -> [f64; N] {
    let mut values = [f64::NAN; N];
    // SAFETY: the instance is valid, the arrays have N elements.
    let status = unsafe { fmi3GetFloat64(c, references.as_ptr(), N, values.as_mut_ptr(), N) };
    assert_eq!(status, Status::Ok);
    values
}

/// A step; the time reached.
fn step(c: Instance, point: f64, h: f64) -> (Status, f64) {
    let (mut flags, mut last) = ([7; 3], f64::NAN);
    let [event, terminate, early] = &mut flags;
    // SAFETY: the instance is valid, each pointer leads to one value.
    let status = unsafe { fmi3DoStep(c, point, h, 1, event, terminate, early, &mut last) };
    assert_eq!(flags, [0; 3]);
    (status, last)
}

fn initialized() -> Instance {
    let c = gear();
    // SAFETY: the instance is valid.
    unsafe {
        assert_eq!(fmi3EnterInitializationMode(c, 1, 1e-9, 0.0, 0, 0.0), Status::Ok);
        assert_eq!(fmi3ExitInitializationMode(c), Status::Ok);
    }
    c
}

#[test]
fn a_retraction_has_the_bits_of_fmi_2() {
    let names = references(["crank.angle", "joint2.force", "energy.drift"]);
    let [force, time] = references(["actuator.force", "time"]);
    let (c, other) = (gear(), gear());
    // SAFETY: both instances are valid until they are freed, all arrays have the lengths told.
    unsafe {
        assert_eq!(fmi2SetupExperiment(other, 1, 1e-9, 0.0, 0, 0.0), Status2::Ok);
        assert_eq!(fmi2EnterInitializationMode(other), Status2::Ok);
        assert_eq!(fmi3EnterInitializationMode(c, 1, 1e-9, 0.0, 0, 0.0), Status::Ok);
        assert_eq!(fmi2ExitInitializationMode(other), Status2::Ok);
        assert_eq!(fmi3ExitInitializationMode(c), Status::Ok);
        for n in 0..130 {
            let (point, h) = (f64::from(n) * 1e-3, 1e-3);
            let value = [30_000.0 + f64::from(n / 7)];
            assert_eq!(fmi2SetReal(other, &force, 1, value.as_ptr()), Status2::Ok);
            assert_eq!(fmi3SetFloat64(c, &force, 1, value.as_ptr(), 1), Status::Ok);
            assert_eq!(fmi2DoStep(other, point, h, 1), Status2::Ok);
            assert_eq!(step(c, point, h), (Status::Ok, point + h));
            let mut values = [0.0; 3];
            assert_eq!(fmi2GetReal(other, names.as_ptr(), 3, values.as_mut_ptr()), Status2::Ok);
            assert_eq!(get(c, &names).map(f64::to_bits), values.map(f64::to_bits));
            assert_eq!(get(c, &[names[0], time, force]), [values[0], point + h, value[0]]);
        }
        assert_eq!(fmi3Terminate(c), Status::Ok);
        fmi2FreeInstance(other);
        fmi3FreeInstance(c);
    }
}

/// y' J x from both sides.
#[test]
fn adjoint_and_directional_derivatives_agree() {
    let unknowns = references(["crank.acceleration", "joint1.force", "actuator.static_load"]);
    let knowns = references(["actuator.force", "load_factor"]);
    let (left, right) = ([0.3, -2.0, 1.7], [5.0, -0.7]);
    let c = initialized();
    step(c, 0.0, 0.03);
    let (mut along, mut back, mut reference) = ([0.0; 3], [0.0; 2], [0.0; 3]);
    // SAFETY: the instance is valid until it is freed, all arrays have the lengths told.
    unsafe {
        let (u, k) = (unknowns.as_ptr(), knowns.as_ptr());
        assert_eq!(fmi3GetDirectionalDerivative(c, u, 3, k, 2, right.as_ptr(), 2, along.as_mut_ptr(), 3), Status::Ok);
        assert_eq!(fmi3GetAdjointDerivative(c, u, 3, k, 2, left.as_ptr(), 3, back.as_mut_ptr(), 2), Status::Ok);
        assert_eq!(fmi2GetDirectionalDerivative(c, u, 3, k, 2, right.as_ptr(), reference.as_mut_ptr()), Status2::Ok);
        assert_eq!(along.map(f64::to_bits), reference.map(f64::to_bits));
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let (one, other) = (dot(&left, &along), dot(&back, &right));
        assert!(one != 0.0 && (one - other).abs() < 1e-12 * one.abs(), "{one} {other}");
        fmi3FreeInstance(c);
    }
}

#[test]
fn a_state_goes_on_with_the_same_bits() {
    let names = references(["crank.angle", "crank.speed", "time"]);
    let c = initialized();
    let (mut state, mut copy, mut size): (FmuState, FmuState, usize) = (null_mut(), null_mut(), 0);
    step(c, 0.0, 0.01);
    // SAFETY: the instance and the states are valid until they are freed.
    unsafe {
        assert_eq!(fmi3GetFMUState(c, &mut state), Status::Ok);
        assert_eq!(fmi3SerializedFMUStateSize(c, state, &mut size), Status::Ok);
        let mut bytes = vec![0u8; size];
        assert_eq!(fmi3SerializeFMUState(c, state, bytes.as_mut_ptr(), size), Status::Ok);
        step(c, 0.01, 0.02);
        let there = get(c, &names);
        for which in 0..2 {
            if which == 1 {
                assert_eq!(fmi3DeserializeFMUState(c, bytes.as_ptr(), size, &mut copy), Status::Ok);
            }
            assert_eq!(fmi3SetFMUState(c, if which == 0 { state } else { copy }), Status::Ok);
            assert_eq!(step(c, 0.01, 0.02), (Status::Ok, 0.03));
            assert_eq!(get(c, &names).map(f64::to_bits), there.map(f64::to_bits));
        }
        assert_eq!(fmi3FreeFMUState(c, &mut state), Status::Ok);
        assert_eq!(fmi3FreeFMUState(c, &mut copy), Status::Ok);
        assert!(state.is_null() && copy.is_null());
        fmi3FreeInstance(c);
    }
}

#[test]
fn what_is_wrong_is_refused_and_changes_nothing() {
    let [angle, force, time] = references(["crank.angle", "actuator.force", "time"]);
    let c = initialized();
    let before = get(c, &[angle, time]);
    let mut value = [0.0; 2];
    // SAFETY: the instance is valid until it is freed, all arrays that are not NULL have the lengths told.
    unsafe {
        assert_eq!(fmi3GetFloat64(c, [angle, force].as_ptr(), 2, value.as_mut_ptr(), 1), Status::Error);
        assert_eq!(fmi3GetFloat64(c, null(), 1, value.as_mut_ptr(), 1), Status::Error);
        assert_eq!(fmi3GetFloat64(c, &(time + 1000), 1, value.as_mut_ptr(), 1), Status::Error);
        for vr in [angle, time] {
            assert_eq!(fmi3SetFloat64(c, &vr, 1, value.as_ptr(), 1), Status::Error);
        }
        assert_eq!(fmi3SetFloat64(c, &force, 1, [f64::NAN].as_ptr(), 1), Status::Error);
        assert_eq!(fmi3GetInt32(c, &force, 1, [0].as_mut_ptr(), 1), Status::Error);
        assert_eq!(fmi3GetInt32(c, null(), 0, null_mut(), 0), Status::Ok);
        assert_eq!(fmi3GetClock(c, &force, 1, [0].as_mut_ptr()), Status::Error);
        assert_eq!(fmi3EnterEventMode(c), Status::Error);
        assert_eq!(fmi3GetNumberOfContinuousStates(c, &mut 0), Status::Error);
        assert_eq!(fmi3EnterInitializationMode(c, 0, 0.0, 0.0, 0, 0.0), Status::Error);
        assert_eq!(fmi3DoStep(c, 0.0, 1e-3, 1, null_mut(), null_mut(), null_mut(), null_mut()), Status::Error);
        assert_eq!(step(c, 0.5, 1e-3), (Status::Error, 0.0));
        assert_eq!(get(c, &[angle, time]), before);
        assert_eq!(fmi3GetVersion().cast::<u8>().read(), b'3');
        fmi3FreeInstance(c);
        assert_eq!(fmi3Terminate(null_mut()), Status::Error);
        fmi3FreeInstance(null_mut());
    }
}

/// `fmi3FunctionTypes.h`, 3.0.2, has 75 functions; hosts look all of them up.
#[test]
fn all_functions_of_the_standard_are_exported() {
    let exchange = super::exchange::FUNCTIONS;
    let tables = [super::functions::FUNCTIONS, exchange, absent::FUNCTIONS, absent::types_of_no_variable::FUNCTIONS];
    let names: std::collections::BTreeSet<_> = tables.into_iter().flatten().map(|function| function.name).collect();
    // Besides: the version, three ways to instantiate, the end of an instance, the step.
    assert_eq!(names.len() + 6, 75);
    assert!(names.iter().all(|name| name.starts_with("fmi3")));
}
