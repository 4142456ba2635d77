//! The tasks of this crate. The exit codes are those of the packer's tasks.

use crate::simulate::Outcome;
use crate::{gallery, import, linearise, live, simulate, sweep};
use anyhow::anyhow;
use fmu_build::task::refused;
use fmu_build::workspace::Workspace;
use fmu_cli::Task;
use std::process::ExitCode;

/// Exit code after Ctrl-C, as in shells.
const INTERRUPTED: u8 = 130;

/// Run a task that the packer does not have. Returns the exit code.
pub fn run(workspace: &Workspace, task: Task) -> ExitCode {
    let complete = |()| Outcome::Complete;
    let result = match task {
        Task::Simulate(arguments) => simulate::run(workspace, &arguments),
        Task::Import(arguments) => import::run(&arguments).map(complete),
        Task::Linearise(arguments) => linearise::run(workspace, &arguments).map(complete),
        Task::Sweep(arguments) => sweep::run(workspace, &arguments, None),
        Task::Optimise(arguments) => sweep::optimise::run(workspace, &arguments, None),
        Task::Demo(arguments) => gallery::run(workspace, arguments.out.as_deref()).map(complete),
        Task::View(arguments) => live::run(workspace, &arguments).map(complete),
        packing => Err(anyhow!("{} does this task", packing.program().name())),
    };
    match result {
        Ok(Outcome::Complete) => ExitCode::SUCCESS,
        Ok(Outcome::Failed) => ExitCode::FAILURE,
        Ok(Outcome::Interrupted) => ExitCode::from(INTERRUPTED),
        Err(error) => refused(&error),
    }
}
