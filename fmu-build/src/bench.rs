//! `cargo fmu bench`: the benchmarks of the validation package.

use crate::command;
use crate::workspace::Workspace;
use anyhow::Result;
use clap::Args;
use std::ffi::OsString;

/// What the command line says.
#[derive(Args)]
pub struct Arguments {
    /// Handed to the validation package as they are
    #[arg(value_name = "ARGS", trailing_var_arg = true, allow_hyphen_values = true)]
    pub rest: Vec<OsString>,
}

/// Run the benchmarks.
///
/// # Errors
/// The benchmarks cannot be built or fail.
pub fn run(workspace: &Workspace, arguments: &Arguments) -> Result<()> {
    let mut cargo = command::cargo(workspace);
    cargo.args(["run", "--release", "--quiet", "--package", "validation", "--"]).args(&arguments.rest);
    command::run(&mut cargo, "validation")
}
