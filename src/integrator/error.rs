//! Why an integration stops.

/// Why an integration stopped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum IntegrationError {
    /// No step above the round-off of time meets the tolerance.
    StepTooSmall {
        /// Time since the start of the span [s].
        t: f64,
        /// The step size that was still too large [s].
        step: f64,
    },
}
