//! Child processes whose output goes straight to the terminal, and the Python environment of the tests.

use crate::workspace::Workspace;
use anyhow::Result;
pub use fmu_cli::python::{cannot_start, demo, environment, run};
use std::env;
use std::path::PathBuf;
use std::process::Command;

/// Cargo, the one that runs this program, in the repository's top folder.
pub fn cargo(workspace: &Workspace) -> Command {
    let mut command = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(workspace.root());
    command
}

/// Interpreter of the environment of the tests and the report, ready to use.
///
/// # Errors
/// As for [`environment`].
pub fn python(workspace: &Workspace) -> Result<PathBuf> {
    environment(&workspace.target("venv"), &workspace.python_tests().join("requirements.txt"))
}

/// Another program of the workspace, built; its name is that of its package.
///
/// # Errors
/// The build fails.
pub fn built(workspace: &Workspace, name: &str) -> Result<PathBuf> {
    // Both packages are named so that dependencies have the features they have for this program, and the engine is not
    // built again for each of the two in turn.
    let mut cargo = cargo(workspace);
    cargo.args(["build", "--release", "--quiet", "--package", "fmu-build", "--package", name, "--bin", name]);
    run(&mut cargo, "cargo build")?;
    Ok(env::current_exe()?.with_file_name(format!("{name}{}", env::consts::EXE_SUFFIX)))
}
