//! The motion in time: poses and variables in equally spaced frames.

use super::Wanted;
use crate::check::FileUnits;
use crate::view::series::Series;
use linkage_fmu::mechanism::ModelError;
use linkage_fmu::mechanism::inspection::{Pose, Scene};
use linkage_fmu::simulation::{Simulation, SimulationError};
use linkage_fmu::variables::{Causality, Kind, Reference, Unit, Variable};
use serde::Serialize;
use std::collections::HashSet;

/// Number of frames of a motion in which no body turns far.
const FRAMES: usize = 300;
/// Largest number of frames.
const MOST_FRAMES: usize = 3000;
/// Largest angle between two frames [rad] for which the page's interpolation has an error of at most 1/2000 of a body's
/// length.
const TURN: f64 = 0.35;
/// Largest number of values of variables in a page.
const MOST_VALUES: usize = 600_000;
/// Largest number of variables of one kind that are plotted at first.
const PLOTTED: usize = 4;

/// Word for the causality of an output.
const OUTPUT: &str = "output";
/// Word for a quantity that depends on the position only.
const POSITION: &str = "position";

/// The motion in time.
#[derive(Clone, Debug, Serialize)]
pub struct Motion {
    /// Time between two frames [s].
    step: f64,
    /// Number of frames.
    count: usize,
    /// Requested stop time [s].
    stop_time: f64,
    /// Angle, x and y of each body of the linkage.
    poses: Vec<[Series; 3]>,
    /// Variables.
    variables: Vec<Recorded>,
    /// Number of variables without room.
    left_out: usize,
    /// Names of the variables that are plotted at first.
    plotted: Vec<String>,
}

/// A variable with its values.
#[derive(Clone, Debug, Serialize)]
pub struct Recorded {
    /// Name.
    pub name: String,
    description: String,
    /// Unit. None for a Boolean.
    unit: Option<&'static str>,
    /// Display unit and its factor.
    display: Option<(&'static str, f64)>,
    causality: &'static str,
    is_boolean: bool,
    values: Series,
}

/// Poses and values by frames.
#[derive(Default)]
struct Frames {
    poses: Vec<Vec<Pose>>,
    columns: Vec<Vec<f64>>,
    /// Largest angle by which a body turns between two frames [rad].
    turn: f64,
}

impl Motion {
    /// Run the simulation from its start. The second value is the reason for an early end, if there is one.
    ///
    /// # Errors
    /// There is no start, or a variable has no value.
    pub fn new(
        simulation: &mut Simulation,
        scene: &Scene,
        wanted: &Wanted,
        units: &FileUnits,
    ) -> Result<(Self, Option<String>), SimulationError> {
        // A mechanism without loads and motion is shown at its start, and along its travel.
        let stop_time = match simulation.model().can_move() {
            true => wanted.stop_time.unwrap_or(simulation.model().experiment().stop_time),
            false => 0.0,
        };
        // A run of length 0 is its start.
        let mut count = if stop_time > 0.0 { FRAMES } else { 0 };
        let all = candidates(simulation, scene);
        let mut room = MOST_VALUES / (count + 1);
        let (mut frames, mut error) = record(simulation, stop_time, count, &all[..all.len().min(room)], TURN)?;
        if frames.turn > TURN {
            count = ((count as f64 * frames.turn / TURN).ceil()).min(MOST_FRAMES as f64) as usize;
            room = MOST_VALUES / (count + 1);
            let recorded = &all[..all.len().min(room)];
            (frames, error) = record(simulation, stop_time, count, recorded, f64::INFINITY)?;
        }
        let variables = simulation.model().variables();
        let recorded = all.iter().zip(&frames.columns).filter_map(|(&reference, column)| {
            let variable = variables.get(reference)?;
            Some((reference, Recorded::new(variable, units, column)))
        });
        let mut recorded: Vec<_> = recorded.collect();
        recorded.sort_by_key(|(reference, _)| *reference);
        let bodies = frames.poses.first().map_or(0, Vec::len);
        let pose = |body: usize| {
            [0, 1, 2].map(|i| Series::new(&frames.poses.iter().map(|poses| poses[body][i]).collect::<Vec<_>>()))
        };
        let motion = Self {
            step: if count > 0 { stop_time / count as f64 } else { 1.0 },
            count: frames.poses.len(),
            stop_time,
            poses: (0..bodies).map(pose).collect(),
            plotted: plotted(&recorded, scene),
            left_out: all.len().saturating_sub(room),
            variables: recorded.into_iter().map(|(_, recorded)| recorded).collect(),
        };
        Ok((motion, error))
    }

    /// Number of frames.
    pub fn frames(&self) -> usize {
        self.count
    }

    /// Time of the last frame [s].
    pub fn stop_time(&self) -> f64 {
        let reached = self.step * self.count.saturating_sub(1) as f64;
        // The last frame is at the stop time, except for rounding.
        if (reached - self.stop_time).abs() < 0.5 * self.step { self.stop_time } else { reached }
    }
}

/// The unit in which a quantity is shown, and its factor: the unit of the file, or a display unit.
pub fn display(unit: Unit, units: &FileUnits) -> Option<(&'static str, f64)> {
    unit.display().or_else(|| units.of(unit.name()))
}

impl Recorded {
    /// A variable with its values.
    pub fn new(variable: &Variable, units: &FileUnits, column: &[f64]) -> Self {
        Self {
            name: variable.name.clone(),
            description: variable.description.clone(),
            unit: variable.unit.map(|unit| unit.name()),
            display: variable.unit.and_then(|unit| display(unit, units)),
            causality: match variable.causality {
                Causality::Parameter => "parameter",
                Causality::CalculatedParameter => "calculated parameter",
                Causality::Input => "input",
                Causality::Output => OUTPUT,
                Causality::Local => "local",
            },
            is_boolean: variable.kind == Kind::Boolean,
            values: Series::new(column),
        }
    }

    /// A quantity that depends on the position only.
    pub fn of_position(name: String, unit: Unit, units: &FileUnits, column: &[f64]) -> Self {
        let shown = display(unit, units);
        Self { display: shown, causality: POSITION, ..Self::of_ratio(name, String::new(), unit.name(), column) }
    }

    /// A ratio of two quantities.
    pub fn of_ratio(name: String, description: String, unit: &'static str, column: &[f64]) -> Self {
        let values = Series::new(column);
        Self { name, description, unit: Some(unit), display: None, causality: OUTPUT, is_boolean: false, values }
    }
}

/// Run from the start in equal steps. Returns the frames, and the reason for an early end. When a body turns by more
/// than `turn` between two frames, only poses are recorded from then on, because these frames are too far apart to be
/// shown.
fn record(
    simulation: &mut Simulation,
    stop_time: f64,
    count: usize,
    references: &[Reference],
    turn: f64,
) -> Result<(Frames, Option<String>), SimulationError> {
    simulation.initialize()?;
    let mut frames = Frames { columns: vec![Vec::with_capacity(count + 1); references.len()], ..Frames::default() };
    frames.add(simulation, references)?;
    for _ in 0..count {
        if let Err(error) = simulation.step(stop_time / count as f64) {
            let why = format!("at {} s the motion stopped with an error: {error}", simulation.time());
            return Ok((frames, Some(why)));
        }
        let is_far = frames.turn > turn;
        frames.add(simulation, if is_far { &[] } else { references })?;
    }
    Ok((frames, None))
}

impl Frames {
    fn add(&mut self, simulation: &mut Simulation, references: &[Reference]) -> Result<(), ModelError> {
        self.poses.extend(simulation.model().poses());
        if let [.., before, now] = &self.poses[..] {
            self.turn = before.iter().zip(now).fold(self.turn, |most, (a, b)| most.max((a[0] - b[0]).abs()));
        }
        let model = simulation.model_mut();
        for (column, &reference) in self.columns.iter_mut().zip(references) {
            let is_boolean = model.variables().get(reference).is_some_and(|v| v.kind == Kind::Boolean);
            column.push(match is_boolean {
                true => f64::from(u8::from(model.boolean(reference)?)),
                false => model.real(reference)?,
            });
        }
        Ok(())
    }
}

/// Variables in the order in which they get room: those of the drawing, outputs, inputs, parameters.
fn candidates(simulation: &Simulation, scene: &Scene) -> Vec<Reference> {
    let drawn = drawn(scene);
    let list = simulation.model().variables().list();
    let mut all: Vec<(u8, Reference)> = list.iter().zip(0..).filter_map(|(v, r)| Some((rank(v, &drawn)?, r))).collect();
    all.sort();
    all.into_iter().map(|(_, reference)| reference).collect()
}

fn rank(variable: &Variable, drawn: &HashSet<String>) -> Option<u8> {
    if !matches!(variable.kind, Kind::Real | Kind::Boolean) {
        return None;
    }
    Some(match variable.causality {
        _ if drawn.contains(&variable.name) => 0,
        Causality::Output => 1,
        Causality::Input => 2,
        Causality::Parameter | Causality::CalculatedParameter => 3,
        // The poses contain the same information.
        Causality::Local => return None,
    })
}

/// Names of the variables in the drawing.
fn drawn(scene: &Scene) -> HashSet<String> {
    let mut names = HashSet::from(["load_factor".to_owned()]);
    let mut add = |owner: &str, quantities: &[&str]| {
        names.extend(quantities.iter().map(|quantity| format!("{owner}.{quantity}")));
    };
    scene
        .joints
        .iter()
        .for_each(|joint| add(&joint.name, &["force_x", "force_y", "force", "torque", "friction_torque"]));
    let connections = scene.actuators.iter().chain(&scene.springs);
    connections.for_each(|c| add(&c.name, &["force", "torque"]));
    scene.forces.iter().for_each(|force| add(&force.name, &["force_x", "force_y"]));
    scene.torques.iter().for_each(|torque| add(&torque.name, &["torque"]));
    scene.markers.iter().for_each(|marker| add(&marker.name, &["x", "y"]));
    scene.surfaces.iter().for_each(|surface| add(&surface.name, &["drag"]));
    scene.locks.iter().for_each(|lock| add(&lock.point.name, &["engage", "force"]));
    for stop in &scene.stops {
        add(&stop.name, &["force", "torque"]);
    }
    names.extend(scene.stops.iter().map(|stop| stop.flag.clone()));
    names
}

/// Names of the variables that are plotted at first: a few angles, reactions and drive forces.
fn plotted(recorded: &[(Reference, Recorded)], scene: &Scene) -> Vec<String> {
    let outputs = recorded.iter().filter(|(_, recorded)| recorded.causality == OUTPUT);
    let names: HashSet<&str> = outputs.map(|(_, recorded)| recorded.name.as_str()).collect();
    let named = |owners: &mut dyn Iterator<Item = &str>, quantities: &[&str]| -> Vec<String> {
        let all = owners.flat_map(|owner| quantities.iter().map(move |quantity| format!("{owner}.{quantity}")));
        all.filter(|name| names.contains(name.as_str())).take(PLOTTED).collect()
    };
    let bodies = named(&mut scene.bodies.iter().map(|body| body.name.as_str()), &["angle"]);
    let joints = named(&mut scene.joints.iter().map(|joint| joint.name.as_str()), &["force"]);
    let drives = named(&mut scene.actuators.iter().map(|drive| drive.name.as_str()), &["length", "position"]);
    let slides = named(&mut scene.joints.iter().map(|joint| joint.name.as_str()), &["position"]);
    let lengths: Vec<String> = drives.into_iter().chain(slides).take(PLOTTED).collect();
    let is_recorded = |name: &String| recorded.iter().any(|(_, recorded)| recorded.name == *name);
    let forces = |names: &mut dyn Iterator<Item = &str>| -> Vec<String> {
        let all =
            names.flat_map(|name| ["acting_force", "force", "acting_torque", "torque"].map(|q| format!("{name}.{q}")));
        all.filter(is_recorded).take(PLOTTED).collect()
    };
    let forces_of_drives = forces(&mut scene.actuators.iter().map(|drive| drive.name.as_str()));
    let forces_of_stops = forces(&mut scene.stops.iter().map(|stop| stop.name.as_str()));
    [bodies, lengths, forces_of_drives, forces_of_stops, joints].concat()
}
