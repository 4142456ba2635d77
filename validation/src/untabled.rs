//! Tables against none: the same motion with the right-hand side from tables and from the exact evaluator.

use crate::asked::{self, Asked, digits};
use crate::benchmarks::{ANDREWS_SPAN, K1_ANGLE};
use crate::measure::{self, Pages};
use crate::retraction::{SPAN, THETA2};
use linkage_fmu::mechanism::{Model, ModelError};
use std::fmt::Write;
use std::path::Path;
use std::time::Instant;

/// Runs of which the fastest counts.
const RUNS: usize = 100;

/// One mechanism with an exact value.
struct Case {
    name: &'static str,
    folder: &'static str,
    span: f64,
    output: &'static str,
    exact: f64,
}

const CASES: [Case; 2] = [
    Case {
        name: "landing gear, S1",
        folder: "LandingGearRetraction",
        span: SPAN,
        output: "crank.angle",
        exact: THETA2,
    },
    Case {
        name: "Andrews' squeezer",
        folder: "AndrewsSqueezer",
        span: ANDREWS_SPAN,
        output: "K1.angle",
        exact: K1_ANGLE,
    },
];

/// Time [us], error and evaluations of a span in one doStep.
#[derive(Clone, Copy)]
struct Run {
    time: f64,
    error: f64,
    evaluations: u64,
}

/// The table in Markdown and CSV.
///
/// # Errors
/// A file cannot be read; the engine refuses a setting or a step.
pub fn table(descriptions: &Path) -> Result<Pages, String> {
    let mut rows = String::from(
        "| mechanism | tolerance | tables [us] | none [us] | ratio | error, tables [rad] | error, none [rad] | evaluations |\n\
         |---|---|---|---|---|---|---|---|\n",
    );
    let mut csv = String::from("mechanism,tolerance,tables_us,none_us,ratio,tables_error_rad,none_error_rad\n");
    let mut figures = Vec::new();
    for case in CASES {
        let text = measure::mechanism(&descriptions.join(case.folder))?;
        for exponent in [6, 9, 12] {
            let [with, without] = case.measure(&text, exponent).map_err(|e| format!("{}: {e}", case.name))?;
            let ratio = without.time / with.time;
            let _ = writeln!(
                rows,
                "| {} | 1e-{exponent} | {} | {} | {} | {:.1e} | {:.1e} | {}, {} |",
                case.name,
                digits(with.time),
                digits(without.time),
                digits(ratio),
                with.error,
                without.error,
                with.evaluations,
                without.evaluations
            );
            let _ = writeln!(
                csv,
                "{},1e-{exponent},{:.2},{:.2},{ratio:.2},{:.2e},{:.2e}",
                case.folder, with.time, without.time, with.error, without.error
            );
            if case.folder == "AndrewsSqueezer" {
                let what = format!("Andrews, time without tables over time with, tolerance 1e-{exponent}");
                figures.push(Asked::at_least(what, ratio, 20.0, " times"));
            }
        }
    }
    let words = format!(
        "The same span in one doStep with `solver.tables` true, and false: each evaluation then closes the loops anew. In \
         the engine, one core; the fastest of {RUNS} runs, the two taken in turn, the steps alone. Error: of {} at 0.13 s, \
         of {} at 0.03 s, against the exact values.",
        CASES[0].output, CASES[1].output
    );
    Ok(Pages { page: asked::page("Tables against none", &words) + &asked::table(&figures) + &rows, csv })
}

impl Case {
    /// With tables and without.
    fn measure(&self, text: &str, exponent: i32) -> Result<[Run; 2], ModelError> {
        let ready = |tables: bool| -> Result<Model, ModelError> {
            let mut model = Model::from_json(text)?;
            let reference = model.variables().find("solver.tables").unwrap_or_default();
            model.set_boolean(reference, tables)?;
            model.set_tolerance(10f64.powi(-exponent))?;
            Ok(model)
        };
        let mut models = [ready(true)?, ready(false)?];
        let mut runs = [Run { time: f64::INFINITY, error: 0.0, evaluations: 0 }; 2];
        for _ in 0..RUNS {
            for (run, model) in runs.iter_mut().zip(&mut models) {
                model.initialize()?;
                let began = Instant::now();
                model.step(self.span)?;
                run.time = (began.elapsed().as_secs_f64() * 1e6).min(run.time);
                run.error = (measure::output(model, self.output)? - self.exact).abs();
                run.evaluations = model.statistics().evaluations;
            }
        }
        Ok(runs)
    }
}
