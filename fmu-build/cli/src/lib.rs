//! The command line of `cargo fmu`, without any of its tasks.
//!
//! In: words. Out: a task with its arguments, or help. It must not know the engine, so that it is built in seconds: the
//! first command of a newcomer asks for help.
pub mod installed;
mod libraries;
mod program;
pub mod python;
pub mod words;

use clap::{Args, Parser, Subcommand, ValueEnum};
pub use libraries::{Dist, Fmi, Library, Naming, PLATFORMS, Package, Platform, Test, glibc, library};
pub use program::Program;
use std::ffi::OsString;
use std::path::PathBuf;

/// Builds, tests and demonstrates the FMUs.
#[derive(Parser)]
#[command(name = "cargo fmu", bin_name = "cargo fmu", version, about = "Builds, tests and demonstrates the FMUs")]
pub struct Cli {
    /// The task.
    #[command(subcommand)]
    pub task: Task,
}

/// What `cargo fmu` does.
#[derive(Subcommand)]
pub enum Task {
    /// Pack mechanisms into target/fmu/<Name>.fmu
    Package(Package),
    /// Tell what is wrong with a mechanism, where it can go, and what it weighs
    Check(Check),
    /// Tell what an FMU or a mechanism offers to a host: variables, default experiment, platforms
    Info(Info),
    /// Tell whether an FMU is whole: archive, description, libraries, definition
    Validate(Validate),
    /// Write a page that moves a mechanism in the browser
    View(View),
    /// Run a mechanism or an FMU by the engine itself: CSV, Parquet, plot, film
    Simulate(Simulate),
    /// Write the mechanism of another program as a definition: PMKS, Pyslvs, MuJoCo, URDF, a table of joints
    Import(Import),
    /// Linearise a mechanism along its travel: eigenfrequency, damping ratio, state-space matrices, as CSV and plot
    Linearise(Linearise),
    /// Make the many runs of a study: design of experiments, tolerances, load cases
    Sweep(Sweep),
    /// Find the best design of a mechanism: a response made small under limits of others
    Optimise(Optimise),
    /// Run the retraction through FMPy: figures, table, plot
    Demo(Demo),
    /// Build the documentation as a site that works without a network: target/docs
    Docs(Docs),
    /// Write the mechanism of a chain of N four-bars
    Chain(Chain),
    /// Recompute the papers' figures through FMPy: validation/report.md, report.html and figures
    Report(Report),
    /// Make a Python wheel of this program and the libraries: `pip install` where there is no Rust
    Dist(Dist),
    /// Run every test: Rust, packaging, Python style, FMPy, the documentation, the wheel, pages in a browser
    Test(Test),
    /// Run the benchmarks of the validation package
    Bench(Bench),
}

/// Arguments of `check`.
#[derive(Args)]
pub struct Check {
    /// A definition file (mechanism.json), a folder that holds one, or an FMU
    #[arg(value_name = "PATH", required = true)]
    pub paths: Vec<PathBuf>,
    /// Print findings and facts as JSON, a list with one object for each path
    #[arg(long)]
    pub json: bool,
    /// End with the exit code 1 on warnings too
    #[arg(long)]
    pub deny_warnings: bool,
}

/// Arguments of `info`.
#[derive(Args)]
pub struct Info {
    /// An FMU, a definition file (mechanism.json), or a folder that holds one
    #[arg(value_name = "PATH")]
    pub path: PathBuf,
    /// Print the same as JSON
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `validate`.
#[derive(Args)]
pub struct Validate {
    /// An FMU, a definition file (mechanism.json), or a folder that holds one
    #[arg(value_name = "PATH", required = true)]
    pub paths: Vec<PathBuf>,
}

/// Arguments of `view`.
#[derive(Args, Default)]
pub struct View {
    /// A definition file (mechanism.json), a folder that holds one, or an FMU
    #[arg(value_name = "MECHANISM")]
    pub path: PathBuf,
    /// The page [default: target/view/<Name>.html of the repository]
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Open the page in the browser
    #[arg(long)]
    pub open: bool,
    /// Time to which the motion is computed [s] [default: that of the definition's experiment]
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub stop_time: Option<f64>,
    /// Start values of inputs and parameters, such as: actuator.force 2e4 crank.start_angle 45deg
    #[arg(long, value_name = "NAME VALUE", num_args = 1.., allow_negative_numbers = true)]
    pub start_values: Vec<String>,
}

/// Arguments of `simulate`.
#[derive(Args, Default)]
pub struct Simulate {
    /// A definition file (mechanism.json), a folder that holds one, or an FMU
    #[arg(value_name = "PATH")]
    pub path: PathBuf,
    /// Time at which the run starts [s]
    #[arg(long, value_name = "S", default_value_t = 0.0, allow_negative_numbers = true, value_parser = seconds)]
    pub start_time: f64,
    /// Time at which the run ends [s] [default: that of the definition's experiment]
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = seconds)]
    pub stop_time: Option<f64>,
    /// Time from row to row [s], which is the communication step [default: the experiment's step, doubled to at most
    /// 1000 rows]
    #[arg(long, value_name = "S", value_parser = seconds)]
    pub output_interval: Option<f64>,
    /// Relative tolerance of the integration [default: solver.tolerance]
    #[arg(long, value_name = "REL", value_parser = part)]
    pub relative_tolerance: Option<f64>,
    /// Start values: pairs of a name and a value, or name=value; a number may have the unit or the display unit of the
    /// variable (45deg)
    #[arg(long, value_name = "NAME VALUE", num_args = 1.., allow_negative_numbers = true)]
    pub start_values: Vec<String>,
    /// Inputs over time: a CSV file with the column `time` first. Values between two times are interpolated, Booleans
    /// held; a time that stands twice is a jump
    #[arg(long, value_name = "CSV")]
    pub input_file: Option<PathBuf>,
    /// Set the slopes of the input signals too, so that inputs change within a step; steps end at each time of the file
    #[arg(long, requires = "input_file")]
    pub set_input_derivatives: bool,
    /// Variables to record [default: every output]
    #[arg(long, value_name = "NAME", num_args = 1..)]
    pub output_variables: Vec<String>,
    /// File for the recorded variables, with `time` first: CSV, or Parquet if the name ends in .parquet
    #[arg(long, value_name = "FILE")]
    pub output_file: Option<PathBuf>,
    /// Picture of the recorded variables over time: a .png or .svg file
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// Film of the mechanism in motion: a .gif file
    #[arg(long, value_name = "FILE")]
    pub gif: Option<PathBuf>,
}

/// A time in seconds.
///
/// # Errors
/// The text is no number; one with a unit of time, or with a decimal comma, says what to write.
fn seconds(text: &str) -> Result<f64, String> {
    if let Ok(seconds) = text.parse() {
        return Ok(seconds);
    }
    let number = text.trim_end_matches(char::is_alphabetic);
    let factor = match &text[number.len()..] {
        "" | "s" | "sec" | "second" | "seconds" => 1.0,
        "ms" => 1e-3,
        "min" => 60.0,
        "h" => 3600.0,
        _ => return Err("write a number of seconds, such as 2.5".to_owned()),
    };
    match number.trim().replace(',', ".").parse::<f64>() {
        Ok(value) => Err(format!("write {} (seconds), without a unit", factor * value)),
        Err(_) => Err("write a number of seconds, such as 2.5".to_owned()),
    }
}

/// A part of 1.
///
/// # Errors
/// The text is no number; a percentage, or one with a decimal comma, says what to write.
fn part(text: &str) -> Result<f64, String> {
    if let Ok(part) = text.parse() {
        return Ok(part);
    }
    let (number, of) = text.strip_suffix('%').map_or((text, 1.0), |percent| (percent, 100.0));
    match number.trim().replace(',', ".").parse::<f64>() {
        Ok(value) => Err(format!("write {} (a part of 1), without a unit", value / of)),
        Err(_) => Err("write a part of 1, such as 1e-6".to_owned()),
    }
}

/// Arguments of `import`.
#[derive(Args)]
pub struct Import {
    /// The file, or a link of PMKS or PMKS+ in quotation marks
    #[arg(value_name = "FILE")]
    pub path: PathBuf,
    /// Form of the file [default: as its name or its beginning tells]
    #[arg(long, value_enum, value_name = "FORM")]
    pub form: Option<ImportForm>,
    /// The definition, a .json file [default: standard output]
    #[arg(long, short, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

/// Forms that `import` reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ImportForm {
    /// PMKS: its text, a line for each joint, a link with it, or its JSON
    Pmks,
    /// A file or a link of PMKS+, the web program
    PmksPlus,
    /// An expression of Pyslvs, M[J[...], ...]
    Pyslvs,
    /// MuJoCo's XML
    Mjcf,
    /// ROS's XML
    Urdf,
    /// CSV with the columns type, x, y, angle, links, driven
    Table,
}

/// Arguments of `linearise`.
#[derive(Args, Default)]
pub struct Linearise {
    /// A definition file (mechanism.json), a folder that holds one, or an FMU
    #[arg(value_name = "PATH")]
    pub path: PathBuf,
    /// Angle or position whose value and rate are the two states, such as crank.angle [default: that which states the
    /// start]
    #[arg(long, value_name = "NAME")]
    pub coordinate: Option<String>,
    /// Inputs of the matrices B and D [default: every one on which the acceleration depends]
    #[arg(long, value_name = "NAME", num_args = 1..)]
    pub inputs: Vec<String>,
    /// Outputs of the matrices C and D [default: the coordinate]
    #[arg(long, value_name = "NAME", num_args = 1..)]
    pub outputs: Vec<String>,
    /// Force or torque of a drive that holds the mechanism at each position, such as servo.torque [default: nothing
    /// does, so that only equilibria of the loads are at rest]
    #[arg(long, value_name = "NAME")]
    pub held_by: Option<String>,
    /// Parts of the travel, equal along the curve
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub count: u32,
    /// Start values, as with `simulate`: pairs of a name and a value, or name=value
    #[arg(long, value_name = "NAME VALUE", num_args = 1.., allow_negative_numbers = true)]
    pub start_values: Vec<String>,
    /// File for the travel: CSV
    #[arg(long, value_name = "FILE")]
    pub output_file: Option<PathBuf>,
    /// Picture of eigenfrequency, damping ratio and eigenvalues over the coordinate: a .png or .svg file
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
}

/// Arguments of `sweep`.
#[derive(Args, Default)]
pub struct Sweep {
    /// The study: a JSON file with mechanism, factors, scenario and responses
    #[arg(value_name = "STUDY")]
    pub study: PathBuf,
    /// Folder for the results, runs.parquet [default: target/sweep/<name of the study> in the repository]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Write the results as runs.csv too
    #[arg(long)]
    pub csv: bool,
    /// Draw the results too: page.html for the browser, and pictures as PNG
    #[arg(long)]
    pub page: bool,
    /// Go on with a study that was ended
    #[arg(long)]
    pub resume: bool,
    /// Threads [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Make the runs by the packed FMU on a cluster of so many processes on this machine, by Dask
    #[arg(long, value_name = "N", conflicts_with = "threads", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub workers: Option<u16>,
    /// Make the runs by the packed FMU on the workers of this scheduler of Dask, such as tcp://10.0.0.1:8786
    #[arg(long, value_name = "ADDRESS", conflicts_with_all = ["threads", "workers"])]
    pub scheduler: Option<String>,
}

/// Arguments of `optimise`.
#[derive(Args, Default)]
pub struct Optimise {
    /// The study: a JSON file with mechanism, factors with bounds, scenario, responses and an objective
    #[arg(value_name = "STUDY")]
    pub study: PathBuf,
    /// Folder for the results: the best design, its picture, evaluations.parquet [default: target/optimise/<name of the
    /// study> in the repository]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Write all evaluations as evaluations.csv too
    #[arg(long)]
    pub csv: bool,
    /// Draw the evaluations too: page.html for the browser, and pictures as PNG
    #[arg(long)]
    pub page: bool,
    /// Threads [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
}

/// Arguments of `demo`.
#[derive(Args)]
pub struct Demo {
    /// Retract by the hydraulic actuator: both FMUs coupled by several schemes, beside the FMU of both as one system
    #[arg(long)]
    pub hydraulic: bool,
    /// Draw the mechanisms of docs/gallery in motion, each as a GIF beside its definition
    #[arg(long, conflicts_with = "hydraulic")]
    pub gallery: bool,
    /// Folder for what is written [default: target/demo; with --gallery docs/gallery]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// Arguments of `docs`.
#[derive(Args)]
pub struct Docs {
    /// Open the site in the browser
    #[arg(long)]
    pub open: bool,
}

/// Most four-bars of a chain.
pub const LONGEST_CHAIN: i64 = 80;

/// Arguments of `chain`.
#[derive(Args)]
pub struct Chain {
    /// Number of four-bars, at most 80: packed in 2 s; longer chains are not all accepted where their bars lie flat
    #[arg(value_parser = clap::value_parser!(u32).range(1..=LONGEST_CHAIN))]
    pub count: u32,
    /// A file that ends in .json, or a folder, written as resources/mechanism.json in it [default: standard output]
    #[arg(long, value_name = "PATH")]
    pub out: Option<PathBuf>,
}

/// Arguments of `report`.
#[derive(Args)]
pub struct Report {
    /// Folder for what is written [default: validation in the repository]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// Arguments of `bench`.
#[derive(Args)]
pub struct Bench {
    /// `importers`: the landing gear in FMPy, libcosim, ECOS and fmi-sim; `studies`: many runs by `sweep`, on Dask, by
    /// FMPy and by MuJoCo; `peers`: work against error beside other solvers and
    /// multibody programs; `plots`: figures from the tables' CSV; all else goes to the validation package as it is:
    /// nothing for the tables of run times, `instructions` for callgrind's counts, `cosim` for the coupling of the
    /// packed FMUs by every scheme (`--write` writes the page; `circuit` takes the circuit in plain numbers), `stress`
    /// for the stress suite and 600 random linkages of each property, `attack` for random histories, states,
    /// definitions and scenes, with `--minutes N`, `--seed S`, `--only PART`, `--count N`, `--threads N`, `--verbose`,
    /// `--write`
    #[arg(value_name = "ARGS", trailing_var_arg = true, allow_hyphen_values = true)]
    pub rest: Vec<OsString>,
}
