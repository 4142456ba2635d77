//! Outputs without a value in a valid state, through the C functions: NaN, fmi2Warning and one line of the log. All
//! other outputs have values.

use crate::host::{Folder, Gear};
use linkage_fmu::fmi2::host::{Host, logger};
use linkage_fmu::fmi2::types::Status;
use linkage_fmu::fmi2::{fmi2GetRealOutputDerivatives, fmi2SetDebugLogging};
use linkage_fmu::variables::{Causality, Kind};
use std::ffi::CString;

const BUCKET: &str = include_str!("../fixtures/excavator_bucket.json");
/// Longest message [bytes].
const LONGEST: usize = 1000;

/// The bucket before it swings through positions in which friction locks it against its cylinder, without loggingOn.
fn bucket(name: &str) -> (Host, Vec<(String, u32)>) {
    let folder = Folder::new(name);
    let description = folder.described(BUCKET);
    let list = description.interface().list().iter().zip(0..);
    let is_output = |v: &linkage_fmu::variables::Variable| v.causality == Causality::Output && v.kind == Kind::Real;
    let outputs = list.filter(|(v, _)| is_output(v)).map(|(v, r)| (v.name.clone(), r)).collect();
    let host = description.instantiate(Some(logger()), false).unwrap();
    for (name, value) in
        [("bucket.start_angle", 2.55), ("bucket.start_speed", 1.5), ("cylinder.force", 2e4), ("digging.torque", -100.0)]
    {
        assert_eq!(host.set(name, value), Status::Ok);
    }
    assert_eq!(host.set_up(None, 0.0, None), Status::Ok);
    assert_eq!(host.initialize(), Status::Ok);
    (host, outputs)
}

#[test]
fn an_output_that_does_not_exist_is_nan_with_one_warning_and_ends_nothing() {
    const STEP: f64 = 4e-3;
    let (host, outputs) = bucket("undefined");
    let references: Vec<u32> = outputs.iter().map(|(_, reference)| *reference).collect();
    let (mut warned, mut complete) = (0, 0);
    for k in 0..60 {
        let mut values = vec![7.0; references.len()];
        let status = host.reals(&references, &mut values);
        let lacking: Vec<&str> =
            outputs.iter().zip(&values).filter(|(_, v)| v.is_nan()).map(|((name, _), _)| name.as_str()).collect();
        assert!(values.iter().all(|value| value.is_nan() || (value.is_finite() && *value != 7.0)));
        let messages = host.log.take();
        if lacking.is_empty() {
            assert_eq!((status, messages.len()), (Status::Ok, 0));
            complete += 1;
        } else {
            assert_eq!((status, messages.len()), (Status::Warning, 1), "{messages:?}");
            let message = &messages[0];
            assert_eq!((message.status, message.category.as_str()), (1, "logStatusWarning"));
            assert!(
                message.text.starts_with("fmi2GetReal: no value exists in this state (NaN is returned) for "),
                "{}",
                message.text
            );
            assert!(lacking.iter().all(|name| message.text.contains(name)), "{}", message.text);
            assert!(message.text.contains("the mechanism against the drive cylinder near "), "{}", message.text);
            // Single readings give the same values.
            for (name, value) in lacking.iter().map(|name| (*name, f64::NAN)).chain([("bucket.speed", 0.0)]) {
                let mut one = [1.0];
                let status = host.reals(&[host.reference(name)], &mut one);
                assert_eq!((status == Status::Warning, one[0].is_nan()), (value.is_nan(), value.is_nan()), "{name}");
            }
            assert_eq!(host.log.take().len(), lacking.len());
            // A wrong call still returns an error.
            assert_eq!(host.reals(&[references[0], u32::MAX], &mut [0.0; 2]), Status::Error);
            host.log.take();
            warned += 1;
        }
        assert_eq!(host.step(f64::from(k) * STEP, STEP), Status::Ok);
    }
    assert!(warned > 2 && complete > 10, "{warned} {complete}");
}

/// The derivatives of such outputs are NaN with a warning too.
#[test]
fn a_derivative_that_does_not_exist_is_nan_with_a_warning() {
    let (host, _) = bucket("derivatives");
    let names = ["bucket.angle", "cylinder.required_force", "cylinder.length"];
    let references = names.map(|name| host.reference(name));
    let mut warned = 0;
    for k in 0..60 {
        assert_eq!(host.step(f64::from(k) * 4e-3, 4e-3), Status::Ok);
        let lacks = host.get("cylinder.required_force").is_err();
        host.log.take();
        let (mut rates, mut partials) = ([7.0; 3], [7.0; 3]);
        // SAFETY: the component is valid; three references, orders and values.
        let status = unsafe {
            fmi2GetRealOutputDerivatives(host.c, references.as_ptr(), 3, [1; 3].as_ptr(), rates.as_mut_ptr())
        };
        let by_input = host.derivatives(&references, host.reference("digging.torque"), &mut partials);
        let expected = if lacks { Status::Warning } else { Status::Ok };
        assert_eq!([status, by_input], [expected; 2], "{:?}", host.log.take());
        assert_eq!([rates, partials].map(|values| values.map(f64::is_nan)), [[false, lacks, false]; 2]);
        let messages = host.log.take();
        assert_eq!(messages.len(), if lacks { 2 } else { 0 });
        assert!(
            messages
                .iter()
                .all(|m| m.text.contains("no derivative exists in this state (NaN is returned) for cylinder.required"))
        );
        warned += usize::from(lacks);
    }
    assert!(warned > 2);
}

/// A message is one line of limited length, for any arguments of the host.
#[test]
fn a_line_of_the_log_is_bounded() {
    let gear = Gear::new();
    let long = CString::new(format!("x{}\u{1}", "y".repeat(100_000))).unwrap();
    // SAFETY: one category.
    assert_eq!(unsafe { fmi2SetDebugLogging(gear.c, 1, 1, &long.as_ptr()) }, Status::Error);
    let refusal = gear.refusal();
    assert!(refusal.len() <= LONGEST && refusal.contains(" bytes omitted) "), "{refusal:.300}");
}
