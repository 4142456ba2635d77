//! What can be wrong with a definition.
use std::fmt;

/// A refused definition; the text names the key, the value and what is allowed.
#[derive(Clone, Debug, PartialEq)]
pub enum DefinitionError {
    /// Not JSON, or not the JSON of this format.
    Malformed {
        /// Path of the key at which the parser stopped; empty at the top.
        key: String,
        /// The parser's message, with line and column.
        message: String,
    },
    /// A number or text out of its range.
    Value {
        /// Path of the key, such as `bodies.crank.mass`.
        key: String,
        /// The value as it stands.
        value: String,
        /// What is allowed.
        allowed: String,
    },
    /// A name that nothing carries.
    Unknown {
        /// Path of the key.
        key: String,
        /// The name as it stands.
        name: String,
        /// What it should name, and which there are.
        allowed: String,
    },
    /// A key that is missing or that does not go with another.
    Key {
        /// Path of the key.
        key: String,
        /// What is wrong and what to do.
        message: String,
    },
}

impl fmt::Display for DefinitionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Malformed { key, message } if key.is_empty() => write!(f, "no mechanism: {message}"),
            Self::Malformed { key, message } => write!(f, "{key}: {message}"),
            Self::Value { key, value, allowed } => write!(f, "{key} = {value}: must be {allowed}"),
            Self::Unknown { key, name, allowed } => write!(f, "{key} = \"{name}\": there is none; {allowed}"),
            Self::Key { key, message } => write!(f, "{key}: {message}"),
        }
    }
}

impl std::error::Error for DefinitionError {}
