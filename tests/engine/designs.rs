//! Designs that a model keeps for parameter sets that it had before give results bit-identical to those of a new model.

use crate::support::{GEAR, Run, reals, runner};
use linkage_fmu::variables::Causality;
use proptest::prelude::*;
use std::sync::Arc;

/// A value that a host sets.
#[derive(Clone, Copy, Debug)]
enum Setting {
    Real(&'static str, f64),
    Flag(&'static str, bool),
}

use Setting::{Flag, Real};

/// Parameters and inputs of the gear, of every causality.
const OF_GEAR: [Setting; 17] = [
    Real("crank.start_angle", 0.5),
    Real("crank.start_speed", -1.0),
    Real("gravity.acceleration", 9.5),
    Real("gravity.up_angle", 1.0),
    Real("crank.length", 0.1757),
    Real("crank.mass", 14.0),
    Real("crank.actuator_x", -0.06),
    Real("upstop.angle", -1.1),
    Real("downstop.restitution", 0.4),
    Real("friction.kinetic_coefficient", 0.03),
    Real("friction.static_coefficient", 0.25),
    Real("joint2.pin_radius", 0.02),
    Real("airspeed", 70.0),
    Real("solver.tolerance", 1e-7),
    Flag("friction.enabled", true),
    Flag("upstop.rigid", false),
    Flag("solver.tables", false),
];

/// An arm with two cylinders. The ends of one coincide at the angle 0, the ends of the other at pi / 2. The start
/// determines on which part of the circle the arm moves.
const ARM: &str = r#"{ "name": "Arm",
  "bodies": { "ground": { "points": { "east": [1, 0], "north": [0, 1] } },
    "arm": { "length": 1, "mass": 3, "shape": "uniform_rod" } },
  "joints": { "pivot": { "type": "revolute", "first": "ground.origin", "second": "arm.origin" } },
  "actuators": { "cylinder": { "first": "ground.east", "second": "arm.end", "force": 1 },
    "other": { "first": "ground.north", "second": "arm.end" } },
  "start": { "body": "arm", "angle": 1 }, "guess": { "arm": 1 } }"#;

const OF_ARM: [Setting; 6] = [
    Real("arm.start_angle", 1.2),
    Real("arm.start_angle", 3.0),
    Real("arm.start_speed", 0.1),
    Real("arm.mass", 2.0),
    Real("ground.east_x", 1.5),
    Real("solver.tolerance", 1e-7),
];

/// Actions of a host before a run of a few steps.
#[derive(Clone, Debug)]
struct Op {
    resets: bool,
    /// Settings, each by its fraction of the range of indices.
    settings: Vec<f64>,
    /// Whether the run starts from a state that was saved in the run before, and whether that state is restored
    /// afterwards.
    rollback: bool,
    steps: u32,
}

fn op() -> impl Strategy<Value = Op> {
    (any::<bool>(), prop::collection::vec(0.0..1.0, 0..3), prop::bool::weighted(0.2), 1..3_u32)
        .prop_map(|(resets, settings, rollback, steps)| Op { resets, settings, rollback, steps })
}

fn set(run: &mut Run, setting: Setting) {
    match setting {
        Real(name, value) => run.set(name, value),
        Flag(name, value) => run.set(name, value),
    }
}

/// Bits of all outputs at the start and after each step, or the error of the start.
fn bits(run: &mut Run, steps: u32, h: f64) -> Result<Vec<u64>, String> {
    let all = reals(run, Causality::Output);
    let mut bits = Vec::new();
    run.0.initialize().map_err(|e| e.to_string())?;
    for step in 0..=steps {
        bits.extend(all.iter().map(|&output| run.real(output).unwrap().to_bits()));
        if step < steps {
            run.step(h);
        }
    }
    Ok(bits)
}

fn check(text: &str, settings: &[Setting], h: f64, ops: &[Op]) -> Result<(), TestCaseError> {
    let mut kept = Run::new(text);
    let mut present: Vec<Setting> = Vec::new();
    for op in ops {
        if op.resets {
            kept.reset();
            present.clear();
        }
        let before = kept.snapshot();
        for part in &op.settings {
            let setting = settings[(part * settings.len() as f64) as usize];
            set(&mut kept, setting);
            present.push(setting);
        }
        let mut new = Run::new(text);
        present.iter().for_each(|&setting| set(&mut new, setting));
        prop_assert_eq!(bits(&mut kept, op.steps, h), bits(&mut new, op.steps, h), "{:?}", present);
        if op.rollback {
            // Back to the previous parameters, and a second continuation from the saved state.
            let after = kept.snapshot();
            kept.restore(&before).unwrap();
            kept.restore(&after).unwrap();
            prop_assert_eq!(bits(&mut kept, op.steps, h), bits(&mut new, op.steps, h), "{:?}, restored", present);
        }
    }
    Ok(())
}

#[test]
fn a_cached_model_is_bit_identical_to_a_new_one() {
    for (text, settings, h) in [(GEAR, &OF_GEAR[..], 0.004), (ARM, &OF_ARM, 0.02)] {
        let result = runner(12).run(&prop::collection::vec(op(), 2..12), |ops| check(text, settings, h, &ops));
        result.unwrap_or_else(|error| panic!("{error}"));
    }
}

/// The reduced models of the last parameter sets are kept: setting these parameters again needs no new set-up.
#[test]
fn the_last_reduced_models_are_kept() {
    let mut run = Run::new(GEAR);
    let as_read = Arc::as_ptr(run.reduced().unwrap());
    let mut reduced_at = |masses: &[f64]| {
        masses.iter().for_each(|mass| run.set("crank.mass", *mass));
        run.initialize();
        Arc::as_ptr(run.reduced().unwrap())
    };
    let first = reduced_at(&[14.0]);
    for mass in [15.0, 16.0, 17.0] {
        assert_ne!(reduced_at(&[mass]), first);
        assert_eq!(reduced_at(&[14.0]), first, "the last ones are kept");
    }
    // The value 20 is replaced before the initialisation: no reduced model is built for it.
    assert_eq!(reduced_at(&[20.0, 14.0]), first);
    let another: Vec<_> = [15.0, 16.0, 17.0, 18.0].map(|mass| reduced_at(&[mass])).to_vec();
    assert_eq!([15.0, 16.0, 17.0, 18.0].map(|mass| reduced_at(&[mass])).to_vec(), another);
    run.reset();
    assert_eq!(Arc::as_ptr(run.reduced().unwrap()), as_read, "and that of the definition as read");
}
