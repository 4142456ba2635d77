//! The bound on the work of a communication step, and long motions that need almost no work.

use crate::support::definition::{With, block, wheel};
use crate::support::{
    ANDREWS, BUCKET, CURVES, GEAR, HYDRAULIC_GEAR, Run, SLIDER_CRANK, SMOOTH, assert_says, changed, reals, values,
    without_stops,
};
use linkage_fmu::mechanism::ModelError;
use linkage_fmu::simulation::SimulationError;
use linkage_fmu::variables::Causality;
use serde_json::json;

/// Default of `solver.max_steps`.
const MAX_STEPS: u64 = 50_000;
/// Largest number of evaluations per attempted step: a step of DOP853 with its interpolant and one event.
const EVALUATIONS: u64 = 40;

/// Make a step of `h` that `solver.max_steps` interrupts. Returns the time reached in the step, and the message. The
/// work must be within the bound, and the energy balance must hold in the reached state.
#[track_caller]
fn interrupted(run: &mut Run, h: f64, max_steps: u64) -> (f64, String) {
    let (before, start) = (run.statistics(), run.0.time());
    let error = run.0.step(h).unwrap_err();
    let SimulationError::Model(ModelError::Interrupted { time, why }) = error else { panic!("{error}") };
    let after = run.statistics();
    let steps = after.accepted + after.rejected - before.accepted - before.rejected;
    let evaluations = after.evaluations - before.evaluations;
    println!("{steps} steps, {evaluations} evaluations: {why}");
    assert!(steps <= max_steps + 200 && evaluations <= EVALUATIONS * max_steps, "{steps} {evaluations}");
    assert!(time > 0.0 && time < h && run.0.time() == start + time, "{time}");
    assert_says(&why, &["solver.max_steps", "shorter communication steps"]);
    let (drift, energy) = (run.get("energy.drift"), run.get("energy.kinetic") + run.get("energy.potential").abs());
    assert!(drift.abs() <= 1e-4 * energy, "{drift:e} of {energy:e} J");
    (time, why)
}

#[test]
fn a_mechanism_that_spins_ever_faster_reaches_the_bound_of_steps() {
    let mut crank = Run::new(SLIDER_CRANK).started();
    let (time, why) = interrupted(&mut crank, 1e4, MAX_STEPS);
    assert_says(why, &["revolutions per second", "revolutions"]);
    // Kinetic energy = work of the drive torque + work on the piston. The latter is 0 over a whole turn.
    let angle = crank.get("crank.angle");
    let energy = 3.0 * (angle + std::f64::consts::FRAC_PI_2);
    let kinetic = crank.get("energy.kinetic");
    assert!((kinetic - energy - 20.0).abs() < 0.01 * kinetic, "{kinetic} {energy}");
    // After the interruption the run continues.
    crank.step(1e-3);
    assert_eq!(crank.0.time(), time + 1e-3);
    assert!(crank.get("crank.angle") > angle);
}

#[test]
fn a_step_in_part_is_the_same_as_a_shorter_one() {
    for flag in [None, Some("friction.enabled")] {
        let mut gear = Run::gear().with(&[("solver.max_steps", 7.0)]);
        flag.iter().for_each(|flag| gear.set(flag, true));
        gear.initialize();
        let mut whole = gear.clone();
        gear.set_derivative("actuator.force", 1, -2e4);
        gear.set_derivative("actuator.force", 2, 3e5);
        let (time, _) = interrupted(&mut gear, 0.1, 7);
        let force = 3e4 + time * (-2e4 + 0.5 * time * 3e5);
        assert_eq!(gear.get("actuator.force"), force);
        whole.set("solver.max_steps", 1e6);
        whole.initialize();
        whole.set_derivative("actuator.force", 1, -2e4);
        whole.set_derivative("actuator.force", 2, 3e5);
        whole.step(time);
        for name in ["crank.angle", "crank.speed", "crank.acceleration"] {
            let [a, b] = [gear.get(name), whole.get(name)];
            assert!((a - b).abs() <= 1e-7 * (1.0 + b.abs()), "{name}: {a} {b}");
        }
        // The drift depends on the sizes of the steps, but stays below the tolerance 1e-9 of the energy.
        let [a, b] = [gear.get("energy.drift"), whole.get("energy.drift")];
        assert!((a - b).abs() <= 1e-9 * whole.get("energy.kinetic"), "energy.drift: {a} {b}");
        // The state after an interrupted step can be saved and restored.
        gear.read_snapshot(&gear.saved()).unwrap();
    }
}

#[test]
fn chatter_on_a_stop_is_named() {
    // A ball bounces on a plate with a restitution of almost 1.
    let ball = block(1.0).with(json!({
        "gravity": { "acceleration": 9.81, "up_angle": 0 }, "start": { "position": 0.01 }, "guess": { "slide": 0.01 },
        "stops": { "plate": { "joint": "slide", "limit": "lower", "position": 0, "restitution": 0.999_999_9 } },
    }));
    let mut ball = Run::new(ball).started();
    let (_, why) = interrupted(&mut ball, 1e6, MAX_STEPS);
    assert_says(why, &["impacts on stops", "restitution"]);
}

#[test]
fn absurd_torques_on_a_bumper_end() {
    let text = changed(SLIDER_CRANK, |m| {
        let stop =
            json!({ "body": "crank", "limit": "upper", "angle": 3, "rigid": false, "stiffness": 1e5, "damping": 10 });
        m["stops"] = json!({ "end": stop });
    });
    let mut crank = Run::new(&text).with(&[("drive.torque", 2.9e7)]).started();
    let before = crank.statistics();
    let ended = crank.0.step(0.028);
    let work = crank.statistics().evaluations - before.evaluations;
    println!("{work} evaluations: {ended:?}");
    assert!(work <= EVALUATIONS * MAX_STEPS, "{work}");
    if let Err(error) = ended {
        assert!(matches!(error, SimulationError::Model(ModelError::Interrupted { .. })), "{error}");
    }
}

#[test]
fn substeps_of_finite_elements_are_bounded_before_the_first() {
    let mut gear = Run::gear();
    assert_says(gear.0.set("solver.fem_step", 1e-12).unwrap_err(), &["solver.fem_step = 1e-12", ">= 1e-9"]);
    gear.set("solver.method", "rigid_fem");
    for (body, stiffness) in [("crank", 2.1e9), ("coupler", 8.9e7), ("follower", 3e8)] {
        gear.set(&format!("{body}.axial_stiffness"), stiffness);
    }
    gear.set("solver.fem_step", 1e-9);
    gear.initialize();
    let error = gear.0.step(1e-3).unwrap_err();
    assert_says(error, &["steps of solver.fem_step", "solver.max_steps allows 5e4", "increase"]);
    assert_eq!((gear.statistics().accepted, gear.0.time()), (0, 0.0));
    gear.step(1e-5);
    assert_eq!(gear.statistics().accepted, 10_000);
}

#[test]
fn the_bound_is_a_whole_number() {
    let mut gear = Run::gear();
    for value in [0.0, -1.0, 0.5, 10.5, 1e16] {
        assert_says(gear.0.set("solver.max_steps", value).unwrap_err(), &["solver.max_steps", "whole number from 1"]);
    }
    // One step at a time.
    let mut gear = gear.with(&[("solver.max_steps", 1.0)]).started();
    let mut steps = 0;
    while gear.0.time() < 0.05 {
        let rest = 0.05 - gear.0.time();
        match gear.0.step(rest) {
            Ok(()) => break,
            Err(SimulationError::Model(ModelError::Interrupted { .. })) => steps += 1,
            Err(error) => panic!("{error}"),
        }
        assert!(steps < 1000);
    }
    let mut whole = Run::gear().started();
    whole.step(0.05);
    let [a, b] = [gear.get("crank.angle"), whole.get("crank.angle")];
    assert!(steps > 2 && (a - b).abs() < 1e-9, "{steps}: {a} {b}");
}

/// The gear swings under its weight and its actuator, without losses and stops.
#[test]
fn a_long_swing_costs_what_a_short_one_does() {
    let text = without_stops();
    let swing = || Run::new(&text).with(&[("solver.tolerance", 1e-12)]).started();
    let mut long = swing();
    long.step(1e6);
    let work = long.statistics();
    println!("{work:?}");
    assert!(work.evaluations < 20_000, "{work:?}");
    let drift = long.get("energy.drift");
    assert!(drift.abs() < 1e-6, "{drift:e} J");
    // 1000 s in one step and in many steps.
    let (mut whole, mut parts) = (swing(), swing());
    whole.step(1000.0);
    parts.steps(2000, 1000.0);
    assert!(parts.statistics().accepted > 10 * whole.statistics().accepted);
    for name in ["crank.angle", "crank.speed"] {
        let [a, b] = [whole.get(name), parts.get(name)];
        println!("{name}: {a} {b}: {:e}", a - b);
        assert!((a - b).abs() < 1e-4, "{name}: {a} {b}");
    }
    parts.take(&whole.saved());
    let ends = [&mut whole, &mut parts].map(|run| {
        run.step(777.0);
        run.get("crank.angle").to_bits()
    });
    assert_eq!(ends[0], ends[1]);
}

/// A balanced crank rotates uniformly without end.
#[test]
fn a_uniform_rotation_is_exact_to_the_last_turn() {
    let turning = json!({ "start": { "angle": 0.25, "speed": 100 }, "guess": { "wheel": 0.25 } });
    let mut wheel = Run::new(wheel(0.5).with(turning)).started();
    wheel.step(1e6);
    let (work, angle) = (wheel.statistics(), wheel.get("wheel.angle"));
    println!("{work:?}: {:e}", angle - 0.25 - 1e8);
    // The error per turn is 1e-12 of a turn.
    assert!(work.evaluations < 30_000 && (angle - 0.25 - 1e8).abs() < 1e-4, "{angle}");
    assert!((wheel.get("wheel.speed") - 100.0).abs() < 1e-9 && wheel.get("energy.drift").abs() < 1e-6);
    // An unbalanced crank under gravity: 1e4 turns in one step against many steps.
    let crank = |parts: u32| {
        let text = changed(SLIDER_CRANK, |m| {
            m["forces"] = json!({});
            m["actuators"]["drive"] = json!({ "joint": "bearing", "torque": 0 });
        });
        let mut crank = Run::new(&text).with(&[("solver.tolerance", 1e-13)]).started();
        crank.steps(parts, 600.0);
        (crank.get("crank.angle"), crank.get("crank.speed"), crank.statistics().evaluations)
    };
    let (whole, parts) = (crank(1), crank(12_000));
    println!("{whole:?} {parts:?}: {:e} rad", whole.0 - parts.0);
    assert!(whole.0 > 1e4 && whole.2 * 50 < parts.2, "{whole:?} {parts:?}");
    assert!((whole.0 - parts.0).abs() < 1e-5 && (whole.1 - parts.1).abs() < 1e-3, "{whole:?} {parts:?}");
}

/// An input that overflows is rejected before the step and changes nothing: the motion afterwards is bit-identical.
#[test]
fn inputs_that_overflow_are_rejected_before_the_step() {
    for (name, order, value) in [
        ("load_factor", 0, 1e308),
        ("airspeed", 0, 1e200),
        ("load_factor", 1, 1e308),
        ("airspeed", 1, -1e250),
        ("actuator.force", 2, 1e308),
    ] {
        let mut one = Run::new(GEAR).with(&[("crank.start_angle", 0.5)]).started();
        one.steps(10, 0.01);
        let mut twin = one.clone();
        let set = |run: &mut Run, value: f64| match order {
            0 => run.set(name, value),
            order => run.set_derivative(name, order, value),
        };
        let now = one.get(name);
        set(&mut one, value);
        let h = if order == 2 { 1e3 } else { 1e-2 };
        let error = one.0.step(h).unwrap_err();
        let SimulationError::Model(error) = error else { panic!("{error}") };
        assert!(!error.ends_step(), "{error}");
        assert_says(error, &[name]);
        set(&mut one, if order == 0 { now } else { 0.0 });
        for run in [&mut one, &mut twin] {
            run.steps(10, 0.02);
        }
        assert_eq!(one.get("crank.speed").to_bits(), twin.get("crank.speed").to_bits(), "{name}");
        assert_eq!(one.get("energy.drift").to_bits(), twin.get("energy.drift").to_bits(), "{name}");
    }
}

/// A step of any length is accepted, from the start and later, and changes nothing or what its length requires.
#[test]
fn a_step_of_any_length_is_done() {
    for definition in [GEAR, CURVES, BUCKET, ANDREWS, SMOOTH, HYDRAULIC_GEAR] {
        for before in [0.0, 0.02, 1.0] {
            let mut start = Run::shared(definition).started();
            (before > 0.0).then(|| start.step(before));
            let outputs: Vec<_> = reals(&start, Causality::Output);
            let name = |k: usize| start.variables().list()[outputs[k] as usize].name.clone();
            let is_motion = |k: &usize| [".angle", ".speed", ".position"].iter().any(|end| name(*k).ends_with(end));
            let motion: Vec<_> = (0..outputs.len()).filter(is_motion).map(|k| outputs[k]).collect();
            let now = values(&mut start.clone(), &motion);
            for exponent in [324, 320, 310, 300, 250, 200, 160, 100, 51, 49, 40, 30, 20] {
                let (mut run, h) = (start.clone(), 10_f64.powi(-exponent).max(5e-324));
                run.step(h);
                let then = values(&mut run, &motion);
                let is_same = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-11 * (1.0 + a.abs());
                assert!(now.iter().zip(&then).all(is_same), "{h:e} at {before}: {now:?} {then:?}");
            }
        }
    }
}
