//! The motion without tables: each evaluation closes the loops and balances the forces again.

use crate::support::{ANDREWS, CHAIN, CRANE, FOUR_BAR, GEAR, Run, SL_CRANK};

fn start(text: &str, tables: bool, flags: &[&str], values: &[(&str, f64)]) -> Run {
    let mut run = Run::new(text);
    assert!(run.is("solver.tables"), "tables are the default");
    run.set("solver.tables", tables);
    flags.iter().for_each(|flag| run.set(flag, true));
    run.with(values).started()
}

/// Ten steps over `span` with and without tables: these outputs agree to `miss`, relative to their size.
fn agree(text: &str, flags: &[&str], values: &[(&str, f64)], span: f64, outputs: &[&str], miss: f64) {
    let values = [values, &[("solver.tolerance", 1e-12)]].concat();
    let mut with = start(text, true, flags, &values);
    let mut without = start(text, false, flags, &values);
    for _ in 0..10 {
        with.step(0.1 * span);
        without.step(0.1 * span);
        for name in outputs {
            let (a, b) = (with.get(name), without.get(name));
            assert!((a - b).abs() < miss * a.abs().max(1.0), "{name}: {a} with tables, {b} without");
        }
    }
}

#[test]
fn the_gear_has_the_same_motion_with_and_without_tables() {
    agree(GEAR, &[], &[], 0.13, &["crank.angle", "crank.speed", "joint2.force"], 1e-11);
    // The results differ in the last digits, as the computation is another.
    let mut both = [true, false].map(|tables| start(GEAR, tables, &[], &[]));
    let differ = (0..10).any(|_| {
        both.iter_mut().for_each(|run| run.step(0.01));
        let [with, without] = both.each_mut().map(|run| run.get("crank.speed").to_bits());
        with != without
    });
    assert!(differ);
}

#[test]
fn the_gear_has_the_same_motion_with_friction_wind_and_stops() {
    let flags = ["friction.enabled", "air.relative_wind"];
    agree(GEAR, &flags, &[("airspeed", 70.0)], 0.13, &["crank.angle", "crank.speed", "joint2.force"], 1e-9);
    // To the up stop and back. Static friction is stiff at V_S = 1e-5 m/s.
    let slow = [("friction.static_speed", 1e-5), ("upstop.restitution", 0.5)];
    agree(GEAR, &flags[..1], &slow, 0.3, &["crank.angle"], 1e-9);
}

#[test]
fn other_mechanisms_have_equal_motions() {
    let outputs = ["energy.kinetic"];
    agree(ANDREWS, &[], &[], 0.03, &outputs, 1e-7);
    agree(SL_CRANK, &[], &[], 1.0, &outputs, 1e-9);
    agree(CHAIN, &[], &[], 1.0, &outputs, 1e-9);
    agree(CRANE, &[], &[], 0.1, &outputs, 1e-9);
    // Full turns on a closed curve.
    agree(FOUR_BAR, &[], &[], 2.0, &outputs, 1e-9);
}

#[test]
fn changing_inputs_and_saved_states_have_equal_effects() {
    let run = |tables: bool| {
        let mut gear = start(GEAR, tables, &[], &[("solver.tolerance", 1e-12)]);
        gear.set_derivative("actuator.force", 1, -1e5);
        gear.step(0.03);
        let saved = gear.snapshot();
        gear.step(0.05);
        let first = gear.get("crank.angle");
        gear.restore(&saved).unwrap();
        gear.step(0.05);
        assert_eq!(first, gear.get("crank.angle"));
        first
    };
    assert!((run(true) - run(false)).abs() < 1e-11);
}
