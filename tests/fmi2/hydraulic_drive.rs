//! The landing gear with its hydraulic circuit through the C interface: retraction, bit-identical saved states,
//! rejected calls.

use linkage_fmu::fmi2::host::{Description, Host, State, logger};
use linkage_fmu::fmi2::types::Status;
use std::path::Path;
use std::sync::{Arc, OnceLock};

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/modelDescription/LandingGearRetractionHydraulic");

fn gear() -> Host {
    static GEAR: OnceLock<Arc<Description>> = OnceLock::new();
    let gear = GEAR.get_or_init(|| Description::read(Path::new(FOLDER)).unwrap());
    let gear = gear.instantiate(Some(logger()), true).unwrap();
    assert_eq!(gear.set_boolean("downstop.enabled", false), Status::Ok);
    for (name, value) in [("command.ramp_amplitude", 0.65), ("command.ramp_time", 0.1), ("solver.tolerance", 1e-12)] {
        assert_eq!(gear.set(name, value), Status::Ok, "{name}");
    }
    assert_eq!(gear.initialize(), Status::Ok, "{:?}", gear.log.take());
    gear
}

/// Angle, pressures and force at 2 s by an independent integration.
#[test]
fn the_retraction_follows_the_reference() {
    let gear = gear();
    for step in 0..2000 {
        assert_eq!(gear.step(f64::from(step) * 1e-3, 1e-3), Status::Ok, "{:?}", gear.log.take());
    }
    for (name, expected) in [
        ("crank.angle", -0.242429680769236),
        ("chamber_a.pressure", 6710031.2547232),
        ("chamber_b.pressure", 6976165.2514557),
        ("actuator.force", 2710.350675763),
        ("actuator.length", 0.583686458596709),
    ] {
        let error = gear.get(name).unwrap() / expected - 1.0;
        assert!(error.abs() < 1e-11, "{name}: off by {error:e}");
    }
}

#[test]
fn a_serialised_state_continues_bit_identically() {
    let names = ["crank.angle", "crank.speed", "chamber_a.pressure", "valve.speed", "energy.supplied", "energy.drift"];
    let bits = |gear: &Host| names.map(|name| gear.get(name).unwrap().to_bits());
    // In motion, and at rest at the up stop.
    for steps in [37, 460] {
        let first = gear();
        let mut state = State::NONE;
        for step in 0..steps {
            assert_eq!(first.step(f64::from(step) * 0.01, 0.01), Status::Ok);
        }
        assert_eq!(first.save_into(&mut state), Status::Ok);
        let bytes = first.serialize(&state).unwrap();
        let run = |gear: &Host| {
            assert_eq!(gear.set("valve.command", -1.3), Status::Ok);
            for step in steps..steps + 40 {
                assert_eq!(gear.step(f64::from(step) * 0.01, 0.01), Status::Ok);
            }
            bits(gear)
        };
        let expected = run(&first);
        let twin = gear();
        let mut read = twin.deserialize(&bytes).unwrap();
        assert_eq!(twin.restore(&read), Status::Ok);
        assert_eq!(run(&twin), expected, "{steps}: in another instance");
        assert_eq!(first.restore(&state), Status::Ok);
        assert_eq!(run(&first), expected, "{steps}: rolled back");
        assert_eq!((first.free(&mut state), twin.free(&mut read)), (Status::Ok, Status::Ok));
    }
}

#[test]
fn the_force_is_an_output() {
    let gear = gear();
    let force = gear.reference("actuator.force");
    assert_ne!(gear.set_reals(&[force], &[1.0]), Status::Ok);
    assert_ne!(gear.set_rates(force, &[1.0]), Status::Ok);
    assert_eq!(gear.set_rates(gear.reference("valve.command"), &[0.1, -0.2]), Status::Ok);
    assert_eq!(gear.step(0.0, 0.01), Status::Ok);
    let command = gear.get("valve.command").unwrap();
    assert!((command - (0.1 * 0.01 - 0.1 * 1e-4)).abs() < 1e-15, "{command}");
}
