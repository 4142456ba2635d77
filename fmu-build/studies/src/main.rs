//! `cargo fmu <command>`, built and started by `fmu-build/cli` for the tasks that `fmu-build` does not have.

use fmu_build::workspace::Workspace;
use std::process::ExitCode;

fn main() -> ExitCode {
    fmu_build::task::run(&Workspace::locate(), fmu_cli::parsed(), fmu_studies::task::run)
}
