//! A task of the command line. Exit codes: 0 done, 1 refused with one line or with what `check` has found, 2 wrong usage,
//! 130 stopped by Ctrl-C.

use crate::workspace::Workspace;
use crate::{
    bench, chain, check, dist, docs, gallery, import, info, linearise, output, package, report, simulate, sweep, test,
    validate, view,
};
use anyhow::Error;
use fmu_cli::{Cli, Task};
use std::process::ExitCode;

/// Exit code after Ctrl-C, as shells have it.
const INTERRUPTED: u8 = 130;

/// Do what the command line says. An installation refuses the tasks that need the repository.
pub fn run(workspace: &Workspace, cli: Cli) -> ExitCode {
    let code = workspace.serves(&cli.task).map_or_else(|error| refused(&error), |()| done(workspace, cli));
    output::finish().map_or_else(|error| refused(&error), |()| code)
}

/// Do a task; the exit code.
fn done(workspace: &Workspace, cli: Cli) -> ExitCode {
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
        Task::View(arguments) => match view::run(workspace, &arguments) {
            Ok(true) => Ok(()),
            Ok(false) => return ExitCode::FAILURE,
            Err(error) => Err(error),
        },
        Task::Simulate(arguments) => match simulate::run(workspace, &arguments) {
            Ok(simulate::Outcome::Complete) => Ok(()),
            Ok(simulate::Outcome::Interrupted) => return ExitCode::from(INTERRUPTED),
            Err(error) => Err(error),
        },
        Task::Import(arguments) => import::run(&arguments),
        Task::Linearise(arguments) => linearise::run(workspace, &arguments),
        Task::Sweep(arguments) => match sweep::run(workspace, &arguments) {
            Ok(simulate::Outcome::Complete) => Ok(()),
            Ok(simulate::Outcome::Interrupted) => return ExitCode::from(INTERRUPTED),
            Err(error) => Err(error),
        },
        Task::Optimise(arguments) => match sweep::optimise::run(workspace, &arguments) {
            Ok(simulate::Outcome::Complete) => Ok(()),
            Ok(simulate::Outcome::Interrupted) => return ExitCode::from(INTERRUPTED),
            Err(error) => Err(error),
        },
        Task::Demo(arguments) if arguments.gallery => gallery::run(workspace, arguments.out.as_deref()),
        Task::Demo(arguments) => report::demo(workspace, &arguments),
        Task::Docs(arguments) => docs::run(workspace, &arguments),
        Task::Chain(arguments) => chain::run(&arguments),
        Task::Report(arguments) => report::report(workspace, &arguments),
        Task::Dist(arguments) => dist::run(workspace, &arguments),
        Task::Test(arguments) => test::run(workspace, &arguments),
        Task::Bench(arguments) => bench::run(workspace, &arguments),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => refused(&error),
    }
}

/// Tell an error; the exit code.
pub fn refused(error: &Error) -> ExitCode {
    eprintln!("error: {error:#}");
    ExitCode::FAILURE
}
