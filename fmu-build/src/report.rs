//! `cargo fmu report`: the figures and claims of the two papers, recomputed from FMU runs.
//!
//! In: the packed FMUs. Out: `report.md` and `figures/`, in `validation/` by default.

use crate::workspace::{DEFAULT_FMU, Workspace};
use crate::{command, package, python};
use anyhow::{Context, Result};
use clap::Args;
use std::path::{self, PathBuf};
use std::process::Command;

/// FMUs that the report runs.
const FMUS: [&str; 3] = [DEFAULT_FMU, "SliderCrank", "Jib"];

/// What the command line says.
#[derive(Args)]
pub struct Arguments {
    /// Folder for report.md and figures/ [default: validation in the repository]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// Pack the FMUs and write the report from them.
///
/// # Errors
/// Packing, Python's environment or a run fails.
pub fn run(workspace: &Workspace, arguments: &Arguments) -> Result<()> {
    let paths = FMUS.iter().map(|name| workspace.descriptions().join(name)).collect();
    package::run(workspace, &package::Arguments { paths, ..Default::default() })?;
    let out = arguments.out.clone().unwrap_or_else(|| workspace.validation());
    let out = path::absolute(&out).with_context(|| out.display().to_string())?;
    let python = python::environment(workspace)?;
    let mut report = Command::new(python);
    report.args(["-m", "report"]).arg(workspace.fmu_folder()).arg("--out").arg(out).current_dir(workspace.validation());
    command::run(&mut report, "report")
}
