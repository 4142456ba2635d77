//! The continuous states of a model, their derivatives and event indicators, for model exchange.

use super::Reference;

/// Variables of a model that a host's solver integrates.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ContinuousTime {
    /// The states, in their order.
    pub states: Vec<Reference>,
    /// The time derivative of each state.
    pub derivatives: Vec<Reference>,
    /// The event indicators, in their order.
    pub indicators: Vec<Reference>,
}
