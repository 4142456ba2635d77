//! `cargo fmu <command>`, built and started by `fmu-build/cli`.

use clap::Parser;
use fmu_build::task;
use fmu_build::workspace::Workspace;
use fmu_cli::Cli;
use std::process::ExitCode;

fn main() -> ExitCode {
    task::run(&Workspace::locate(), Cli::parse())
}
