//! A refused call: the status the host gets and the line the logger gets.
//!
//! The message names the quantity, the value, the limit and what to do; the function's name is put in front of it by
//! `guard`.

use super::types::Status;
use crate::mechanism::ModelError;

/// Why a call was refused. The instance is unchanged.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    /// Answer to the host: `Discard` or `Error`.
    pub status: Status,
    /// One line for the logger.
    pub message: String,
}

impl Refusal {
    /// A call that is wrong, or that failed.
    pub fn error(message: impl Into<String>) -> Self {
        Refusal { status: Status::Error, message: message.into() }
    }

    /// A question without an answer here; the instance goes on (FMI 2.0.5, 4.2.3).
    pub fn discard(message: impl Into<String>) -> Self {
        Refusal { status: Status::Discard, message: message.into() }
    }
}

impl From<ModelError> for Refusal {
    fn from(error: ModelError) -> Self {
        Refusal::error(error.to_string())
    }
}
