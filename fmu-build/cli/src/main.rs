//! `cargo fmu`: help and wrong usage are answered here; a task goes to fmu-build, which cargo builds first.
use clap::Parser;
use fmu_cli::{Cli, words};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::{env, io};

fn main() -> ExitCode {
    Cli::parse_from(words::given());
    match run() {
        Ok(code) => code,
        Err(error) => {
            eprintln!("error: cargo cannot be started to run fmu-build: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Run fmu-build with the same words.
fn run() -> io::Result<ExitCode> {
    let package =
        env::var_os("CARGO_MANIFEST_DIR").map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")), PathBuf::from);
    // This package is in fmu-build, in the root.
    let root = package.ancestors().nth(2).unwrap_or(Path::new("."));
    let mut cargo = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.args(["run", "--release", "--package", "fmu-build", "--manifest-path"]).arg(root.join("Cargo.toml"));
    let status = cargo.arg("--").args(env::args_os().skip(1)).status()?;
    Ok(status.code().and_then(|code| u8::try_from(code).ok()).map_or(ExitCode::FAILURE, ExitCode::from))
}
