//! A task of the command line. Exit codes: 0 done; 1 rejected with one line or with the findings of `check`; 2 wrong
//! usage; 130 stopped by Ctrl-C.

use crate::workspace::Workspace;
use crate::{bench, chain, check, dist, docs, info, output, package, report, test, validate, view};
use anyhow::Error;
use fmu_cli::{Cli, Task};
use std::process::ExitCode;

/// Function for the tasks that this crate does not have.
pub type Studies = fn(&Workspace, Task) -> ExitCode;

/// Run the task of the command line. An installation rejects the tasks that need the repository.
pub fn run(workspace: &Workspace, cli: Cli, studies: Studies) -> ExitCode {
    let code = workspace.serves(&cli.task).map_or_else(|error| refused(&error), |()| done(workspace, cli, studies));
    output::finish().map_or_else(|error| refused(&error), |()| code)
}

/// Run a task. Returns the exit code.
fn done(workspace: &Workspace, cli: Cli, studies: Studies) -> ExitCode {
    let result = match cli.task {
        Task::Package(arguments) => package::run(workspace, &arguments).map(drop),
        Task::Check(arguments) => match check::run(workspace, &arguments) {
            Ok(true) => Ok(()),
            Ok(false) => return ExitCode::FAILURE,
            Err(error) => Err(error),
        },
        Task::Info(arguments) => info::run(workspace, &arguments),
        Task::Validate(arguments) => match validate::run(workspace, &arguments) {
            Ok(true) => Ok(()),
            Ok(false) => return ExitCode::FAILURE,
            Err(error) => Err(error),
        },
        Task::View(arguments) if !arguments.live => match view::run(workspace, &arguments) {
            Ok(true) => Ok(()),
            Ok(false) => return ExitCode::FAILURE,
            Err(error) => Err(error),
        },
        Task::Demo(arguments) if !arguments.gallery => report::demo(workspace, &arguments),
        Task::Docs(arguments) => docs::run(workspace, &arguments),
        Task::Chain(arguments) => chain::run(&arguments),
        Task::Report(arguments) => report::report(workspace, &arguments),
        Task::Dist(arguments) => dist::run(workspace, &arguments),
        Task::Test(arguments) => test::run(workspace, &arguments),
        Task::Bench(arguments) => bench::run(workspace, &arguments),
        study => return studies(workspace, study),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => refused(&error),
    }
}

/// Print an error. Returns the exit code.
pub fn refused(error: &Error) -> ExitCode {
    eprintln!("error: {error:#}");
    ExitCode::FAILURE
}
