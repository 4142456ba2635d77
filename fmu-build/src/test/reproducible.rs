//! The same source gives the same library in any folder.
//!
//! In: the repository. Out: a line, and an error if a copy of the repository in another folder gives other bytes.

use crate::binary;
use crate::library::served;
use crate::workspace::Workspace;
use crate::{command, files};
use anyhow::{Context, Result, bail};
use std::env::consts::DLL_EXTENSION;
use std::fs;
use std::path::{Path, PathBuf};

/// Parts of the repository for a build. Cargo reads the descriptions of the other packages too.
const PARTS: [&str; 6] = ["Cargo.toml", "Cargo.lock", "src", "fmu-build", "validation", "modelDescription"];
/// Folder of the copy. Its name has another length than that of the repository.
const COPY: &str = "a copy of the repository, somewhere else";

/// Build the library here and in a copy of the repository, with separate target folders, and compare.
///
/// # Errors
/// A build fails, or the bytes differ. The message contains the first difference.
pub fn run(workspace: &Workspace) -> Result<()> {
    let folder = workspace.target("platforms").join("reproducible");
    let copy = folder.join(COPY);
    if copy.is_dir() {
        fs::remove_dir_all(&copy).with_context(|| format!("{}: cannot be removed", copy.display()))?;
    }
    for part in PARTS {
        files::copy_all(&workspace.root().join(part), &copy.join(part))?;
    }
    let here = build(workspace, workspace.root(), &folder.join("target-here"))?;
    let there = build(workspace, &copy, &folder.join("target-in-the-copy"))?;
    binary::exports_fmi_only(&here)?;
    if let Some(place) = first_difference(&here, &there) {
        bail!(
            "the library differs between two folders of the same source from byte {place} on; look for a path in \
             the library"
        );
    }
    println!(
        "the libraries that were built from copies of the source in two folders are identical, with {} bytes",
        here.len()
    );
    Ok(())
}

/// The library that is built from the repository in `root`.
fn build(workspace: &Workspace, root: &Path, target: &Path) -> Result<Vec<u8>> {
    let mut cargo = command::cargo(workspace);
    // Cargo passes the folder of the running program to its child processes.
    cargo.current_dir(root).env_remove("CARGO_MANIFEST_DIR").env("CARGO_TARGET_DIR", target);
    cargo.args(["build", "--release", "--quiet", "--package", served::MECHANISMS.package, "--lib"]);
    command::run(&mut cargo, "cargo build")?;
    let prefix = if cfg!(windows) { "" } else { "lib" };
    let path: PathBuf = target.join("release").join(format!("{prefix}{}.{DLL_EXTENSION}", served::MECHANISMS.name));
    fs::read(&path).with_context(|| format!("{}: cannot be read", path.display()))
}

/// Index of the first byte in which two files differ. The length of the shorter file if it is a prefix of the longer
/// one.
fn first_difference(a: &[u8], b: &[u8]) -> Option<usize> {
    let first = a.iter().zip(b).position(|(a, b)| a != b);
    first.or_else(|| (a.len() != b.len()).then(|| a.len().min(b.len())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_difference_is_found() {
        assert_eq!(first_difference(b"abc", b"abc"), None);
        assert_eq!(first_difference(b"abc", b"abd"), Some(2));
        assert_eq!(first_difference(b"abc", b"ab"), Some(2));
    }
}
