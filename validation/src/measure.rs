//! One measurement: a span of a model in equal doSteps, timed, with its row in a table.
use linkage_fmu::mechanism::{Model, ModelError, Statistics};
use std::path::Path;
use std::time::Instant;

/// What one benchmark writes: Markdown to read, CSV to draw.
pub struct Pages {
    /// Markdown.
    pub page: String,
    /// CSV, with a heading.
    pub csv: String,
}

/// Head of a CSV of rows with their scene, number of doSteps and error.
pub const COLUMNS: &str = "scene,steps,tolerance,error_rad,time_us,evaluations,accepted,rejected\n";

/// What one tolerance gives.
pub struct Row {
    microseconds: f64,
    work: Statistics,
}

/// The text of a description folder's mechanism.
pub fn mechanism(folder: &Path) -> Result<String, String> {
    let path = folder.join("resources/mechanism.json");
    std::fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))
}

/// Present value of an output.
pub fn output(model: &mut Model, name: &str) -> Result<f64, ModelError> {
    let reference = model.variables().find(name).unwrap_or_default();
    model.real(reference)
}

/// Head of a table whose errors have this unit.
pub fn heading(unit: &str) -> String {
    format!("| tolerance | error [{unit}] | time [us] | evaluations | steps | rejected |\n|---|---|---|---|---|---|\n")
}

impl Row {
    /// The fastest of `runs` runs over the span; the model is left at its end.
    pub fn measure(model: &mut Model, tolerance: f64, span: f64, steps: u32, runs: usize) -> Result<Self, ModelError> {
        let h = span / f64::from(steps);
        let mut microseconds = f64::INFINITY;
        for _ in 0..runs {
            model.reset();
            model.set_tolerance(tolerance)?;
            model.initialize()?;
            let began = Instant::now();
            for _ in 0..steps {
                model.step(h)?;
            }
            microseconds = (began.elapsed().as_secs_f64() * 1e6).min(microseconds);
        }
        Ok(Self { microseconds, work: model.statistics() })
    }

    /// The line for tolerance 10^-exponent.
    pub fn line(&self, exponent: i32, error: f64) -> String {
        let Statistics { evaluations, accepted, rejected, .. } = self.work;
        let time = self.microseconds;
        format!("| 1e-{exponent} | {error:.1e} | {time:.1} | {evaluations} | {accepted} | {rejected} |\n")
    }

    /// The same in CSV, under `COLUMNS`.
    pub fn csv(&self, scene: &str, steps: u32, exponent: i32, error: f64) -> String {
        let Statistics { evaluations, accepted, rejected, .. } = self.work;
        let time = self.microseconds;
        format!("{scene},{steps},1e-{exponent},{error:.2e},{time:.2},{evaluations},{accepted},{rejected}\n")
    }
}
