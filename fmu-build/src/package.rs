//! `cargo fmu package`: a definition becomes an FMU.
//!
//! In: a definition file of any kind of model. Out: `<Name>.fmu`, and for a folder of `modelDescription/` its
//! `modelDescription.xml`.

use crate::archive::{self, Entry, MODEL_DESCRIPTION};
use crate::binary::Binary;
use crate::source::{self, Companions, Source};
use crate::workspace::{DEFAULT_FMU, Workspace};
use crate::xml::{fmi2, terminals};
use crate::{check, files, library, page, schema, ssp};
use anyhow::{Context, Result, bail};
use fmu_cli::Library;
pub use fmu_cli::Package as Arguments;
use linkage_fmu::component::Component;
use linkage_fmu::inspection::Severity;
use linkage_fmu::variables::Interface;
use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

/// A checked definition, ready to be packed.
struct Prepared {
    source: Source,
    name: String,
    /// Text of the definition file.
    definition: String,
    /// Name of the definition file in the FMU.
    file: &'static str,
    description: String,
    terminals: Option<String>,
    interface: Interface,
}

/// Pack the definitions; the paths of the FMUs, in the order of the arguments.
///
/// # Errors
/// The first definition that is refused, before anything is built or written.
pub fn run(workspace: &Workspace, arguments: &Arguments) -> Result<Vec<PathBuf>> {
    let paths = if arguments.all {
        workspace.description_folders()?
    } else if arguments.ssp {
        ssp::FMUS.iter().map(|name| workspace.descriptions().join(name)).collect()
    } else if arguments.paths.is_empty() {
        vec![workspace.descriptions().join(DEFAULT_FMU)]
    } else {
        arguments.paths.clone()
    };
    let mut definitions: HashMap<String, PathBuf> = HashMap::new();
    let mut prepared = Vec::new();
    for path in &paths {
        let fmu = prepare(Source::find(workspace, path)?)?;
        let definition = fmu.source.definition.clone();
        if let Some(other) = definitions.insert(fmu.name.clone(), definition) {
            bail!(
                "{}: name is {}, as in {}; both would be {}.fmu, so rename one",
                fmu.source.definition.display(),
                fmu.name,
                other.display(),
                fmu.name
            );
        }
        prepared.push(fmu);
    }
    let binaries = further(&arguments.binaries)?;
    let library = library::build(workspace)?;
    let out = arguments.out.clone().unwrap_or_else(|| workspace.fmu_folder());
    let interfaces: HashMap<_, _> = prepared.iter().map(|fmu| (fmu.name.clone(), fmu.interface.clone())).collect();
    let pack = |fmu| pack(workspace, fmu, &library, &binaries, &out);
    let mut paths = prepared.into_iter().map(pack).collect::<Result<Vec<_>>>()?;
    if let ([Some(gear), Some(hydraulics)], true) =
        (ssp::FMUS.map(|name| interfaces.get(name)), arguments.ssp || arguments.all)
    {
        let [first, second] = ssp::FMUS.map(|name| out.join(name).with_extension("fmu"));
        paths.push(ssp::write(&out, [(&first, gear.list()), (&second, hydraulics.list())])?);
    }
    Ok(paths)
}

/// Pack the default FMU; its path.
///
/// # Errors
/// As for [`run`].
pub fn default(workspace: &Workspace) -> Result<PathBuf> {
    run(workspace, &Arguments::default())?.pop().context("no FMU was packed")
}

/// The libraries of other platforms.
fn further(named: &[Library]) -> Result<Vec<Binary>> {
    let mut binaries: Vec<Binary> = Vec::new();
    for named in named {
        let binary = Binary::read(named)?;
        let platform = binary.platform();
        if library::platform()? == platform {
            bail!("--binary {platform}: that library is built here; leave it out");
        }
        if binaries.iter().any(|other| other.platform() == platform) {
            bail!("--binary {platform}: given twice; name one library for each platform");
        }
        binaries.push(binary);
    }
    Ok(binaries)
}

fn prepare(source: Source) -> Result<Prepared> {
    let path = source.definition.display();
    let definition = source.text()?;
    let checked = check::check(path.to_string(), source.kind(), definition.clone())?;
    print!("{}", check::findings(&checked));
    let errors = check::listed(&checked, Severity::Error);
    if let Some(first) = errors.first() {
        let others = if errors.len() > 1 { format!("; {} more stand above", errors.len() - 1) } else { String::new() };
        bail!("{first}{others}");
    }
    println!("{}", check::summary(&checked));
    let component = Component::from_definition(source.kind(), &definition).with_context(|| path.to_string())?;
    let description = fmi2::to_xml(&component).with_context(|| path.to_string())?;
    let (name, file) = (component.name().to_owned(), component.definition_file());
    if let Some(folder) = source.folder.as_deref().filter(|_| source.keeps_description) {
        // A name such as `.` says nothing; the full path does.
        let folder = folder.canonicalize()?;
        if !folder.ends_with(&name) {
            bail!("{path}: name is {name}, but the folder is {}; give both one name", folder.display());
        }
    }
    let terminals = terminals::to_xml(&component).with_context(|| path.to_string())?;
    let interface = component.interface().clone();
    Ok(Prepared { name, definition, file, description, terminals, interface, source })
}

fn pack(workspace: &Workspace, fmu: Prepared, library: &[u8], binaries: &[Binary], out: &Path) -> Result<PathBuf> {
    if let Some(folder) = fmu.source.folder.as_deref().filter(|_| fmu.source.keeps_description) {
        write_if_changed(&folder.join(MODEL_DESCRIPTION), &fmu.description)?;
    }
    let Companions { mut entries, left_out } = fmu.source.companions()?;
    if !left_out.is_empty() {
        println!("{}: left out of the FMU: {}", fmu.source.definition.display(), source::listed(&left_out));
    }
    if let Some(page) = entries.iter_mut().find(|entry| entry.name == page::PATH) {
        page.content = page::whole(&fmu.name, fmu.file, std::mem::take(&mut page.content));
    }
    let schema = schema::name(fmu.file);
    let definition = schema::led_here(&fmu.definition, &schema).into_bytes();
    entries.extend([
        Entry { name: MODEL_DESCRIPTION.to_owned(), content: fmu.description.into_bytes() },
        Entry { name: library::path(&fmu.name)?, content: library.to_vec() },
        Entry { name: format!("resources/{}", fmu.file), content: definition },
        Entry { name: format!("resources/{schema}"), content: schema::text(workspace, fmu.file)? },
    ]);
    // A file of the user's own says more than the generated one.
    if let Some(text) = fmu.terminals.filter(|_| entries.iter().all(|entry| entry.name != terminals::PATH)) {
        entries.push(Entry { name: terminals::PATH.to_owned(), content: text.into_bytes() });
    }
    entries.extend(binaries.iter().map(|binary| binary.entry(&fmu.name)));
    let path = out.join(format!("{}.fmu", fmu.name));
    archive::write(&path, entries)?;
    let size = fs::metadata(&path)?.len().div_ceil(1024);
    println!("{} ({size} KiB, {} variables)", path.display(), fmu.interface.list().len());
    Ok(path)
}

fn write_if_changed(path: &Path, text: &str) -> Result<()> {
    if fs::read(path).is_ok_and(|present| present == text.as_bytes()) {
        return Ok(());
    }
    files::replace(path, text.as_bytes())?;
    println!("{} (generated anew)", path.display());
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The committed descriptions are what the engine says today.
    #[test]
    fn committed_descriptions_are_current() {
        let workspace = Workspace::locate();
        let folders = workspace.description_folders().unwrap();
        assert!(folders.iter().any(|folder| folder.ends_with(DEFAULT_FMU)), "{folders:?}");
        for folder in folders {
            let expected = prepare(Source::find(&workspace, &folder).unwrap()).unwrap().description;
            let committed = fs::read_to_string(folder.join(MODEL_DESCRIPTION)).unwrap_or_default();
            assert!(
                committed == expected,
                "{}/{MODEL_DESCRIPTION} is out of date; run `cargo fmu package --all` and commit it",
                folder.display()
            );
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
    fn a_path_without_a_definition_is_refused_with_the_remedy() {
        let workspace = Workspace::locate();
        let message = |path: &str| Source::find(&workspace, &workspace.root().join(path)).unwrap_err().to_string();
        assert!(message("nowhere").ends_with(
            "there is no such file or folder; name a mechanism.json or a hydraulics.json or a folder that holds one"
        ));
        assert!(message("fmu-build").ends_with("put the definition there"));
    }
}
