//! Verdict and message of a call that does not return OK. The host gets the verdict, and the logger gets the message.
//!
//! The message states the quantity, the value, the limit and the remedy. `handle` adds the function's name.

use crate::component::{NoValue, Refused};

/// Answer to a call, independent of the version of FMI.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Done.
    Ok,
    /// Done, with a remark about something unusual.
    Warning,
    /// The requested value does not exist, and the instance can continue; or a step ended early.
    Discard,
    /// The call is wrong or failed. A message states the reason.
    Error,
    /// A fault inside this library. The instance cannot be used any more.
    Fatal,
}

/// Reason why a call was not carried out. The instance is unchanged, unless a part of a step was made. With the verdict
/// `Warning`, the call was carried out.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    /// Verdict for the host.
    pub verdict: Verdict,
    /// One line for the logger.
    pub message: String,
}

impl Refusal {
    /// A call that is wrong, or that failed.
    pub fn error(message: impl Into<String>) -> Self {
        Refusal { verdict: Verdict::Error, message: message.into() }
    }

    /// A call that was carried out, with a remark about something unusual.
    pub fn warning(message: impl Into<String>) -> Self {
        Refusal { verdict: Verdict::Warning, message: message.into() }
    }

    /// A value that does not exist, or a step that was made in part.
    pub fn discard(message: impl Into<String>) -> Self {
        Refusal { verdict: Verdict::Discard, message: message.into() }
    }
}

impl From<NoValue> for Refusal {
    #[cold]
    fn from(no_value: NoValue) -> Self {
        match no_value {
            NoValue::AtState(why) => Refusal::discard(why),
            NoValue::Refused(refused) => refused.into(),
        }
    }
}

impl From<Refused> for Refusal {
    #[cold]
    fn from(refused: Refused) -> Self {
        Refusal::error(refused.0)
    }
}
