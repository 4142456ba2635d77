//! Locks of a mechanism that the pressures of its hydraulic network release and engage within steps.

use crate::support::{Run, changed};
use linkage_fmu::mechanism::{Pauses, Reached};
use serde_json::json;

const ARM: &str = include_str!("../../modelDescription/LiftArm/resources/mechanism.json");
/// Pressure at which the lock releases [Pa].
const RELEASE: f64 = 14e6;

/// An arm that a lock holds at its lower stop. It rises when the oil releases the lock, reverses under the opposite
/// command, and returns to the stop.
fn definition(hysteresis: f64, tolerance: f64) -> String {
    changed(ARM, |arm| {
        arm["stops"] = json!({ "low": { "body": "arm", "limit": "lower", "angle": 0.1 } });
        arm["locks"] = json!({ "latch": { "stop": "low", "at": "arm.end", "engage": true } });
        arm["hydraulics"]["pressure_locks"] = json!({
            "latch": { "at": "lift.a", "release_pressure": RELEASE, "hysteresis": hysteresis }
        });
        arm["hydraulics"]["cylinders"]["lift"]["chamber_a"]["start_pressure"] = json!(2e6);
        arm["solver"]["tolerance"] = json!(tolerance);
    })
}

fn arm(hysteresis: f64, tolerance: f64) -> Run {
    Run::new(definition(hysteresis, tolerance)).started()
}

/// The command of the valve from a time on, as a host sets it.
fn command(arm: &mut Run, time: f64) {
    arm.set("lift_valve.command", 1.0 - time);
    arm.set_derivative("lift_valve.command", 1, -1.0);
}

/// Equal steps between two times. Returns the reported events.
fn run(arm: &mut Run, [from, to]: [f64; 2], count: u32) -> Vec<String> {
    let h = (to - from) / f64::from(count);
    let mut lines = Vec::new();
    arm.listen(true, false);
    for k in 0..count {
        let time = from + f64::from(k) * h;
        command(arm, time);
        arm.step(h);
        lines.extend(arm.take_occurrences(time).into_iter().map(|line| line.text));
    }
    lines
}

/// Steps of at most `h` that end at each event, which the host then handles. Returns the times at which the lock
/// changes.
fn run_to_events(arm: &mut Run, [from, to]: [f64; 2], h: f64) -> Vec<f64> {
    let (mut time, mut changes) = (from, Vec::new());
    while time < to - 1e-12 {
        command(arm, time);
        let h = h.min(to - time);
        let reached = arm.step_to_pause(Some(time), h, Pauses { at_events: true, at_steps: false }).unwrap();
        time += reached.time(h);
        if matches!(reached, Reached::Event(_)) {
            let (was, forces) = (arm.is("latch.engaged"), [arm.get("latch.force"), arm.get("arm.acceleration")]);
            let jumps = arm.handle_event(Some(time)).unwrap();
            if arm.is("latch.engaged") != was {
                changes.push(time);
                assert!(!jumps);
            }
            if was && !arm.is("latch.engaged") {
                // The lock holds up to the event and is released after it.
                assert_eq!(arm.get("lift.chamber_a.pressure"), RELEASE);
                assert!(forces[0] > 1e3 && forces[1] == 0.0, "{forces:?}");
                assert!(arm.get("latch.force") == 0.0 && arm.get("arm.acceleration") > 1.0);
            }
        }
    }
    changes
}

const STATE: [&str; 7] = [
    "arm.angle",
    "arm.speed",
    "lift.chamber_a.pressure",
    "guy.chamber_b.pressure",
    "gallery.pressure",
    "lift_valve.position",
    "energy.throttling",
];

#[track_caller]
fn assert_agree(one: &[f64], other: &[f64], allowed: f64) {
    for ((name, one), other) in STATE.iter().zip(one).zip(other) {
        assert!((one - other).abs() <= allowed * other.abs(), "{name}: {one:e} and {other:e}");
    }
}

/// With a hysteresis of 9 MPa the lock engages while the arm rises, and catches the arm at the stop. With 13.5 MPa it
/// engages when the arm rests at the stop. Without hysteresis it changes whenever the pressure passes one value.
#[test]
fn results_do_not_depend_on_the_communication_step() {
    for (hysteresis, span, last) in
        [(9e6, 1.5, "engages"), (9e6, 3.0, "holds"), (13.5e6, 3.0, "holds"), (0.0, 1.0, "lock latch")]
    {
        let state = |arm: &mut Run| STATE.map(|name| arm.get(name));
        let mut whole = arm(hysteresis, 1e-11);
        let expected = run(&mut whole, [0.0, span], 1);
        assert!(expected[1].ends_with("lock latch releases") && expected.last().unwrap().contains(last));
        let end = state(&mut whole);
        for h in [1e-2, 1e-3] {
            let mut other = arm(hysteresis, 1e-11);
            assert_eq!(run(&mut other, [0.0, span], (span / h) as u32), expected, "{h}");
            assert_agree(&state(&mut other), &end, 1e-9);
        }
        // A host that handles each event, with one step from event to event or with short steps.
        let mut changes = Vec::new();
        for h in [span, 1e-2] {
            let mut other = arm(hysteresis, 1e-11);
            changes.push(run_to_events(&mut other, [0.0, span], h));
            assert_agree(&state(&mut other), &end, 1e-9);
        }
        assert!(changes[0].len() == changes[1].len() && changes[0].len() >= 2, "{changes:?}");
        for (one, other) in changes[0].iter().zip(&changes[1]) {
            assert!((one - other).abs() < 1e-11, "{changes:?}");
        }
    }
}

/// With constant inputs internal steps extend beyond the communication step.
#[test]
fn a_step_ahead_ends_where_the_lock_changes() {
    let mut ends = [1, 130, 1300].map(|count| {
        let mut arm = arm(9e6, 1e-11);
        arm.set("lift_valve.command", 1.0);
        arm.steps(count, 0.13);
        (STATE.map(|name| arm.get(name)), arm.is("latch.engaged"))
    });
    let (whole, engaged) = ends[0];
    assert!(whole[0] > 0.11 && engaged);
    for (end, engaged) in &mut ends[1..] {
        assert_agree(end, &whole, 1e-9);
        assert!(*engaged);
    }
}

/// A run, its saved state and a run after a reset continue with the same numbers: from rest in the lock, from the rise
/// before the lock engages, and after it.
#[test]
fn a_saved_state_and_a_reset_continue_as_the_run() {
    for time in [0.05, 0.07, 0.1] {
        let mut one = arm(9e6, 1e-9);
        run(&mut one, [0.0, time], 10);
        let mut lines = Vec::new();
        one.repeats(|one| lines.push(run(one, [time, 0.2], 3)));
        assert!(lines.iter().all(|line| *line == lines[0]), "{lines:?}");
        let expected = one.all();
        one.reset();
        one.initialize();
        run(&mut one, [0.0, time], 10);
        run(&mut one, [time, 0.2], 3);
        assert_eq!(one.all(), expected);
    }
}

/// Rates of outputs directly before and after the release, against differences on the same side of the release. While
/// the lock holds, oil, load and lock are in equilibrium.
#[test]
fn derivatives_and_reactions_are_those_of_either_side_of_the_release() {
    let names =
        ["arm.speed", "lift.chamber_a.pressure", "latch.force", "lift.force", "lift.length", "gallery.pressure"];
    let release = run_to_events(&mut arm(9e6, 1e-12), [0.0, 0.07], 0.07)[0];
    let h = 1e-6;
    for (time, is_held) in [(release - 1e-5, true), (release + 1e-5, false)] {
        let at = |time: f64| {
            let mut arm = arm(9e6, 1e-12);
            run(&mut arm, [0.0, time], 2);
            arm
        };
        let mut here = at(time);
        assert_eq!(here.is("latch.engaged"), is_held);
        let [before, after] = [time - h, time + h].map(|time| names.map(|name| at(time).get(name)));
        for ((name, before), after) in names.into_iter().zip(before).zip(after) {
            let (rate, difference) = (here.derivative(name), (after - before) / (2.0 * h));
            let size = 1e-6 * after.abs() / h;
            assert!((rate - difference).abs() <= 1e-4 * rate.abs() + size * 1e-2, "{name}: {rate} {difference}");
        }
        let [force, oil, load] = ["latch.force", "lift.force", "lift.holding_force"].map(|name| here.get(name));
        if is_held {
            // Moment of a unit force of the cylinder about the pivot, from the points foot and lug.
            let (sin, cos) = 0.1_f64.sin_cos();
            let lug = [0.8 * cos + 0.1 * sin, 0.8 * sin - 0.1 * cos];
            let way = [lug[0] - 0.5, lug[1] + 0.9];
            let arm_of_force = (lug[0] * way[1] - lug[1] * way[0]) / way[0].hypot(way[1]);
            let moment = (oil - load) * arm_of_force;
            assert!((2.0 * force - moment).abs() < 1e-9 * moment, "{force} {moment}");
        } else {
            assert!(force == 0.0 && here.get("arm.acceleration") > 1.0);
        }
    }
}

/// A host releases the lock by its input: the arm rises as soon as the oil force is sufficient, below the pressure of
/// the lock.
#[test]
fn a_manually_released_lock_does_not_hold() {
    let mut angles = [true, false].map(|engage| {
        let mut arm = arm(9e6, 1e-9);
        arm.set("latch.engage", engage);
        run(&mut arm, [0.0, 0.059], 1);
        assert!(arm.is("latch.engaged"));
        arm.get("arm.angle")
    });
    angles[0] -= 0.1;
    assert!(angles[0].abs() < 1e-12 && angles[1] > 0.1 + 1e-4, "{angles:?}");
}
