//! Scene S1: run time of a whole retraction against its error.
use linkage_fmu::model::{Model, Statistics};
use std::fmt::Write;
use std::path::Path;
use std::time::Instant;

/// theta2 [rad] at 0.13 s, from a 34-digit energy quadrature.
const THETA2: f64 = -1.237_711_726_689_136_7;
const SPAN: f64 = 0.13;
/// Runs of which the fastest counts.
const RUNS: usize = 300;

struct Row {
    error: f64,
    microseconds: f64,
    work: Statistics,
}

/// The table in Markdown.
pub fn table(folder: &Path) -> Result<String, String> {
    let path = folder.join("resources/mechanism.json");
    let text = std::fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
    let began = Instant::now();
    let mut model = Model::from_json(&text).map_err(|e| e.to_string())?;
    let instantiation = began.elapsed().as_secs_f64() * 1e3;
    let mut out = String::from("# Run time of a whole retraction against its error\n\n");
    let _ = writeln!(
        out,
        "Scene S1 (30 kN, load factor 3, from rest, 0.13 s) in the engine, without a host. Error: theta2 at 0.13 s \
         against the 34-digit reference. Time: the fastest of {RUNS} runs, the steps alone, one core. Evaluations: of the \
         right-hand side. Reading and tracing the mechanism took {instantiation:.1} ms, once.\n"
    );
    for (title, steps) in
        [("One doStep of 0.13 s", 1), ("130 doSteps of 1 ms", 130), ("13 000 doSteps of 10 us", 13_000)]
    {
        let _ = writeln!(out, "## {title}\n");
        out.push_str(
            "| tolerance | error [rad] | time [us] | evaluations | steps | rejected |\n|---|---|---|---|---|---|\n",
        );
        for exponent in [4, 6, 8, 10, 12, 13] {
            let row = run(&mut model, 10f64.powi(-exponent), steps).map_err(|e| e.to_string())?;
            let Statistics { evaluations, accepted, rejected } = row.work;
            let _ = writeln!(
                out,
                "| 1e-{exponent} | {:.1e} | {:.1} | {evaluations} | {accepted} | {rejected} |",
                row.error, row.microseconds
            );
        }
        out.push('\n');
    }
    Ok(out)
}

fn run(model: &mut Model, tolerance: f64, steps: u32) -> Result<Row, linkage_fmu::model::ModelError> {
    let h = SPAN / f64::from(steps);
    let mut microseconds = f64::INFINITY;
    for _ in 0..(RUNS / (1 + steps as usize / 500)).max(10) {
        model.reset();
        model.set_tolerance(tolerance)?;
        model.initialize()?;
        let began = Instant::now();
        for _ in 0..steps {
            model.step(h)?;
        }
        microseconds = (began.elapsed().as_secs_f64() * 1e6).min(microseconds);
    }
    let angle = model.variables().find("crank.angle").unwrap_or_default();
    let error = (model.real(angle)? - THETA2).abs();
    Ok(Row { error, microseconds, work: model.statistics() })
}
