//! `cargo fmu bench`: the benchmarks of the validation package, their figures, and comparisons of importers and with
//! other tools.

use crate::workspace::{DEFAULT_FMU, Workspace};
use crate::{command, dist, files, package};
use anyhow::{Context, Result};
pub use fmu_cli::Bench as Arguments;
use fmu_cli::Program;
use serde_json::{Value, json};
use std::env;
use std::fs;
use std::path::PathBuf;
use std::process::Command;

/// Package and program of the benchmarks.
const VALIDATION: &str = "validation";

/// Run the benchmarks, the importers or the other tools, or draw the figures.
///
/// # Errors
/// The benchmarks cannot be built or fail; the importers cannot be installed or do not agree; another tool cannot be
/// installed, does not converge to the exact value, or is faster; there is no Python for the figures.
pub fn run(workspace: &Workspace, arguments: &Arguments) -> Result<()> {
    if let [word] = &arguments.rest[..] {
        match word.to_str() {
            Some("importers") => return importers(workspace),
            Some("peers") => return peers(workspace),
            Some("plots") => return plots(workspace),
            Some("studies") => return studies(workspace),
            Some("module") => return module(workspace),
            _ => {}
        }
    }
    command::run(
        Command::new(command::built(workspace, VALIDATION)?).args(&arguments.rest).current_dir(workspace.root()),
        "validation",
    )?;
    if arguments.rest.iter().any(|word| word == "stress") {
        random_linkages(workspace)?;
    }
    Ok(())
}

/// The random linkages of the engine's tests, six times as many as in a normal test run.
fn random_linkages(workspace: &Workspace) -> Result<()> {
    let mut cargo = command::cargo(workspace);
    cargo.args(["test", "--quiet", "--package", "linkage-fmu", "--test", "engine", "random_linkages"]);
    command::run(cargo.env("LINKAGE_FMU_CASES", "600"), "random linkages")
}

/// A Python script in the folder `name` of `validation/`, in a separate environment, with the default FMU as its first
/// argument. Also returns this folder, and a folder for intermediate files.
fn comparison(workspace: &Workspace, name: &str) -> Result<(Command, PathBuf, PathBuf)> {
    let fmu = package::default(workspace)?;
    let (folder, work) = (workspace.validation().join(name), workspace.target(name));
    let environment = workspace.target(&format!("venv-{name}"));
    let mut script = Command::new(command::environment(&environment, &folder.join("requirements.txt"))?);
    script.arg(folder.join(name).with_extension("py")).arg(fmu);
    Ok((script, folder, work))
}

/// Run the default FMU in each importer, alone and coupled with its hydraulic actuator, and write the results.
fn importers(workspace: &Workspace) -> Result<()> {
    package::run(workspace, &package::Arguments { ssp: true, ..Default::default() })?;
    let (mut script, _, work) = comparison(workspace, "importers")?;
    script.arg("--out").arg(workspace.results().join("importers.md")).arg("--work").arg(work);
    if cfg!(target_os = "linux") {
        script.arg("--host").arg(command::built(workspace, VALIDATION)?);
    }
    match fmi_sim(workspace) {
        Ok(program) => _ = script.env("FMI_SIM", program),
        Err(error) => {
            println!("fmi-sim is left out: {error:#} (fmi-sim needs libclang; Debian: apt-get install libclang-dev)")
        }
    }
    script.env("DELAYED_FMU", delayed(workspace)?);
    command::run(&mut script, "importers.py")
}

/// The hydraulic actuator packed with the coupling mode `delayed`. libcosim and ECOS do not support the Enumerations of
/// FMI 2.0, so that they cannot set the mode.
fn delayed(workspace: &Workspace) -> Result<PathBuf> {
    const NAME: &str = "HydraulicActuator";
    let source = workspace.descriptions().join(NAME).join("resources").join("hydraulics.json");
    let text = fs::read_to_string(&source).with_context(|| format!("{}: cannot be read", source.display()))?;
    let mut definition: Value = serde_json::from_str(&text)?;
    definition["coupling"] = json!({ "mode": "delayed" });
    let out = workspace.target("importers").join("delayed");
    let folder = out.join(NAME);
    files::replace(&folder.join("resources").join("hydraulics.json"), definition.to_string().as_bytes())?;
    let arguments =
        package::Arguments { paths: vec![folder], out: Some(out.clone()), ..package::Arguments::of_fmi_2() };
    package::run(workspace, &arguments)?;
    Ok(out.join(NAME).with_extension("fmu"))
}

/// The program of the crate fmi-sim, installed from crates.io into a separate folder. An existing program is not built
/// again.
fn fmi_sim(workspace: &Workspace) -> Result<PathBuf> {
    const CRATE: &str = "fmi-sim@0.7.0";
    let root = workspace.target("importers").join("fmi-sim");
    let mut cargo = command::cargo(workspace);
    cargo.args(["install", "--quiet", "--locked", CRATE, "--root"]).arg(&root);
    // Cargo passes the folder of the running program to its child processes.
    cargo
        .arg("--target-dir")
        .arg(root.join("target"))
        .env_remove("CARGO_MANIFEST_DIR")
        .current_dir(std::env::temp_dir());
    command::run(&mut cargo, "cargo install of fmi-sim")?;
    Ok(root.join("bin").join(format!("fmi-sim{}", env::consts::EXE_SUFFIX)))
}

/// Measure the Rust solvers, then the tools with Python and the installed libraries in C, and write results and figure.
fn peers(workspace: &Workspace) -> Result<()> {
    let (mut script, folder, work) = comparison(workspace, "peers")?;
    let rust = work.join("rust.csv");
    let mut cargo = command::cargo(workspace);
    cargo.args(["run", "--release", "--quiet", "--manifest-path"]).arg(folder.join("Cargo.toml"));
    cargo.arg("--target-dir").arg(&work).arg("--").arg(workspace.descriptions()).arg(&rust);
    command::run(&mut cargo, "the Rust solvers")?;
    script.arg(&rust).arg("--out").arg(workspace.validation());
    script.arg("--work").arg(&work).env("OMP_NUM_THREADS", "1");
    command::run(&mut script, "peers.py")
}

/// Measure the cost of a run of a study with this program and with other tools, and write the results.
fn studies(workspace: &Workspace) -> Result<()> {
    let (mut script, _, work) = comparison(workspace, "studies")?;
    script.arg("--program").arg(command::built(workspace, Program::Studies.name())?);
    script.arg("--mechanism").arg(workspace.descriptions().join(DEFAULT_FMU)).arg("--work").arg(work);
    script.arg("--out").arg(workspace.results().join("studies.md"));
    command::run(&mut script, "studies.py")
}

/// Measure runs and steps by the Python module, FMPy, MuJoCo and EXUDYN, and write the results. The module is that of
/// the wheel that `dist` has built.
fn module(workspace: &Workspace) -> Result<()> {
    let folder = workspace.validation().join("studies");
    let python = command::environment(&workspace.target("venv-studies"), &folder.join("requirements.txt"))?;
    let wheel =
        dist::wheel_in(&workspace.target("dist")).context("run `cargo fmu dist` first, which builds a wheel")?;
    dist::install(&python, &wheel)?;
    let mut script = Command::new(python);
    script.arg(folder.join("module.py")).arg("--fmu").arg(package::default(workspace)?);
    script.arg("--out").arg(workspace.results().join("module.md")).env("OMP_NUM_THREADS", "1");
    command::run(&mut script, "module.py")
}

/// Draw the figures from the committed results.
fn plots(workspace: &Workspace) -> Result<()> {
    let mut script = Command::new(command::Python::Fmpy.interpreter(workspace)?);
    script.args(["-m", "bench_figures"]).arg(workspace.results()).arg(workspace.validation().join("figures"));
    command::run(script.current_dir(workspace.validation()), "bench_figures")
}
