//! Messages contain the types and functions of the FMI version of the host.
use crate::Fmu;
use crate::fmi2::Gear;
use linkage_fmu::fmi2::host::Message;
use linkage_fmu::fmi2::{
    fmi2GetBoolean, fmi2GetDirectionalDerivative, fmi2GetInteger, fmi2GetRealOutputDerivatives, fmi2SetString,
};
use linkage_fmu::fmi3::host::Wishes;
use linkage_fmu::fmi3::{fmi3GetInt32, fmi3SetString, fmi3SetUInt8};
use std::ptr::null;

/// Each message contains the expected types.
fn assert_says(lines: &[Message], expected: &[(&str, &str)], foreign: &[&str]) {
    assert_eq!(lines.len(), expected.len(), "{lines:#?}");
    for (line, (function, words)) in lines.iter().map(|message| &message.text).zip(expected) {
        assert!(line.starts_with(function) && line.contains(words), "{line}");
        assert!(!foreign.iter().any(|word| line.contains(word)), "{line}");
    }
}

#[test]
fn each_version_names_its_own_types_and_functions() {
    let gear = Fmu::gear(Wishes { logging: true, ..Wishes::default() });
    let [angle, stop, force, end] = gear.vrs(["crank.angle", "upstop.enabled", "actuator.force", "time"]);
    let (absent, mut number) = (end + 1000, [0.0]);
    gear.log.take();
    gear.boolean(angle, &mut 0);
    // SAFETY: the instance is valid, all arrays have the lengths that are passed.
    unsafe {
        fmi3GetInt32(gear.instance(), &angle, 1, [0].as_mut_ptr(), 1);
        fmi3SetUInt8(gear.instance(), &stop, 1, [0].as_ptr(), 1);
        fmi3SetString(gear.instance(), &force, 1, [null()].as_ptr(), 1);
    }
    gear.set_reals(&[absent], &number);
    gear.terminate();
    gear.enter(None, 0.0, None);
    gear.output_derivatives(&[absent], &[1], &mut number);
    gear.derivative(false, &[angle], &[absent], &[1.0], &mut number);
    gear.derivative(true, &[absent], &[force], &[1.0], &mut number);
    let expected = [
        ("fmi3GetBoolean: ", "is a Float64, not a Boolean; value references of Boolean variables: "),
        ("fmi3GetInt32: ", "is a Float64, not a Int32; value references of Int32 variables: there are none"),
        ("fmi3SetUInt8: ", "is a Boolean, not a UInt8; value references of UInt8 variables: there are none"),
        ("fmi3SetString: ", "is a Float64, not a String; "),
        ("fmi3SetFloat64: ", "does not exist; value references of Float64 variables: "),
        ("fmi3Terminate: ", "not allowed"),
        ("fmi3GetOutputDerivatives: ", "does not exist; value references of Float64 variables: "),
        ("fmi3GetDirectionalDerivative: ", "does not exist; value references of Float64 variables: "),
        ("fmi3GetAdjointDerivative: ", "does not exist; value references of Float64 variables: "),
    ];
    assert_says(&gear.log.take(), &expected, &["Real", "fmi2"]);

    let gear = Gear::new();
    gear.log.take();
    // SAFETY: as above.
    unsafe {
        fmi2GetBoolean(gear.c, &angle, 1, [0].as_mut_ptr());
        fmi2GetInteger(gear.c, &angle, 1, [0].as_mut_ptr());
        fmi2SetString(gear.c, &force, 1, [null()].as_ptr());
        gear.set_reals(&[absent], &number);
        gear.terminate();
        gear.set_up(None, 0.0, None);
        gear.enter();
        fmi2GetRealOutputDerivatives(gear.c, &absent, 1, [1].as_ptr(), number.as_mut_ptr());
        fmi2GetDirectionalDerivative(gear.c, &absent, 1, &force, 1, [1.0].as_ptr(), number.as_mut_ptr());
    }
    let expected = [
        ("fmi2GetBoolean: ", "is a Real, not a Boolean; value references of Boolean variables: "),
        ("fmi2GetInteger: ", "is a Real, not a Enumeration; value references of Enumeration variables: "),
        ("fmi2SetString: ", "is a Real, not a String; "),
        ("fmi2SetReal: ", "does not exist; value references of Real variables: "),
        ("fmi2Terminate: ", "not allowed"),
        ("fmi2GetRealOutputDerivatives: ", "does not exist; value references of Real variables: "),
        ("fmi2GetDirectionalDerivative: ", "does not exist; value references of Real variables: "),
    ];
    assert_says(&gear.log.take(), &expected, &["Float64", "Int32", "fmi3"]);
}
