//! One run of a study.
//!
//! In: a model, the values of the factors, the scenario. Out: the responses, or the reason of a failure. The model is
//! then ready for the next run. Every run starts with an initialisation, so that no run depends on previous runs.

use super::design::Call;
use super::factor::Factor;
use super::responses::{Measure, Progress, Responses};
use super::scenario::{Event, Scenario, Set, Step};
use anyhow::{Context, Result, bail};
use linkage_fmu::component::{Component, Snapshot, Stepped, Waypoint};
use linkage_fmu::numerics::decimal::Decimal;

/// Relative distance after an event at which its state is searched first. A step that ends nearer would often end
/// before the event because of rounding.
const JUST_AFTER: f64 = 64.0 * f64::EPSILON;
/// Largest number of steps in the search for an event.
const MOST_HALVINGS: u32 = 1100;

/// Common data of all runs.
#[derive(Clone, Debug)]
pub struct Task {
    /// The factors.
    pub factors: Vec<Factor>,
    /// The calls that set them.
    pub calls: Vec<Call>,
    /// Scenario of every run.
    pub scenario: Scenario,
    /// Responses of every run.
    pub responses: Responses,
}

/// A model with the data for repeated runs.
#[derive(Debug)]
pub struct Runner<'a> {
    task: &'a Task,
    /// The model before its first run.
    fresh: Component,
    model: Component,
    /// State at the start of the present step, if the step may have to be repeated.
    before: Option<Snapshot>,
    /// A state on the way of the present run, which the energy integral has given.
    waypoint: Option<Waypoint>,
    progress: Progress,
    scratch: Vec<f64>,
}

impl<'a> Runner<'a> {
    /// A runner with the common values of all runs.
    ///
    /// # Errors
    /// The model rejects one of the values.
    pub fn new(task: &'a Task, mut model: Component) -> Result<Self> {
        set_start(&mut model, &task.scenario)?;
        let (fresh, progress) = (model.clone(), Progress::default());
        Ok(Self { task, fresh, model, before: None, waypoint: None, progress, scratch: Vec::new() })
    }

    /// The model at the start with the common values of all runs, if it has a start.
    pub fn started(mut self) -> Option<Component> {
        self.model.initialize().ok().map(|()| self.model)
    }

    /// Restart after a run that left the model in an unknown state.
    pub fn renew(&mut self) {
        (self.model, self.before) = (self.fresh.clone(), None);
    }

    /// Make the run with these values of the factors, from a known state on the way if there is one. Returns the
    /// responses, and a remark or an empty text.
    ///
    /// # Errors
    /// The reason of a failure. The responses are then NaN.
    pub fn run(&mut self, point: &[f64], waypoint: Option<Waypoint>, values: &mut [f64]) -> Result<String> {
        self.waypoint = waypoint;
        self.progress.begin(&self.task.responses, values);
        let done = self.make(point, values);
        if done.is_err() {
            values.fill(f64::NAN);
        }
        done
    }

    fn make(&mut self, point: &[f64], values: &mut [f64]) -> Result<String> {
        let Task { factors, calls, scenario, responses } = self.task;
        if matches!(self.model, Component::Hydraulic(_)) {
            // Factor values are checked against each other, so values of the previous run could matter.
            self.model.reset();
        }
        set_start(&mut self.model, scenario)?;
        for call in calls {
            call.apply(&mut self.model, factors, point, &mut self.scratch)?;
        }
        self.model.initialize().context("initialisation at 0 s")?;
        let reads = responses.read_states();
        if reads {
            self.progress.observe(responses, &mut self.model, 0.0, [true, false], values)?;
        }
        let (mut has_stopped, count) = (false, scenario.steps.len());
        for (index, step) in scenario.steps.iter().enumerate() {
            for (reference, setting) in &step.settings {
                setting.apply(&mut self.model, *reference).with_context(|| at("inputs", step.start))?;
            }
            if scenario.stop_at.is_some() || !responses.events.is_empty() {
                match &mut self.before {
                    Some(before) => self.model.snapshot_into(before),
                    none => *none = Some(self.model.snapshot()),
                }
            }
            let ends = scenario.stop_at.filter(|_| reads).map(|event| self.step_to_known(event, step)).transpose()?;
            let is_there = ends == Some(true);
            if !is_there {
                self.step(step, step.end - step.start)?;
            }
            let stop = scenario.stop_at.map(|event| self.stop(event, step)).transpose()?.flatten();
            let end = stop.map_or(step.end, |(_, time)| time);
            has_stopped = stop.is_some();
            self.find_events(step, stop, end, values)?;
            if let Some((event, time)) = stop.filter(|_| reads && !is_there) {
                self.step_to(event, step, time)?;
            }
            if reads {
                let is_last = has_stopped || index + 1 == count;
                self.progress.observe(responses, &mut self.model, end, [false, is_last], values)?;
            }
            if has_stopped {
                break;
            }
        }
        Ok(self.remark(has_stopped))
    }

    /// A remark about the run. Usually empty.
    fn remark(&self, has_stopped: bool) -> String {
        let name = |reference: u32| &self.model.interface().list()[reference as usize].name;
        let scenario = &self.task.scenario;
        let mut remarks = Vec::new();
        if let Some(event) = scenario.stop_at.filter(|_| !has_stopped) {
            let (flag, stop) = (name(event.flag), Decimal(scenario.stop()));
            remarks.push(format!("the output {flag} (scenario.stop_at) did not become true within {stop} s"));
        }
        if let Some((reference, time)) = self.progress.undefined {
            remarks.push(format!("{} has no value {}", name(reference), self.instant(time)));
        }
        remarks.join("; ")
    }

    /// The text for an instant of observation.
    fn instant(&self, time: f64) -> String {
        let mut ends = self.task.scenario.steps.iter().map(|step| step.end);
        let is_regular = time == 0.0 || ends.any(|end| end == time);
        if is_regular { format!("at {} s", Decimal(time)) } else { "at the impact (scenario.stop_at)".to_owned() }
    }

    /// Make a step of this length from the start of `step`.
    fn step(&mut self, step: &Step, h: f64) -> Result<()> {
        let is_on_way = |state: &Waypoint| step.start == 0.0 && state.is_within(h);
        let waypoint = self.waypoint.filter(is_on_way);
        match self.model.step_by(waypoint.as_ref(), step.start, h).with_context(|| at("step", step.start))? {
            Stepped::Whole => Ok(()),
            Stepped::Part(part) => bail!("{}: {}", at("step", step.start), part.why),
            Stepped::Failed(why) => bail!("{}: {why}", at("step", step.start)),
        }
    }

    /// The number of impacts since the start.
    fn count(&mut self, event: Event) -> Result<f64> {
        Ok(self.model.real(event.count)?)
    }

    /// The event and its time [s], if it occurred in this step.
    fn stop(&mut self, event: Event, step: &Step) -> Result<Option<(Event, f64)>> {
        if self.count(event)? == 0.0 {
            return Ok(None);
        }
        Ok(Some((event, self.time_of(event, step)?)))
    }

    /// Record the times of events that occur first in this step, until `end` [s]. The time of the event that ends the
    /// run is known.
    fn find_events(&mut self, step: &Step, stop: Option<(Event, f64)>, end: f64, values: &mut [f64]) -> Result<()> {
        let responses = &self.task.responses;
        for (index, event) in responses.events.iter().enumerate() {
            let known = stop.filter(|(stop, _)| stop == event).map(|(_, time)| time);
            let mut own = responses.list.iter().filter(|response| response.measure == Measure::Event(index));
            let time = match known {
                Some(time) => time,
                None if own.all(|response| !values[response.column].is_nan()) || self.count(*event)? == 0.0 => continue,
                None => self.time_of(*event, step)?,
            };
            if time > end {
                continue;
            }
            for response in responses.list.iter().filter(|response| response.measure == Measure::Event(index)) {
                values[response.column] = time;
            }
        }
        Ok(())
    }

    /// Return to the state at the start of the step.
    fn back(&mut self) -> Result<()> {
        let Some(before) = &self.before else { bail!("the state before the step was not kept") };
        Ok(self.model.restore(before)?)
    }

    /// Time of the first impact of an event that occurred in this completed step [s]. The model returns the time of the
    /// last impact. If there are several, the step is halved until it contains only the first one.
    fn time_of(&mut self, event: Event, step: &Step) -> Result<f64> {
        if self.count(event)? == 1.0 {
            return Ok(self.model.real(event.time)?);
        }
        let (mut without, mut with) = (0.0, step.end - step.start);
        let mut time = step.start + with;
        for _ in 0..MOST_HALVINGS {
            let h = 0.5 * (without + with);
            if h <= without || h >= with {
                time = step.start + with;
                break;
            }
            self.back()?;
            self.step(step, h)?;
            match self.count(event)? {
                0.0 => without = h,
                1.0 => {
                    time = self.model.real(event.time)?;
                    break;
                }
                _ => with = h,
            }
        }
        self.back()?;
        self.step(step, step.end - step.start)?;
        Ok(time)
    }

    /// Bring the model into the state just after an event, if the known state on the way belongs to this event. Returns
    /// whether it does; otherwise the state does not change.
    fn step_to_known(&mut self, event: Event, step: &Step) -> Result<bool> {
        let Some(state) = self.waypoint.filter(|state| state.is_stop && step.start == 0.0) else { return Ok(false) };
        let h = state.time + just_after(state.time);
        if h >= step.end {
            return Ok(false);
        }
        self.step(step, h)?;
        let is_there = self.count(event)? == 1.0 && self.model.real(event.time)? == state.time;
        if !is_there {
            self.back()?;
        }
        Ok(is_there)
    }

    /// Bring the model into the state just after an event, which occurred in this completed step at `time` [s].
    fn step_to(&mut self, event: Event, step: &Step, time: f64) -> Result<()> {
        let whole = step.end - step.start;
        let mut later = just_after(time);
        loop {
            let h = (time + later) - step.start;
            self.back()?;
            if h >= whole {
                return self.step(step, whole);
            }
            self.step(step, h)?;
            if self.count(event)? > 0.0 {
                return Ok(());
            }
            later *= 2.0;
        }
    }
}

/// Time between an event at `time` [s] and the first attempt at a state after it [s].
fn just_after(time: f64) -> f64 {
    JUST_AFTER * time.abs().max(f64::MIN_POSITIVE)
}

/// Set the common values of all runs.
fn set_start(model: &mut Component, scenario: &Scenario) -> Result<()> {
    let (reals, others) = &scenario.start;
    for (references, values) in reals {
        model.set_reals(references, values).context("start values")?;
    }
    for (reference, set) in others {
        let done = match set {
            Set::Input(setting) => setting.apply(model, *reference),
            Set::Text(text) => model.set_text(*reference, text),
        };
        done.with_context(|| format!("start value of {}", model.interface().list()[*reference as usize].name))?;
    }
    Ok(())
}

/// The text for the time of a failure.
fn at(what: &str, time: f64) -> String {
    format!("{what} at {} s", Decimal(time))
}
