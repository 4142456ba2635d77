//! `cargo fmu check`: facts about a definition, and all its faults.
//!
//! In: a definition file, a folder that contains one, or an FMU. Out: findings with their places in the text, and facts
//! about the model, as text or as JSON.

mod faults;
mod located;
mod print;
mod spans;
mod syntax;
mod units;

use crate::fmu::Definition;
use crate::workspace::Workspace;
use anyhow::{Context, Result, anyhow};
pub use fmu_cli::Check as Arguments;
use linkage_fmu::component::{Component, Refused};
use linkage_fmu::format::{Place, parse};
use linkage_fmu::inspection::{Finding, Inspection, Severity};
pub use located::Located;
use std::path::{Path, PathBuf};

pub use print::{findings, json, line, listed, summary, text};
pub use units::FileUnits;

/// A checked definition.
pub struct Checked {
    /// Path of the definition in messages.
    pub shown: String,
    /// Its text.
    pub text: String,
    /// Findings of the inspection, with their places.
    pub findings: Vec<Located>,
    /// Whether names and numbers were checked too, which is possible only if the text can be read.
    pub is_whole: bool,
    /// Units of the file.
    pub units: FileUnits,
    /// Facts. The field `findings` contains the findings.
    pub inspection: Inspection,
}

impl Checked {
    /// Number of findings of this severity.
    pub fn count(&self, severity: Severity) -> usize {
        self.findings.iter().filter(|located| located.finding.severity == severity).count()
    }
}

/// Check the definitions and print the results. Returns whether all passed. A path without a definition has one
/// finding, and the other paths are checked.
///
/// # Errors
/// The findings cannot be written as JSON.
pub fn run(workspace: &Workspace, arguments: &Arguments) -> Result<bool> {
    let checked = |path: &PathBuf| {
        let Definition { shown, kind, text } = Definition::read(workspace, path)?;
        check(shown, kind, text)
    };
    let checked = |path| checked(path).unwrap_or_else(|error| unread(path, &error));
    let all: Vec<Checked> = arguments.paths.iter().map(checked).collect();
    match arguments.json {
        true => println!("{}", serde_json::to_string_pretty(&print::json(&all))?),
        false => all.iter().for_each(|checked| print!("{}", print::text(checked))),
    }
    let fails = |checked: &Checked| {
        checked.count(Severity::Error) > 0 || arguments.deny_warnings && checked.count(Severity::Warning) > 0
    };
    Ok(!all.iter().any(fails))
}

/// The model of a definition.
///
/// # Errors
/// The definition gives no model: the first fault, in the units of the file.
pub fn model(workspace: &Workspace, definition: &Definition) -> Result<Component> {
    let Definition { shown, kind, text } = definition;
    let in_units = |refused: Refused| {
        // A warning may state the cause, such as a number in another unit.
        let checked = check(shown.clone(), kind, text.clone()).into_iter().flat_map(|checked| checked.findings);
        for Located { finding, .. } in checked.filter(|located| located.finding.severity == Severity::Warning) {
            eprintln!("warning: {finding}");
        }
        let units = FileUnits::stated(parse("definition", text).ok().as_ref());
        anyhow!("{}", units.converted(Finding::error(&refused.0, &refused.0)).message)
    };
    let model = Component::from_definition(kind, text).map_err(in_units);
    model.with_context(|| format!("{shown}; `{} check` prints the details", workspace.program()))
}

/// Place of a key in the text of a JSON file, or of the longest existing part of its path. None if the text is no JSON.
pub fn place_of(text: &str, path: &str) -> Option<Place> {
    let place = spans::find(text, &parse("file", text).ok()?, path);
    Some(Place::new(text, place.shown))
}

/// A path without a definition, with the reason.
fn unread(path: &Path, error: &anyhow::Error) -> Checked {
    let finding = Finding::error("", format!("{error:#}"));
    let findings = vec![Located { finding, span: 0..0, position: [1, 1] }];
    let shown = path.display().to_string();
    let (units, inspection) = (FileUnits::default(), Inspection::default());
    Checked { shown, text: String::new(), findings, is_whole: true, units, inspection }
}

/// Check the text of a definition of this kind. `shown` is its path in messages.
///
/// # Errors
/// There is no such kind.
pub fn check(shown: String, kind: &str, text: String) -> Result<Checked> {
    let faults::All { inspection, located, is_whole, units } = faults::all(kind, &text)?;
    Ok(Checked { shown, text, findings: located, is_whole, units, inspection })
}
