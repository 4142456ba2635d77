//! The data of the page from the engine: the scene, the motion in time, the travel without time.
//!
//! In: a checked definition, start values. Out: data for the page. The module must not know how anything is drawn.

mod motion;
mod still;
mod sweep;
mod wanted;

use crate::check::{Checked, FileUnits};
use anyhow::Result;
use linkage_fmu::inspection::Severity;
use linkage_fmu::mechanism::definition::Mechanism;
use linkage_fmu::mechanism::inspection::Scene;
use linkage_fmu::simulation::Simulation;
pub use motion::Motion;
use serde::Serialize;
use std::panic::resume_unwind;
use std::thread;
pub use still::Still;
pub use sweep::Travel;
pub use wanted::Wanted;

/// Result of the computation for a definition.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// The whole requested motion.
    Whole,
    /// The motion up to a step that failed.
    Part,
    /// Poses without a motion: at the guess, or assembled.
    Still,
    /// Nothing can be drawn.
    Nothing,
}

/// A finding, for the page.
#[derive(Clone, Debug, Serialize)]
pub struct PageFinding {
    is_error: bool,
    path: String,
    line: usize,
    message: String,
    remedy: String,
}

/// All data of the page.
#[derive(Clone, Debug, Serialize)]
pub struct Data {
    /// Name of the model. Empty if the definition could not be read.
    pub name: String,
    /// One line of text.
    pub description: String,
    /// Path of the definition in messages.
    pub source: String,
    /// How much of the motion could be computed.
    pub status: Status,
    /// Reason for an incomplete motion.
    pub error: Option<String>,
    /// Findings of the check.
    pub findings: Vec<PageFinding>,
    /// The parts to draw.
    pub scene: Option<Scene>,
    /// The motion in time.
    pub motion: Option<Motion>,
    /// The travel without time.
    pub travel: Option<Travel>,
    /// Poses of a definition without a motion.
    pub still: Option<Still>,
    /// Unit of lengths in the file, and its factor.
    pub length: (&'static str, f64),
    /// Differences of this run in a comparison of two runs.
    pub label: String,
    /// The run with which this run is compared.
    pub compare: Option<Box<Self>>,
}

impl Data {
    /// Compute the requested data as far as possible.
    ///
    /// # Errors
    /// A start value is invalid, or the stop time is no time.
    pub fn collect(checked: &Checked, wanted: &Wanted) -> Result<Self> {
        // A program that packs the mechanism has a model of it, whose tables are used here too.
        let mut opened = Simulation::sharing(&checked.text).map_err(|error| error.to_string());
        if let Ok(simulation) = &mut opened {
            wanted.set(simulation)?;
        }
        Ok(Self::played(checked, &mut opened, wanted))
    }

    /// The same data from a simulation with its start values, or from the reason why there is none.
    pub fn played(checked: &Checked, opened: &mut Result<Simulation, String>, wanted: &Wanted) -> Self {
        let findings = checked.findings.iter().map(|located| PageFinding {
            is_error: located.finding.severity == Severity::Error,
            path: located.finding.path.clone(),
            line: if located.span.is_empty() { 0 } else { located.position[0] },
            message: located.finding.message.clone(),
            remedy: located.finding.remedy.clone(),
        });
        let mut data = Self {
            name: checked.name().unwrap_or_default().into(),
            description: Mechanism::with_faults(&checked.text).map_or_else(|_| String::new(), |(m, _)| m.description),
            source: checked.shown.clone(),
            status: Status::Nothing,
            error: None,
            findings: findings.collect(),
            scene: None,
            motion: None,
            travel: None,
            still: None,
            length: checked.units.of("m").unwrap_or(("m", 1.0)),
            label: String::new(),
            compare: None,
        };
        let refused = match opened {
            Ok(simulation) => match data.play(simulation, wanted, &checked.units) {
                Ok(error) => {
                    data.error = error.map(|error| checked.units.message(&error));
                    return data;
                }
                Err(refused) => refused,
            },
            Err(error) => error.clone(),
        };
        data.error = Some(checked.units.message(&refused));
        data.stand(&checked.text);
        data
    }

    /// Compute motion and travel. Returns the reason why the motion ends early or there is no start.
    fn play(
        &mut self,
        simulation: &mut Simulation,
        wanted: &Wanted,
        units: &FileUnits,
    ) -> Result<Option<String>, String> {
        let words = |error: &dyn std::fmt::Display| error.to_string();
        simulation.initialize().map_err(|error| words(&error))?;
        let model = simulation.model_mut();
        let scene = model.scene().map_err(|error| words(&error))?;
        let mut still = model.clone();
        let (travel, motion) = thread::scope(|scope| {
            let travel = scope.spawn(|| Travel::new(&mut still, &scene, units));
            let motion = Motion::new(simulation, &scene, wanted, units);
            (travel.join().unwrap_or_else(|panic| resume_unwind(panic)), motion)
        });
        let travel = travel.map_err(|error| words(&error))?;
        let (motion, error) = motion.map_err(|error| words(&error))?;
        self.status = if error.is_none() { Status::Whole } else { Status::Part };
        (self.scene, self.travel, self.motion) = (Some(scene), Some(travel), Some(motion));
        Ok(error)
    }

    /// Poses of a definition without a motion.
    fn stand(&mut self, text: &str) {
        if let Some((scene, still)) = Still::new(text) {
            (self.status, self.scene, self.still) = (Status::Still, Some(scene), Some(still));
        }
    }

    /// Compare with another run with these changed start values.
    pub fn compare_with(&mut self, mut other: Self, changed: &[String]) {
        let [one, two] = match (self.source == other.source, self.name == other.name) {
            (true, _) => ["as defined".to_owned(), String::new()],
            (false, false) => [self.name.clone(), other.name.clone()],
            (false, true) => [self.source.clone(), other.source.clone()],
        };
        let changed = changed.join(" ");
        self.label = one;
        other.label = [two, changed].into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(", ");
        self.compare = Some(Box::new(other));
    }

    /// Title of the page.
    pub fn title(&self) -> &str {
        if self.name.is_empty() { "Mechanism" } else { &self.name }
    }

    /// File name of the page.
    pub fn file_name(&self) -> &str {
        let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
        if self.title().chars().all(is_name) { self.title() } else { "Mechanism" }
    }

    /// Contents of the page in a few words.
    pub fn summary(&self) -> String {
        match (&self.motion, &self.still) {
            (Some(motion), _) => format!("{} frames over {} s", motion.frames(), motion.stop_time()),
            (None, Some(still)) if !still.is_assembled() => {
                "the mechanism with open loops, in the position in the key guess".into()
            }
            (None, Some(_)) => "the assembled mechanism without motion".into(),
            (None, None) => "the error message only".into(),
        }
    }
}
