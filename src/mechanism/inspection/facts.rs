//! Facts about a mechanism: its masses, its assembly, its travel, its drives.
//!
//! In: a model. Out: facts, and warnings about its travel. It must not know steps.
use super::bends::bends;
use super::place::Places;
use super::travel::{Extremes, Walk};
use super::{equilibrium, friction, slots};
use crate::hydraulics::network::facts::facts as network_facts;
use crate::inspection::{Fact, Finding, Inspection};
use crate::mechanism::closure::{AssemblyError, Closure, guessed};
use crate::mechanism::curve::{Configuration, Ends};
use crate::mechanism::definition::{Mechanism, Units};
use crate::mechanism::linkage::{GROUND, Linkage, Point, Positions};
use crate::mechanism::model::Model;
use crate::mechanism::motion::contact::Travel;
use crate::mechanism::motion::samples::ends;
use crate::mechanism::motion::state::State;
use crate::mechanism::reduced::{End, Reduced};
use crate::mechanism::warnings::{is_within, of_guess, remarks};
use crate::numerics::decimal::Decimal;
use crate::numerics::plane::Vec2;
use crate::variables::Unit;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// Topic of positions where branches almost cross, by lengths that may be as small as rounding.
const NEAR: &str = "Near misses";
/// Text where the motion is followed only in part.
const FURTHER: &str = "the motion continues beyond the stated range: no stop ends the motion";
/// Remedy where joints that come into line end the motion.
const LINKS: &str = "change the lengths or the pivots of these links,";
/// Most places of one kind that are listed.
const PLACES: usize = 12;
/// Most coordinates, drives and bends that are followed over the travel, so that a large mechanism takes seconds.
const FOLLOWED: usize = 200;

/// Facts about a mechanism that could be assembled, traced and put at its start.
pub fn collect(model: &mut Model, out: &mut Inspection) {
    let values = Arc::clone(&model.original.parameter_values);
    let (mechanism, reduced) = (values.mechanism(), Arc::clone(&model.original.reduced));
    let Ok(state) = State::at_start(&reduced, mechanism, &model.original.inputs) else { return };
    let here = state.sigma + state.revolutions * reduced.period().unwrap_or(0.0);
    let facts = &mut out.facts;
    let start = reduced.at(state.sigma).curve().configuration(state.sigma);
    add_masses(reduced.linkage(), &start.positions, facts);
    let assembled = reduced.curve().configuration(0.0);
    add_assembly(mechanism, reduced.linkage(), &assembled.q, facts);
    let done = remarks(&reduced, mechanism.snap()).into_iter();
    out.facts.extend(done.map(|text| Fact::new("Snapped lengths", "").saying(text)));
    let ends = ends(&reduced, &state.travel, here);
    let places = add_travel(&reduced, &state, (here, ends), *mechanism.file_units, out);
    friction::add((&reduced, &state), &model.original.inputs, ends, out);
    add_redundant_joints(&reduced, &assembled, &mut out.facts);
    equilibrium::add(model, &reduced, &state, places, &mut out.facts);
    if let Some(network) = &mechanism.hydraulics {
        let mut value = |name: &str| model.variables().find(name).and_then(|reference| model.real(reference).ok());
        out.facts.extend(network_facts(network, &mut |name| value(name).unwrap_or(f64::NAN)));
    }
    without_rounding(&mut out.facts, reduced.linkage().size);
}

/// Angles, lengths and ratios that are rounding are 0; `size`: that of the linkage [m].
fn without_rounding(facts: &mut [Fact], size: f64) {
    const ROUNDING: f64 = 1e-12;
    for quantity in facts.iter_mut().filter(|fact| fact.topic != NEAR).flat_map(|fact| &mut fact.quantities) {
        let scale = match quantity.unit {
            "rad" | "1" => 1.0,
            "m" => size,
            _ => continue,
        };
        if quantity.value.abs() <= ROUNDING * scale {
            quantity.value = 0.0;
        }
    }
}

/// Facts about a mechanism that gives no model: as far as its assembly goes.
pub fn collect_unassembled(mechanism: &Mechanism, out: &mut Inspection) {
    let Ok(linkage) = Linkage::new(mechanism) else { return };
    let Ok(guess) = guessed(&linkage, &mechanism.guess) else { return };
    let linkage = Arc::new(linkage);
    match Closure::assemble(Arc::clone(&linkage), &guess) {
        Ok((_, q)) => {
            add_masses(&linkage, &linkage.positions(&q), &mut out.facts);
            add_assembly(mechanism, &linkage, &q, &mut out.facts);
            out.findings.extend(of_guess(mechanism, &linkage, &q));
        }
        Err(AssemblyError::Open { .. } | AssemblyError::TooLong { .. }) => add_gaps(&linkage, &guess, &mut out.facts),
        Err(_) => {}
    }
}

/// Gaps of the joints at the guess.
fn add_gaps(linkage: &Linkage, guess: &[f64], facts: &mut Vec<Fact>) {
    let gaps = linkage.gaps(&linkage.positions(guess));
    for (joint, gap) in linkage.row_joints().into_iter().zip(gaps) {
        let name = &linkage.joints[joint].name;
        match facts.last_mut().filter(|fact| fact.of == *name) {
            Some(fact) => fact.quantities[0].value = fact.quantities[0].value.hypot(gap),
            None => facts.push(Fact::new("Gaps at the guess", name).with("gap", gap.abs(), Unit::Metre)),
        }
    }
}

fn add_masses(linkage: &Linkage, positions: &Positions, facts: &mut Vec<Fact>) {
    let (mut mass, mut moment) = (0.0, Vec2::zeros());
    for (body, b) in linkage.bodies.iter().enumerate().filter(|(body, _)| *body != GROUND) {
        mass += b.mass;
        moment += b.mass * positions.point(Point { body, local: b.center });
    }
    let mut fact = Fact::new("Mass", "");
    if !linkage.is_massless {
        fact = fact.with("total", mass, Unit::Kilogram);
    }
    if mass > 0.0 && !linkage.is_massless {
        let center = moment / mass;
        fact = fact.with("centre x", center.x, Unit::Metre).with("centre y", center.y, Unit::Metre);
    }
    let counted = |count: usize, one: &str, more: &str| format!("{count} {}", if count == 1 { one } else { more });
    let bodies = counted(linkage.bodies.len() - 1, "moving body", "moving bodies");
    let joints = counted(linkage.joints.len() - linkage.couplings.len(), "joint", "joints");
    let loops = counted(linkage.cuts.len() - linkage.couplings.len(), "closed loop", "closed loops");
    let none = if linkage.is_massless { "no body has a mass: motion without forces; " } else { "" };
    facts.push(fact.saying(format!("{none}{bodies}, {joints}, {loops}")));
}

/// Assembled coordinates beside the guess, and the side to which each joint bends.
fn add_assembly(mechanism: &Mechanism, linkage: &Linkage, q: &[f64], facts: &mut Vec<Fact>) {
    let Ok(guess) = guessed(linkage, &mechanism.guess) else { return };
    for (i, name) in linkage.coordinates.iter().enumerate() {
        let (unit, offset) = of_coordinate(linkage, i);
        let fact = Fact::new("Assembly", name).with("guess", guess[i] + offset, unit);
        facts.push(fact.with("assembled", q[i] + offset, unit).with("apart", (q[i] - guess[i]).abs(), unit));
    }
    let positions = linkage.positions(q);
    for bend in bends(linkage) {
        let angle = bend.angle(&positions);
        let [from, at, to] = bend.joints.map(|joint| linkage.joints[joint].name.as_str());
        let side = if angle > 0.0 { "left" } else { "right" };
        let text = format!("bends to the {side}, seen along the path from {from} to {to}");
        facts.push(Fact::new("Assembly mode", at).with("bend", angle, Unit::Radian).saying(text));
    }
}

/// Unit of a coordinate, and the offset of the body that has its name.
fn of_coordinate(linkage: &Linkage, coordinate: usize) -> (Unit, f64) {
    let name = &linkage.coordinates[coordinate];
    match coordinate < linkage.angles {
        true => (Unit::Radian, linkage.bodies.iter().find(|body| body.name == *name).map_or(0.0, |body| body.offset)),
        false => (Unit::Metre, 0.0),
    }
}

/// What is watched over the travel: coordinates, then for each drive its displacement and its influence, then the
/// bends.
fn functions(reduced: &Reduced) -> impl Fn(&Configuration, f64, &mut Vec<[f64; 2]>) + use<'_> {
    let (linkage, loading) = (reduced.linkage(), reduced.loading());
    let bends = bends(linkage);
    let followed = linkage.coordinates.len().min(FOLLOWED);
    let offsets: Vec<f64> = (0..followed).map(|i| of_coordinate(linkage, i).1).collect();
    move |c, revolutions, out| {
        for (i, offset) in offsets.iter().enumerate() {
            out.push([c.q[i] + revolutions * reduced.curve().growth(i) + offset, c.q_sigma[i]]);
        }
        for (drive, load) in loading.loads.iter().take(loading.drives.len().min(FOLLOWED)).enumerate() {
            let [s, s_sigma, s_second] = load.displacement(linkage, c);
            out.push([s + revolutions * reduced.load_growth(drive), s_sigma]);
            out.push([s_sigma, s_second]);
        }
        out.extend(bends.iter().take(FOLLOWED).map(|bend| [bend.angle(&c.positions).sin(), 0.0]));
    }
}

/// Least and largest value of a coordinate or a drive: `range`, or one cycle from the start on where the whole cycle is
/// travelled and it grows by `growth` over each.
fn from_start(range: [f64; 2], start: f64, growth: f64) -> [f64; 2] {
    if growth == 0.0 || (range[1] - range[0] - growth.abs()).abs() > 1e-6 * growth.abs() {
        return range;
    }
    [start.min(start + growth), start.max(start + growth)]
}

fn add_travel<'a>(
    reduced: &'a Reduced,
    state: &State,
    (here, ends): (f64, [f64; 2]),
    file_units: Units,
    out: &mut Inspection,
) -> Places<'a> {
    let (linkage, loading) = (reduced.linkage(), reduced.loading());
    let mut walk = Walk::new(reduced, ends, functions(reduced));
    let at_start = walk.at(here);
    let coordinates = linkage.coordinates.len().min(FOLLOWED);
    let places = Places::new(reduced, walk.steady(coordinates));
    let drives = loading.drives.len().min(FOLLOWED);
    let mut toggles = Vec::new();
    let goes_on = (0..2).any(|side| state.travel.rigid[side].is_none() && reduced.curve().is_open(side));
    for (i, name) in linkage.coordinates.iter().enumerate().take(FOLLOWED) {
        let unit = of_coordinate(linkage, i).0;
        let Extremes { range, stationary } = walk.extremes(i, 1.0);
        // Between stops that are less than a cycle apart, there is no cycle.
        let growth = Some(reduced.curve().growth(i)).filter(|growth| range[1] - range[0] >= 0.999_999 * growth.abs());
        let growth = growth.unwrap_or(0.0);
        let ([least, most], start) = (from_start(range, at_start[i][0], growth), at_start[i][0]);
        slots::warn(linkage, i, [least, most], out);
        let fact = Fact::new("Travel", name).with("least", least, unit).with("most", most, unit);
        let fact = fact.with("start", start, unit);
        let turns = growth / TAU;
        if turns == 0.0 && most - least <= 1e-9 * (1.0 + most.abs()) {
            out.facts.push(fact.saying("does not move"));
            continue;
        }
        out.facts.push(match turns == 0.0 {
            true if goes_on => fact.saying(FURTHER),
            true => fact,
            false => {
                let (turns, word) = (turns.round(), if turns.abs() < 1.5 { "turn" } else { "turns" });
                fact.saying(format!("makes {turns} full {word} in each cycle of the mechanism"))
            }
        });
        toggles.extend(stationary.iter().map(|&sigma| (sigma, name.clone(), None)));
    }
    add_ends(reduced, (state, &walk, places), file_units, out);
    for (drive, defined) in loading.drives.iter().enumerate().take(FOLLOWED) {
        let (motion, influence) =
            (walk.extremes(coordinates + 2 * drive, 1.0), walk.extremes(coordinates + 2 * drive + 1, 0.0));
        let (length, mass) = match defined.is_rotary {
            true => (Unit::Radian, Unit::KilogramSquareMetre),
            false => (Unit::Metre, Unit::Kilogram),
        };
        let start = at_start[coordinates + 2 * drive][0];
        let fact = Fact::new("Drives", &defined.name).with("start", start, length);
        let [least, most] = from_start(motion.range, start, reduced.load_growth(drive));
        let fact = fact.with("least", least, length).with("most", most, length);
        let fact = fact.with("stroke", most - least, length);
        out.facts.push(if goes_on { fact.saying(FURTHER) } else { fact });
        // The reduced mass is 1 / S_sigma^2.
        let [low, high] = influence.range;
        let slowest = if low < 0.0 && high > 0.0 { 0.0 } else { low.abs().min(high.abs()) };
        let start = at_start[coordinates + 2 * drive + 1][0].powi(-2);
        let fact = Fact::new("Reduced mass", &defined.name).with("start", start, mass);
        let fact = fact.with("least", low.abs().max(high.abs()).powi(-2), mass).with("most", slowest.powi(-2), mass);
        if !linkage.is_massless {
            out.facts.push(fact);
        }
        toggles.extend(motion.stationary.iter().map(|&sigma| (sigma, defined.name.clone(), Some(drive))));
    }
    add_toggles(places, ends, toggles, out);
    for (k, bend) in bends(linkage).iter().enumerate().take(FOLLOWED) {
        let [low, high] = walk.extremes(coordinates + 2 * drives + k, 1.0).range;
        if low * high > 0.0 {
            let fact = Fact::new("Assembly mode", &linkage.joints[bend.joints[1]].name);
            out.facts.push(fact.saying("bends to the same side over the whole travel"));
        }
    }
    add_singular(reduced, &state.travel, out);
    places
}

/// Dead centres in the order of the travel: sigma, name, and the drive whose displacement stands still.
fn add_toggles(words: Places, [low, high]: [f64; 2], toggles: Vec<(f64, String, Option<usize>)>, out: &mut Inspection) {
    let near = 1e-7 * (high - low);
    let mut places: Vec<Vec<(f64, String, Option<usize>)>> = Vec::new();
    for toggle in toggles {
        match places.iter_mut().find(|place| (place[0].0 - toggle.0).abs() <= near) {
            Some(place) => place.push(toggle),
            None => places.push(vec![toggle]),
        }
    }
    places.sort_by(|a, b| a[0].0.total_cmp(&b[0].0));
    for place in places.iter().take(PLACES) {
        // One text for all that stand still here.
        let drive = place.iter().find_map(|(_, _, drive)| *drive);
        let reason = words.in_line(place[0].0, drive);
        let reason = reason.map_or_else(String::new, |joints| format!("; {joints} are in line"));
        let text = format!("dead centre at {}{reason}", words.describe(place[0].0));
        out.facts.extend(place.iter().map(|(_, name, _)| Fact::new("Toggles", name).saying(&text)));
    }
    if places.len() > PLACES {
        out.facts.push(Fact::new("Toggles", "").saying(format!("and {} more", places.len() - PLACES)));
    }
}

/// What ends the travel on each side, the stops on the way, and those that are never met.
fn add_ends<F: Fn(&Configuration, f64, &mut Vec<[f64; 2]>)>(
    reduced: &Reduced,
    (state, walk, places): (&State, &Walk<F>, Places),
    file_units: Units,
    out: &mut Inspection,
) {
    let stops = &reduced.loading().stops;
    let turns = (0..reduced.linkage().coordinates.len()).any(|i| reduced.curve().growth(i) != 0.0);
    for (side, word) in ["backward", "forward"].into_iter().enumerate() {
        let text = match (&state.travel.rigid[side], &reduced.curve().ends) {
            (Some(end), _) => format!("{} at {}", stops[end.stop].name, places.describe(end.position)),
            (None, _) if reduced.ends_meet()[side].is_some() => {
                let reason = ends_meet(reduced, side);
                let message = format!(
                    "no stop ends the travel in the direction {word}, so a run can end with an error: {reason}"
                );
                out.findings.push(Finding::warning("stops", message, "add a stop before this position"));
                format!("no stop: {reason}")
            }
            (None, Ends::Closed(_)) if turns => "no stop: the mechanism turns without end".to_owned(),
            (None, Ends::Closed(_)) => "no stop: the motion is a cycle that returns to its start".to_owned(),
            (None, _) => format!("no stop: the motion continues beyond {}", places.describe(walk.ends[side])),
        };
        out.facts.push(Fact::new("Ends of travel", word).saying(text));
        for bumper in &state.travel.bumpers {
            if let Some(position) = bumper.positions[side] {
                let text = format!("bumper {} starts at {}", stops[bumper.stop].name, places.describe(position));
                out.facts.push(Fact::new("Ends of travel", word).saying(text));
            }
        }
    }
    for (index, stop) in stops.iter().enumerate().filter(|(_, stop)| stop.enabled && !stop.of_cylinder) {
        let ends = state.travel.stops().any(|(met, _)| met == index);
        let begins = state.travel.bumpers.iter().any(|b| b.stop == index && b.positions.iter().any(Option::is_some));
        if ends || begins {
            continue;
        }
        let beyond = |sigma: f64| {
            let (on_curve, revolutions) = reduced.unwound(sigma);
            stop.beyond(reduced.displacement_at(stop.load, on_curve, 0) + revolutions * reduced.load_growth(stop.load))
        };
        let (nearest, at) = walk.most(beyond);
        let as_degrees = stop.quantity == "angle" && stop.value.abs() > PI && !file_units.has_degrees();
        let remedy = match as_degrees {
            true => {
                format!(
                    "if you mean {} degrees, write {} rad",
                    Decimal(stop.value),
                    Decimal::rounded(stop.value * PI / 180.0)
                )
            }
            false => "correct the value of the stop, or write \"enabled\": false".to_owned(),
        };
        let (factor, unit) = match stop.quantity {
            "angle" if file_units.has_degrees() => (180.0 / PI, "deg"),
            "angle" => (1.0, "rad"),
            _ if file_units.has_millimetres() => (1e3, "mm"),
            _ => (1.0, "m"),
        };
        let short: f64 = format!("{:.3e}", -nearest * factor).parse().unwrap_or(-nearest * factor);
        let ending = [0, 1].into_iter().find(|&side| at == walk.ends[side]).and_then(|side| state.travel.rigid[side]);
        let ends = match ending {
            Some(end) => format!("the stop {} ends the motion {} {unit} before", stops[end.stop].name, Decimal(short)),
            None if walk.ends.contains(&at) => format!("the motion ends {} {unit} before", Decimal(short)),
            None => format!("the motion turns back {} {unit} before", Decimal(short)),
        };
        let joints = places.in_line(at, None).filter(|_| !walk.ends.contains(&at));
        let reason = joints.map_or_else(String::new, |joints| format!(": {joints} come into line (dead centre)"));
        let remedy = if reason.is_empty() { remedy } else { format!("{LINKS} {remedy}") };
        let message = format!("the stop is never reached: {ends} this stop{reason}");
        out.findings.push(Finding::warning(format_args!("stops.{}", stop.name), message, remedy));
    }
}

/// Why the motion ends on a side where two ends of a load coincide.
fn ends_meet(reduced: &Reduced, side: usize) -> String {
    match reduced.next(reduced, side) {
        Err(End::Failed(reason)) => reason.to_string(),
        _ => String::new(),
    }
}

/// Crossings of branches within the travel, and positions where the lengths almost let them cross.
fn add_singular(reduced: &Reduced, travel: &Travel, out: &mut Inspection) {
    let curve = reduced.curve();
    let crosses = |sigma: &&f64| is_within(reduced, travel, **sigma) && curve.branches_cross(**sigma);
    for &sigma in curve.crossings.iter().filter(crosses).take(PLACES) {
        let text = format!(
            "two branches of motion cross at {}, so the mechanism can continue in two ways; the computed motion \
             continues straight",
            curve.describe(sigma, 0.0)
        );
        out.facts.push(Fact::new("Crossings", "").saying(text));
    }
    for miss in curve.near.misses.iter().filter(|miss| is_within(reduced, travel, miss.sigma)).take(PLACES) {
        let text = format!(
            "two branches of motion almost cross at {}; the computed motion turns sharply at this position and does \
             not continue straight",
            miss.position
        );
        let fact = Fact::new(NEAR, "").with("miss", miss.miss * curve.linkage().size, Unit::Metre);
        out.facts.push(fact.with("relative to the mechanism", miss.miss, Unit::One).saying(text));
    }
}

/// Joints whose conditions follow from those of others.
fn add_redundant_joints(reduced: &Reduced, c: &Configuration, facts: &mut Vec<Fact>) {
    let closure = &reduced.curve().closure;
    if !closure.redundant() {
        return;
    }
    let linkage = &*closure.linkage;
    let (all, joints) = (linkage.jacobian(&c.positions, &c.q), linkage.row_joints());
    let kept = closure.rows();
    let independent = DMatrix::from_fn(all.ncols(), kept.len(), |column, k| all[(kept[k], column)]);
    // A single coordinate has no independent equation.
    let svd = (!kept.is_empty()).then(|| independent.svd(true, true));
    let mut told: Vec<(usize, Vec<usize>)> = Vec::new();
    for row in (0..linkage.rows()).filter(|row| !kept.contains(row)) {
        let right = DVector::from_fn(all.ncols(), |column, _| all[(row, column)]);
        let parts = svd.as_ref().and_then(|svd| svd.solve(&right, 1e-12).ok());
        let follows = |k: &usize| parts.as_ref().is_some_and(|parts| parts[*k].abs() > 1e-6);
        let others = (0..kept.len()).filter(follows).map(|k| joints[kept[k]]);
        match told.iter_mut().find(|(joint, _)| *joint == joints[row]) {
            Some((_, known)) => known.extend(others),
            None => told.push((joints[row], others.collect())),
        }
    }
    for (joint, mut others) in told {
        others.retain(|other| *other != joint);
        others.sort_unstable();
        others.dedup();
        let names: Vec<&str> = others.iter().map(|&other| linkage.joints[other].name.as_str()).collect();
        let text = match names.is_empty() {
            true => "this joint is redundant, because other joints of the loop impose the same constraints; these \
                joints share the reactions"
                .to_owned(),
            false => {
                format!(
                    "this joint is redundant, because the joint repeats the constraints of {}; the joints of these \
                     loops share the reactions",
                    names.join(", ")
                )
            }
        };
        facts.push(Fact::new("Redundant joints", &linkage.joints[joint].name).saying(text));
    }
}
