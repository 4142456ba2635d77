//! The scenario of a study: the steps of a run, and the settings of the inputs in each step.
//!
//! In: stop time, interval, inputs over time, instants of responses. Out: the steps, which are equal for all runs. They
//! are the steps of `cargo fmu simulate`, and also end at every corner of an input over time and at every instant of a
//! response.

use super::definition::{Definition, Input, Setting};
use super::factor::{Factor, settable};
use anyhow::{Context, Result, bail};
use fmu_build::run::signals::{self, Signals, is_close};
use fmu_build::start_values::find;
use fmu_build::xml::ssv;
use linkage_fmu::component::Component;
use linkage_fmu::variables::{Causality, Interface, Kind, Reference, Value, Variable};
use std::path::Path;

/// Largest number of steps of a run.
const MOST_STEPS: f64 = 1e7;

/// References and values of Reals that one call sets.
pub type Reals = (Vec<Reference>, Vec<f64>);

/// Setting of a variable.
#[derive(Clone, Debug, PartialEq)]
pub enum Set {
    /// An input at an instant.
    Input(signals::Setting),
    /// A text parameter.
    Text(String),
}

impl From<Value> for Set {
    fn from(value: Value) -> Self {
        match value {
            Value::Real(value) => Self::Input(signals::Setting::Real(value)),
            Value::Boolean(value) => Self::Input(signals::Setting::Boolean(value)),
            Value::Item(item) => Self::Text(item),
        }
    }
}

/// A step of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// Time at its start [s].
    pub start: f64,
    /// Time at its end [s].
    pub end: f64,
    /// Settings of the inputs before the step.
    pub settings: Vec<(Reference, signals::Setting)>,
}

/// Outputs with the impacts on a stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Event {
    /// The flag of the stop.
    pub flag: Reference,
    /// Number of impacts on it.
    pub count: Reference,
    /// Time of the last one.
    pub time: Reference,
}

/// The scenario of every run.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// Settings before the start of a run, before the factors: Reals grouped by calls, then all others.
    pub start: (Vec<Reals>, Vec<(Reference, Set)>),
    /// The steps; at least one.
    pub steps: Vec<Step>,
    /// The event that ends a run, if there is one.
    pub stop_at: Option<Event>,
    /// Whether the communication instants are equally spaced.
    pub is_sampled: bool,
}

impl Scenario {
    /// The scenario of a study in `folder`, for these factors. Steps must end at `instants` [s].
    ///
    /// # Errors
    /// A name is unknown; a value or a time is invalid; an input is stated twice.
    pub fn new(
        study: &Definition,
        folder: &Path,
        model: &Component,
        factors: &[Factor],
        instants: &[f64],
    ) -> Result<Self> {
        let interface = model.interface();
        let stated = &study.scenario;
        let stop = stated.stop_time.unwrap_or(model.experiment().stop_time);
        if !(stop > 0.0 && stop.is_finite()) {
            bail!("scenario.stop_time = {stop:?}: must be finite and > 0 s");
        }
        if let Some(interval) = stated.output_interval
            && !(interval > 0.0 && interval.is_finite() && stop / interval <= MOST_STEPS)
        {
            bail!(
                "scenario.output_interval = {interval:?}: must be > 0 s, and the stop time {stop:?} s must have at \
                 most {MOST_STEPS:e} steps"
            );
        }
        let mut start = constants("start_values", study.start_values.iter(), model)?;
        let mut all = Vec::new();
        for (name, input) in stated.inputs.iter() {
            let key = format!("scenario.inputs.{name}");
            match input {
                Input::Constant(value) => {
                    let set = constants("scenario.inputs", [(name, value)], model)?;
                    check_input(&key, set.first().and_then(|(reference, _)| interface.get(*reference)))?;
                    start.extend(set);
                }
                Input::Points(points) => all.push(signal(&key, name, points, interface)?),
            }
        }
        if let Some(file) = &stated.input_file {
            let with_slopes = model.input_order() > 0;
            all.push(Signals::read(&folder.join(file), interface, with_slopes).context("scenario.input_file")?);
        }
        let mut known: Vec<Reference> = start.iter().map(|(reference, _)| *reference).collect();
        for reference in all.iter().flat_map(Signals::references) {
            if known.contains(&reference) {
                bail!("scenario: {} is set twice; remove one value", interface.list()[reference as usize].name);
            }
            known.push(reference);
        }
        if let Some(file) = &study.parameters_file {
            // All other keys of the study replace values of the parameter set.
            known.extend(factors.iter().map(|factor| factor.reference));
            let values = ssv::read(&folder.join(file), interface).context("parameters_file")?;
            let free = values.into_iter().filter(|(reference, _)| !known.contains(reference));
            start.extend(free.map(|(reference, value)| (reference, value.into())));
        }
        // Values are set in the order of the variables, like in a host, because the check of a value may depend on
        // previous ones.
        start.sort_by_key(|(reference, _)| *reference);
        let at_start = all.iter().flat_map(|signals| signals.settings(0.0, true));
        start.extend(at_start.map(|(reference, setting)| (reference, Set::Input(setting))));
        let stop_at = stated.stop_at.as_ref().map(|flag| event("scenario.stop_at", flag, model)).transpose()?;
        let steps = steps(stop, stated.output_interval, &all, instants);
        let start = in_calls(start, model);
        Ok(Self { start, steps, stop_at, is_sampled: stated.output_interval.is_some() })
    }

    /// Time at which a run ends unless an event ends it [s].
    pub fn stop(&self) -> f64 {
        self.steps.last().map_or(0.0, |step| step.end)
    }

    /// Whether the scenario sets a variable.
    pub fn sets(&self, reference: Reference) -> bool {
        let (reals, others) = &self.start;
        let others = others.iter().map(|(own, _)| own);
        reals.iter().flat_map(|(references, _)| references).chain(others).any(|own| *own == reference)
    }
}

/// The steps up to the stop time: to each multiple of the interval, to corners of inputs over time, to instants.
fn steps(stop: f64, interval: Option<f64>, all: &[Signals], instants: &[f64]) -> Vec<Step> {
    let mut events: Vec<f64> = all.iter().flat_map(|signals| signals.times()).chain(instants).copied().collect();
    events.retain(|event| *event > 0.0 && *event < stop);
    events.sort_unstable_by(f64::total_cmp);
    let (mut steps, mut time, mut points) = (Vec::new(), 0.0, 0_u64);
    while time <= stop && !is_close(time, stop) {
        let regular = interval.map_or(stop, |interval| (points + 1) as f64 * interval);
        let after = events.partition_point(|event| *event <= time);
        let event = events[after..].iter().copied().find(|event| !is_close(*event, time)).unwrap_or(f64::INFINITY);
        let mut next = regular;
        for earlier in [event, stop] {
            if next > earlier && !is_close(next, earlier) {
                next = earlier;
            }
        }
        let settings = all.iter().flat_map(|signals| signals.settings(time, true)).collect();
        steps.push(Step { start: time, end: next, settings });
        time = next;
        if is_close(next, regular) {
            points += 1;
        }
    }
    steps
}

/// The event whose flag has this name.
///
/// # Errors
/// No variable has the name, or it is no flag of a stop.
pub fn event(key: &str, flag: &str, model: &Component) -> Result<Event> {
    let interface = model.interface();
    let flags = (0..).zip(interface.list()).filter_map(|(reference, variable)| {
        let [count, _] = model.impacts_of(reference)?;
        Some((variable.name.as_str(), interface.get(count)?.name.split('.').next()?))
    });
    let flags: Vec<(&str, &str)> = flags.collect();
    if let Some((own, _)) = flags.iter().find(|(own, stop)| *stop == flag && *own != flag) {
        bail!("{key} = \"{flag}\": the name of the flag variable of this stop is {own}; write {own}");
    }
    let found = interface.find(flag).and_then(|reference| Some((reference, model.impacts_of(reference)?)));
    let Some((reference, [count, time])) = found else {
        let flags: Vec<&str> = flags.into_iter().map(|(flag, _)| flag).collect();
        let remedy = match flags.as_slice() {
            [] => "this mechanism has no stop".to_owned(),
            flags => format!("the flag variables of this mechanism are {}", flags.join(", ")),
        };
        bail!("{key} = \"{flag}\": an event must be the flag variable of a stop; {remedy}");
    };
    Ok(Event { flag: reference, count, time })
}

/// Settings before the start of a run, grouped by calls.
fn in_calls(start: Vec<(Reference, Set)>, model: &Component) -> (Vec<Reals>, Vec<(Reference, Set)>) {
    let (mut reals, mut others) = (Vec::new(), Vec::new());
    for (reference, set) in start {
        match set {
            Set::Input(signals::Setting::Real(value)) => reals.push((reference, value)),
            other => others.push((reference, other)),
        }
    }
    (reals.chunks(model.most_together()).map(|together| together.iter().copied().unzip()).collect(), others)
}

/// Values that are constant from the start on.
fn constants<'a>(
    section: &str,
    values: impl IntoIterator<Item = (&'a str, &'a Setting)>,
    model: &Component,
) -> Result<Vec<(Reference, Set)>> {
    let mut constants: Vec<(Reference, Set)> = Vec::new();
    for (name, value) in values {
        let key = format!("{section}.{name}");
        let reference = settable(&key, name, "use a parameter or an input", model)?;
        let value = value.value(&model.interface().list()[reference as usize]);
        constants.push((reference, value.with_context(|| key)?.into()));
    }
    Ok(constants)
}

/// Check that a value that is constant from the start on is that of an input.
fn check_input(key: &str, variable: Option<&Variable>) -> Result<()> {
    match variable {
        Some(variable) if variable.causality != Causality::Input => {
            let what = variable.causality.word().to_lowercase();
            bail!(
                "{key}: this variable is not an input but a {what}; set this variable in `start_values`, or as a \
                 factor if the value differs between runs"
            )
        }
        _ => Ok(()),
    }
}

/// An input that is linear between points.
fn signal(key: &str, name: &str, points: &[[f64; 2]], interface: &Interface) -> Result<Signals> {
    let reference = find(interface, name).with_context(|| key.to_owned())?;
    let variable = &interface.list()[reference as usize];
    if variable.causality != Causality::Input || !matches!(variable.kind, Kind::Real | Kind::Boolean) {
        bail!(
            "{key}: only an input of the type Real or Boolean can change over time, but this variable is a {}",
            variable.causality.word().to_lowercase()
        );
    }
    if let Some(pair) = points.windows(2).find(|pair| pair[0][0] > pair[1][0]) {
        bail!("{key}: the time decreases from {} to {} s; sort the points", pair[0][0], pair[1][0]);
    }
    if let Some(points) = points.windows(3).find(|points| is_close(points[0][0], points[2][0])) {
        bail!(
            "{key}: three points are at {} s, but a jump has two points: the values before and after the jump",
            points[0][0]
        );
    }
    Ok(Signals::of_points(reference, variable.kind, points))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn steps_end_at_multiples_corners_and_instants() {
        let ramp = Signals::of_points(0, Kind::Real, &[[0.0, 1.0], [0.25, 2.0], [0.25, 0.0], [2.0, 7.0]]);
        let steps = steps(1.0, Some(0.4), &[ramp], &[0.5, 0.8 + 1e-12, 1.0]);
        let ends: Vec<f64> = steps.iter().map(|step| step.end).collect();
        assert_eq!(ends, [0.25, 0.4, 0.5, 0.8, 1.0]);
        let at = |k: usize| steps[k].settings.clone();
        assert_eq!(at(0), [(0, signals::Setting::Real(1.0)), (0, signals::Setting::Slope(4.0))]);
        assert_eq!(at(1), [(0, signals::Setting::Real(0.0)), (0, signals::Setting::Slope(4.0))]);
        let whole = super::steps(1.0, None, &[], &[]);
        assert_eq!((whole.len(), whole[0].start, whole[0].end), (1, 0.0, 1.0));
    }
}
