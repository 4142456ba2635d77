//! One model as the user names it: a definition file such as `mechanism.json`, or a folder that holds one.
//!
//! In: a path. Out: the definition's kind and text, and the files that accompany it in the FMU.

use crate::archive::Entry;
use crate::workspace::Workspace;
use anyhow::{Context, Result, bail};
use linkage_fmu::component::Component;
use std::fs;
use std::path::{Path, PathBuf};

/// What a folder may hold besides the definition, under the names that FMI 2.0.5 (2.1, 2.5) gives them.
const COMPANIONS: [&str; 5] = ["documentation", "extra", "licenses", "model.png", "terminalsAndIcons"];

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
    /// There is nothing there, or a device, a pipe or the like, or a folder without a definition or
    /// with several.
    pub fn find(workspace: &Workspace, path: &Path) -> Result<Self> {
        if path.is_file() {
            return Ok(match described_folder(workspace, path) {
                Some(folder) => Self::in_folder(workspace, &folder, path.to_path_buf()),
                None => Self { definition: path.to_path_buf(), folder: None, keeps_description: false },
            });
        }
        let files = Component::definition_files();
        if !path.is_dir() {
            let fault = if path.exists() { "this is no regular file" } else { "there is no such file or folder" };
            bail!("{}: {fault}; name a {} or a folder that holds one", path.display(), files.join(" or a "));
        }
        let places = |file| [path.join("resources").join(file), path.join(file)];
        let mut found = files.into_iter().filter_map(|file| places(file).into_iter().find(|place| place.is_file()));
        match (found.next(), found.next()) {
            (Some(definition), None) => Ok(Self::in_folder(workspace, path, definition)),
            (Some(one), Some(other)) => {
                bail!("{} and {}: an FMU has one definition; remove one of them", one.display(), other.display())
            }
            (None, _) => bail!(
                "{}: the folder holds no {}, and its resources neither; put the definition there",
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
    /// `gear.mechanism.json`, else the first.
    pub fn kind(&self) -> &'static str {
        let own = self.definition.file_name().unwrap_or_default().to_string_lossy();
        let files = Component::definition_files();
        files.into_iter().find(|file| own.ends_with(file)).unwrap_or(files[0])
    }

    /// The definition's text.
    ///
    /// # Errors
    /// The file cannot be read or is not UTF-8.
    pub fn text(&self) -> Result<String> {
        let path = self.definition.display();
        let bytes = fs::read(&self.definition).with_context(|| format!("{path}: cannot be read"))?;
        String::from_utf8(bytes).ok().with_context(|| format!("{path}: is not UTF-8 text; save it as UTF-8"))
    }

    /// The accompanying files under their names in the FMU; hidden files stay out.
    ///
    /// # Errors
    /// A file cannot be read, or its name is not UTF-8.
    pub fn companions(&self) -> Result<Vec<Entry>> {
        let mut entries = Vec::new();
        if let Some(folder) = &self.folder {
            for name in COMPANIONS {
                collect(&folder.join(name), name, &mut entries)?;
            }
        }
        Ok(entries)
    }
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
    parent.is_some_and(|parent| workspace.descriptions().canonicalize().is_ok_and(|folder| folder == parent))
}

fn collect(path: &Path, name: &str, entries: &mut Vec<Entry>) -> Result<()> {
    if path.is_file() {
        let content = fs::read(path).with_context(|| format!("{}: cannot be read", path.display()))?;
        entries.push(Entry { name: name.to_owned(), content });
    } else if path.is_dir() {
        for entry in fs::read_dir(path).with_context(|| format!("{}: cannot be listed", path.display()))? {
            let child = entry?.path();
            let Some(file_name) = child.file_name().and_then(|file_name| file_name.to_str()) else {
                bail!("{}: the name is not UTF-8; rename the file", child.display());
            };
            if !file_name.starts_with('.') {
                collect(&child, &format!("{name}/{file_name}"), entries)?;
            }
        }
    }
    Ok(())
}
