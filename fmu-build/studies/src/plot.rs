//! Plots of variables, drawn by a program in Python.
//!
//! In: values of variables along an axis. Out: a PNG, an SVG or a PDF. It must not know where the values come from.

use anyhow::{Context, Result, bail};
use fmu_build::workspace::Workspace;
use fmu_build::xml::quantity;
use fmu_build::{command, files};
use linkage_fmu::variables::Unit;
use serde_json::{Value, json};
use std::path::Path;
use std::process::{Command, Stdio};

/// The program.
const PROGRAM: &str = "plot.py";
/// From here on a value stands for an infinite one, such as the limit of a drive without a stop or a reduced mass at a
/// dead centre.
const INFINITE: f64 = 1e30;

/// Values of a variable along the axis, or those of the axis.
pub struct Series<'a> {
    /// Name of the variable.
    pub name: &'a str,
    /// Its unit; none of a Boolean.
    pub unit: Option<Unit>,
    /// The values; not finite where there is none.
    pub values: Vec<f64>,
}

impl Series<'_> {
    /// The values in the unit in which the quantity is shown.
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

/// Whether a plot can have this name.
///
/// # Errors
/// It ends in none of .png, .svg and .pdf.
pub fn check(path: &Path) -> Result<()> {
    match &*ending(path) {
        "png" | "svg" | "pdf" => Ok(()),
        _ => bail!("--plot: the name {} must end in .png, .svg or .pdf", path.display()),
    }
}

fn ending(path: &Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase()
}

/// Draw the lines along the axis under a title.
///
/// # Errors
/// The name of the file has another ending; Python's environment cannot be made; the program fails; the file cannot be
/// written.
pub fn write(workspace: &Workspace, path: &Path, title: &str, x: &Series, lines: &[Series]) -> Result<()> {
    check(path)?;
    let scripts = workspace.python_scripts();
    let mut program = Command::new(command::demo(&workspace.target(""), &scripts)?);
    program.arg(scripts.join(PROGRAM)).arg(ending(path)).stdin(Stdio::piped()).stdout(Stdio::piped());
    let mut child = program.spawn().with_context(|| command::cannot_start(&program, PROGRAM))?;
    let lines: Vec<Value> = lines.iter().map(Series::plan).collect();
    let plan = json!({ "title": title, "x": x.plan(), "lines": lines });
    // A program that has ended early says why by itself; the pipe is closed when this statement ends.
    let sent = child.stdin.take().map(|input| serde_json::to_writer(std::io::BufWriter::new(input), &plan));
    let picture = child.wait_with_output()?;
    if !picture.status.success() || !matches!(sent, Some(Ok(()))) {
        bail!("--plot: {PROGRAM} failed ({}); the messages above state the reason", picture.status);
    }
    files::replace_named(path, "--plot", &picture.stdout)
}
