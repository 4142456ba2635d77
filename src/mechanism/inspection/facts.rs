//! Facts about a mechanism: its masses, its assembly, its travel, its drives.
//!
//! In: a model. Out: facts, and warnings about its travel. It must not know steps.
use super::travel::{Extremes, Walk};
use super::{equilibrium, friction};
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
use crate::numerics::plane::{Vec2, cross};
use crate::variables::Unit;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// Topic of positions where branches almost cross, by lengths that may be as small as rounding.
const NEAR: &str = "Near misses";
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
    add_travel(&reduced, &state, (here, ends), *mechanism.file_units, out);
    friction::add((&reduced, &state), &model.original.inputs, ends, out);
    add_redundant_joints(&reduced, &assembled, &mut out.facts);
    equilibrium::add(model, &reduced, &state, &mut out.facts);
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
    let mut fact = Fact::new("Mass", "").with("total", mass, Unit::Kilogram);
    if mass > 0.0 {
        let center = moment / mass;
        fact = fact.with("centre x", center.x, Unit::Metre).with("centre y", center.y, Unit::Metre);
    }
    facts.push(fact.saying(format!(
        "{} moving bodies, {} joints, {} closed loops",
        linkage.bodies.len() - 1,
        linkage.joints.len() - linkage.couplings.len(),
        linkage.cuts.len() - linkage.couplings.len()
    )));
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

/// Two links at a joint between moving bodies, as seen from the next joint of each.
struct Bend {
    /// The next joint of one body, the joint, the next joint of the other body.
    joints: [usize; 3],
    points: [Point; 3],
}

impl Bend {
    /// Angle by which the way through the three joints turns, anticlockwise positive [rad].
    fn angle(&self, positions: &Positions) -> f64 {
        let [from, at, to] = self.points.map(|point| positions.point(point));
        let (one, other) = (at - from, to - at);
        cross(one, other).atan2(one.dot(&other))
    }
}

/// The bends whose sides tell in which way a linkage is put together: at revolute joints between two moving bodies.
fn bends(linkage: &Linkage) -> Vec<Bend> {
    let mut joints_of: Vec<Vec<usize>> = vec![Vec::new(); linkage.bodies.len()];
    let hinges = || linkage.joints[..linkage.joints.len() - linkage.couplings.len()].iter().enumerate();
    for (index, joint) in hinges() {
        joints_of[joint.first.body].push(index);
        joints_of[joint.second.body].push(index);
    }
    let mut all = Vec::new();
    for (index, joint) in hinges() {
        let bodies = [joint.first.body, joint.second.body];
        if joint.freedom.rows() != 2 || bodies.contains(&GROUND) {
            continue;
        }
        let next = |own: Point| {
            let on = |other: usize| {
                let j = &linkage.joints[other];
                if j.first.body == own.body { j.first } else { j.second }
            };
            let apart = |other: &usize| (on(*other).local - own.local).norm() > 1e-9 * linkage.size;
            let other = joints_of[own.body].iter().copied().filter(|other| *other != index).find(apart);
            other.map(|other| (other, on(other)))
        };
        if let (Some((from, one)), Some((to, other))) = (next(joint.first), next(joint.second)) {
            all.push(Bend { joints: [from, index, to], points: [one, joint.first, other] });
        }
    }
    all
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

/// Least and largest value of a coordinate or a drive: `range`, or one cycle from the start on where it grows by
/// `growth` over each cycle.
fn from_start(range: [f64; 2], start: f64, growth: f64) -> [f64; 2] {
    if growth == 0.0 || range[1] - range[0] > 1.000_001 * growth.abs() {
        return range;
    }
    [start.min(start + growth), start.max(start + growth)]
}

fn add_travel(
    reduced: &Reduced,
    state: &State,
    (here, ends): (f64, [f64; 2]),
    file_units: Units,
    out: &mut Inspection,
) {
    let (linkage, loading) = (reduced.linkage(), reduced.loading());
    let mut walk = Walk::new(reduced, ends, functions(reduced));
    let at_start = walk.at(here);
    let coordinates = linkage.coordinates.len().min(FOLLOWED);
    let drives = loading.drives.len().min(FOLLOWED);
    let mut toggles = Vec::new();
    for (i, name) in linkage.coordinates.iter().enumerate().take(FOLLOWED) {
        let unit = of_coordinate(linkage, i).0;
        let Extremes { range, stationary } = walk.extremes(i, 1.0);
        let growth = reduced.curve().growth(i);
        let ([least, most], start) = (from_start(range, at_start[i][0], growth), at_start[i][0]);
        let fact = Fact::new("Travel", name).with("least", least, unit).with("most", most, unit);
        let fact = fact.with("start", start, unit);
        let turns = growth / TAU;
        if turns == 0.0 && most - least <= 1e-9 * (1.0 + most.abs()) {
            out.facts.push(fact.saying("does not move"));
            continue;
        }
        out.facts.push(match turns == 0.0 {
            true => fact,
            false => fact.saying(format!("makes {} full turns in each cycle of the mechanism", turns.round())),
        });
        toggles.extend(stationary.iter().map(|&sigma| (name.clone(), sigma)));
    }
    add_ends(reduced, state, &walk, file_units, out);
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
        out.facts.push(fact.with("least", least, length).with("most", most, length).with(
            "stroke",
            most - least,
            length,
        ));
        // The reduced mass is 1 / S_sigma^2.
        let [low, high] = influence.range;
        let slowest = if low < 0.0 && high > 0.0 { 0.0 } else { low.abs().min(high.abs()) };
        let start = at_start[coordinates + 2 * drive + 1][0].powi(-2);
        let fact = Fact::new("Reduced mass", &defined.name).with("start", start, mass);
        let fact = fact.with("least", low.abs().max(high.abs()).powi(-2), mass).with("most", slowest.powi(-2), mass);
        out.facts.push(fact);
        toggles.extend(motion.stationary.iter().map(|&sigma| (defined.name.clone(), sigma)));
    }
    let told = toggles.len();
    for (name, sigma) in toggles.into_iter().take(PLACES) {
        out.facts.push(Fact::new("Toggles", name).saying(format!("dead centre at {}", walk.describe(sigma))));
    }
    if told > PLACES {
        out.facts.push(Fact::new("Toggles", "").saying(format!("and {} more", told - PLACES)));
    }
    for (k, bend) in bends(linkage).iter().enumerate().take(FOLLOWED) {
        let [low, high] = walk.extremes(coordinates + 2 * drives + k, 1.0).range;
        if low * high > 0.0 {
            let fact = Fact::new("Assembly mode", &linkage.joints[bend.joints[1]].name);
            out.facts.push(fact.saying("bends to the same side over the whole travel"));
        }
    }
    add_singular(reduced, &state.travel, out);
}

/// What ends the travel on each side, the stops on the way, and those that are never met.
fn add_ends<F: Fn(&Configuration, f64, &mut Vec<[f64; 2]>)>(
    reduced: &Reduced,
    state: &State,
    walk: &Walk<F>,
    file_units: Units,
    out: &mut Inspection,
) {
    let stops = &reduced.loading().stops;
    let turns = (0..reduced.linkage().coordinates.len()).any(|i| reduced.curve().growth(i) != 0.0);
    for (side, word) in ["backward", "forward"].into_iter().enumerate() {
        let text = match (&state.travel.rigid[side], &reduced.curve().ends) {
            (Some(end), _) => format!("{} at {}", stops[end.stop].name, walk.describe(end.position)),
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
            (None, _) => format!("no stop: the motion continues beyond {}", walk.describe(walk.ends[side])),
        };
        out.facts.push(Fact::new("Ends of travel", word).saying(text));
        for bumper in &state.travel.bumpers {
            if let Some(position) = bumper.positions[side] {
                let text = format!("bumper {} starts at {}", stops[bumper.stop].name, walk.describe(position));
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
        let values = walk.positions.iter().map(|&sigma| {
            let (on_curve, revolutions) = reduced.unwound(sigma);
            reduced.displacement_at(stop.load, on_curve, 0) + revolutions * reduced.load_growth(stop.load)
        });
        let nearest = values.fold(f64::NEG_INFINITY, |most: f64, s| most.max(stop.beyond(s)));
        let unit = if stop.quantity == "angle" { "rad" } else { "m" };
        let as_degrees = stop.quantity == "angle" && stop.value.abs() > PI && !file_units.has_degrees();
        let remedy = match as_degrees {
            true => {
                format!(
                    "if you mean {} degrees, write {} rad",
                    Decimal(stop.value),
                    Decimal::rounded(stop.value * PI / 180.0)
                )
            }
            false => "correct the value, or write \"enabled\": false".to_owned(),
        };
        let short: f64 = format!("{:.2e}", -nearest).parse().unwrap_or(-nearest);
        let message = format!("is never reached: the motion ends {} {unit} before this stop", Decimal(short));
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
            "two branches of motion cross at {}; the motion continues straight through the crossing",
            curve.describe(sigma, 0.0)
        );
        out.facts.push(Fact::new("Crossings", "").saying(text));
    }
    for miss in curve.near.misses.iter().filter(|miss| is_within(reduced, travel, miss.sigma)).take(PLACES) {
        let text = format!(
            "two branches of motion almost cross at {}; the motion turns sharply at this position and does not \
             continue straight",
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
            true => "is redundant, because other joints of the loop impose the same constraints; these joints share \
                the reactions"
                .to_owned(),
            false => {
                format!(
                    "is redundant, because this joint repeats the constraints of {}; the joints of these loops share \
                     the reactions",
                    names.join(", ")
                )
            }
        };
        facts.push(Fact::new("Redundant joints", &linkage.joints[joint].name).saying(text));
    }
}
