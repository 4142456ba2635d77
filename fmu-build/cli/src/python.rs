//! Python's virtual environments, made once and renewed when the pinned requirements change.
//!
//! In: a folder, requirements. Out: the interpreter of an environment in this folder that has them. It must not know
//! what runs there.

use anyhow::{Context, Result, bail};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

/// Environment variable that names another interpreter of Python.
const INTERPRETER: &str = "PYTHON";
/// File in a virtual environment that says what it was made from.
const STAMP: &str = "made-from.txt";
/// First line of requirements that name all that is used: what they themselves ask for besides is left out.
const COMPLETE: &str = "# complete";

/// Run to the end.
///
/// # Errors
/// The program cannot be started, or it ends with anything but success; `task` names it in the message.
pub fn run(command: &mut Command, task: &str) -> Result<()> {
    let status = command.status().with_context(|| cannot_start(command, task))?;
    if !status.success() {
        bail!("{task} failed ({status}); its own messages are above");
    }
    Ok(())
}

/// Message for a program that cannot be started.
pub fn cannot_start(command: &Command, task: &str) -> String {
    format!("{task}: {} cannot be started; check that it is installed and on the PATH", command.get_program().display())
}

/// Interpreter of the environment of the demo, in a folder for environments, with the requirements in the folder of the
/// scripts.
///
/// # Errors
/// As for [`environment`].
pub fn demo(environments: &Path, scripts: &Path) -> Result<PathBuf> {
    environment(&environments.join("venv-demo"), &scripts.join("demo.txt"))
}

/// Interpreter of the environment in `folder` with these requirements, ready to use.
///
/// # Errors
/// There is no interpreter, it has no `venv`, or the requirements cannot be installed.
pub fn environment(folder: &Path, requirements: &Path) -> Result<PathBuf> {
    let python = folder.join(if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" });
    let pinned = fs::read_to_string(requirements).with_context(|| {
        format!("{}: cannot be read; restore this file from the repository", requirements.display())
    })?;
    let interpreter = env::var_os(INTERPRETER)
        .filter(|name| !name.is_empty())
        .unwrap_or_else(|| OsString::from(if cfg!(windows) { "python" } else { "python3" }));
    let wanted = format!("{}\n{pinned}", interpreter.display());
    let stamp = folder.join(STAMP);
    if python.is_file() && fs::read_to_string(&stamp).is_ok_and(|made_from| made_from == wanted) {
        return Ok(python);
    }
    println!("creating the Python environment {}: about half a minute, only once", folder.display());
    run(Command::new(&interpreter).args(["-m", "venv", "--clear"]).arg(folder), "python -m venv").context(format!(
        "{}: the virtual environment cannot be created; install Python 3.11 or later with venv (Debian: apt-get \
         install python3-venv), or give the path of an interpreter in {INTERPRETER}",
        interpreter.display()
    ))?;
    let mut pip = Command::new(&python);
    pip.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]);
    // Python compiles what a script imports, and most of what is installed is never imported.
    pip.arg("--no-compile");
    if pinned.starts_with(COMPLETE) {
        pip.arg("--no-deps");
    }
    pip.arg("--requirement").arg(requirements);
    run(&mut pip, "pip install")?;
    fs::write(&stamp, wanted).with_context(|| format!("{}: cannot be written", stamp.display()))?;
    Ok(python)
}
