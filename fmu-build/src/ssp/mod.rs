//! `cargo fmu package --ssp`: mechanisms and their hydraulics as systems of SSP 1.0.
//!
//! In: system files, packed FMUs. Out: `<name>.ssp` next to the FMUs. A simulation tool that holds inputs can couple
//! the FMUs: the force on a mechanism is the mean force that its hydraulics predicts for the next step.

mod connect;
pub mod definition;
mod layout;

use crate::archive::{self, Entry};
use crate::check::place_of;
use crate::files;
use crate::source::{Source, check_content};
use crate::workspace::Workspace;
use crate::xml::common::is_c_identifier;
use crate::xml::ssd;
use anyhow::{Context, Result, anyhow};
use definition::Definition;
use linkage_fmu::component::Component;
use linkage_fmu::format::{self, DefinitionError, Faults, LARGEST_DEFINITION, Numbers, Range};
use std::fs;
use std::path::{Path, PathBuf};

/// Names of the example systems: the landing gear with its actuator (scene H1 of the coupling benchmark), and gear and
/// door with the hydraulic system that moves and unlocks both.
const EXAMPLES: [&str; 2] = ["LandingGearRetractionWithHydraulics", "LandingGearSystem"];

/// Files of the example systems.
pub fn examples(workspace: &Workspace) -> Vec<PathBuf> {
    EXAMPLES.iter().map(|name| example(workspace, name)).collect()
}

/// File of the example system with this name.
pub fn example(workspace: &Workspace, name: &str) -> PathBuf {
    workspace.descriptions().join(name).with_extension("json")
}

/// A system from its file.
pub struct System {
    path: PathBuf,
    text: String,
    definition: Definition,
    /// Full path of the definition file of each FMU.
    pub files: Vec<PathBuf>,
}

/// A system before packing.
pub struct Packable {
    /// Name of the package.
    pub name: String,
    /// Names of the models.
    models: Vec<String>,
    /// Text of the system structure.
    pub structure: String,
    /// Warnings, one per line.
    pub warnings: Vec<String>,
}

impl System {
    /// Read a system file, and find the definitions of its FMUs.
    ///
    /// # Errors
    /// The file cannot be read; all faults of its keys, one per line; an FMU has no definition.
    pub fn read(workspace: &Workspace, path: &Path) -> Result<(Self, Vec<Source>)> {
        let shown = path.display();
        let bytes = files::read(path, LARGEST_DEFINITION)
            .with_context(|| "--ssp reads system files: give a file such as system.json")?;
        let text = String::from_utf8(bytes)
            .ok()
            .with_context(|| format!("{shown}: is not UTF-8 text; save the file as UTF-8"))?;
        check_content("system", &text).with_context(|| format!("{shown}"))?;
        let mut definition = Definition::default();
        let mut faults = format::read_with("system", &text, &Numbers::default(), &mut definition);
        if faults.is_empty() {
            check(&definition, &mut faults);
        }
        let mut system = Self { path: path.to_path_buf(), text, definition, files: Vec::new() };
        system.refused(faults)?;
        let (mut sources, mut faults) = (Vec::new(), Faults::default());
        for (name, fmu) in system.definition.fmus.iter() {
            let found = Source::find(workspace, &system.path_of(&fmu.definition));
            let path = format!("fmus.{name}.definition");
            sources.extend(faults.keep(found.map_err(|error| DefinitionError::key(path, format_args!("{error:#}")))));
        }
        system.refused(faults)?;
        system.files = sources.iter().map(|source| full(&source.definition)).collect();
        Ok((system, sources))
    }

    /// The system with the models of its FMUs, in the order of the file.
    ///
    /// # Errors
    /// All faults of names, connections and values, one per line.
    pub fn packable(&self, models: &[&Component]) -> Result<Packable> {
        let Definition { name, description, stop_time, fmus, .. } = &self.definition;
        let mut faults = Faults::default();
        let found = connect::Connected::new(self, models, &mut faults);
        self.refused(faults)?;
        let connectors = found.connectors(models);
        let connected: Vec<[usize; 2]> = found.connections.iter().map(|ends| ends.map(|(part, _)| part)).collect();
        let (areas, area) = layout::areas(&connectors, &connected);
        let files: Vec<String> = models.iter().map(|model| format!("{}.fmu", model.name())).collect();
        let parts: Vec<ssd::Part> = (0..models.len())
            .map(|part| ssd::Part {
                name: fmus.names()[part],
                file: &files[part],
                variables: models[part].interface().list(),
                places: layout::places(&connectors[part]),
                connectors: connectors[part].clone(),
                values: &found.values[part],
                area: areas[part],
            })
            .collect();
        let longest = models.iter().map(|model| model.experiment().stop_time).fold(0.0, f64::max);
        let structure = ssd::System {
            name,
            description,
            parts: &parts,
            connections: &found.connections,
            area,
            stop_time: stop_time.unwrap_or(longest),
        };
        let shown = self.path.display();
        let warnings = found.warnings(models).iter().map(|line| format!("{shown}: warning: {line}")).collect();
        let mut models: Vec<String> = models.iter().map(|model| model.name().to_owned()).collect();
        models.sort_unstable();
        models.dedup();
        let structure = structure.text().with_context(|| shown.to_string())?;
        Ok(Packable { name: name.clone(), models, structure, warnings })
    }

    /// Path of a file that the system names relative to its own folder.
    fn path_of(&self, path: &str) -> PathBuf {
        self.path.parent().unwrap_or(Path::new("")).join(path)
    }

    /// # Errors
    /// All faults, one per line with their places in the text.
    fn refused(&self, faults: Faults) -> Result<()> {
        let mut lines = Vec::new();
        for fault in faults {
            let place = fault.place().is_none().then(|| place_of(&self.text, fault.path())).flatten();
            let fault = match place {
                Some(place) => fault.at(place),
                None => fault,
            };
            lines.push(format!("{}: {fault}", self.path.display()));
        }
        if lines.is_empty() { Ok(()) } else { Err(anyhow!(lines.join("\n"))) }
    }
}

/// Check the parts of a file that do not depend on its models.
fn check(definition: &Definition, faults: &mut Faults) {
    const NAME: &str = "a name of letters, digits and underscores that does not start with a digit";
    let Definition { name, description, stop_time, fmus, .. } = definition;
    if !is_c_identifier(name) {
        faults.push(DefinitionError::value("name", format_args!("\"{name}\""), NAME));
    }
    if description.contains(char::is_control) {
        faults.push(DefinitionError::key(
            "description",
            "the text contains a control character; write the text on one line",
        ));
    }
    if let Some(time) = stop_time {
        faults.keep(Range::Positive.check("stop_time", *time));
    }
    if fmus.is_empty() {
        faults.push(DefinitionError::key("fmus", "the object is empty; add at least one FMU"));
    }
    for name in fmus.names().into_iter().filter(|name| !is_c_identifier(name)) {
        faults.push(DefinitionError::value(format_args!("fmus.{name}"), format_args!("\"{name}\""), NAME));
    }
}

/// The full path of a file. If the file does not exist, the given path.
pub fn full(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_path_buf())
}

/// Write the package of a system, whose FMUs are in the folder.
///
/// # Errors
/// A file cannot be read or written.
pub fn write(out: &Path, system: Packable) -> Result<PathBuf> {
    let mut entries = Vec::new();
    for name in system.models {
        let path = out.join(&name).with_extension("fmu");
        let content = fs::read(&path).with_context(|| format!("{}: cannot be read", path.display()))?;
        entries.push(Entry { name: format!("resources/{name}.fmu"), content });
    }
    entries.push(Entry { name: ssd::PATH.to_owned(), content: system.structure.into_bytes() });
    let path = out.join(system.name).with_extension("ssp");
    archive::write(&path, entries)?;
    println!("{}", path.display());
    Ok(path)
}
