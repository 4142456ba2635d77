//! The landing gear with a hydraulic circuit on its actuator, as a single system. The reference values are from an
//! independent Taylor-series integration of gear and circuit. Its results in double and in 80 bit agree to 2e-13.

use crate::support::{HYDRAULIC_GEAR, Run, assert_says, cases, changed, numbers, read_all};
use serde_json::json;

mod accumulator;
mod cavitation;
mod ends;
mod faults;
pub mod reference;

/// Time [s]; angle [rad] and speed [rad/s] of the crank; pressures of the chambers [Pa]; force [N]; length [m] and
/// speed [m/s] of the actuator.
pub type Row = [f64; 8];

const NAMES: [&str; 7] = [
    "crank.angle",
    "crank.speed",
    "chamber_a.pressure",
    "chamber_b.pressure",
    "actuator.force",
    "actuator.length",
    "actuator.speed",
];
/// Largest value of each quantity in both scenes. Errors are relative to it where a value passes through 0.
const SIZES: [f64; 7] = [1.0, 0.5, 1e7, 1e7, 5e3, 0.5, 0.08];

/// The retraction scene, with this tolerance.
fn retraction(tolerance: f64) -> Run {
    let mut gear = Run::shared(HYDRAULIC_GEAR);
    gear.set("downstop.enabled", false);
    let command = [("command.ramp_amplitude", 0.65), ("command.ramp_time", 0.1)];
    gear.with(&[("solver.tolerance", tolerance)]).with(&command).started()
}

/// The vibration scene, with this tolerance.
fn vibration(tolerance: f64) -> Run {
    let mut gear = Run::shared(HYDRAULIC_GEAR);
    gear.set_all(&[("downstop.enabled", false), ("upstop.enabled", false)]);
    gear.set_all(&[
        ("fluid.air_fraction", 0.0),
        ("seal.coulomb", 0.0),
        ("seal.static", 0.0),
        ("seal.viscous", 0.0),
        ("cushion_a.length", 0.0),
        ("cushion_b.length", 0.0),
        ("crank.start_angle", 0.0),
        ("chamber_a.start_pressure", 8e6),
        ("chamber_b.start_pressure", 10.08e6),
        ("command.ramp_amplitude", 0.0),
        ("command.sine_amplitude", 0.5),
        ("command.sine_frequency", 2.0),
        ("solver.tolerance", tolerance),
    ]);
    gear.started()
}

/// `energy.drift` is the energy gained since the start minus the work of the piston and the losses of the stops. The
/// energies of the circuit balance too.
#[track_caller]
fn balances(gear: &mut Run, allowed: f64) {
    let supplied = gear.get("energy.supplied").abs().max(gear.get("energy.throttling").abs());
    let (balance, drift) = (gear.get("energy.balance"), gear.get("energy.drift"));
    assert!(balance.abs() <= allowed * supplied, "balance {balance:e} J of {supplied:e} J");
    let worked = gear.get("energy.piston").abs().max(100.0);
    assert!(drift.abs() <= 10.0 * allowed * worked, "drift {drift:e} J of {worked:e} J");
}

#[test]
fn energies_balance_at_a_common_tolerance_whatever_the_steps() {
    let end = *numbers::<Vec<Row>>(reference::REFERENCE, "retraction").last().unwrap();
    for (h, steps) in [(1e-3, 4000), (0.02, 200), (1.0, 4)] {
        let mut gear = retraction(1e-9);
        for _ in 0..steps {
            gear.step(h);
        }
        balances(&mut gear, 1e-8);
        let error = gear.get("crank.angle") - end[1];
        assert!(error.abs() < 1e-8, "{h} s: {error:e}");
    }
}

#[test]
fn the_work_of_the_piston_is_the_energy_gained_by_the_gear() {
    let mut gear = retraction(1e-12);
    let before = gear.get("energy.kinetic") + gear.get("energy.potential");
    gear.steps(40, 4.0);
    let gained = gear.get("energy.kinetic") + gear.get("energy.potential") - before;
    let error = gained / gear.get("energy.piston") - 1.0;
    assert!(error.abs() < 1e-12, "{error:e}");
}

/// At the stop the mechanism rests while the pressures continue to change. The opposite command moves it off the stop.
#[test]
fn the_circuit_continues_while_a_stop_holds_the_gear() {
    for restitution in [0.0, 0.4] {
        let mut gear = retraction(1e-10);
        gear.set("upstop.restitution", restitution);
        gear.initialize();
        gear.steps(41, 4.1);
        let impact = gear.get("chamber_a.pressure");
        gear.steps(900, 0.9);
        assert!(gear.is("retracted"));
        assert_eq!(gear.get("crank.speed"), 0.0);
        // Chamber A fills to the supply pressure, chamber B empties to the tank pressure, except for leakage.
        assert!(gear.get("chamber_a.pressure") > impact.max(20.0e6) && gear.get("chamber_a.pressure") < 20.7e6);
        assert!(gear.get("chamber_b.pressure") < 1e6 && gear.get("chamber_b.pressure") > 0.35e6);
        let force = gear.get("actuator.force");
        let [area_a, area_b] =
            [0.045_f64.powi(2), 0.045_f64.powi(2) - 0.025_f64.powi(2)].map(|d| d * 0.25 * std::f64::consts::PI);
        let expected = gear.get("chamber_a.pressure") * area_a - gear.get("chamber_b.pressure") * area_b;
        assert!((force / expected - 1.0).abs() < 1e-12, "{force} {expected}");
        assert!(gear.get("upstop.torque").abs() > 100.0);
        balances(&mut gear, 1e-7);
        // While nothing moves, the supply delivers no power except for leakage.
        assert!(gear.get("power.supply") < 100.0);
        gear.set("valve.command", -1.3);
        gear.steps(1000, 1.0);
        assert!(!gear.is("retracted"));
        assert!(gear.get("crank.angle") > -1.29 && gear.get("crank.speed") > 0.01, "{}", gear.get("crank.angle"));
        balances(&mut gear, 1e-7);
    }
}

/// The gear starts to move from rest at the time at which the forces balance, for any communication step and tolerance.
#[test]
fn the_gear_moves_off_when_the_pressures_exceed_the_load() {
    let angle = |tolerance: f64, steps: u32| {
        let mut gear = retraction(tolerance);
        gear.steps(5, 5.0);
        gear.set("valve.command", -1.3);
        gear.steps(steps, 0.4);
        (gear.get("crank.angle"), gear.get("crank.speed"), gear.get("chamber_b.pressure"))
    };
    let one = angle(1e-11, 1);
    assert!(one.0 > -1.299 && one.1 > 0.0, "{one:?}");
    for (tolerance, steps) in
        [(1e-11, 400), (1e-11, 20), (1e-13, 1), (1e-13, 20), (1e-13, 400), (1e-12, 7), (1e-12, 50)]
    {
        let many = angle(tolerance, steps);
        assert!((one.0 - many.0).abs() < 1e-10 && (one.2 - many.2).abs() < 1e-3, "{one:?} {many:?}");
    }
    let mut held = retraction(1e-11);
    held.steps(5, 5.0);
    held.set("uplock.engage", true);
    held.set("valve.command", -1.3);
    held.steps(4, 0.4);
    assert!((held.get("crank.angle") + 1.3).abs() < 1e-15);
    assert!(held.get("chamber_b.pressure") > 20e6 && held.get("chamber_a.pressure") < 1e6);
    assert!(held.get("uplock.force").abs() > 1000.0);
    balances(&mut held, 1e-7);
}

#[test]
fn energies_balance_with_friction_bumpers_and_air() {
    let mut gear = retraction(1e-10);
    gear.set("friction.enabled", true);
    gear.set("airspeed", 70.0);
    gear.initialize();
    gear.steps(430, 4.3);
    assert!(gear.get("joint1.friction_torque").is_finite());
    balances(&mut gear, 1e-8);
    let bumper = changed(HYDRAULIC_GEAR, |gear| {
        gear["stops"]["upstop"] = json!({
            "body": "crank", "limit": "lower", "angle": -1.2, "rigid": false, "stiffness": 1e5, "damping": 1e3,
                "flag": "retracted"
        });
        gear["stops"]["downstop"]["enabled"] = json!(false);
        let command = &mut gear["actuators"]["actuator"]["hydraulics"]["command"];
        *command = json!({ "ramp_amplitude": 0.65, "ramp_time": 0.1 });
        gear["solver"]["tolerance"] = json!(1e-10);
    });
    let mut gear = Run::new(&bumper).started();
    gear.steps(430, 4.3);
    assert!(gear.get("upstop.torque") > 100.0, "{}", gear.get("upstop.torque"));
    balances(&mut gear, 1e-8);
}

#[test]
fn a_ramp_may_be_an_input_derivative_and_is_clipped_at_one() {
    let mut gear = retraction(1e-12);
    let mut by_input = retraction(1e-12);
    by_input.set("command.ramp_amplitude", 0.0);
    by_input.initialize();
    for k in 0..4 {
        if k < 2 {
            by_input.set_derivative("valve.command", 1, 6.5);
        }
        gear.step(0.05);
        by_input.step(0.05);
        assert!((gear.get("crank.angle") - by_input.get("crank.angle")).abs() < 1e-12);
    }
    assert_eq!(by_input.get("valve.command"), 0.65);
    // A ramp to 3 in 0.3 s is clipped at 1 from 0.1 s on, for any communication points.
    let clipped = |steps: u32, ramp: [f64; 2]| {
        let mut gear = retraction(1e-12);
        gear.set_all(&[("command.ramp_amplitude", ramp[0]), ("command.ramp_time", ramp[1])]);
        gear.initialize();
        gear.steps(steps, 0.5);
        (gear.get("crank.angle"), gear.get("valve.position"))
    };
    let expected = clipped(1, [1.0, 0.1]);
    for steps in [1, 7, 500] {
        let found = clipped(steps, [3.0, 0.3]);
        assert!((found.0 - expected.0).abs() < 1e-11 && (found.1 - 1.0).abs() < 1e-9, "{found:?} {expected:?}");
    }
}

#[test]
fn every_output_has_a_value() {
    let mut gear = retraction(1e-13);
    gear.set("friction.enabled", true);
    gear.initialize();
    gear.set("valve.command", 0.05);
    gear.steps(16, 0.0793);
    assert!(read_all(&mut gear).is_empty());
}
