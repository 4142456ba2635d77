//! Python's virtual environments. They are created once and renewed when the pinned requirements change.
//!
//! In: a folder, requirements. Out: the interpreter of an environment in this folder with these requirements. The
//! module must not know the scripts.

use anyhow::{Context, Result, bail};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::OnceLock;
use std::{env, fs, io};

/// Environment variable that names another interpreter of Python.
const INTERPRETER: &str = "PYTHON";
/// File in a virtual environment with the requirements for which it was created.
const STAMP: &str = "made-from.txt";
/// First line of requirements that list all used packages: pip does not install further dependencies.
const COMPLETE: &str = "# complete";
/// Line of requirements with the name of the wheel's extra, the packages that the scripts import, and their size on
/// disk.
const EXTRA: &str = "# extra ";
const SIZE: &str = "# size: ";
/// Exits with success if Python has the packages of its arguments.
const HAS: &str = "import sys, importlib.metadata as m; [m.version(name) for name in sys.argv[1:]]";

/// Interpreter in which the package of this program is installed, if there is one.
static OWN: OnceLock<PathBuf> = OnceLock::new();

/// State the interpreter in which the package of this program is installed.
pub fn runs_in(interpreter: PathBuf) {
    let _ = OWN.set(interpreter);
}

/// Run a program to its end.
///
/// # Errors
/// The program cannot be started, or does not exit with success. `task` is its name in the message.
pub fn run(command: &mut Command, task: &str) -> Result<()> {
    let status = command.status().with_context(|| cannot_start(command, task))?;
    if !status.success() {
        bail!("{task} failed ({status}); the messages above state the reason");
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

/// Name of the extra of the wheel for these requirements, and the packages in it.
fn extra(pinned: &str) -> Option<(&str, Vec<&str>)> {
    let (name, packages) = pinned.lines().find_map(|line| line.strip_prefix(EXTRA))?.split_once(':')?;
    Some((name, packages.split_whitespace().collect()))
}

/// Interpreter of the environment in which this program is installed, if it has the packages of the extra.
fn own(pinned: &str) -> Option<PathBuf> {
    let (_, packages) = extra(pinned)?;
    OWN.get().filter(|python| has(python, &packages)).cloned()
}

fn has(python: &Path, packages: &[&str]) -> bool {
    let mut command = Command::new(python);
    command.args(["-c", HAS]).args(packages).stdout(Stdio::null()).stderr(Stdio::null());
    command.status().is_ok_and(|status| status.success())
}

/// Message with the folder, the size and the duration of the installation.
fn announcement(folder: &Path, pinned: &str) -> String {
    let size = pinned.lines().find_map(|line| line.strip_prefix(SIZE));
    let size = size.map_or_else(String::new, |size| format!("{size} on disk, "));
    let instead = match extra(pinned) {
        Some((name, _)) => format!(
            "; if you installed linkage-fmu with pip, you can run `pip install \"linkage-fmu[{name}]\"` instead"
        ),
        None => String::new(),
    };
    format!("creating the Python environment {}: {size}about half a minute, only once{instead}", folder.display())
}

/// Lock file next to a folder. One process at a time has the lock, others wait. Dropping the file releases the lock.
fn locked(folder: &Path) -> io::Result<fs::File> {
    fs::create_dir_all(folder.parent().unwrap_or(folder))?;
    let file = fs::File::create(folder.with_extension("lock"))?;
    file.lock()?;
    Ok(file)
}

/// Python interpreter with these requirements: that of this program if it has the extra, or that of the virtual
/// environment in `folder`. The virtual environment is created if it does not exist.
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
    if let Some(own) = own(&pinned) {
        return Ok(own);
    }
    let stamp = folder.join(STAMP);
    let is_ready = || python.is_file() && fs::read_to_string(&stamp).is_ok_and(|made_from| made_from == wanted);
    if is_ready() {
        return Ok(python);
    }
    // Another process may be creating the environment. The first process creates it, the others wait.
    let _lock = locked(folder).with_context(|| format!("{}: cannot be created", folder.display()))?;
    if is_ready() {
        return Ok(python);
    }
    println!("{}", announcement(folder, &pinned));
    run(Command::new(&interpreter).args(["-m", "venv", "--clear"]).arg(folder), "python -m venv").context(format!(
        "{}: the virtual environment cannot be created; install Python 3.11 or later with venv (Debian: apt-get \
         install python3-venv), or give the path of an interpreter in {INTERPRETER}",
        interpreter.display()
    ))?;
    let mut pip = Command::new(&python);
    pip.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]);
    // Python compiles imported modules when they are needed. Most of the installed modules are never imported.
    pip.arg("--no-compile");
    if pinned.starts_with(COMPLETE) {
        pip.arg("--no-deps");
    }
    pip.arg("--requirement").arg(requirements);
    run(&mut pip, "pip install")?;
    fs::write(&stamp, &wanted).with_context(|| format!("{}: cannot be written", stamp.display()))?;
    Ok(python)
}

#[cfg(test)]
mod tests {
    use super::*;

    const PINNED: &str = "# complete\n# extra plot: FMPy numpy\n# size: 230 MB\nFMPy==0.3.32\nnumpy==2.4.6\n";

    #[test]
    fn requirements_contain_their_extra_and_size() {
        assert_eq!(extra(PINNED), Some(("plot", vec!["FMPy", "numpy"])));
        assert_eq!(extra("numpy==2.4.6\n"), None);
        let text = announcement(Path::new("venv"), PINNED);
        assert_eq!(
            text,
            "creating the Python environment venv: 230 MB on disk, about half a minute, only once; if you \
             installed linkage-fmu with pip, you can run `pip install \"linkage-fmu[plot]\"` instead"
        );
        assert!(announcement(Path::new("venv"), "mkdocs==1\n").ends_with("venv: about half a minute, only once"));
    }

    #[test]
    #[cfg(unix)]
    fn packages_are_looked_up_in_the_interpreter() {
        let python = Path::new("python3");
        assert!(has(python, &[]));
        assert!(!has(python, &["no-package-of-this-name"]));
        assert!(!has(Path::new("no-interpreter-of-this-name"), &[]));
        assert_eq!(own(PINNED), None, "no interpreter runs a test");
    }
}
