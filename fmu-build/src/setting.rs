//! A value of a variable in a JSON file: a number, a Boolean or a text.
//!
//! In: a value of JSON. Out: the value for a variable. The module must not know models.

use crate::start_values;
use anyhow::{Result, bail};
use linkage_fmu::format::{Field, Json, Kind as Keys, Node, Own, Slot};
use linkage_fmu::variables::{Kind, Value, Variable};
use std::fmt;

/// Value of a variable.
#[derive(Clone, Debug, PartialEq)]
pub enum Setting {
    /// Of a Real.
    Real(f64),
    /// Of a Boolean.
    Boolean(bool),
    /// Of an Enumeration, or a value with its unit.
    Text(String),
}

impl Setting {
    /// The setting in a JSON node, if it contains one.
    pub fn of(node: &Node) -> Option<Self> {
        match &node.json {
            Json::Number(number) => Some(Self::Real(*number)).filter(|_| number.is_finite()),
            Json::Flag(value) => Some(Self::Boolean(*value)),
            Json::Text(text) => Some(Self::Text(text.clone())),
            Json::Null | Json::List(_) | Json::Object(_) => None,
        }
    }

    /// The value for a variable. A text may state a number with its unit, such as `"30 kN"`.
    ///
    /// # Errors
    /// The value has another type than the variable, or the unit of another quantity.
    pub fn value(&self, variable: &Variable) -> Result<Value> {
        Ok(match (self, variable.kind) {
            (Self::Real(value), Kind::Real) => Value::Real(*value),
            (Self::Boolean(value), Kind::Boolean) => Value::Boolean(*value),
            (Self::Text(text), _) => start_values::value(variable, text)?,
            _ => bail!("{} must be {}, not {self}", variable.name, words(variable.kind)),
        })
    }
}

/// A kind of values, in words.
pub fn words(kind: Kind) -> &'static str {
    match kind {
        Kind::Real => "a number",
        Kind::Boolean => "true or false",
        Kind::Enumeration => "a text in quotes",
    }
}

impl fmt::Display for Setting {
    /// Written as in JSON.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Real(value) => value.fmt(f),
            Self::Boolean(value) => value.fmt(f),
            Self::Text(text) => write!(f, "\"{}\"", text.escape_debug()),
        }
    }
}

impl Default for Setting {
    fn default() -> Self {
        Self::Real(0.0)
    }
}

impl Field for Setting {
    const KIND: Keys = Keys::Own("a number, true, false or a text");

    fn slot(&mut self) -> Slot<'_> {
        Slot::Own(self)
    }
}

impl Own for Setting {
    fn take(&mut self, node: &Node, text: &str) -> Result<(), String> {
        let stated = &text[node.span.clone()];
        *self =
            Self::of(node).ok_or_else(|| format!("{stated} is not a value; write a number, true, false or a text"))?;
        Ok(())
    }

    fn written(&self) -> String {
        self.to_string()
    }
}
