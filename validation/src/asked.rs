//! Figures asked beside figures measured, and the machine they were measured on.

use std::fmt::Write;

/// One figure with its limit.
pub struct Asked {
    what: String,
    unit: &'static str,
    measured: f64,
    limit: f64,
    at_least: bool,
}

impl Asked {
    /// At most `limit`; the unit has its own blank.
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
            (if *at_least { "at least" } else { "at most" }, if self.holds() { "holds" } else { "**misses**" });
        format!("| {what} | {side} {limit}{unit} | {}{unit} | {verdict} |\n", digits(*measured))
    }
}

/// Three digits or so, without an exponent.
pub fn digits(value: f64) -> String {
    match value.abs() {
        size if size < 10.0 => format!("{value:.2}"),
        size if size < 100.0 => format!("{value:.1}"),
        _ => format!("{value:.0}"),
    }
}

/// The table of figures asked.
pub fn table(figures: &[Asked]) -> String {
    let mut out = String::from("| figure | asked | measured | |\n|---|---|---|---|\n");
    for figure in figures {
        out.push_str(&figure.line());
    }
    out.push('\n');
    out
}

/// Head of a page: title, what was measured and how, and on which machine.
pub fn page(title: &str, words: &str) -> String {
    let mut out = String::new();
    let _ = writeln!(out, "# {title}\n\n{words} Machine: {}.\n", machine());
    out
}

/// Processor, operating system and number of cores.
fn machine() -> String {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let processor = (info.lines().find_map(|line| line.strip_prefix("model name")))
        .map_or("processor unknown", |name| name.trim_start_matches([' ', '\t', ':']));
    format!("{processor}, {cores} cores, shared, {} {}", std::env::consts::OS, std::env::consts::ARCH)
}
