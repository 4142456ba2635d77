//! Saved states, failed steps and faulty circuits.
use super::*;
use crate::support::{assert_rejected, refusal};
use std::f64::consts::PI;

#[test]
fn faulty_circuits_are_rejected_with_their_key() {
    assert_rejected("circuits", HYDRAULIC_GEAR);
    let other = changed(HYDRAULIC_GEAR, |gear| gear["actuators"]["other"] = gear["actuators"]["actuator"].clone());
    assert_says(refusal(other), &["actuators.other.hydraulics", "actuator already has a hydraulic circuit"]);
    let mut gear = Run::shared(HYDRAULIC_GEAR).with(&[("cylinder.rod", 0.06)]);
    assert_says(gear.refusal(), &["cylinder.rod"]);
    let mut gear = Run::shared(HYDRAULIC_GEAR);
    gear.set("solver.method", "rigid_fem");
    assert_says(gear.refusal(), &["hydraulics", "rigid_fem", "reduced"]);
    let mut gear = retraction(1e-9);
    gear.set("tank.pressure", -2e5);
    assert_says(gear.0.step(1e-3).unwrap_err(), &["tank.pressure", "fluid.ambient_pressure"]);
    gear.set("tank.pressure", 0.35e6);
    gear.step(1e-3);
    assert!(gear.0.set("actuator.force", 1.0).is_err());
    assert!(gear.0.set_derivative("actuator.force", 1, 1.0).is_err());
}

/// Oil without air in chambers that the gear's weight expands, with valves that let no oil in.
#[test]
fn oil_without_air_has_no_pressure_below_absolute_zero() {
    let mut gear = retraction(1e-9);
    gear.set_all(&[("fluid.air_fraction", 0.0), ("anticavitation.conductance", 0.0), ("command.ramp_amplitude", 0.0)]);
    gear.set_all(&[
        ("chamber_a.start_pressure", 0.4e6),
        ("chamber_b.start_pressure", 0.4e6),
        ("tank.pressure", 0.35e6),
    ]);
    gear.set("load_factor", 60.0);
    gear.initialize();
    let error = (0..500).find_map(|_| gear.0.step(1e-3).err()).unwrap().to_string();
    assert_says(error, &["chamber_", "absolute", "fluid.air_fraction"]);
}

/// A changed input acts at once, although steps may extend beyond the communication point.
#[test]
fn a_change_of_a_port_takes_effect_at_once() {
    for (name, value) in [("valve.command", -0.3), ("supply.pressure", 15e6), ("tank.pressure", 1e6)] {
        let end = |steps: u32| {
            let mut gear = retraction(1e-11);
            gear.steps(steps, 0.5);
            gear.set(name, value);
            gear.steps(steps, 0.05);
            (gear.get("crank.angle"), gear.get("chamber_a.pressure"), gear.get("energy.supplied"))
        };
        let (whole, many) = (end(1), end(500));
        assert!((whole.0 - many.0).abs() < 1e-9, "{name}: {whole:?} {many:?}");
        assert!((whole.1 / many.1 - 1.0).abs() < 1e-8 && (whole.2 / many.2 - 1.0).abs() < 1e-9, "{name}");
    }
}

/// With a circuit the start `equilibrium` is rejected. Its remedy: start pressures whose force is the holding force
/// give an equilibrium.
#[test]
fn start_pressures_of_the_holding_force_give_an_equilibrium() {
    let gear = || {
        let mut gear = Run::shared(HYDRAULIC_GEAR);
        gear.set_all(&[("downstop.enabled", false), ("upstop.enabled", false)]);
        gear.with(&[("crank.start_angle", 0.3), ("command.ramp_amplitude", 0.0), ("command.sine_amplitude", 0.0)])
    };
    let mut first = gear().started();
    let holding = first.get("actuator.holding_force");
    assert!(holding.abs() > 100.0 && first.get("crank.acceleration").abs() > 0.1);
    let [bore, rod] = ["cylinder.bore", "cylinder.rod"].map(|name| first.get(name));
    let (piston, ring) = (PI / 4.0 * bore * bore, PI / 4.0 * (bore * bore - rod * rod));
    let b = 8e6;
    let a = (holding + b * ring) / piston;
    let mut rests = gear().with(&[("chamber_a.start_pressure", a), ("chamber_b.start_pressure", b)]).started();
    assert!(rests.get("crank.acceleration").abs() < 1e-9, "{}", rests.get("crank.acceleration"));
}

/// Implicit steps keep a Jacobian across communication steps. A saved and restored state keeps it too.
#[test]
fn steps_share_a_jacobian_that_a_saved_state_contains() {
    let mut gear = retraction(1e-3);
    let mut other = retraction(1e-3);
    for step in 0..200 {
        if step % 7 == 3 {
            let mut bytes = Vec::new();
            gear.snapshot().write(&mut bytes).unwrap();
            let state = other.read_snapshot(&bytes).unwrap();
            other.restore(&state).unwrap();
        }
        for gear in [&mut gear, &mut other] {
            gear.step(0.02);
        }
        assert_eq!(gear.get("crank.angle").to_bits(), other.get("crank.angle").to_bits(), "{step}");
    }
    let statistics = gear.0.model().statistics();
    assert!(statistics.jacobians < 40, "{statistics:?}");
    assert!(statistics.accepted_by(linkage_fmu::integrator::Method::Radau) > 150, "{statistics:?}");
}
