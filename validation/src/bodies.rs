//! Run time over the number of bodies: a chain of four-bars, set-up and steps of 10 ms.

use crate::measure::{self, Asked, Pages, digits, heading, timed};
use fmu_build::chain;
use linkage_fmu::mechanism::{Model, ModelError};
use std::fmt::{Display, Write};

/// Numbers of four-bars.
const COUNTS: [u32; 6] = [1, 2, 5, 10, 20, 40];
/// Length of a step [s], and number of steps: 10 s, five turns through both flat positions.
const STEP: f64 = 0.01;
const STEPS: u32 = 1000;
const TOLERANCE: f64 = 1e-9;
/// Number of runs and of instantiations; the fastest of each counts.
const RUNS: usize = 200;
const SETUPS: usize = 9;

/// One chain.
struct Chain {
    count: u32,
    model: Model,
    /// Set-up [ms], from the text to the initialised model.
    setup: f64,
    /// Run time of all steps of a run [s].
    run: f64,
}

/// The table as Markdown and CSV.
pub fn table() -> Result<Pages, String> {
    measure().map_err(|e| e.to_string())
}

fn measure() -> Result<Pages, ModelError> {
    let mut chains = COUNTS.iter().map(|&count| Chain::new(count)).collect::<Result<Vec<_>, _>>()?;
    for _ in 0..RUNS {
        for chain in &mut chains {
            chain.run()?;
        }
    }
    let mut rows =
        heading(&["four-bars", "bodies", "set-up [ms]", "step of 10 ms [ns]", "to N = 1", "evaluations a step"]);
    let mut csv = String::from("count,bodies,setup_ms,step_ns,ratio,evaluations\n");
    let step_of = |chain: &Chain| chain.run * 1e9 / f64::from(STEPS);
    let first = step_of(&chains[0]);
    for chain in &chains {
        let Chain { count, model, setup, .. } = chain;
        let step = step_of(chain);
        let (bodies, ratio) = (2 * count + 1, step / first);
        let evaluations = model.statistics().evaluations as f64 / f64::from(STEPS);
        let _ =
            writeln!(rows, "| {count} | {bodies} | {} | {step:.0} | {ratio:.2} | {evaluations:.2} |", digits(*setup));
        let _ = writeln!(csv, "{count},{bodies},{setup:.3},{step:.1},{ratio:.3},{evaluations:.3}");
    }
    let last = chains.last().map_or(first, step_of);
    let figures = [Asked::at_most("step of 10 ms of 40 four-bars against one", last / first, 1.3, " times")];
    let tolerance = format!("{TOLERANCE:.0e}");
    let values: [(&str, &dyn Display); 4] =
        [("tolerance", &tolerance), ("setups", &SETUPS), ("steps", &STEPS), ("runs", &RUNS)];
    Ok(Pages { page: measure::page("bodies", &values) + &measure::asked(&figures) + &rows, csv })
}

impl Chain {
    fn new(count: u32) -> Result<Self, ModelError> {
        let text = chain::text(count);
        let make = || {
            let mut model = Model::from_json(&text)?;
            model.set_tolerance(TOLERANCE)?;
            model.initialize()?;
            Ok::<_, ModelError>(model)
        };
        let mut setup = f64::INFINITY;
        let mut model = timed(&mut setup, make)?;
        for _ in 1..SETUPS {
            model = timed(&mut setup, make)?;
        }
        Ok(Self { count, model, setup: setup * 1e3, run: f64::INFINITY })
    }

    fn run(&mut self) -> Result<(), ModelError> {
        self.model.initialize()?;
        timed(&mut self.run, || (0..STEPS).try_for_each(|_| self.model.step(STEP)))
    }
}
