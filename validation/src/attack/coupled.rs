//! Twins of a coupling: a landing gear and an actuator with random options exchange motion and force in steps; one of
//! the two pairs is also read, saved and restored between any two calls of the exchange.
use super::histories::{difference, outputs, written};
use super::prepared::{Definition, Prepared};
use super::probe::Probe;
use super::random::Random;
use super::{actuator, network};
use linkage_fmu::component::{Component, Refused, Stepped};
use linkage_fmu::hydraulics::ACTUATOR;
use linkage_fmu::variables::{Causality, Reference};
use serde_json::Value;

const GEAR: &str = example!("LandingGearRetraction");
/// Greatest number of steps of a coupling.
const STEPS: usize = 24;
/// Outputs of the actuator's preview.
const PREVIEW: [&str; 5] =
    ["preview.force", "preview.force_rate", "preview.force_mean", "preview.start_acceleration", "preview.acceleration"];
/// Share of the couplings that have a network instead of a single actuator.
const NETWORKS: f64 = 0.4;

/// How force and motion are exchanged.
#[derive(Clone, Copy, Debug)]
enum Exchange {
    /// The mean force or the line; the actuator keeps its predicted motion.
    Held,
    Line,
    /// The gear steps first, then the actuator with the gear's motion.
    TwoPasses,
    /// The force of the step before.
    Late,
    /// Present force and motion.
    Plain,
}

/// A gear and an actuator.
struct Pair {
    gear: Component,
    actuator: Component,
}

/// Both sides at their start, with value references.
struct Start {
    gear: Prepared,
    actuator: Prepared,
    /// Pairs of an output of the gear and an input of the actuator: length, speed, and so on.
    inputs: Vec<[Reference; 2]>,
    preview: [Reference; PREVIEW.len()],
    force: [Reference; 2],
    horizon: Reference,
}

impl Start {
    fn new(random: &mut Random) -> Result<Self, String> {
        let mut json: Value = serde_json::from_str(GEAR).map_err(|e| e.to_string())?;
        json["start"]["angle"] = random.within(-1.2, 0.79).into();
        json["friction"]["enabled"] = random.chance(0.3).into();
        json["solver"] = serde_json::json!({ "tolerance": random.decades(1e-11, 1e-5) });
        let text = json.to_string();
        let gear = Prepared::new(Definition { file: "mechanism.json", text, force: 1e4, torque: 1e3, h: 1e-3 })?;
        let is_network = random.chance(NETWORKS);
        let drawn = if is_network { network::driving } else { actuator::definition };
        let (actuator, _) = Prepared::random(random, drawn);
        let find = |of: &Prepared, name: &str| of.start.interface().find(name).ok_or(format!("no variable {name}"));
        let inputs = (0..).zip(actuator.start.interface().list()).filter(|(_, v)| v.causality == Causality::Input);
        let inputs = inputs.filter(|(_, v)| v.name.starts_with(ACTUATOR));
        let inputs = inputs.map(|(to, v)| Ok([find(&gear, &v.name)?, to])).collect::<Result<_, String>>()?;
        let mut preview = [0; PREVIEW.len()];
        for (reference, name) in preview.iter_mut().zip(PREVIEW) {
            let own = if is_network { format!("{ACTUATOR}{name}") } else { name.to_owned() };
            *reference = find(&actuator, &own)?;
        }
        let force = [find(&gear, "actuator.force")?, find(&actuator, "actuator.force")?];
        let horizon = find(&actuator, "preview.horizon")?;
        Ok(Self { gear, actuator, inputs, preview, force, horizon })
    }
}

/// Additional calls of one twin between two calls of the exchange.
fn call_further(pair: &mut Pair, start: &Start, random: &mut Random) -> Result<(), String> {
    for (component, prepared) in [(&mut pair.gear, &start.gear), (&mut pair.actuator, &start.actuator)] {
        if random.chance(0.2) {
            outputs(component, prepared)?;
        }
        if random.chance(0.25) {
            let bytes = written(component)?;
            let read =
                component.read_snapshot(&bytes).map_err(|e| format!("the state that it wrote is refused: {e}"))?;
            let own = component.snapshot();
            let state = if random.chance(0.5) { &own } else { &read };
            match random.below(3) {
                0 => drop(component.step(random.decades(1e-5, 1e-2))),
                1 => *component = prepared.start.clone(),
                _ => {}
            }
            component.restore(state).map_err(|e| format!("restored: {e}"))?;
        }
    }
    Ok(())
}

/// One step of a coupling; `between` acts between its calls. Returns how both sides stepped.
fn exchange(
    pair: &mut Pair,
    start: &Start,
    exchange: Exchange,
    late: &mut Option<f64>,
    h: f64,
    mut between: impl FnMut(&mut Pair) -> Result<(), String>,
) -> Result<[Result<Stepped, Refused>; 2], String> {
    let words = |e: Refused| e.to_string();
    let reals = |component: &mut Component, names: &[Reference]| -> Result<Vec<f64>, String> {
        names.iter().map(|&name| component.real(name).map_err(words)).collect()
    };
    let of_gear: Vec<Reference> = start.inputs.iter().map(|[gear, _]| *gear).collect();
    let inputs = reals(&mut pair.gear, &of_gear)?;
    between(pair)?;
    for (&[_, to], &value) in start.inputs.iter().zip(&inputs) {
        // Near a toggle of the drive the gear has no finite mass; both twins then keep the previous one.
        let _ = pair.actuator.set_real(to, value);
    }
    pair.actuator.set_real(start.horizon, h).map_err(words)?;
    between(pair)?;
    let [line, rate, mean, from, to] = reals(&mut pair.actuator, &start.preview)?[..] else {
        return Err("five values are foreseen".into());
    };
    let plain = pair.actuator.real(start.force[1]).map_err(words)?;
    between(pair)?;
    let force = match exchange {
        Exchange::Held => mean,
        Exchange::Line | Exchange::TwoPasses => line,
        Exchange::Late => late.unwrap_or(mean),
        Exchange::Plain => plain,
    };
    let _ = pair.gear.set_real(start.force[0], force);
    if matches!(exchange, Exchange::Line | Exchange::TwoPasses) {
        let _ = pair.gear.set_input_derivative(start.force[0], 1, rate);
    }
    between(pair)?;
    let gear = pair.gear.step(h);
    between(pair)?;
    if matches!(exchange, Exchange::TwoPasses) {
        let end = reals(&mut pair.gear, &of_gear)?;
        let speed = (end[1] - inputs[1] - from * h) / (h * h);
        let slope = (to - from) / h;
        let rates = [from, 2.0 * (3.0 * speed - slope), 6.0 * (slope - 2.0 * speed) / h];
        for (order, rate) in (1..).zip(rates) {
            let _ = pair.actuator.set_input_derivative(start.inputs[1][1], order, rate);
        }
    }
    between(pair)?;
    let actuator = pair.actuator.step(h);
    between(pair)?;
    *late = Some(pair.actuator.real(start.preview[2]).map_err(words)?).filter(|mean| mean.is_finite());
    Ok([gear, actuator])
}

/// The case of this part: one coupling.
pub fn attack(probe: &mut Probe) -> Result<(), String> {
    let mut random = probe.random.clone();
    let start = probe.timed("instantiation", || Start::new(&mut random))?;
    if probe.verbose {
        println!("{}\n{}", start.gear.definition.text, start.actuator.definition.text);
    }
    let pair = || Pair { gear: start.gear.start.clone(), actuator: start.actuator.start.clone() };
    let (mut one, mut twin) = (pair(), pair());
    let kinds = [Exchange::Held, Exchange::Line, Exchange::TwoPasses, Exchange::Late, Exchange::Plain];
    let kind = random.pick(&kinds);
    let h = random.decades(1e-4, 2e-2);
    let (mut late, mut late_twin) = (None, None);
    let interface = start.actuator.start.interface();
    let command = interface.find("valve.command").or_else(|| interface.find("selector.command"));
    for n in 0..=random.below(STEPS) {
        if let (true, Some(command)) = (random.chance(0.2), command) {
            let u = random.within(-1.1, 1.1);
            for pair in [&mut one, &mut twin] {
                pair.actuator.set_real(command, u).map_err(|e| e.to_string())?;
            }
        }
        let stepped = probe.timed("step of a pair", || exchange(&mut one, &start, kind, &mut late, h, |_| Ok(())))?;
        let again =
            exchange(&mut twin, &start, kind, &mut late_twin, h, |pair| call_further(pair, &start, &mut random))
                .map_err(|e| format!("step {n}, {kind:?}: {e}"))?;
        probe.count("steps of pairs");
        if probe.verbose {
            println!("step {n} of {h:e} s, {kind:?}: {stepped:?}");
        }
        if stepped != again {
            return Err(format!("step {n} of {h:e} s, {kind:?}: {stepped:?} and {again:?}"));
        }
        if stepped.iter().any(|stepped| !matches!(stepped, Ok(Stepped::Whole))) {
            probe.count("steps of pairs that ended early");
        }
        let sides =
            [(&mut one.gear, &mut twin.gear, &start.gear), (&mut one.actuator, &mut twin.actuator, &start.actuator)];
        for (one, twin, prepared) in sides {
            if written(one)? != written(twin)? {
                return Err(format!("after step {n}, {kind:?}: the states of {} differ", prepared.start.name()));
            }
            let [a, b] = [outputs(one, prepared)?, outputs(twin, prepared)?];
            if let Some(difference) = difference(one, prepared, &a, &b) {
                return Err(format!("after step {n}, {kind:?}: {difference}"));
            }
        }
    }
    Ok(())
}
