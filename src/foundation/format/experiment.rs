//! The default experiment of a definition, which hosts propose to their users.
use super::{DefinitionError, Range, number};
use crate::numerics::decimal::Decimal;
use crate::variables::Unit;

super::keys! {
    /// The object `experiment` states the default run that the FMU proposes to the simulation tool. The default run
    /// starts at 0 s.
    pub struct Experiment: Copy {
        /// Time at which the default run ends [s], > 0.
        stop_time: f64 = 1.0 => number(Unit::Second, Range::Positive).required();
        /// Communication step size that the FMU proposes to the simulation tool [s], > 0.
        step_size: f64 = 1e-3 => number(Unit::Second, Range::Positive).required();
    }
}

impl Experiment {
    /// Key, message and remedy if the step is longer than the whole run.
    pub fn coarse(&self) -> Option<(&'static str, String, &'static str)> {
        let (step, stop) = (Decimal(self.step_size), Decimal(self.stop_time));
        let message =
            format!("the step size is {step} s, but stop_time is {stop} s, so the whole run is one step of {stop} s");
        let remedy = "give a `step_size` that is smaller than `stop_time`";
        (self.step_size > self.stop_time).then_some(("experiment.step_size", message, remedy))
    }

    /// Checks both times.
    ///
    /// # Errors
    /// A time is not > 0.
    pub fn check(&self) -> Result<(), DefinitionError> {
        Range::Positive.check("experiment.stop_time", self.stop_time)?;
        Range::Positive.check("experiment.step_size", self.step_size)
    }
}
