//! Why a component refuses a call, or has no value in a trial state.
//!
//! In: the error of a model of any kind. Out: its text. It must not know what was asked.
use crate::hydraulics::HydraulicsError;
use crate::mechanism::{self, ModelError};
use std::fmt;

/// Why a model refuses a call; the model is unchanged. The text names the quantity, the value, the limit and the
/// remedy.
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

/// Why a question of a host's solver has no answer; the model is unchanged.
#[derive(Clone, Debug, PartialEq)]
pub enum NoValue {
    /// There is no value at this trial state: a shorter step of the solver avoids it.
    AtState(String),
    /// Whatever the state.
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
