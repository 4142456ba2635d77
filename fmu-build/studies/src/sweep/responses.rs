//! The responses of a study: the recorded numbers of each run.
//!
//! In: the model at the communication instants of a run. Out: numbers in the order of the columns. NaN stands for a
//! missing value.

use super::definition::{self, Definition};
use super::scenario::{Event, Scenario, event};
use anyhow::{Context, Result, bail};
use fmu_build::run::signals::is_close;
use fmu_build::start_values::find;
use linkage_fmu::component::{Component, Refused};
use linkage_fmu::numerics::decimal::Decimal;
use linkage_fmu::variables::{Kind, Reference, Unit};

/// A variable to read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Observed {
    /// Its reference.
    pub reference: Reference,
    /// Whether it is a Boolean, recorded as 1 or 0.
    pub is_boolean: bool,
}

impl Observed {
    fn read(self, model: &mut Component) -> Result<f64, Refused> {
        match self.is_boolean {
            true => Ok(f64::from(u8::from(model.boolean(self.reference)?))),
            false => model.real(self.reference),
        }
    }
}

/// Measure of a response.
#[derive(Clone, Debug, PartialEq)]
pub enum Measure {
    /// Time of an event, by its index among the events: one column.
    Event(usize),
    /// Value at the end: one column.
    Final,
    /// Largest value (sign 1) or smallest value (sign -1) at the communication instants, and its time: two columns.
    Extreme(f64),
    /// Integral over time by the trapezoidal rule: one column.
    Integral,
    /// Root mean square over time: one column.
    RootMeanSquare,
    /// Values at these instants [s]: as many columns.
    Course(Vec<f64>),
}

/// A response.
#[derive(Clone, Debug)]
pub struct Response {
    /// The variable. For an event its flag.
    pub observed: Observed,
    /// The recorded measure.
    pub measure: Measure,
    /// Its first column.
    pub column: usize,
}

/// All responses, and the names of their columns.
#[derive(Clone, Debug)]
pub struct Responses {
    /// In the order of the study.
    pub list: Vec<Response>,
    /// The events whose times are recorded.
    pub events: Vec<Event>,
    /// Names of the columns.
    pub columns: Vec<String>,
    /// Their units. Empty for a number without unit.
    pub units: Vec<String>,
}

/// The instants that the responses of a study name [s].
///
/// # Errors
/// A time is negative, not finite or duplicate, or a list is empty.
pub fn instants(study: &Definition) -> Result<Vec<f64>> {
    let mut all = Vec::new();
    for (name, response) in study.responses.iter() {
        if response.times.as_ref().is_some_and(Vec::is_empty) {
            bail!(
                "responses.{name}.times: the list is empty, so the time series has no column; add an instant or remove \
                 the response"
            );
        }
        for (index, time) in response.times.iter().flatten().enumerate() {
            if !(*time >= 0.0 && time.is_finite()) {
                bail!("responses.{name}.times[{index}] = {time}: must be finite and >= 0 s");
            }
            if response.times.iter().flatten().take(index).any(|other| other == time) {
                bail!("responses.{name}.times[{index}] = {time} s occurs twice; remove one of the two times");
            }
            all.push(*time);
        }
    }
    Ok(all)
}

impl Responses {
    /// The responses of a study.
    ///
    /// # Errors
    /// A name is unknown; a response has no measure or several; a measure needs communication instants, but the
    /// scenario has none; an instant is after the end.
    pub fn new(study: &Definition, scenario: &Scenario, model: &Component) -> Result<Self> {
        let mut all = Self { list: Vec::new(), events: Vec::new(), columns: Vec::new(), units: Vec::new() };
        for (name, stated) in study.responses.iter() {
            let key = format!("responses.{name}");
            if name.is_empty() || name.chars().any(char::is_control) {
                bail!("{key}: a name needs at least one character and no control characters");
            }
            all.add(&key, name, stated, scenario, model)?;
        }
        Ok(all)
    }

    fn add(
        &mut self,
        key: &str,
        name: &str,
        stated: &definition::Response,
        scenario: &Scenario,
        model: &Component,
    ) -> Result<()> {
        let definition::Response { event: flag, last, maximum, minimum, integral, root_mean_square, course, times } =
            stated;
        let kinds = [
            ("event", flag),
            ("final", last),
            ("maximum", maximum),
            ("minimum", minimum),
            ("integral", integral),
            ("root_mean_square", root_mean_square),
            ("course", course),
        ];
        let mut given = kinds.iter().filter_map(|(kind, variable)| Some((*kind, variable.as_ref()?)));
        let (Some((kind, variable)), None) = (given.next(), given.next()) else {
            bail!("{key}: give exactly one of {}", kinds.map(|(kind, _)| kind).join(", "));
        };
        let key = format!("{key}.{kind}");
        if times.is_some() != (kind == "course") {
            bail!("{key}: give the keys `course` and `times` together; `times` lists the instants of the time series");
        }
        let met = (kind == "event").then(|| event(&key, variable, model)).transpose()?;
        let reference = find(model.interface(), variable).with_context(|| key.clone())?;
        let of = &model.interface().list()[reference as usize];
        if matches!(of.kind, Kind::Enumeration) {
            bail!("{key}: {variable} is a text, but a response must be a number");
        }
        if !scenario.is_sampled && !matches!(kind, "event" | "final" | "course") {
            bail!(
                "{key}: this response needs communication steps of constant size; add the key \
                `scenario.output_interval`"
            );
        }
        let unit = of.unit.map_or("", Unit::name);
        let mut names = vec![(name.to_owned(), unit.to_owned())];
        let measure = match (kind, met) {
            (_, Some(event)) => {
                let known = self.events.iter().position(|other| *other == event);
                if known.is_none() {
                    self.events.push(event);
                }
                names[0].1 = Unit::Second.name().to_owned();
                Measure::Event(known.unwrap_or(self.events.len() - 1))
            }
            ("final", _) => Measure::Final,
            ("maximum" | "minimum", _) => {
                names.push((format!("{name}.time"), Unit::Second.name().to_owned()));
                Measure::Extreme(if kind == "maximum" { 1.0 } else { -1.0 })
            }
            ("integral", _) => {
                names[0].1 = if matches!(unit, "" | "1") { "s".to_owned() } else { format!("{unit}.s") };
                Measure::Integral
            }
            ("root_mean_square", _) => Measure::RootMeanSquare,
            _ => {
                let times = times.clone().unwrap_or_default();
                if let Some(late) = times.iter().find(|time| **time > scenario.stop()) {
                    bail!(
                        "{key}: the instant {late} s is after the end of the run at {} s; give an earlier instant, \
                        or a later `stop_time`",
                        scenario.stop()
                    );
                }
                names = times.iter().map(|time| (format!("{name}@{}", Decimal(*time)), unit.to_owned())).collect();
                Measure::Course(times)
            }
        };
        let observed = Observed { reference, is_boolean: of.kind == Kind::Boolean };
        self.list.push(Response { observed, measure, column: self.columns.len() });
        let (names, units): (Vec<_>, Vec<_>) = names.into_iter().unzip();
        self.columns.extend(names);
        self.units.extend(units);
        Ok(())
    }

    /// Whether a response other than the time of an event is recorded.
    pub fn read_states(&self) -> bool {
        self.list.iter().any(|response| !matches!(response.measure, Measure::Event(_)))
    }
}

/// The responses of one run in progress.
#[derive(Clone, Debug, Default)]
pub struct Progress {
    /// For each response: the value at the last instant, and a sum over time.
    sums: Vec<[f64; 2]>,
    time: f64,
    /// The first variable without a value, and the time.
    pub undefined: Option<(Reference, f64)>,
}

impl Progress {
    /// Start before the first instant. `values` are the columns.
    pub fn begin(&mut self, responses: &Responses, values: &mut [f64]) {
        self.sums.clear();
        self.sums.resize(responses.list.len(), [0.0; 2]);
        self.undefined = None;
        values.fill(f64::NAN);
    }

    /// Read the model at an instant [s]. `is_first`, `is_last`: whether the instant is the first or the last one of the
    /// run.
    ///
    /// # Errors
    /// The model rejects reading a value.
    pub fn observe(
        &mut self,
        responses: &Responses,
        model: &mut Component,
        time: f64,
        [is_first, is_last]: [bool; 2],
        values: &mut [f64],
    ) -> Result<(), Refused> {
        for (response, [before, sum]) in responses.list.iter().zip(&mut self.sums) {
            let wanted = match &response.measure {
                Measure::Event(_) => false,
                Measure::Final => is_last,
                Measure::Course(times) => times.iter().any(|instant| is_close(*instant, time)),
                Measure::Extreme(_) | Measure::Integral | Measure::RootMeanSquare => true,
            };
            if !wanted {
                continue;
            }
            let value = response.observed.read(model)?;
            if value.is_nan() {
                self.undefined.get_or_insert((response.observed.reference, time));
            }
            let own = &mut values[response.column..];
            match &response.measure {
                Measure::Event(_) => {}
                Measure::Final => own[0] = value,
                Measure::Extreme(sign) => {
                    // A missing value is no extreme value, and makes the extreme missing.
                    if is_first || value.is_nan() || sign * value > sign * own[0] {
                        [own[0], own[1]] = [value, if value.is_nan() { f64::NAN } else { time }];
                    }
                }
                Measure::Integral | Measure::RootMeanSquare => {
                    let is_square = response.measure == Measure::RootMeanSquare;
                    let size = if is_square { value * value } else { value };
                    if !is_first {
                        *sum += 0.5 * (*before + size) * (time - self.time);
                    }
                    *before = size;
                    if is_last {
                        own[0] = if is_square { (*sum / time).sqrt() } else { *sum };
                    }
                }
                Measure::Course(times) => {
                    for (own, _) in own.iter_mut().zip(times).filter(|(_, instant)| is_close(**instant, time)) {
                        *own = value;
                    }
                }
            }
        }
        self.time = time;
        Ok(())
    }
}
