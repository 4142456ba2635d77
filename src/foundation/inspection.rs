//! Results of an inspection of a definition: facts about the model and findings, as plain data.
//!
//! In: nothing. Out: the types of facts and findings, with their lines of text. Must not know: kinds of model.
use crate::format::{DefinitionError, on_one_line};
use crate::variables::Unit;
use serde::Serialize;
use std::fmt;
use std::ops::Range;

/// Results of the inspection of a definition.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Inspection {
    /// Name of the model; empty if the definition could not be read.
    pub name: String,
    /// Whether the text has the form of a definition, so that its names and numbers were checked.
    pub is_readable: bool,
    /// Errors and warnings, in the order found.
    pub findings: Vec<Finding>,
    /// Facts, by topics.
    pub facts: Vec<Fact>,
}

/// Weight of a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// The definition describes no valid model.
    Error,
    /// The model runs, but probably differs from the intended model.
    Warning,
}

/// An error or a warning about one place of a definition.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// Weight.
    pub severity: Severity,
    /// Path of the key in the definition, such as `bodies.crank.length`; empty for the whole file.
    pub path: String,
    /// The fault, with the value and the limit. The message of an error also contains the path and the remedy.
    pub message: String,
    /// The remedy. Empty if the message contains it.
    pub remedy: String,
    /// Range of bytes in the text, if the fault was found when the text was read.
    #[serde(skip)]
    pub bytes: Option<Range<usize>>,
}

impl Finding {
    /// An error with a complete message.
    pub fn error(path: impl fmt::Display, message: impl fmt::Display) -> Self {
        let (path, message) = (path.to_string(), on_one_line(&message.to_string()));
        Self { severity: Severity::Error, path, message, remedy: String::new(), bytes: None }
    }

    /// The error for a fault of a definition, at this path.
    pub fn fault(path: &str, fault: &DefinitionError) -> Self {
        let bytes = fault.place().map(|place| place.bytes.clone());
        Self { bytes, ..Self::error(path, fault.message()) }
    }

    /// A warning about the value at this path.
    pub fn warning(path: impl fmt::Display, message: impl fmt::Display, remedy: impl fmt::Display) -> Self {
        Self::of_warning(&path, &message, &remedy)
    }

    // The code exists once for all types of texts.
    #[cold]
    #[inline(never)]
    fn of_warning(path: &dyn fmt::Display, message: &dyn fmt::Display, remedy: &dyn fmt::Display) -> Self {
        let [message, remedy] = [message, remedy].map(|text| on_one_line(&text.to_string()));
        let path = path.to_string();
        Self { severity: Severity::Warning, path, message, remedy, bytes: None }
    }
}

impl fmt::Display for Finding {
    /// One line, for a log.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.severity == Severity::Warning && !self.path.is_empty() {
            write!(f, "{}: ", self.path)?;
        }
        f.write_str(&self.message)?;
        if self.remedy.is_empty() { Ok(()) } else { write!(f, "; {}", self.remedy) }
    }
}

/// A fact about a part of the model.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fact {
    /// Topic, which groups facts in a printed list.
    pub topic: &'static str,
    /// Name of the part, such as a coordinate, a drive or a joint. Empty for the whole model.
    pub of: String,
    /// Numbers with their names and units.
    pub quantities: Vec<Quantity>,
    /// Additional text; may be empty.
    pub text: String,
}

/// A number with its name and unit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Quantity {
    /// Name, such as `guess`.
    pub name: &'static str,
    /// Value. Not finite if the quantity is unbounded.
    pub value: f64,
    /// Unit as in `modelDescription.xml`, such as `rad`.
    pub unit: &'static str,
}

impl Fact {
    /// A fact about the part `of` of the model.
    pub fn new(topic: &'static str, of: impl Into<String>) -> Self {
        Self { topic, of: of.into(), quantities: Vec::new(), text: String::new() }
    }

    /// Adds a number to the fact.
    pub fn with(mut self, name: &'static str, value: f64, unit: Unit) -> Self {
        self.quantities.push(Quantity { name, value, unit: unit.name() });
        self
    }

    /// Sets the text of the fact.
    pub fn saying(mut self, text: impl Into<String>) -> Self {
        self.text = text.into();
        self
    }
}
