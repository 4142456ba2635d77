//! Python's virtual environment, made once and renewed when the pinned requirements change.

use crate::command;
use crate::workspace::Workspace;
use anyhow::{Context, Result};
use std::env;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Environment variable that names another interpreter.
const INTERPRETER: &str = "PYTHON";
/// File in the environment that says what it was made from.
const STAMP: &str = "made-from.txt";

/// Interpreter of the environment of demo and tests, ready to use.
///
/// # Errors
/// As for [`environment_of`].
pub fn environment(workspace: &Workspace) -> Result<PathBuf> {
    environment_of(&workspace.target("venv"), &workspace.python_tests().join("requirements.txt"))
}

/// Interpreter of the environment in `folder` with these requirements, ready to use.
///
/// # Errors
/// There is no interpreter, it has no `venv`, or the requirements cannot be installed.
pub fn environment_of(folder: &Path, requirements: &Path) -> Result<PathBuf> {
    let python = folder.join(if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" });
    let pinned = fs::read_to_string(requirements)
        .with_context(|| format!("{}: cannot be read; restore it from the repository", requirements.display()))?;
    let interpreter = env::var_os(INTERPRETER)
        .filter(|name| !name.is_empty())
        .unwrap_or_else(|| OsString::from(if cfg!(windows) { "python" } else { "python3" }));
    let wanted = format!("{}\n{pinned}", interpreter.display());
    let stamp = folder.join(STAMP);
    if python.is_file() && fs::read_to_string(&stamp).is_ok_and(|made_from| made_from == wanted) {
        return Ok(python);
    }
    println!("making the Python environment {}", folder.display());
    command::run(Command::new(&interpreter).args(["-m", "venv", "--clear"]).arg(folder), "python -m venv").context(
        format!(
            "{}: no virtual environment can be made; install Python 3.11 or later with venv \
             (Debian: apt-get install python3-venv) or name an interpreter in {INTERPRETER}",
            interpreter.display()
        ),
    )?;
    let mut pip = Command::new(&python);
    pip.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--requirement"]).arg(requirements);
    command::run(&mut pip, "pip install")?;
    fs::write(&stamp, wanted).with_context(|| format!("{}: cannot be written", stamp.display()))?;
    Ok(python)
}
