//! `cargo fmu <command>`, built and started by `fmu-build/cli`: the tasks of a first user. `fmu-studies` has all.

use anyhow::anyhow;
use fmu_build::task;
use fmu_build::workspace::Workspace;
use fmu_cli::{Task, parsed};
use std::process::ExitCode;

fn main() -> ExitCode {
    task::run(&Workspace::locate(), parsed(), elsewhere)
}

/// Answer to a task that this program does not have.
fn elsewhere(_: &Workspace, task: Task) -> ExitCode {
    let name = task.program().name();
    task::refused(&anyhow!(
        "{name} contains this command: run `cargo fmu`, or `cargo run --release --package {name} \
        --`"
    ))
}
