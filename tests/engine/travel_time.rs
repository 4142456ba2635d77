//! The time of travel by the energy integral, against closed forms and the steps of the integration.
use crate::support::GEAR;
use crate::support::definition::{With, arm, weight};
use linkage_fmu::simulation::{Simulation, SimulationError};
use serde_json::json;
use std::f64::consts::FRAC_PI_2;

/// A model at its start.
fn started(text: &str) -> Simulation {
    let mut model = Simulation::open(text).unwrap();
    model.initialize().unwrap();
    model
}

/// A rod that falls from the horizontal to the vertical: a quarter of the period of a pendulum with an amplitude of 90
/// degrees, K(sin 45 deg) sqrt(I / (m g r)) = K sqrt(2 l / (3 g)) under the gravity g.
#[test]
fn a_rod_falls_in_a_quarter_of_its_period() {
    const K: f64 = 1.854_074_677_301_371_9;
    let rod = arm(0.6, 2.0, 0.0).with(json!({
        "gravity": weight(),
        "stops": { "low": { "body": "arm", "limit": "lower", "angle": -FRAC_PI_2, "flag": "down" } },
    }));
    let of = started(&rod.to_string()).travel_time("down", &["load_factor"], &[1.0]).unwrap().unwrap();
    // With gravity upwards or without gravity the rod does not fall.
    let factors = [1.0, 4.0, 0.01, -1.0, 0.0, f64::NAN, 1e300, f64::INFINITY];
    let mut times = [0.0_f64; 8];
    of.times(&factors, &mut times);
    for (factor, time) in factors.iter().zip(times) {
        let exact = K * (2.0 * 0.6 / (3.0 * 9.81 * factor)).sqrt();
        assert!(
            if *factor > 0.0 && exact > 0.0 { (time / exact - 1.0).abs() < 1e-12 } else { time.is_nan() },
            "{factor}: {time}"
        );
    }
}

/// For many forces and load factors the times agree with steps at the smallest tolerance. Outside of the range, and for
/// too small forces, there is no time or the right one. A time does not depend on the other elements of the call.
#[test]
fn times_are_those_of_the_steps() {
    let mut gear = started(GEAR);
    let inputs = ["actuator.force", "load_factor"];
    let samples: Vec<f64> =
        (0..64).flat_map(|k| [28e3 + 12e3 * f64::from(k * 5 % 64) / 63.0, 1.0 + f64::from(k) / 31.5]).collect();
    let of = gear.travel_time("retracted", &inputs, &samples).unwrap().unwrap();
    let points: Vec<f64> = (0..35).flat_map(|k| [15e3 + 1e3 * f64::from(k), f64::from(k * 11 % 35) / 10.0]).collect();
    let mut times = vec![0.0; 35];
    of.times(&points, &mut times);
    gear.set("solver.tolerance", 1e-13).unwrap();
    let mut found = 0;
    for (point, found_time) in points.chunks_exact(2).zip(&times) {
        inputs.iter().zip(point).for_each(|(name, value)| gear.set(name, *value).unwrap());
        gear.initialize().unwrap();
        gear.step(0.5).unwrap();
        let exact = gear.get("upstop.impact_time").unwrap();
        let inside = point[0] >= 28e3 && (1.0..=3.0).contains(&point[1]);
        println!("{point:?}: {found_time} {exact} {:e}", found_time - exact);
        assert!(
            if inside || !found_time.is_nan() { (found_time - exact).abs() < 1e-11 } else { true },
            "{point:?}: {found_time} {exact}"
        );
        found += usize::from(!found_time.is_nan());
        let mut alone = [0.0_f64];
        of.times(point, &mut alone);
        assert_eq!(alone[0].to_bits(), found_time.to_bits());
    }
    assert!(found > 15, "{found}");
}

/// The integral is not offered for losses, a start in motion, a bumper, a lock that holds, or an input that is no load.
#[test]
fn where_the_integral_does_not_hold_there_is_no_function() {
    let of = |gear: &Simulation, inputs: &[&str]| gear.travel_time("retracted", inputs, &[3e4]).unwrap();
    let mut gear = started(GEAR);
    assert!(of(&gear, &["actuator.force"]).is_some());
    assert!(of(&gear, &["airspeed"]).is_none());
    assert!(of(&gear, &["crank.mass"]).is_none());
    assert!(gear.travel_time("crank.angle", &["actuator.force"], &[3e4]).unwrap().is_none());
    // This force is too small.
    assert!(gear.travel_time("retracted", &["actuator.force"], &[1e3]).unwrap().is_none());
    type Change = fn(&mut Simulation) -> Result<(), SimulationError>;
    let changes: [Change; 5] = [
        |gear| gear.set("airspeed", 80.0),
        |gear| gear.set("crank.start_speed", -0.1),
        |gear| gear.set("friction.enabled", true),
        |gear| gear.set("upstop.rigid", false),
        |gear| gear.set("solver.method", "rigid_fem"),
    ];
    for (k, change) in changes.iter().enumerate() {
        let mut other = started(GEAR);
        change(&mut other).unwrap();
        // A bumper needs a stiffness.
        other.set("upstop.stiffness", 1e6).unwrap();
        other.initialize().unwrap();
        assert!(of(&other, &["actuator.force"]).is_none(), "change {k}");
    }
    gear.set("downlock.engage", true).unwrap();
    gear.initialize().unwrap();
    assert!(of(&gear, &["actuator.force"]).is_none());
}
