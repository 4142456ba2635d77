//! Plots of variables, drawn by a Python program.
//!
//! In: values of variables along an axis. Out: a PNG, SVG or PDF file. The module must not know the source of the
//! values.

use anyhow::{Context, Result, bail};
use fmu_build::workspace::Workspace;
use fmu_build::xml::quantity;
use fmu_build::{command, files};
use linkage_fmu::variables::Unit;
use serde_json::{Value, json};
use std::path::Path;
use std::process::{Command, Stdio};

/// The Python program.
const PROGRAM: &str = "plot.py";
/// A larger value represents infinity, such as the limit of a drive without a stop or a reduced mass at a dead centre.
const INFINITE: f64 = 1e30;

/// Values of a variable along the axis, or those of the axis.
pub struct Series<'a> {
    /// Name of the variable.
    pub name: &'a str,
    /// Unit of the variable. None for a Boolean.
    pub unit: Option<Unit>,
    /// The values. A missing value is not finite.
    pub values: Vec<f64>,
}

impl Series<'_> {
    /// The values in the unit of the plot.
    fn plan(&self) -> Value {
        let (shown, factor) = self
            .unit
            .map_or((None, 1.0), |unit| unit.display().map_or((Some(unit.name()), 1.0), |(n, f)| (Some(n), f)));
        let values = self.values.iter().map(|value| (value.abs() < INFINITE).then_some(factor * value));
        json!({
            "name": self.name,
            "quantity": self.unit.and_then(quantity),
            "unit": shown,
            "values": values.collect::<Vec<_>>(),
        })
    }
}

/// Check the name of a plot.
///
/// # Errors
/// The name ends in none of .png, .svg and .pdf.
pub fn check(path: &Path) -> Result<()> {
    match &*ending(path) {
        "png" | "svg" | "pdf" => Ok(()),
        _ => bail!("--plot: the name {} must end in .png, .svg or .pdf", path.display()),
    }
}

fn ending(path: &Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase()
}

/// Draw the lines along the axis, with a title.
///
/// # Errors
/// The name of the file has another ending; the Python environment cannot be created; the program fails; the file
/// cannot be written.
pub fn write(workspace: &Workspace, path: &Path, title: &str, x: &Series, lines: &[Series]) -> Result<()> {
    check(path)?;
    let scripts = workspace.python_scripts();
    let mut program = Command::new(command::demo(&workspace.target(""), &scripts)?);
    program.arg(scripts.join(PROGRAM)).arg(ending(path)).stdin(Stdio::piped()).stdout(Stdio::piped());
    let mut child = program.spawn().with_context(|| command::cannot_start(&program, PROGRAM))?;
    let lines: Vec<Value> = lines.iter().map(Series::plan).collect();
    let plan = json!({ "title": title, "x": x.plan(), "lines": lines });
    // A program that ends early prints the reason itself. The pipe is closed at the end of this statement.
    let sent = child.stdin.take().map(|input| serde_json::to_writer(std::io::BufWriter::new(input), &plan));
    let picture = child.wait_with_output()?;
    if !picture.status.success() || !matches!(sent, Some(Ok(()))) {
        bail!("--plot: {PROGRAM} failed ({}); the messages above state the reason", picture.status);
    }
    files::replace_named(path, "--plot", &picture.stdout)
}
