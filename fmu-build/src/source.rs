//! One model that the user names: a definition file such as `mechanism.json`, or a folder that contains one.
//!
//! In: a path. Out: kind and text of the definition, and the additional files for the FMU.

use crate::archive::{Entry, MODEL_DESCRIPTION};
use crate::fmu::{self, Definition, Fmu, RESOURCES};
use crate::workspace::Workspace;
use crate::{files, names, shared};
use anyhow::{Context, Result, bail};
use linkage_fmu::component::Component;
use linkage_fmu::fmi::LARGEST_DEFINITION;
use linkage_fmu::format::parse;
use std::fs;
use std::path::{Path, PathBuf};

/// Files and folders that a folder may contain besides the definition, with their names in FMI 2.0.5 (2.1, 2.5).
const COMPANIONS: [&str; 5] = ["documentation", "extra", "licenses", "model.png", "terminalsAndIcons"];

/// Text about a model, which is added to the page of its FMU.
const README: &str = "README.md";
/// Files of the folder of a model that are not copied to its FMU, or are generated for the FMU.
const OF_THE_FOLDER: [&str; 2] = [README, MODEL_DESCRIPTION];
/// First bytes of a zip.
const ZIP: &[u8] = b"PK\x03\x04";
/// Largest text about a model [bytes].
const LARGEST_README: u64 = 1 << 20;

/// The additional files of a definition.
#[derive(Debug, Default)]
pub struct Companions {
    /// Files for the FMU, with their names in the FMU.
    pub entries: Vec<Entry>,
    /// Omitted files and folders, by their paths in the model's folder: hidden ones, and those with names that FMI does
    /// not define.
    pub left_out: Vec<String>,
}

/// A definition on disk.
#[derive(Debug)]
pub struct Source {
    /// The definition file.
    pub definition: PathBuf,
    /// Folder with documentation, icon and similar files. None if the user names a definition file.
    pub folder: Option<PathBuf>,
    /// Whether the folder is one of `modelDescription/`, which contains its generated `modelDescription.xml`.
    pub keeps_description: bool,
}

impl Source {
    /// Find the definition at `path`.
    ///
    /// # Errors
    /// The path does not exist, or is a device, a pipe or similar, or a folder without a definition, with several
    /// definitions, or with a link instead of a definition.
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
        // An object that is no file is found too, and rejected with its name.
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

    /// Name of the definition file of this kind of model in an FMU: the end of the file's own name, as in
    /// `gear.mechanism.json`, else by the keys in the file, else the first name.
    pub fn kind(&self) -> &'static str {
        let own = self.definition.file_name().unwrap_or_default().to_string_lossy();
        let files = Component::definition_files();
        let by_keys =
            || Component::kind_of(&String::from_utf8(files::read(&self.definition, LARGEST_DEFINITION).ok()?).ok()?);
        files.into_iter().find(|file| own.ends_with(file)).or_else(by_keys).unwrap_or(files[0])
    }

    /// The text of the definition, with the contents of the file of shared parameters that it names.
    ///
    /// # Errors
    /// The file cannot be read, is larger than the limit of an FMU, or is not UTF-8.
    pub fn text(&self) -> Result<String> {
        let path = self.definition.display();
        let bytes = files::read(&self.definition, LARGEST_DEFINITION)?;
        match String::from_utf8(bytes) {
            Ok(text) => {
                check_content("mechanism", &text).with_context(|| path.to_string())?;
                shared::completed(&self.definition, text)
            }
            Err(error) if error.as_bytes().starts_with(ZIP) => bail!("{path}: {}", of_archive(&self.definition)),
            Err(_) => bail!("{path}: the file is not UTF-8 text; save the file as UTF-8"),
        }
    }

    /// The Markdown text next to the definition. None if the user names a definition file.
    ///
    /// # Errors
    /// The file is no regular file, is too large, or is not UTF-8.
    pub fn readme(&self) -> Result<Option<String>> {
        let Some(path) = self.folder.as_ref().map(|folder| folder.join(README)) else { return Ok(None) };
        match fs::symlink_metadata(&path) {
            Err(_) => Ok(None),
            Ok(metadata) if !metadata.is_file() => Err(refused(&path, &metadata)),
            Ok(_) => {
                let text = String::from_utf8(files::read(&path, LARGEST_README)?).ok();
                text.map(Some)
                    .with_context(|| format!("{}: the file is not UTF-8 text; save the file as UTF-8", path.display()))
            }
        }
    }

    /// The additional files. Each file or folder with a name of the standard is packed or rejected, except hidden ones.
    ///
    /// # Errors
    /// An object is neither file nor folder, such as a symbolic link, a pipe or a device; a file cannot be read; a name
    /// is not UTF-8, or is invalid on some system.
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
    /// The path contains no definition, or it cannot be read.
    pub fn read(workspace: &Workspace, path: &Path) -> Result<Self> {
        if fmu::is_fmu(path) {
            return Fmu::open(path)?.definition();
        }
        let source = Source::find(workspace, path)?;
        Ok(Self { shown: source.definition.display().to_string(), kind: source.kind(), text: source.text()? })
    }
}

/// Check that a JSON file is not a file of another kind than this one: a mechanism, a study or a system.
///
/// # Errors
/// The file has the keys of another kind. The message names the command for it.
pub fn check_content(wanted: &str, text: &str) -> Result<()> {
    const KINDS: [(&str, &str, &str); 3] = [
        ("mechanism", "bodies", "use the command `simulate`, `check` or `package`"),
        ("study", "responses", "use the command `sweep` or `optimise`"),
        ("system", "fmus", "use the command `package` with the option --ssp"),
    ];
    let Ok(root) = parse("file", text) else { return Ok(()) };
    let mut kinds = KINDS.iter().filter(|(_, key, _)| root.member(key).is_some());
    match (kinds.next(), kinds.next()) {
        (Some((kind, _, remedy)), None) if *kind != wanted => bail!("this file is a {kind}, not a {wanted}; {remedy}"),
        _ => Ok(()),
    }
}

/// Message about a zip instead of a definition, with a remedy.
fn of_archive(path: &Path) -> String {
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    match extension.as_str() {
        "fmu" => {
            format!(
                "this is a packed FMU; unpack the FMU, and give the path of the definition in its folder {RESOURCES}"
            )
        }
        "ssp" => format!(
            "this is a system of FMUs; unpack the system, and give the path of one of the FMUs in its folder \
                {RESOURCES}"
        ),
        _ => "this is an archive; give the path of a definition, or of an FMU, whose name ends in .fmu".to_owned(),
    }
}

/// Message about a file whose name differs from that of a definition only by case, with a remedy.
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

/// Some of these names, and the number of the others.
pub fn listed(names: &[String]) -> String {
    const SHOWN: usize = 10;
    let mut text = names[..names.len().min(SHOWN)].join(", ").escape_debug().to_string();
    if names.len() > SHOWN {
        text.push_str(&format!(" and {} more", names.len() - SHOWN));
    }
    text
}

/// The folder of `modelDescription/` whose resources contain this definition file.
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

/// Error for an object that is neither file nor folder.
fn refused(path: &Path, metadata: &fs::Metadata) -> anyhow::Error {
    let (shown, kind) = (path.display(), files::kind(metadata));
    anyhow::anyhow!("{shown}: this is {kind}; replace the entry by a regular file, or remove the entry")
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

/// Add a file, or the contents of a folder, with this name in the FMU. The names are checked during the search, so that
/// the length of a path limits its depth.
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

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::check_content;

    #[test]
    fn a_file_of_another_kind_is_named() {
        let [gear, study, system] = ["bodies", "responses", "fmus"].map(|key| format!("{{ \"{key}\": {{}} }}"));
        for (wanted, text, said) in [
            ("study", &gear, "this file is a mechanism, not a study; use the command `simulate`"),
            ("system", &gear, "this file is a mechanism, not a system"),
            ("mechanism", &study, "this file is a study, not a mechanism; use the command `sweep`"),
            ("mechanism", &system, "this file is a system, not a mechanism; use the command `package` with"),
        ] {
            assert!(check_content(wanted, text).unwrap_err().to_string().starts_with(said), "{text}");
        }
        for text in [study.as_str(), "{}", "no JSON"] {
            check_content("study", text).unwrap();
        }
    }
}
