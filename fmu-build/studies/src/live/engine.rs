//! Runs for the page: from a text and values of variables to the data of the page.
//!
//! In: the text of a definition, values of parameters and inputs. Out: data of the page, places of findings, variables
//! that can be set. The module must not know who sends a request.

use anyhow::Result;
use fmu_build::check::{self, Checked};
use fmu_build::shared;
use fmu_build::view::{Data, Wanted};
use fmu_build::workspace::MECHANISM;
use linkage_fmu::inspection::{Finding, Severity};
use linkage_fmu::simulation::Simulation;
use linkage_fmu::variables::{Causality, Kind, Value, Variable};
use serde::{Deserialize, Serialize};
use std::panic::resume_unwind;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Instant;

/// Number of texts whose models are kept: those of two pages, and of one previous edit.
const KEPT: usize = 3;

/// The models of the newest texts.
pub struct Engine {
    shown: String,
    path: PathBuf,
    wanted: Wanted,
    kept: Mutex<Vec<Model>>,
}

/// A request.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
pub struct Asked {
    /// Text of the definition.
    pub text: String,
    /// Values of parameters and inputs, by name.
    #[serde(default)]
    pub values: Vec<(String, Number)>,
}

/// A value of a variable.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Number {
    /// Of a Boolean.
    Boolean(bool),
    /// Of a Real.
    Real(f64),
}

/// The answer to a request.
#[derive(Debug, Serialize)]
pub struct Outcome {
    /// The data of the page of `view`.
    pub data: Data,
    /// The additional data of the live page.
    pub notes: Notes,
}

/// Additional data about a text.
#[derive(Debug, Serialize)]
pub struct Notes {
    marks: Vec<Mark>,
    knobs: Vec<Knob>,
    /// Messages about values that could not be set.
    problems: Vec<String>,
    /// Time of the computation [ms].
    milliseconds: f64,
}

/// A finding in the text.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct Mark {
    /// Range of the text, in units of UTF-16; empty at 0 for the whole text.
    from: usize,
    to: usize,
    is_error: bool,
    message: String,
}

/// A variable that can be set.
#[derive(Clone, Debug, Serialize)]
struct Knob {
    name: String,
    description: String,
    unit: Option<&'static str>,
    display: Option<(&'static str, f64)>,
    is_input: bool,
    start: Number,
    bounds: [Option<f64>; 2],
}

/// A text with its model.
struct Model {
    /// The text with the contents of the file of shared parameters.
    text: String,
    checked: Checked,
    opened: Result<Simulation, String>,
    /// Values that were set, with the previous values.
    set: Vec<(String, Number)>,
    /// The last request with its answer: a page that opens repeats the request.
    last: Option<(Asked, Arc<Outcome>)>,
}

impl Engine {
    /// An engine for texts of the file at this path. `shown` is its name in messages.
    pub fn new(shown: String, path: PathBuf, wanted: Wanted) -> Self {
        Self { shown, path, wanted, kept: Mutex::new(Vec::new()) }
    }

    /// Name of the file.
    pub fn shown(&self) -> &str {
        &self.shown
    }

    /// Check a text and run it under these values.
    ///
    /// # Errors
    /// There is no such kind of definition.
    pub fn run(&self, asked: &Asked) -> Result<Arc<Outcome>> {
        let began = Instant::now();
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let (text, fault) = match shared::completed(&self.path, asked.text.clone()) {
            Ok(text) => (text, None),
            Err(error) => (asked.text.clone(), Some(format!("{error:#}"))),
        };
        // The model is removed during the run, so that a model that panics is dropped.
        let found = kept.iter().position(|model| model.text == text);
        let mut model = match found {
            Some(index) => kept.remove(index),
            None => self.open(text)?,
        };
        let is_whole = fault.is_none();
        if let Some((_, outcome)) = model.last.clone().filter(|(last, _)| last == asked && is_whole) {
            kept.insert(0, model);
            return Ok(outcome);
        }
        let problems = model.set(&asked.values);
        let mut data = Data::played(&model.checked, &mut model.opened, &self.wanted);
        if let Some(fault) = fault {
            data.error = Some(fault);
        }
        let (marks, knobs) = (model.marks(&asked.text), model.knobs());
        let milliseconds = 1e3 * began.elapsed().as_secs_f64();
        let outcome = Arc::new(Outcome { data, notes: Notes { marks, knobs, problems, milliseconds } });
        model.last = is_whole.then(|| (asked.clone(), Arc::clone(&outcome)));
        kept.insert(0, model);
        kept.truncate(KEPT);
        Ok(outcome)
    }

    fn open(&self, text: String) -> Result<Model> {
        let (opened, checked) = thread::scope(|scope| {
            let opened = scope.spawn(|| Simulation::open(&text).map_err(|error| error.to_string()));
            let checked = check::check(self.shown.clone(), MECHANISM, text.clone());
            (opened.join().unwrap_or_else(|panic| resume_unwind(panic)), checked)
        });
        Ok(Model { text, checked: checked?, opened, set: Vec::new(), last: None })
    }
}

impl Model {
    /// Set these values, and reset values that were set before. Returns messages about values that could not be set.
    fn set(&mut self, values: &[(String, Number)]) -> Vec<String> {
        let Ok(simulation) = &mut self.opened else { return Vec::new() };
        let mut all: Vec<(String, Number)> = std::mem::take(&mut self.set);
        all.retain(|(name, _)| values.iter().all(|(other, _)| other != name));
        all.extend_from_slice(values);
        let mut problems = Vec::new();
        for (name, value) in all {
            let variables = simulation.model().variables();
            // The variable may be missing in the new text.
            let Some(start) = variables.find(&name).and_then(|r| start(&variables.list()[r as usize])) else {
                continue;
            };
            let set = match value {
                Number::Boolean(value) => simulation.set(&name, value),
                Number::Real(value) => simulation.set(&name, value),
            };
            match set {
                Ok(()) if value != start => self.set.push((name, start)),
                Ok(()) => {}
                Err(error) => problems.push(error.to_string()),
            }
        }
        problems
    }

    /// The findings at their places in the sent text.
    fn marks(&self, sent: &str) -> Vec<Mark> {
        let place = |byte: usize| units(sent, own(sent, &self.text, byte));
        let mark = |located: &check::Located| Mark {
            from: place(located.span.start),
            to: place(located.span.end),
            is_error: located.finding.severity == Severity::Error,
            message: words(&located.finding),
        };
        self.checked.findings.iter().map(mark).collect()
    }

    fn knobs(&self) -> Vec<Knob> {
        let Ok(simulation) = &self.opened else { return Vec::new() };
        let knob = |variable: &Variable| {
            Some(Knob {
                name: variable.name.clone(),
                description: variable.description.clone(),
                unit: variable.unit.map(|unit| unit.name()),
                display: variable.unit.and_then(|unit| unit.display()),
                is_input: variable.causality == Causality::Input,
                start: start(variable)?,
                bounds: variable.details.bounds,
            })
        };
        simulation.model().variables().list().iter().filter_map(knob).collect()
    }
}

/// Start value of a parameter or an input that the page can set.
fn start(variable: &Variable) -> Option<Number> {
    if !matches!(variable.causality, Causality::Parameter | Causality::Input) {
        return None;
    }
    match (variable.kind, variable.start.as_ref()?) {
        (Kind::Real, Value::Real(value)) => Some(Number::Real(*value)),
        (Kind::Boolean, Value::Boolean(value)) => Some(Number::Boolean(*value)),
        _ => None,
    }
}

fn words(finding: &Finding) -> String {
    let Finding { message, remedy, .. } = finding;
    if remedy.is_empty() { message.clone() } else { format!("{message}; {remedy}") }
}

/// Index of a byte of `completed` in the text `sent`, from which one part was replaced.
fn own(sent: &str, completed: &str, byte: usize) -> usize {
    let same = |(a, b): &(u8, u8)| a == b;
    let before = sent.bytes().zip(completed.bytes()).take_while(same).count();
    if byte <= before {
        return byte;
    }
    let after = sent.bytes().rev().zip(completed.bytes().rev()).take_while(same).count();
    let (rest, most) = (completed.len().saturating_sub(byte), sent.len());
    if rest <= after { most - rest } else { before.min(most) }
}

/// Number of UTF-16 units before a byte of a text.
fn units(text: &str, byte: usize) -> usize {
    let mut end = byte.min(text.len());
    while !text.is_char_boundary(end) {
        end -= 1;
    }
    text[..end].encode_utf16().count()
}
