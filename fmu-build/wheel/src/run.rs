//! A model with its time: steps, and values by name from Python.
//!
//! In: names, values of Python, steps. Out: values, exceptions. The module must not know how threads share it.

use crate::arguments;
use crate::errors::{SimulationError, input, refused, value};
use crate::names::{Names, with_numbers};
use fmu_build::start_values::find;
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
                "the simulation is not initialised, or a parameter was set after the initialisation; call \
                    initialize() before a step",
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

    /// Step to a time, or with `at_event` only to the first event. Returns texts about the event.
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

    /// Set Reals. Inputs and, during a run, tunable parameters act from now on. Any other parameter ends the run.
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
        // Values are set in the order of the variables, like in a host, because the check of a value may depend on
        // previous ones.
        set.sort_by_key(|(reference, _)| *reference);
        for together in set.chunks(self.model.most_together()) {
            let (references, values): (Vec<_>, Vec<_>) = together.iter().copied().unzip();
            self.model.set_reals(&references, &values).map_err(value)?;
        }
        self.is_initialized &= !ends;
        Ok(())
    }

    /// Set variables: all or none.
    pub fn assign(&mut self, values: Vec<(Reference, Value)>) -> PyResult<()> {
        let (mut references, mut numbers) = (Vec::new(), Vec::new());
        for (reference, given) in &values {
            match given {
                Value::Real(number) => {
                    references.push(*reference);
                    numbers.push(*number);
                }
                Value::Boolean(truth) => self.model.check_boolean(*reference, *truth).map_err(value)?,
                Value::Item(item) => self.model.check_text(*reference, item).map_err(value)?,
            }
        }
        if !numbers.is_empty() {
            self.set_reals(&references, &numbers)?;
        }
        for (reference, given) in &values {
            match given {
                Value::Real(_) => continue,
                Value::Boolean(truth) => self.model.set_boolean(*reference, *truth).map_err(value)?,
                Value::Item(item) => self.model.set_text(*reference, item).map_err(value)?,
            }
            let variable = &self.model.interface().list()[*reference as usize];
            self.is_initialized &= variable.causality != Causality::Parameter;
        }
        Ok(())
    }

    /// Set one variable.
    pub fn set(&mut self, name: &str, given: &Bound<'_, PyAny>) -> PyResult<()> {
        let interface = self.model.interface();
        let reference = find(interface, name).map_err(input)?;
        let set = arguments::value(&interface.list()[reference as usize], given)?;
        self.assign(vec![(reference, set)])
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

    /// The numbers of several variables. A Boolean is 1 or 0, an Enumeration is the number of its item from 1 on.
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

    /// Set several variables to the values in an array or a list: all or none.
    pub fn set_all(&mut self, names: &Names, given: &Bound<'_, PyAny>) -> PyResult<()> {
        names.belong_to(&self.model)?;
        if names.are_reals
            && let Some(set) = with_numbers(given, names.references.len(), |values| {
                if !names.are_inputs {
                    return self.set_reals(&names.references, values);
                }
                let all = || names.references.iter().zip(values);
                all().try_for_each(|(&own, &number)| self.model.check_real(own, number)).map_err(value)?;
                all().try_for_each(|(&own, &number)| self.model.take_real(own, number)).map_err(value)
            })
        {
            return set;
        }
        let list = self.model.interface().list();
        let variables = names.references.iter().map(|reference| &list[*reference as usize]);
        let values = arguments::values(variables, given)?;
        self.assign(names.references.iter().copied().zip(values).collect())
    }
}
