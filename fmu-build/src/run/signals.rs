//! Input signals: values over time from a CSV file, interpolated like in FMPy.
//!
//! In: the file. Out: at any time the values of the inputs and their slopes for the next step, and the times at which a
//! step must end.

use super::Span;
use crate::csv_file;
use crate::start_values::{find, truth};
use anyhow::{Context, Result, bail};
use fmu_cli::words::comma;
use linkage_fmu::component::{Component, Refused};
use linkage_fmu::variables::{Causality, Interface, Kind, Reference};
use std::path::Path;

/// Relative difference below which two times are equal, as in Python's math.isclose.
const CLOSE: f64 = 1e-9;

/// Whether two times are equal except for rounding.
#[inline]
pub fn is_close(a: f64, b: f64) -> bool {
    a == b || (a - b).abs() <= CLOSE * a.abs().max(b.abs())
}

/// Values of one input at all times.
struct Signal {
    reference: Reference,
    values: Vec<f64>,
}

/// A setting of an input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Setting {
    /// Value of a Real.
    Real(f64),
    /// First derivative of a Real in time, for the next step.
    Slope(f64),
    /// Value of a Boolean.
    Boolean(bool),
}

impl Setting {
    /// Set the input.
    ///
    /// # Errors
    /// The model rejects the value.
    pub fn apply(self, model: &mut Component, reference: Reference) -> Result<(), Refused> {
        match self {
            Self::Real(value) => model.set_real(reference, value),
            Self::Slope(slope) => model.set_input_derivative(reference, 1, slope),
            Self::Boolean(value) => model.set_boolean(reference, value),
        }
    }
}

/// Signals of some inputs.
pub struct Signals {
    times: Vec<f64>,
    /// Interpolated inputs.
    continuous: Vec<Signal>,
    /// Booleans, with 1 for true. A value holds until the next change.
    discrete: Vec<Signal>,
    /// Times at which a step must end, ascending: jumps, and with slopes every corner.
    events: Vec<f64>,
    /// Whether slopes are set as derivatives of the inputs.
    with_slopes: bool,
    /// Largest difference of two equal times [s].
    resolution: f64,
}

impl Signals {
    /// No signal: the inputs do not change.
    pub fn none() -> Self {
        Self {
            times: Vec::new(),
            continuous: Vec::new(),
            discrete: Vec::new(),
            events: Vec::new(),
            with_slopes: false,
            resolution: f64::INFINITY,
        }
    }

    /// The signals for a run with these times, whose steps may be shorter than the rounding of times far from 0 s.
    pub fn within(self, span: &Span) -> Self {
        Self { resolution: span.resolution(), ..self }
    }

    fn is_close(&self, a: f64, b: f64) -> bool {
        is_close(a, b) && (a - b).abs() <= self.resolution
    }

    /// Read a file whose first column is the time.
    ///
    /// # Errors
    /// The file cannot be read; a column is no input of the model; a value is no finite number; the times decrease.
    pub fn read(path: &Path, interface: &Interface, with_slopes: bool) -> Result<Self> {
        let shown = path.display();
        let (mut reader, names) = csv_file::open(path)?;
        let mut names = names.iter().map(String::as_str);
        match names.next() {
            Some("time") => {}
            first => {
                bail!("{shown}: the first column is \"{}\", but must be `time`", first.unwrap_or("").escape_debug())
            }
        }
        let mut signals = Self { with_slopes, ..Self::none() };
        let mut kinds = Vec::new();
        for name in names {
            let kind = signals.add(interface, name, Vec::new()).with_context(|| format!("{shown}"))?;
            kinds.push((name.to_owned(), kind));
        }
        for (record, line) in reader.records().zip(2..) {
            let record = record.with_context(|| format!("{shown}"))?;
            let mut texts = record.iter();
            let time =
                value(texts.next().unwrap_or(""), Kind::Real).with_context(|| format!("{shown}, line {line}, time"))?;
            if signals.times.last().is_some_and(|last| *last > time) {
                bail!("{shown}, line {line}: the time decreases to {time} s; sort the rows by time");
            }
            signals.times.push(time);
            let (mut continuous, mut discrete) = (signals.continuous.iter_mut(), signals.discrete.iter_mut());
            for (text, (name, kind)) in texts.zip(&kinds) {
                let value = value(text, *kind).with_context(|| format!("{shown}, line {line}, {name}"))?;
                let signal = if *kind == Kind::Real { continuous.next() } else { discrete.next() };
                signal.into_iter().for_each(|signal| signal.values.push(value));
            }
        }
        if signals.times.is_empty() {
            bail!("{shown}: the file contains no row of values");
        }
        signals.events = signals.find_events();
        Ok(signals)
    }

    /// Signals with these values at these times [s]. For a Boolean, 1 means true.
    ///
    /// # Errors
    /// A name is no input of the model, or duplicate; a number is not finite; the times decrease, or there are none;
    /// the number of values differs from the number of times.
    pub fn of_columns(
        interface: &Interface,
        times: Vec<f64>,
        columns: Vec<(String, Vec<f64>)>,
        with_slopes: bool,
    ) -> Result<Self> {
        let mut signals = Self { with_slopes, ..Self::none() };
        if times.is_empty() {
            bail!("--input-file: contains no row of values");
        }
        if let Some(pair) = times.windows(2).find(|pair| pair[0] > pair[1]) {
            bail!("--input-file: the time decreases to {} s; sort the rows by time", pair[1]);
        }
        for (name, values) in [("time", &times)].into_iter().chain(columns.iter().map(|(name, all)| (&**name, all))) {
            if values.len() != times.len() {
                bail!("--input-file: {name} has {} values at {} times", values.len(), times.len());
            }
            if let Some(value) = values.iter().find(|value| !value.is_finite()) {
                bail!("--input-file: {name}: {value} must be finite");
            }
        }
        signals.times = times;
        for (name, values) in columns {
            signals.add(interface, &name, values).context("--input-file")?;
        }
        signals.events = signals.find_events();
        Ok(signals)
    }

    /// Add the signal of an input. Returns its type.
    fn add(&mut self, interface: &Interface, name: &str, values: Vec<f64>) -> Result<Kind> {
        let reference = find(interface, name)?;
        let variable = &interface.list()[reference as usize];
        if variable.causality != Causality::Input {
            let kind = variable.causality.word().to_lowercase();
            bail!("{name} is not an input (causality {kind}); set a parameter with --start-values");
        }
        if self.all().any(|signal| signal.reference == reference) {
            bail!("{name} occurs twice; remove one column");
        }
        let signal = Signal { reference, values };
        match variable.kind {
            Kind::Real => self.continuous.push(signal),
            Kind::Boolean => {
                let all = signal.values.iter().try_for_each(|value| of_boolean(*value).map(drop));
                all.with_context(|| name.to_owned())?;
                self.discrete.push(signal);
            }
            Kind::Enumeration => {
                bail!("{name} is an Enumeration, which cannot change during a run; remove this column")
            }
        }
        Ok(variable.kind)
    }

    fn all(&self) -> impl Iterator<Item = &Signal> {
        self.continuous.iter().chain(&self.discrete)
    }

    /// Duplicate times, and times at which a Boolean changes. With slopes all times, because a slope holds until the
    /// next time.
    fn find_events(&self) -> Vec<f64> {
        let changes = |k: usize| self.discrete.iter().any(|signal| signal.values[k] != signal.values[k - 1]);
        let is_event = |k: usize| self.with_slopes || k > 0 && (self.times[k] == self.times[k - 1] || changes(k));
        let mut events: Vec<f64> = (0..self.times.len()).filter(|&k| is_event(k)).map(|k| self.times[k]).collect();
        events.dedup();
        events
    }

    /// The next time after `time` at which a step must end; infinite if there is none.
    #[inline]
    pub fn next_event(&self, time: f64) -> f64 {
        if self.events.is_empty() {
            return f64::INFINITY;
        }
        let after = self.events.partition_point(|event| *event <= time);
        self.events[after..].iter().copied().find(|event| !self.is_close(*event, time)).unwrap_or(f64::INFINITY)
    }

    /// One input whose value is linear between points of a time [s] and a value. A duplicate time is a jump. A Boolean,
    /// with 1 for true, holds until the next point. The times ascend.
    pub fn of_points(reference: Reference, kind: Kind, points: &[[f64; 2]]) -> Self {
        let signal = Signal { reference, values: points.iter().map(|[_, value]| *value).collect() };
        let mut signals = Self { with_slopes: true, ..Self::none() };
        signals.times = points.iter().map(|[time, _]| *time).collect();
        if kind == Kind::Boolean {
            signals.discrete.push(signal)
        } else {
            signals.continuous.push(signal)
        }
        signals.events = signals.find_events();
        signals
    }

    /// The times of the values, ascending [s].
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// The inputs that have a signal.
    pub fn references(&self) -> impl Iterator<Item = Reference> {
        self.all().map(|signal| signal.reference)
    }

    /// Set the inputs to their values at `time`, as in [`Self::settings`].
    ///
    /// # Errors
    /// The model rejects a value.
    #[inline]
    pub fn apply(&self, model: &mut Component, time: f64, after_event: bool) -> Result<(), Refused> {
        if self.times.is_empty() {
            return Ok(());
        }
        self.settings(time, after_event).try_for_each(|(reference, setting)| setting.apply(model, reference))
    }

    /// Settings of the inputs at `time`, in order: at a jump the values after it, or those before it. A slope is that
    /// of the step from `time` on. FMPy sets the slope of the previous step, so that a corner acts one step late.
    pub fn settings(&self, time: f64, after_event: bool) -> impl Iterator<Item = (Reference, Setting)> {
        let next = self.place_from(time);
        let place = if self.with_slopes && after_event { next } else { self.place(time, after_event) };
        let row = self.row(time, after_event);
        let continuous = self.continuous.iter().flat_map(move |signal| {
            let [value, _] = place.interpolate(&self.times, &signal.values, time);
            let [_, slope] = next.interpolate(&self.times, &signal.values, time);
            let slope = self.with_slopes.then_some((signal.reference, Setting::Slope(slope)));
            std::iter::once((signal.reference, Setting::Real(value))).chain(slope)
        });
        let discrete = self.discrete.iter().map(move |s| (s.reference, Setting::Boolean(s.values[row] != 0.0)));
        continuous.chain(discrete)
    }

    /// Row of the Booleans that hold at `time`.
    fn row(&self, time: f64, after_event: bool) -> usize {
        let (times, last) = (&self.times, self.times.len().saturating_sub(1));
        let mut row = match times.partition_point(|t| *t < time) {
            0 => 0,
            next if next > last => return last,
            next => next - 1,
        };
        while after_event && row < last && (times[row + 1] < time || self.is_close(time, times[row + 1])) {
            row += 1;
        }
        row
    }

    /// Place of `time` for the continuous inputs, as in FMPy.
    fn place(&self, time: f64, after_event: bool) -> Place {
        let (times, last) = (&self.times, self.times.len().saturating_sub(1));
        let mut row = times.partition_point(|t| *t < time);
        if last == 0 || row > last {
            return Place::At { row: row.min(last), slope: None };
        }
        let is_jump = |row: usize| row < last && self.is_close(times[row], times[row + 1]);
        if !(self.is_close(time, times[row]) && is_jump(row)) {
            return row.checked_sub(1).map_or(Place::At { row, slope: None }, Place::Between);
        }
        while after_event && is_jump(row) {
            row += 1;
        }
        Place::At { row, slope: None }
    }

    /// Place for the continuous inputs at the start of a step from `time` on.
    fn place_from(&self, time: f64) -> Place {
        let behind = self.times.partition_point(|t| *t <= time || self.is_close(*t, time));
        match behind.checked_sub(1) {
            None => Place::At { row: 0, slope: None },
            Some(row) if row + 1 == self.times.len() => Place::At { row, slope: None },
            Some(row) if self.is_close(self.times[row], time) => Place::At { row, slope: Some(row) },
            Some(row) => Place::Between(row),
        }
    }
}

/// Place of a time among the times of the signals.
#[derive(Clone, Copy)]
enum Place {
    /// At a row. The slope is that from the row `slope` to the next row, or 0.
    At { row: usize, slope: Option<usize> },
    /// Between this row and the next.
    Between(usize),
}

impl Place {
    /// Value and slope at this place.
    fn interpolate(&self, times: &[f64], values: &[f64], time: f64) -> [f64; 2] {
        let slope = |row: usize| (values[row + 1] - values[row]) / (times[row + 1] - times[row]);
        match *self {
            Self::At { row, slope: from } => [values[row], from.map_or(0.0, slope)],
            Self::Between(row) => {
                let weight = (times[row + 1] - time) / (times[row + 1] - times[row]);
                [weight * values[row] + (1.0 - weight) * values[row + 1], slope(row)]
            }
        }
    }
}

/// A cell of the file. A Boolean is 1 or 0.
fn value(text: &str, kind: Kind) -> Result<f64> {
    match text.parse::<f64>() {
        Ok(value) if !value.is_finite() => bail!("{value} must be finite"),
        Ok(value) if kind == Kind::Boolean => of_boolean(value),
        Ok(value) => Ok(value),
        Err(_) if kind == Kind::Boolean => Ok(f64::from(u8::from(truth(text)?))),
        Err(_) => match comma(text) {
            Some(fault) => bail!("\"{text}\" {fault}"),
            None => bail!("\"{}\" is not a number", text.escape_debug()),
        },
    }
}

/// The value of a Boolean: 0 or 1.
fn of_boolean(value: f64) -> Result<f64> {
    if value == 0.0 || value == 1.0 { Ok(value) } else { bail!("{value} is not true or false; write 1 or 0") }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn signals(times: &[f64], force: &[f64], lock: &[f64]) -> Signals {
        let signal = |reference, values: &[f64]| Signal { reference, values: values.to_vec() };
        let mut signals = Signals::none();
        (signals.times, signals.continuous, signals.discrete) =
            (times.to_vec(), vec![signal(0, force)], vec![signal(1, lock)]);
        signals.events = signals.find_events();
        signals
    }

    fn at(signals: &Signals, time: f64, after: bool) -> (f64, f64) {
        let [value, _] = signals.place(time, after).interpolate(&signals.times, &signals.continuous[0].values, time);
        (value, signals.discrete[0].values[signals.row(time, after)])
    }

    #[test]
    fn signals_are_interpolated_and_jump_where_a_time_stands_twice() {
        let signals = signals(&[0.0, 1.0, 1.0, 3.0], &[0.0, 2.0, 10.0, 14.0], &[0.0, 0.0, 1.0, 1.0]);
        assert_eq!(at(&signals, -1.0, true), (0.0, 0.0));
        assert_eq!(at(&signals, 0.25, true), (0.5, 0.0));
        assert_eq!(at(&signals, 1.0, false), (2.0, 0.0));
        assert_eq!(at(&signals, 1.0, true), (10.0, 1.0));
        assert_eq!(at(&signals, 2.0, true), (12.0, 1.0));
        assert_eq!(at(&signals, 9.0, true), (14.0, 1.0));
        assert_eq!([0.0, 0.5, 1.0].map(|time| signals.next_event(time)), [1.0, 1.0, f64::INFINITY]);
    }

    #[test]
    fn a_jump_at_the_first_time_acts_from_the_start() {
        let signals = signals(&[0.0, 0.0, 1.0], &[2.0, 4.0, 5.0], &[0.0, 1.0, 1.0]);
        assert_eq!([-1.0, 0.0].map(|time| at(&signals, time, false)), [(2.0, 0.0); 2]);
        assert_eq!([-1.0, 0.0, 0.5].map(|time| at(&signals, time, true)), [(2.0, 0.0), (4.0, 1.0), (4.5, 1.0)]);
    }

    #[test]
    fn a_step_from_a_corner_has_the_slope_after_it() {
        let signals = signals(&[0.0, 1.0, 1.0, 3.0, 4.0], &[0.0, 2.0, 10.0, 14.0, 14.5], &[0.0; 5]);
        let at = |time: f64| signals.place_from(time).interpolate(&signals.times, &signals.continuous[0].values, time);
        for (time, expected) in [
            (-1.0, [0.0, 0.0]),
            (0.0, [0.0, 2.0]),
            (0.5, [1.0, 2.0]),
            (1.0, [10.0, 2.0]),
            (3.0, [14.0, 0.5]),
            (4.0, [14.5, 0.0]),
        ] {
            assert_eq!(at(time), expected, "{time}");
        }
    }

    #[test]
    fn a_boolean_changes_with_an_event() {
        let signals = signals(&[0.0, 0.5, 2.0], &[1.0; 3], &[1.0, 0.0, 0.0]);
        assert_eq!(signals.next_event(0.0), 0.5);
        assert_eq!([0.25, 0.5, 0.75].map(|time| at(&signals, time, true).1), [1.0, 0.0, 0.0]);
    }

    #[test]
    fn a_boolean_is_one_or_zero() {
        let accepted = ["1", "0", "1.0", "true", "False", "-0"].map(|text| value(text, Kind::Boolean).unwrap());
        assert_eq!(accepted, [1.0, 0.0, 1.0, 1.0, 0.0, 0.0]);
        for text in ["0.5", "2", "-1", "1e-300", "maybe"] {
            let message = value(text, Kind::Boolean).unwrap_err().to_string();
            assert!(message.contains("is not true or false"), "{message}");
        }
    }
}
