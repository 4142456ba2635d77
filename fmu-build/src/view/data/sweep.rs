//! The travel without time: poses, coordinates and forces at rest from one end to the other, with marked positions.
//!
//! In: a model at its start. Out: series over the travel from the engine. The module must not know how anything is
//! drawn.

use super::motion::Recorded;
use crate::check::FileUnits;
use crate::view::series::Series;
use linkage_fmu::mechanism::inspection::{On, Pose, Scene, Sweep, SweptStop};
use linkage_fmu::mechanism::{Model, ModelError};
use linkage_fmu::variables::{Causality, Reference, Unit};
use serde::Serialize;

/// Number of parts of the travel.
const PARTS: usize = 240;
/// Largest number of series of forces, and of mechanical advantages.
const MOST: [usize; 2] = [32, 8];
/// Largest number of marks of one kind.
const MARKS: usize = 24;
/// Quantities of a drive at rest. The second name is that for a rotary drive.
const OF_DRIVE: [[&str; 2]; 5] = [
    ["holding_force", "holding_torque"],
    ["breakaway_force_forward", "breakaway_torque_forward"],
    ["breakaway_force_backward", "breakaway_torque_backward"],
    ["static_load", "static_load"],
    ["reduced_mass", "reduced_inertia"],
];

/// The travel without time.
#[derive(Clone, Debug, Serialize)]
pub struct Travel {
    /// Number of positions.
    count: usize,
    /// Angle, x and y of each body of the linkage.
    poses: Vec<[Series; 3]>,
    /// Coordinates and displacements of the drives, then quantities at rest.
    values: Vec<Recorded>,
    /// Names of the quantities that are plotted at first.
    plotted: Vec<String>,
    /// Name of the drive that holds the mechanism at each position.
    held_by: Option<String>,
    /// Position of the start, from 0 at the low end to 1 at the high end.
    start: f64,
    is_closed: bool,
    goes_on: [bool; 2],
    stops: Vec<Met>,
    /// Name of the stop at the low and the high end.
    ends: [Option<String>; 2],
    dead_centres: Vec<Mark>,
    equilibria: Vec<Mark>,
}

/// A stop that is reached.
#[derive(Clone, Debug, Serialize)]
struct Met {
    stop: usize,
    /// Position from 0 at the low end to 1 at the high end.
    at: f64,
    poses: Vec<Pose>,
}

/// A marked position of the travel, with its name.
#[derive(Clone, Debug, Serialize)]
struct Mark {
    /// Position from 0 at the low end to 1 at the high end.
    at: f64,
    name: String,
}

impl Travel {
    /// The travel of a model under its present parameters.
    ///
    /// # Errors
    /// There is no model, or no start.
    pub fn new(model: &mut Model, scene: &Scene, units: &FileUnits) -> Result<Self, ModelError> {
        let sweep = model.sweep(PARTS)?;
        let [low, high] = [sweep.sigma[0], sweep.sigma[PARTS]];
        let part = |sigma: f64| if high > low { (sigma - low) / (high - low) } else { 0.0 };
        let is_shown = |at: &f64| (0.0..=1.0).contains(at);
        let bodies = sweep.poses.first().map_or(0, Vec::len);
        let pose = |body: usize| {
            [0, 1, 2].map(|i| Series::new(&sweep.poses.iter().map(|poses| poses[body][i]).collect::<Vec<_>>()))
        };
        let mut values = positions(&sweep, units);
        let at_rest = at_rest(model, scene, &sweep.sigma, units);
        let plotted = at_rest.iter().filter(|one| is_plotted(&one.name)).map(|one| one.name.clone()).collect();
        let held_by = holder(model, scene).filter(|_| !at_rest.is_empty()).map(|(name, _)| name);
        values.extend(at_rest);
        values.extend(advantages(&sweep, scene));
        let met =
            |SweptStop { stop, sigma, poses }: &SweptStop| Met { stop: *stop, at: part(*sigma), poses: poses.clone() };
        let equilibria = model.equilibria().unwrap_or_default().into_iter().map(|one| {
            let name = if one.place.is_some() || one.is_stable { "stable" } else { "unstable" };
            Mark { at: part(one.position), name: name.to_owned() }
        });
        Ok(Self {
            count: sweep.sigma.len(),
            poses: (0..bodies).map(pose).collect(),
            values,
            plotted,
            held_by,
            start: part(sweep.start),
            is_closed: sweep.is_closed,
            goes_on: sweep.goes_on,
            stops: sweep.stops.iter().map(met).filter(|met| is_shown(&met.at)).collect(),
            ends: sweep.ends.clone(),
            dead_centres: together(sweep.dead_centres.iter().map(|(sigma, name)| (part(*sigma), name.clone()))),
            equilibria: equilibria.filter(|mark| is_shown(&mark.at)).take(MARKS).collect(),
        })
    }
}

/// Marks in the order of the travel. Marks at one position are joined.
fn together(places: impl Iterator<Item = (f64, String)>) -> Vec<Mark> {
    let mut places: Vec<_> = places.collect();
    places.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mark = |place: &[(f64, String)]| Mark {
        at: place[0].0,
        name: place.iter().map(|(_, name)| name.as_str()).collect::<Vec<_>>().join(", "),
    };
    places.chunk_by(|a, b| b.0 - a.0 < 1e-6).map(mark).take(MARKS).collect()
}

/// Coordinates, then displacements of the drives.
fn positions(sweep: &Sweep, units: &FileUnits) -> Vec<Recorded> {
    let recorded = |name: String, is_angle: bool, values: &[f64]| {
        let unit = if is_angle { Unit::Radian } else { Unit::Metre };
        Recorded::of_position(name, unit, units, values)
    };
    let coordinates = sweep.coordinates.iter().enumerate().map(|(k, (name, values))| {
        let is_angle = k < sweep.angles;
        recorded(format!("{name}.{}", if is_angle { "angle" } else { "position" }), is_angle, values)
    });
    let drives = sweep.drives.iter().map(|(name, is_rotary, values)| recorded(name.clone(), *is_rotary, values));
    coordinates.chain(drives).collect()
}

/// The first drive whose force is an input: its name, and the reference of the input.
fn holder(model: &Model, scene: &Scene) -> Option<(String, Reference)> {
    scene.actuators.iter().find_map(|drive| {
        let inputs = ["force", "torque"].into_iter();
        let mut inputs = inputs.filter_map(|word| model.variables().find(&format!("{}.{word}", drive.name)));
        let is_input = |reference: &Reference| {
            model.variables().get(*reference).is_some_and(|variable| variable.causality == Causality::Input)
        };
        Some((drive.name.clone(), inputs.find(is_input)?))
    })
}

/// Forces at rest, while the first drive holds the mechanism. None for a mechanism with more states than position and
/// speed.
fn at_rest(model: &mut Model, scene: &Scene, sigma: &[f64], units: &FileUnits) -> Vec<Recorded> {
    let of_drives = scene.actuators.iter().flat_map(|drive| {
        OF_DRIVE.iter().flat_map(move |names| names.iter().map(move |name| format!("{}.{name}", drive.name)))
    });
    let of = |names: &mut dyn Iterator<Item = &str>| -> Vec<String> {
        names.flat_map(|name| ["force", "torque"].map(|word| format!("{name}.{word}"))).collect()
    };
    let springs = of(&mut scene.springs.iter().map(|spring| spring.name.as_str()));
    let joints = of(&mut scene.joints.iter().map(|joint| joint.name.as_str()));
    let mut references: Vec<Reference> = Vec::new();
    for name in of_drives.chain(springs).chain(joints) {
        let found = model.variables().find(&name);
        let is_output = |reference: &Reference| {
            model.variables().get(*reference).is_some_and(|variable| variable.causality == Causality::Output)
        };
        references.extend(found.filter(|reference| is_output(reference) && !references.contains(reference)));
    }
    references.truncate(MOST[0]);
    let holder = holder(model, scene).map(|(_, input)| input);
    // A drive with a prescribed motion can hold the mechanism like any other drive.
    let mut free = model.clone();
    for drive in &scene.actuators {
        if let Some(prescribes) = model.variables().find(&format!("{}.motion.enabled", drive.name)) {
            // If the prescribed motion cannot be switched off, there are no forces at rest.
            let _ = free.set_boolean(prescribes, false);
        }
    }
    let Ok(columns) = free.at_rest(sigma, &references, holder) else { return Vec::new() };
    let variables = model.variables();
    // Without friction the breakaway force of a drive is its holding force.
    let is_same = |k: usize| {
        let name = |k: usize| variables.get(references[k]).map_or("", |variable| variable.name.as_str());
        name(k).contains(".breakaway_")
            && (0..k).any(|other| name(other).contains(".holding_") && columns[other] == columns[k])
    };
    let kept = (0..references.len()).filter(|&k| columns[k].iter().any(|value| value.is_finite()) && !is_same(k));
    let recorded = kept.map(|k| (&references[k], &columns[k]));
    recorded.filter_map(|(reference, column)| Some(Recorded::new(variables.get(*reference)?, units, column))).collect()
}

/// Whether a quantity over the travel is plotted at first: forces of drives.
fn is_plotted(name: &str) -> bool {
    OF_DRIVE.iter().take(3).flatten().any(|quantity| name.ends_with(&format!(".{quantity}")))
}

/// Mechanical advantages: the force or torque along a coordinate per unit of drive force. By virtual work this is the
/// displacement of the drive per unit of the coordinate.
fn advantages(sweep: &Sweep, scene: &Scene) -> Vec<Recorded> {
    let is_ground = |on: &On| on.frame == 0;
    let of_ground = |name: &str| {
        let is_body =
            |on: &On| scene.bodies.iter().any(|b| b.name == name && b.points.iter().any(|p| p.on.frame == on.frame));
        let joints = scene.joints.iter();
        let mut joints = joints.filter(|joint| is_ground(&joint.first) || is_ground(&joint.second));
        joints.any(|joint| joint.name == name || is_body(&joint.first) || is_body(&joint.second))
    };
    let coordinates = sweep.coordinates.iter().enumerate().filter(|(_, (name, _))| of_ground(name));
    let pairs = coordinates.flat_map(|(k, (name, _))| {
        let drives = scene.actuators.iter().zip(&sweep.drives).enumerate();
        drives.map(move |(d, (drive, (_, is_rotary, _)))| (k, name, d, &drive.name, *is_rotary))
    });
    let recorded = pairs.filter(|(_, name, _, drive, _)| name != drive).map(|(k, name, d, drive, is_rotary)| {
        let slopes = sweep.slopes[sweep.coordinates.len() + d].iter().zip(&sweep.slopes[k]);
        let values: Vec<f64> = slopes.map(|(drive, coordinate)| drive / coordinate).collect();
        let is_angle = k < sweep.angles;
        let unit = match (is_angle, is_rotary) {
            (true, false) => "N.m/N",
            (false, true) => "N/(N.m)",
            _ => "1",
        };
        let word = |is_angle: bool| if is_angle { "torque" } else { "force" };
        let description = format!(
            "Mechanical advantage: {} along {name} for each unit of {} of {drive}",
            word(is_angle),
            word(is_rotary)
        );
        Recorded::of_ratio(format!("{drive}.advantage_on_{name}"), description, unit, &values)
    });
    recorded.take(MOST[1]).collect()
}
