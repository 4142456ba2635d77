//! Saved states through the C interface: what follows a restored state has the bits of what followed the saved one.
#![allow(unsafe_code, clippy::unwrap_used)]

mod fmi2_host;

use fmi2_host::{Folder, Gear, Log, c, callback, callbacks};
use linkage_fmu::fmi2::types::{Component, FmuState, Status};
use linkage_fmu::fmi2::*;
use linkage_fmu::mechanism::Model;
use linkage_fmu::variables::{Causality, Kind};
use std::ptr::{null, null_mut};

const STEPS: usize = 60;

/// What is switched on before initialisation.
struct Scenario {
    name: &'static str,
    method: &'static str,
    flags: &'static [(&'static str, bool)],
    parameters: &'static [(&'static str, f64)],
    /// Whether air blows now and then, and locks engage.
    weather: bool,
    /// Mean step [s].
    h: f64,
}

/// Friction with drag, locks and bouncing on both stops; steps that go on beyond the present; bumpers; no loss at all; finite
/// elements.
const SCENARIOS: [Scenario; 6] = [
    Scenario {
        name: "friction and bouncing",
        method: "reduced",
        flags: &[("friction.enabled", true)],
        parameters: &[("upstop.restitution", 0.7), ("downstop.restitution", 0.5), ("friction.static_coefficient", 0.1)],
        weather: true,
        h: 4e-3,
    },
    Scenario {
        name: "friction in steps far shorter than need be",
        method: "reduced",
        flags: &[("friction.enabled", true)],
        parameters: &[("crank.start_speed", -5.0)],
        weather: false,
        h: 1e-4,
    },
    Scenario {
        name: "bumpers and wind",
        method: "reduced",
        flags: &[("upstop.rigid", false), ("downstop.rigid", false), ("air.relative_wind", true)],
        parameters: &[("upstop.stiffness", 1e6), ("downstop.stiffness", 1e5), ("upstop.damping", 500.0)],
        weather: true,
        h: 4e-3,
    },
    Scenario {
        name: "air that begins to blow",
        method: "reduced",
        flags: &[],
        parameters: &[("upstop.restitution", 0.9)],
        weather: true,
        h: 4e-3,
    },
    Scenario {
        name: "no loss",
        method: "reduced",
        flags: &[("upstop.enabled", false), ("downstop.enabled", false)],
        parameters: &[("crank.start_angle", 0.5), ("solver.tolerance", 1e-11)],
        weather: false,
        h: 1e-3,
    },
    Scenario {
        name: "finite elements",
        method: "rigid_fem",
        flags: &[],
        parameters: &[("solver.fem_step", 2e-5), ("coupler.axial_stiffness", 5e7)],
        weather: false,
        h: 5e-4,
    },
];

fn switch(gear: &Gear, name: &str, on: bool) {
    // SAFETY: one reference, one value.
    assert_eq!(unsafe { fmi2SetBoolean(gear.c, &gear.vr(name), 1, &i32::from(on)) }, Status::Ok, "{name}");
}

fn started(scenario: &Scenario) -> Gear {
    let gear = Gear::new();
    assert_eq!(gear.set_text("solver.method", scenario.method), Status::Ok);
    scenario.flags.iter().for_each(|(name, on)| switch(&gear, name, *on));
    scenario.parameters.iter().for_each(|(name, value)| assert_eq!(gear.set(name, *value), Status::Ok, "{name}"));
    assert_eq!(gear.initialize(), Status::Ok, "{}: {:?}", scenario.name, gear.log.take());
    gear.log.take();
    gear
}

/// Size of step `n` [s]: some are tiny, none like the one before.
fn h(scenario: &Scenario, n: usize) -> f64 {
    scenario.h * if n % 9 == 4 { 1e-4 } else { 0.3 + (n * 7 % 11) as f64 / 8.0 }
}

/// Every output: status and bits.
fn outputs(gear: &Gear) -> Vec<(Status, u64)> {
    let model = fmi2_host::gear();
    let mut all = Vec::new();
    for (reference, variable) in model.variables().list().iter().enumerate() {
        let reference = reference as u32;
        match variable.kind {
            Kind::Real => {
                let mut value = 0.0;
                // SAFETY: one reference, room for one value.
                let status = unsafe { fmi2GetReal(gear.c, &reference, 1, &mut value) };
                all.push((status, value.to_bits()));
            }
            Kind::Boolean => {
                let mut value = 0;
                // SAFETY: one reference, room for one value.
                let status = unsafe { fmi2GetBoolean(gear.c, &reference, 1, &mut value) };
                all.push((status, value as u64));
            }
            _ => assert_eq!(variable.causality, Causality::Parameter),
        }
    }
    gear.log.take();
    all
}

/// Steps `from` to `to` under changing inputs, with all outputs after each.
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

fn save(gear: &Gear) -> FmuState {
    let mut state = null_mut();
    // SAFETY: the component is valid, the pointer has room.
    assert_eq!(unsafe { fmi2GetFMUstate(gear.c, &mut state) }, Status::Ok);
    assert!(!state.is_null());
    state
}

fn restore(gear: &Gear, state: FmuState) {
    // SAFETY: the component and the state are valid.
    assert_eq!(unsafe { fmi2SetFMUstate(gear.c, state) }, Status::Ok, "{:?}", gear.log.take());
}

fn free(gear: &Gear, mut state: FmuState) {
    // SAFETY: the component and the state are valid.
    assert_eq!(unsafe { fmi2FreeFMUstate(gear.c, &mut state) }, Status::Ok);
    assert!(state.is_null());
}

fn serialize(gear: &Gear, state: FmuState) -> Vec<u8> {
    let mut size = 0;
    // SAFETY: the component and the state are valid; the buffer has the size that is passed.
    unsafe {
        assert_eq!(fmi2SerializedFMUstateSize(gear.c, state, &mut size), Status::Ok);
        let mut bytes = vec![0_u8; size];
        assert_eq!(fmi2SerializeFMUstate(gear.c, state, bytes.as_mut_ptr().cast(), size), Status::Ok);
        bytes
    }
}

fn deserialize(gear: &Gear, bytes: &[u8]) -> Result<FmuState, String> {
    let untouched = null_mut::<u8>().wrapping_add(64).cast();
    let mut state = untouched;
    // SAFETY: the component is valid, the bytes are as many as is told.
    match unsafe { fmi2DeSerializeFMUstate(gear.c, bytes.as_ptr().cast(), bytes.len(), &mut state) } {
        Status::Ok => Ok(state),
        status => {
            assert_eq!((status, state), (Status::Error, untouched));
            Err(gear.refusal())
        }
    }
}

#[test]
fn what_follows_has_the_same_bits() {
    for scenario in &SCENARIOS {
        let gear = started(scenario);
        let mut reused = null_mut();
        for at in [0, 7, 23, 41] {
            let gear = if at == 0 { &gear } else { &started(scenario) };
            run(gear, scenario, 0, at);
            let state = save(gear);
            let bytes = serialize(gear, state);
            // SAFETY: NULL, or a state of this FMU.
            assert_eq!(unsafe { fmi2GetFMUstate(gear.c, &mut reused) }, Status::Ok);
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
            for state in [state, reused] {
                restore(gear, state);
                check(gear, "the same instance");
            }
            let instantiated = Gear::new();
            restore(&instantiated, state);
            check(&instantiated, "an instance that was only instantiated");
            let other = Gear::new();
            assert_eq!(other.set("crank.length", 0.17), Status::Ok);
            assert_eq!(other.set("actuator.force", 31_000.0), Status::Ok);
            assert_eq!(other.initialize(), Status::Ok);
            other.log.take();
            restore(&other, state);
            check(&other, "an instance with other parameters");
            let read = Gear::new();
            let copy = deserialize(&read, &bytes).unwrap();
            restore(&read, copy);
            assert_eq!(serialize(&read, copy), bytes);
            assert_eq!(serialize(&read, save(&read)), bytes);
            check(&read, "from bytes");
            free(&read, copy);
            free(gear, state);
        }
        free(&gear, reused);
    }
}

#[test]
fn a_state_returns_the_phase_the_clock_and_the_parameters() {
    let gear = Gear::new();
    assert_eq!(gear.set("crank.length", 0.1756), Status::Ok);
    let early = save(&gear);
    // SAFETY: the component is valid.
    unsafe {
        assert_eq!(fmi2SetupExperiment(gear.c, 0, 0.0, 5.0, 1, 6.0), Status::Ok);
        assert_eq!(gear.initialize(), Status::Ok);
        assert_eq!(gear.step(5.0, 0.01), Status::Ok);
        let good = save(&gear);
        assert_eq!(gear.set("actuator.force", 1e300), Status::Ok);
        assert_eq!(gear.step(5.01, 0.01), Status::Error);
        assert_eq!(gear.step(5.01, 0.01), Status::Error);
        let failed = save(&gear);
        restore(&gear, good);
        assert_eq!(gear.step(5.01, 0.01), Status::Ok);
        assert_eq!(fmi2Terminate(gear.c), Status::Ok);
        restore(&gear, good);
        gear.log.take();
        assert_eq!(gear.step(5.02, 0.01), Status::Error);
        assert!(gear.refusal().contains("the instance is at 5.01 s"));
        assert_eq!(gear.step(5.01, 1.0), Status::Error);
        assert!(gear.refusal().contains("stopTime"));
        restore(&gear, failed);
        assert_eq!(gear.step(5.01, 0.01), Status::Error);
        assert_eq!(gear.get("actuator.force"), Ok(1e300));
        assert_eq!(fmi2Reset(gear.c), Status::Ok);
        assert_eq!(gear.get("crank.length"), Ok(0.1755));
        restore(&gear, early);
        assert_eq!(gear.get("crank.length"), Ok(0.1756));
        assert_eq!(gear.set("crank.length", 0.1757), Status::Ok);
        assert_eq!(gear.initialize(), Status::Ok);
        assert_eq!(gear.step(0.0, 0.01), Status::Ok);
        [early, good, failed].into_iter().for_each(|state| free(&gear, state));
    }
}

#[test]
fn a_state_returns_the_tolerance_of_the_experiment() {
    let (first, second) = (Gear::new(), Gear::new());
    // SAFETY: the component is valid.
    unsafe { assert_eq!(fmi2SetupExperiment(first.c, 1, 1e-7, 0.0, 0, 0.0), Status::Ok) };
    let state = save(&first);
    let copy = deserialize(&second, &serialize(&first, state)).unwrap();
    restore(&second, copy);
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
    let state = save(&first);
    let after = run(&first, scenario, 10, 20);
    drop(first);
    let second = Gear::new();
    restore(&second, state);
    assert!(run(&second, scenario, 10, 20) == after);
    free(&second, state);
}

/// CRC-32 bit by bit, apart from the library's.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |crc: u32, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| if crc & 1 == 1 { crc >> 1 ^ 0xEDB8_8320 } else { crc >> 1 })
    })
}

/// With a check sum that is right.
fn sealed(mut bytes: Vec<u8>) -> Vec<u8> {
    let end = bytes.len() - 4;
    let check = crc32(&bytes[..end]);
    bytes[end..].copy_from_slice(&check.to_le_bytes());
    bytes
}

/// The bytes with the first `old` replaced, and a check sum that is right.
fn replaced(bytes: &[u8], old: f64, new: f64) -> Vec<u8> {
    let at = bytes.windows(8).position(|window| window == old.to_le_bytes()).unwrap();
    let mut bytes = bytes.to_vec();
    bytes[at..at + 8].copy_from_slice(&new.to_le_bytes());
    sealed(bytes)
}

#[test]
fn a_string_that_is_no_state_is_refused_and_nothing_changes() {
    let scenario = &SCENARIOS[0];
    let gear = started(scenario);
    assert_eq!(gear.set("actuator.force", 12_345.678), Status::Ok);
    run(&gear, scenario, 1, 1);
    assert_eq!(gear.step(0.0, 0.01), Status::Ok);
    let state = save(&gear);
    let bytes = serialize(&gear, state);
    println!("serialised: {} bytes", bytes.len());
    assert_eq!(sealed(bytes.clone()), bytes);
    let before = outputs(&gear);
    let refused = |bytes: &[u8]| deserialize(&gear, bytes).unwrap_err();
    for at in 0..bytes.len() {
        let mut changed = bytes.clone();
        changed[at] ^= 1 << (at % 8);
        refused(&changed);
        refused(&bytes[..at]);
    }
    let changed = |at: usize, by: &[u8]| {
        let mut changed = bytes.clone();
        changed[at..at + by.len()].copy_from_slice(by);
        changed
    };
    let longer = |n: usize| bytes.iter().copied().chain(std::iter::repeat_n(0, n)).collect::<Vec<_>>();
    for (bytes, expected) in [
        (vec![], "no state of this kind"),
        (vec![0; 1000], "no state of this kind"),
        (bytes[..12].to_vec(), "cut off"),
        (bytes[..bytes.len() - 1].to_vec(), "cut off"),
        (longer(1), "too long"),
        (longer(1000), "too long"),
        (changed(8, &[255]), "version 255"),
        (changed(100, &[bytes[100] ^ 1]), "check sum"),
        (sealed(changed(20, &[bytes[20] ^ 1])), "GUID"),
        (sealed(changed(28, &[bytes[28] ^ 1])), "mechanism.json"),
        (sealed(changed(36, &[32])), "phase = 32"),
        (sealed(changed(36, &[3])), "phase = 3"),
        (sealed(changed(47, &f64::NAN.to_le_bytes())), "time = NaN"),
        (replaced(&bytes, 0.1755, -0.1755), "crank.length = -0.1755: must be"),
        (replaced(&bytes, 0.1755, f64::NAN), "crank.length = NaN: must be"),
        (replaced(&bytes, 0.1755, 10.0), "fmi2DeSerializeFMUstate"),
        (replaced(&bytes, 12_345.678, f64::INFINITY), "input = inf"),
    ] {
        let message = refused(&bytes);
        assert!(message.starts_with("fmi2DeSerializeFMUstate: ") && message.contains(expected), "{message}");
    }
    assert!(outputs(&gear) == before);
    assert_eq!(gear.step(0.01, 0.01), Status::Ok);
    free(&gear, state);
}

/// Whatever numbers a forger writes: an answer, and no fault.
#[test]
fn forged_numbers_are_refused_or_harmless() {
    let scenario = &SCENARIOS[0];
    let gear = started(scenario);
    assert_eq!(gear.set("actuator.force", 12_345.678), Status::Ok);
    // The last of these is read from a step that goes on beyond it.
    (0..10).for_each(|n| assert_eq!(gear.step(1e-3 * f64::from(n), 1e-3), Status::Ok));
    let state = save(&gear);
    let bytes = serialize(&gear, state);
    // From the inputs on: other parameters are other mechanisms.
    let first = bytes.windows(8).position(|window| window == 12_345.678_f64.to_le_bytes()).unwrap();
    let mut accepted = 0;
    for at in first..bytes.len() - 4 {
        for forged in [&[0xFF_u8; 8][..], &[0; 8], &[0xFF], &1e9_f64.to_le_bytes(), &f64::NAN.to_le_bytes()] {
            let mut changed = bytes.clone();
            let end = (at + forged.len()).min(bytes.len() - 4);
            changed[at..end].copy_from_slice(&forged[..end - at]);
            if let Ok(forged) = deserialize(&gear, &sealed(changed)) {
                accepted += 1;
                // SAFETY: the component and the state are valid.
                assert_ne!(unsafe { fmi2SetFMUstate(gear.c, forged) }, Status::Fatal);
                assert_ne!(gear.step(0.01, 1e-3), Status::Fatal);
                assert!(outputs(&gear).iter().all(|(status, _)| *status != Status::Fatal));
                free(&gear, forged);
            }
        }
    }
    assert!(accepted > 0);
    restore(&gear, state);
    free(&gear, state);
}

/// An instance of another FMU.
fn four_bar(log: &Log) -> Component {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/modelDescription/FourBar/resources");
    let text = std::fs::read_to_string(format!("{folder}/mechanism.json")).unwrap();
    let guid = c(Model::from_json(&text).unwrap().variables().guid());
    instance(log, guid.to_str().unwrap(), folder)
}

fn instance(log: &Log, guid: &str, folder: &str) -> Component {
    let functions = callbacks(Some(callback()), log);
    // SAFETY: all pointers live during the call.
    unsafe { fmi2Instantiate(c"other".as_ptr(), 1, c(guid).as_ptr(), c(folder).as_ptr(), &functions, 0, 0) }
}

#[test]
fn a_pointer_to_something_else_is_refused() {
    let (gear, log) = (Gear::new(), Log::default());
    let other = four_bar(&log);
    let state = save(&gear);
    let mut foreign = null_mut();
    let mut zeros = [0_u64; 64];
    let text = |log: &Log| log.take().pop().unwrap().text;
    // SAFETY: components and states are valid until they are freed; `zeros` can be read.
    unsafe {
        assert_eq!(fmi2GetFMUstate(other, &mut foreign), Status::Ok);
        let bytes = serialize(&gear, state);
        for (pointer, expected) in [
            (null_mut(), "NULL"),
            (zeros.as_mut_ptr().cast(), "no state of this FMU"),
            (state.wrapping_byte_add(1), "no state of this FMU"),
            (foreign, "another FMU"),
        ] {
            assert_eq!(fmi2SetFMUstate(gear.c, pointer), Status::Error);
            assert!(text(&gear.log).contains(expected));
            assert_eq!(fmi2SerializedFMUstateSize(gear.c, pointer, &mut 0), Status::Error);
            assert_eq!(fmi2SerializeFMUstate(gear.c, pointer, null_mut(), 0), Status::Error);
            if !pointer.is_null() {
                let mut place = pointer;
                assert_eq!(fmi2GetFMUstate(gear.c, &mut place), Status::Error);
                assert_eq!(fmi2FreeFMUstate(gear.c, &mut place), Status::Error);
                assert_eq!(place, pointer);
            }
        }
        assert_eq!(fmi2SetFMUstate(other, state), Status::Error);
        let mut place = null_mut();
        assert_eq!(fmi2DeSerializeFMUstate(other, bytes.as_ptr().cast(), bytes.len(), &mut place), Status::Error);
        assert!(place.is_null() && text(&log).contains("GUID"));
        assert_eq!(fmi2SerializedFMUstateSize(gear.c, state, null_mut()), Status::Error);
        assert_eq!(fmi2DeSerializeFMUstate(gear.c, bytes.as_ptr().cast(), bytes.len(), null_mut()), Status::Error);
        assert_eq!(fmi2DeSerializeFMUstate(gear.c, null(), 0, &mut place), Status::Error);
        let mut room = vec![0_u8; bytes.len() + 1];
        for size in [0, bytes.len() - 1, bytes.len() + 1] {
            assert_eq!(fmi2SerializeFMUstate(gear.c, state, room.as_mut_ptr().cast(), size), Status::Error);
        }
        assert!(room.iter().all(|byte| *byte == 0));
        assert_eq!(fmi2FreeFMUstate(other, &mut foreign), Status::Ok);
        assert_eq!(fmi2FreeFMUstate(other, &mut foreign), Status::Ok);
        fmi2FreeInstance(other);
    }
    free(&gear, state);
}

/// The interface is the same, the mechanism is not: the guess names the assembly, and no parameter does.
#[test]
fn numbers_of_the_file_that_are_no_parameters_must_agree() {
    let text = std::fs::read_to_string(format!("{}/mechanism.json", fmi2_host::RESOURCES)).unwrap();
    let change = |old: &str, new: &str| {
        assert_eq!(text.matches(old).count(), 1, "{old}");
        text.replace(old, new)
    };
    let folder = Folder::new("state of another file");
    let gear = Gear::stepping(0.0, None);
    let state = save(&gear);
    let (log, model) = (Log::default(), fmi2_host::gear());
    for (text, expected) in [
        (change("\"follower\": 2.43", "\"follower\": 2.44"), Status::Error),
        (change("\"length\": 0.1755", "\"length\": 0.176"), Status::Ok),
        (change("\"force\": 30000", "\"force\": 1"), Status::Ok),
        (change("Retraction mechanism of", "The"), Status::Ok),
    ] {
        std::fs::write(folder.0.join("mechanism.json"), text).unwrap();
        let other = instance(&log, model.variables().guid(), folder.0.to_str().unwrap());
        assert!(!other.is_null(), "{:?}", log.take());
        // SAFETY: component and state are valid.
        unsafe {
            assert_eq!(fmi2SetFMUstate(other, state), expected);
            fmi2FreeInstance(other);
        }
    }
    free(&gear, state);
}

/// Saving, stepping and restoring costs less than 1.2 times the step. Held in release builds only, as others are not meant
/// to be fast.
#[test]
fn a_state_costs_little() {
    const LIMIT: f64 = 1.2;
    const STEPS: u32 = 120;
    let h = 1e-3;
    // Time of each step of a run [ns].
    let time = |with_state: bool| {
        let gear = Gear::stepping(0.0, None);
        let mut state = save(&gear);
        let clock = std::time::Instant::now();
        for n in 0..STEPS {
            assert_eq!(gear.step(f64::from(n) * h, h), Status::Ok);
            // What is restored was saved after the step: no step is repeated, which would be quicker than a new one.
            if with_state {
                // SAFETY: component and state are valid.
                unsafe {
                    assert_eq!(fmi2GetFMUstate(gear.c, &mut state), Status::Ok);
                    assert_eq!(fmi2SetFMUstate(gear.c, state), Status::Ok);
                }
            }
        }
        let time = clock.elapsed().as_secs_f64() / f64::from(STEPS) * 1e9;
        free(&gear, state);
        time
    };
    // The least of many runs, taken in turn; more of them where the machine is busy.
    let (mut plain, mut with) = (f64::INFINITY, f64::INFINITY);
    for round in 0..1000 {
        (plain, with) = (plain.min(time(false)), with.min(time(true)));
        if round >= 50 && with < LIMIT * plain {
            break;
        }
    }
    println!("step {plain:.0} ns; with save and restore {with:.0} ns, {:.2} times", with / plain);
    if !cfg!(debug_assertions) {
        assert!(with < LIMIT * plain, "{with} ns against {plain} ns");
    }
}
