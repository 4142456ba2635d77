//! What can be wrong with a definition.
use std::fmt::{self, Write};

/// A refused definition; the text names the key, the value and what is allowed.
#[derive(Clone, Debug, PartialEq)]
pub enum DefinitionError {
    /// Not JSON, or not the JSON of this format.
    Malformed {
        /// Path of the key at which the parser stopped; at the top `no mechanism`, with the kind of definition.
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
    /// A name that no element has.
    Unknown {
        /// Path of the key.
        key: String,
        /// The name as it stands.
        name: String,
        /// The names that there are.
        allowed: String,
    },
    /// A missing key, or a key that excludes another.
    Key {
        /// Path of the key.
        key: String,
        /// What is wrong and what to do.
        message: String,
    },
}

impl DefinitionError {
    /// [`Self::Key`].
    pub fn key(key: impl fmt::Display, message: impl Into<String>) -> Self {
        Self::Key { key: key.to_string(), message: message.into() }
    }

    /// [`Self::Value`].
    pub fn value(key: impl fmt::Display, value: impl fmt::Display, allowed: impl Into<String>) -> Self {
        Self::Value { key: key.to_string(), value: value.to_string(), allowed: allowed.into() }
    }

    /// [`Self::Unknown`].
    pub fn unknown(key: impl fmt::Display, name: &str, allowed: impl Into<String>) -> Self {
        Self::Unknown { key: key.to_string(), name: name.into(), allowed: allowed.into() }
    }
}

impl fmt::Display for DefinitionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let line = match self {
            Self::Value { key, value, allowed } => format!("{key} = {value}: must be {allowed}"),
            Self::Unknown { key, name, allowed } => format!("{key} = \"{name}\": there is none; {allowed}"),
            Self::Malformed { key, message } | Self::Key { key, message } => format!("{key}: {message}"),
        };
        // A key in the file may hold any character, and a message is one line.
        line.chars()
            .try_for_each(|c| if c.is_control() { write!(f, "{}", c.escape_default()) } else { f.write_char(c) })
    }
}

impl std::error::Error for DefinitionError {}
