//! A model with its time: steps, and values by name from Python.
//!
//! In: names, values of Python, steps. Out: values, exceptions. It must not know who shares it.

use crate::errors::{SimulationError, input, refused, value};
use crate::names::Names;
use fmu_build::start_values::{self, find, most_together, set_reals};
use linkage_fmu::component::{Component, Paused, Pauses, Stepped};
use linkage_fmu::variables::{Causality, Kind, Reference, Value, Variability};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyString};

/// A model at a time.
#[derive(Clone)]
pub struct Run {
    /// The model.
    pub model: Component,
    /// Time since the start [s].
    pub time: f64,
    /// Whether no parameter was set since the last initialisation.
    pub is_initialized: bool,
}

impl Run {
    /// Advance by `h` [s].
    pub fn step(&mut self, h: f64) -> PyResult<()> {
        self.is_ready()?;
        let stepped = self.model.step(h).map_err(value)?;
        self.advanced(h, stepped)
    }

    fn is_ready(&self) -> PyResult<()> {
        match self.is_initialized {
            true => Ok(()),
            false => Err(SimulationError::new_err(
                "the simulation is not initialised, or a parameter was set since; call initialize() before a step",
            )),
        }
    }

    fn advanced(&mut self, h: f64, stepped: Stepped) -> PyResult<()> {
        match stepped {
            Stepped::Whole => self.time += h,
            Stepped::Part(part) => {
                self.time += part.time;
                return Err(refused(format!("the step ends at {:?} s: {}", self.time, part.why)));
            }
            Stepped::Failed(why) => return Err(refused(format!("step at {:?} s: {why}", self.time))),
        }
        Ok(())
    }

    /// Step to a time; with `at_event` only to the first event. What happened there.
    pub fn run_until(&mut self, time: f64, at_event: bool) -> PyResult<Vec<String>> {
        self.is_ready()?;
        let h = time - self.time;
        if !(h >= 0.0 && h.is_finite()) {
            return Err(input(format!(
                "time = {time:?} s: must be finite and not before the present time, {:?} s",
                self.time
            )));
        }
        if h == 0.0 {
            return Ok(Vec::new());
        }
        if !at_event {
            self.step(h)?;
            self.time = time;
            return Ok(Vec::new());
        }
        self.model.listen(true, false);
        let pauses = Pauses { at_events: true, at_steps: false };
        let paused = self.model.step_to_pause(self.time, h, pauses);
        let outcome = match paused.map_err(value) {
            Ok(Paused::AtEvent(part)) => {
                let mut lines = self.model.take_occurrences(self.time);
                self.time += part;
                let jumped = self.model.handle_event(self.time).map_err(refused);
                lines.extend(self.model.take_occurrences(self.time));
                jumped.map(|_| lines.into_iter().map(|line| line.text).collect())
            }
            Ok(Paused::AtEnd | Paused::AtStep(_)) => {
                self.time = time;
                Ok(Vec::new())
            }
            Ok(Paused::Part(part)) => self.advanced(h, Stepped::Part(part)).map(|()| Vec::new()),
            Ok(Paused::Failed(why)) => self.advanced(h, Stepped::Failed(why)).map(|()| Vec::new()),
            Err(error) => Err(error),
        };
        self.model.listen(false, false);
        outcome
    }

    /// Set Reals: inputs and, within a run, tunable parameters act from now on; any other parameter ends the run.
    fn set_reals(&mut self, references: &[Reference], values: &[f64]) -> PyResult<()> {
        let mut set: Vec<(Reference, f64)> = references.iter().copied().zip(values.iter().copied()).collect();
        let is = |run: &Self, reference: Reference| {
            let variable = &run.model.interface().list()[reference as usize];
            [variable.causality == Causality::Parameter, variable.variability == Variability::Tunable]
        };
        if self.is_initialized && set.iter().all(|(reference, _)| is(self, *reference) != [true, false]) {
            for (reference, value_of) in &set {
                self.model.check_real(*reference, *value_of).map_err(value)?;
            }
            let (tuned, others): (Vec<_>, Vec<_>) = set.iter().partition(|(reference, _)| is(self, *reference)[1]);
            if !tuned.is_empty() {
                let (references, values): (Vec<_>, Vec<_>) = tuned.into_iter().unzip();
                self.model.check_together(&references, &values).map_err(value)?;
                self.model.tune(&references, &values).map_err(value)?;
            }
            return others
                .iter()
                .try_for_each(|(reference, number)| self.model.take_real(*reference, *number).map_err(value));
        }
        let ends = set.iter().any(|(reference, _)| is(self, *reference)[0]);
        // As a host does it: what a value is checked against may depend on one before.
        set.sort_by_key(|(reference, _)| *reference);
        for together in set.chunks(most_together(&self.model)) {
            let (references, values): (Vec<_>, Vec<_>) = together.iter().copied().unzip();
            set_reals(&mut self.model, &references, &values).map_err(value)?;
        }
        self.is_initialized &= !ends;
        Ok(())
    }

    /// Set one variable to a number, a truth value or a text.
    pub fn set(&mut self, name: &str, given: &Bound<'_, PyAny>) -> PyResult<()> {
        let reference = find(self.model.interface(), name).map_err(input)?;
        let variable = &self.model.interface().list()[reference as usize];
        let (kind, is_parameter) = (variable.kind, variable.causality == Causality::Parameter);
        match kind {
            Kind::Real if !given.is_instance_of::<PyBool>() => {
                if given.is_instance_of::<PyString>() {
                    let text = given.extract::<String>()?;
                    let words = [format!("{name}={text}")];
                    let parsed = start_values::parse(self.model.interface(), &words).map_err(input)?;
                    let number = match parsed.first() {
                        Some((_, Value::Real(number))) => *number,
                        _ => f64::NAN,
                    };
                    return self.set_reals(&[reference], &[number]);
                }
                let number = given.extract::<f64>().map_err(|_| wrong(name, "a number", given))?;
                return self.set_reals(&[reference], &[number]);
            }
            Kind::Real => return Err(wrong(name, "a number", given)),
            Kind::Boolean => {
                let truth = given.is_truthy().map_err(|_| wrong(name, "True or False", given))?;
                if given.is_instance_of::<PyString>() {
                    return Err(wrong(name, "True or False", given));
                }
                self.model.set_boolean(reference, truth).map_err(value)?;
            }
            Kind::Enumeration => {
                let text = given.extract::<String>().map_err(|_| wrong(name, "the name of an item", given))?;
                self.model.set_text(reference, &text).map_err(value)?;
            }
        }
        self.is_initialized &= !is_parameter;
        Ok(())
    }

    /// The value of one variable.
    pub fn get<'py>(&mut self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let reference = find(self.model.interface(), name).map_err(input)?;
        let variable = &self.model.interface().list()[reference as usize];
        match variable.kind {
            Kind::Real => Ok(self.model.real(reference).map_err(refused)?.into_pyobject(py)?.into_any()),
            Kind::Boolean => Ok(PyBool::new(py, self.model.boolean(reference).map_err(refused)?).to_owned().into_any()),
            Kind::Enumeration => {
                let items = variable.details.items;
                let item = self.model.item(reference).map_err(refused)?;
                Ok(PyString::new(py, items.get(item).copied().unwrap_or_default()).into_any())
            }
        }
    }

    /// The numbers of several variables; of a Boolean 1 or 0, of an Enumeration the number of the item from 1 on.
    pub fn numbers(&mut self, names: &Names, values: &mut Vec<f64>) -> PyResult<()> {
        names.belong_to(&self.model)?;
        if names.are_reals {
            return self.model.reals(&names.references, |number| values.push(number)).map_err(refused);
        }
        for (&reference, kind) in names.references.iter().zip(&names.kinds) {
            values.push(match kind {
                Kind::Real => self.model.real(reference).map_err(refused)?,
                Kind::Boolean => f64::from(u8::from(self.model.boolean(reference).map_err(refused)?)),
                Kind::Enumeration => (self.model.item(reference).map_err(refused)? + 1) as f64,
            });
        }
        Ok(())
    }

    /// Set several variables to numbers, all or none.
    pub fn set_all(&mut self, names: &Names, values: &[f64]) -> PyResult<()> {
        names.belong_to(&self.model)?;
        if names.are_inputs {
            let all = || names.references.iter().zip(values);
            all().try_for_each(|(&own, &number)| self.model.check_real(own, number)).map_err(value)?;
            return all().try_for_each(|(&own, &number)| self.model.take_real(own, number)).map_err(value);
        }
        if names.are_reals {
            return self.set_reals(&names.references, values);
        }
        Err(input("an array sets numbers only; set a Boolean or an Enumeration by its name"))
    }
}

fn wrong(name: &str, needed: &str, given: &Bound<'_, PyAny>) -> PyErr {
    let shown = given.repr().map_or_else(|_| "this".to_owned(), |text| text.to_string());
    input(format!("{name} needs {needed}, not {shown}"))
}
