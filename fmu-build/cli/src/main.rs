//! `cargo fmu`: answers help and wrong usage. For a task, Cargo first builds the program of the task, then the program
//! runs.
use anyhow::{Context, Result, anyhow};
use fmu_cli::{Cli, Program, parsed, python};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::{env, thread};

fn main() -> ExitCode {
    let cli = parsed();
    let package =
        env::var_os("CARGO_MANIFEST_DIR").map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")), PathBuf::from);
    // This package is in fmu-build, in the root.
    let root = package.ancestors().nth(2).unwrap_or(Path::new("."));
    run(&cli, root).unwrap_or_else(|error| {
        eprintln!("error: {error:#}");
        ExitCode::FAILURE
    })
}

/// Build the program of the task and run it with the same arguments.
fn run(cli: &Cli, root: &Path) -> Result<ExitCode> {
    let program = cli.task.program();
    let path = env::current_exe()?.with_file_name(format!("{}{}", program.name(), env::consts::EXE_SUFFIX));
    if !path.is_file() {
        eprintln!("building {}: the first build needs {} on two cores", program.name(), program.time());
    }
    if cli.task.is_demo() {
        prepare_demo(program, root)?;
    }
    let mut cargo = cargo("run", program, root);
    let status = cargo
        .arg("--")
        .args(env::args_os().skip(1))
        .status()
        .context("cargo cannot be started; check that Rust is installed and on the PATH")?;
    Ok(status.code().and_then(|code| u8::try_from(code).ok()).map_or(ExitCode::FAILURE, ExitCode::from))
}

/// Build the program and the library of the FMUs. Meanwhile create the Python environment, because pip mostly waits for
/// the network.
fn prepare_demo(program: Program, root: &Path) -> Result<()> {
    let [environments, scripts] = [root.join("target"), root.join("fmu-build").join("python")];
    thread::scope(|scope| {
        let environment = scope.spawn(|| python::demo(&environments, &scripts));
        let mut cargo = cargo("build", program, root);
        python::run(cargo.args(["--package", "linkage-fmu-exports"]), "cargo build")?;
        environment.join().map_err(|_| anyhow!("the thread of the Python environment panicked"))?
    })
    .map(drop)
}

/// A call of Cargo that builds or runs a program.
fn cargo(subcommand: &str, program: Program, root: &Path) -> Command {
    let mut cargo = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.args([subcommand, "--release", "--package", program.name(), "--manifest-path"]).arg(root.join("Cargo.toml"));
    cargo
}
