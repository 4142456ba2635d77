//! A communication step without errors allocates no memory.
#![allow(unsafe_code, clippy::unwrap_used)]

#[path = "../support/counting.rs"]
mod counting;
mod exchange;
mod fmi3;
#[path = "../fmi2/host.rs"]
mod host;
mod prepared;

use counting::{allocations, live};
use host::Gear;
use linkage_fmu::fmi2::host::{Description, Host, State};
use linkage_fmu::fmi2::types::Status;
use linkage_fmu::fmi2::{fmi2GetDirectionalDerivative, fmi2GetRealOutputDerivatives, fmi2SetRealInputDerivatives};
use linkage_fmu::mechanism::Model;
use linkage_fmu::variables::Kind;

/// Largest number of allocations and of bytes of a saved state.
const STATE_BLOCKS: usize = 8;
const STATE_BYTES: isize = 2048;
#[test]
fn set_step_get_allocates_nothing() {
    exchange_allocates_nothing("reduced");
}

#[test]
fn nor_do_the_finite_elements() {
    exchange_allocates_nothing("rigid_fem");
}

#[test]
fn nor_do_derivatives() {
    let h = 1e-4;
    let gear = Gear::new();
    assert_eq!(gear.initialize(), Status::Ok);
    let inputs = [gear.vr("actuator.force"), gear.vr("load_factor")];
    let outputs =
        ["crank.angle", "crank.acceleration", "actuator.static_load", "joint2.force"].map(|name| gear.vr(name));
    let mut values = [0.0; 4];
    let exchange = |n: i32| {
        let (ones, rates) = ([1; 4], [2e5, 10.0]);
        assert_eq!(gear.set_reals(&inputs, &[3e4, 3.0]), Status::Ok);
        // SAFETY: every array has the length that is passed.
        unsafe {
            let status = fmi2SetRealInputDerivatives(gear.c, inputs.as_ptr(), 2, ones.as_ptr(), rates.as_ptr());
            assert_eq!(status, Status::Ok);
            assert_eq!(gear.step(f64::from(n) * h, h), Status::Ok);
            let (known, unknown) = (inputs.as_ptr(), outputs.as_ptr());
            let status =
                fmi2GetDirectionalDerivative(gear.c, unknown, 4, known, 2, rates.as_ptr(), values.as_mut_ptr());
            assert_eq!(status, Status::Ok);
            let status = fmi2GetRealOutputDerivatives(gear.c, unknown, 4, ones.as_ptr(), values.as_mut_ptr());
            assert_eq!(status, Status::Ok);
        }
    };
    assert_allocates_nothing(&gear, exchange, "derivatives");
}

#[test]
fn nor_do_saving_and_restoring_in_a_state_that_is_used_again() {
    for (method, friction) in [("reduced", false), ("reduced", true), ("rigid_fem", false)] {
        let h = 1e-4;
        let gear = Gear::new();
        assert_eq!(gear.set_item("solver.method", method), Status::Ok);
        assert_eq!(gear.set_boolean("friction.enabled", friction), Status::Ok);
        assert_eq!(gear.initialize(), Status::Ok);
        let (input, output) = (gear.vr("actuator.force"), gear.vr("joint2.force"));
        let mut state = State::NONE;
        let mut step_twice = |n: i32| {
            let mut values = [0.0; 2];
            assert_eq!(gear.save_into(&mut state), Status::Ok);
            for value in &mut values {
                assert_eq!(gear.set_reals(&[input], &[f64::from(n)]), Status::Ok);
                assert_eq!(gear.step(f64::from(n) * h, h), Status::Ok);
                assert_eq!(gear.reals(&[output], std::slice::from_mut(value)), Status::Ok);
                assert_eq!(gear.restore(&state), Status::Ok);
            }
            assert_eq!(values[0].to_bits(), values[1].to_bits());
            assert_eq!(gear.step(f64::from(n) * h, h), Status::Ok);
        };
        assert_allocates_nothing(&gear, &mut step_twice, &format!("{method}, friction {friction}"));
        assert_eq!(gear.free(&mut state), Status::Ok);
    }
}

/// All Reals of an FMU.
fn reals(description: &Description) -> Vec<u32> {
    let list = (0..).zip(description.interface().list());
    list.filter(|(_, variable)| variable.kind == Kind::Real).map(|(reference, _)| reference).collect()
}

/// The hydraulic actuator in both modes, with all inputs, derivatives and outputs, and with a state that is saved
/// repeatedly.
#[test]
fn nor_does_the_hydraulic_actuator() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/modelDescription/HydraulicActuator");
    let description = Description::read(std::path::Path::new(folder)).unwrap();
    for mode in ["preview", "follow"] {
        let h = 1e-4;
        let actuator = description.instantiate(None, false).unwrap();
        assert_eq!(actuator.set_item("coupling.mode", mode), Status::Ok);
        assert_eq!(actuator.set("actuator.length", 0.5), Status::Ok);
        assert_eq!(actuator.set("preview.horizon", h), Status::Ok);
        assert_eq!(actuator.initialize(), Status::Ok);
        let reals = reals(&description);
        let mut values = vec![0.0; reals.len()];
        let names = ["actuator.speed", "valve.command", "actuator.reduced_mass", "actuator.holding_force"];
        let inputs = names.map(|name| actuator.reference(name));
        let unknowns = ["actuator.force", "preview.force"].map(|name| actuator.reference(name));
        let mut state = State::NONE;
        let exchange = |n: i32| {
            let t = f64::from(n) * h;
            assert_eq!(actuator.save_into(&mut state), Status::Ok);
            assert_eq!(actuator.set_reals(&inputs, &[0.01, 0.3 * t.sin(), 700.0, 500.0]), Status::Ok);
            let (orders, rates) = ([1; 4], [0.1, 0.2, 0.0, 0.0]);
            let mut derivatives = [0.0; 2];
            // SAFETY: every array has the length that is passed.
            unsafe {
                let status =
                    fmi2SetRealInputDerivatives(actuator.c, inputs.as_ptr(), 4, orders.as_ptr(), rates.as_ptr());
                assert_eq!(status, Status::Ok);
                assert_eq!(actuator.step(t, h), Status::Ok);
                let (unknown, out) = (unknowns.as_ptr(), derivatives.as_mut_ptr());
                assert_eq!(
                    fmi2GetDirectionalDerivative(actuator.c, unknown, 2, inputs.as_ptr(), 4, rates.as_ptr(), out),
                    Status::Ok
                );
                assert_eq!(fmi2GetRealOutputDerivatives(actuator.c, unknown, 2, orders.as_ptr(), out), Status::Ok);
            }
            assert_eq!(actuator.reals(&reals, &mut values), Status::Ok);
            assert_eq!(actuator.restore(&state), Status::Ok);
            assert_eq!(actuator.step(t, h), Status::Ok);
        };
        assert_allocates_nothing(&actuator, exchange, mode);
        assert_eq!(actuator.free(&mut state), Status::Ok);
    }
}

/// The landing gear with its hydraulic circuit, in motion and at rest at a stop.
#[test]
fn nor_does_a_mechanism_with_a_hydraulic_circuit() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/modelDescription/LandingGearRetractionHydraulic");
    let description = Description::read(std::path::Path::new(folder)).unwrap();
    for held in [false, true] {
        let h = 1e-3;
        let gear = description.instantiate(None, false).unwrap();
        assert_eq!(gear.set_boolean("downstop.enabled", held), Status::Ok);
        assert_eq!(gear.set("command.ramp_amplitude", 0.0), Status::Ok);
        // This pressure presses the gear against its down stop.
        assert_eq!(gear.set("chamber_b.start_pressure", 15e6), Status::Ok);
        assert_eq!(gear.initialize(), Status::Ok);
        let reals = reals(&description);
        let mut values = vec![0.0; reals.len()];
        let inputs = ["valve.command", "supply.pressure"].map(|name| gear.reference(name));
        let (mut state, mut derivatives) = (State::NONE, [0.0]);
        // A saved state includes the inputs.
        assert_eq!(gear.set("valve.command", -0.1), Status::Ok);
        let exchange = |n: i32| {
            let t = f64::from(n) * h;
            assert_eq!(gear.save_into(&mut state), Status::Ok);
            let command = if held { -0.1 } else { 0.3 * t.sin() };
            assert_eq!(gear.set_reals(&inputs, &[command, 20e6 + 1e5 * t]), Status::Ok);
            assert_eq!(gear.set_rates(inputs[1], &[1e5, 0.0]), Status::Ok);
            assert_eq!(gear.step(t, h), Status::Ok);
            assert_eq!(gear.derivatives(&[gear.reference("supply.flow")], inputs[1], &mut derivatives), Status::Ok);
            assert_eq!(gear.reals(&reals, &mut values), Status::Ok);
            assert_eq!(gear.restore(&state), Status::Ok);
            assert_eq!(gear.step(t, h), Status::Ok);
        };
        assert_allocates_nothing(&gear, exchange, if held { "held" } else { "in motion" });
        assert_eq!(gear.get("crank.speed") == Ok(0.0), held, "{:?}", gear.get("crank.angle"));
        assert_eq!(gear.free(&mut state), Status::Ok);
    }
}

/// A controller with an integral part, which static friction holds at times.
#[test]
fn nor_does_an_integral_part() {
    let folder = host::Folder::new("integrating");
    let description = folder.described(include_str!("../fixtures/integrating_drive.json"));
    let h = 0.05;
    let drive = description.instantiate(None, false).unwrap();
    assert_eq!(drive.initialize(), Status::Ok);
    let reals = reals(&description);
    let mut values = vec![0.0; reals.len()];
    let (command, speed) = (drive.reference("motor.command"), drive.reference("slide.speed"));
    let (mut state, mut derivatives, mut seen) = (State::NONE, [0.0], [0, 0]);
    let exchange = |n: i32| {
        let t = f64::from(n) * h;
        assert_eq!(drive.save_into(&mut state), Status::Ok);
        assert_eq!(drive.set_reals(&[command], &[0.2 * t.sin()]), Status::Ok);
        assert_eq!(drive.set_rates(command, &[0.2 * t.cos(), 0.0]), Status::Ok);
        assert_eq!(drive.step(t, h), Status::Ok);
        let force = drive.reference("motor.acting_force");
        assert_eq!(drive.derivatives(&[force], command, &mut derivatives), Status::Ok);
        assert_eq!(drive.reals(&reals, &mut values), Status::Ok);
        assert_eq!(drive.restore(&state), Status::Ok);
        assert_eq!(drive.step(t, h), Status::Ok);
        assert_eq!(drive.reals(&[speed], &mut derivatives), Status::Ok);
        seen[usize::from(derivatives[0] == 0.0)] += 1;
    };
    assert_allocates_nothing(&drive, exchange, "integral part");
    assert!(seen[0] > 0 && seen[1] > 0, "{seen:?}");
    assert_eq!(drive.free(&mut state), Status::Ok);
}

/// Saving and restoring a state in every step needs no evaluation, no additional integration step, and one small block
/// of memory. Together with the test above these are all its costs. `cargo fmu bench` measures the times.
#[test]
fn a_state_costs_no_evaluation_and_few_bytes() {
    let statistics = |friction: bool, with_state: bool| {
        let mut model = Model::from_json(&host::mechanism()).unwrap();
        let reference = model.variables().find("friction.enabled").unwrap();
        model.set_boolean(reference, friction).unwrap();
        model.initialize().unwrap();
        let mut snapshot = model.snapshot();
        for _ in 0..120 {
            model.step(1e-3).unwrap();
            if with_state {
                model.snapshot_into(&mut snapshot);
                model.restore(&snapshot).unwrap();
            }
        }
        model.statistics()
    };
    for friction in [false, true] {
        assert_eq!(statistics(friction, true), statistics(friction, false));
    }
    let gear = Gear::stepping(0.0, None);
    assert_eq!(gear.step(0.0, 1e-3), Status::Ok);
    // The mechanism is hashed when a state is saved for the first time.
    assert_eq!(gear.free(&mut gear.save()), Status::Ok);
    let before = (allocations(), live());
    let mut state = gear.save();
    let (blocks, bytes) = (allocations() - before.0, live() - before.1);
    assert!(blocks <= STATE_BLOCKS && bytes <= STATE_BYTES, "{blocks} allocations, {bytes} bytes");
    assert_eq!(gear.free(&mut state), Status::Ok);
    assert_eq!(live(), before.1);
}

/// A step allocates memory only for a new stretch of an open curve. Each stretch is eight times as long as the previous
/// one.
#[test]
fn only_growth_allocates() {
    let text = r#"{ "name": "Carriage", "bodies": { "ground": {}, "carriage": { "length": 0.02, "mass": 3 } },
      "joints": { "rail": { "type": "prismatic", "first": "ground.origin", "second": "carriage.origin" } },
      "start": { "joint": "rail", "position": 0, "speed": 100 }, "guess": { "rail": 0 } }"#;
    let mut model = Model::from_json(text).unwrap();
    model.initialize().unwrap();
    let position = model.variables().find("rail.position").unwrap();
    let mut grown = 0;
    for k in 1..=10_000 {
        let before = allocations();
        model.step(0.1).unwrap();
        assert!((model.real(position).unwrap() / (10.0 * f64::from(k)) - 1.0).abs() < 1e-12);
        grown += u32::from(allocations() > before);
    }
    // 1e5 m are 5e6 sizes of the mechanism, or 1e2 times 8^5.2.
    assert_eq!(grown, 6);
}

fn exchange_allocates_nothing(method: &str) {
    let h = 1e-4;
    let gear = Gear::new();
    assert_eq!(gear.set_item("solver.method", method), Status::Ok);
    assert_eq!(gear.initialize(), Status::Ok);
    let inputs = [gear.vr("actuator.force"), gear.vr("load_factor")];
    let motion = ["crank.angle", "crank.speed", "crank.acceleration", "actuator.acceleration"];
    let others = ["actuator.reduced_mass", "wheel.acceleration_x", "joint2.force", "energy.drift"];
    let outputs = [motion, others].concat().into_iter().map(|name| gear.vr(name)).collect::<Vec<_>>();
    let mut values = [0.0; 8];
    let exchange = |n: i32| {
        assert_eq!(gear.set_reals(&inputs, &[30_000.0 + f64::from(n), 3.0]), Status::Ok);
        assert_eq!(gear.step(f64::from(n) * h, h), Status::Ok);
        assert_eq!(gear.reals(&outputs, &mut values), Status::Ok);
    };
    assert_allocates_nothing(&gear, exchange, method);
}

/// A repeated run allocates no memory from its tenth round on. Tables are built when an output first needs them, those
/// of reactions panel by panel. `rewind` restores the start of the run.
fn assert_allocates_nothing_again(rewind: impl FnOnce(), mut round: impl FnMut(i32), what: &str) {
    (0..200).for_each(&mut round);
    rewind();
    (0..10).for_each(&mut round);
    let before = allocations();
    (10..200).for_each(&mut round);
    assert_eq!(allocations(), before, "{what}");
}

/// [`assert_allocates_nothing_again`] for a host of FMI 2.0.
fn assert_allocates_nothing(host: &Host, round: impl FnMut(i32), what: &str) {
    let mut start = State::NONE;
    assert_eq!(host.save_into(&mut start), Status::Ok);
    let rewind = || assert_eq!(host.restore(&start), Status::Ok);
    assert_allocates_nothing_again(rewind, round, what);
    assert_eq!(host.free(&mut start), Status::Ok);
}
