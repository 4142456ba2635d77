//! The source distribution: the files of the repository that Cargo and the wheel need, and the build instructions for
//! pip.
//!
//! In: the files that git tracks, the metadata of the wheel. Out: an archive for `pip install` on a machine with Rust.

use super::pack;
use crate::fmu::Fmu;
use crate::workspace::Workspace;
use crate::{command, files};
use anyhow::{Context, Result, ensure};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Folders that no build reads: pictures and measured results.
const LEFT_OUT: [&str; 3] = ["validation/results/", "validation/figures/", "validation/report"];
const PICTURES: [&str; 2] = ["gif", "png"];
/// Build instructions for pip (PEP 517).
const BUILD_SYSTEM: &str = r#"[build-system]
requires = []
build-backend = "source_build"
backend-path = ["fmu-build/wheel"]
"#;

/// Write the source distribution into the folder. None without a git repository, as in a source distribution.
///
/// # Errors
/// git cannot list the files; the wheel has no metadata; the archive cannot be written.
pub fn distribution(workspace: &Workspace, wheel: &Path, out: &Path) -> Result<Option<PathBuf>> {
    if !workspace.root().join(".git").exists() {
        return Ok(None);
    }
    let mut git = Command::new("git");
    let output = git.args(["ls-files", "-z"]).current_dir(workspace.root()).output();
    let output = output.with_context(|| command::cannot_start(&git, "the source distribution"))?;
    ensure!(output.status.success(), "git ls-files failed ({}): the source distribution has no files", output.status);
    let name = format!("linkage_fmu-{}", env!("CARGO_PKG_VERSION"));
    let stage = workspace.target("wheel").join("source");
    files::replace(&stage.join("pyproject.toml"), BUILD_SYSTEM.as_bytes())?;
    files::replace(&stage.join("PKG-INFO"), &metadata(wheel)?)?;
    let mut entries: Vec<_> =
        ["PKG-INFO", "pyproject.toml"].map(|file| (stage.join(file), format!("{name}/{file}"))).into();
    let listed = String::from_utf8_lossy(&output.stdout).into_owned();
    for file in listed.split('\0').filter(|file| is_built(file)) {
        let path = workspace.root().join(file);
        // Files that were deleted and not committed are skipped.
        if path.is_file() {
            entries.push((path, format!("{name}/{file}")));
        }
    }
    let archive = out.join(format!("{name}.tar.gz"));
    pack(workspace, &archive, &entries)?;
    Ok(Some(archive))
}

/// Whether a build may read a file of the repository.
fn is_built(file: &str) -> bool {
    let extension = Path::new(file).extension().unwrap_or_default();
    !file.is_empty()
        && !LEFT_OUT.iter().any(|folder| file.starts_with(folder))
        && !PICTURES.iter().any(|picture| extension == *picture)
}

/// The metadata of the wheel, which are those of the source distribution.
fn metadata(wheel: &Path) -> Result<Vec<u8>> {
    let mut archive = Fmu::open(wheel)?;
    let name = archive.names().iter().find(|name| name.ends_with(".dist-info/METADATA")).cloned();
    let name = name.with_context(|| format!("{}: has no METADATA", wheel.display()))?;
    Ok(archive.read(&name)?.unwrap_or_default())
}
