//! What can be wrong with a definition.
use std::fmt::{self, Write};

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
        let line = match self {
            Self::Malformed { key, message } if key.is_empty() => format!("no mechanism: {message}"),
            Self::Malformed { key, message } => format!("{key}: {message}"),
            Self::Value { key, value, allowed } => format!("{key} = {value}: must be {allowed}"),
            Self::Unknown { key, name, allowed } => format!("{key} = \"{name}\": there is none; {allowed}"),
            Self::Key { key, message } => format!("{key}: {message}"),
        };
        // A key in the file may hold any character, and a message is one line.
        line.chars()
            .try_for_each(|c| if c.is_control() { write!(f, "{}", c.escape_default()) } else { f.write_char(c) })
    }
}

impl std::error::Error for DefinitionError {}
