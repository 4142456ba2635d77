//! Messages name the types and functions of the version that the host speaks.

use super::*;
use crate::fmi::version::Version;
use crate::fmi2::{self, fmi2GetBoolean, fmi2GetInteger, fmi2GetRealOutputDerivatives, fmi2SetString, fmi2Terminate};
use std::cell::RefCell;
use std::rc::Rc;

type Lines = Rc<RefCell<Vec<String>>>;

/// An instance of the landing gear of a version, and the messages that it gives.
fn logged(version: Version) -> (Instance, Lines) {
    let lines = Lines::default();
    let kept = Rc::clone(&lines);
    let logger = Logger::new(
        Some(Box::new(move |_, _, message| kept.borrow_mut().push(message.to_string_lossy().into_owned()))),
        true,
    );
    let load = || Ok(Component::from_definition("mechanism.json", GEAR)?.into());
    (handle::instantiate(version, "instantiate", c"gear", logger, Usage::default(), load), lines)
}

/// Each refusal with the types that it names.
fn assert_says(lines: &Lines, expected: &[(&str, &str)], foreign: &[&str]) {
    let lines = lines.take();
    assert_eq!(lines.len(), expected.len(), "{lines:#?}");
    for (line, (function, words)) in lines.iter().zip(expected) {
        assert!(line.starts_with(function) && line.contains(words), "{line}");
        assert!(!foreign.iter().any(|word| line.contains(word)), "{line}");
    }
}

#[test]
fn each_version_names_its_own_types_and_functions() {
    let [angle, stop, force, end] = references(["crank.angle", "upstop.enabled", "actuator.force", "time"]);
    let absent = end + 1000;
    let (mut number, mut flag) = ([0.0], [0]);
    let (c, lines) = logged(super::super::VERSION);
    // SAFETY: the instance is valid until it is freed, all arrays have the lengths told.
    unsafe {
        fmi3GetBoolean(c, &angle, 1, [0].as_mut_ptr(), 1);
        fmi3GetInt32(c, &angle, 1, [0].as_mut_ptr(), 1);
        fmi3SetUInt8(c, &stop, 1, [0].as_ptr(), 1);
        fmi3SetString(c, &force, 1, [null()].as_ptr(), 1);
        fmi3SetFloat64(c, &absent, 1, number.as_ptr(), 1);
        fmi3Terminate(c);
        fmi3EnterInitializationMode(c, 0, 0.0, 0.0, 0, 0.0);
        fmi3GetOutputDerivatives(c, &absent, 1, [1].as_ptr(), number.as_mut_ptr(), 1);
        fmi3GetDirectionalDerivative(c, &angle, 1, &absent, 1, [1.0].as_ptr(), 1, number.as_mut_ptr(), 1);
        fmi3GetAdjointDerivative(c, &absent, 1, &force, 1, [1.0].as_ptr(), 1, number.as_mut_ptr(), 1);
        fmi3FreeInstance(c);
    }
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
    assert_says(&lines, &expected, &["Real", "fmi2"]);

    let (c, lines) = logged(fmi2::VERSION);
    // SAFETY: as above.
    unsafe {
        fmi2GetBoolean(c, &angle, 1, [0].as_mut_ptr());
        fmi2GetInteger(c, &angle, 1, flag.as_mut_ptr());
        fmi2SetString(c, &force, 1, [null()].as_ptr());
        fmi2SetReal(c, &absent, 1, number.as_ptr());
        fmi2Terminate(c);
        fmi2SetupExperiment(c, 0, 0.0, 0.0, 0, 0.0);
        fmi2EnterInitializationMode(c);
        fmi2GetRealOutputDerivatives(c, &absent, 1, [1].as_ptr(), number.as_mut_ptr());
        fmi2GetDirectionalDerivative(c, &absent, 1, &force, 1, [1.0].as_ptr(), number.as_mut_ptr());
        fmi2FreeInstance(c);
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
    assert_says(&lines, &expected, &["Float64", "Int32", "fmi3"]);
}
