//! The default experiment that a definition states, and that hosts offer to their users.
use super::{DefinitionError, Range};
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
    /// Check both times.
    ///
    /// # Errors
    /// A time is not > 0.
    pub fn check(&self) -> Result<(), DefinitionError> {
        Range::Positive.check("experiment.stop_time", self.stop_time)?;
        Range::Positive.check("experiment.step_size", self.step_size)
    }
}
