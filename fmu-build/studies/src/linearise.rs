//! `cargo fmu linearise`: small motions about rest along the travel of a mechanism.
//!
//! In: a definition or an FMU, names of a coordinate, inputs and outputs. Out: eigenfrequency, damping ratio and the
//! matrices of x' = A x + B u, y = C x + D u at each position as CSV and plot, and those at the start as text. The
//! module must not know how they are computed.

use crate::plot::{self, Series};
use anyhow::{Context, Result, bail};
use fmu_build::check;
use fmu_build::files;
use fmu_build::fmu::Definition;
use fmu_build::run::csv::decimal;
use fmu_build::start_values::{self, find};
use fmu_build::workspace::Workspace;
pub use fmu_cli::Linearise as Arguments;
use linkage_fmu::component::{Component, Linearisation, Linearised};
use linkage_fmu::variables::{Interface, Reference, Unit, nearest};
use std::path::Path;

/// A linearisation with the names of its variables.
struct Named<'a> {
    what: Linearisation,
    interface: &'a Interface,
}

/// Linearise and write the requested files.
///
/// # Errors
/// The path contains no mechanism; a name or a value is invalid; a file cannot be written.
pub fn run(workspace: &Workspace, arguments: &Arguments) -> Result<()> {
    arguments.plot.as_deref().map_or(Ok(()), plot::check)?;
    arguments.output_file.as_deref().map_or(Ok(()), check_csv)?;
    let definition = Definition::read(workspace, &arguments.path)?;
    let mut model = check::model(workspace, &definition)?;
    start_values::apply(&mut model, &arguments.start_values)?;
    let interface = model.interface().clone();
    let named = Named { what: what(&model, arguments)?, interface: &interface };
    let start = model.linearise_here(&named.what)?;
    print!("{}", named.in_words(&start));
    if is_held_by_friction(&start) {
        eprintln!(
            "warning: static friction holds the mechanism at this position, so the matrix elements A21, A22 and B2 are \
             zero; eigenfrequency, damping ratio and eigenvalues are computed for sliding friction; for matrices that \
             agree with these values, set friction.enabled to false, or friction.law to viscous"
        );
    }
    if arguments.output_file.is_none() && arguments.plot.is_none() {
        return Ok(());
    }
    let all = model.linearise(&named.what, arguments.count as usize)?;
    if let Some(path) = &arguments.output_file {
        files::replace_named(path, "--output-file", named.csv(&all)?.as_slice())?;
        eprintln!("{}", path.display());
    }
    if let Some(path) = &arguments.plot {
        named.draw(workspace, path, model.name(), &all)?;
        eprintln!("{}", path.display());
    }
    Ok(())
}

/// Whether friction holds the mechanism at a position, so that small loads and deviations cause no acceleration.
fn is_held_by_friction(at: &Linearised) -> bool {
    let slides = at.eigenvalues.iter().flatten().any(|part| *part != 0.0);
    let rows = at.a[1].iter().chain(at.b.iter().map(|column| &column[1]));
    slides && at.acceleration == 0.0 && rows.copied().all(|value| value == 0.0)
}

/// Check that the name is allowed for a table.
fn check_csv(path: &Path) -> Result<()> {
    match path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase().as_str() {
        "csv" => Ok(()),
        _ => bail!("--output-file: the name {} must end in .csv", path.display()),
    }
}

/// The variables in the arguments. By default the coordinate of the start, and the inputs on which its acceleration
/// depends.
///
/// # Errors
/// A name is unknown, or the model has no travel.
pub fn what(model: &Component, arguments: &Arguments) -> Result<Linearisation> {
    let interface = model.interface();
    let all = |names: &[String], option: &'static str| -> Result<Vec<Reference>> {
        names.iter().map(|name| find(interface, name).context(option)).collect()
    };
    let coordinate = match &arguments.coordinate {
        Some(name) => interface.find(name).with_context(|| {
            let is_coordinate = |name: &&str| name.ends_with(".angle") || name.ends_with(".position");
            let all = interface.list().iter().map(|variable| variable.name.as_str()).filter(is_coordinate);
            format!(
                "--coordinate: there is no variable \"{}\": the most similar names are {}; a coordinate is an angle \
                 or a position",
                name.escape_debug(),
                nearest(all, name).join(", ")
            )
        })?,
        None => match model.natural_coordinate() {
            Some(coordinate) => coordinate,
            None => bail!("{} is not a mechanism and has no travel: only mechanisms can be linearised", model.name()),
        },
    };
    let inputs = match arguments.inputs.as_slice() {
        [] => acting(interface, coordinate),
        names => all(names, "--inputs")?,
    };
    let outputs = match arguments.outputs.as_slice() {
        [] => vec![coordinate],
        names => all(names, "--outputs")?,
    };
    let held_by = arguments.held_by.as_ref().map(|name| find(interface, name).context("--held-by")).transpose()?;
    Ok(Linearisation { coordinate, inputs, outputs, held_by })
}

/// The continuous inputs on which the acceleration of a coordinate depends.
fn acting(interface: &Interface, coordinate: Reference) -> Vec<Reference> {
    let list = interface.list();
    let name = &list[coordinate as usize].name;
    let of = name.rsplit_once('.').map_or(name.as_str(), |(of, _)| of);
    let acceleration = interface.find(&format!("{of}.acceleration")).map(|found| &list[found as usize].dependencies);
    let all = acceleration.into_iter().flatten().copied();
    all.filter(|input| list[*input as usize].unit.is_some()).collect()
}

impl Named<'_> {
    fn name(&self, reference: Reference) -> &str {
        &self.interface.list()[reference as usize].name
    }

    fn unit(&self, reference: Reference) -> Unit {
        self.interface.list()[reference as usize].unit.unwrap_or(Unit::One)
    }

    /// Names of the columns, with so many states.
    fn columns(&self, states: usize) -> Vec<String> {
        let Linearisation { coordinate, inputs, outputs, held_by } = &self.what;
        let mut names = vec![self.name(*coordinate).to_owned(), "acceleration".to_owned()];
        names.extend(held_by.map(|input| self.name(input).to_owned()));
        names.extend(["eigenfrequency", "damping_ratio"].map(String::from));
        names.extend((1..=states).flat_map(|k| ["re", "im"].map(|part| format!("eigenvalue{k}.{part}"))));
        names.extend((1..=states).flat_map(|row| (1..=states).map(move |column| format!("A{row}{column}"))));
        for input in inputs {
            names.extend((1..=states).map(|row| format!("B{row}({})", self.name(*input))));
        }
        for output in outputs {
            names.extend((1..=states).map(|column| format!("C{column}({})", self.name(*output))));
            names.extend(inputs.iter().map(|input| format!("D({}; {})", self.name(*output), self.name(*input))));
        }
        names
    }

    /// One line of the table. NaN stands for a missing value.
    fn row(at: &Linearised) -> Vec<f64> {
        let mut row = vec![at.coordinate, at.acceleration];
        row.extend(at.holding);
        row.extend([at.eigenfrequency(), at.damping_ratio]);
        row.extend(at.eigenvalues.iter().flatten().chain(at.a.iter().flatten()).chain(at.b.iter().flatten()));
        for (c, d) in at.c.iter().zip(&at.d) {
            row.extend(c.iter().chain(d));
        }
        row
    }

    /// The table as CSV.
    fn csv(&self, all: &[Linearised]) -> Result<Vec<u8>> {
        let mut table = csv::WriterBuilder::new().from_writer(Vec::new());
        table.write_record(self.columns(all.first().map_or(0, |at| at.a.len())))?;
        let mut digits = zmij::Buffer::new();
        for at in all {
            for value in Self::row(at) {
                table.write_field(decimal(&mut digits, value))?;
            }
            table.write_record(None::<&[u8]>)?;
        }
        table.into_inner().context("--output-file")
    }

    /// Draw eigenfrequency, damping ratio and eigenvalues over the coordinate.
    fn draw(&self, workspace: &Workspace, path: &Path, title: &str, all: &[Linearised]) -> Result<()> {
        let coordinate = self.what.coordinate;
        let series = |name, unit, value: &dyn Fn(&Linearised) -> f64| Series {
            name,
            unit: Some(unit),
            values: all.iter().map(value).collect(),
        };
        let names: Vec<[String; 2]> = (1..=all.first().map_or(0, |at| at.a.len()))
            .map(|k| ["real", "imaginary"].map(|part| format!("eigenvalue {k}, {part}")))
            .collect();
        let mut lines = vec![
            series("eigenfrequency", Unit::Hertz, &Linearised::eigenfrequency),
            series("damping ratio", Unit::One, &|at| at.damping_ratio),
        ];
        for (k, own) in names.iter().enumerate() {
            for (part, name) in own.iter().enumerate() {
                lines.push(series(name, Unit::PerSecond, &|at| at.eigenvalues[k][part]));
            }
        }
        let x = series(self.name(coordinate), self.unit(coordinate), &|at| at.coordinate);
        plot::write(workspace, path, &format!("{title}: small motions along the travel"), &x, &lines)
    }

    /// The linearisation at the start, one line per number.
    fn in_words(&self, at: &Linearised) -> String {
        let names = self.columns(at.a.len());
        let width = names.iter().map(String::len).max().unwrap_or_default();
        let lines = names.iter().zip(Self::row(at)).map(|(name, value)| format!("{name:width$}  {value:?}\n"));
        lines.collect()
    }
}
