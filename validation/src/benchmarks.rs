//! Error against exact values, run time and work: scene S1, published benchmark mechanisms, cost of each further loop,
//! and runs with and without tables. `scenes/known.json` contains the exact values.
use crate::measure::{self, Asked, Pages, digits, heading, timed};
use fmu_build::chain;
use linkage_fmu::mechanism::{Model, ModelError, Statistics};
use serde_json::Value;
use std::fmt::Write;
use std::path::Path;

/// Heading of the CSV.
const COLUMNS: &str = "scene,steps,tolerance,error_rad,time_us,evaluations,accepted,rejected\n";

/// One mechanism with an output whose value at the end of the span is known.
struct Known {
    /// Name in the CSV.
    name: &'static str,
    title: String,
    text: String,
    /// Span [s].
    span: f64,
    /// Output and its exact value [rad].
    output: String,
    exact: f64,
}

impl Known {
    fn read(name: &'static str, descriptions: &Path) -> Result<Self, String> {
        let all: Value = serde_json::from_str(include_str!("../scenes/known.json")).map_err(|e| e.to_string())?;
        let own = &all[name];
        let text = match name.strip_prefix("FourBarChain").and_then(|count| count.parse().ok()) {
            Some(count) => chain::text(count),
            None => measure::mechanism(&descriptions.join(name))?,
        };
        let [span, exact] = ["span", "exact"].map(|key| own[key].as_f64().unwrap_or(f64::NAN));
        let [title, output] = ["title", "output"].map(|key| own[key].as_str().unwrap_or_default().to_owned());
        Ok(Self { name, title, text, span, output, exact })
    }

    fn error(&self, model: &mut Model) -> Result<f64, ModelError> {
        Ok((measure::output(model, &self.output)? - self.exact).abs())
    }

    /// One row for each tolerance 10^-exponent, each the fastest of `runs` runs.
    fn rows(
        &self,
        model: &mut Model,
        steps: u32,
        exponents: [i32; 6],
        runs: usize,
        pages: &mut Pages,
    ) -> Result<(), ModelError> {
        pages.page += &heading(&["tolerance", "error [rad]", "time [us]", "evaluations", "steps", "rejected"]);
        let h = self.span / f64::from(steps);
        for exponent in exponents {
            let mut seconds = f64::INFINITY;
            for _ in 0..runs {
                model.reset();
                model.set_tolerance(10f64.powi(-exponent))?;
                model.initialize()?;
                timed(&mut seconds, || (0..steps).try_for_each(|_| model.step(h)))?;
            }
            let (time, error) = (seconds * 1e6, self.error(model)?);
            let Statistics { evaluations, accepted, rejected, .. } = model.statistics();
            let _ = writeln!(
                pages.page,
                "| 1e-{exponent} | {error:.1e} | {time:.1} | {evaluations} | {accepted} | {rejected} |"
            );
            let _ = writeln!(
                pages.csv,
                "{},{steps},1e-{exponent},{error:.2e},{time:.2},{evaluations},{accepted},{rejected}",
                self.name
            );
        }
        pages.page.push('\n');
        Ok(())
    }

    /// Time [s], error and evaluations of the span in one doStep, with tables and without: the fastest of many runs,
    /// alternating between the two.
    fn tables(&self, exponent: i32, runs: usize) -> Result<[(f64, f64, u64); 2], ModelError> {
        let ready = |tables: bool| -> Result<Model, ModelError> {
            let mut model = Model::from_json(&self.text)?;
            measure::set(&mut model, "solver.tables", tables)?;
            model.set_tolerance(10f64.powi(-exponent))?;
            Ok(model)
        };
        let mut models = [ready(true)?, ready(false)?];
        let mut found = [(f64::INFINITY, 0.0, 0); 2];
        for _ in 0..runs {
            for ((seconds, error, evaluations), model) in found.iter_mut().zip(&mut models) {
                model.initialize()?;
                timed(seconds, || model.step(self.span))?;
                *error = self.error(model)?;
                *evaluations = model.statistics().evaluations;
            }
        }
        Ok(found)
    }
}

/// Scene S1: run time of a whole retraction over its error; the table as Markdown and CSV.
pub fn retraction(descriptions: &Path) -> Result<Pages, String> {
    /// Number of runs; the fastest counts.
    const RUNS: usize = 300;
    let known = Known::read("LandingGearRetraction", descriptions)?;
    let mut instantiation = f64::INFINITY;
    let mut model = timed(&mut instantiation, || Model::from_json(&known.text)).map_err(|e| e.to_string())?;
    let took = format!("{:.1}", instantiation * 1e3);
    let page = measure::page("retraction", &[("runs", &RUNS), ("instantiation", &took)]);
    let mut pages = Pages { page, csv: COLUMNS.into() };
    for (title, steps) in
        [("One doStep of 0.13 s", 1), ("130 doSteps of 1 ms", 130), ("13 000 doSteps of 10 us", 13_000)]
    {
        let _ = writeln!(pages.page, "## {title}\n");
        let runs = (RUNS / (1 + steps as usize / 500)).max(10);
        known.rows(&mut model, steps, [4, 6, 8, 10, 12, 13], runs, &mut pages).map_err(|e| e.to_string())?;
    }
    Ok(pages)
}

/// The published mechanisms; the tables as Markdown and CSV.
pub fn table(descriptions: &Path) -> Result<Pages, String> {
    const SCENES: [(&str, u32); 5] = [
        ("AndrewsSqueezer", 300),
        ("SlCrank", 1000),
        ("FourBarChain2", 1000),
        ("FourBarChain10", 1000),
        ("FourBarChain40", 1000),
    ];
    let mut pages = Pages { page: measure::page("benchmarks", &[]), csv: COLUMNS.into() };
    for (name, many) in SCENES {
        let known = Known::read(name, descriptions)?;
        for steps in [1, many] {
            let mut instantiation = f64::INFINITY;
            let model = timed(&mut instantiation, || Model::from_json(&known.text));
            let _ = writeln!(pages.page, "## {}, {} s in {steps} doSteps\n", known.title, known.span);
            let _ = writeln!(pages.page, "Instantiation {:.1} ms.\n", instantiation * 1e3);
            let rows = model.and_then(|mut model| known.rows(&mut model, steps, [4, 6, 8, 9, 10, 12], 50, &mut pages));
            rows.map_err(|e| format!("{name}: {e}"))?;
        }
    }
    Ok(pages)
}

/// Runs with and without tables: the same motion with the right-hand side from tables and from the exact evaluator; the
/// table as Markdown and CSV.
pub fn untabled(descriptions: &Path) -> Result<Pages, String> {
    /// Number of runs; the fastest counts.
    const RUNS: usize = 100;
    const ANDREWS: &str = "AndrewsSqueezer";
    let times = ["mechanism", "tolerance", "tables [us]", "none [us]", "ratio"];
    let mut rows = heading(&[&times[..], &["error, tables [rad]", "error, none [rad]", "evaluations"]].concat());
    let mut csv = String::from("mechanism,tolerance,tables_us,none_us,ratio,tables_error_rad,none_error_rad\n");
    let mut figures = Vec::new();
    for name in ["LandingGearRetraction", ANDREWS] {
        let known = Known::read(name, descriptions)?;
        for exponent in [6, 9, 12] {
            let [with, without] = known.tables(exponent, RUNS).map_err(|e| format!("{name}: {e}"))?;
            let ((seconds, error, count), (seconds_without, error_without, count_without)) = (with, without);
            let (time, time_without, ratio) = (seconds * 1e6, seconds_without * 1e6, seconds_without / seconds);
            let [a, b, c] = [time, time_without, ratio].map(digits);
            let _ = writeln!(
                rows,
                "| {} | 1e-{exponent} | {a} | {b} | {c} | {error:.1e} | {error_without:.1e} | \
                 {count}, {count_without} |",
                known.title
            );
            let _ = writeln!(
                csv,
                "{name},1e-{exponent},{time:.2},{time_without:.2},{ratio:.2},{error:.2e},{error_without:.2e}"
            );
            if name == ANDREWS {
                let what = format!("Andrews, time without tables over time with, tolerance 1e-{exponent}");
                figures.push(Asked::at_least(what, ratio, 20.0, " times"));
            }
        }
    }
    Ok(Pages { page: measure::page("untabled", &[("runs", &RUNS)]) + &measure::asked(&figures) + &rows, csv })
}
