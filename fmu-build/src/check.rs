//! `cargo fmu check`: what a definition gives, and all that is wrong with it.
//!
//! In: a definition file, a folder that holds one, or an FMU. Out: findings with their places in the text, facts about
//! the model; as text or as JSON.

mod faults;
mod print;
mod spans;

use crate::files;
use crate::source::Source;
use crate::workspace::Workspace;
use anyhow::{Context, Result, bail};
use clap::Args;
pub use faults::Located;
use linkage_fmu::component::Component;
use linkage_fmu::fmi::LARGEST_DEFINITION;
use linkage_fmu::inspection::{Inspection, Severity};
pub use print::{findings, json, listed, summary};
use std::io::{Cursor, Read};
use std::path::{Path, PathBuf};
use zip::ZipArchive;

/// Largest FMU that is read [bytes].
const LARGEST_FMU: u64 = 1 << 30;

/// What the command line says.
#[derive(Args)]
pub struct Arguments {
    /// A definition file (mechanism.json), a folder that holds one, or an FMU
    #[arg(value_name = "PATH", required = true)]
    pub paths: Vec<PathBuf>,
    /// Print findings and facts as JSON, a list with one object for each path
    #[arg(long)]
    pub json: bool,
    /// End with the exit code 1 on warnings too
    #[arg(long)]
    pub deny_warnings: bool,
}

/// A definition that was checked.
pub struct Checked {
    /// Where the definition is, as messages name it.
    pub shown: String,
    /// Its text.
    pub text: String,
    /// Findings of the inspection, with their places.
    pub findings: Vec<Located>,
    /// Whether names and numbers were checked too, which takes a text that can be read.
    pub is_whole: bool,
    /// Facts; the findings of the inspection are those above.
    pub inspection: Inspection,
}

impl Checked {
    /// Number of findings of this weight.
    pub fn count(&self, severity: Severity) -> usize {
        self.findings.iter().filter(|located| located.finding.severity == severity).count()
    }
}

/// Check the definitions and print what was found; whether all passed.
///
/// # Errors
/// A path that leads to no definition.
pub fn run(workspace: &Workspace, arguments: &Arguments) -> Result<bool> {
    let mut all = Vec::new();
    for path in &arguments.paths {
        let (shown, kind, text) = read(workspace, path)?;
        all.push(check(shown, kind, text)?);
    }
    match arguments.json {
        true => println!("{}", serde_json::to_string_pretty(&print::json(&all))?),
        false => all.iter().for_each(|checked| print!("{}", print::text(checked))),
    }
    let fails = |checked: &Checked| {
        checked.count(Severity::Error) > 0 || arguments.deny_warnings && checked.count(Severity::Warning) > 0
    };
    Ok(!all.iter().any(fails))
}

/// Check the text of a definition of this kind, which messages name so.
///
/// # Errors
/// There is no such kind.
pub fn check(shown: String, kind: &str, text: String) -> Result<Checked> {
    let faults::All { inspection, located, is_whole } = faults::all(kind, &text)?;
    Ok(Checked { shown, text, findings: located, is_whole, inspection })
}

/// Name, kind and text of the definition to which a path leads.
fn read(workspace: &Workspace, path: &Path) -> Result<(String, &'static str, String)> {
    let is_fmu = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("fmu"));
    if !(is_fmu && path.is_file()) {
        let source = Source::find(workspace, path)?;
        return Ok((source.definition.display().to_string(), source.kind(), source.text()?));
    }
    let shown = path.display();
    let bytes = files::read(path, LARGEST_FMU)?;
    let mut archive = ZipArchive::new(Cursor::new(bytes)).with_context(|| format!("{shown}: is no FMU"))?;
    for kind in Component::definition_files() {
        let name = format!("resources/{kind}");
        let Ok(entry) = archive.by_name(&name) else { continue };
        let mut bytes = Vec::new();
        entry.take(LARGEST_DEFINITION + 1).read_to_end(&mut bytes).with_context(|| format!("{shown}: {name}"))?;
        if bytes.len() as u64 > LARGEST_DEFINITION {
            bail!("{shown}: {name} has more than {LARGEST_DEFINITION} bytes; is it the right file?");
        }
        let text = String::from_utf8(bytes).ok().with_context(|| format!("{shown}: {name} is not UTF-8 text"))?;
        return Ok((format!("{shown}/{name}"), kind, text));
    }
    bail!("{shown}: holds no resources/{}; is it an FMU of this program?", Component::definition_files().join(" or "))
}
