//! `cargo fmu validate`: whether a host can use a model as it is.
//!
//! In: an FMU, or a definition. Out: errors and warnings, one per line. For a definition they are those of `check`. For
//! an FMU they also concern the archive, the rules of FMI for its description, the agreement of description and
//! definition, and the libraries.

mod rules;

use crate::archive::{BINARIES, MODEL_DESCRIPTION};
use crate::binary::{ARM_LINUX, COMPATIBLE};
use crate::check;
use crate::fmu::{self, Definition, Fmu};
use crate::needs::Needs;
use crate::version::Version;
use crate::workspace::Workspace;
use crate::xml::description::{Described, Description};
use crate::{binary, info, names, static_library};
use anyhow::{Context, Result};
use fmu_cli::Naming;
pub use fmu_cli::Validate as Arguments;
use linkage_fmu::component::Component;
use linkage_fmu::inspection::Severity;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

/// Interface type of the FMUs that this program packs.
const INTERFACE: &str = "CoSimulation";
/// Prefix of the name of the program in descriptions that this program wrote.
const PROGRAM: &str = "linkage-fmu";
/// Folder of an FMU with sources from which a host can build a library.
const SOURCES: &str = "sources/";

/// Results of the validation.
#[derive(Default, Serialize)]
pub struct Found {
    /// Reasons why a host cannot use the model.
    pub errors: Vec<String>,
    /// Probable mistakes.
    pub warnings: Vec<String>,
    /// Requirements on the machine of a host.
    pub notes: Vec<String>,
}

impl Found {
    /// Record a failure as an error.
    fn take<T>(&mut self, result: Result<T>) -> Option<T> {
        result.map_err(|error| self.errors.push(format!("{error:#}"))).ok()
    }
}

/// Validate the models and print the results. Returns whether all are without errors.
///
/// # Errors
/// A path contains no model.
pub fn run(workspace: &Workspace, arguments: &Arguments) -> Result<bool> {
    let mut is_valid = true;
    for path in &arguments.paths {
        let Found { errors, warnings, notes } = validate(workspace, path)?;
        errors.iter().for_each(|error| println!("error: {error}"));
        warnings.iter().for_each(|warning| println!("warning: {warning}"));
        notes.iter().for_each(|note| println!("note: {note}"));
        let counted = |count: usize, word: &str| format!("{count} {word}{}", if count == 1 { "" } else { "s" });
        let verdict = if errors.is_empty() { "valid" } else { "not valid" };
        let counts = [counted(errors.len(), "error"), counted(warnings.len(), "warning")].join(", ");
        println!("{}: {verdict}: {counts}", path.display());
        is_valid &= errors.is_empty();
    }
    Ok(is_valid)
}

/// Validate one model.
///
/// # Errors
/// The path contains no model.
pub fn validate(workspace: &Workspace, path: &Path) -> Result<Found> {
    let mut found = Found::default();
    if !fmu::is_fmu(path) {
        definition(Definition::read(workspace, path)?, Version::Two, &mut found)?;
        return Ok(found);
    }
    let Some(mut fmu) = found.take(Fmu::open(path)) else { return Ok(found) };
    archive(&mut fmu, &mut found);
    let described = found.take(info::description(&mut fmu));
    let version = Version::of(described.as_ref().map_or("", |described| &described.fmi_version));
    if let Ok(Some(xml)) = fmu.read(MODEL_DESCRIPTION) {
        let broken = rules::broken(&String::from_utf8_lossy(&xml));
        found.errors.extend(broken.into_iter().map(|rule| format!("{}/{MODEL_DESCRIPTION}: {rule}", fmu.shown())));
    }
    if let Some(described) = &described {
        libraries(&mut fmu, described, &mut found);
    }
    let is_own = described.as_ref().is_none_or(|described| described.generation_tool.starts_with(PROGRAM));
    let packed = if is_own { fmu.definition().map(Some) } else { fmu.find_definition() };
    if matches!(packed, Ok(None)) {
        let why = "another program built this FMU, which contains no definition: only the archive, \
                   modelDescription.xml and the libraries are checked";
        found.notes.push(format!("{}: {why}", fmu.shown()));
    }
    if let Some(Some(packed)) = found.take(packed)
        && let Some(meant) = definition(packed, version, &mut found)?
        && let Some(described) = described
    {
        compare(&fmu, &described, &meant, &mut found);
    }
    Ok(found)
}

/// Check a definition like `check`. Returns its description for this version, if it gives a model.
fn definition(
    Definition { shown, kind, text }: Definition,
    version: Version,
    found: &mut Found,
) -> Result<Option<Description>> {
    let checked = check::check(shown.clone(), kind, text.clone())?;
    found.errors.extend(check::listed(&checked, Severity::Error));
    found.warnings.extend(check::listed(&checked, Severity::Warning));
    if checked.count(Severity::Error) > 0 {
        return Ok(None);
    }
    let description = Component::from_definition(kind, &text)
        .map_err(anyhow::Error::from)
        .and_then(|component| Description::parse(&version.describe(&component, Naming::default())?))
        .context(shown);
    Ok(found.take(description))
}

/// Names and contents of all entries.
fn archive(fmu: &mut Fmu, found: &mut Found) {
    let all = fmu.names().to_vec();
    found.errors.extend(fmu.faults().iter().map(|fault| format!("{}: {fault}", fmu.shown())));
    for name in &all {
        found.take(names::check(name).with_context(|| fmu.shown().to_owned()));
        // Unpacking compares the checksum.
        found.take(fmu.read(name));
    }
    found.take(names::check_case(all.iter().map(String::as_str)).with_context(|| fmu.shown().to_owned()));
}

/// Check the library of each platform that has a folder, and that this platform has one.
fn libraries(fmu: &mut Fmu, described: &Description, found: &mut Found) {
    let shown = fmu.shown().to_owned();
    let is_own = described.generation_tool.starts_with(PROGRAM);
    let any = described.interfaces.values().next().filter(|_| !is_own);
    let Some(identifier) = described.interfaces.get(INTERFACE).or(any) else {
        found.errors.push(format!("{shown}: modelDescription.xml has no {INTERFACE}"));
        return;
    };
    let platforms = info::platforms(fmu);
    if platforms.is_empty() && (is_own || !fmu.names().iter().any(|name| name.starts_with(SOURCES))) {
        found.errors.push(format!("{shown}: the FMU contains no library, so no simulation tool can load this FMU"));
    }
    let is_archive = |name: &&String| name.starts_with(BINARIES) && [".a", ".lib"].iter().any(|e| name.ends_with(e));
    let pages = [static_library::PAGE.to_owned(), static_library::PAGE.replace(".txt", ".html")];
    if let Some(archive) = fmu.names().iter().find(is_archive)
        && !pages.iter().any(|page| fmu.names().contains(page))
    {
        found.errors.push(format!(
            "{shown}: the FMU contains the static library {archive}, but not the file {}, which explains how to link \
             this library",
            static_library::PAGE
        ));
    }
    for platform in &platforms {
        let within = format!("{}/{platform}/", BINARIES);
        if fmu.names().iter().filter(|name| name.starts_with(&within)).all(|name| is_archive(&name)) {
            continue;
        }
        let Some(path) = binary::path(platform, identifier) else {
            let known = fmu_cli::PLATFORMS.join(", ");
            found.warnings.push(format!(
                "{shown}: binaries/{platform} is not a platform of FMI; the platforms of FMI 2.0 are {known}"
            ));
            continue;
        };
        match fmu.read(&path) {
            Ok(Some(content)) if platform == COMPATIBLE && binary::check_for(ARM_LINUX, &content).is_ok() => {
                found.warnings.push(format!(
                    "{shown}/{path}: this library is for ARM ({ARM_LINUX}); simulation tools on x86_64 cannot load \
                     this FMU"
                ))
            }
            Ok(Some(content)) => {
                found.take(binary::check_for(platform, &content).with_context(|| format!("{shown}/{path}")));
                needs(&format!("{shown}/{path}"), &content, found);
            }
            Ok(None) => found
                .errors
                .push(format!("{shown}: the FMU contains no {path}, which simulation tools on {platform} load")),
            // The check of the archive has reported the fault.
            Err(_) => {}
        }
    }
    if let Ok(own) = Version::of(&described.fmi_version).platform()
        && !platforms.contains(&own)
    {
        found.warnings.push(format!("{shown}: the FMU contains no library for this machine ({own})"));
    }
}

/// Report the requirements of a library on the machine that loads it.
fn needs(shown: &str, content: &[u8], found: &mut Found) {
    // A file that is no library was reported before.
    let Ok(needs) = Needs::of(content) else { return };
    if let Some(version) = &needs.glibc {
        let functions = needs.functions.join(", ");
        found.notes.push(format!("{shown}: the library needs glibc {version} or later (for {functions})"));
    }
    for library in &needs.libraries {
        found.warnings.push(format!(
            "{shown}: the library needs {library}, which Windows does not have; install this library in a folder of \
                PATH"
        ));
    }
}

/// Compare the description in the FMU with that of its definition.
fn compare(fmu: &Fmu, packed: &Description, meant: &Description, found: &mut Found) {
    let shown = fmu.shown();
    let of_model = [
        ("fmiVersion", &packed.fmi_version, &meant.fmi_version),
        ("modelName", &packed.name, &meant.name),
        ("guid", &packed.guid, &meant.guid),
    ];
    let remedy = "pack the FMU again, or restore the names in the definition";
    let mut differ = |what: &str, packed: &str, meant: &str| {
        found.errors.push(format!("{shown}: {what} is \"{packed}\", but the definition gives \"{meant}\"; {remedy}"));
    };
    for (what, packed, meant) in of_model {
        if packed != meant {
            differ(what, packed, meant);
        }
    }
    if packed.interfaces != meant.interfaces {
        differ("the list of interface types", &format!("{:?}", packed.interfaces), &format!("{:?}", meant.interfaces));
    }
    let mut others: BTreeMap<&str, &Described> = packed.variables.iter().map(|v| (v.name.as_str(), v)).collect();
    let mut starts = Vec::new();
    for meant in &meant.variables {
        let Some(packed) = others.remove(meant.name.as_str()) else {
            found.errors.push(format!("{shown}: modelDescription.xml has no variable {}; {remedy}", meant.name));
            continue;
        };
        let parts = |variable: &Described| {
            [&variable.reference, &variable.kind, &variable.causality, &variable.variability, &variable.unit]
                .map(String::clone)
        };
        if parts(packed) != parts(meant) {
            let (name, packed, given) = (&meant.name, parts(packed).join(" "), parts(meant).join(" "));
            found.errors.push(format!(
                "{shown}: value reference, type, causality, variability and unit of {name} are \"{packed}\", but the \
                 definition gives \"{given}\"; {remedy}"
            ));
        }
        if packed.start != meant.start {
            starts.push(meant.name.as_str());
        }
    }
    for name in others.keys() {
        found.errors.push(format!("{shown}: the definition has no variable {name}; {remedy}"));
    }
    if let Some(first) = starts.first() {
        let more = if starts.len() > 1 { format!(" and {} more", starts.len() - 1) } else { String::new() };
        found.warnings.push(format!(
            "{shown}: the start value of {first}{more} in modelDescription.xml differs from the definition; simulation \
             tools show the value of modelDescription.xml, but the FMU uses the value of the definition; pack the FMU \
             again"
        ));
    }
}
