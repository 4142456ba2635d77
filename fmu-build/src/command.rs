//! Child processes that write directly to the terminal, and the Python environments of the tests.

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

/// A Python environment of the tests.
#[derive(Clone, Copy)]
pub enum Python {
    /// FMUs and pages, also of the report and of benchmarks.
    Fmpy,
    /// Documentation site.
    Docs,
    /// Build of wheels.
    Wheel,
    /// Python module.
    Module,
    /// Pages in a browser.
    Browser,
}

impl Python {
    /// All environments.
    pub const ALL: [Self; 5] = [Self::Fmpy, Self::Docs, Self::Wheel, Self::Module, Self::Browser];

    /// Interpreter of the environment, which is created if it does not exist.
    ///
    /// # Errors
    /// As for [`environment`].
    pub fn interpreter(self, workspace: &Workspace) -> Result<PathBuf> {
        let (name, folder) = match self {
            Self::Fmpy => ("venv", workspace.python_tests()),
            Self::Docs => ("venv-docs", workspace.root().join("docs")),
            Self::Wheel => ("venv-wheel", workspace.wheel()),
            Self::Module => ("venv-module", workspace.module_tests()),
            Self::Browser => ("venv-browser", workspace.browser_tests()),
        };
        environment(&workspace.target(name), &folder.join("requirements.txt"))
    }
}

/// pytest in an environment. The packages are installed without bytecode. Python compiles a module when it is first
/// imported, and keeps the bytecode in the target folder, also if the environment of the caller forbids to write it.
pub fn pytest(workspace: &Workspace, python: &Path) -> Command {
    let mut pytest = Command::new(python);
    pytest.args(["-m", "pytest", "-q"]).current_dir(workspace.root());
    pytest.env_remove("PYTHONDONTWRITEBYTECODE").env("PYTHONPYCACHEPREFIX", workspace.target("pycache"));
    pytest
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
