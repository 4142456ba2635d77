//! Static equilibrium at the start: whether the mechanism stays at its start position when it is released at rest.
//!
//! In: a model at its start. Out: the reason of the equilibrium or the acceleration, and the holding force of each
//! drive. It must not know laws: it reads outputs.
use super::place::Places;
use crate::inspection::Fact;
use crate::mechanism::loads::resolved::DriveLaw;
use crate::mechanism::loads::unit_load::Load;
use crate::mechanism::model::Model;
use crate::mechanism::motion::contact::Travel;
use crate::mechanism::motion::state::State;
use crate::mechanism::reduced::Reduced;
use crate::variables::Unit;
use std::f64::consts::TAU;

/// Part of the sum of all loads up to which their balance is rounding.
const BALANCE: f64 = 1e-9;
const TOPIC: &str = "Equilibrium at the start";
const ALL: &str = "Equilibria under the loads at the start";
/// Most equilibria that are listed.
const MOST: usize = 12;

/// Add the facts of the equilibrium; the model is left at rest.
pub fn add(model: &mut Model, reduced: &Reduced, state: &State, places: Places, facts: &mut Vec<Fact>) {
    if reduced.linkage().is_massless {
        facts.push(Fact::new(ALL, "").saying("not computed, because no body has a mass"));
        return;
    }
    let start = &model.original.parameter_values.mechanism().start;
    let of = start.body.clone().or_else(|| start.joint.clone()).unwrap_or_default();
    let speed = model.variables().find(&format!("{of}.start_speed"));
    if speed.is_none() && !start.is_at_guess() {
        return;
    }
    speed.into_iter().for_each(|speed| model.start_at_rest(speed));
    if model.initialize().is_err() {
        return;
    }
    let linkage = reduced.linkage();
    // The coordinate that moves most tells the acceleration along the curve best.
    let c = reduced.at(state.sigma).curve().configuration(state.sigma);
    let weighted = |i: usize| c.q_sigma[i].abs() / if i < linkage.angles { 1.0 } else { linkage.size };
    let most = (0..c.q.len()).fold(0, |most, i| if weighted(i) > weighted(most) { i } else { most });
    let (name, is_angle) = (&linkage.coordinates[most], most < linkage.angles);
    add_all(model, reduced, &state.travel, places, most, facts);
    let Some(reference) = model.variables().find(&format!("{name}.acceleration")) else { return };
    let Ok(acceleration) = model.real(reference) else { return };
    let unit = if is_angle { Unit::RadianPerSecondSquared } else { Unit::MetrePerSecondSquared };
    let all = natural_acceleration(reduced, &model.original.inputs.reals, state.sigma);
    let here = state.sigma + state.revolutions * reduced.period().unwrap_or(0.0);
    let sticking = model.variables().find("friction.sticking");
    let sticks = sticking.is_some_and(|reference| model.boolean(reference).unwrap_or(false));
    // The acceleration that the speed alone gives, for the rounding of it.
    let turning = state.sigma_dot * state.sigma_dot / reduced.scale();
    let is_balanced = acceleration == 0.0 || (acceleration / c.q_sigma[most]).abs() <= BALANCE * (all + turning);
    let fact = Fact::new(TOPIC, name).with("acceleration", if is_balanced { 0.0 } else { acceleration }, unit);
    let text = if sticks {
        "at the start friction holds the mechanism (equilibrium)".to_owned()
    } else if acceleration.is_nan() {
        let reason = model.undefined(reference).unwrap_or_default();
        format!("at the start the acceleration is unknown: {reason}")
    } else if reduced.loading().motion.is_some() && model.original.inputs.prescribes() {
        "at the start a drive prescribes the motion".to_owned()
    } else if is_balanced {
        match held_by(reduced, &state.travel, here).filter(|_| acceleration == 0.0 && all > 0.0) {
            Some(stop) => format!("at the start the mechanism is held at stop {stop} (equilibrium)"),
            None if all == 0.0 => "at the start no load acts (equilibrium)".to_owned(),
            None => "at the start the loads are in balance (equilibrium)".to_owned(),
        }
    } else {
        match creeps(model, reduced) {
            Some(drive) => format!(
                "at the start the mechanism creeps (no equilibrium): the force of {drive} is between the two \
                 breakaway forces, but the friction law viscous allows slow motion below friction.static_speed"
            ),
            None => "at the start the loads move the mechanism (no equilibrium)".to_owned(),
        }
    };
    facts.push(fact.saying(text));
    for (load, drive) in reduced.loading().drives.iter().enumerate() {
        // The force that all loads are for this drive.
        let slope = reduced.loading().loads[load].displacement(linkage, &c)[1];
        let influence = slope.abs();
        let is_rounding = |value: f64| influence > 0.0 && value.abs() * influence <= BALANCE * all;
        let (word, unit) = if drive.is_rotary { ("torque", Unit::NewtonMetre) } else { ("force", Unit::Newton) };
        let mut fact = Fact::new(TOPIC, &drive.name);
        let given = if drive.law.is_some() { format!("acting_{word}") } else { word.to_owned() };
        let given = [("given", given), ("holding", format!("holding_{word}"))];
        let range = [("forward", "moves forward above"), ("backward", "moves backward below")];
        let range = range.map(|(end, label)| (label, format!("breakaway_{word}_{end}")));
        let range = if sticking.is_some() { &range[..] } else { &[] };
        for &(label, ref variable) in given.iter().chain(range) {
            let reference = model.variables().find(&format!("{}.{variable}", drive.name));
            if let Some(Ok(value)) = reference.map(|reference| model.real(reference)) {
                fact = fact.with(label, if label != "given" && is_rounding(value) { 0.0 } else { value }, unit);
            }
        }
        if sticking.is_some() && slope != 0.0 {
            fact = fact.saying(directions(reduced, &state.travel, here, slope, drive.is_rotary));
        }
        facts.push(fact);
    }
}

/// The stops towards which the mechanism moves forward and backward, for a drive whose displacement has this slope
/// along sigma: forward, this displacement grows.
fn directions(reduced: &Reduced, travel: &Travel, here: f64, slope: f64, is_rotary: bool) -> String {
    let forward = if is_rotary { "forward (anticlockwise)" } else { "forward (the length grows)" };
    let parts = [(forward, true), ("backward", false)].into_iter().filter_map(|(word, is_forward)| {
        let end = travel.rigid[usize::from(is_forward == (slope > 0.0))]?;
        let holds = (end.position - here).abs() <= 1e-9 * (reduced.scale() + here.abs());
        let holds = if holds { ", which holds the mechanism" } else { "" };
        Some(format!("{word} is towards stop {}{holds}", reduced.loading().stops[end.stop].name))
    });
    parts.collect::<Vec<_>>().join("; ")
}

/// All equilibria of the travel, stable or not, with the values of one coordinate; none are told of a model with more
/// states than position and speed.
fn add_all(model: &mut Model, reduced: &Reduced, travel: &Travel, places: Places, most: usize, facts: &mut Vec<Fact>) {
    let Ok(all) = model.equilibria() else { return };
    let linkage = reduced.linkage();
    let coordinate = places.steady.unwrap_or(most);
    let unit = if coordinate < linkage.angles { Unit::Radian } else { Unit::Metre };
    for found in all.iter().take(MOST) {
        let (sigma, revolutions) = reduced.unwound(found.position);
        let value = reduced.at(sigma).curve().coordinates(sigma, revolutions)[coordinate];
        let is_stable = found.place.is_some() || found.is_stable;
        let name = if is_stable { "stable position" } else { "unstable position" };
        let mut fact = Fact::new(ALL, &linkage.coordinates[coordinate]).with(name, value, unit);
        if found.place.is_none() && found.is_stable && found.stiffness > 0.0 {
            let omega = found.stiffness.sqrt();
            fact = fact.with("eigenfrequency", omega / TAU, Unit::Hertz);
            fact = fact.with("damping ratio", 0.5 * found.damping / omega, Unit::One);
        }
        let word = if is_stable { "stable" } else { "unstable" };
        // The value of a coordinate that stands still nowhere names the position.
        let mut parts = vec![match places.steady {
            Some(_) => word.to_owned(),
            None => format!("{word} at {}", places.describe(found.position)),
        }];
        if found.place.is_some() {
            let stop = held_by(reduced, travel, found.position).unwrap_or_default();
            parts.push(format!("the loads press the mechanism against {stop}"));
        }
        facts.push(fact.saying(parts.join(": ")));
    }
    if all.is_empty() {
        facts.push(Fact::new(ALL, "").saying("none: no load acts, or the loads move the mechanism at every position"));
    } else if all.len() > MOST {
        facts.push(Fact::new(ALL, "").saying(format!("and {} more", all.len() - MOST)));
    }
}

/// Acceleration along the curve that all loads would cause if they acted along one motion. Balances are relative to it.
fn natural_acceleration(reduced: &Reduced, inputs: &[f64], sigma: f64) -> f64 {
    let (loading, linkage) = (reduced.loading(), reduced.linkage());
    let influence = |load: usize| {
        let displacement = match &loading.loads[load] {
            Load::Separation { .. } => 0.0,
            Load::Torque { .. } | Load::Couple { .. } => 1.0,
            Load::Force { .. } | Load::Pair { .. } | Load::Slide { .. } | Load::Rub { .. } => linkage.size,
            Load::Screw { ratio, .. } => ratio * linkage.size,
            Load::Gravity(acceleration) => {
                linkage.bodies.iter().map(|body| body.mass).sum::<f64>() * acceleration.norm() * linkage.size
            }
        };
        displacement / reduced.scale()
    };
    // A command sizes a load by the law of its drive. The speed of a surface is no size.
    let unit = |load: usize| {
        if loading.surfaces.contains(&load) {
            return 0.0;
        }
        let laws = loading.drives.iter().filter_map(|drive| drive.law.as_ref());
        laws.filter(|law| law.commands().contains(&load)).map(|law| law.force_of_command(load)).next().unwrap_or(1.0)
    };
    let applied = reduced.sizes(inputs).into_iter().enumerate();
    let applied = applied.map(|(load, size)| size.abs() * unit(load) * influence(load));
    let springs = loading.springs.iter().map(|spring| {
        let force = spring.force(reduced.displacement_at(spring.load, sigma, 0));
        // The force at the free length or angle is the rounding of a difference.
        let whole = spring.stiffness * influence(spring.load) * reduced.scale();
        (force.abs() + whole) * influence(spring.load)
    });
    let controllers = loading.drives.iter().enumerate().map(|(load, drive)| {
        let gain = drive.law.as_ref().and_then(DriveLaw::control).and_then(|control| control.position_gain);
        gain.unwrap_or(0.0) * reduced.displacement_at(load, sigma, 0).abs() * influence(load)
    });
    applied.chain(springs).chain(controllers).sum()
}

/// Name of a stop at this position.
fn held_by<'a>(reduced: &'a Reduced, travel: &Travel, here: f64) -> Option<&'a str> {
    let near = 1e-9 * (reduced.scale() + here.abs());
    let (place, _) = travel.places().find(|(_, position)| (position - here).abs() <= near)?;
    let stop = match place.bumper() {
        Some(bumper) => travel.bumpers[bumper].stop,
        None => travel.rigid[place.side]?.stop,
    };
    Some(&reduced.loading().stops[stop].name)
}

/// The drive whose force lies between those at which the mechanism breaks away, if friction tells any.
fn creeps(model: &mut Model, reduced: &Reduced) -> Option<String> {
    for drive in &reduced.loading().drives {
        let word = if drive.is_rotary { "torque" } else { "force" };
        let given = if drive.law.is_some() { format!("acting_{word}") } else { word.to_owned() };
        let names = [given, format!("breakaway_{word}_forward"), format!("breakaway_{word}_backward")];
        let values = names.map(|name| {
            let reference = model.variables().find(&format!("{}.{name}", drive.name))?;
            model.real(reference).ok().filter(|value| value.is_finite())
        });
        if let [Some(given), Some(forward), Some(backward)] = values
            && (backward..=forward).contains(&given)
        {
            return Some(drive.name.clone());
        }
    }
    None
}
