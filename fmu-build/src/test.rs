//! `cargo fmu test`: runs all tests, and stops at the first stage that fails.

mod platforms;
mod reproducible;

use crate::command::Python;
use crate::workspace::Workspace;
use crate::{command, dist, docs, files, package};
use anyhow::{Context, Result};
use fmu_cli::Program;
pub use fmu_cli::Test as Arguments;
use std::panic::resume_unwind;
use std::path::Path;
use std::process::Command;
use std::thread;
use std::time::Instant;

/// Environment variable with the folder of the FMUs, for the Python tests and the browser tests.
const FMU_FOLDER: &str = "LINKAGE_FMU_DIR";
/// Environment variable with the program of the studies, for the documentation pages, whose commands it runs.
const PROGRAM: &str = "LINKAGE_FMU_PROGRAM";
/// Environment variable with the program of the studies, for the browser tests, whose pages it writes.
const VIEW: &str = "LINKAGE_VIEW";
/// Environment variable with the seed of proptest's random cases.
const SEED: &str = "PROPTEST_RNG_SEED";

/// Options of pytest: one process per core, each file in one process.
const SHARED: [&str; 2] = ["--numprocesses=auto", "--dist=loadfile"];

/// First part of the page about the platforms.
const PAGE: &str = include_str!("test/platforms.md");

/// Run all stages, or the requested one.
///
/// # Errors
/// The name of the first stage that fails.
pub fn run(workspace: &Workspace, arguments: &Arguments) -> Result<()> {
    let start = Instant::now();
    if arguments.platforms {
        return stage("libraries for other platforms", || platforms(workspace, arguments));
    }
    if arguments.reproducible {
        return stage("the library from two folders", || reproducible::run(workspace));
    }
    // Packages are downloaded while Cargo builds.
    thread::scope(|scope| {
        let environments =
            scope.spawn(|| Python::ALL.iter().try_for_each(|environment| environment.interpreter(workspace).map(drop)));
        stage("Rust tests", || {
            // The dev profile is optimised too, and its build is faster than a release build.
            let mut cargo = command::cargo(workspace);
            if std::env::var_os(SEED).is_none() {
                // The random cases are equal in every run. `cargo fmu bench attack` uses new ones.
                cargo.env(SEED, "1");
            }
            command::run(cargo.args(["test", "--workspace"]), "cargo test")
        })?;
        stage("Python environments", || environments.join().unwrap_or_else(|panic| resume_unwind(panic)))
    })?;
    stage("packaging", || package::run(workspace, &package::Arguments { all: true, ..Default::default() }).map(drop))?;
    let studies = stage("program of the studies", || command::built(workspace, Program::Studies.name()))?;
    let python = Python::Fmpy.interpreter(workspace)?;
    stage("Python style", || style(workspace, &python))?;
    stage("FMPy tests", || {
        let mut pytest = command::pytest(workspace, &python);
        pytest.args(SHARED).arg(workspace.python_tests());
        pytest.env(FMU_FOLDER, workspace.fmu_folder()).env(PROGRAM, &studies);
        command::run(&mut pytest, "pytest")
    })?;
    stage("documentation site", || docs::run(workspace, &docs::Arguments { open: false }))?;
    stage("wheel", || dist::run(workspace, &dist::Arguments { test: true, ..Default::default() }))?;
    let python = Python::Browser.interpreter(workspace)?;
    stage("browser tests", || {
        let mut pytest = command::pytest(workspace, &python);
        pytest.args(SHARED).arg(workspace.browser_tests());
        pytest.env(VIEW, &studies).env(FMU_FOLDER, workspace.fmu_folder());
        command::run(&mut pytest, "pytest")
    })?;
    println!(
        "all tests passed: Rust, packaging, Python style, FMPy, documentation, wheel, browser ({:.0} s)",
        start.elapsed().as_secs_f64()
    );
    Ok(())
}

/// Run the libraries for other platforms. With `write`, write the page.
fn platforms(workspace: &Workspace, arguments: &Arguments) -> Result<()> {
    let table = platforms::run(workspace, &arguments.binaries)?;
    let page = format!("{PAGE}{table}");
    println!("{page}");
    if arguments.write {
        files::replace(&workspace.results().join("platforms.md"), page.as_bytes())?;
    }
    Ok(())
}

fn style(workspace: &Workspace, python: &Path) -> Result<()> {
    let settings = workspace.python_tests().join("pyproject.toml");
    for task in [&["check"][..], &["format", "--check"]] {
        let mut ruff = Command::new(python);
        ruff.args(["-m", "ruff"]).args(task).arg("--quiet").arg("--config").arg(&settings).arg(".");
        command::run(ruff.current_dir(workspace.root()), &format!("ruff {}", task.join(" ")))?;
    }
    Ok(())
}

fn stage<T>(name: &str, body: impl FnOnce() -> Result<T>) -> Result<T> {
    println!("== {name}");
    let start = Instant::now();
    let result = body().with_context(|| format!("stage '{name}' failed"))?;
    println!("== {name}: {:.0} s", start.elapsed().as_secs_f64());
    Ok(result)
}
