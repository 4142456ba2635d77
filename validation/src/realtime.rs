//! The slowest step of a run, which limits real-time use, with and without `solver.prepare`.
use crate::measure::{self, Pages, digits, heading};
use fmu_build::workspace::{MECHANISM, Workspace};
use linkage_fmu::mechanism::{Model, ModelError};
use linkage_fmu::variables::{Kind, Reference};
use std::fmt::Write;
use std::path::Path;
use std::time::Instant;

/// Numbers of new instances, of which the fastest counts for each step, and numbers of steps: with all outputs read
/// after each step, and over a long run without outputs.
const RUNS: [usize; 2] = [10, 2];
const STEPS: [usize; 2] = [3000, 1_000_000];
/// Length of a step [s].
const STEP: f64 = 1e-3;

/// The table as Markdown and CSV.
pub fn table(_: &Path) -> Result<Pages, String> {
    let [runs, long_runs, steps, long] = [RUNS[0], RUNS[1], STEPS[0], STEPS[1]].map(|count| count.to_string());
    let mut page =
        measure::page("realtime", &[("runs", &runs), ("steps", &steps), ("long_runs", &long_runs), ("long", &long)]);
    let columns = ["doStep, median", "largest", "at step", "all outputs, median", "largest", "at step"];
    page += &heading(&[&["mechanism", "solver.prepare", "initialisation"], &columns[..]].concat());
    let mut whole = String::from("\n## Over a long run, prepared\n\n");
    whole += &heading(&["mechanism", "steps", "doStep, median", "largest", "at step"]);
    let mut csv =
        String::from("mechanism,prepare,start_us,step_median_us,step_largest_us,read_median_us,read_largest_us\n");
    for folder in Workspace::locate().description_folders().map_err(|e| format!("{e:#}"))? {
        if !folder.join("resources").join(MECHANISM).is_file() {
            continue;
        }
        let name = folder.file_name().unwrap_or_default().to_string_lossy();
        let text = measure::mechanism(&folder)?;
        for prepare in [false, true] {
            let run = least(&text, prepare, false).map_err(|e| format!("{name}: {e}"))?;
            let start = run.start * 1e6;
            let [steps, reads] = [run.steps, run.reads].map(Spread::of);
            let _ =
                writeln!(page, "| {name} | {prepare} | {} | {} | {} |", digits(start), steps.cells(), reads.cells());
            let [a, b, c, d] = [steps.median, steps.largest, reads.median, reads.largest];
            let _ = writeln!(csv, "{name},{prepare},{start:.1},{a:.3},{b:.3},{c:.3},{d:.3}");
        }
        let long = least(&text, true, true).map_err(|e| format!("{name}: {e}"))?.steps;
        let _ = writeln!(whole, "| {name} | {} | {} |", long.len(), Spread::of(long).cells());
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

/// All outputs are read after each step except in a long run. The run ends with the first step that returns an error.
fn least(text: &str, prepare: bool, is_long: bool) -> Result<Run, ModelError> {
    let [runs, steps] = [RUNS, STEPS].map(|counts| counts[usize::from(is_long)]);
    let mut least = Run { start: f64::INFINITY, steps: vec![f64::INFINITY; steps], reads: vec![f64::INFINITY; steps] };
    for _ in 0..runs {
        let mut model = Model::from_json(text)?;
        measure::set(&mut model, "solver.prepare", prepare)?;
        let list = (0..).zip(model.variables().list());
        let outputs: Vec<Reference> =
            list.filter(|(_, v)| v.kind == Kind::Real && v.is_output()).map(|(k, _)| k).collect();
        measure::timed(&mut least.start, || model.initialize())?;
        let mut values = Vec::with_capacity(outputs.len());
        for step in 0..least.steps.len() {
            let began = Instant::now();
            if model.step(STEP).is_err() {
                least.steps.truncate(step);
                least.reads.truncate(step);
                break;
            }
            least.steps[step] = least.steps[step].min(began.elapsed().as_secs_f64());
            if is_long {
                continue;
            }
            values.clear();
            measure::timed(&mut least.reads[step], || model.reals(&outputs, |value| values.push(value)))?;
        }
    }
    Ok(least)
}
