//! `cargo fmu simulate`: a run of a model by the engine, with the options of FMPy.
//!
//! In: a definition or an FMU, start values, input signals, an interval. Out: a table of the outputs over time as CSV
//! or Parquet, a plot, a film. The run makes the same steps as FMPy, so that both are bit-identical.

mod film;
mod parquet;

use crate::plot::{self, Series};
use crate::progress::Bar;
use anyhow::{Context, Result, bail};
use film::Film;
use fmu_build::check::{self, FileUnits};
use fmu_build::files;
use fmu_build::fmu::Definition;
use fmu_build::run::column::{Column, columns};
use fmu_build::run::csv::Csv;
use fmu_build::run::file::Writer;
use fmu_build::run::signals::Signals;
use fmu_build::run::table::{Recorded, Table};
use fmu_build::run::{self, Ended, Span};
use fmu_build::start_values;
use fmu_build::workspace::Workspace;
use fmu_build::xml::ssv;
pub use fmu_cli::Simulate as Arguments;
use linkage_fmu::component::Component;
use linkage_fmu::variables::{Reference, Unit};
use parquet::Parquet;
use std::collections::BTreeMap;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};

/// Result of a run, for the exit code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// At the stop time.
    Complete,
    /// The user stopped the run. The recorded rows are written.
    Interrupted,
    /// All runs of a study failed. The results with the reasons are written.
    Failed,
}

/// Run the model and write the requested files.
///
/// # Errors
/// The path contains no definition; a name, a value or a signal is invalid; a step fails (the rows recorded before are
/// written); a file cannot be written.
pub fn run(workspace: &Workspace, arguments: &Arguments) -> Result<Outcome> {
    check_files(arguments)?;
    let definition = Definition::read(workspace, &arguments.path)?;
    let mut model = check::model(workspace, &definition)?;
    let units = FileUnits::stated(linkage_fmu::format::parse("definition", &definition.text).ok().as_ref());
    for finding in model.warnings() {
        eprintln!("warning: {}", units.converted(finding.clone()));
    }
    if let Some(tolerance) = arguments.relative_tolerance {
        model.set_tolerance(tolerance).context("--relative-tolerance")?;
    }
    let stated = set_start_values(&mut model, arguments)?;
    let Arguments { start_time, stop_time, output_interval, .. } = *arguments;
    let span = Span::new(model.experiment(), start_time, stop_time, output_interval)?;
    let signals = match &arguments.input_file {
        Some(path) => {
            Signals::read(path, model.interface(), arguments.set_input_derivatives).context("--input-file")?
        }
        None => Signals::none(),
    };
    if let Some(both) = signals.references().find(|reference| stated.contains(reference)) {
        eprintln!(
            "warning: --input-file replaces the value of {} in --start-values; remove one of the two",
            model.interface().list()[both as usize].name
        );
    }
    let signals = signals.within(&span);
    if arguments.set_input_derivatives && model.input_order() == 0 {
        bail!("--set-input-derivatives: this model has no derivatives of inputs; remove this option");
    }
    let columns = with_axis(columns(model.interface(), &arguments.output_variables)?, &model, arguments)?;
    for (option, path) in written(arguments) {
        files::make_folder(files::folder_of(path), option)?;
    }
    let mut film = arguments.gif.is_some().then(|| Film::new(&model)).transpose()?;
    let writer = arguments.output_file.as_deref().map(|path| writer(path, &columns)).transpose()?;
    let mut table = Table::new(columns, writer, arguments.plot.is_some());
    let mut bar = Bar::new(std::io::stderr().is_terminal());
    let started = std::time::Instant::now();
    let mut reached = span.start;
    let mut record = |model: &mut Component, time: f64| {
        reached = time;
        if let Some(film) = &mut film {
            film.record(model, time);
        }
        table.record(model, time)
    };
    let ended = run::run(&mut model, &span, &signals, &mut record, &mut bar);
    bar.end();
    let elapsed = started.elapsed().as_secs_f64();
    let recorded = table.finish(ended.is_ok().then_some((&mut model, reached)))?;
    for line in &recorded.missing {
        eprintln!("warning: {line}");
    }
    if let Some(path) = &arguments.plot {
        draw(workspace, path, model.name(), &recorded, arguments.x.as_deref())?;
    }
    if let (Some(path), Some(film)) = (&arguments.gif, film) {
        film.write(path, &mut model, reached)?;
    }
    let ended = ended?;
    summarize(arguments, &recorded, &ended, elapsed);
    Ok(if ended.is_interrupted { Outcome::Interrupted } else { Outcome::Complete })
}

/// Set the start values: those of the command line replace those of the parameter set. Returns the variables of the
/// command line.
fn set_start_values(model: &mut Component, arguments: &Arguments) -> Result<Vec<Reference>> {
    let mut values = BTreeMap::new();
    let mut options = "--start-values";
    if let Some(path) = &arguments.parameters {
        values.extend(ssv::read(path, model.interface()).context("--parameters")?);
        options = "--parameters and --start-values";
    }
    let own = start_values::parse(model.interface(), &arguments.start_values)?;
    let stated = own.iter().map(|(reference, _)| *reference).collect();
    values.extend(own);
    start_values::apply_all(model, values.into_iter().collect()).context(options)?;
    Ok(stated)
}

/// The output files, with their options.
fn written(arguments: &Arguments) -> impl Iterator<Item = (&'static str, &PathBuf)> {
    let Arguments { output_file, plot, gif, .. } = arguments;
    let all = [("--output-file", output_file), ("--plot", plot), ("--gif", gif)];
    all.into_iter().filter_map(|(option, path)| Some((option, path.as_ref()?)))
}

/// Check the names of the output files before the run.
fn check_files(arguments: &Arguments) -> Result<()> {
    let Arguments { output_file, plot, gif, .. } = arguments;
    plot.as_deref().map_or(Ok(()), plot::check)?;
    gif.as_deref().map_or(Ok(()), film::check)?;
    output_file.as_deref().map_or(Ok(()), check_table)?;
    let read = [
        ("the model", Some(&arguments.path)),
        ("--parameters", arguments.parameters.as_ref()),
        ("--input-file", arguments.input_file.as_ref()),
    ];
    for (_, path) in written(arguments) {
        let is_same = |other: &PathBuf| matches!((path.canonicalize(), other.canonicalize()), (Ok(a), Ok(b)) if a == b);
        if let Some((what, _)) = read.iter().find(|(_, other)| other.is_some_and(is_same)) {
            bail!("{}: this is {what}; give another path for the output", path.display());
        }
    }
    Ok(())
}

/// Check that a table with this name can be written.
fn check_table(path: &Path) -> Result<()> {
    match extension(path).as_str() {
        "csv" | "parquet" | "" => Ok(()),
        _ => bail!("--output-file: the name {} must end in .csv or .parquet", path.display()),
    }
}

/// The columns, including the variable along the axis of the plot.
fn with_axis(mut columns: Vec<Column>, model: &Component, arguments: &Arguments) -> Result<Vec<Column>> {
    if let Some(name) = &arguments.x
        && !columns.iter().any(|column| column.name == *name)
    {
        columns.extend(fmu_build::run::column::columns(model.interface(), std::slice::from_ref(name)).context("--x")?);
    }
    Ok(columns)
}

/// Draw the recorded variables, over time or over one of the variables.
fn draw(workspace: &Workspace, path: &Path, title: &str, recorded: &Recorded, axis: Option<&str>) -> Result<()> {
    let values = |k: usize| recorded.plotted.iter().map(|row| row[k]).collect();
    let time = Series { name: "time", unit: Some(Unit::Second), values: values(0) };
    let all = recorded.columns.iter().zip(1..);
    let all = all.map(|(column, k)| Series { name: &column.name, unit: column.unit, values: values(k) });
    let (mut along, lines): (Vec<Series>, Vec<Series>) = all.partition(|series| Some(series.name) == axis);
    plot::write(workspace, path, title, &along.pop().unwrap_or(time), &lines)
}

/// The writer of a table: Parquet for names that end in .parquet, else CSV.
fn writer(path: &Path, columns: &[Column]) -> Result<Writer> {
    match extension(path).as_str() {
        "parquet" => Writer::begin::<Parquet>(path, columns),
        _ => Writer::begin::<Csv>(path, columns),
    }
}

fn extension(path: &Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase()
}

/// Results of the run in a few lines.
fn summarize(arguments: &Arguments, recorded: &Recorded, ended: &Ended, elapsed: f64) {
    eprintln!("{} steps to {:?} s, computed in {elapsed:.3} s", ended.steps, ended.time);
    for (_, path) in written(arguments) {
        eprintln!("{}", path.display());
    }
    if written(arguments).next().is_none() {
        // Without a file the last row is printed.
        for (column, value) in recorded.columns.iter().zip(&recorded.last) {
            println!("{}\t{value:?}\t{}", column.name, column.unit.map_or("", |unit| unit.name()));
        }
    }
}
