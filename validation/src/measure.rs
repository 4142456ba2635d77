//! Common functions of the benchmarks: read, set and time a model; required and measured values; the machine of the
//! measurement.
use linkage_fmu::mechanism::{Model, ModelError};
use linkage_fmu::simulation::Settable;
use std::fmt::Display;
use std::path::Path;
use std::time::Instant;

/// Output of one benchmark: Markdown to read, CSV to draw.
pub struct Pages {
    /// Markdown.
    pub page: String,
    /// CSV with a heading; empty if no figure uses it.
    pub csv: String,
}

/// The text of a description folder's mechanism.
pub fn mechanism(folder: &Path) -> Result<String, String> {
    let path = folder.join("resources/mechanism.json");
    std::fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))
}

/// Present value of an output; NaN, which fails every limit, if it is undefined.
pub fn output(model: &mut Model, name: &str) -> Result<f64, ModelError> {
    let reference = model.variables().find(name).unwrap_or_default();
    model.real(reference)
}

/// Set a variable by its name.
pub fn set(model: &mut Model, name: &str, value: impl Settable) -> Result<(), ModelError> {
    let reference = model.variables().find(name).unwrap_or_default();
    value.set(model, reference)
}

/// Make a call and keep its time [s] in `least` if it is less. The result is dropped after the time is taken.
pub fn timed<T>(least: &mut f64, call: impl FnOnce() -> T) -> T {
    let began = Instant::now();
    let given = std::hint::black_box(call());
    *least = least.min(began.elapsed().as_secs_f64());
    given
}

/// Heading of a table in Markdown.
pub fn heading(columns: &[&str]) -> String {
    format!("| {} |\n|{}\n", columns.join(" | "), "---|".repeat(columns.len()))
}

/// A measured value with its limit.
pub struct Asked {
    what: String,
    unit: &'static str,
    measured: f64,
    limit: f64,
    at_least: bool,
}

impl Asked {
    /// At most `limit`; `unit` includes its blank.
    pub fn at_most(what: impl Into<String>, measured: f64, limit: f64, unit: &'static str) -> Self {
        Self { what: what.into(), unit, measured, limit, at_least: false }
    }

    /// At least `limit`.
    pub fn at_least(what: impl Into<String>, measured: f64, limit: f64, unit: &'static str) -> Self {
        Self { at_least: true, ..Self::at_most(what, measured, limit, unit) }
    }

    fn holds(&self) -> bool {
        if self.at_least { self.measured >= self.limit } else { self.measured <= self.limit }
    }

    fn line(&self) -> String {
        let Self { what, unit, measured, limit, at_least } = self;
        let (side, verdict) =
            (if *at_least { "at least" } else { "at most" }, if self.holds() { "reached" } else { "**missed**" });
        format!("| {what} | {side} {limit}{unit} | {}{unit} | {verdict} |\n", digits(*measured))
    }
}

/// About three digits, without an exponent.
pub fn digits(value: f64) -> String {
    match value.abs() {
        size if size < 10.0 => format!("{value:.2}"),
        size if size < 100.0 => format!("{value:.1}"),
        _ => format!("{value:.0}"),
    }
}

/// The table of limits and measured values.
pub fn asked(figures: &[Asked]) -> String {
    let head = String::from("| quantity | goal | measured | result |\n|---|---|---|---|\n");
    head + &figures.iter().map(Asked::line).collect::<String>() + "\n"
}

/// The text of a page or of a part of one, from `pages.md`: its paragraphs, each in one line, with values inserted.
pub fn page(name: &str, values: &[(&str, &dyn Display)]) -> String {
    let texts = include_str!("pages.md").split("<!-- ");
    let text = texts.filter_map(|text| text.strip_prefix(name)?.strip_prefix(" -->\n")).next().unwrap_or_default();
    let lines = text.trim().replace("\n\n", "\u{0}").replace('\n', " ").replace('\u{0}', "\n\n");
    let own = lines.replace("{machine}", &machine()) + "\n\n";
    values.iter().fold(own, |text, (name, value)| text.replace(&format!("{{{name}}}"), &value.to_string()))
}

/// Processor, operating system and number of cores.
fn machine() -> String {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let processor = processor().unwrap_or_else(|| "processor unknown".into());
    format!("{processor}, {cores} cores, shared, {} {}", std::env::consts::OS, std::env::consts::ARCH)
}

/// Model of the processor, where the system reports it.
pub fn processor() -> Option<String> {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let (_, name) = info.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':'))?;
    Some(name.trim().into())
}
