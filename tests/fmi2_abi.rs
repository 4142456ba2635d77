//! The C interface from the host's side: phases, arguments, values, steps.
#![allow(unsafe_code)]

mod fmi2_host;

use fmi2_host::Gear;
use linkage_fmu::fmi2::types::{Component, Status};
use linkage_fmu::fmi2::*;
use std::ffi::{CStr, c_int};
use std::ptr::{null, null_mut};

const H: f64 = 1e-3;

/// Bring a fresh instance into each phase.
fn in_phases() -> [(&'static str, Gear); 4] {
    let initialization = Gear::new();
    let terminated = Gear::stepping(0.0, None);
    // SAFETY: the components are valid.
    unsafe {
        assert_eq!(fmi2EnterInitializationMode(initialization.c), Status::Ok);
        assert_eq!(fmi2Terminate(terminated.c), Status::Ok);
    }
    let all = [
        ("instantiated", Gear::new()),
        ("initialization mode", initialization),
        ("step mode", Gear::stepping(0.0, None)),
        ("terminated", terminated),
    ];
    all.iter().for_each(|(_, gear)| drop(gear.log.take()));
    all
}

#[test]
fn a_function_out_of_its_phase_is_refused_by_name() {
    type Call = fn(&Gear) -> Status;
    // SAFETY: the components are valid.
    let table: [(&str, &[&str], Call); 5] = unsafe {
        [
            ("fmi2SetupExperiment", &["instantiated"], |g| fmi2SetupExperiment(g.c, 0, 0.0, 0.0, 0, 0.0)),
            ("fmi2EnterInitializationMode", &["instantiated"], |g| fmi2EnterInitializationMode(g.c)),
            ("fmi2ExitInitializationMode", &["initialization mode"], |g| fmi2ExitInitializationMode(g.c)),
            ("fmi2DoStep", &["step mode"], |g| g.step(0.0, H)),
            ("fmi2Terminate", &["step mode"], |g| fmi2Terminate(g.c)),
        ]
    };
    for (function, legal, call) in table {
        for (phase, gear) in in_phases() {
            if legal.contains(&phase) {
                assert_eq!(call(&gear), Status::Ok, "{function} in {phase}");
                continue;
            }
            assert_eq!(call(&gear), Status::Error, "{function} in {phase}");
            let message = gear.refusal();
            assert!(message.starts_with(function) && message.contains(phase), "{message}");
        }
    }
}

#[test]
fn variables_are_set_and_read_when_the_standard_allows_it() {
    use Status::{Error, Ok};
    let expected = [("instantiated", Ok, Ok), ("initialization mode", Ok, Ok), ("step mode", Error, Ok)];
    for ((phase, gear), (name, parameter, input)) in in_phases().iter().zip(expected) {
        assert_eq!(*phase, name);
        assert_eq!(gear.set("crank.length", 0.1755), parameter, "{phase}");
        assert_eq!(gear.set("actuator.force", 1000.0), input, "{phase}");
        assert_eq!(gear.set("crank.angle", 0.0), Error, "{phase}");
        assert_eq!(gear.get("actuator.force"), Result::Ok(1000.0));
        assert_eq!(gear.get("crank.angle").is_ok(), name != "instantiated", "{phase}");
    }
    let [.., (_, terminated)] = in_phases();
    assert_eq!(terminated.set("actuator.force", 0.0), Error);
    assert!(terminated.get("crank.angle").is_ok());
}

#[test]
fn null_is_answered_wherever_it_stands() {
    let none: Component = null_mut();
    // SAFETY: NULL is what is tested; every array that is not NULL has the length that is passed.
    unsafe {
        fmi2FreeInstance(none);
        assert_eq!(fmi2DoStep(none, 0.0, H, 1), Status::Error);
        assert_eq!(fmi2Reset(none), Status::Error);
        assert_eq!(fmi2GetReal(none, &0, 1, &mut 0.0), Status::Error);
        assert_eq!(fmi2SetDebugLogging(none, 1, 0, null()), Status::Error);

        let gear = Gear::stepping(0.0, None);
        let (c, vr) = (gear.c, gear.vr("actuator.force"));
        assert_eq!(fmi2GetReal(c, null(), 0, null_mut()), Status::Ok);
        assert_eq!(fmi2GetInteger(c, null(), 0, null_mut()), Status::Ok);
        assert_eq!(fmi2GetBoolean(c, null(), 0, null_mut()), Status::Ok);
        assert_eq!(fmi2GetString(c, null(), 0, null_mut()), Status::Ok);
        assert_eq!(fmi2SetReal(c, null(), 0, null()), Status::Ok);
        assert_eq!(fmi2SetInteger(c, null(), 0, null()), Status::Ok);
        assert_eq!(fmi2SetBoolean(c, null(), 0, null()), Status::Ok);
        assert_eq!(fmi2SetString(c, null(), 0, null()), Status::Ok);
        assert!(gear.log.take().is_empty());

        let refused = [
            fmi2GetReal(c, null(), 1, &mut 0.0),
            fmi2GetReal(c, &vr, 1, null_mut()),
            fmi2SetReal(c, null(), 1, &0.0),
            fmi2SetReal(c, &vr, 1, null()),
            fmi2GetBoolean(c, &vr, 1, null_mut()),
            fmi2SetBoolean(c, &vr, 1, null()),
            fmi2GetInteger(c, &vr, 1, null_mut()),
            fmi2SetInteger(c, &vr, 1, null()),
            fmi2GetString(c, &vr, 1, null_mut()),
            fmi2SetString(c, &vr, 1, null()),
            fmi2GetStatus(c, 0, null_mut()),
            fmi2GetRealStatus(c, 2, null_mut()),
            fmi2GetBooleanStatus(c, 3, null_mut()),
        ];
        assert_eq!(refused, [Status::Error; 13]);
        assert!(gear.log.take().iter().all(|message| message.text.contains("NULL")));
    }
}

#[test]
fn unknown_references_and_wrong_types_are_named() {
    let gear = Gear::stepping(0.0, None);
    let (c, vr, beyond) = (gear.c, gear.vr("actuator.force"), gear.count());
    // SAFETY: one reference and one value each.
    unsafe {
        for unknown in [beyond, u32::MAX] {
            assert_eq!(fmi2GetReal(c, &unknown, 1, &mut 0.0), Status::Error);
            let message = gear.refusal();
            assert!(message.contains(&unknown.to_string()) && message.contains(" to "), "{message}");
            assert_eq!(fmi2SetReal(c, &unknown, 1, &0.0), Status::Error);
            assert_eq!(fmi2SetBoolean(c, &unknown, 1, &0), Status::Error);
            assert_eq!(fmi2SetString(c, &unknown, 1, &c"x".as_ptr()), Status::Error);
            gear.log.take();
        }
        let wrong = [
            fmi2GetBoolean(c, &vr, 1, &mut 0),
            fmi2SetBoolean(c, &vr, 1, &1),
            fmi2GetInteger(c, &vr, 1, &mut 0),
            fmi2SetInteger(c, &vr, 1, &1),
            fmi2GetString(c, &vr, 1, &mut null()),
            fmi2SetString(c, &vr, 1, &c"x".as_ptr()),
        ];
        assert_eq!(wrong, [Status::Error; 6]);
        for message in gear.log.take() {
            assert!(message.text.contains("'actuator.force'") && message.text.contains("is a Real"), "{message:?}");
        }
        if let Some(engage) = gear.find("uplock.engage") {
            assert_eq!(fmi2SetBoolean(c, &engage, 1, &-1), Status::Ok);
            let mut value: c_int = 7;
            assert_eq!(fmi2GetBoolean(c, &engage, 1, &mut value), Status::Ok);
            assert_eq!(value, 1);
            assert_eq!(fmi2SetReal(c, &engage, 1, &1.0), Status::Error);
        }
    }
}

#[test]
fn a_refused_set_changes_nothing() {
    let gear = Gear::stepping(0.0, None);
    let force = gear.get("actuator.force").unwrap();
    let (input, output) = (gear.vr("actuator.force"), gear.vr("crank.angle"));
    // SAFETY: two references and two values each.
    unsafe {
        assert_eq!(fmi2SetReal(gear.c, [input, output].as_ptr(), 2, [1.0, 1.0].as_ptr()), Status::Error);
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let references = [input, gear.vr("load_factor")];
            assert_eq!(fmi2SetReal(gear.c, references.as_ptr(), 2, [1.0, bad].as_ptr()), Status::Error);
        }
    }
    assert_eq!(gear.get("actuator.force"), Ok(force));
    assert_eq!(Gear::new().set("crank.length", f64::NAN), Status::Error);
}

#[test]
fn strings_are_set_read_and_reset() {
    let gear = Gear::new();
    assert_eq!(gear.get_text("solver.method").as_deref(), Ok("reduced"));
    assert_eq!(gear.set_text("solver.method", "rigid_fem"), Status::Ok);
    assert_eq!(gear.get_text("solver.method").as_deref(), Ok("rigid_fem"));
    for bad in ["", "Reduced", "rigid_fem ", "\u{e4}"] {
        gear.log.take();
        assert_eq!(gear.set_text("solver.method", bad), Status::Error);
        let expected = format!("fmi2SetString: solver.method = \"{bad}\": must be \"reduced\" or \"rigid_fem\"");
        assert_eq!(gear.refusal(), expected);
    }
    let method = gear.vr("solver.method");
    // SAFETY: every array has the length that is passed.
    unsafe {
        // All or none: a good word before a Real, an unknown reference, a bad word, a NULL.
        for (second, word) in [
            (gear.vr("crank.length"), c"reduced".as_ptr()),
            (gear.count(), c"reduced".as_ptr()),
            (method, c"no".as_ptr()),
            (method, c"\xff".as_ptr()),
            (method, null()),
        ] {
            let words = [c"reduced".as_ptr(), word];
            assert_eq!(fmi2SetString(gear.c, [method, second].as_ptr(), 2, words.as_ptr()), Status::Error);
        }
        assert_eq!(gear.get_text("solver.method").as_deref(), Ok("rigid_fem"));
        // Both pointers of one call hold at once.
        let mut two = [null(); 2];
        assert_eq!(fmi2GetString(gear.c, [method, method].as_ptr(), 2, two.as_mut_ptr()), Status::Ok);
        assert_eq!(two.map(|text| CStr::from_ptr(text)), [c"rigid_fem"; 2]);
        assert_eq!(
            fmi2GetString(gear.c, [method, gear.vr("crank.angle")].as_ptr(), 2, two.as_mut_ptr()),
            Status::Error
        );
        assert_eq!(fmi2GetReal(gear.c, &method, 1, &mut 0.0), Status::Error);
        assert_eq!(fmi2SetReal(gear.c, &method, 1, &0.0), Status::Error);
        assert_eq!(gear.initialize(), Status::Ok);
        gear.log.take();
        assert_eq!(gear.set_text("solver.method", "reduced"), Status::Error);
        assert!(gear.refusal().contains("'solver.method'"));
        assert_eq!(gear.step(0.0, H), Status::Ok);
        assert_eq!(gear.get_text("solver.method").as_deref(), Ok("rigid_fem"));
        assert_eq!(fmi2Reset(gear.c), Status::Ok);
    }
    assert_eq!(gear.get_text("solver.method").as_deref(), Ok("reduced"));
}

#[test]
fn a_refused_step_changes_nothing() {
    let (gear, twin) = (Gear::stepping(0.0, Some(0.01)), Gear::stepping(0.0, Some(0.01)));
    let refused = [
        (0.0, 0.0),
        (0.0, -H),
        (0.0, f64::NAN),
        (0.0, f64::INFINITY),
        (H, H),
        (-H, H),
        (f64::NAN, H),
        (f64::INFINITY, H),
        (0.0, 0.02),
    ];
    for n in 0..10 {
        let t = f64::from(n) * H;
        for (offset, h) in refused {
            assert_eq!(gear.step(t + offset, h), Status::Error);
            assert!(gear.refusal().starts_with("fmi2DoStep: "));
        }
        assert_eq!((gear.step(t, H), twin.step(t, H)), (Status::Ok, Status::Ok));
        let bits = |g: &Gear| (g.get("crank.angle").unwrap().to_bits(), g.get("crank.speed").unwrap().to_bits());
        assert_eq!(bits(&gear), bits(&twin));
    }
    assert_eq!(gear.step(0.01, H), Status::Error);
    assert!(gear.refusal().contains("stopTime"));
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
fn an_experiment_is_checked() {
    let gear = Gear::new();
    // SAFETY: the component is valid.
    let setup = |tolerance: Option<f64>, start: f64, stop: Option<f64>| unsafe {
        let defined = |value: Option<f64>| c_int::from(value.is_some());
        let (e, s) = (tolerance.unwrap_or(f64::NAN), stop.unwrap_or(f64::NAN));
        fmi2SetupExperiment(gear.c, defined(tolerance), e, start, defined(stop), s)
    };
    for tolerance in [0.0, -1e-6, f64::NAN, f64::INFINITY] {
        assert_eq!(setup(Some(tolerance), 0.0, None), Status::Error);
    }
    for start in [f64::NAN, f64::INFINITY] {
        assert_eq!(setup(None, start, None), Status::Error);
    }
    for stop in [-1.0, 0.0, f64::NAN, f64::INFINITY] {
        assert_eq!(setup(None, 0.0, Some(stop)), Status::Error);
    }
    assert_eq!(setup(Some(1e-8), -1.0, Some(1.0)), Status::Ok);
    assert_eq!(gear.get("solver.tolerance"), Ok(1e-8));
    // A parameter that is set later does not override the experiment.
    assert_eq!(gear.set("solver.tolerance", 1e-3), Status::Ok);
    assert_eq!(gear.initialize(), Status::Ok);
    assert_eq!(gear.get("solver.tolerance"), Ok(1e-8));
}

#[test]
fn impossible_parameters_are_refused_and_can_be_corrected() {
    let gear = Gear::new();
    let length = gear.get("crank.length").unwrap();
    assert_eq!(gear.set("crank.length", 100.0), Status::Ok);
    // SAFETY: the component is valid.
    unsafe {
        assert_eq!(fmi2EnterInitializationMode(gear.c), Status::Ok);
        assert_eq!(gear.get("crank.angle"), Err(Status::Error));
        assert_eq!(fmi2ExitInitializationMode(gear.c), Status::Error);
        assert_eq!(gear.set("crank.length", length), Status::Ok);
        assert_eq!(fmi2ExitInitializationMode(gear.c), Status::Ok);
    }
    assert_eq!(gear.step(0.0, H), Status::Ok);
}

#[test]
fn reset_gives_a_fresh_instance() {
    let (gear, fresh) = (Gear::stepping(2.0, Some(2.5)), Gear::stepping(0.0, None));
    assert_eq!(gear.set("actuator.force", 1.0), Status::Ok);
    assert_eq!(gear.step(2.0, H), Status::Ok);
    // SAFETY: the component is valid.
    unsafe {
        assert_eq!(fmi2Reset(gear.c), Status::Ok);
        assert_eq!(gear.step(0.0, H), Status::Error);
        assert_eq!(fmi2EnterInitializationMode(gear.c), Status::Ok);
        assert_eq!(fmi2ExitInitializationMode(gear.c), Status::Ok);
    }
    for n in 0..5 {
        assert_eq!((gear.step(f64::from(n) * H, H), fresh.step(f64::from(n) * H, H)), (Status::Ok, Status::Ok));
    }
    assert_eq!(gear.get("actuator.force"), fresh.get("actuator.force"));
    assert_eq!(gear.get("crank.angle"), fresh.get("crank.angle"));
}

#[test]
fn instances_in_threads_do_not_meet() {
    let run = |force: f64| {
        let gear = Gear::stepping(0.0, None);
        assert_eq!(gear.set("actuator.force", force), Status::Ok);
        for n in 0..50 {
            assert_eq!(gear.step(f64::from(n) * H, H), Status::Ok);
        }
        gear.get("crank.angle").unwrap().to_bits()
    };
    let alone = [run(30_000.0), run(29_000.0)];
    assert_ne!(alone[0], alone[1]);
    let together = std::thread::scope(|scope| {
        [30_000.0, 29_000.0].map(|force| scope.spawn(move || run(force))).map(|thread| thread.join().unwrap())
    });
    assert_eq!(alone, together);
}

#[test]
fn what_is_not_supported_says_so() {
    let gear = Gear::stepping(0.0, None);
    let c = gear.c;
    let mut flag = 0;
    // SAFETY: every array has the length that is passed.
    unsafe {
        let refused = [
            fmi2EnterEventMode(c),
            fmi2NewDiscreteStates(c, null_mut()),
            fmi2EnterContinuousTimeMode(c),
            fmi2CompletedIntegratorStep(c, 1, &mut flag, &mut flag.clone()),
            fmi2SetTime(c, 0.0),
            fmi2SetContinuousStates(c, null(), 0),
            fmi2GetDerivatives(c, null_mut(), 0),
            fmi2GetEventIndicators(c, null_mut(), 0),
            fmi2GetContinuousStates(c, null_mut(), 0),
            fmi2GetNominalsOfContinuousStates(c, null_mut(), 0),
        ];
        assert_eq!(refused, [Status::Error; 10]);
        assert_eq!(gear.log.take().len(), refused.len());
    }
    assert_eq!(gear.step(0.0, H), Status::Ok, "a refusal does not end the simulation");
}

#[test]
fn static_strings_are_those_of_the_headers() {
    // SAFETY: both are static strings.
    unsafe {
        assert_eq!(CStr::from_ptr(fmi2GetTypesPlatform()), c"default");
        assert_eq!(CStr::from_ptr(fmi2GetVersion()), c"2.0");
    }
}
