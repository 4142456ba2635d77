//! Benchmarks: run time over error, on scenes with exact references. Writes its tables next to this package.
/// Text of an example.
macro_rules! example {
    ($name:literal) => {
        include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../modelDescription/", $name, "/resources/mechanism.json"))
    };
}

pub mod attack;
mod benchmarks;
mod bodies;
mod callgrind;
pub mod cosim;
mod designs;
pub mod extrapolation;
mod gear;
mod host;
mod hydraulics;
mod instructions;
pub mod kinds;
mod linear;
mod measure;
mod realtime;
mod rigid_fem;
mod scene;
mod scenes;
mod setup;
mod steps;
pub mod stress;
mod stress_report;
mod versions;

use fmu_build::package;
use fmu_build::workspace::Workspace;
use measure::Pages;
use std::path::{Path, PathBuf};

/// Run the benchmarks named on the command line.
///
/// # Errors
/// Unknown arguments, a call that returns an error, a failed scene, or a file that cannot be written.
pub fn run(arguments: &[&str]) -> Result<(), String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let (results, descriptions) = (root.join("results"), root.join("../modelDescription"));
    match arguments {
        [] => tables(TABLES.iter(), &descriptions, &results),
        names if names.iter().all(|name| TABLES.iter().any(|(own, _)| own == name)) => {
            tables(TABLES.iter().filter(|(own, _)| names.contains(own)), &descriptions, &results)
        }
        ["realtime", mechanisms @ ..] => {
            print!("{}", realtime::of(mechanisms)?.page);
            Ok(())
        }
        ["instructions"] => count(&results),
        ["attack", words @ ..] => attack::run(&results, words),
        ["cosim", "foreign", file] => foreign(Path::new(file)),
        ["cosim", words @ ..] => couple(&results, words),
        ["stress", groups @ ..] => stress_report::run(&results, groups),
        &[instructions::REPEAT, scene, reads, steps, repetitions] => {
            instructions::repeat(&descriptions, [scene, reads, steps, repetitions])
        }
        &[instructions::REPEAT, setup::FIRST, file, folder] => setup::first(Path::new(file), Path::new(folder)),
        &[instructions::REPEAT, hydraulics::NETWORK, runs] => hydraulics::repeat(&descriptions, runs),
        &[versions::CALLS, version, call, repetitions] => {
            versions::repeat(&descriptions.join("LandingGearRetraction"), [version, call, repetitions])
        }
        _ => Err("arguments: none for the tables of run times or names of some, `realtime` with names of mechanisms, \
                 `instructions`, `cosim`, `stress` with names of groups, or `attack` with its options"
            .into()),
    }
}

/// Name of a page, and the function that measures it for a folder of mechanisms.
type Table = (&'static str, fn(&Path) -> Result<Pages, String>);

/// The tables of run times.
const TABLES: [Table; 11] = [
    ("setup", setup::table),
    ("designs", designs::table),
    ("steps", steps::table),
    ("scenes", scenes::table),
    ("realtime", realtime::table),
    ("bodies", |_| bodies::table()),
    ("untabled", benchmarks::untabled),
    ("retraction", benchmarks::retraction),
    ("rigid_fem", rigid_fem::table),
    ("benchmarks", benchmarks::table),
    ("hydraulics", hydraulics::table),
];

fn tables<'a>(mut tables: impl Iterator<Item = &'a Table>, descriptions: &Path, results: &Path) -> Result<(), String> {
    tables.try_for_each(|(name, table)| publish(results, name, &table(descriptions)?))
}

fn count(results: &Path) -> Result<(), String> {
    match instructions::table()? {
        Some(pages) => publish(results, "instructions", &pages),
        None => {
            println!("instructions are not counted: there is no valgrind (Debian: apt-get install valgrind)");
            Ok(())
        }
    }
}

/// The coupling host with an FMU of another exporter.
fn foreign(file: &Path) -> Result<(), String> {
    let name = file.file_stem().ok_or_else(|| format!("{}: no FMU", file.display()))?;
    let fmu = cosim::fmus::Fmu::open(file, &Workspace::locate().target("cosim").join(name))?;
    println!("{}", cosim::fmus::foreign(&fmu)?);
    Ok(())
}

/// Couple the packed FMUs with every scheme; with `circuit`, the gear's FMU and the circuit in plain numbers. With
/// `--write`, write the page.
fn couple(results: &Path, words: &[&str]) -> Result<(), String> {
    if let Some(word) = words.iter().find(|word| !["--write", "circuit"].contains(word)) {
        return Err(format!("cosim {word}: no such word; `circuit` and `--write` are"));
    }
    let workspace = Workspace::locate();
    let open = |name: &str| cosim::fmus::Fmu::open(&pack(name)?, &workspace.target("cosim").join(name));
    let hydraulic = if words.contains(&"circuit") { None } else { Some(open("HydraulicActuator")?) };
    let pages = cosim::table(&cosim::scenes::Fmus { gear: open("LandingGearRetraction")?, hydraulic })?;
    if words.contains(&"--write") {
        return publish(results, "cosim", &pages);
    }
    print!("{}", pages.page);
    Ok(())
}

/// The packed FMU of a description folder.
fn pack(name: &str) -> Result<PathBuf, String> {
    let workspace = Workspace::locate();
    let paths = vec![workspace.descriptions().join(name)];
    let arguments = package::Arguments { paths, ..package::Arguments::of_fmi_2() };
    let files = package::run(&workspace, &arguments).map_err(|e| format!("{e:#}"))?;
    files.into_iter().next().ok_or_else(|| "nothing was packed".to_owned())
}

fn publish(results: &Path, name: &str, pages: &Pages) -> Result<(), String> {
    print!("{}", pages.page);
    for (text, extension) in [(&pages.csv, "csv"), (&pages.page, "md")].into_iter().filter(|(text, _)| !text.is_empty())
    {
        let target = results.join(name).with_extension(extension);
        std::fs::write(&target, text).map_err(|e| format!("{}: {e}", target.display()))?;
        println!("\nwritten to {}", target.display());
    }
    Ok(())
}
