//! Tables against none: the same motion with the right-hand side from tables and from the exact evaluator.

use crate::benchmarks::{ANDREWS_SPAN, K1_ANGLE};
use crate::measure::{self, Asked, Pages, digits, heading, timed};
use crate::scene::{SPAN, THETA2};
use linkage_fmu::mechanism::{Model, ModelError};
use std::fmt::Write;
use std::path::Path;

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

const GEAR: &str = "LandingGearRetraction";
const ANDREWS: &str = "AndrewsSqueezer";
const CASES: [Case; 2] = [
    Case { name: "landing gear, S1", folder: GEAR, span: SPAN, output: "crank.angle", exact: THETA2 },
    Case { name: "Andrews' squeezer", folder: ANDREWS, span: ANDREWS_SPAN, output: "K1.angle", exact: K1_ANGLE },
];

/// Time [s], error and evaluations of a span in one doStep.
type Run = (f64, f64, u64);

/// The table in Markdown and CSV.
pub fn table(descriptions: &Path) -> Result<Pages, String> {
    let times = ["mechanism", "tolerance", "tables [us]", "none [us]", "ratio"];
    let mut rows = heading(&[&times[..], &["error, tables [rad]", "error, none [rad]", "evaluations"]].concat());
    let mut csv = String::from("mechanism,tolerance,tables_us,none_us,ratio,tables_error_rad,none_error_rad\n");
    let mut figures = Vec::new();
    for case in CASES {
        let text = measure::mechanism(&descriptions.join(case.folder))?;
        for exponent in [6, 9, 12] {
            let [with, without] = case.measure(&text, exponent).map_err(|e| format!("{}: {e}", case.name))?;
            let ((seconds, error, evaluations), (seconds_without, error_without, evaluations_without)) =
                (with, without);
            let (time, time_without, ratio) = (seconds * 1e6, seconds_without * 1e6, seconds_without / seconds);
            let _ = writeln!(
                rows,
                "| {} | 1e-{exponent} | {} | {} | {} | {error:.1e} | {error_without:.1e} | {evaluations}, \
                 {evaluations_without} |",
                case.name,
                digits(time),
                digits(time_without),
                digits(ratio)
            );
            let _ = writeln!(
                csv,
                "{},1e-{exponent},{time:.2},{time_without:.2},{ratio:.2},{error:.2e},{error_without:.2e}",
                case.folder
            );
            if case.folder == ANDREWS {
                let what = format!("Andrews, time without tables over time with, tolerance 1e-{exponent}");
                figures.push(Asked::at_least(what, ratio, 20.0, " times"));
            }
        }
    }
    let words = format!(
        "The same span in one doStep with `solver.tables` true, and false: each evaluation then closes the loops anew. \
         In \
         the engine, one core; the fastest of {RUNS} runs, the two taken in turn, the steps alone. Error: of {} at \
         0.13 s, \
         of {} at 0.03 s, against the exact values.",
        CASES[0].output, CASES[1].output
    );
    Ok(Pages { page: measure::page("Tables against none", &words) + &measure::asked(&figures) + &rows, csv })
}

impl Case {
    /// With tables and without.
    fn measure(&self, text: &str, exponent: i32) -> Result<[Run; 2], ModelError> {
        let ready = |tables: bool| -> Result<Model, ModelError> {
            let mut model = Model::from_json(text)?;
            measure::set(&mut model, "solver.tables", tables)?;
            model.set_tolerance(10f64.powi(-exponent))?;
            Ok(model)
        };
        let mut models = [ready(true)?, ready(false)?];
        let mut runs = [(f64::INFINITY, 0.0, 0); 2];
        for _ in 0..RUNS {
            for ((seconds, error, evaluations), model) in runs.iter_mut().zip(&mut models) {
                model.initialize()?;
                timed(seconds, || model.step(self.span))?;
                *error = (measure::output(model, self.output)? - self.exact).abs();
                *evaluations = model.statistics().evaluations;
            }
        }
        Ok(runs)
    }
}
