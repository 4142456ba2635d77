//! Mechanisms written in two ways that must have the same motion, and packing of every accepted definition.
//!
//! In: the examples and random mechanisms. Out: pairs that differ by more than rounding, outputs that are not finite
//! without a reason, accepted definitions without a description. Must not depend on how a mechanism is solved.
use super::mechanism;
use super::probe::Probe;
use super::random::Random;
use super::relation::{Relation, factor};
use super::rewritten::{
    Rewritten, chained, cloned, exchanged, in_other_units, loose, mirrored, moved, plain, renamed, rescaled,
};
use linkage_fmu::component::Component;
use linkage_fmu::simulation::Simulation;
use linkage_fmu::variables::{Causality, Kind, Unit};
use serde_json::{Value, json};
use std::collections::HashMap;
use std::f64::consts::PI;

/// The examples.
const EXAMPLES: [&str; 13] = [
    example!("AndrewsSqueezer"),
    example!("CraneJib"),
    example!("FourBar"),
    example!("FourBarFamily"),
    example!("GearTrain"),
    example!("Jib"),
    example!("LandingGearRetraction"),
    example!("LandingGearRetractionHydraulic"),
    example!("SliderCrank"),
    example!("SmoothRetraction"),
    example!("StickSlip"),
    example!("Tailgate"),
    example!("ValveTrain"),
];
/// Names of the ways to rewrite a mechanism.
const WAYS: [&str; 9] = [
    "cloned joint",
    "exchanged sides",
    "chained body",
    "other units",
    "moved",
    "mirrored",
    "rescaled",
    "damped, loose tolerance",
    "renamed",
];
/// Index of the way for which a strong damper is added.
const DAMPED: usize = 7;
/// Largest difference of two outputs, relative to the largest value of the run.
const CLOSE: f64 = 1e-6;
/// Fraction of the largest output below which an output may be rounding error only.
const ROUNDING: f64 = 1e-6;
/// Represents an infinite value.
const BOUNDLESS: f64 = 1e300;
/// Tolerance of the integration.
const TOLERANCE: f64 = 1e-10;
/// Communication steps of a run.
const STEPS: usize = 5;

/// Result of a run: names and units of the outputs, and their values at each communication point.
struct Rows {
    outputs: Vec<(String, Unit)>,
    values: Vec<HashMap<String, f64>>,
}

/// The case of this part: one pair.
pub fn attack(probe: &mut Probe) -> Result<(), String> {
    let mut random = probe.random.clone();
    let Some((mut scene, h)) = scene(&mut random) else {
        probe.count("scenes refused");
        return Ok(());
    };
    let way = random.below(WAYS.len());
    if way == DAMPED {
        let joints: Vec<&String> = scene["joints"].as_object().into_iter().flatten().map(|(name, _)| name).collect();
        let joint = joints[random.below(joints.len())].clone();
        scene["springs"]["zz_damper"] = json!({ "joint": joint, "damping": random.decades(1.0, 1e5) });
    }
    let Some(other) = rewritten(&scene, way, &mut random) else {
        probe.count("ways that a scene does not have");
        return Ok(());
    };
    compare(probe, &scene, &other, h, WAYS[way])
}

/// A mechanism in plain numbers, and a communication step in which it moves; None if it has no start.
fn scene(random: &mut Random) -> Option<(Value, f64)> {
    let (text, h, sizes) = if random.chance(0.5) {
        let text = random.pick(&EXAMPLES).to_owned();
        let stated: Value = serde_json::from_str(&text).ok()?;
        let h = stated["experiment"]["stop_time"].as_f64().unwrap_or(1.0) / 40.0;
        (text, h, None)
    } else {
        let drawn = mechanism::definition(random);
        let sizes = [drawn.force, drawn.torque];
        (drawn.text, drawn.h, Some(sizes))
    };
    let mut plain = plain(&text).ok()?;
    if !plain["springs"].is_object() {
        plain["springs"] = json!({});
    }
    plain["solver"] = json!({ "tolerance": TOLERANCE });
    if let Some([force, torque]) = sizes {
        for (_, drive) in plain["actuators"].as_object_mut().into_iter().flatten() {
            for (key, size) in [("force", force), ("torque", torque)] {
                if drive.get(key).is_some() {
                    drive[key] = json!(size * random.within(-1.0, 1.0));
                }
            }
        }
    }
    Some((plain, h * random.within(0.5, 1.5)))
}

/// The mechanism rewritten in one of [`WAYS`].
fn rewritten(scene: &Value, way: usize, random: &mut Random) -> Option<Rewritten> {
    let mut of = |group: &str| {
        let names: Vec<&String> = scene[group].as_object()?.keys().collect();
        Some(names[random.below(names.len())].clone())
    };
    match way {
        0 => cloned(scene, &of("joints")?, random.within(-0.3, 0.3)),
        1 => exchanged(scene, &of("joints")?),
        2 => chained(scene, &of("bodies")?, random.within(-PI, PI)),
        3 => in_other_units(scene),
        4 => moved(scene, random.within(-PI, PI), [random.within(-1.0, 1.0), random.within(-1.0, 1.0)]),
        5 => mirrored(scene),
        6 => rescaled(scene, [0, 1, 2].map(|_| random.decades(0.2, 5.0))),
        DAMPED => Some(loose(scene, random.decades(1e-6, 1e-2))),
        _ => renamed(scene, &mut || (b'a' + random.below(26) as u8) as char),
    }
}

/// The rows of a run.
fn run(definition: &Value, h: f64) -> Result<Rows, String> {
    let mut run = Simulation::open(&definition.to_string()).map_err(|e| e.to_string())?;
    run.initialize().map_err(|e| e.to_string())?;
    let list = run.model().variables().list().iter();
    let all = list.filter(|v| v.causality == Causality::Output && v.kind == Kind::Real);
    let outputs: Vec<(String, Unit)> = all.map(|v| (v.name.clone(), v.unit.unwrap_or(Unit::One))).collect();
    let mut values = Vec::new();
    for step in 0..=STEPS {
        if step > 0 {
            run.step(h).map_err(|e| format!("step {step}: {e}"))?;
        }
        let mut row = HashMap::new();
        for (name, _) in &outputs {
            let value = run.get(name).map_err(|e| format!("{name}: {e}"))?;
            let mut is_undefined = || run.undefined(name).is_ok_and(|reason| reason.is_some());
            if !(value.is_finite() || value.is_nan() && is_undefined()) {
                return Err(format!("unreported: {name} = {value}"));
            }
            row.insert(name.clone(), value);
        }
        values.push(row);
    }
    Ok(Rows { outputs, values })
}

/// Run both mechanisms and compare the outputs.
fn compare(probe: &mut Probe, scene: &Value, other: &Rewritten, h: f64, way: &'static str) -> Result<(), String> {
    if probe.verbose {
        println!("{scene}\n{way}, steps of {h} s:\n{}", other.definition);
    }
    let first = probe.timed("run", || run(scene, h));
    let time = if let Relation::Scaled(units) = &other.relation { factor(Unit::Second, *units) } else { 1.0 };
    let second = probe.timed("run", || run(&other.definition, h * time));
    let (first, second) = match (first, second) {
        (Ok(first), Ok(second)) => (first, second),
        (Err(one), Err(another)) if !one.starts_with("unreported") && !another.starts_with("unreported") => {
            probe.count("pairs that are refused alike");
            return Ok(());
        }
        (Err(one), Err(another)) => return Err(format!("{way}: {one}; {another}")),
        (Err(one), Ok(_)) => return Err(format!("{way}: the first is refused: {one}")),
        (Ok(_), Err(one)) => return Err(format!("{way}: the other is refused: {one}")),
    };
    let (close, least) =
        if let Relation::Loose(tolerance) = other.relation { (10.0 * tolerance, 1.0) } else { (CLOSE, 0.0) };
    let sizes = first.values.iter().flat_map(HashMap::values).map(|value| value.abs());
    let largest = sizes.filter(|size| *size < BOUNDLESS).fold(0.0, f64::max);
    let size = |name: &str| first.values.iter().map(|row| row[name].abs()).fold(0.0, f64::max);
    for (name, unit) in &first.outputs {
        let alike = first.outputs.iter().filter(|(_, other)| other == unit);
        let scale = size(name)
            .max(1e-3 * alike.map(|(name, _)| size(name)).fold(0.0, f64::max))
            .max(ROUNDING * largest)
            .max(least);
        let mut start = [0.0; 2];
        for (k, (row, others)) in first.values.iter().zip(&second.values).enumerate() {
            let mut get = |name: &str| others.get(name).copied();
            let Some(mut found) = other.relation.expected(name, *unit, &mut get) else { continue };
            let mut own = row[name];
            if name == "energy.drift" {
                continue;
            } else if name == "energy.potential" {
                // A reference value may differ at the start.
                if k == 0 {
                    start = [own, found];
                }
                (own, found) = (own - start[0], found - start[1]);
            } else if name.ends_with(".impact_time") && own < 0.0 {
                // There was no value before.
                continue;
            } else if matches!(other.relation, Relation::Mirrored) && name.ends_with(".slip_speed") {
                own = own.abs();
            }
            let off = (own - found).abs() / scale;
            if own.is_nan() && found.is_nan() {
                continue;
            }
            probe.ratio(off / close, "difference over what it may be");
            if off.is_nan() || off > close {
                return Err(format!("{way}: {name} at step {k} is {own}, the other has {found}, of {scale:e}"));
            }
        }
    }
    probe.count(way);
    Ok(())
}

/// The case of this part: one definition, whose whole model description is generated.
pub fn package(probe: &mut Probe) -> Result<(), String> {
    let mut random = probe.random.clone();
    let drawn = match random.chance(0.2) {
        true => rubbing(random.pick(&EXAMPLES)),
        false => mechanism::definition(&mut random).text,
    };
    let Ok(model) = Component::from_definition("mechanism.json", &drawn) else {
        probe.count("definitions refused");
        return Ok(());
    };
    probe.count("definitions described");
    fmu_build::package::descriptions(&model).map(drop).map_err(|e| format!("accepted, not packed: {e:#}"))
}

/// An example with friction in its joints, and teeth that do not push wheels apart, as friction requires.
fn rubbing(text: &str) -> String {
    let mut all: Value = serde_json::from_str(text).unwrap_or_default();
    if all.get("friction").is_none() {
        all["friction"] = json!({ "enabled": true, "static_coefficient": 0.1, "kinetic_coefficient": 0.05 });
    }
    for (_, coupling) in all["couplings"].as_object_mut().into_iter().flatten() {
        if ["gears", "rack"].iter().any(|kind| coupling["type"] == *kind) {
            coupling["pressure_angle"] = json!(0);
        }
    }
    all.to_string()
}
