//! `cargo fmu <command>`, built and started by `fmu-build/cli` for the tasks that `fmu-build` does not have.

use clap::Parser;
use fmu_build::workspace::Workspace;
use fmu_cli::{Cli, words};
use std::process::ExitCode;

fn main() -> ExitCode {
    fmu_build::task::run(&Workspace::locate(), Cli::parse_from(words::given()), fmu_studies::task::run)
}
