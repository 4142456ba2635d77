//! A run of a model: its steps, its input signals, the table of its recorded variables.
//!
//! In: a model at its start values, times, signals. Out: a row for each communication point. The run makes the same
//! steps as FMPy, so that both are bit-identical. The module must not know its observer.
//!
//! The functions for each row are inline, because this crate is not optimised, but the crate of the studies is.

pub mod column;
pub mod csv;
pub mod file;
pub mod missing;
pub mod signals;
pub mod table;
pub mod thinned;

use anyhow::{Context, Result, bail};
use column::columns;
use csv::Csv;
use file::Writer;
use linkage_fmu::component::{Component, Stepped};
use linkage_fmu::format::Experiment;
use linkage_fmu::numerics::decimal::Decimal;
use signals::{Signals, is_close};
use std::path::Path;
use std::time::{Duration, Instant};
use table::Table;

/// Approximate time between two calls of the observer.
const LOOK: Duration = Duration::from_millis(10);
/// Difference below which two times of a run are equal, relative to the interval. FMPy uses 1e-9 of the time, which far
/// from 0 s is more than an interval.
const CLOSE_TO_INTERVAL: f64 = 1e-3;
/// Smallest interval, relative to the times of a run. Some rounding errors of a double are no step.
const LEAST_INTERVAL: f64 = 1e-12;
/// Largest number of rows of a run without a given interval.
const DEFAULT_ROWS: f64 = 1000.0;
/// Largest number of steps of a default run.
const MOST_STEPS: f64 = 1e5;

/// The times of a run [s].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// Time at the start.
    pub start: f64,
    /// Time at the end, >= `start`. If it is `start`, the model is only initialised.
    pub stop: f64,
    /// Time between two communication points, > 0.
    pub interval: f64,
}

impl Span {
    /// The times of a run with these options [s]. A missing stop time or interval is that of the experiment.
    ///
    /// # Errors
    /// A time is not finite; the stop time is before the start; the interval is not above 0, or is so small that the
    /// times of the run are not distinct.
    pub fn new(experiment: Experiment, start: f64, stop: Option<f64>, interval: Option<f64>) -> Result<Self> {
        let stop = stop.unwrap_or(start + experiment.stop_time);
        if !(start.is_finite() && stop.is_finite() && stop >= start) {
            bail!(
                "--stop-time: the run from {start:?} s to {stop:?} s is not possible: the stop time must be finite \
                 and not before the start time"
            );
        }
        let interval = match interval {
            Some(interval) if interval > 0.0 && interval.is_finite() => interval,
            Some(interval) => bail!("--output-interval: {interval:?} s must be finite and > 0"),
            None => default_interval(experiment, stop - start),
        };
        let least = LEAST_INTERVAL * start.abs().max(stop.abs());
        if interval < least {
            bail!(
                "--output-interval: {interval:?} s is less than {least:?} s, which is {LEAST_INTERVAL:e} of the times \
                 of the run; use a larger interval, or times nearer to 0 s"
            );
        }
        Ok(Self { start, stop, interval })
    }

    /// Largest difference of two equal times [s].
    pub fn resolution(&self) -> f64 {
        CLOSE_TO_INTERVAL * self.interval
    }
}

/// Times at which the observer is called.
struct Looks {
    /// Number of steps at which the time is read again.
    at: u64,
    stride: u64,
    last: Instant,
}

impl Looks {
    fn new() -> Self {
        Self { at: 1, stride: 1, last: Instant::now() }
    }

    /// Whether the last call was long ago. With short steps the time is read rarely.
    #[inline]
    fn is_due(&mut self, steps: u64) -> bool {
        if steps < self.at {
            return false;
        }
        let passed = self.last.elapsed();
        self.stride = if passed < LOOK / 2 { 2 * self.stride } else { (self.stride / 2).max(1) };
        self.at = steps + self.stride;
        let is_due = passed >= LOOK / 2;
        if is_due {
            self.last = Instant::now();
        }
        is_due
    }
}

/// Result of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ended {
    /// Time reached [s].
    pub time: f64,
    /// Steps made.
    pub steps: u64,
    /// Whether the user stopped it.
    pub is_interrupted: bool,
}

/// Observer of a run.
pub trait Watch {
    /// Report the progress of the run, from 0 to 1. Returns whether the run must end here.
    fn look(&mut self, part: f64) -> bool;

    /// Report a warning of the model.
    fn warn(&mut self, line: &str);
}

/// No observer: the run ends at its stop time, and warnings are printed.
pub struct Nobody;

impl Watch for Nobody {
    fn look(&mut self, _: f64) -> bool {
        false
    }

    fn warn(&mut self, line: &str) {
        eprintln!("{line}");
    }
}

/// Initialise the model and make steps from start to stop, like FMPy: to each multiple of the interval, to jumps of the
/// inputs and to the stop time. `record` is called at each communication point.
///
/// # Errors
/// The model rejects its start, an input or a step; a step reached `solver.max_steps`; an error of `record`.
pub fn run(
    model: &mut Component,
    span: &Span,
    signals: &Signals,
    record: &mut impl FnMut(&mut Component, f64) -> Result<()>,
    watch: &mut impl Watch,
) -> Result<Ended> {
    let start_at = |time: f64| format!("initialisation at {} s", Decimal(time));
    signals.apply(model, span.start, false).with_context(|| start_at(span.start))?;
    model.initialize().with_context(|| start_at(span.start))?;
    if let Some(warning) = model.start_warning() {
        watch.warn(&format!("warning: {warning}"));
    }
    record(model, span.start)?;
    let mut ended = Ended { time: span.start, steps: 0, is_interrupted: false };
    let is_close = |a: f64, b: f64| is_close(a, b) && (a - b).abs() <= span.resolution();
    let mut looks = Looks::new();
    // Number of points of the grid that are passed.
    let mut points = 0_u64;
    while ended.time <= span.stop && !is_close(ended.time, span.stop) {
        if looks.is_due(ended.steps) && watch.look((ended.time - span.start) / (span.stop - span.start)) {
            ended.is_interrupted = true;
            break;
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
            // A warning about lost contact contains its time.
            let when = if warning.contains(" at t = ") { String::new() } else { format!("at {} s: ", Decimal(next)) };
            watch.warn(&format!("warning: {when}{warning}"));
        }
        (ended.time, ended.steps) = (next, ended.steps + 1);
        if is_close(next, regular) {
            points += 1;
        }
        record(model, next)?;
    }
    Ok(ended)
}

/// The default run with its actual settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DefaultRun {
    /// Time between two steps [s].
    pub interval: f64,
    /// Number of steps between two rows, a power of two. The end is a row too.
    pub stride: u64,
}

/// Run a model from its start values over its experiment in steps of its default size. Every output is recorded as CSV
/// at this path, at every n-th communication point and at the end, in few rows.
///
/// # Errors
/// The start or a step is rejected, or the file cannot be written.
pub fn default_run(model: &mut Component, path: &Path, most_rows: u64) -> Result<DefaultRun> {
    let experiment = model.experiment();
    let interval = interval(experiment, experiment.stop_time, MOST_STEPS);
    let span = Span { start: 0.0, stop: experiment.stop_time, interval };
    let steps = (span.stop / interval).round() as u64;
    let mut stride = 1;
    while steps / stride + 1 > most_rows {
        stride *= 2;
    }
    let columns = columns(model.interface(), &[])?;
    let writer = Writer::begin::<Csv>(path, &columns)?;
    let mut table = Table::new(columns, Some(writer), false);
    let mut point = 0_u64;
    let mut record = |model: &mut Component, time: f64| {
        let is_row = point.is_multiple_of(stride) || is_close(time, span.stop);
        point += 1;
        if is_row { table.record(model, time) } else { Ok(()) }
    };
    let ended = run(model, &span, &Signals::none(), &mut record, &mut Nobody);
    table.finish(None)?;
    ended.map(|_| DefaultRun { interval, stride })
}

/// The experiment's step, doubled until a run of this length has few rows [s].
fn default_interval(experiment: Experiment, length: f64) -> f64 {
    interval(experiment, length, DEFAULT_ROWS)
}

/// The experiment's step, doubled until a run of this length has at most this number of steps [s].
fn interval(experiment: Experiment, length: f64, most: f64) -> f64 {
    let mut interval = experiment.step_size;
    while length / interval > most {
        interval *= 2.0;
    }
    interval
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use std::fs;

    /// A slider without loads: x = t.
    fn slider(stop_time: f64, step_size: f64) -> Component {
        let text = format!(
            r#"{{ "name": "Slider", "bodies": {{ "ground": {{}}, "block": {{ "mass": 1 }} }},
            "joints": {{ "x": {{ "type": "prismatic", "first": "ground.origin", "second": "block.origin" }} }},
            "start": {{ "joint": "x", "position": 0, "speed": 1 }}, "guess": {{ "x": 0 }},
            "experiment": {{ "stop_time": {stop_time}, "step_size": {step_size} }} }}"#
        );
        Component::from_definition("mechanism.json", &text).unwrap()
    }

    /// Far from 0 s, 1e-9 of the time is longer than the run.
    #[test]
    fn a_run_is_as_long_wherever_it_starts() {
        let run = |start: f64, length: f64, interval: f64| {
            let mut model = slider(1.0, 0.25);
            let span = Span::new(model.experiment(), start, Some(start + length), Some(interval)).unwrap();
            let mut rows = Vec::new();
            let mut record = |_: &mut Component, time: f64| {
                rows.push(time);
                Ok(())
            };
            let ended = super::run(&mut model, &span, &Signals::none(), &mut record, &mut Nobody).unwrap();
            (rows.len(), ended.time)
        };
        for start in [0.0, -1e5, 1e5, 1e7, 5e8] {
            let (rows, end) = run(start, 0.131_25, 1e-3);
            assert_eq!((rows, (end - start - 0.131_25).abs() < 1e-6), (133, true), "from {start} s");
        }
        let refused = Span::new(slider(1.0, 1.0).experiment(), 1e16, None, Some(1e-3)).unwrap_err().to_string();
        assert!(refused.contains("nearer to 0 s"), "{refused}");
    }

    #[test]
    fn the_default_run_has_the_default_step_and_keeps_its_ends() {
        let path = std::env::temp_dir().join(format!("fmu-build-default-run-{}.csv", std::process::id()));
        for (stop, step, most, expected, times) in [
            (1.0, 0.25, 200, DefaultRun { interval: 0.25, stride: 1 }, vec![0.0, 0.25, 0.5, 0.75, 1.0]),
            (5.0, 0.001, 3, DefaultRun { interval: 0.001, stride: 2048 }, vec![0.0, 2.048, 4.096, 5.0]),
            (1e6, 5.0, 2, DefaultRun { interval: 10.0, stride: 65_536 }, vec![0.0, 655_360.0, 1e6]),
        ] {
            assert_eq!(default_run(&mut slider(stop, step), &path, most).unwrap(), expected);
            let text = fs::read_to_string(&path).unwrap();
            let read = |line: &str| line.split(',').next().unwrap().parse::<f64>().unwrap();
            let rows: Vec<f64> = text.lines().skip(1).map(read).collect();
            assert!(rows.len() == times.len(), "{rows:?}");
            assert!(rows.iter().zip(&times).all(|(row, time)| (row - time).abs() <= 1e-9 * stop), "{rows:?}");
        }
        fs::remove_file(path).unwrap();
    }
}
