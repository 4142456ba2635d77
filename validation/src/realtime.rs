//! The slowest step of a run, which limits real-time use, with and without `solver.prepare`.
use crate::attack::random::Random;
use crate::measure::{self, Pages, digits, heading};
use fmu_build::workspace::{MECHANISM, Workspace};
use linkage_fmu::mechanism::{Model, ModelError};
use linkage_fmu::variables::{Causality, Kind, Reference, Variable};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Number of new instances of which the fastest counts for each step: in the default experiment, and in many
/// experiments with other inputs.
const RUNS: [usize; 2] = [10, 2];
/// Number of steps of the many experiments together.
const STEPS: usize = 1_000_000;
/// Length of a step [s].
const STEP: f64 = 1e-3;
/// Factors of the inputs in the many experiments: smallest and largest.
const FACTORS: [f64; 2] = [0.8, 1.2];

/// The table as Markdown and CSV.
pub fn table(_: &Path) -> Result<Pages, String> {
    of(&[])
}

/// The table of the examples with these names, or of all examples without names.
///
/// # Errors
/// A name that no example has, or a call that returns an error.
pub fn of(names: &[&str]) -> Result<Pages, String> {
    let [low, high] = FACTORS;
    let mut page = measure::page(
        "realtime",
        &[("runs", &RUNS[0]), ("passes", &RUNS[1]), ("steps", &STEPS), ("low", &low), ("high", &high)],
    );
    let columns = ["doStep, median", "largest", "at step", "all outputs, median", "largest", "at step"];
    page += &heading(&[&["mechanism", "solver.prepare", "initialisation"], &columns[..]].concat());
    let mut whole = String::from("\n## Many experiments, prepared\n\n");
    whole += &heading(&["mechanism", "steps", "doStep, median", "largest", "at step"]);
    let mut csv =
        String::from("mechanism,prepare,start_us,step_median_us,step_largest_us,read_median_us,read_largest_us\n");
    let mut folders = Workspace::locate().description_folders().map_err(|e| format!("{e:#}"))?;
    folders.retain(|folder| folder.join("resources").join(MECHANISM).is_file());
    let name = |folder: &PathBuf| folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
    if let Some(unknown) = names.iter().find(|own| !folders.iter().any(|folder| name(folder) == **own)) {
        let all: Vec<_> = folders.iter().map(name).collect();
        return Err(format!("realtime {unknown}: there is no such mechanism; the mechanisms are {}", all.join(", ")));
    }
    folders.retain(|folder| names.is_empty() || names.contains(&name(folder).as_str()));
    for folder in folders {
        let name = name(&folder);
        eprintln!("{name} ...");
        let text = measure::mechanism(&folder)?;
        for prepare in [false, true] {
            let run = experiment(&text, prepare).map_err(|e| format!("{name}: {e}"))?;
            let start = run.start * 1e6;
            let [steps, reads] = [run.steps, run.reads].map(Spread::of);
            let _ =
                writeln!(page, "| {name} | {prepare} | {} | {} | {} |", digits(start), steps.cells(), reads.cells());
            let [a, b, c, d] = [steps.median, steps.largest, reads.median, reads.largest];
            let _ = writeln!(csv, "{name},{prepare},{start:.1},{a:.3},{b:.3},{c:.3},{d:.3}");
        }
        let many = experiments(&text).map_err(|e| format!("{name}: {e}"))?;
        let _ = writeln!(whole, "| {name} | {} | {} |", many.len(), Spread::of(many).cells());
    }
    Ok(Pages { page: page + &whole, csv })
}

/// Least times [s] of the parts of one run over several runs.
struct Run {
    start: f64,
    steps: Vec<f64>,
    reads: Vec<f64>,
}

/// Median and largest of some times [us], and the index of the largest.
struct Spread {
    median: f64,
    largest: f64,
    at: usize,
}

impl Spread {
    fn of(times: Vec<f64>) -> Self {
        let (at, largest) =
            (1..).zip(&times).max_by(|a, b| a.1.total_cmp(b.1)).map_or((0, 0.0), |(at, time)| (at, *time));
        let mut times = times;
        times.sort_by(f64::total_cmp);
        let median = times.get(times.len() / 2).copied().unwrap_or(0.0);
        Self { median: median * 1e6, largest: largest * 1e6, at }
    }

    fn cells(&self) -> String {
        format!("{} | {} | {}", digits(self.median), digits(self.largest), self.at)
    }
}

/// The default experiment, with all outputs read after each step. It ends with the first step that returns an error.
fn experiment(text: &str, prepare: bool) -> Result<Run, ModelError> {
    let mut least = Run { start: f64::INFINITY, steps: Vec::new(), reads: Vec::new() };
    for _ in 0..RUNS[0] {
        let mut model = Model::from_json(text)?;
        measure::set(&mut model, "solver.prepare", prepare)?;
        let outputs = references(&model, |variable| variable.is_output());
        measure::timed(&mut least.start, || model.initialize())?;
        let steps = steps(&model);
        least.steps.resize(steps, f64::INFINITY);
        least.reads.resize(steps, f64::INFINITY);
        let mut values = Vec::with_capacity(outputs.len());
        for step in 0..steps {
            if measure::timed(&mut least.steps[step], || model.step(STEP)).is_err() {
                least.steps.truncate(step);
                least.reads.truncate(step);
                break;
            }
            values.clear();
            measure::timed(&mut least.reads[step], || model.reals(&outputs, |value| values.push(value)))?;
        }
    }
    Ok(least)
}

/// Least times [s] of the steps of many experiments, without reading. Each experiment has its own inputs.
fn experiments(text: &str) -> Result<Vec<f64>, ModelError> {
    let mut least = vec![f64::INFINITY; STEPS];
    for _ in 0..RUNS[1] {
        let (mut random, mut model) = (Random::new(1), Model::from_json(text)?);
        let inputs = references(&model, |variable| variable.causality == Causality::Input);
        let starts = inputs.iter().map(|input| model.real(*input)).collect::<Result<Vec<_>, _>>()?;
        let mut left = &mut least[..];
        while !left.is_empty() {
            model.reset();
            measure::set(&mut model, "solver.prepare", true)?;
            for (input, start) in inputs.iter().zip(&starts) {
                let value = start * random.within(FACTORS[0], FACTORS[1]);
                if model.check_real(*input, value).is_ok() {
                    model.set_real(*input, value)?;
                }
            }
            model.initialize()?;
            let (times, rest) = left.split_at_mut(left.len().min(steps(&model)));
            for time in times {
                measure::timed(time, || model.step(STEP))?;
            }
            left = rest;
        }
    }
    Ok(least)
}

/// Number of steps in the default experiment.
fn steps(model: &Model) -> usize {
    (model.experiment().stop_time / STEP).ceil() as usize
}

/// References of the Real variables of some kind.
fn references(model: &Model, of: impl Fn(&Variable) -> bool) -> Vec<Reference> {
    let list = (0..).zip(model.variables().list());
    list.filter(|(_, variable)| variable.kind == Kind::Real && of(variable)).map(|(reference, _)| reference).collect()
}
