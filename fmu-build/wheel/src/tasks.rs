//! The tasks of the command line as functions, and the command itself.
//!
//! In: paths, texts, a function to report progress. Out: the result of a task, as JSON or paths, and its printed text.

use crate::arguments::{names, text, truth, whole};
use crate::errors::{detached, guarded, in_python, input, refused};
use anyhow::{Context, Result};
use fmu_build::fmu::Definition;
use fmu_build::workspace::Workspace;
use fmu_build::{check as checking, output, prebuilt, task};
use fmu_studies::progress;
use fmu_studies::simulate::Outcome;
use fmu_studies::sweep::{self as studies, Watch};
use linkage_fmu::component::Component;
use pyo3::prelude::*;
use std::cell::RefCell;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::OnceLock;
use std::sync::atomic::Ordering;

/// Folder of the package.
static PACKAGE: OnceLock<PathBuf> = OnceLock::new();

/// The installation, or the repository for a development build.
fn workspace() -> Result<Workspace> {
    let package = PACKAGE.get().map_or(Path::new("."), PathBuf::as_path);
    match Workspace::installed(package) {
        Err(_) if cfg!(debug_assertions) => Ok(Workspace::locate()),
        other => other,
    }
}

/// State the folder of the package and its interpreter. Returns the folder of its files.
#[pyfunction]
pub fn folder(package: OsString, interpreter: Option<OsString>) -> Option<OsString> {
    // Texts instead of paths: Python's module for paths would take most of the import time.
    let _ = PACKAGE.set(package.into());
    interpreter.into_iter().for_each(|interpreter| fmu_cli::python::runs_in(interpreter.into()));
    prebuilt::set_reader(unpacked);
    workspace().ok().map(|workspace| workspace.root().as_os_str().to_owned())
}

/// A file in an archive, read by Python's module for archives.
fn unpacked(archive: &Path, name: &str) -> Result<Vec<u8>> {
    let read = |py: Python<'_>| -> PyResult<Vec<u8>> {
        let archive = py.import("tarfile")?.call_method1("open", (archive,))?;
        let content = archive.call_method1("extractfile", (name,))?.call_method0("read")?.extract();
        archive.call_method0("close")?;
        content
    };
    Python::attach(read)
        .context("Python's module lzma is needed; install a Python that contains lzma, or give a library with --binary")
}

/// The command with its words, of which the first is the name of the program. Returns the exit code.
#[pyfunction]
pub fn main(py: Python<'_>, words: Vec<OsString>) -> PyResult<u8> {
    detached(py, || {
        let cli = fmu_cli::installed::parse(words);
        let code = match workspace() {
            Ok(workspace) => task::run(&workspace, cli, fmu_studies::task::run),
            Err(error) => task::refused(&error),
        };
        // An exit code cannot be converted to its number.
        let number = (0..=u8::MAX).find(|number| code == ExitCode::from(*number));
        Ok(number.unwrap_or(1))
    })
}

/// Kind, place and text of the definition in a file, a folder or an FMU.
#[pyfunction]
pub fn read(py: Python<'_>, path: PathBuf) -> PyResult<(&'static str, String, String)> {
    detached(py, || {
        // Only folders of the repository are special, so any workspace can be used.
        let workspace = workspace().unwrap_or_else(|_| Workspace::locate());
        let Definition { shown, kind, text } = Definition::read(&workspace, &path).map_err(input)?;
        Ok((kind, shown, text))
    })
}

/// Name of the definition file of the kind of model that a text describes.
#[pyfunction]
pub fn kind_of(text: &str) -> &'static str {
    Component::kind_of(text).unwrap_or(Component::definition_files()[0])
}

/// Findings and facts of a definition as JSON and as text.
#[pyfunction]
pub fn check(py: Python<'_>, kind: &str, text: String, shown: String) -> PyResult<(String, String)> {
    detached(py, || {
        let checked = checking::check(shown, kind, text).map_err(input)?;
        let words = checking::text(&checked);
        Ok((checking::json(&[checked])[0].to_string(), words))
    })
}

/// Pack definitions. Returns the paths of the FMUs, and the printed text.
#[pyfunction]
pub fn package(
    py: Python<'_>,
    path: PathBuf,
    out: PathBuf,
    fmi: &Bound<'_, PyAny>,
    platforms: &Bound<'_, PyAny>,
    animation: &Bound<'_, PyAny>,
    results: &Bound<'_, PyAny>,
) -> PyResult<(Vec<PathBuf>, String)> {
    let (fmi, platforms) = (text("fmi", fmi)?, names("platforms", platforms)?);
    let (animation, results) = (truth("animation", animation)?, truth("results", results)?);
    detached(py, || {
        let fmi = match &*fmi {
            "2" => fmu_cli::Fmi::Two,
            "3" => fmu_cli::Fmi::Three,
            "both" => fmu_cli::Fmi::Both,
            other => return Err(input(format!("fmi = {other:?}: must be \"2\", \"3\" or \"both\""))),
        };
        let platforms = platforms.iter().map(|name| fmu_cli::Platform::named(name));
        let platforms = platforms.collect::<Result<Vec<_>, _>>().map_err(|why| input(format!("platforms: {why}")))?;
        let arguments = fmu_build::package::Arguments {
            paths: vec![path],
            out: Some(out),
            fmi,
            platforms,
            no_animation: !animation,
            no_results: !results,
            ..Default::default()
        };
        let workspace = workspace().map_err(refused)?;
        let (made, printed) = output::collected(|| fmu_build::package::run(&workspace, &arguments));
        Ok((made.map_err(|error| input(format!("{error:#}\n{printed}").trim_end()))?, printed))
    })
}

/// The interface of a model as text and as JSON.
#[pyfunction]
pub fn info(py: Python<'_>, path: PathBuf) -> PyResult<(String, String)> {
    detached(py, || {
        let workspace = workspace().unwrap_or_else(|_| Workspace::locate());
        fmu_build::info::of(&workspace, &path).map_err(input)
    })
}

/// Errors, warnings and notes about an FMU, as JSON.
#[pyfunction]
pub fn validate(py: Python<'_>, path: PathBuf) -> PyResult<String> {
    detached(py, || {
        let workspace = workspace().unwrap_or_else(|_| Workspace::locate());
        let found = fmu_build::validate::validate(&workspace, &path).map_err(input)?;
        serde_json::to_string(&found).map_err(refused)
    })
}

/// Make the runs of a study into a folder. Returns the printed text. `watch` is called with the number of completed
/// runs and of all runs.
#[pyfunction]
pub fn sweep(
    py: Python<'_>,
    study: PathBuf,
    out: PathBuf,
    threads: Option<&Bound<'_, PyAny>>,
    watch: Option<Py<PyAny>>,
) -> PyResult<String> {
    let threads = number_of_threads(threads)?;
    let arguments = studies::Arguments { study, out: Some(out), csv: true, threads, ..Default::default() };
    observed(py, watch, |workspace, watch| studies::run(workspace, &arguments, Some(watch)))
}

/// Search for the best design of a study into a folder. Returns the printed text. `watch` is called as for [`sweep`].
#[pyfunction]
pub fn optimise(
    py: Python<'_>,
    study: PathBuf,
    out: PathBuf,
    threads: Option<&Bound<'_, PyAny>>,
    watch: Option<Py<PyAny>>,
) -> PyResult<String> {
    let threads = number_of_threads(threads)?;
    let arguments = studies::optimise::Arguments { study, out: Some(out), csv: true, threads, ..Default::default() };
    observed(py, watch, |workspace, watch| studies::optimise::run(workspace, &arguments, Some(watch)))
}

fn number_of_threads(given: Option<&Bound<'_, PyAny>>) -> PyResult<Option<u16>> {
    given.map(|given| whole::<1, { u16::MAX as i64 }>("threads", given).map(|threads| threads as u16)).transpose()
}

/// Make a study with a progress function in Python. Returns the printed text.
fn observed(
    py: Python<'_>,
    watch: Option<Py<PyAny>>,
    make: impl FnOnce(&Workspace, Watch) -> Result<Outcome> + Send,
) -> PyResult<String> {
    detached(py, || {
        let wish = progress::stop_wish_of_host();
        wish.store(false, Ordering::Relaxed);
        let raised: RefCell<Option<PyErr>> = RefCell::new(None);
        let report = |done: u64, all: u64| {
            let call = |py: Python<'_>| -> PyResult<()> {
                py.check_signals()?;
                watch.as_ref().map_or(Ok(()), |watch| watch.call1(py, (done, all)).map(drop))
            };
            if let Err(error) = Python::attach(call) {
                raised.borrow_mut().get_or_insert(error);
                wish.store(true, Ordering::Relaxed);
            }
        };
        let workspace = workspace().unwrap_or_else(|_| Workspace::locate());
        let (outcome, printed) = output::collected(|| make(&workspace, &report));
        match (raised.into_inner(), outcome) {
            (Some(error), _) => Err(error),
            (None, Ok(_)) => Ok(in_python(&printed)),
            (None, Err(error)) => Err(input(error)),
        }
    })
}

/// A panic, for the test that it becomes an exception.
#[pyfunction]
pub fn panics() -> PyResult<()> {
    guarded(|| panic!("for a test"))
}
