//! The command line of `cargo fmu`, without any of its tasks.
//!
//! In: words. Out: a task with its arguments, or help. The crate must not depend on the engine, so that its build takes
//! seconds: a new user first asks for help.
mod examples;
pub mod installed;
mod libraries;
mod program;
pub mod python;
mod tips;
pub mod words;

use clap::{Args, Parser, Subcommand, ValueEnum};
pub use libraries::{Dist, Fmi, Library, Naming, PLATFORMS, Package, Platform, Test, glibc, library};
pub use program::Program;
use std::ffi::OsString;
use std::path::PathBuf;
pub use tips::parsed;

/// Packs, checks, runs and tests mechanisms as FMUs.
#[derive(Parser)]
#[command(name = "cargo fmu", bin_name = "cargo fmu", version, about = "Pack, check, run and test mechanisms as FMUs")]
pub struct Cli {
    /// The task.
    #[command(subcommand)]
    pub task: Task,
}

/// The commands of `cargo fmu`.
#[derive(Subcommand)]
pub enum Task {
    /// Pack each mechanism as an FMU: <Name>.fmu for FMI 2.0 and <Name>.fmi3.fmu for FMI 3.0
    #[command(after_help = examples::PACKAGE)]
    Package(Package),
    /// Check a mechanism: print errors, warnings, masses, range of motion, drives and equilibria
    #[command(after_help = examples::CHECK)]
    Check(Check),
    /// List the interface of an FMU or a mechanism: variables, default experiment and platforms
    #[command(after_help = examples::INFO)]
    Info(Info),
    /// Check that an FMU is complete and follows the FMI standard
    #[command(after_help = examples::VALIDATE)]
    Validate(Validate),
    /// Write a web page that shows the moving mechanism
    #[command(after_help = examples::VIEW)]
    View(View),
    /// Simulate a mechanism or an FMU without another simulation tool, and write CSV, Parquet, a plot or a film
    #[command(after_help = examples::SIMULATE)]
    Simulate(Simulate),
    /// Convert a file of another program to a definition file: PMKS, PMKS+, Pyslvs, MuJoCo, URDF, SDF or a table of
    /// joints
    #[command(after_help = examples::IMPORT)]
    Import(Import),
    /// Linearise a mechanism along its travel: compute eigenfrequency, damping ratio and state-space matrices
    #[command(after_help = examples::LINEARISE)]
    Linearise(Linearise),
    /// Simulate all variants that a study describes: a design of experiments, tolerances or load cases
    #[command(after_help = examples::SWEEP)]
    Sweep(Sweep),
    /// Search for the best design of a mechanism: minimise or maximise a response within limits
    #[command(after_help = examples::OPTIMISE)]
    Optimise(Optimise),
    /// Simulate the retraction of the example landing gear with FMPy, and write results, table and plot
    #[command(after_help = examples::DEMO)]
    Demo(Demo),
    /// Build the documentation as a website in target/docs, which works without a network
    #[command(after_help = examples::DOCS)]
    Docs(Docs),
    /// Write the definition file of a chain of four-bar linkages, a benchmark for multibody programs
    #[command(after_help = examples::CHAIN)]
    Chain(Chain),
    /// Recompute with FMPy the results of the papers on which the models are based, and write validation/report.md,
    /// report.html and figures
    #[command(after_help = examples::REPORT)]
    Report(Report),
    /// Build a Python wheel of this program, for machines without Rust
    #[command(after_help = examples::DIST)]
    Dist(Dist),
    /// Run all tests: Rust, packaging, Python style, FMPy, documentation, Python wheel, and pages in a browser
    #[command(after_help = examples::TEST)]
    Test(Test),
    /// Run a benchmark, such as a comparison of run times
    #[command(after_help = examples::BENCH)]
    Bench(Bench),
}

/// Arguments of `check`.
#[derive(Args)]
pub struct Check {
    /// Definition file (mechanism.json), folder that contains a definition file, or FMU
    #[arg(value_name = "PATH", required = true)]
    pub paths: Vec<PathBuf>,
    /// Print the errors, warnings and computed values as a JSON list with one object for each path
    #[arg(long)]
    pub json: bool,
    /// Exit with code 1 also if there is a warning [default: code 1 only if there is an error]
    #[arg(long)]
    pub deny_warnings: bool,
}

/// Arguments of `info`.
#[derive(Args)]
pub struct Info {
    /// FMU, definition file (mechanism.json), or folder that contains a definition file
    #[arg(value_name = "PATH")]
    pub path: PathBuf,
    /// Print the interface of the FMU as JSON
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `validate`.
#[derive(Args)]
pub struct Validate {
    /// FMU, definition file (mechanism.json), or folder that contains a definition file
    #[arg(value_name = "PATH", required = true)]
    pub paths: Vec<PathBuf>,
}

/// Arguments of `view`.
#[derive(Args, Default)]
pub struct View {
    /// Definition file (mechanism.json), folder that contains a definition file, or FMU
    #[arg(value_name = "MECHANISM")]
    pub path: PathBuf,
    /// File for the page, or folder in which the page <Name>.html is written [default: target/view in the repository]
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Open the page in the browser
    #[arg(long)]
    pub open: bool,
    /// Open a page with an editor for the definition next to the moving mechanism. The page of --live shows the motion
    /// after each change, until you stop the command with Ctrl-C
    #[arg(long, conflicts_with_all = ["out", "start_values", "compare", "compare_set"])]
    pub live: bool,
    /// Network port on 127.0.0.1 for the page that --live opens [default: a free port]
    #[arg(
        long, value_name = "PORT", requires = "live",
        conflicts_with_all = ["out", "start_values", "compare", "compare_set"]
    )]
    pub port: Option<u16>,
    /// End time of the motion in seconds [default: stop_time of the definition]
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub stop_time: Option<f64>,
    /// Start values of inputs and parameters: pairs of a variable name and a value, such as actuator.force 2e4
    /// crank.start_angle 45deg [default: values of the definition]
    #[arg(long, value_name = "NAME VALUE", num_args = 1.., allow_negative_numbers = true)]
    pub start_values: Vec<String>,
    /// Second definition or FMU for comparison. The drawing and the plots show the second mechanism with dashed lines
    #[arg(long, value_name = "MECHANISM")]
    pub compare: Option<PathBuf>,
    /// Start values of the second run, in the form of --start-values. A value in --compare-set replaces the value of
    /// the same variable in --start-values. Without --compare, the second run uses the definition of the first run
    #[arg(long, value_name = "NAME VALUE", num_args = 1.., allow_negative_numbers = true)]
    pub compare_set: Vec<String>,
}

/// Arguments of `simulate`.
#[derive(Args, Default)]
pub struct Simulate {
    /// Definition file (mechanism.json), folder that contains a definition file, or FMU
    #[arg(value_name = "PATH")]
    pub path: PathBuf,
    /// Start time of the run in seconds
    #[arg(long, value_name = "S", default_value_t = 0.0, allow_negative_numbers = true, value_parser = seconds)]
    pub start_time: f64,
    /// End time of the run in seconds [default: stop_time of the definition]
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = seconds)]
    pub stop_time: Option<f64>,
    /// Time between two rows of the output in seconds, which is also the communication step [default: step_size of the
    /// definition, doubled until there are at most 1000 rows]
    #[arg(long, value_name = "S", value_parser = seconds)]
    pub output_interval: Option<f64>,
    /// Relative tolerance of the integration, a fraction of 1 such as 1e-6 [default: solver.tolerance of the
    /// definition]
    #[arg(long, value_name = "REL", value_parser = part)]
    pub relative_tolerance: Option<f64>,
    /// File with start values of inputs and parameters: a parameter set of the SSP standard (.ssv). The program
    /// converts each value from its unit in the file to the unit of the variable. A value in --start-values replaces
    /// the value of the same variable in the file
    #[arg(long, value_name = "SSV")]
    pub parameters: Option<PathBuf>,
    /// Start values of inputs and parameters: pairs of a variable name and a value, or name=value. A number without a
    /// unit is in SI units. A number can have a unit: the display unit of the variable (45deg), or a common unit (30kN)
    /// [default: values of the definition]
    #[arg(long, value_name = "NAME VALUE", num_args = 1.., allow_negative_numbers = true)]
    pub start_values: Vec<String>,
    /// CSV file with inputs over time. The first column of the file is `time` in seconds. Numeric inputs change
    /// linearly between two rows. Boolean inputs keep their value until the next row. Two rows with equal times define
    /// a jump of the inputs
    #[arg(long, value_name = "CSV")]
    pub input_file: Option<PathBuf>,
    /// Also set the time derivatives of the inputs, so that the inputs change within a communication step. A
    /// communication step then ends at each time of the input file
    #[arg(long, requires = "input_file")]
    pub set_input_derivatives: bool,
    /// Variables to record [default: all outputs]
    #[arg(long, value_name = "NAME", num_args = 1..)]
    pub output_variables: Vec<String>,
    /// File for the recorded variables: Parquet if the name ends in .parquet, otherwise CSV. The first column of the
    /// file is `time` in seconds
    #[arg(long, value_name = "FILE")]
    pub output_file: Option<PathBuf>,
    /// File for a plot of the recorded variables (.png, .svg or .pdf). The option --plot needs Python
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// Variable on the horizontal axis of the plot. The program also records this variable [default: time]
    #[arg(long, value_name = "VARIABLE", requires = "plot")]
    pub x: Option<String>,
    /// File for a film of the moving mechanism (.gif)
    #[arg(long, value_name = "FILE")]
    pub gif: Option<PathBuf>,
}

/// A time in seconds.
///
/// # Errors
/// The text is no number. For a unit of time and for a decimal comma the message states the correct text.
fn seconds(text: &str) -> Result<f64, String> {
    if let Ok(seconds) = text.parse() {
        return Ok(seconds);
    }
    if let Some(fault) = words::comma(text) {
        return Err(fault);
    }
    let number = text.trim_end_matches(char::is_alphabetic);
    let factor = match &text[number.len()..] {
        "" | "s" | "sec" | "second" | "seconds" => 1.0,
        "ms" => 1e-3,
        "min" => 60.0,
        "h" => 3600.0,
        _ => return Err("write a number of seconds, such as 2.5".to_owned()),
    };
    match number.trim().parse::<f64>() {
        Ok(value) => Err(format!("write {} (seconds), without a unit", factor * value)),
        Err(_) => Err("write a number of seconds, such as 2.5".to_owned()),
    }
}

/// A number from 0 to 1.
///
/// # Errors
/// The text is no number. For a percentage and for a decimal comma the message states the correct text.
fn part(text: &str) -> Result<f64, String> {
    if let Ok(part) = text.parse() {
        return Ok(part);
    }
    if let Some(fault) = words::comma(text) {
        return Err(fault);
    }
    let (number, of) = text.strip_suffix('%').map_or((text, 1.0), |percent| (percent, 100.0));
    match number.trim().parse::<f64>() {
        Ok(value) => Err(format!("write {} (a fraction of 1), without a unit", value / of)),
        Err(_) => Err("write a fraction of 1, such as 1e-6".to_owned()),
    }
}

/// Arguments of `import`.
#[derive(Args)]
pub struct Import {
    /// File to convert, or the web address (URL) of a mechanism in PMKS or PMKS+, in quotation marks
    #[arg(value_name = "FILE")]
    pub path: PathBuf,
    /// Format of the file [default: recognised from the file name or the first characters of the file]
    #[arg(long, value_enum, value_name = "FORM")]
    pub form: Option<ImportForm>,
    /// File for the converted definition (.json) [default: standard output]
    #[arg(long, short, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

/// Formats that `import` reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ImportForm {
    /// PMKS: text with one line for each joint, a web address, or JSON
    Pmks,
    /// PMKS+ (web program): a file, or a web address
    PmksPlus,
    /// Pyslvs: an expression M[J[...], ...]
    Pyslvs,
    /// MJCF file of MuJoCo (XML)
    Mjcf,
    /// URDF file of ROS (XML)
    Urdf,
    /// SDF file of Gazebo (XML)
    Sdf,
    /// Table of joints: CSV file with the columns type, x (in m), y (in m), angle (in degrees), links and driven
    Table,
}

/// Arguments of `linearise`.
#[derive(Args, Default)]
pub struct Linearise {
    /// Definition file (mechanism.json), folder that contains a definition file, or FMU
    #[arg(value_name = "PATH")]
    pub path: PathBuf,
    /// Coordinate of the linearisation: an angle or a position, such as crank.angle. The coordinate and its time
    /// derivative are the first two states [default: the coordinate that the key `start` of the definition names]
    #[arg(long, value_name = "NAME")]
    pub coordinate: Option<String>,
    /// Inputs of the model, which define the columns of the matrices B and D [default: all inputs on which the
    /// acceleration depends]
    #[arg(long, value_name = "NAME", num_args = 1..)]
    pub inputs: Vec<String>,
    /// Outputs of the model, which define the rows of the matrices C and D [default: the coordinate of the
    /// linearisation]
    #[arg(long, value_name = "NAME", num_args = 1..)]
    pub outputs: Vec<String>,
    /// Force or torque of the drive that holds the mechanism at each position, such as servo.torque [default: no drive
    /// holds the mechanism, which is then in equilibrium only at some positions]
    #[arg(long, value_name = "NAME")]
    pub held_by: Option<String>,
    /// Number of equal parts into which the program divides the travel
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub count: u32,
    /// Start values of inputs and parameters: pairs of a variable name and a value, or name=value [default: values of
    /// the definition]
    #[arg(long, value_name = "NAME VALUE", num_args = 1.., allow_negative_numbers = true)]
    pub start_values: Vec<String>,
    /// CSV file for the results along the travel [default: standard output]
    #[arg(long, value_name = "FILE")]
    pub output_file: Option<PathBuf>,
    /// File for a plot of eigenfrequency, damping ratio and eigenvalues over the coordinate (.png, .svg or .pdf). The
    /// option --plot needs Python
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
}

/// Arguments of `sweep`.
#[derive(Args, Default)]
pub struct Sweep {
    /// Study file (JSON), which names the mechanism, its factors, the scenario and the responses
    #[arg(value_name = "STUDY")]
    pub study: PathBuf,
    /// Folder for the results, such as runs.parquet [default: target/sweep/<name of the study> in the repository]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Also write the results of all runs as a CSV file, runs.csv
    #[arg(long)]
    pub csv: bool,
    /// Also draw the results of the study: write page.html for the browser, and PNG pictures
    #[arg(long)]
    pub page: bool,
    /// Continue a study that was stopped before its last run
    #[arg(long)]
    pub resume: bool,
    /// Number of threads that simulate the runs [default: one for each processor core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Number of Dask worker processes on this machine. The workers simulate the runs with the FMU [default: threads of
    /// this program simulate the runs]
    #[arg(long, value_name = "N", conflicts_with = "threads", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub workers: Option<u16>,
    /// Address of a Dask scheduler, such as tcp://10.0.0.1:8786. The workers of the scheduler simulate the runs with
    /// the FMU
    #[arg(long, value_name = "ADDRESS", conflicts_with_all = ["threads", "workers"])]
    pub scheduler: Option<String>,
}

/// Arguments of `optimise`.
#[derive(Args, Default)]
pub struct Optimise {
    /// Study file (JSON), which names the mechanism, the factors with their bounds, the scenario, the responses and an
    /// objective
    #[arg(value_name = "STUDY")]
    pub study: PathBuf,
    /// Folder for the results (best design, its picture, evaluations.parquet) [default: target/optimise/<name of the
    /// study> in the repository]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Also write all evaluations as a CSV file, evaluations.csv
    #[arg(long)]
    pub csv: bool,
    /// Also draw the evaluations of the study: write page.html for the browser, and PNG pictures
    #[arg(long)]
    pub page: bool,
    /// Number of threads that simulate the runs [default: one for each processor core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
}

/// Arguments of `demo`.
#[derive(Args)]
pub struct Demo {
    /// Retract the landing gear with the hydraulic actuator. The demo compares two FMUs, which are coupled in several
    /// ways, with one FMU that contains both models
    #[arg(long)]
    pub hydraulic: bool,
    /// Retract and extend a landing gear with door, locks and one hydraulic system. The models are three FMUs of an SSP
    /// package
    #[arg(long, conflicts_with = "hydraulic")]
    pub system: bool,
    /// Write a film of each mechanism in docs/gallery, as a GIF file next to the definition
    #[arg(long, conflicts_with_all = ["hydraulic", "system"])]
    pub gallery: bool,
    /// Folder for the results [default: target/demo, or docs/gallery with --gallery]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// Arguments of `docs`.
#[derive(Args)]
pub struct Docs {
    /// Open the website in the browser
    #[arg(long)]
    pub open: bool,
}

/// Largest number of four-bars of a chain.
pub const LONGEST_CHAIN: i64 = 80;

/// Arguments of `chain`.
#[derive(Args)]
pub struct Chain {
    /// Number of four-bar linkages, at most 80
    #[arg(value_parser = clap::value_parser!(u32).range(1..=LONGEST_CHAIN))]
    pub count: u32,
    /// File for the definition (.json), or folder in which resources/mechanism.json is written [default: standard
    /// output]
    #[arg(long, value_name = "PATH")]
    pub out: Option<PathBuf>,
}

/// Arguments of `report`.
#[derive(Args)]
pub struct Report {
    /// Folder for the results [default: validation in the repository]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// Arguments of `bench`.
#[derive(Args)]
pub struct Bench {
    /// Name of the benchmark, followed by its options. The end of this help lists the benchmarks [default: the
    /// benchmark of the run times]
    #[arg(value_name = "ARGS", trailing_var_arg = true, allow_hyphen_values = true)]
    pub rest: Vec<OsString>,
}
