//! Warnings about an assembled mechanism: it runs, but is probably not the one that is meant.
//!
//! In: a definition and its reduced model. Out: warnings. It must not know states.
mod belts;
mod cams;
mod locking;

pub use belts::of_slack_belt;

use super::closure::{AssemblyError, guessed, straight};
use super::curve::{Near, NearMiss, REPORTED, cure};
use super::definition::Mechanism;
use super::linkage::{GROUND, Linkage};
use super::motion::contact::Travel;
use super::reduced::Reduced;
use crate::inspection::Finding;
use crate::numerics::decimal::Decimal;
use std::f64::consts::{PI, TAU};

/// Distance of an assembled angle from its guess that is far [rad], and of a position in sizes of the linkage.
const FAR: f64 = 0.5;
/// Least move of a joint's point that is told, as a part of the largest one, and most of them that are told.
const TOLD: f64 = 1e-3;
const MOST_TOLD: usize = 12;
/// Difference of two pitch radii that are one, relative to their size.
const SAME: f64 = 3.2e-5;

/// All warnings that need geometry.
pub fn warnings(mechanism: &Mechanism, reduced: &Reduced) -> Vec<Finding> {
    let mut all = of_guess(mechanism, reduced.linkage(), &reduced.curve().guess);
    warn_of_grounded_loads(mechanism, reduced.linkage(), &mut all);
    warn_of_idle_loads(mechanism, reduced, &mut all);
    cams::warn_of_cams(reduced.linkage(), &mut all);
    belts::warn_of_overlaps(reduced.linkage(), &mut all);
    locking::warn_of_locking(mechanism, reduced, &mut all);
    warn_of_wheels(mechanism, reduced.linkage(), &reduced.curve().guess, &mut all);
    all
}

/// The warning about a drive whose motion begins elsewhere than the start has it: both displacements [m or rad].
pub fn of_jump(mechanism: &Mechanism, [here, there]: [f64; 2]) -> Option<Finding> {
    let mut drives = mechanism.actuators.iter();
    let (name, drive, motion) = drives.find_map(|(name, drive)| Some((name, drive, drive.motion.as_ref()?)))?;
    let unit = if mechanism.turns(drive) { "rad" } else { "m" };
    let [here, there] = [here, there].map(|at| format!("{} {unit}", Decimal::rounded(at)));
    let message = format_args!(
        "the prescribed motion starts at {there}, but the drive is at {here} at the start: the drive would jump to \
         {there}"
    );
    let (key, remedy) = match motion.profile {
        Some(_) => (
            "points",
            format!("let the table start with 0 {unit} at time 0, because its distances count from the start position"),
        ),
        None => ("position", format!("write {here}, or start the mechanism at the position {there} of the drive")),
    };
    Some(Finding::warning(format_args!("actuators.{name}.motion.{key}"), message, remedy))
}

/// Warn of a wheel that has one number of teeth and two pitch circles.
fn warn_of_wheels(mechanism: &Mechanism, linkage: &Linkage, assembled: &[f64], all: &mut Vec<Finding>) {
    let positions = linkage.positions(assembled);
    let mut known: Vec<(usize, f64, f64, &str)> = Vec::new();
    for ((name, defined), coupling) in mechanism.couplings.iter().zip(&linkage.couplings) {
        let (Some(first), Some(second)) = (defined.first_teeth, defined.second_teeth) else { continue };
        let joint = &linkage.joints[coupling.joint];
        let distance = (positions.point(joint.second) - positions.point(joint.first)).norm();
        let ratio = if defined.internal == Some(true) { -first / second } else { first / second };
        let of_second = distance / (1.0 + ratio);
        let wheels = [
            ("first", joint.first.body, first, (ratio * of_second).abs()),
            ("second", joint.second.body, second, of_second.abs()),
        ];
        for (which, body, teeth, radius) in wheels {
            let same = known.iter().find(|(wheel, count, ..)| (*wheel, *count) == (body, teeth));
            let Some(&(.., other, at)) = same else {
                known.push((body, teeth, radius, name));
                continue;
            };
            if (radius - other).abs() > SAME * radius {
                let message = format_args!(
                    "this coupling gives the wheel of {} with {teeth} teeth a pitch radius of {} m, but \
                     couplings.{at} gives this wheel a pitch radius of {} m",
                    linkage.bodies[body].name,
                    Decimal::rounded(radius),
                    Decimal::rounded(other)
                );
                let remedy = "if both couplings use the same wheel, check the numbers of teeth: the ring of a \
                              planetary gear has as many teeth as the sun and two planets together";
                all.push(Finding::warning(format_args!("couplings.{name}.{which}_teeth"), message, remedy));
            }
        }
    }
}

/// Warnings about coordinates that the loops have closed far from the guess; `assembled`: the closed coordinates.
pub fn of_guess(mechanism: &Mechanism, linkage: &Linkage, assembled: &[f64]) -> Vec<Finding> {
    let mut all = Vec::new();
    let Ok(guess) = guessed(linkage, &mechanism.guess) else { return all };
    for (i, name) in linkage.coordinates.iter().enumerate() {
        let is_angle = i < linkage.angles;
        let away = (assembled[i] - guess[i]).abs();
        if away <= if is_angle { FAR } else { FAR * linkage.size } {
            continue;
        }
        // The guess may name another body of the same angle; the value that the file states is told.
        let offset = linkage.bodies.iter().find(|body| body.name == *name).map_or(0.0, |body| body.offset);
        let path = if mechanism.guess.get(name).is_some() { format!("guess.{name}") } else { "guess".to_owned() };
        let [stated, found] = [guess[i] + offset, assembled[i] + offset].map(Decimal::rounded);
        let message = match is_angle {
            true => format!(
                "{name} is assembled at {found} rad ({} deg), which differs by {} rad from its guess of {stated} \
                 rad ({} deg)",
                Decimal::rounded(found.0 * 180.0 / PI),
                Decimal::rounded(away),
                Decimal::rounded(stated.0 * 180.0 / PI)
            ),
            false => {
                format!(
                    "{name} is assembled at {found} m, which differs by {} m from its guess of {stated} m",
                    Decimal::rounded(away)
                )
            }
        };
        let as_degrees = stated.0 * PI / 180.0;
        let off = (found.0 - as_degrees).rem_euclid(TAU);
        let may_be_degrees = is_angle && !mechanism.file_units.has_degrees();
        let remedy = match may_be_degrees && off.min(TAU - off) <= FAR && stated.0.abs() > PI {
            true => format!(
                "if you mean {stated} degrees, write {} rad or add \"units\": {{ \"angle\": \"deg\" }}",
                Decimal::rounded(as_degrees)
            ),
            false => {
                let unit = if is_angle { "rad" } else { "m" };
                format!(
                    "if this assembly is correct, write {found} {unit}; otherwise check the lengths or improve the \
                     guess"
                )
            }
        };
        all.push(Finding::warning(path, message, remedy));
    }
    all
}

/// Warnings about places within the travel where the lengths almost let branches cross, so that the motion turns off.
pub fn of_near_misses(mechanism: &Mechanism, reduced: &Reduced, travel: &Travel) -> Vec<Finding> {
    let size = reduced.linkage().size;
    let misses = || reduced.curve().near.misses.iter().filter(|miss| is_within(reduced, travel, miss.sigma));
    // No branches cross where a loop is stretched flat, however its points are moved.
    let drawn = reduced.curve().drawn();
    let flat = misses().next().and_then(|_| straight(drawn, REPORTED));
    if let Some(error @ AssemblyError::TooLong { joint, .. }) = &flat {
        return vec![Finding::warning(format_args!("joints.{joint}"), error.to_string(), "")];
    }
    let warning = |miss: &NearMiss| {
        let message = format_args!(
            "branches of motion almost cross at {}: the lengths miss a crossing by {:.1e} of the size of the mechanism \
             ({:.1e} m), and the motion turns sharply at this position",
            miss.position,
            miss.miss,
            miss.miss * size
        );
        let remedy = format_args!(
            "if the mechanism must continue straight at this position, write \"snap\": {:e} or correct the lengths",
            cure(miss.miss)
        );
        Finding::warning(if mechanism.snap.is_some() { "snap" } else { "" }, message, remedy)
    };
    misses().map(warning).collect()
}

/// Whether a sigma on the curve is within the travel.
pub fn is_within(reduced: &Reduced, travel: &Travel, sigma: f64) -> bool {
    let [low, high] = [0, 1].map(|side| travel.end(side));
    let Some(period) = reduced.period() else {
        return low.is_none_or(|low| low <= sigma) && high.is_none_or(|high| sigma <= high);
    };
    let (Some(low), Some(high)) = (low, high) else { return true };
    (low..=high).contains(&(sigma + ((low - sigma) / period).ceil() * period))
}

/// What was done to the lengths so that branches cross, a line for each place.
pub fn remarks(reduced: &Reduced, snap: f64) -> Vec<String> {
    let Near { drawn, snapped, moves, .. } = &reduced.curve().near;
    let Some(drawn) = drawn else { return Vec::new() };
    let largest = moves.iter().map(|(_, change)| change.norm()).fold(0.0, f64::max);
    let mut told: Vec<String> = Vec::new();
    for (point, change) in moves.iter().filter(|(_, change)| change.norm() > TOLD * largest) {
        let joints = drawn.joints.iter().filter(|joint| [joint.first, joint.second].contains(point));
        let names: Vec<&str> = joints.map(|joint| joint.name.as_str()).collect();
        told.push(format!("{} of {} by {:.1e} m", names.join(", "), drawn.bodies[point.body].name, change.norm()));
    }
    let count = told.len();
    told.truncate(MOST_TOLD);
    if count > MOST_TOLD {
        told.push(format!("and {} more", count - MOST_TOLD));
    }
    let mut lines: Vec<String> = snapped
        .iter()
        .map(|(position, miss)| {
            format!(
                "two branches of motion almost cross at {position}: the lengths miss the crossing by {miss:.1e} of the \
                 size of the mechanism, less than snap = {}, so the program corrects the lengths and the motion \
                 continues straight",
                Decimal(snap)
            )
        })
        .collect();
    lines.push(format!(
        "to correct the lengths, the program moves points of joints by at most {largest:.1e} m: {}",
        told.join("; ")
    ));
    lines
}

/// Forces and torques on the ground or on what is fixed to it.
fn warn_of_grounded_loads(mechanism: &Mechanism, linkage: &Linkage, all: &mut Vec<Finding>) {
    let forces = mechanism.forces.iter().map(|(name, force)| ("forces", name, "at", force.at.as_str()));
    let torques = mechanism.torques.iter().map(|(name, torque)| ("torques", name, "on", torque.on.as_str()));
    for (group, name, key, at) in forces.chain(torques) {
        let body = at.split('.').next().unwrap_or_default();
        if linkage.carrier(mechanism, body).is_some_and(|(carrier, _)| carrier == GROUND) {
            let message = format_args!("this load acts on {at}, which does not move, so it has no effect");
            let remedy = if key == "at" { "give a point that moves" } else { "give a body that moves" };
            all.push(Finding::warning(format_args!("{group}.{name}.{key}"), message, remedy));
        }
    }
}

/// Drives and springs between two points or in a joint that never move relative to one another.
fn warn_of_idle_loads(mechanism: &Mechanism, reduced: &Reduced, all: &mut Vec<Finding>) {
    let loading = reduced.loading();
    let drives = mechanism.actuators.names().into_iter().enumerate().map(|(load, name)| ("actuators", name, load));
    let springs = loading.springs.iter().map(|spring| ("springs", spring.name.as_str(), spring.load));
    for (group, name, load) in drives.chain(springs) {
        let load = loading.loads[load].along();
        if load.is_idle() {
            let at = load.displacement_at(reduced.linkage(), &reduced.linkage().positions(&reduced.curve().guess));
            let (words, remedy) = load.idle_words(at, reduced.linkage().size);
            let message = format_args!("{words}, so this element never moves the mechanism and only loads the joints");
            all.push(Finding::warning(format_args!("{group}.{name}"), message, remedy));
        }
    }
}
