//! Random histories of inputs and steps. A twin that is saved and restored at any time gives bit-identical results,
//! with or without derivatives of inputs. Every state that is written is read back. Only the values of inputs and
//! parameters at a step count, not the calls that set them.

use crate::cams::{ROLLER, parsed, translating};
use crate::friction_contacts::TEETH;
use crate::support::definition::{With, block, friction, weight};
use crate::support::{
    ANDREWS, CURVES, FOUR_BAR, GEAR, HYDRAULIC_GEAR, Run, SMOOTH, TWO_DRIVES, changed, reals, replaced, runner,
};
use crate::{impacts, losses, several_stops, stiction};
use linkage_fmu::mechanism::Model;
use linkage_fmu::variables::{Causality, Kind, Reference, Variability, Variable};
use proptest::prelude::*;
use serde_json::json;

/// How a twin continues after a step.
#[derive(Clone, Copy, Debug)]
enum Rollback {
    /// Unchanged.
    None,
    /// The same instance, restored after another step.
    InPlace,
    /// Another instance, restored from the snapshot.
    Fresh,
    /// Another instance, restored from bytes.
    Bytes,
}

/// Actions in one communication step.
#[derive(Clone, Debug)]
struct Op {
    /// Inputs, each by its fraction of the list of inputs, and a new value in units of the scene; often 0.
    inputs: Vec<(f64, f64)>,
    /// Input, order, and derivative in the input's unit over the step.
    derivatives: Vec<(f64, i32, f64)>,
    /// Boolean input that changes its value.
    lock: Option<f64>,
    /// Whether outputs are read before the step.
    reads: bool,
    /// Rollbacks before the step (after derivatives are set), and after the step.
    rollbacks: [Rollback; 2],
    /// Size of the step, in units of the scene's step.
    h: f64,
}

fn rollback() -> impl Strategy<Value = Rollback> {
    prop::sample::select(&[Rollback::None, Rollback::None, Rollback::InPlace, Rollback::Fresh, Rollback::Bytes][..])
}

fn op() -> impl Strategy<Value = Op> {
    let part = 0.0..1.0;
    let size = prop_oneof![2 => -1.0..1.0, 2 => Just(0.0), 1 => Just(1.0)];
    (
        prop::collection::vec((part.clone(), size.clone()), 0..3),
        prop::collection::vec((part.clone(), 1..=2, size), 0..4),
        prop::option::weighted(0.1, part),
        any::<bool>(),
        [rollback(), rollback()],
        prop_oneof![4 => 0.3..1.5, 1 => Just(1.0), 1 => 0.01..0.1],
    )
        .prop_map(|(inputs, derivatives, lock, reads, rollbacks, h)| Op {
            inputs,
            derivatives,
            lock,
            reads,
            rollbacks,
            h,
        })
}

/// A model with the quantities that the history changes.
struct Scene {
    name: &'static str,
    start: Run,
    h: f64,
    /// Size of forces and torques relative to those of the gear.
    loads: f64,
}

fn gear(flags: &[&str], values: &[(&str, f64)]) -> Run {
    let mut gear = Run::gear();
    flags.iter().for_each(|flag| gear.set(flag, true));
    gear.with(values).started()
}

fn scenes() -> Vec<Scene> {
    let bouncing = [("upstop.restitution", 0.7), ("downstop.restitution", 0.5), ("crank.start_angle", 0.5)];
    let bumpers = changed(GEAR, |m| {
        for stop in ["upstop", "downstop"] {
            m["stops"][stop]["rigid"] = json!(false);
            m["stops"][stop]["stiffness"] = json!(1e5);
            m["stops"][stop]["damping"] = json!(500);
        }
    });
    let efficiency = replaced(GEAR, &[("\"force\": 30000", "\"force\": 30000, \"efficiency\": 0.6")]);
    let steep = block(2.0).with(json!({
        "gravity": weight(), "friction": friction([0.3, 0.2], [1e-3, 0.05]),
        "actuators": { "push": { "joint": "slide", "force": -4000 } },
    }));
    let profile = json!({ "profile": "trapezoid", "distance": 0.3, "speed": 0.5, "acceleration": 3 });
    let moved = changed(GEAR, |m| {
        m["actuators"]["actuator"]["motion"] = profile;
        m["friction"]["enabled"] = json!(true);
    });
    let coil = changed(FOUR_BAR, |m| {
        m["springs"] = json!({ "coil": { "joint": "S", "points": [[-10, -9], [-3, -1], [4, 2], [12, 2], [20, 11]] } });
        m["start"]["speed"] = json!(60);
    });
    let circuit = || Run::new(HYDRAULIC_GEAR).with(&[("command.ramp_amplitude", 0.0)]).started();
    let mut at_rest = circuit();
    at_rest.step(6.0);
    let scene = |name, start, h, loads| Scene { name, start, h, loads };
    let of = |name, text: String, h, loads| scene(name, Run::new(text).started(), h, loads);
    vec![
        scene("no losses, air that begins to blow", gear(&[], &bouncing), 2e-3, 1.0),
        scene("friction", gear(&["friction.enabled"], &bouncing), 2e-3, 1.0),
        scene("relative wind", gear(&["air.relative_wind"], &bouncing), 2e-3, 1.0),
        of("bumpers", bumpers, 2e-3, 1.0),
        of("a drive with losses", efficiency, 2e-3, 1.0),
        of("two drives", TWO_DRIVES.into(), 2e-3, 1.0),
        of("curves", CURVES.into(), 2e-3, 1.0),
        of("no stops", ANDREWS.into(), 1e-3, 1.0),
        of("a block with steep friction", steep.to_string(), 7e-3, 1.0),
        of("a block that sticks and slips", stiction::block(0.0, stiction::STIFFNESS).to_string(), 5e-2, 5e-4),
        of("bumpers before a rigid stop", several_stops::crowded().definition(), 2e-2, 5e-3),
        of("a block that bounces", impacts::bouncing(0.8), 5e-2, 5e-3),
        of("a coil over turns", coil, 0.1, 1e-3),
        of("a cam", translating("polynomial_345", parsed(ROLLER)), 1e-2, 1e-4),
        of("gears with losses", losses::shafts(3.0, -1.0).to_string(), 1e-2, 1e-2),
        of("teeth on pins with friction", TEETH.into(), 1e-2, 1e-2),
        of("a motion by a profile", moved, 1.3e-2, 1.0),
        scene("a circuit", circuit(), 1e-2, 1.0),
        scene("a circuit at rest at a stop", at_rest, 1e-2, 1.0),
    ]
}

/// Typical size of an input's values.
fn unit(name: &str, loads: f64) -> f64 {
    match name {
        "airspeed" => 60.0,
        "load_factor" => 5.0,
        name if name.ends_with("demanded_acceleration") => 50.0,
        name if name.ends_with("pressure") => 2e7,
        name if name.contains("torque") => 300.0 * loads,
        name if name.contains("force") => 4e4 * loads,
        _ => 1.0,
    }
}

fn written(model: &Model) -> Vec<u8> {
    let mut bytes = Vec::new();
    model.snapshot().write(&mut bytes).unwrap();
    bytes
}

/// The model after a rollback. `fresh` is another instance of the mechanism.
fn rolled_back(model: &mut Model, fresh: &Model, rollback: Rollback, h: f64) -> Result<(), TestCaseError> {
    let bytes = written(model);
    // Every state that is written can be read, and is the same state.
    let mut read = model.read_snapshot(&bytes).map_err(|e| TestCaseError::fail(format!("its own state: {e}")))?;
    let mut again = Vec::new();
    read.write(&mut again).unwrap();
    prop_assert!(again == bytes, "a state changes when it is read");
    match rollback {
        Rollback::None => {}
        Rollback::InPlace => {
            let snapshot = model.snapshot();
            let _ = model.step(h);
            model.restore(&snapshot).unwrap();
        }
        Rollback::Fresh => {
            let snapshot = model.snapshot();
            *model = fresh.clone();
            model.restore(&snapshot).unwrap();
        }
        Rollback::Bytes => {
            *model = fresh.clone();
            model.restore(&read).unwrap();
        }
    }
    Ok(())
}

/// Bits of all outputs, or the reason for an output without a value.
fn outputs(model: &mut Model, all: &[Reference]) -> Vec<Result<u64, String>> {
    all.iter().map(|&output| model.real(output).map(f64::to_bits).map_err(|e| e.to_string())).collect()
}

/// Set all inputs, tunable parameters and input derivatives of a model to other values and back, twice. `reads`:
/// outputs read in between. `rollback`: how the model continues in between.
fn away_and_back(
    model: &mut Model,
    fresh: &Model,
    reads: Option<&[Reference]>,
    rollback: Rollback,
    loads: f64,
) -> Result<(), TestCaseError> {
    let list = model.variables().list().to_vec();
    let inputs = (0..).zip(&list).filter(|(_, v)| v.causality == Causality::Input);
    let (reals, locks): (Vec<_>, Vec<_>) = inputs.partition(|(_, v)| v.kind == Kind::Real);
    let tunable = (0..).zip(&list).filter(|(_, v)| v.variability == Variability::Tunable && v.kind == Kind::Real);
    let parameters = tunable.map(|(parameter, _)| (parameter, model.real(parameter).unwrap())).collect::<Vec<_>>();
    let parameters =
        parameters.into_iter().filter(|(parameter, value)| model.check_real(*parameter, 0.9 * value).is_ok());
    let (parameters, values): (Vec<_>, Vec<_>) = parameters.unzip();
    let others: Vec<f64> = values.iter().map(|value| 0.9 * value).collect();
    let before: Vec<f64> = reals.iter().map(|(input, _)| model.real(*input).unwrap()).collect();
    for ((input, variable), value) in reals.iter().zip(&before) {
        model.set_real(*input, value + 0.5 * unit(&variable.name, loads)).unwrap();
        if model.set_input_derivative(*input, 1, 1.0).is_ok() {
            model.set_input_derivative(*input, 1, 0.0).unwrap();
        }
    }
    model.tune(&parameters, &others).unwrap();
    for _ in 0..2 {
        for (lock, _) in &locks {
            let engaged = model.boolean(*lock).unwrap();
            model.set_boolean(*lock, !engaged).unwrap();
        }
        reads.map(|all| outputs(model, all));
        match rollback {
            // A step in between would use the other values.
            Rollback::InPlace => {}
            other => rolled_back(model, fresh, other, 0.0)?,
        }
    }
    for _ in 0..2 {
        reals.iter().zip(&before).for_each(|((input, _), value)| model.set_real(*input, *value).unwrap());
        model.tune(&parameters, &values).unwrap();
    }
    Ok(())
}

fn pick(among: &[Reference], part: f64) -> Reference {
    among[(part * among.len() as f64) as usize]
}

#[test]
fn rollbacks_and_values_that_are_changed_and_restored_have_no_effect() {
    let mut scenes = scenes();
    scenes.push(Scene { name: "a smooth motion", start: Run::new(SMOOTH).started(), h: 2e-2, loads: 1.0 });
    // Short steps, which are read from a step ahead, and all tolerances that hosts pass; or other inputs, derivatives
    // and rollbacks in each step, from the scene's own state.
    let part = || prop::sample::select(&[1.0_f64, 0.1, 0.01][..]);
    let history = || (prop::collection::vec(op(), 1..25), prop::option::of((3..=10_i32, part())));
    for scene in scenes {
        let result = runner(40).run(&history(), |(ops, calm)| {
            let mut twins = [scene.start.clone(), scene.start.clone()];
            let [inputs, all] = [Causality::Input, Causality::Output].map(|causality| reals(&twins[0], causality));
            let list = twins[0].variables().list().to_vec();
            let is_lock = |v: &Variable| v.causality == Causality::Input && v.kind == Kind::Boolean;
            let locks: Vec<Reference> = (0..).zip(&list).filter(|(_, v)| is_lock(v)).map(|(r, _)| r).collect();
            for twin in twins.iter_mut().filter(|_| calm.is_some()) {
                twin.0.model_mut().set_tolerance(10_f64.powi(-calm.unwrap().0)).unwrap();
                twin.initialize();
            }
            let (fresh, is_busy, part) = (twins[0].clone(), calm.is_none(), calm.map_or(1.0, |(_, part)| part));
            for (n, op) in ops.iter().enumerate() {
                let h = scene.h * part * op.h;
                for (k, twin) in twins.iter_mut().enumerate() {
                    // The inputs are constant during some steps.
                    for &(part, value) in op.inputs.iter().filter(|_| is_busy || n % 5 == 0) {
                        let input = pick(&inputs, part);
                        twin.set_real(input, value * unit(&list[input as usize].name, scene.loads)).unwrap();
                    }
                    if k == 1 {
                        let reads = op.reads.then_some(&all[..]);
                        away_and_back(twin.0.model_mut(), fresh.0.model(), reads, op.rollbacks[0], scene.loads)?;
                    }
                    for &(part, order, value) in op.derivatives.iter().filter(|_| is_busy || n % 7 == 6) {
                        let input = pick(&inputs, part);
                        let rate = value * unit(&list[input as usize].name, scene.loads) / scene.h.powi(order);
                        let _ = twin.set_input_derivative(input, order, rate);
                    }
                    if let Some(part) = op.lock.filter(|_| is_busy && !locks.is_empty()) {
                        let (lock, engaged) = (pick(&locks, part), twin.boolean(pick(&locks, part)).unwrap());
                        twin.set_boolean(lock, !engaged).unwrap();
                    }
                    if k == 1 && is_busy {
                        rolled_back(twin.0.model_mut(), fresh.0.model(), op.rollbacks[0], h)?;
                    }
                }
                let [a, b] = twins.each_mut().map(|twin| twin.0.model_mut().step(h).map_err(|e| e.to_string()));
                prop_assert_eq!(&a, &b, "{}: step {}", scene.name, n);
                if a.is_err() {
                    break;
                }
                rolled_back(twins[1].0.model_mut(), fresh.0.model(), op.rollbacks[1], h)?;
                let [a, b] = twins.each_mut().map(|twin| outputs(twin, &all));
                prop_assert_eq!(a, b, "{}: after step {}", scene.name, n);
                prop_assert!(written(&twins[0]) == written(&twins[1]), "{}: states after step {}", scene.name, n);
            }
            Ok(())
        });
        result.unwrap_or_else(|error| panic!("{}: {error}", scene.name));
    }
}

/// The wind starts by a derivative within the step before the saved state: the airspeed at the start of that step is 0.
#[test]
fn air_that_blows_by_a_derivative_alone_is_saved() {
    let mut one = gear(&[], &[("crank.start_angle", 0.5)]);
    let mut twin = one.clone();
    for run in [&mut one, &mut twin] {
        run.step(1e-3);
        run.set_derivative("airspeed", 1, -40.0);
        run.step(1e-3);
    }
    let snapshot = twin.snapshot();
    twin.restore(&snapshot).unwrap();
    for run in [&mut one, &mut twin] {
        run.step(1e-3);
    }
    assert_eq!(one.get("crank.speed").to_bits(), twin.get("crank.speed").to_bits());
}

/// A saved state contains a parameter that was set but not yet used by a step. The restored state continues with the
/// new value.
#[test]
fn a_state_is_read_under_a_parameter_that_was_just_set() {
    let [mut first, mut second] = [Run::gear().started(), Run::gear()];
    for name in ["solver.tolerance", "solver.max_steps"] {
        let value = first.get(name) * 0.5;
        [&mut first, &mut second].into_iter().for_each(|run| run.set(name, value));
    }
    first.initialize();
    first.step(0.01);
    second.take(&first.saved());
    let ends = [&mut first, &mut second].map(|run| {
        run.0.model_mut().step(0.02).unwrap();
        run.bits(["crank.angle"])
    });
    assert_eq!(ends[0], ends[1]);
}
