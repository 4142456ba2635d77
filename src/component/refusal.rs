//! Reasons why a component returns an error, or has no value in a trial state.
//!
//! In: the error of a model of any kind. Out: its text. Must not know: the call.
use crate::hydraulics::HydraulicsError;
use crate::mechanism::{self, ModelError};
use std::fmt;

/// Error of a model, which is unchanged. The text states the quantity, the value, the limit and the remedy.
#[derive(Clone, Debug, PartialEq)]
pub struct Refused(pub String);

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Refused {}

impl From<ModelError> for Refused {
    #[cold]
    fn from(error: ModelError) -> Self {
        Self(error.to_string())
    }
}

impl From<HydraulicsError> for Refused {
    #[cold]
    fn from(error: HydraulicsError) -> Self {
        Self(error.to_string())
    }
}

/// Reason why a value for a host's solver does not exist. The model is unchanged.
#[derive(Clone, Debug, PartialEq)]
pub enum NoValue {
    /// The value does not exist at this trial state. A shorter step of the solver avoids the state.
    AtState(String),
    /// The call is wrong in every state.
    Refused(Refused),
}

impl From<mechanism::NoValue> for NoValue {
    #[cold]
    fn from(no_value: mechanism::NoValue) -> Self {
        match no_value {
            mechanism::NoValue::AtState(why) => Self::AtState(why),
            mechanism::NoValue::Refused(error) => Self::Refused(error.into()),
        }
    }
}
