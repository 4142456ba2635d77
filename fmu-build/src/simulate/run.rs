//! The steps of a run.
//!
//! In: a model at its start values, times, signals. Out: a row for each communication point.

use super::signals::{Signals, is_close};
use anyhow::{Context, Result, bail};
use indicatif::{ProgressBar, ProgressStyle};
use linkage_fmu::component::{Component, Stepped};
use linkage_fmu::numerics::decimal::Decimal;
use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Steps between two looks at the user's wish to stop; the bar is moved then too.
const STEPS_PER_LOOK: u64 = 1024;
/// Time for which a run goes on before its bar is shown.
const SILENT: Duration = Duration::from_millis(500);
/// Steps of the bar.
const TICKS: f64 = 1e4;

/// The times of a run [s].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// Time at the start.
    pub start: f64,
    /// Time at the end, >= `start`; at `start` the model is initialised only.
    pub stop: f64,
    /// From one communication point to the next, > 0.
    pub interval: f64,
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ended {
    /// Time reached [s].
    pub time: f64,
    /// Steps made.
    pub steps: u64,
    /// Whether the user stopped it.
    pub is_interrupted: bool,
}

/// Initialise the model and step it from start to stop, as FMPy does: to each multiple of the interval, to jumps of the
/// inputs and to the stop time. `record` is called at each communication point. `stop_wish`: set when the run is to end;
/// `is_shown`: a bar shows how far a long run is.
///
/// # Errors
/// The model refuses its start, an input or a step; a step that met `solver.max_steps`; an error of `record`.
pub fn run(
    model: &mut Component,
    span: &Span,
    signals: &Signals,
    record: &mut impl FnMut(&mut Component, f64) -> Result<()>,
    stop_wish: &AtomicBool,
    is_shown: bool,
) -> Result<Ended> {
    let start_at = |time: f64| format!("initialisation at {} s", Decimal(time));
    signals.apply(model, span.start, false).with_context(|| start_at(span.start))?;
    model.initialize().with_context(|| start_at(span.start))?;
    if let Some(warning) = model.start_warning() {
        eprintln!("warning: {warning}");
    }
    record(model, span.start)?;
    let mut ended = Ended { time: span.start, steps: 0, is_interrupted: false };
    let mut bar = Bar::new(is_shown);
    // Points of the grid that are behind.
    let mut points = 0_u64;
    while ended.time <= span.stop && !is_close(ended.time, span.stop) {
        if ended.steps.is_multiple_of(STEPS_PER_LOOK) {
            bar.show((ended.time - span.start) / (span.stop - span.start));
            if stop_wish.load(Ordering::Relaxed) {
                ended.is_interrupted = true;
                break;
            }
        }
        let regular = span.start + (points + 1) as f64 * span.interval;
        let mut next = regular;
        for earlier in [signals.next_event(ended.time), span.stop] {
            if next > earlier && !is_close(next, earlier) {
                next = earlier;
            }
        }
        signals.apply(model, ended.time, true).with_context(|| format!("inputs at {} s", Decimal(ended.time)))?;
        match model
            .step_from(Some(ended.time), next - ended.time)
            .with_context(|| format!("step at {} s", Decimal(ended.time)))?
        {
            Stepped::Whole => {}
            Stepped::Part(part) => {
                record(model, ended.time + part.time)?;
                bail!("the run ends at {} s: {}", Decimal(ended.time + part.time), part.why);
            }
            Stepped::Failed(why) => bail!("the run ends at {} s: {why}", Decimal(ended.time)),
        }
        if let Some(warning) = model.take_warning() {
            // A contact that parts tells its time.
            let when = if warning.contains(" at t = ") { String::new() } else { format!("at {} s: ", Decimal(next)) };
            bar.say(&format!("warning: {when}{warning}"));
        }
        (ended.time, ended.steps) = (next, ended.steps + 1);
        if is_close(next, regular) {
            points += 1;
        }
        record(model, next)?;
    }
    bar.end();
    Ok(ended)
}

/// Set when the user types Ctrl-C; one for all runs of the program, which can have one handler only.
pub fn stop_wish() -> &'static AtomicBool {
    static WISH: AtomicBool = AtomicBool::new(false);
    static HANDLED: Once = Once::new();
    // Without a handler Ctrl-C ends the program at once, which loses rows only.
    HANDLED.call_once(|| drop(ctrlc::set_handler(|| WISH.store(true, Ordering::Relaxed))));
    &WISH
}

/// How far a long run is.
struct Bar {
    bar: ProgressBar,
    started: std::time::Instant,
    is_shown: bool,
}

impl Bar {
    fn new(is_shown: bool) -> Self {
        Self { bar: ProgressBar::hidden(), started: std::time::Instant::now(), is_shown }
    }

    fn show(&mut self, part: f64) {
        if self.is_shown && self.bar.is_hidden() && self.started.elapsed() > SILENT {
            let style = ProgressStyle::with_template("{bar:40} {percent} %, {eta} left");
            self.bar = ProgressBar::new(TICKS as u64);
            self.bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        }
        self.bar.set_position((part * TICKS) as u64);
    }

    fn say(&self, line: &str) {
        self.bar.suspend(|| eprintln!("{line}"));
    }

    fn end(&self) {
        self.bar.finish_and_clear();
    }
}
