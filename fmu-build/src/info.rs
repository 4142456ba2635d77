//! `cargo fmu info`: the interface of a model.
//!
//! In: an FMU of any program, or a definition. Out: the content of its `modelDescription.xml` (for a definition, the
//! one that packing would write), as text or as JSON.

use crate::archive::MODEL_DESCRIPTION;
use crate::binary;
use crate::check;
use crate::fmu::{self, Definition, Fmu};
use crate::needs::Needs;
use crate::workspace::Workspace;
use crate::xml::description::{Described, Description};
use crate::xml::fmi2;
use anyhow::{Context, Result};
pub use fmu_cli::Info as Arguments;
use fmu_cli::Naming;
use linkage_fmu::component::Component;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

/// Causalities in the order in which variables are listed, with the headings.
const CAUSALITIES: [(&str, &str); 5] = [
    ("input", "Inputs"),
    ("output", "Outputs"),
    ("parameter", "Parameters"),
    ("local", "Local variables"),
    ("", "Other variables"),
];

/// The printed data.
#[derive(Serialize)]
struct Info {
    file: String,
    /// Definition file of the kind of model. None in an FMU of another program.
    definition: Option<String>,
    /// Platforms of the libraries in an FMU.
    platforms: Vec<String>,
    /// Requirements of the libraries on the machine that loads them.
    needs: BTreeMap<String, Needs>,
    #[serde(flatten)]
    description: Description,
}

/// Print the interface of the model.
///
/// # Errors
/// The path contains no model, or its description cannot be read.
pub fn run(workspace: &Workspace, arguments: &Arguments) -> Result<()> {
    let info = info(workspace, &arguments.path)?;
    match arguments.json {
        true => println!("{}", serde_json::to_string_pretty(&info)?),
        false => print!("{}", words(&info)),
    }
    Ok(())
}

/// The interface of the model, as text and as JSON.
///
/// # Errors
/// As for [`run`].
pub fn of(workspace: &Workspace, path: &Path) -> Result<(String, String)> {
    let info = info(workspace, path)?;
    Ok((words(&info), serde_json::to_string(&info)?))
}

fn info(workspace: &Workspace, path: &Path) -> Result<Info> {
    Ok(if fmu::is_fmu(path) {
        of_fmu(Fmu::open(path)?)?
    } else {
        let definition = Definition::read(workspace, path)?;
        let component = check::model(workspace, &definition)?;
        let Definition { shown, kind, .. } = definition;
        let description =
            Description::parse(&fmi2::to_xml(&component, Naming::default()).with_context(|| shown.clone())?)?;
        Info {
            file: shown,
            definition: Some(kind.to_owned()),
            platforms: Vec::new(),
            needs: BTreeMap::new(),
            description,
        }
    })
}

fn of_fmu(mut fmu: Fmu) -> Result<Info> {
    let description = description(&mut fmu)?;
    let definition =
        Component::definition_files().into_iter().find(|file| fmu.names().iter().any(|n| n.ends_with(file)));
    let (file, definition) = (fmu.shown().to_owned(), definition.map(str::to_owned));
    let platforms = platforms(&fmu);
    let mut needs = BTreeMap::new();
    for platform in &platforms {
        if let Some(found) = library_needs(&mut fmu, platform, &description) {
            needs.insert(platform.clone(), found);
        }
    }
    Ok(Info { file, definition, platforms, needs, description })
}

/// Requirements of the library for a platform. None without requirements, or if the file is no library, which
/// `validate` reports.
fn library_needs(fmu: &mut Fmu, platform: &str, description: &Description) -> Option<Needs> {
    let path = binary::path(platform, description.interfaces.values().next()?)?;
    let needs = Needs::of(&fmu.read(&path).ok()??).ok()?;
    (needs != Needs::default()).then_some(needs)
}

/// The description in an FMU.
///
/// # Errors
/// The FMU has no description, or it cannot be read.
pub fn description(fmu: &mut Fmu) -> Result<Description> {
    let shown = fmu.shown().to_owned();
    let text =
        fmu.text(MODEL_DESCRIPTION)?.with_context(|| format!("{shown}: the FMU contains no {MODEL_DESCRIPTION}"))?;
    Description::parse(&text).with_context(|| format!("{shown}/{MODEL_DESCRIPTION}"))
}

/// Names of the folders of libraries in an FMU.
pub fn platforms(fmu: &Fmu) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for name in fmu.names() {
        if let Some((platform, _)) = name.strip_prefix("binaries/").and_then(|rest| rest.split_once('/'))
            && !found.iter().any(|other| other == platform)
        {
            found.push(platform.to_owned());
        }
    }
    found.sort();
    found
}

fn words(info: &Info) -> String {
    let Info { description, .. } = info;
    let mut out = String::new();
    let mut line = |name: &str, text: String| {
        if !text.is_empty() {
            let _ = writeln!(out, "{name:<13}{text}");
        }
    };
    line("file", info.file.clone());
    line("name", description.name.clone());
    line("description", description.description.clone());
    line("definition", info.definition.clone().unwrap_or_default());
    line("FMI", description.fmi_version.clone());
    line("interfaces", description.interfaces.keys().cloned().collect::<Vec<_>>().join(", "));
    line("GUID", description.guid.clone());
    line("written by", description.generation_tool.clone());
    let platforms = info.platforms.iter().map(|platform| match info.needs.get(platform) {
        Some(needs) => format!("{platform} ({})", needs.words()),
        None => platform.clone(),
    });
    line("platforms", platforms.collect::<Vec<_>>().join(", "));
    line("experiment", experiment(description));
    let of = |causality: &str| -> Vec<&Described> {
        let is_known = |variable: &Described| CAUSALITIES.iter().any(|(known, _)| *known == variable.causality);
        description
            .variables
            .iter()
            .filter(|v| v.causality == causality || causality.is_empty() && !is_known(v))
            .collect()
    };
    let counts = CAUSALITIES.map(|(causality, heading)| (of(causality).len(), heading.to_lowercase()));
    let counts: Vec<String> =
        counts.iter().filter(|(count, _)| *count > 0).map(|(count, heading)| format!("{count} {heading}")).collect();
    line("variables", format!("{}: {}", description.variables.len(), counts.join(", ")));
    for (causality, heading) in CAUSALITIES {
        let listed = of(causality);
        if !listed.is_empty() {
            let _ = write!(out, "\n{heading}\n{}", table(&listed));
        }
    }
    out
}

fn experiment(description: &Description) -> String {
    let experiment = &description.experiment;
    let parts = [
        ("from", experiment.start_time, " s"),
        ("to", experiment.stop_time, " s"),
        ("with steps of", experiment.step_size, " s"),
        ("tolerance", experiment.tolerance, ""),
    ];
    let shown = parts.iter().filter_map(|(word, value, unit)| value.map(|value| format!("{word} {value:?}{unit}")));
    shown.collect::<Vec<_>>().join(" ")
}

/// A line for each variable: name, start value, unit, description.
fn table(variables: &[&Described]) -> String {
    let cells = variables.iter().map(|variable| {
        let unit = if variable.unit.is_empty() { variable.kind.clone() } else { variable.unit.clone() };
        [variable.name.clone(), variable.start.clone().unwrap_or_default(), unit]
    });
    let cells: Vec<[String; 3]> = cells.collect();
    let [name, start, unit] = [0, 1, 2].map(|i| cells.iter().map(|row| row[i].chars().count()).max().unwrap_or(0));
    let lines = cells.iter().zip(variables).map(|([a, b, c], variable)| {
        let line = format!("  {a:<name$}  {b:>start$}  {c:<unit$}  {}", variable.description);
        format!("{}\n", line.trim_end())
    });
    lines.collect()
}
