//! Retraction and vibration of the gear with its circuit, against reference values.
use super::*;
use crate::support::numbers;
use std::collections::BTreeMap;

/// State and energies of both scenes, with their source.
pub const REFERENCE: &str = include_str!("../../fixtures/hydraulic_gear.json");

#[track_caller]
fn agrees(gear: &mut Run, row: &Row, digits: f64) {
    for ((name, expected), size) in NAMES.iter().zip(&row[1..]).zip(SIZES) {
        let value = gear.get(name);
        let error = (value - expected).abs() / size.max(expected.abs());
        assert!(error <= digits, "{} s {name} = {value}: {expected}, off by {error:e}", row[0]);
    }
}

/// Step to these times, in communication steps of `h`.
fn follow(gear: &mut Run, rows: &[Row], h: f64, digits: f64) {
    let mut steps = 0;
    for row in rows {
        let end = (row[0] / h).round() as u64;
        while steps < end {
            gear.step((steps + 1) as f64 * h - steps as f64 * h);
            steps += 1;
        }
        agrees(gear, row, digits);
    }
}

#[test]
fn the_retraction_follows_the_reference() {
    // From rest at 0.8 rad, with air in the oil, cushions and seal friction.
    let rows: Vec<Row> = numbers(REFERENCE, "retraction");
    let mut gear = retraction(1e-12);
    follow(&mut gear, &rows, 0.05, 1e-11);
    gear.near("valve.position", 0.65, 1e-11);
    let mut gear = retraction(1e-12);
    follow(&mut gear, &rows[..1], 0.05, 1e-11);
    gear.near("valve.position", 0.29741314344, 1e-10);
}

#[test]
fn the_gear_is_up_at_the_reference_time_with_the_reference_energies() {
    let mut gear = retraction(1e-12);
    gear.set("upstop.enabled", false);
    gear.initialize();
    let [time, ..]: Row = numbers(REFERENCE, "retracted");
    gear.step(time);
    let time = (gear.get("crank.angle") + 1.3) / -gear.get("crank.speed");
    assert!(time.abs() < 1e-10, "{time:e}");
    have_energies(&mut gear, "retracted_energies");
}

#[test]
fn the_vibration_follows_the_reference() {
    // Oscillation about 0 rad under a sinusoidal command, without air, cushions and friction.
    let mut gear = vibration(1e-12);
    follow(&mut gear, &numbers::<Vec<Row>>(REFERENCE, "vibration"), 0.05, 1e-11);
    have_energies(&mut gear, "vibration_energies");
}

fn have_energies(gear: &mut Run, group: &str) {
    for (name, expected) in numbers::<BTreeMap<String, f64>>(REFERENCE, group) {
        let error = gear.get(&name) / expected - 1.0;
        assert!(error.abs() < 1e-10, "{name}: off by {error:e}");
    }
}
