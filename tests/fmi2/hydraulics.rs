//! The hydraulic actuator through the C interface: life cycle, bit-identical saved states, derivatives, warnings,
//! rejected calls.

use linkage_fmu::fmi2::fmi2GetRealOutputDerivatives;
use linkage_fmu::fmi2::host::{Description, Host, State, logger};
use linkage_fmu::fmi2::types::Status;
use linkage_fmu::variables::{Causality, Kind};
use std::path::Path;
use std::sync::{Arc, OnceLock};

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/modelDescription/HydraulicActuator");

fn description() -> &'static Arc<Description> {
    static ACTUATOR: OnceLock<Arc<Description>> = OnceLock::new();
    ACTUATOR.get_or_init(|| Description::read(Path::new(FOLDER)).unwrap())
}

fn actuator() -> Host {
    description().instantiate(Some(logger()), true).unwrap()
}

fn started(mode: &str) -> Host {
    let actuator = actuator();
    assert_eq!(actuator.set_item("coupling.mode", mode), Status::Ok);
    assert_eq!(actuator.set("actuator.length", 0.43), Status::Ok);
    assert_eq!(actuator.initialize(), Status::Ok, "{:?}", actuator.log.take());
    actuator.log.take();
    actuator
}

fn rates(actuator: &Host, name: &str, rates: &[f64]) -> Status {
    actuator.set_rates(actuator.reference(name), rates)
}

/// Statuses and bits of all Reals.
fn all_bits(actuator: &Host) -> Vec<(Status, u64)> {
    let list = description().interface().list();
    let reals = (0..).zip(list).filter(|(_, variable)| variable.kind == Kind::Real);
    let bits = reals.map(|(reference, _)| {
        let mut value = [0.0];
        let status = actuator.reals(&[reference], &mut value);
        (status, value[0].to_bits())
    });
    bits.collect()
}

/// Make the steps `from` to `to` under changing inputs. Returns the bits of all Reals after each step.
fn run(actuator: &Host, from: u32, to: u32, mass: f64) -> Vec<Vec<(Status, u64)>> {
    let h = 1e-3;
    let step = |n: u32| {
        let t = f64::from(n) * h;
        if n.is_multiple_of(5) {
            assert_eq!(actuator.set("valve.command", 0.9 * (f64::from(n)).sin()), Status::Ok);
            assert_eq!(actuator.set("actuator.reduced_mass", mass), Status::Ok);
            assert_eq!(actuator.set("actuator.holding_force", 300.0 + f64::from(n)), Status::Ok);
        }
        assert_eq!(actuator.set("actuator.speed", 0.02 * (0.1 * f64::from(n)).cos()), Status::Ok);
        if n.is_multiple_of(3) {
            assert_eq!(rates(actuator, "actuator.speed", &[0.1, -2.0, 30.0, 1e3]), Status::Ok);
        }
        let status = actuator.step(t, h);
        assert!(matches!(status, Status::Ok | Status::Warning), "{n}: {:?}", actuator.log.take());
        actuator.log.take();
        all_bits(actuator)
    };
    (from..to).map(step).collect()
}

#[test]
fn steps_after_a_saved_state_are_bit_identical() {
    for (mode, mass) in [("follow", 0.0), ("follow", 700.0), ("preview", 700.0)] {
        for at in [0, 7, 23] {
            let first = started(mode);
            run(&first, 0, at, mass);
            let mut state = State::NONE;
            assert_eq!(first.save_into(&mut state), Status::Ok);
            let bytes = first.serialize(&state).unwrap();
            let expected = run(&first, at, 60, mass);
            assert_eq!(first.restore(&state), Status::Ok);
            assert!(run(&first, at, 60, mass) == expected, "{mode} {mass} {at}: rolled back");
            let twin = started(if mode == "follow" { "preview" } else { "follow" });
            let mut read = twin.deserialize(&bytes).unwrap();
            assert_eq!(twin.restore(&read), Status::Ok);
            assert!(run(&twin, at, 60, mass) == expected, "{mode} {mass} {at}: in another instance");
            assert_eq!(twin.serialize(&read).unwrap(), bytes);
            assert_eq!(first.free(&mut state), Status::Ok);
            assert_eq!(twin.free(&mut read), Status::Ok);
        }
    }
}

#[test]
fn corrupted_states_are_rejected_and_change_nothing() {
    let host = started("preview");
    run(&host, 0, 11, 700.0);
    let mut state = State::NONE;
    assert_eq!(host.save_into(&mut state), Status::Ok);
    let bytes = host.serialize(&state).unwrap();
    let before = all_bits(&host);
    for at in 0..bytes.len() {
        let mut corrupted = bytes.clone();
        corrupted[at] ^= 0x41;
        assert!(host.deserialize(&corrupted).is_err(), "byte {at}");
    }
    assert!(host.deserialize(&bytes[..bytes.len() - 1]).is_err());
    assert!(all_bits(&host) == before);
    assert_eq!(host.free(&mut state), Status::Ok);
}

#[test]
fn a_reset_instance_is_a_new_one() {
    let host = started("follow");
    let expected = run(&host, 0, 10, 700.0);
    assert_eq!(host.set("valve.command", 5.0), Status::Ok);
    assert_eq!(host.reset(), Status::Ok);
    assert_eq!(host.set_item("coupling.mode", "follow"), Status::Ok);
    assert_eq!(host.set("actuator.length", 0.43), Status::Ok);
    assert_eq!(host.initialize(), Status::Ok);
    assert!(run(&host, 0, 10, 700.0) == expected);
}

#[test]
fn derivatives_are_those_of_differences() {
    let host = started("preview");
    run(&host, 0, 11, 700.0);
    let (speed, length) = (host.reference("actuator.speed"), host.reference("actuator.length"));
    let outputs = ["actuator.force", "power.piston", "chamber_a.flow", "preview.force", "preview.speed"];
    let outputs = outputs.map(|name| host.reference(name));
    for (input, e) in [(speed, 1e-5), (length, 1e-6)] {
        let mut exact = [0.0; 5];
        assert_eq!(host.derivatives(&outputs, input, &mut exact), Status::Ok);
        let mut value = [0.0];
        assert_eq!(host.reals(&[input], &mut value), Status::Ok);
        let at = |by: f64| {
            let mut values = [0.0; 5];
            assert_eq!(host.set_reals(&[input], &[value[0] + by]), Status::Ok);
            assert_eq!(host.reals(&outputs, &mut values), Status::Ok);
            assert_eq!(host.set_reals(&[input], &value), Status::Ok);
            values
        };
        let (low, high) = (at(-e), at(e));
        for k in 0..5 {
            let difference = (high[k] - low[k]) / (2.0 * e);
            let rounding = 1e-4 * difference.abs() + 1e-9 * high[k].abs() / e;
            assert!((exact[k] - difference).abs() <= rounding, "{input} {k}: {} {difference}", exact[k]);
        }
    }
    let references = [host.reference("preview.force"), host.reference("preview.force_mean")];
    let (mut of_outputs, mut rate) = ([f64::NAN; 2], [0.0]);
    // SAFETY: the component is valid; all arrays have two elements.
    let status = unsafe {
        fmi2GetRealOutputDerivatives(host.c, references.as_ptr(), 2, [1, 1].as_ptr(), of_outputs.as_mut_ptr())
    };
    assert_eq!(status, Status::Ok);
    assert_eq!(host.reals(&[host.reference("preview.force_rate")], &mut rate), Status::Ok);
    assert_eq!(of_outputs, [rate[0], 0.0]);
}

#[test]
fn orders_of_input_derivatives_are_those_that_count() {
    let host = started("follow");
    assert_eq!(rates(&host, "actuator.speed", &[0.1, 0.2, 0.3, 0.4]), Status::Ok);
    assert_eq!(rates(&host, "valve.command", &[0.1, 0.2]), Status::Ok);
    assert_eq!(rates(&host, "valve.command", &[0.1, 0.2, 0.3]), Status::Error);
    let text = host.log.take().pop().unwrap().text;
    assert!(text.contains("valve.command") && text.contains("1 to 2"), "{text}");
    assert_eq!(rates(&host, "actuator.speed", &[f64::NAN]), Status::Error);
    assert_eq!(rates(&host, "actuator.force", &[1.0]), Status::Error);
}

#[test]
fn a_warning_is_a_status_with_a_line_of_the_log() {
    let host = started("follow");
    assert_eq!(host.set("valve.command", 1.5), Status::Ok);
    assert_eq!(host.step(0.0, 1e-3), Status::Warning);
    let messages = host.log.take();
    let found = messages.iter().any(|message| message.status == 1 && message.text.contains("clipped"));
    assert!(found, "{messages:?}");
    assert_eq!(host.step(1e-3, 1e-3), Status::Ok);
}

#[test]
fn rejected_values_change_nothing() {
    let host = started("preview");
    run(&host, 0, 5, 700.0);
    let before = all_bits(&host);
    for (reference, variable) in (0..).zip(description().interface().list()) {
        let values = match variable.causality {
            Causality::Input => vec![f64::NAN, f64::INFINITY, f64::NEG_INFINITY],
            _ => vec![f64::NAN, 0.0, 1e300],
        };
        for value in values {
            assert_eq!(host.set_reals(&[reference], &[value]), Status::Error, "{} = {value}", variable.name);
        }
    }
    assert_eq!(host.set_reals(&[9999], &[1.0]), Status::Error);
    assert_eq!(host.set("supply.pressure", 1e300), Status::Error);
    assert_eq!(host.set_item("coupling.mode", "follow"), Status::Error);
    assert_eq!(host.step(5e-3, f64::NAN), Status::Error);
    assert_eq!(host.step(5e-3, -1.0), Status::Error);
    host.log.take();
    assert!(all_bits(&host) == before);
    // Absurd but legal values give values or an error, never NaN without a message.
    for (name, value) in [("actuator.speed", 1e300), ("supply.pressure", 1e12), ("actuator.reduced_mass", 1e-300)] {
        let host = started("preview");
        run(&host, 0, 5, 700.0);
        assert_eq!(host.set(name, value), Status::Ok);
        let status = host.step(5e-3, 1e-3);
        for (status, bits) in all_bits(&host) {
            assert!(status != Status::Ok || f64::from_bits(bits).is_finite(), "{name} = {value}");
        }
        assert!(matches!(status, Status::Ok | Status::Warning | Status::Discard | Status::Error), "{name}: {status:?}");
    }
}

#[test]
fn a_travel_beyond_the_cylinder_is_rejected_with_both_lengths() {
    let host = actuator();
    assert_eq!(host.set("actuator.length", 0.8), Status::Ok);
    assert_eq!(host.enter(), Status::Ok);
    assert_eq!(host.exit(), Status::Error);
    let text = host.log.take().pop().unwrap().text;
    assert!(text.contains("0.8 m") && text.contains("0.742 m"), "{text}");
    assert_eq!(host.set("actuator.length", 0.5), Status::Ok);
    assert_eq!(host.exit(), Status::Ok);
}
