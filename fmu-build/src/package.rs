//! `cargo fmu package`: packs a definition as an FMU.
//!
//! In: a definition file of any kind of model. Out: `<Name>.fmu`, `<Name>.fmi3.fmu` for FMI 3.0, and for a folder of
//! `modelDescription/` its `modelDescription.xml`.

use crate::archive::{self, Entry, MODEL_DESCRIPTION};
use crate::binary::Binary;
use crate::check::Checked;
use crate::documentation::{Extent, RESULTS, Subject};
use crate::library::served::{self, SharedLibrary};
use crate::source::{self, Companions, Source};
use crate::ssp::{Packable, System};
use crate::static_library::{self, StaticLibrary};
use crate::version::Version;
use crate::workspace::{DEFAULT_FMU, Workspace};
use crate::xml::{fmi2, fmi3, terminals};
use crate::{check, files, licenses, platform, schema, ssp};
use anyhow::{Context, Result, bail};
pub use fmu_cli::Package as Arguments;
use fmu_cli::{Fmi, Naming};
use linkage_fmu::component::{Component, TABLES};
use linkage_fmu::inspection::Severity;
use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

/// A checked definition before packing.
struct Prepared {
    source: Source,
    name: String,
    /// The definition with its findings.
    checked: Checked,
    component: Component,
    /// Text of the README next to the definition.
    readme: Option<String>,
    /// The description of FMI 2.0.
    description: String,
    terminals: String,
}

/// Common data of all FMUs of one call.
struct Common<'a> {
    workspace: &'a Workspace,
    /// The libraries, for each platform and each kind of model that is packed.
    binaries: Vec<Binary>,
    /// The static libraries.
    statics: Vec<StaticLibrary>,
    extent: Extent,
    /// Whether tables are packed.
    tables: bool,
    versions: &'static [Version],
    naming: Naming,
    /// Folder for the FMUs.
    out: PathBuf,
}

/// Pack the definitions. Returns the paths of the FMUs in the order of the arguments, FMI 2.0 first.
///
/// # Errors
/// The rejected definitions. All of them are reported before anything is built or written.
pub fn run(workspace: &Workspace, arguments: &Arguments) -> Result<Vec<PathBuf>> {
    if arguments.ssp && arguments.fmi == Fmi::Three {
        bail!("--ssp with --fmi 3: the system contains FMUs of FMI 2.0; remove --fmi, or write --fmi 2");
    }
    let mut refused = Vec::new();
    let (sources, systems) = read(workspace, arguments, &mut refused)?;
    let prepared = prepare_all(sources, &mut refused);
    let packages = packages(&systems, &prepared, &mut refused);
    if !refused.is_empty() {
        bail!("nothing was packed: {}", refused.join("\n"));
    }
    let mut needed: Vec<&'static SharedLibrary> = Vec::new();
    for library in prepared.iter().map(|fmu| served::of(&fmu.component)) {
        if !needed.contains(&library) {
            needed.push(library);
        }
    }
    let binaries = libraries(workspace, arguments, &needed)?;
    let pairs = arguments.statics.iter().flat_map(|target| needed.iter().map(move |library| (target, *library)));
    let statics = pairs.map(|(target, library)| StaticLibrary::build(workspace, library, target));
    let statics = statics.collect::<Result<Vec<_>>>()?;
    let out = arguments.out.clone().unwrap_or_else(|| workspace.fmu_folder());
    if out.extension().is_some_and(|extension| extension == "fmu") && !out.is_dir() {
        bail!(
            "{}: the folder for the FMUs has the name of an FMU; state a folder, in which each FMU has the name of its \
             model",
            out.display()
        );
    }
    files::make_folder(&out, "--out")?;
    let extent = Extent { animation: !arguments.no_animation, results: !arguments.no_results };
    let versions: &[Version] = match arguments.fmi {
        Fmi::Two => &[Version::Two],
        Fmi::Three => &[Version::Three],
        Fmi::Both => &[Version::Two, Version::Three],
    };
    let tables = !arguments.no_tables;
    let common = Common { workspace, binaries, statics, extent, tables, versions, naming: arguments.naming, out };
    let mut paths = Vec::new();
    for fmu in prepared {
        paths.extend(pack(&common, fmu)?);
    }
    for package in packages {
        paths.push(ssp::write(&common.out, package)?);
    }
    Ok(paths)
}

/// Read the definitions and the systems. Unreadable ones are added to `refused`.
fn read(workspace: &Workspace, arguments: &Arguments, refused: &mut Vec<String>) -> Result<(Vec<Source>, Vec<System>)> {
    let paths = match arguments {
        Arguments { all: true, .. } => workspace.description_folders()?,
        Arguments { ssp: true, .. } => Vec::new(),
        Arguments { paths, .. } if !paths.is_empty() => paths.clone(),
        _ => vec![workspace.descriptions().join(DEFAULT_FMU)],
    };
    // Systems contain FMUs of FMI 2.0.
    let files = match arguments {
        Arguments { fmi: Fmi::Three, .. } | Arguments { all: false, ssp: false, .. } => Vec::new(),
        Arguments { ssp: true, paths, .. } if !paths.is_empty() => paths.clone(),
        _ => ssp::examples(workspace),
    };
    let (mut sources, mut systems) = (Vec::new(), Vec::new());
    for path in &paths {
        match Source::find(workspace, path) {
            Ok(source) => sources.push(source),
            Err(error) => refused.push(format!("{error:#}")),
        }
    }
    for path in &files {
        match System::read(workspace, path) {
            Ok((system, own)) => {
                systems.push(system);
                for source in own {
                    // Two FMUs of one or several systems may have the same definition.
                    if sources.iter().all(|other| ssp::full(&other.definition) != ssp::full(&source.definition)) {
                        sources.push(source);
                    }
                }
            }
            Err(error) => refused.push(format!("{error:#}")),
        }
    }
    Ok((sources, systems))
}

/// The checked definitions. Definitions with errors and duplicate names are added to `refused`.
fn prepare_all(sources: Vec<Source>, refused: &mut Vec<String>) -> Vec<Prepared> {
    let mut definitions: HashMap<String, PathBuf> = HashMap::new();
    let mut prepared = Vec::new();
    for source in sources {
        let path = source.definition.clone();
        let fmu = match prepare(source) {
            Ok(Some(fmu)) => fmu,
            Ok(None) => {
                refused.push(format!("{}: no FMU was packed, because of the errors above", path.display()));
                continue;
            }
            Err(error) => {
                refused.push(format!("{error:#}"));
                continue;
            }
        };
        if let Some(other) = definitions.insert(fmu.name.clone(), path.clone()) {
            let (path, name, other) = (path.display(), &fmu.name, other.display());
            refused.push(format!(
                "{path}: the value of the key `name` is {name}, as in {other}; both FMUs would have the file name \
                 {name}.fmu, so change one of the two values"
            ));
        }
        prepared.push(fmu);
    }
    prepared
}

/// The systems with the models of their FMUs. Systems with errors and duplicate names are added to `refused`.
fn packages(systems: &[System], prepared: &[Prepared], refused: &mut Vec<String>) -> Vec<Packable> {
    let mut packages: Vec<Packable> = Vec::new();
    for system in systems {
        let model = |file: &PathBuf| prepared.iter().find(|fmu| ssp::full(&fmu.source.definition) == *file);
        let models = system.files.iter().map(|file| Some(&model(file)?.component)).collect::<Option<Vec<_>>>();
        // A definition with errors is already in `refused`.
        let Some(models) = models else { continue };
        match system.packable(&models) {
            Ok(package) if packages.iter().any(|other| other.name == package.name) => refused.push(format!(
                "two systems have the name {0}; both packages would have the file name {0}.ssp, so change one name",
                package.name
            )),
            Ok(package) => {
                package.warnings.iter().for_each(|line| println!("{line}"));
                packages.push(package);
            }
            Err(error) => refused.push(format!("{error:#}")),
        }
    }
    packages
}

/// Pack the default FMU of FMI 2.0. Returns its path.
///
/// # Errors
/// As for [`run`].
pub fn default(workspace: &Workspace) -> Result<PathBuf> {
    run(workspace, &Arguments::of_fmi_2())?.pop().context("no FMU was packed")
}

/// The requested libraries. Libraries built elsewhere are first.
///
/// # Errors
/// A library is not available, or is for no platform.
pub(crate) fn libraries(
    workspace: &Workspace,
    arguments: &Arguments,
    needed: &[&'static SharedLibrary],
) -> Result<Vec<Binary>> {
    let mut binaries = further(arguments)?;
    binaries.extend(platform::build(workspace, arguments, needed)?);
    Ok(binaries)
}

/// The libraries built elsewhere.
fn further(arguments: &Arguments) -> Result<Vec<Binary>> {
    let built = platform::folders(arguments)?;
    let mut binaries: Vec<Binary> = Vec::new();
    for named in &arguments.binaries {
        let binary = Binary::read(named)?;
        let platform = binary.platform();
        if built.contains(&platform) {
            bail!("--binary {platform}: the program adds the library for this platform itself; remove this option");
        }
        if binaries.iter().any(|other| other.platform() == platform) {
            bail!("--binary {platform}: the option occurs twice for this platform; give one library for each platform");
        }
        binaries.push(binary);
    }
    Ok(binaries)
}

/// The checked definition of a source. None if it has errors, which are printed.
fn prepare(source: Source) -> Result<Option<Prepared>> {
    let path = source.definition.display();
    let definition = source.text()?;
    let checked = check::check(path.to_string(), source.kind(), definition)?;
    print!("{}", check::findings(&checked));
    println!("{}", check::summary(&checked));
    if checked.count(Severity::Error) > 0 {
        return Ok(None);
    }
    let component = Component::from_definition(source.kind(), &checked.text).with_context(|| path.to_string())?;
    let description = fmi2::to_xml(&component, Naming::default()).with_context(|| path.to_string())?;
    let name = component.name().to_owned();
    if let Some(folder) = source.folder.as_deref().filter(|_| source.keeps_description) {
        // A name such as `.` contains no information, the full path does.
        let folder = folder.canonicalize()?;
        if !folder.ends_with(&name) {
            bail!(
                "{path}: the value of the key `name` is {name}, but the folder has the name {}; give the folder the \
                 name {name}, or change the key",
                folder.display()
            );
        }
    }
    let terminals = terminals::to_xml(&component).with_context(|| path.to_string())?;
    let readme = source.readme()?;
    Ok(Some(Prepared { name, checked, component, readme, description, terminals, source }))
}

/// The descriptions of a model for FMI 2.0 and 3.0, and its terminals.
///
/// # Errors
/// The model cannot be described.
pub fn descriptions(component: &Component) -> Result<[String; 3]> {
    let naming = Naming::default();
    Ok([fmi2::to_xml(component, naming)?, fmi3::to_xml(component, naming)?, terminals::to_xml(component)?])
}

/// Write the FMUs of one model. Returns their paths.
fn pack(common: &Common, fmu: Prepared) -> Result<Vec<PathBuf>> {
    if let Some(folder) = fmu.source.folder.as_deref().filter(|_| fmu.source.keeps_description) {
        write_if_changed(&folder.join(MODEL_DESCRIPTION), &fmu.description)?;
    }
    let shown = fmu.source.definition.display();
    let Companions { mut entries, left_out } = fmu.source.companions()?;
    if !left_out.is_empty() {
        println!("{shown}: not packed into the FMU: {}", source::listed(&left_out));
    }
    let mut generated = documentation(common, &fmu, &entries)?;
    generated.push(Entry { name: terminals::PATH.to_owned(), content: fmu.terminals.into_bytes() });
    generated.extend(licenses::entries());
    // A user's own file replaces the generated file.
    let is_own = |made: &Entry| entries.iter().any(|own| own.name == made.name);
    let (replaced, generated): (Vec<_>, Vec<_>) = generated.into_iter().partition(is_own);
    if !replaced.is_empty() {
        let names: Vec<String> = replaced.into_iter().map(|entry| entry.name).collect();
        println!("{shown}: your own files are packed instead of the generated files: {}", source::listed(&names));
    }
    entries.extend(generated);
    let (file, library) = (fmu.component.definition_file(), served::of(&fmu.component));
    let schema = schema::name(file);
    let definition = schema::with_schema_path(&fmu.checked.text, &schema).into_bytes();
    // The tables belong to the text in the FMU.
    let packed = String::from_utf8_lossy(&definition);
    if let Some(tables) = common.tables.then(|| fmu.component.tables(&packed)).flatten() {
        entries.push(Entry { name: format!("resources/{TABLES}"), content: tables });
    }
    entries.extend([
        Entry { name: format!("resources/{file}"), content: definition },
        Entry { name: format!("resources/{schema}"), content: schema::text(file) },
    ]);
    let mut paths = Vec::new();
    for &version in common.versions {
        let description = match version {
            Version::Two if common.naming == Naming::default() => fmu.description.clone(),
            other => other.describe(&fmu.component, common.naming)?,
        };
        let mut entries = entries.clone();
        entries.extend([Entry { name: MODEL_DESCRIPTION.to_owned(), content: description.into_bytes() }]);
        let path = common.out.join(format!("{}.{}", fmu.name, version.extension()));
        for binary in common.binaries.iter().filter(|binary| binary.serves(library)) {
            let libraries = binary.entries(version, &fmu.name);
            if libraries.is_empty() {
                let (file, platform) = (path.display(), binary.platform());
                println!(
                    "{file}: the library for {platform} is left out, because the library has no functions of FMI 3.0"
                );
            }
            entries.extend(libraries);
        }
        let statics: Vec<_> = common.statics.iter().filter(|other| other.library == library).collect();
        for library in &statics {
            entries.push(library.entry(version, &fmu.name)?);
        }
        if !statics.is_empty() {
            entries.push(static_library::page(&statics, version, &fmu.name));
        }
        archive::write(&path, entries)?;
        let size = fs::metadata(&path)?.len().div_ceil(1024);
        println!("{} ({size} KiB, {} variables)", path.display(), fmu.component.interface().list().len());
        paths.push(path);
    }
    Ok(paths)
}

/// The documentation files of the model. A user's own reference results replace the generated ones, because they share
/// one manifest.
fn documentation(common: &Common, fmu: &Prepared, own: &[Entry]) -> Result<Vec<Entry>> {
    let shown = fmu.source.definition.display();
    let subject = Subject { checked: &fmu.checked, component: &fmu.component, readme: fmu.readme.as_deref() };
    let has_results = own.iter().any(|entry| entry.name.starts_with(RESULTS));
    let extent = Extent { results: common.extent.results && !has_results, ..common.extent };
    let made = subject.files(common.workspace, extent).with_context(|| shown.to_string())?;
    made.left_out.iter().for_each(|line| println!("{shown}: {line}"));
    Ok(made.entries)
}

fn write_if_changed(path: &Path, text: &str) -> Result<()> {
    if fs::read(path).is_ok_and(|present| present == text.as_bytes()) {
        return Ok(());
    }
    files::replace(path, text.as_bytes())?;
    println!("{} (updated)", path.display());
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The committed descriptions agree with the present engine.
    #[test]
    fn committed_descriptions_are_current() {
        let workspace = Workspace::locate();
        let folders = workspace.description_folders().unwrap();
        assert!(folders.iter().any(|folder| folder.ends_with(DEFAULT_FMU)), "{folders:?}");
        for folder in folders {
            let expected = prepare(Source::find(&workspace, &folder).unwrap()).unwrap().unwrap().description;
            if std::env::var_os("LINKAGE_FMU_WRITE").is_some() {
                fs::write(folder.join(MODEL_DESCRIPTION), &expected).unwrap();
            }
            let committed = fs::read_to_string(folder.join(MODEL_DESCRIPTION)).unwrap_or_default();
            assert!(
                committed == expected,
                "{}/{MODEL_DESCRIPTION} is out of date; \
                 LINKAGE_FMU_WRITE=1 cargo test -p fmu-build --lib package writes it",
                folder.display()
            );
        }
    }

    /// FMI 2.0.5, 2.2.8, and FMI 3.0.2, 2.4.7: an unknown may depend only on knowns. Knowns are inputs; for present
    /// values also continuous states; for initial values also variables with an exact start.
    #[test]
    fn dependencies_are_known_variables() {
        let workspace = Workspace::locate();
        for folder in workspace.description_folders().unwrap() {
            let component = prepare(Source::find(&workspace, &folder).unwrap()).unwrap().unwrap().component;
            for version in [Version::Two, Version::Three] {
                let text = version.describe(&component, Naming::default()).unwrap();
                let document = roxmltree::Document::parse(&text).unwrap();
                let variables: Vec<_> = document.descendants().filter(|node| node.has_attribute("causality")).collect();
                let first = usize::from(version == Version::Two);
                let mut count = 0;
                for unknown in document.descendants().filter(|node| node.has_attribute("dependencies")) {
                    let is_initial =
                        [unknown, unknown.parent().unwrap()].iter().any(|n| n.tag_name().name().starts_with("Initial"));
                    for index in unknown.attribute("dependencies").unwrap().split_whitespace() {
                        let known = variables[index.parse::<usize>().unwrap() - first];
                        let is_state = known.descendants().any(|node| node.has_attribute("reinit"));
                        let is_known = match known.attribute("causality") {
                            Some("input") => true,
                            _ if is_initial => known.attribute("initial") == Some("exact"),
                            _ => is_state,
                        };
                        count += 1;
                        assert!(is_known, "{}: {unknown:?} depends on {known:?}", folder.display());
                    }
                }
                assert!(count > 0, "{}", folder.display());
            }
        }
    }

    #[test]
    fn a_folder_and_its_definition_are_the_same_source() {
        let workspace = Workspace::locate();
        let folder = workspace.descriptions().join(DEFAULT_FMU);
        let by_folder = Source::find(&workspace, &folder).unwrap();
        let by_file = Source::find(&workspace, &folder.join("resources").join("mechanism.json")).unwrap();
        assert!(by_folder.keeps_description && by_file.keeps_description);
        assert_eq!([by_folder.kind(), by_file.kind()], ["mechanism.json"; 2]);
        assert_eq!(by_folder.folder.unwrap().canonicalize().unwrap(), by_file.folder.unwrap());
    }

    #[test]
    fn a_path_without_a_definition_is_rejected_with_the_remedy() {
        let workspace = Workspace::locate();
        let message = |path: &str| Source::find(&workspace, &workspace.root().join(path)).unwrap_err().to_string();
        assert!(message("nowhere").ends_with(
            "there is no such file or folder; give the path of a mechanism.json or a hydraulics.json or a \
             network.json, or of a folder that contains one of these files"
        ));
        assert!(message("fmu-build").ends_with("in one of these folders"));
    }
}
