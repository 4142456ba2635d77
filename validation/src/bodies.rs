//! Cost against the number of bodies: the chain of four-bars, set-up and steps of 10 ms.

use crate::asked::{self, Asked, digits};
use crate::measure::Pages;
use fmu_build::chain::mechanism;
use linkage_fmu::mechanism::{Model, ModelError};
use std::fmt::Write;
use std::time::Instant;

/// Numbers of four-bars.
const COUNTS: [u32; 6] = [1, 2, 5, 10, 20, 40];
/// Steps [s] and their number: 10 s, five turns through both flat positions.
const STEP: f64 = 0.01;
const STEPS: u32 = 1000;
const TOLERANCE: f64 = 1e-9;
/// Runs of which the fastest counts; instantiations, likewise.
const RUNS: usize = 200;
const SETUPS: usize = 9;

/// One chain.
struct Chain {
    count: u32,
    model: Model,
    /// Set-up [ms], from the text to the initialised model.
    setup: f64,
    /// One step [ns].
    step: f64,
}

/// The table in Markdown and CSV.
///
/// # Errors
/// The engine refuses a chain or a step.
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
    let mut rows = String::from(
        "| four-bars | bodies | set-up [ms] | step of 10 ms [ns] | to N = 1 | evaluations a step |\n|---|---|---|---|---|---|\n",
    );
    let mut csv = String::from("count,bodies,setup_ms,step_ns,ratio,evaluations\n");
    let first = chains[0].step;
    for Chain { count, model, setup, step } in &chains {
        let (bodies, ratio) = (2 * count + 1, step / first);
        let evaluations = model.statistics().evaluations as f64 / f64::from(STEPS);
        let _ =
            writeln!(rows, "| {count} | {bodies} | {} | {step:.0} | {ratio:.2} | {evaluations:.2} |", digits(*setup));
        let _ = writeln!(csv, "{count},{bodies},{setup:.3},{step:.1},{ratio:.3},{evaluations:.3}");
    }
    let last = chains.last().map_or(first, |chain| chain.step);
    let figures = [Asked::at_most("step of 10 ms of 40 four-bars against one", last / first, 1.3, " times")];
    let words = format!(
        "Chains of N four-bars (IFToMM A02) for 10 s, which is five turns through both flat positions, at tolerance \
         {TOLERANCE:.0e}, in the engine; one core. Set-up: from the text of the file to the initialised model, the fastest \
         of {SETUPS}. Step: the mean of {STEPS}, of the fastest of {RUNS} runs, the chains taken in turn."
    );
    Ok(Pages { page: asked::page("Cost against the number of bodies", &words) + &asked::table(&figures) + &rows, csv })
}

impl Chain {
    fn new(count: u32) -> Result<Self, ModelError> {
        let text = mechanism::text(count);
        let make = || {
            let began = Instant::now();
            let mut model = Model::from_json(&text)?;
            model.set_tolerance(TOLERANCE)?;
            model.initialize()?;
            Ok::<_, ModelError>((model, began.elapsed().as_secs_f64() * 1e3))
        };
        let (mut model, mut setup) = make()?;
        for _ in 1..SETUPS {
            let (again, time) = make()?;
            (model, setup) = (again, time.min(setup));
        }
        Ok(Self { count, model, setup, step: f64::INFINITY })
    }

    fn run(&mut self) -> Result<(), ModelError> {
        self.model.initialize()?;
        let began = Instant::now();
        for _ in 0..STEPS {
            self.model.step(STEP)?;
        }
        self.step = (began.elapsed().as_secs_f64() * 1e9 / f64::from(STEPS)).min(self.step);
        Ok(())
    }
}
