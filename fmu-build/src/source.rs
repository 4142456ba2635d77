//! One model as the user names it: a definition file such as `mechanism.json`, or a folder that holds one.
//!
//! In: a path. Out: the definition's kind and text, and the files that accompany it in the FMU.

use crate::archive::{Entry, MODEL_DESCRIPTION};
use crate::fmu::{self, Definition, Fmu, RESOURCES};
use crate::workspace::Workspace;
use crate::{files, names, shared};
use anyhow::{Context, Result, bail};
use linkage_fmu::component::Component;
use linkage_fmu::fmi::LARGEST_DEFINITION;
use std::fs;
use std::path::{Path, PathBuf};

/// What a folder may hold besides the definition, under the names that FMI 2.0.5 (2.1, 2.5) gives them.
const COMPANIONS: [&str; 5] = ["documentation", "extra", "licenses", "model.png", "terminalsAndIcons"];

/// Text about a model, which goes into the page of its FMU.
const README: &str = "README.md";
/// What belongs to the folder of a model and not to its FMU as a file, or is made anew for the FMU.
const OF_THE_FOLDER: [&str; 2] = [README, MODEL_DESCRIPTION];
/// Beginning of a zip.
const ZIP: &[u8] = b"PK\x03\x04";
/// Largest text about a model [bytes].
const LARGEST_README: u64 = 1 << 20;

/// The files that accompany a definition.
#[derive(Debug, Default)]
pub struct Companions {
    /// Those that go into the FMU, under their names there.
    pub entries: Vec<Entry>,
    /// Files and folders that stay out, by their paths from the model's folder: hidden ones, and those under names to
    /// which FMI gives no meaning.
    pub left_out: Vec<String>,
}

/// A definition on disk.
#[derive(Debug)]
pub struct Source {
    /// The definition file.
    pub definition: PathBuf,
    /// Folder with documentation, icon and the like; none for a definition file named by itself.
    pub folder: Option<PathBuf>,
    /// Whether the folder is one of `modelDescription/`, which keeps its generated `modelDescription.xml`.
    pub keeps_description: bool,
}

impl Source {
    /// Find the definition that `path` names.
    ///
    /// # Errors
    /// There is nothing there, or a device, a pipe or the like, or a folder without a definition or with several, or
    /// with a link in the place of one.
    pub fn find(workspace: &Workspace, path: &Path) -> Result<Self> {
        if path.is_file() {
            return Ok(match described_folder(workspace, path) {
                Some(folder) => Self::in_folder(workspace, &folder, path.to_path_buf()),
                None => Self { definition: path.to_path_buf(), folder: None, keeps_description: false },
            });
        }
        let files = Component::definition_files();
        if !path.is_dir() {
            let fault = if path.exists() { "this is not a regular file" } else { "there is no such file or folder" };
            bail!(
                "{}: {fault}; give the path of a {}, or of a folder that contains one of these files",
                path.display(),
                files.join(" or a ")
            );
        }
        let places = |file| [path.join(RESOURCES).join(file), path.join(file)];
        // What is no file is found too, and refused by name.
        let stands = |place: &PathBuf| fs::symlink_metadata(place).is_ok();
        let mut found = files.into_iter().filter_map(|file| places(file).into_iter().find(stands));
        match (found.next(), found.next()) {
            (Some(definition), None) => {
                for part in [&path.join(RESOURCES), &definition] {
                    match fs::symlink_metadata(part) {
                        Ok(metadata) if part == &definition && !metadata.is_file() => {
                            return Err(refused(&definition, &metadata));
                        }
                        Ok(metadata) if metadata.is_symlink() => return Err(refused(part, &metadata)),
                        _ => {}
                    }
                }
                Ok(Self::in_folder(workspace, path, definition))
            }
            (Some(one), Some(other)) => {
                bail!("{} and {}: an FMU has one definition; remove one file", one.display(), other.display())
            }
            (None, _) if let Some(near) = near_miss(path, &files) => bail!("{near}"),
            (None, _) => bail!(
                "{}: the folder contains no {}, neither directly nor in the folder resources; put the definition in \
                 one of these folders",
                path.display(),
                files.join(" or ")
            ),
        }
    }

    fn in_folder(workspace: &Workspace, folder: &Path, definition: PathBuf) -> Self {
        let keeps_description = is_same(folder.canonicalize().ok().as_deref().and_then(Path::parent), workspace);
        Self { definition, folder: Some(folder.to_path_buf()), keeps_description }
    }

    /// Name of the definition file of this kind of model in an FMU: the one that ends the file's own name, as in
    /// `gear.mechanism.json`, else the one that the keys in the file tell, else the first.
    pub fn kind(&self) -> &'static str {
        let own = self.definition.file_name().unwrap_or_default().to_string_lossy();
        let files = Component::definition_files();
        let told =
            || Component::kind_of(&String::from_utf8(files::read(&self.definition, LARGEST_DEFINITION).ok()?).ok()?);
        files.into_iter().find(|file| own.ends_with(file)).or_else(told).unwrap_or(files[0])
    }

    /// The definition's text, with the contents of the file of shared parameters that it names.
    ///
    /// # Errors
    /// The file cannot be read, is larger than an FMU reads, or is not UTF-8.
    pub fn text(&self) -> Result<String> {
        let path = self.definition.display();
        let bytes = files::read(&self.definition, LARGEST_DEFINITION)?;
        match String::from_utf8(bytes) {
            Ok(text) => shared::completed(&self.definition, text),
            Err(error) if error.as_bytes().starts_with(ZIP) => bail!("{path}: {}", of_archive(&self.definition)),
            Err(_) => bail!("{path}: is not UTF-8 text; save the file as UTF-8"),
        }
    }

    /// The text about the model beside its definition, in Markdown; none of a definition file named by itself.
    ///
    /// # Errors
    /// What stands there is no regular file, is too large, or is not UTF-8.
    pub fn readme(&self) -> Result<Option<String>> {
        let Some(path) = self.folder.as_ref().map(|folder| folder.join(README)) else { return Ok(None) };
        match fs::symlink_metadata(&path) {
            Err(_) => Ok(None),
            Ok(metadata) if !metadata.is_file() => Err(refused(&path, &metadata)),
            Ok(_) => {
                let text = String::from_utf8(files::read(&path, LARGEST_README)?).ok();
                text.map(Some).with_context(|| format!("{}: is not UTF-8 text; save the file as UTF-8", path.display()))
            }
        }
    }

    /// The accompanying files. Each that stands under a name of the standard is packed or refused, but for hidden ones.
    ///
    /// # Errors
    /// What stands there is neither file nor folder, such as a symbolic link, a pipe or a device; a file cannot be
    /// read; a name is not UTF-8, or none on some system.
    pub fn companions(&self) -> Result<Companions> {
        let mut all = Companions::default();
        let Some(folder) = &self.folder else { return Ok(all) };
        for name in names_in(folder)? {
            let path = folder.join(&name);
            if COMPANIONS.contains(&name.as_str()) {
                collect(&path, &name, &mut all)?;
            } else if name == RESOURCES && path.is_dir() {
                let others = names_in(&path)?.into_iter().filter(|name| path.join(name) != self.definition);
                all.left_out.extend(others.map(|other| format!("{name}/{other}")));
            } else if path != self.definition && !OF_THE_FOLDER.contains(&name.as_str()) {
                all.left_out.push(name);
            }
        }
        Ok(all)
    }
}

impl Definition {
    /// The definition in a file, in a folder, or in an FMU.
    ///
    /// # Errors
    /// The path leads to no definition; what is there cannot be read.
    pub fn read(workspace: &Workspace, path: &Path) -> Result<Self> {
        if fmu::is_fmu(path) {
            return Fmu::open(path)?.definition();
        }
        let source = Source::find(workspace, path)?;
        Ok(Self { shown: source.definition.display().to_string(), kind: source.kind(), text: source.text()? })
    }
}

/// What a zip in the place of a definition is, and what to name instead.
fn of_archive(path: &Path) -> String {
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    match extension.as_str() {
        "fmu" => {
            format!("this is a packed FMU; unpack it, and give the path of the definition in its folder {RESOURCES}")
        }
        "ssp" => format!(
            "this is a system of FMUs; unpack it, and give the path of one of the FMUs in its folder {RESOURCES}"
        ),
        _ => "this is an archive; give the path of a definition, or of an FMU, whose name ends in .fmu".to_owned(),
    }
}

/// A file in a folder whose name differs from that of a definition by case only, with what to do.
fn near_miss(folder: &Path, files: &[&str]) -> Option<String> {
    for inner in [folder.join(RESOURCES), folder.to_path_buf()] {
        for name in names_in(&inner).unwrap_or_default() {
            if let Some(file) = files.iter().find(|file| file.eq_ignore_ascii_case(&name)) {
                return Some(format!("{}: rename this file to {file}, in small letters", inner.join(name).display()));
            }
        }
    }
    None
}

/// Some of these names, and how many there are besides.
pub fn listed(names: &[String]) -> String {
    const SHOWN: usize = 10;
    let mut text = names[..names.len().min(SHOWN)].join(", ").escape_debug().to_string();
    if names.len() > SHOWN {
        text.push_str(&format!(" and {} more", names.len() - SHOWN));
    }
    text
}

/// The folder of `modelDescription/` among whose resources this definition file is.
fn described_folder(workspace: &Workspace, definition: &Path) -> Option<PathBuf> {
    let full = definition.canonicalize().ok()?;
    let resources = full.parent().filter(|folder| folder.ends_with("resources"))?;
    let folder = resources.parent()?;
    let is_definition = Component::definition_files().iter().any(|file| full.ends_with(file));
    (is_definition && is_same(folder.parent(), workspace)).then(|| folder.to_path_buf())
}

fn is_same(parent: Option<&Path>, workspace: &Workspace) -> bool {
    parent.is_some_and(|parent| workspace.keeps_descriptions(parent))
}

/// Error for what stands in a folder and is neither file nor folder.
fn refused(path: &Path, metadata: &fs::Metadata) -> anyhow::Error {
    let (shown, kind) = (path.display(), files::kind(metadata));
    anyhow::anyhow!("{shown}: this is {kind}; replace it by a regular file, or remove it")
}

/// Names in a folder, in order.
fn names_in(folder: &Path) -> Result<Vec<String>> {
    let unlisted = || format!("{}: cannot be listed", folder.display());
    let mut names = Vec::new();
    for entry in fs::read_dir(folder).with_context(unlisted)? {
        let entry = entry.with_context(unlisted)?;
        let Ok(name) = entry.file_name().into_string() else {
            bail!("{}: the name is not UTF-8; rename the file", entry.path().display());
        };
        names.push(name);
    }
    names.sort_unstable();
    Ok(names)
}

/// Add a file, or all that is in a folder, under this name in the FMU. The names are checked on the way, so that a
/// folder has an end however deep it is.
fn collect(path: &Path, name: &str, all: &mut Companions) -> Result<()> {
    names::check(name)?;
    let metadata = fs::symlink_metadata(path).with_context(|| format!("{}: cannot be read", path.display()))?;
    if metadata.is_file() {
        all.entries.push(Entry { name: name.to_owned(), content: files::read(path, u64::MAX)? });
    } else if metadata.is_dir() {
        for child in names_in(path)? {
            let child_name = format!("{name}/{child}");
            match child.starts_with('.') {
                true => all.left_out.push(child_name),
                false => collect(&path.join(child), &child_name, all)?,
            }
        }
    } else {
        return Err(refused(path, &metadata));
    }
    Ok(())
}
