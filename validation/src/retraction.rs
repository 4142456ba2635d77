//! Scene S1: run time of a whole retraction against its error.
use crate::asked;
use crate::measure::{self, COLUMNS, Pages, Row};
use linkage_fmu::mechanism::Model;
use std::fmt::Write;
use std::path::Path;
use std::time::Instant;

/// theta2 [rad] at 0.13 s, from a 34-digit energy quadrature.
pub const THETA2: f64 = -1.237_711_726_689_136_7;
/// Its duration [s].
pub const SPAN: f64 = 0.13;
/// Runs of which the fastest counts.
const RUNS: usize = 300;

/// The table in Markdown and CSV.
pub fn table(folder: &Path) -> Result<Pages, String> {
    let text = measure::mechanism(folder)?;
    let began = Instant::now();
    let mut model = Model::from_json(&text).map_err(|e| e.to_string())?;
    let instantiation = began.elapsed().as_secs_f64() * 1e3;
    let mut csv = String::from(COLUMNS);
    let words = format!(
        "Scene S1 (30 kN, load factor 3, from rest, 0.13 s) in the engine, without a host. Error: theta2 at 0.13 s \
         against the 34-digit reference. Time: the fastest of {RUNS} runs, the steps alone, one core. Evaluations: of the \
         right-hand side. Reading and tracing the mechanism took {instantiation:.1} ms, once."
    );
    let mut out = asked::page("Run time of a whole retraction against its error", &words);
    for (title, steps) in
        [("One doStep of 0.13 s", 1), ("130 doSteps of 1 ms", 130), ("13 000 doSteps of 10 us", 13_000)]
    {
        let _ = writeln!(out, "## {title}\n");
        out.push_str(&measure::heading("rad"));
        let runs = (RUNS / (1 + steps as usize / 500)).max(10);
        for exponent in [4, 6, 8, 10, 12, 13] {
            let row = Row::measure(&mut model, 10f64.powi(-exponent), SPAN, steps, runs).map_err(|e| e.to_string())?;
            let error = (measure::output(&mut model, "crank.angle").map_err(|e| e.to_string())? - THETA2).abs();
            out.push_str(&row.line(exponent, error));
            csv.push_str(&row.csv("LandingGearRetraction", steps, exponent, error));
        }
        out.push('\n');
    }
    Ok(Pages { page: out, csv })
}
