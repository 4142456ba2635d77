//! Child processes that write directly to the terminal, and the Python environment of the tests.

use crate::workspace::Workspace;
use anyhow::{Context, Result};
pub use fmu_cli::python::{cannot_start, demo, environment, run};
use std::env;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The Cargo program that started this program, in the top folder of the repository.
pub fn cargo(workspace: &Workspace) -> Command {
    let mut command = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(workspace.root());
    command
}

/// Interpreter of the environment of the tests and the report.
///
/// # Errors
/// As for [`environment`].
pub fn python(workspace: &Workspace) -> Result<PathBuf> {
    environment(&workspace.target("venv"), &workspace.python_tests().join("requirements.txt"))
}

/// Build another program of the workspace, with the name of its package.
///
/// # Errors
/// The build fails.
pub fn built(workspace: &Workspace, name: &str) -> Result<PathBuf> {
    // Both packages are named. Their dependencies then have the same features, and the engine is not built twice.
    let mut cargo = cargo(workspace);
    cargo.args(["build", "--release", "--quiet", "--package", "fmu-build", "--package", name, "--bin", name]);
    run(&mut cargo, "cargo build")?;
    Ok(env::current_exe()?.with_file_name(format!("{name}{}", env::consts::EXE_SUFFIX)))
}

/// Open a file or an address in the user's browser.
///
/// # Errors
/// There is no browser that opens the page.
pub fn show(page: impl AsRef<OsStr>) -> Result<()> {
    let page = page.as_ref();
    open::that_detached(page).with_context(|| {
        format!("{}: no browser could open this page; open the page in a browser", Path::new(page).display())
    })
}
