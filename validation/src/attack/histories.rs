//! Random histories as twins: two instances get the same inputs, derivatives, locks and steps; one of them is also
//! read, saved, restored and serialised in between. Their outputs and states must be bit-identical.
use super::mechanism::definition;
use super::prepared::Prepared;
use super::probe::Probe;
use super::random::Random;
use super::{actuator, network};
use linkage_fmu::component::{Component, Stepped};
use linkage_fmu::variables::Reference;

/// Consecutive histories with the same mechanism, whose set-up takes as long as many steps.
pub const SHARED: u64 = 32;
/// Greatest number of steps of a history.
const STEPS: usize = 24;

/// How the second twin continues.
#[derive(Clone, Copy, Debug)]
enum Rollback {
    /// Unchanged.
    None,
    /// Restored in the same instance, after another step.
    InPlace,
    /// Another instance, restored.
    Fresh,
    /// Another instance, restored from bytes.
    Bytes,
    /// Another instance that has made other steps, restored from bytes.
    Elsewhere,
}

const ROLLBACKS: [Rollback; 7] = [
    Rollback::None,
    Rollback::None,
    Rollback::None,
    Rollback::InPlace,
    Rollback::Fresh,
    Rollback::Bytes,
    Rollback::Elsewhere,
];

/// The case of this part: one history.
pub fn attack(probe: &mut Probe) -> Result<(), String> {
    let prepared = prepared(probe);
    probe.count(match prepared.1.definition.file {
        "hydraulics.json" => "histories of actuators",
        "network.json" => "histories of networks",
        _ if prepared.1.has_circuit() => "histories of gears with a circuit",
        _ => "histories of mechanisms",
    });
    let result = history(probe, &prepared.1);
    probe.prepared = Some(prepared);
    result
}

/// The mechanism of the present case: that of the case before, or another one.
pub fn prepared(probe: &mut Probe) -> (u64, Prepared) {
    let key = probe.seed / SHARED;
    match probe.prepared.take() {
        Some(own) if own.0 == key => own,
        _ => {
            let mut random = Random::new(!key);
            // Every third is an actuator, a network, or a gear with a circuit.
            let (what, definition): (_, fn(&mut Random) -> _) = match key % 12 {
                2 => ("actuators", actuator::definition),
                8 => ("networks", network::definition),
                5 | 11 => ("gears with a circuit", actuator::gear),
                _ => ("mechanisms", definition),
            };
            let (prepared, refused) = probe.timed("instantiation", || Prepared::random(&mut random, definition));
            *probe.tally.counts.entry("definitions refused").or_default() += refused;
            probe.count(what);
            (key, prepared)
        }
    }
}

/// A serialised state.
pub fn written(model: &Component) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    model.snapshot().write(&mut bytes).map_err(|e| format!("a state cannot be written: {e}"))?;
    Ok(bytes)
}

/// Bits of all outputs; each is finite or has a reason not to be.
///
/// # Errors
/// An output returns an error, or is not finite without a reason.
pub fn outputs(model: &mut Component, prepared: &Prepared) -> Result<Vec<u64>, String> {
    let mut bits = Vec::with_capacity(prepared.outputs.len());
    for &output in &prepared.outputs {
        let value = model.real(output).map_err(|e| format!("{}: {e}", name(model, output)))?;
        if !value.is_finite() && (!value.is_nan() || model.undefined(output).is_none()) {
            return Err(format!("{} = {value} without a reason", name(model, output)));
        }
        bits.push(value.to_bits());
    }
    for &flag in &prepared.flags {
        bits.push(u64::from(model.boolean(flag).map_err(|e| e.to_string())?));
    }
    Ok(bits)
}

/// Name of a variable.
pub fn name(model: &Component, reference: Reference) -> String {
    model.interface().list()[reference as usize].name.clone()
}

/// The first difference between the outputs of twins.
pub fn difference(model: &Component, prepared: &Prepared, a: &[u64], b: &[u64]) -> Option<String> {
    let k = (0..a.len()).find(|&k| a[k] != b[k])?;
    let of = prepared.outputs.iter().chain(&prepared.flags).nth(k).map(|&r| name(model, r)).unwrap_or_default();
    Some(format!("{of}: {:?} {:?}", f64::from_bits(a[k]), f64::from_bits(b[k])))
}

/// Set the same random inputs, derivatives and locks in these models.
pub fn set<const N: usize>(
    random: &mut Random,
    prepared: &Prepared,
    h: f64,
    models: [&mut Component; N],
    verbose: bool,
) {
    let mut calls: Vec<(usize, i32, f64)> = Vec::new();
    let size = |random: &mut Random| match random.below(5) {
        0 | 1 => random.within(-1.0, 1.0),
        2 => 1.0,
        _ => 0.0,
    };
    // All inputs in some steps, some in others, none in most.
    let share = random.pick(&[0.0, 0.0, 0.3, 1.0]);
    for k in 0..prepared.inputs.len() {
        if random.chance(share) {
            calls.push((k, 0, size(random)));
        }
    }
    let share = random.pick(&[0.0, 0.0, 0.3, 1.0]);
    for k in 0..prepared.inputs.len() {
        for order in 1..=4 {
            if random.chance(share) {
                calls.push((k, order, size(random) / h.powi(order)));
            }
        }
    }
    let lock = (!prepared.locks.is_empty() && random.chance(0.15)).then(|| random.pick(&prepared.locks));
    for model in models {
        for &(k, order, value) in &calls {
            let (input, [middle, size]) = (prepared.inputs[k], prepared.sizes[k]);
            // A value or an order that the model rejects must be rejected in all of them.
            let value = if order == 0 { middle + value * size } else { value * size };
            let _ = match order {
                0 => model.set_real(input, value),
                order => model.set_input_derivative(input, order, value),
            };
            if verbose {
                println!("  {} order {order} = {value:e}", name(model, input));
            }
        }
        if let Some(lock) = lock {
            let engaged = model.boolean(lock).unwrap_or_default();
            let _ = model.set_boolean(lock, !engaged);
            if verbose {
                println!("  {} = {}", name(model, lock), !engaged);
            }
        }
    }
}

/// A random step: as long as the mechanism's usual one, shorter, or much shorter.
pub fn length(random: &mut Random, prepared: &Prepared) -> f64 {
    let h = prepared.definition.h;
    h * match random.below(8) {
        0 => 1.0,
        1 => random.within(0.01, 0.1),
        2 => random.decades(1e-6, 1.0),
        3 => random.within(1.0, 20.0),
        _ => random.within(0.3, 1.5),
    }
}

fn rolled_back(
    twin: &mut Component,
    prepared: &Prepared,
    rollback: Rollback,
    random: &mut Random,
) -> Result<(), String> {
    let bytes = written(twin)?;
    let mut read = twin.read_snapshot(&bytes).map_err(|e| format!("the state that it wrote is refused: {e}"))?;
    let mut again = Vec::new();
    read.write(&mut again).map_err(|e| e.to_string())?;
    if again != bytes {
        return Err("a state changes when it is written and read".into());
    }
    let snapshot = twin.snapshot();
    match rollback {
        Rollback::None => return Ok(()),
        Rollback::InPlace => {
            let h = length(random, prepared);
            let _ = twin.step(h);
            return twin.restore(&snapshot).map_err(|e| format!("restored: {e}"));
        }
        Rollback::Fresh | Rollback::Bytes => *twin = prepared.start.clone(),
        Rollback::Elsewhere => {
            *twin = prepared.start.clone();
            set(random, prepared, prepared.definition.h, [&mut *twin], false);
            let _ = twin.step(prepared.definition.h);
        }
    }
    let state = if matches!(rollback, Rollback::Fresh) { &snapshot } else { &read };
    twin.restore(state).map_err(|e| format!("restored: {e}"))
}

/// One history of a mechanism.
fn history(probe: &mut Probe, prepared: &Prepared) -> Result<(), String> {
    let (mut one, mut twin) = (prepared.start.clone(), prepared.start.clone());
    if probe.verbose {
        println!("{}", prepared.definition.text);
    }
    let mut random = probe.random.clone();
    for n in 0..=random.below(STEPS) {
        let h = length(&mut random, prepared);
        set(&mut random, prepared, h, [&mut one, &mut twin], probe.verbose);
        if random.chance(0.02) {
            for model in [&mut one, &mut twin] {
                model.reset();
                model.initialize().map_err(|e| format!("reset: {e}"))?;
            }
            probe.count("resets");
        }
        let rollbacks = [random.pick(&ROLLBACKS), random.pick(&ROLLBACKS)];
        rolled_back(&mut twin, prepared, rollbacks[0], &mut random).map_err(|e| format!("before step {n}: {e}"))?;
        if random.chance(0.3) {
            outputs(&mut twin, prepared)?;
        }
        if random.chance(0.1) && !prepared.outputs.is_empty() {
            let _ = twin.output_derivative(random.pick(&prepared.outputs), 1);
        }
        let stepped = [&mut one, &mut twin].map(|model| probe.timed("step", || model.step(h)));
        if probe.verbose {
            println!("step {n} of {h:e} s: {:?}; rollbacks {rollbacks:?}", stepped[0]);
        }
        probe.count("steps");
        if stepped[0] != stepped[1] {
            return Err(format!("step {n} of {h:e} s: {:?} and {:?}", stepped[0], stepped[1]));
        }
        match &stepped[0] {
            Ok(Stepped::Whole) => {}
            Ok(Stepped::Part(_)) => probe.count("steps that met solver.max_steps"),
            Ok(Stepped::Failed(_)) | Err(_) => probe.count("steps that ended with an error"),
        }
        rolled_back(&mut twin, prepared, rollbacks[1], &mut random).map_err(|e| format!("after step {n}: {e}"))?;
        if random.chance(0.3) {
            let [a, b] = [outputs(&mut one, prepared)?, outputs(&mut twin, prepared)?];
            if let Some(difference) = difference(&one, prepared, &a, &b) {
                return Err(format!("after step {n}: {difference}"));
            }
        }
        if written(&one)? != written(&twin)? {
            return Err(format!("after step {n}: the states differ"));
        }
    }
    let [a, b] = [outputs(&mut one, prepared)?, outputs(&mut twin, prepared)?];
    difference(&one, prepared, &a, &b).map_or(Ok(()), |difference| Err(format!("at the end: {difference}")))
}
