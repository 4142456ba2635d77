//! Saved states through the C interface: after a state is restored, the motion is bit-identical to the motion after the
//! state was saved.

use crate::host::{self, FOLDER, Folder, Gear, mechanism};
use linkage_fmu::codec::checksum::xxh64;
use linkage_fmu::fmi2::host::{Description, Host, Log, State, logger};
use linkage_fmu::fmi2::types::Status;
use linkage_fmu::fmi2::{fmi2GetBoolean, fmi2GetInteger};
use linkage_fmu::variables::Kind;
use std::path::Path;

const STEPS: usize = 60;

/// Parameters that are set before the initialisation, and inputs that change during the run.
struct Scenario {
    name: &'static str,
    method: &'static str,
    flags: &'static [(&'static str, bool)],
    parameters: &'static [(&'static str, f64)],
    /// Whether the airspeed changes and locks engage.
    weather: bool,
    /// Mean step [s].
    h: f64,
}

const BASE: Scenario = Scenario { name: "", method: "reduced", flags: &[], parameters: &[], weather: false, h: 4e-3 };

/// Friction with drag, locks and bouncing on both stops; short steps with steps ahead; bumpers; no losses; finite
/// elements.
const SCENARIOS: [Scenario; 6] = [
    Scenario {
        name: "friction and bouncing",
        flags: &[("friction.enabled", true)],
        parameters: &[("upstop.restitution", 0.7), ("downstop.restitution", 0.5), ("friction.static_coefficient", 0.1)],
        weather: true,
        ..BASE
    },
    Scenario {
        name: "friction in steps far shorter than need be",
        flags: &[("friction.enabled", true)],
        parameters: &[("crank.start_speed", -5.0)],
        h: 1e-4,
        ..BASE
    },
    Scenario {
        name: "bumpers and wind",
        flags: &[("upstop.rigid", false), ("downstop.rigid", false), ("air.relative_wind", true)],
        parameters: &[("upstop.stiffness", 1e6), ("downstop.stiffness", 1e5), ("upstop.damping", 500.0)],
        weather: true,
        ..BASE
    },
    Scenario { name: "air that begins to blow", parameters: &[("upstop.restitution", 0.9)], weather: true, ..BASE },
    Scenario {
        name: "no loss",
        flags: &[("upstop.enabled", false), ("downstop.enabled", false)],
        parameters: &[("crank.start_angle", 0.5), ("solver.tolerance", 1e-11)],
        h: 1e-3,
        ..BASE
    },
    Scenario {
        name: "finite elements",
        method: "rigid_fem",
        parameters: &[("solver.fem_step", 2e-5), ("coupler.axial_stiffness", 5e7)],
        h: 5e-4,
        ..BASE
    },
];

fn switch(gear: &Gear, name: &str, on: bool) {
    assert_eq!(gear.set_boolean(name, on), Status::Ok, "{name}");
}

fn started(scenario: &Scenario) -> Gear {
    let gear = Gear::new();
    assert_eq!(gear.set_item("solver.method", scenario.method), Status::Ok);
    scenario.flags.iter().for_each(|(name, on)| switch(&gear, name, *on));
    scenario.parameters.iter().for_each(|(name, value)| assert_eq!(gear.set(name, *value), Status::Ok, "{name}"));
    assert_eq!(gear.initialize(), Status::Ok, "{}: {:?}", scenario.name, gear.log.take());
    gear.log.take();
    gear
}

/// Size of step `n` [s]: some steps are tiny, and consecutive steps differ.
fn h(scenario: &Scenario, n: usize) -> f64 {
    scenario.h * if n % 9 == 4 { 1e-4 } else { 0.3 + (n * 7 % 11) as f64 / 8.0 }
}

/// Statuses and bits of all Reals and Booleans.
fn outputs(gear: &Gear) -> Vec<(Status, u64)> {
    let mut all = gear.all_bits();
    for (reference, variable) in (0..).zip(host::interface().list()) {
        match variable.kind {
            Kind::Real => {}
            Kind::Boolean => {
                let mut value = 0;
                // SAFETY: one reference, room for one value.
                let status = unsafe { fmi2GetBoolean(gear.c, &reference, 1, &mut value) };
                all[reference as usize] = (status, value as u64);
            }
            Kind::Enumeration => {
                let mut value = 0;
                // SAFETY: one reference, room for one value.
                let status = unsafe { fmi2GetInteger(gear.c, &reference, 1, &mut value) };
                all[reference as usize] = (status, value as u64);
            }
        }
    }
    gear.log.take();
    all
}

/// Make the steps `from` to `to` under changing inputs. Returns all outputs after each step.
fn run(gear: &Gear, scenario: &Scenario, from: usize, to: usize) -> Vec<Vec<(Status, u64)>> {
    let mut t = (0..from).fold(0.0, |t, n| t + h(scenario, n));
    let mut seen = Vec::new();
    for n in from..to {
        if n % 5 == 0 {
            let force = if scenario.method == "reduced" && n % 40 >= 20 { -9_000.0 } else { 30_000.0 };
            assert_eq!(gear.set("actuator.force", force + n as f64), Status::Ok);
        }
        if scenario.weather && n % 7 == 0 {
            assert_eq!(gear.set("airspeed", if n % 14 == 0 { 0.0 } else { 60.0 }), Status::Ok);
            switch(gear, "uplock.engage", n % 21 == 0);
        }
        assert_eq!(gear.step(t, h(scenario, n)), Status::Ok, "{} {n}: {:?}", scenario.name, gear.log.take());
        t += h(scenario, n);
        seen.push(outputs(gear));
    }
    seen
}

fn restore(gear: &Gear, state: &State) {
    assert_eq!(gear.restore(state), Status::Ok, "{:?}", gear.log.take());
}

fn free(gear: &Gear, mut state: State) {
    assert_eq!(gear.free(&mut state), Status::Ok);
    assert!(state.pointer().is_null());
}

fn deserialize(gear: &Gear, bytes: &[u8]) -> Result<State, String> {
    gear.deserialize(bytes).map_err(|status| {
        assert_eq!(status, Status::Error);
        gear.refusal()
    })
}

#[test]
fn steps_after_a_restored_state_are_bit_identical() {
    for scenario in &SCENARIOS {
        let gear = started(scenario);
        let mut reused = State::NONE;
        for at in [0, 7, 23, 41] {
            let gear = if at == 0 { &gear } else { &started(scenario) };
            run(gear, scenario, 0, at);
            let state = gear.save();
            let bytes = gear.serialize(&state).unwrap();
            assert_eq!(gear.save_into(&mut reused), Status::Ok);
            let before = outputs(gear);
            let after = run(gear, scenario, at, STEPS);
            assert_ne!(after[STEPS - at - 1], after[0]);
            let check = |other: &Gear, what: &str| {
                assert!(outputs(other) == before, "{} from {at}, {what}: the outputs at once", scenario.name);
                let again = run(other, scenario, at, STEPS);
                for (n, (a, b)) in after.iter().zip(&again).enumerate() {
                    assert!(a == b, "{} from {at}, {what}: differs after step {}", scenario.name, at + n);
                }
            };
            for state in [&state, &reused] {
                restore(gear, state);
                check(gear, "the same instance");
            }
            let instantiated = Gear::new();
            restore(&instantiated, &state);
            check(&instantiated, "an instance that was only instantiated");
            let other = Gear::new();
            assert_eq!(other.set("crank.length", 0.17), Status::Ok);
            assert_eq!(other.set("actuator.force", 31_000.0), Status::Ok);
            assert_eq!(other.initialize(), Status::Ok);
            other.log.take();
            restore(&other, &state);
            check(&other, "an instance with other parameters");
            let read = Gear::new();
            let copy = deserialize(&read, &bytes).unwrap();
            restore(&read, &copy);
            assert_eq!(read.serialize(&copy).unwrap(), bytes);
            assert_eq!(read.serialize(&read.save()).unwrap(), bytes);
            check(&read, "from bytes");
            free(&read, copy);
            free(gear, state);
        }
        free(&gear, reused);
    }
}

/// Only the values at a step count, not the calls that set them, nor readings and saved states in between.
#[test]
fn values_that_are_changed_and_restored_have_no_effect() {
    let names =
        ["actuator.force", "airspeed", "friction.kinetic_coefficient", "upstop.restitution", "solver.tolerance"];
    for scenario in &SCENARIOS {
        let (gear, twin) = (started(scenario), started(scenario));
        let names = if scenario.method == "reduced" { &names[..] } else { &names[..1] };
        let references: Vec<u32> = names.iter().map(|name| gear.vr(name)).collect();
        for n in 0..STEPS {
            let mut now = vec![0.0; names.len()];
            assert_eq!(twin.reals(&references, &mut now), Status::Ok);
            let others: Vec<f64> = now.iter().map(|value| 0.5 * value + 1e-4).collect();
            assert_eq!(twin.set_reals(&references, &others), Status::Ok, "{:?}", twin.log.take());
            if scenario.method == "reduced" {
                assert_eq!(twin.set_rates(references[0], &[1e4]), Status::Ok);
                assert_eq!(twin.set_rates(references[0], &[0.0]), Status::Ok);
            }
            if n % 3 == 0 {
                outputs(&twin);
            }
            if n % 4 == 0 {
                let saved = twin.save();
                let read = deserialize(&twin, &twin.serialize(&saved).unwrap()).unwrap();
                restore(&twin, &read);
                [saved, read].into_iter().for_each(|state| free(&twin, state));
            }
            assert_eq!(twin.set_reals(&references, &now), Status::Ok);
            let [one, other] = [&gear, &twin].map(|gear| run(gear, scenario, n, n + 1));
            assert!(one == other, "{}: step {n}", scenario.name);
            let [one, other] = [&gear, &twin].map(|gear| {
                let state = gear.save();
                let bytes = gear.serialize(&state).unwrap();
                free(gear, state);
                bytes
            });
            assert!(one == other, "{}: state after step {n}", scenario.name);
        }
    }
}

#[test]
fn a_state_returns_the_phase_the_clock_and_the_parameters() {
    let gear = Gear::new();
    assert_eq!(gear.set("crank.length", 0.1756), Status::Ok);
    let early = gear.save();
    assert_eq!(gear.set_up(None, 5.0, Some(6.0)), Status::Ok);
    assert_eq!(gear.initialize(), Status::Ok);
    assert_eq!(gear.step(5.0, 0.01), Status::Ok);
    let good = gear.save();
    assert_eq!(gear.set("actuator.force", 1e300), Status::Ok);
    assert_eq!(gear.step(5.01, 0.01), Status::Error);
    assert_eq!(gear.step(5.01, 0.01), Status::Error);
    let failed = gear.save();
    restore(&gear, &good);
    assert_eq!(gear.step(5.01, 0.01), Status::Ok);
    assert_eq!(gear.terminate(), Status::Ok);
    restore(&gear, &good);
    gear.log.take();
    assert_eq!(gear.step(5.02, 0.01), Status::Error);
    assert!(gear.refusal().contains("the time of the instance is 5.01 s"));
    assert_eq!(gear.step(5.01, 1.0), Status::Error);
    assert!(gear.refusal().contains("stopTime"));
    restore(&gear, &failed);
    assert_eq!(gear.step(5.01, 0.01), Status::Error);
    assert_eq!(gear.get("actuator.force"), Ok(1e300));
    assert_eq!(gear.reset(), Status::Ok);
    assert_eq!(gear.get("crank.length"), Ok(0.1755));
    restore(&gear, &early);
    assert_eq!(gear.get("crank.length"), Ok(0.1756));
    assert_eq!(gear.set("crank.length", 0.1757), Status::Ok);
    assert_eq!(gear.initialize(), Status::Ok);
    assert_eq!(gear.step(0.0, 0.01), Status::Ok);
    [early, good, failed].into_iter().for_each(|state| free(&gear, state));
}

#[test]
fn a_state_returns_the_tolerance_of_the_experiment() {
    let (first, second) = (Gear::new(), Gear::new());
    assert_eq!(first.set_up(Some(1e-7), 0.0, None), Status::Ok);
    let state = first.save();
    let copy = deserialize(&second, &first.serialize(&state).unwrap()).unwrap();
    restore(&second, &copy);
    assert_eq!(second.set("solver.tolerance", 1e-3), Status::Ok);
    assert_eq!(second.initialize(), Status::Ok);
    assert_eq!(second.get("solver.tolerance"), Ok(1e-7));
    free(&first, state);
    free(&second, copy);
}

#[test]
fn a_state_outlives_its_instance() {
    let scenario = &SCENARIOS[0];
    let first = started(scenario);
    run(&first, scenario, 0, 10);
    let state = first.save();
    let after = run(&first, scenario, 10, 20);
    drop(first);
    let second = Gear::new();
    restore(&second, &state);
    assert!(run(&second, scenario, 10, 20) == after);
    free(&second, state);
}

/// Bytes of the check sum.
const CHECK: usize = 8;

/// The bytes with a valid check sum.
fn sealed(mut bytes: Vec<u8>) -> Vec<u8> {
    bytes.truncate(bytes.len() - CHECK);
    let check = xxh64(&bytes).to_le_bytes();
    [bytes, check.to_vec()].concat()
}

/// The bytes with the first `old` replaced, and with a valid check sum.
fn replaced(bytes: &[u8], old: f64, new: f64) -> Vec<u8> {
    let at = bytes.windows(8).position(|window| window == old.to_le_bytes()).unwrap();
    sealed([&bytes[..at], &new.to_le_bytes(), &bytes[at + 8..]].concat())
}

#[test]
fn a_text_that_is_no_state_is_rejected_and_changes_nothing() {
    let scenario = &SCENARIOS[0];
    let gear = started(scenario);
    assert_eq!(gear.set("actuator.force", 12_345.678), Status::Ok);
    run(&gear, scenario, 1, 1);
    assert_eq!(gear.step(0.0, 0.01), Status::Ok);
    let state = gear.save();
    let bytes = gear.serialize(&state).unwrap();
    println!("serialised: {} bytes", bytes.len());
    assert_eq!(sealed(bytes.clone()), bytes);
    let before = outputs(&gear);
    let refused = |bytes: &[u8]| deserialize(&gear, bytes).err().unwrap();
    for at in 0..bytes.len() {
        let mut changed = bytes.clone();
        changed[at] ^= 1 << (at % 8);
        refused(&changed);
        refused(&bytes[..at]);
    }
    let changed = |at: usize, by: &[u8]| [&bytes[..at], by, &bytes[at + by.len()..]].concat();
    let longer = |n: usize| [&bytes[..], &vec![0; n]].concat();
    for (bytes, expected) in [
        (vec![], "not a serialized state of this type"),
        (vec![0; 1000], "not a serialized state of this type"),
        (bytes[..12].to_vec(), "incomplete"),
        (bytes[..bytes.len() - 1].to_vec(), "incomplete"),
        (longer(1), "too long"),
        (longer(1000), "too long"),
        (changed(8, &[255]), "version 255"),
        (changed(100, &[bytes[100] ^ 1]), "check sum"),
        (sealed(changed(20, &[bytes[20] ^ 1])), "GUID"),
        (sealed(changed(28, &[bytes[28] ^ 1])), "mechanism.json"),
        (sealed(changed(36, &[5])), "the number 5 for the status"),
        (sealed(changed(36, &[32])), "the number 32 for the status"),
        (sealed(changed(48, &f64::NAN.to_le_bytes())), "'time' is NaN"),
        (replaced(&bytes, 0.1755, -0.1755), "crank.length = -0.1755: must be"),
        (replaced(&bytes, 0.1755, f64::NAN), "crank.length = NaN: must be"),
        (replaced(&bytes, 0.1755, 10.0), "fmi2DeSerializeFMUstate"),
        (replaced(&bytes, 12_345.678, f64::INFINITY), "'input' is inf"),
    ] {
        let message = refused(&bytes);
        assert!(message.starts_with("fmi2DeSerializeFMUstate: ") && message.contains(expected), "{message}");
    }
    assert!(outputs(&gear) == before);
    assert_eq!(gear.step(0.01, 0.01), Status::Ok);
    free(&gear, state);
}

/// Forged numbers in a state never give the status fmi2Fatal.
#[test]
fn forged_numbers_are_rejected_or_harmless() {
    let scenario = &SCENARIOS[0];
    let gear = started(scenario);
    assert_eq!(gear.set("actuator.force", 12_345.678), Status::Ok);
    // The last of these steps is read from a step ahead.
    (0..10).for_each(|n| assert_eq!(gear.step(1e-3 * f64::from(n), 1e-3), Status::Ok));
    let state = gear.save();
    let bytes = gear.serialize(&state).unwrap();
    // Only the bytes from the inputs on are forged, because other parameters are another mechanism.
    let first = bytes.windows(8).position(|window| window == 12_345.678_f64.to_le_bytes()).unwrap();
    let mut accepted = 0;
    for at in first..bytes.len() - CHECK {
        for forged in [&[0xFF_u8; 8][..], &[0; 8], &[0xFF], &1e9_f64.to_le_bytes(), &f64::NAN.to_le_bytes()] {
            let mut changed = bytes.clone();
            let end = (at + forged.len()).min(bytes.len() - CHECK);
            changed[at..end].copy_from_slice(&forged[..end - at]);
            if let Ok(forged) = deserialize(&gear, &sealed(changed)) {
                accepted += 1;
                assert_ne!(gear.restore(&forged), Status::Fatal);
                assert_ne!(gear.step(0.01, 1e-3), Status::Fatal);
                assert!(outputs(&gear).iter().all(|(status, _)| *status != Status::Fatal));
                free(&gear, forged);
            }
        }
    }
    assert!(accepted > 0);
    restore(&gear, &state);
    free(&gear, state);
}

fn instantiate(folder: &Path) -> Host {
    Description::read(folder).and_then(|fmu| fmu.instantiate(Some(logger()), false)).unwrap()
}

/// The calls of `hostile` include other pointers and wrong sizes.
#[test]
fn a_state_of_another_fmu_is_rejected() {
    let gear = Gear::new();
    let other = instantiate(&Path::new(FOLDER).with_file_name("FourBar"));
    let (state, mut foreign) = (gear.save(), State::NONE);
    assert_eq!(other.save_into(&mut foreign), Status::Ok);
    let text = |log: &Log| log.take().pop().unwrap().text;
    assert_eq!(gear.restore(&foreign), Status::Error);
    assert!(text(&gear.log).contains("another FMU"));
    assert_eq!(gear.serialize(&foreign).err(), Some(Status::Error));
    assert_eq!(gear.save_into(&mut foreign), Status::Error);
    assert_eq!(gear.free(&mut foreign), Status::Error);
    assert!(!foreign.pointer().is_null());
    assert_eq!(other.restore(&state), Status::Error);
    assert_eq!(other.deserialize(&gear.serialize(&state).unwrap()).err(), Some(Status::Error));
    assert!(text(&other.log).contains("GUID"));
    assert_eq!([other.free(&mut foreign), other.free(&mut foreign)], [Status::Ok; 2]);
    free(&gear, state);
}

/// Two files with one interface differ in the guess, which selects the assembly and is no parameter. Their states are
/// not exchangeable.
#[test]
fn numbers_of_the_file_that_are_no_parameters_must_agree() {
    let text = mechanism();
    let change = |old: &str, new: &str| {
        assert_eq!(text.matches(old).count(), 1, "{old}");
        text.replace(old, new)
    };
    let folder = Folder::new("state of another file");
    let gear = Gear::stepping(0.0, None);
    let state = gear.save();
    std::fs::create_dir(folder.0.join("resources")).unwrap();
    for (text, expected) in [
        (change("\"follower\": 2.43", "\"follower\": 2.44"), Status::Error),
        (change("\"length\": 0.1755", "\"length\": 0.176"), Status::Ok),
        (change("\"force\": 30000", "\"force\": 1"), Status::Ok),
        (change("Retraction mechanism of", "The"), Status::Ok),
    ] {
        std::fs::write(folder.0.join("resources/mechanism.json"), text).unwrap();
        assert_eq!(instantiate(&folder.0).restore(&state), expected);
    }
    free(&gear, state);
}
