//! `cargo fmu demo`: the landing gear is retracted through FMPy.
//!
//! In: the packed FMU. Out: figures on the terminal, `retraction.csv` and `retraction.png`.

use crate::workspace::Workspace;
use crate::{command, package, python};
use anyhow::{Context, Result};
use clap::Args;
use std::path::PathBuf;
use std::process::Command;

/// What the command line says.
#[derive(Args)]
pub struct Arguments {
    /// Folder for retraction.csv and retraction.png [default: target/demo in the repository]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// Pack the default FMU and run the demo on it.
///
/// # Errors
/// Packing, Python's environment or the run itself fails.
pub fn run(workspace: &Workspace, arguments: &Arguments) -> Result<()> {
    let fmus = package::run(workspace, &package::Arguments::default())?;
    let fmu = fmus.first().context("no FMU was packed")?;
    let out = arguments.out.clone().unwrap_or_else(|| workspace.target("demo"));
    let python = python::environment(workspace)?;
    let mut demo = Command::new(python);
    demo.arg(workspace.demo_script()).arg(fmu).arg("--out").arg(out);
    command::run(&mut demo, "demo.py")
}
