//! `stress`: all scenes, printed when complete, and written as a table.
use crate::measure::{heading, processor};
use crate::stress::{self, Outcome, Row, Verdict};
use std::fmt::Write;
use std::path::Path;
use std::time::Instant;

/// Meaning of the columns, and derivation of the bounds.
const HEAD: &str = include_str!("stress_report.md");
const THREADS: usize = 2;

/// Run, print, and write `stress.csv` and `stress.md`; with some groups named, run only those and write nothing.
pub fn run(results: &Path, groups: &[&str]) -> Result<(), String> {
    let mut scenes = stress::all();
    scenes.retain(|scene| groups.is_empty() || groups.contains(&scene.group));
    let began = Instant::now();
    let report = |place: usize, outcome: &Outcome| println!("{}", line(&scenes[place], outcome, ", "));
    let outcomes = stress::judge(&scenes, THREADS, &report);
    let seconds = began.elapsed().as_secs_f64();
    let count = |verdict| outcomes.iter().filter(|o| o.verdict == verdict).count();
    let [holds, refused, fails] = [Verdict::Holds, Verdict::Refused, Verdict::Fails].map(count);
    let summary = format!(
        "**{} rows: {holds} hold, {refused} rejected as expected, {fails} fail.** {seconds:.0} s on {THREADS} threads \
         of {}.",
        outcomes.len(),
        processor().unwrap_or_else(|| "an unknown processor".into())
    );
    let mut page = format!("{HEAD}\n{summary}\n");
    let mut csv = format!("group,{COLUMNS}\n");
    let mut group = "";
    for (scene, outcome) in scenes.iter().zip(&outcomes) {
        if scene.group != group {
            group = scene.group;
            page += &format!("\n## {group}\n\n{}", heading(&COLUMNS.split(',').collect::<Vec<_>>()));
        }
        let _ = writeln!(page, "| {} |", line(scene, outcome, " | "));
        let fields = fields(scene, outcome)
            .map(|f| if f.contains([',', '"']) { format!("\"{}\"", f.replace('"', "\"\"")) } else { f });
        let _ = writeln!(csv, "{group},{}", fields.join(","));
    }
    for (name, text) in [("stress.md", page), ("stress.csv", csv)].into_iter().filter(|_| groups.is_empty()) {
        let target = results.join(name);
        std::fs::write(&target, text).map_err(|e| format!("{}: {e}", target.display()))?;
        println!("written to {}", target.display());
    }
    println!("{summary}");
    if outcomes.len() != scenes.len() {
        return Err("a thread ended early: rows are missing".into());
    }
    if fails > 0 { Err(format!("{fails} scenes fail")) } else { Ok(()) }
}

/// Columns of a row; in the CSV preceded by the group.
const COLUMNS: &str =
    "mechanism,scene,tolerance,error,bound,drift [J],bound [J],steps,evaluations,rejected,CPU [ms],verdict,why";

fn fields(scene: &Row, outcome: &Outcome) -> [String; 13] {
    let pair = |values: Option<(f64, f64)>| {
        values.map_or([String::new(), String::new()], |(value, bound)| [format!("{value:.1e}"), format!("{bound:.1e}")])
    };
    let ([error, bound], [drift, drift_bound]) = (pair(outcome.error), pair(outcome.drift));
    [
        scene.model.into(),
        scene.what.clone(),
        format!("{:.0e}", scene.tolerance),
        error,
        bound,
        drift,
        drift_bound,
        outcome.work.accepted.to_string(),
        outcome.work.evaluations.to_string(),
        outcome.work.rejected.to_string(),
        format!("{:.3}", 1e3 * outcome.cpu),
        outcome.verdict.word().into(),
        outcome.why.clone(),
    ]
}

fn line(scene: &Row, outcome: &Outcome, separator: &str) -> String {
    fields(scene, outcome).join(separator)
}
