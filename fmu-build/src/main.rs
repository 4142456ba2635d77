//! `cargo fmu <command>`, built and started by `fmu-build/cli`.

use clap::Parser;
use fmu_build::task;
use fmu_build::workspace::Workspace;
use fmu_cli::{Cli, words};
use std::process::ExitCode;

fn main() -> ExitCode {
    task::run(&Workspace::locate(), Cli::parse_from(words::given()))
}
