//! What is said about a call that is not answered with OK: the verdict that the host gets and the line that the logger
//! gets.
//!
//! The message names the quantity, the value, the limit and what to do; `handle` puts the function's name in front of
//! it.

use crate::component::{NoValue, Refused};

/// Answer to a call, in the words that all versions of FMI share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Done.
    Ok,
    /// Done, although something about the call is unusual.
    Warning,
    /// A question without an answer, after which the instance goes on; or a step that came to a part of its end.
    Discard,
    /// Refused or failed; a message says why.
    Error,
    /// A fault inside this library; the instance is lost.
    Fatal,
}

/// Why a call was refused; the instance is unchanged, unless a step was made in part. With the verdict `Warning`: what
/// is unusual about a call that was done.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    /// Answer to the host.
    pub verdict: Verdict,
    /// One line for the logger.
    pub message: String,
}

impl Refusal {
    /// A call that is wrong, or that failed.
    pub fn error(message: impl Into<String>) -> Self {
        Refusal { verdict: Verdict::Error, message: message.into() }
    }

    /// A call that was done, although something about it is unusual.
    pub fn warning(message: impl Into<String>) -> Self {
        Refusal { verdict: Verdict::Warning, message: message.into() }
    }

    /// A question without an answer, or a step that was made in part.
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
