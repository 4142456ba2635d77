//! The parts of a mechanism as tables: bodies, joints, drives, springs, stops, locks, markers.
//!
//! In: a checked definition. Out: rows of texts. The first text of each row is the name.

use super::variables::rounded;
use crate::check::FileUnits;
use linkage_fmu::mechanism::definition::{Between, JointKind, Limit, Mechanism, Stop};
use serde::Serialize;

/// Largest number of rows of a table. The definition contains the other parts.
const MOST_ROWS: usize = 5000;

/// A table of parts.
#[derive(Debug, Serialize)]
pub struct Table {
    title: &'static str,
    columns: Vec<String>,
    rows: Vec<Vec<String>>,
    /// Number of parts without a row.
    left_out: usize,
}

impl Table {
    fn new(title: &'static str, columns: Vec<String>, rows: impl Iterator<Item = Vec<String>>) -> Self {
        let mut rows: Vec<_> = rows.collect();
        let left_out = rows.len().saturating_sub(MOST_ROWS);
        rows.truncate(MOST_ROWS);
        Self { title, columns, rows, left_out }
    }
}

/// The parts of a mechanism, in the units of the file.
pub fn tables(mechanism: &Mechanism, units: &FileUnits) -> Vec<Table> {
    let (unit, factor) = units.of("m").unwrap_or(("m", 1.0));
    let length = |value: f64| rounded(value * factor);
    let bodies = mechanism.bodies.iter().map(|(name, body)| {
        let [x, y] = body.center_of_mass();
        let carried = body.fixed_to.clone().unwrap_or_default();
        let center = if body.mass.is_some() { format!("{}, {}", length(x), length(y)) } else { String::new() };
        let long = body.length.map(length).unwrap_or_default();
        vec![name.to_owned(), body.mass.map(rounded).unwrap_or_default(), center, long, carried]
    });
    let joints = mechanism.joints.iter().map(|(name, joint)| {
        let kind = match joint.kind {
            JointKind::Revolute => "revolute",
            JointKind::Prismatic => "prismatic",
            JointKind::Slot => "slot",
        };
        vec![name.to_owned(), kind.to_owned(), joint.first.clone(), joint.second.clone()]
    });
    let drives = mechanism.actuators.iter().map(|(name, drive)| {
        let kind = if drive.hydraulics.is_some() { "hydraulic drive" } else { "drive" };
        vec![name.to_owned(), kind.to_owned(), words(drive.between())]
    });
    let springs = mechanism
        .springs
        .iter()
        .map(|(name, spring)| vec![name.to_owned(), "spring or damper".to_owned(), words(spring.between())]);
    let forces =
        mechanism.forces.iter().map(|(name, force)| vec![name.to_owned(), "force".to_owned(), force.at.clone()]);
    let torques =
        mechanism.torques.iter().map(|(name, torque)| vec![name.to_owned(), "torque".to_owned(), torque.on.clone()]);
    let surfaces = mechanism.surfaces.iter().map(|(name, surface)| {
        let at = [&surface.at, &surface.from, &surface.to].into_iter().flatten().cloned().collect::<Vec<_>>();
        vec![name.to_owned(), "drag".to_owned(), at.join(" to ")]
    });
    let stops = mechanism.stops.iter().map(|(name, stop)| vec![name.to_owned(), "stop".to_owned(), limit(stop, units)]);
    let locks = mechanism.locks.iter().map(|(name, lock)| {
        vec![name.to_owned(), "lock".to_owned(), format!("holds {} at the stop {}", lock.at, lock.stop)]
    });
    let markers =
        mechanism.markers.iter().map(|(name, marker)| vec![name.to_owned(), "marker".to_owned(), marker.at.clone()]);
    let loads = drives.chain(springs).chain(forces).chain(torques).chain(surfaces);
    let tables = [
        Table::new(
            "Bodies",
            vec![
                "Body".to_owned(),
                "Mass [kg]".to_owned(),
                format!("Centre of mass [{unit}]"),
                format!("Length [{unit}]"),
                "Fixed to".to_owned(),
            ],
            bodies,
        ),
        Table::new("Joints", columns(&["Joint", "Kind", "First body", "Second body"]), joints),
        Table::new("Drives and loads", columns(&["Name", "Kind", "Where"]), loads),
        Table::new("Stops, locks and markers", columns(&["Name", "Kind", "Where"]), stops.chain(locks).chain(markers)),
    ];
    tables.into_iter().filter(|table| !table.rows.is_empty()).collect()
}

fn columns(names: &[&str]) -> Vec<String> {
    names.iter().map(|&name| name.to_owned()).collect()
}

/// The ends of a connection, its joint or its bodies.
fn words(place: Option<Between>) -> String {
    match place {
        Some(Between::Points([first, second])) => format!("{first} to {second}"),
        Some(Between::Joint(joint)) => format!("in {joint}"),
        Some(Between::Bodies([first, second])) => format!("{second} relative to {first}"),
        None => String::new(),
    }
}

/// The quantity that a stop limits, and the limit.
fn limit(stop: &Stop, units: &FileUnits) -> String {
    let side = if stop.limit == Limit::Lower { "at least" } else { "at most" };
    let of = stop.body.clone().or(stop.joint.clone()).unwrap_or_else(|| words(stop.between()));
    let (quantity, value, unit) = match (stop.angle, stop.position, stop.length) {
        (Some(angle), ..) => ("angle", angle, "rad"),
        (_, Some(position), _) => ("position", position, "m"),
        (.., length) => ("length", length.unwrap_or(f64::NAN), "m"),
    };
    let state = if stop.enabled { "" } else { ", switched off" };
    format!("{quantity} of {of} {side} {}{state}", units.quantity(value, unit))
}
