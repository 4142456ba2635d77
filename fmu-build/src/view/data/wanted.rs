//! The experiment of the command line: stop time and start values.

use crate::start_values::parse;
use anyhow::{Context, Result, anyhow, bail};
use linkage_fmu::simulation::Simulation;
use linkage_fmu::variables::{Reference, Value};

/// The requested experiment.
#[derive(Clone, Debug, Default)]
pub struct Wanted {
    /// Stop time [s]. None: that of the default experiment of the definition.
    pub stop_time: Option<f64>,
    /// Names and values, as written.
    start_values: Vec<String>,
    /// Names and values of the run to compare, set after the start values.
    changed: Vec<String>,
    /// Additional start values.
    values: Vec<(Reference, Value)>,
}

impl Wanted {
    /// From a stop time, and a list of names with their values.
    ///
    /// # Errors
    /// The stop time is no valid time.
    pub fn new(stop_time: Option<f64>, start_values: &[String]) -> Result<Self> {
        if let Some(time) = stop_time.filter(|time| !(time.is_finite() && *time >= 0.0)) {
            bail!("--stop-time {time}: must be a time in s, >= 0");
        }
        Ok(Self { stop_time, start_values: start_values.to_vec(), ..Self::default() })
    }

    /// The same experiment with these start values, in the order of the variables.
    #[must_use]
    pub fn with(self, values: Vec<(Reference, Value)>) -> Self {
        Self { values, ..self }
    }

    /// The same experiment with more start values, as written, which replace previous values of the same variables.
    #[must_use]
    pub fn compared(self, changed: &[String]) -> Self {
        Self { changed: changed.to_vec(), ..self }
    }

    /// Set the start values.
    ///
    /// # Errors
    /// A variable does not exist, or rejects the value.
    pub fn set(&self, simulation: &mut Simulation) -> Result<()> {
        let variables = simulation.model().variables();
        let mut all = parse(variables, &self.start_values)?;
        all.extend(self.values.iter().cloned());
        let changed = parse(variables, &self.changed)
            .map_err(|error| anyhow!(format!("{error:#}").replace("--start-values", "--compare-set")))?;
        all.retain(|(reference, _)| changed.iter().all(|(other, _)| other != reference));
        let all = all.into_iter().map(|one| ("--start-values", one));
        for (option, (reference, value)) in all.chain(changed.into_iter().map(|one| ("--compare-set", one))) {
            let name = simulation.model().variables().list()[reference as usize].name.clone();
            let set = match value {
                Value::Real(value) => simulation.set(&name, value),
                Value::Boolean(value) => simulation.set(&name, value),
                Value::Item(value) => simulation.set(&name, value.as_str()),
            };
            set.with_context(|| format!("{option} {name}"))?;
        }
        Ok(())
    }
}
