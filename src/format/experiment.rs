//! The default experiment that a definition states, and that hosts offer to their users.
use super::{DefinitionError, Range};
use crate::numerics::decimal::Decimal;
use serde::{Deserialize, Serialize};

/// Default experiment of the FMU.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Experiment {
    /// Stop time [s], > 0; the start time is 0.
    pub stop_time: f64,
    /// Preferred communication step [s], > 0.
    pub step_size: f64,
}

impl Default for Experiment {
    fn default() -> Self {
        Self { stop_time: 1.0, step_size: 1e-3 }
    }
}

impl Experiment {
    /// Key, message and remedy of a step that is longer than the whole run; none if it is not.
    pub fn coarse(&self) -> Option<(&'static str, String, &'static str)> {
        let (step, stop) = (Decimal(self.step_size), Decimal(self.stop_time));
        let message = format!("is {step} s, longer than the whole run of {stop} s, which is cut to one step");
        let remedy = "give a step_size below stop_time";
        (self.step_size > self.stop_time).then_some(("experiment.step_size", message, remedy))
    }

    /// Check both times.
    ///
    /// # Errors
    /// A time is not > 0.
    pub fn check(&self) -> Result<(), DefinitionError> {
        Range::Positive.check("experiment.stop_time", self.stop_time)?;
        Range::Positive.check("experiment.step_size", self.step_size)
    }
}
