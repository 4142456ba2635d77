//! The command line of `cargo fmu`. Exit codes: 0 done, 1 refused with one line or with what `check` has found, 2 wrong
//! usage.

use clap::{Parser, Subcommand};
use fmu_build::workspace::Workspace;
use fmu_build::{bench, chain, check, package, report, test};
use std::process::ExitCode;

#[derive(Parser)]
#[command(name = "cargo fmu", bin_name = "cargo fmu", version, about = "Builds, tests and demonstrates the FMUs")]
struct Cli {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Pack mechanisms into target/fmu/<Name>.fmu
    Package(package::Arguments),
    /// Tell what is wrong with a mechanism, where it can go, and what it weighs
    Check(check::Arguments),
    /// Run the retraction through FMPy: figures, table, plot
    Demo(report::Demo),
    /// Write the mechanism of a chain of N four-bars
    Chain(chain::Arguments),
    /// Recompute the papers' figures through FMPy: validation/report.md, validation/figures
    Report(report::Arguments),
    /// Run every test: Rust, packaging, Python style, FMPy
    Test,
    /// Run the benchmarks of the validation package
    Bench(bench::Arguments),
}

fn main() -> ExitCode {
    let workspace = Workspace::locate();
    let result = match Cli::parse().task {
        Task::Package(arguments) => package::run(&workspace, &arguments).map(drop),
        Task::Check(arguments) => match check::run(&workspace, &arguments) {
            Ok(true) => Ok(()),
            Ok(false) => return ExitCode::FAILURE,
            Err(error) => Err(error),
        },
        Task::Demo(arguments) => report::demo(&workspace, &arguments),
        Task::Chain(arguments) => chain::run(&arguments),
        Task::Report(arguments) => report::report(&workspace, &arguments),
        Task::Test => test::run(&workspace),
        Task::Bench(arguments) => bench::run(&workspace, &arguments),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}
