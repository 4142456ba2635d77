//! `cargo fmu bench`: the benchmarks of the validation package, their figures, the comparison of importers, and that
//! with other tools.

use crate::workspace::Workspace;
use crate::{command, package, python};
use anyhow::{Context, Result};
use clap::Args;
use std::env;
use std::ffi::OsString;
use std::process::Command;

/// First argument that asks for the comparison of importers.
const IMPORTERS: &str = "importers";
/// First argument that asks for the comparison with other tools.
const PEERS: &str = "peers";
/// First argument that asks for the figures.
const PLOTS: &str = "plots";

/// What the command line says.
#[derive(Args)]
pub struct Arguments {
    /// `importers`: the landing gear in FMPy, libcosim and ECOS; `peers`: work against error beside other solvers and
    /// multibody programs; `plots`: figures from the tables' CSV; all else goes to the validation package as it is: nothing
    /// for the tables of run times, `instructions` for callgrind's counts, `stress` for the stress suite
    #[arg(value_name = "ARGS", trailing_var_arg = true, allow_hyphen_values = true)]
    pub rest: Vec<OsString>,
}

/// Run the benchmarks, the importers or the other tools, or draw the figures.
///
/// # Errors
/// The benchmarks cannot be built or fail; the importers cannot be installed or do not agree; another tool cannot be
/// installed, does not converge to the exact value, or is faster; there is no Python for
/// the figures.
pub fn run(workspace: &Workspace, arguments: &Arguments) -> Result<()> {
    if arguments.rest.len() == 1 && arguments.rest[0] == IMPORTERS {
        return importers(workspace);
    }
    if arguments.rest.len() == 1 && arguments.rest[0] == PEERS {
        return peers(workspace);
    }
    if arguments.rest.len() == 1 && arguments.rest[0] == PLOTS {
        return plots(workspace);
    }
    // Both packages are named so that dependencies have the features they have for this program, and the engine is not built
    // again for each of the two in turn.
    let mut cargo = command::cargo(workspace);
    cargo.args(["build", "--release", "--quiet", "--package", "fmu-build", "--package", "validation"]);
    command::run(cargo.args(["--bin", "validation"]), "cargo build")?;
    let program = env::current_exe()?.with_file_name(format!("validation{}", env::consts::EXE_SUFFIX));
    command::run(Command::new(program).args(&arguments.rest).current_dir(workspace.root()), "validation")
}

/// Pack the default FMU, drive it with each importer, and write the results.
fn importers(workspace: &Workspace) -> Result<()> {
    let fmus = package::run(workspace, &package::Arguments::default())?;
    let fmu = fmus.first().context("no FMU was packed")?;
    let folder = workspace.importers();
    let python = python::environment_of(&workspace.importers_environment(), &folder.join("requirements.txt"))?;
    let mut script = Command::new(python);
    script.arg(folder.join("importers.py")).arg(fmu);
    script.arg("--out").arg(workspace.results().join("importers.md")).arg("--work").arg(workspace.importers_work());
    command::run(&mut script, "importers.py")
}

/// Measure the Rust solvers, then the tools with Python, and write results and figure.
fn peers(workspace: &Workspace) -> Result<()> {
    let fmus = package::run(workspace, &package::Arguments::default())?;
    let fmu = fmus.first().context("no FMU was packed")?;
    let (folder, work) = (workspace.peers(), workspace.peers_work());
    let python = python::environment_of(&workspace.peers_environment(), &folder.join("requirements.txt"))?;
    let rust = work.join("rust.csv");
    let mut cargo = command::cargo(workspace);
    cargo.args(["run", "--release", "--quiet", "--manifest-path"]).arg(folder.join("Cargo.toml"));
    cargo.arg("--target-dir").arg(&work).arg("--").arg(workspace.descriptions()).arg(&rust);
    command::run(&mut cargo, "the Rust solvers")?;
    let mut script = Command::new(python);
    script.arg(folder.join("peers.py")).arg(fmu).arg(&rust).arg("--out").arg(workspace.validation());
    script.arg("--work").arg(&work).env("OMP_NUM_THREADS", "1");
    command::run(&mut script, "peers.py")
}

/// Draw the figures from the committed results.
fn plots(workspace: &Workspace) -> Result<()> {
    let mut script = Command::new(python::environment(workspace)?);
    script.args(["-m", "bench_figures"]).arg(workspace.results()).arg(workspace.validation().join("figures"));
    command::run(script.current_dir(workspace.scripts()), "bench_figures")
}
