//! Records of stops: number, time and impulse of impacts, against closed forms.

use crate::support::definition::{G, With, block};
use crate::support::{GEAR, Run, SLIDER_CRANK, changed};
use serde_json::{Value, json};
use std::fmt::Display;

const MASS: f64 = 3.5;

/// A block 2 m above the origin of its slide, with these stops.
fn above(stops: Value) -> Value {
    block(MASS).with(json!({
        "actuators": { "load": { "joint": "slide" } }, "start": { "position": 2.0 }, "guess": { "slide": 2.0 },
        "solver": { "tolerance": 1e-11 }, "stops": stops,
    }))
}

fn floor(restitution: f64) -> Value {
    json!({ "floor": { "joint": "slide", "position": 0.5, "limit": "lower", "restitution": restitution } })
}

/// The block under a constant weight, on a floor with this restitution.
pub fn bouncing(restitution: f64) -> String {
    changed(above(floor(restitution)), |m| m["actuators"]["load"]["force"] = json!(-MASS * G))
}

/// The block under its weight.
fn falling(definition: impl Display) -> Run {
    Run::new(definition).with(&[("load.force", -MASS * G)]).started()
}

/// Time and speed of the first impact of a block that falls by 1.5 m.
fn first_impact() -> (f64, f64) {
    let time = (2.0 * 1.5 / G).sqrt();
    (time, G * time)
}

#[test]
fn a_falling_block_gives_the_floor_its_momentum() {
    let (hit, speed) = first_impact();
    for restitution in [0.0, 0.3, 0.8] {
        let mut run = falling(above(floor(restitution)));
        assert_eq!(met(&mut run, "floor"), [0.0, -1.0, 0.0]);
        run.step(hit - 1e-6);
        assert_eq!(met(&mut run, "floor"), [0.0, -1.0, 0.0]);
        run.step(2e-6);
        let [count, time, impulse] = met(&mut run, "floor");
        let expected = MASS * speed * (1.0 + restitution);
        assert_eq!(count, 1.0);
        assert!((time - hit).abs() < 1e-12, "{time} {hit}");
        assert!((impulse - expected).abs() < 1e-9 * expected, "{impulse} {expected}");
        // Each flight is shorter than the previous flight by the factor of the restitution.
        let (mut next, mut flight) = (hit, 2.0 * restitution * speed / G);
        for bounce in 1..4 {
            if restitution == 0.0 {
                break;
            }
            (next, flight) = (next + flight, flight * restitution);
            run.step(next + 1e-6 - run.0.time());
            let [count, time, impulse] = met(&mut run, "floor");
            let expected = expected * restitution.powi(bounce);
            assert!(count == f64::from(bounce) + 1.0 && (time - next).abs() < 1e-8, "{count} {time} {next}");
            assert!((impulse - expected).abs() < 1e-7 * expected, "{impulse} {expected}");
        }
    }
}

/// A series of bounces until it ends, in one step and in many: the same record.
#[test]
fn all_bounces_of_a_series_count() {
    let restitution = 0.7_f64;
    let (mut whole, mut cut) = (falling(above(floor(restitution))), falling(above(floor(restitution))));
    whole.step(5.0);
    cut.steps(500, 5.0);
    let [count, time, impulse] = met(&mut whole, "floor");
    assert_eq!(met(&mut cut, "floor")[0], count);
    // Time of rest in closed form. A flight within the rounding of sigma, some 1e-14 m or 1e-7 s, counts as rest.
    let (hit, speed) = first_impact();
    let rest = hit + 2.0 * speed / G * restitution / (1.0 - restitution);
    assert!(count > 30.0 && (time - rest).abs() < 1e-6, "{count} {time} {rest}");
    assert!(impulse > 0.0 && impulse < 1e-2, "{impulse}");
    assert_eq!(whole.get("slide.speed"), 0.0);
    // A block at rest on the floor makes no impacts.
    whole.step(1.0);
    assert_eq!(met(&mut whole, "floor"), [count, time, impulse]);
}

/// The energy that the up stop absorbs follows from its impulse: P = I_z omega (1 + e) and E = I_z omega^2 (1 - e^2) /
/// 2 give E = P omega (1 - e) / 2, without the inertia of the gear.
#[test]
fn the_impulse_of_the_gear_fits_to_the_energy_lost() {
    let (hit, speed) = (0.132_059_852_744_259_7, 30.257_773_253_560_312);
    for restitution in [0.0, 0.5] {
        let values = [("solver.tolerance", 1e-12), ("upstop.restitution", restitution)];
        let mut gear = Run::gear().with(&values).started();
        let energy = |gear: &mut Run| gear.get("energy.kinetic");
        gear.step(hit - 1e-9);
        let before = energy(&mut gear);
        gear.step(2e-9);
        let lost = before - energy(&mut gear);
        let [count, time, impulse] = met(&mut gear, "upstop");
        assert_eq!(count, 1.0);
        assert!((time - hit).abs() < 1e-12, "{time}");
        let expected = impulse * speed * (1.0 - restitution) / 2.0;
        assert!((lost - expected).abs() < 1e-6 * expected, "{lost} {expected}");
    }
}

/// The recorded impulse of a bumper is the momentum at first contact: reduced mass times speed.
#[test]
fn a_bumper_records_the_incoming_momentum() {
    let bumper = json!({ "pad": { "joint": "slide", "position": 0.5, "limit": "lower", "rigid": false,
        "stiffness": 4e4, "damping": 100.0 } });
    let mut run = falling(above(bumper));
    let (hit, speed) = first_impact();
    run.step(hit + 1e-3);
    let [count, time, impulse] = met(&mut run, "pad");
    assert!(count == 1.0 && (time - hit).abs() < 1e-9, "{count} {time}");
    assert!((impulse - MASS * speed).abs() < 1e-8 * impulse, "{impulse}");
    run.step(2.0);
    assert!(met(&mut run, "pad")[0] > 2.0);
}

#[test]
fn initialisation_clears_the_record() {
    let mut run = falling(above(floor(0.8)));
    run.steps(20, 1.0);
    assert!(met(&mut run, "floor")[0] > 0.0);
    run.initialize();
    assert_eq!(met(&mut run, "floor"), [0.0, -1.0, 0.0]);
}

/// Outputs that change only at events have the rate 0.
#[test]
fn the_record_has_no_rates() {
    let mut gear = Run::gear().started();
    gear.step(0.2);
    for part in ["impact_count", "impact_time", "impact_impulse"] {
        assert_eq!(gear.derivative(&format!("upstop.{part}")), 0.0);
    }
}

/// A step that the bound on work interrupts counts the impacts of the part that was made.
#[test]
fn a_step_made_in_part_counts_its_part() {
    let definition = changed(above(floor(0.9)), |m| m["solver"] = json!({ "tolerance": 1e-9, "max_steps": 40 }));
    let mut run = falling(definition);
    assert!(run.0.step(10.0).is_err());
    let (reached, [count, time, _]) = (run.0.time(), met(&mut run, "floor"));
    assert!(count > 1.0 && time <= reached && reached < 10.0, "{count} {time} {reached}");
}

#[test]
fn every_stop_has_a_record() {
    for definition in [GEAR, SLIDER_CRANK] {
        let run = Run::new(definition);
        let stops = run.0.names().filter(|name| name.ends_with(".impact_count")).count();
        let stated: Value = serde_json::from_str(definition).unwrap();
        assert_eq!(stops, stated["stops"].as_object().map_or(0, serde_json::Map::len));
    }
}

fn met(run: &mut Run, stop: &str) -> [f64; 3] {
    ["impact_count", "impact_time", "impact_impulse"].map(|part| run.get(&format!("{stop}.{part}")))
}
