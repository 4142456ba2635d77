//! `cargo fmu demo --gallery`: films of the mechanisms of `docs/gallery`.
//!
//! In: the definitions in this folder. Out: a GIF of the experiment next to each definition, or in another folder.

use crate::simulate;
use anyhow::{Context, Result};
use fmu_build::files;
use fmu_build::workspace::Workspace;
use std::fs;
use std::path::{Path, PathBuf};

/// Draw all mechanisms of the gallery into this folder. The default is the folder of the gallery.
///
/// # Errors
/// The folder cannot be listed or created, or a run fails.
pub fn run(workspace: &Workspace, out: Option<&Path>) -> Result<()> {
    let gallery = workspace.gallery();
    let out = out.unwrap_or(&gallery);
    files::make_folder(out, "--out")?;
    for path in definitions(workspace)? {
        let name = Path::new(path.file_stem().unwrap_or_default()).with_extension("gif");
        let arguments = simulate::Arguments { path, gif: Some(out.join(name)), ..Default::default() };
        simulate::run(workspace, &arguments)?;
    }
    Ok(())
}

/// The definitions of the gallery, by name.
///
/// # Errors
/// The folder cannot be listed.
pub fn definitions(workspace: &Workspace) -> Result<Vec<PathBuf>> {
    let folder = workspace.gallery();
    let unlisted = || format!("{}: cannot be listed", folder.display());
    let entries = fs::read_dir(&folder).with_context(unlisted)?;
    let mut paths = entries.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>>>().with_context(unlisted)?;
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "json"));
    paths.sort();
    Ok(paths)
}
