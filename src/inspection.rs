//! Results of an inspection of a definition: facts about the model and findings, as plain data.
//!
//! In: nothing. Out: the types of facts and findings, with their lines of text. It must not know kinds of model.
use crate::format::{DefinitionError, on_one_line};
use crate::variables::Unit;
use serde::Serialize;
use std::fmt;
use std::ops::Range;

/// All that an inspection of a definition has found.
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
    /// The definition gives no model.
    Error,
    /// The model runs, but is probably not the one that is meant.
    Warning,
}

/// An error or a warning about one place of a definition.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// Weight.
    pub severity: Severity,
    /// Path of the key in the definition, such as `bodies.crank.length`; empty for the whole file.
    pub path: String,
    /// What is wrong, with the value and the limit; of an error with the path and the remedy too.
    pub message: String,
    /// What to do; empty where the message says it.
    pub remedy: String,
    /// Range of bytes in the text, of a fault that was found while the text was read.
    #[serde(skip)]
    pub bytes: Option<Range<usize>>,
}

impl Finding {
    /// An error whose text is complete.
    pub fn error(path: impl fmt::Display, message: impl fmt::Display) -> Self {
        let (path, message) = (path.to_string(), on_one_line(&message.to_string()));
        Self { severity: Severity::Error, path, message, remedy: String::new(), bytes: None }
    }

    /// The error of a fault of a definition, which belongs to this path.
    pub fn fault(path: &str, fault: &DefinitionError) -> Self {
        let bytes = fault.place().map(|place| place.bytes.clone());
        Self { bytes, ..Self::error(path, fault.message()) }
    }

    /// A warning about the value at this path.
    pub fn warning(path: impl fmt::Display, message: impl AsRef<str>, remedy: impl AsRef<str>) -> Self {
        Self::of_warning(&path, message.as_ref(), remedy.as_ref())
    }

    // One copy of the code for all types of texts.
    #[cold]
    #[inline(never)]
    fn of_warning(path: &dyn fmt::Display, message: &str, remedy: &str) -> Self {
        let (path, message, remedy) = (path.to_string(), on_one_line(message), on_one_line(remedy));
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
    /// Topic, under which facts are printed together.
    pub topic: &'static str,
    /// Name of the coordinate, drive, joint or the like; empty for the whole model.
    pub of: String,
    /// Numbers with their names and units.
    pub quantities: Vec<Quantity>,
    /// What the numbers do not say; may be empty.
    pub text: String,
}

/// A number with its name and unit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Quantity {
    /// Name, such as `guess`.
    pub name: &'static str,
    /// Value; not finite where the quantity is unbounded.
    pub value: f64,
    /// Unit as in `modelDescription.xml`, such as `rad`.
    pub unit: &'static str,
}

impl Fact {
    /// A fact of a topic about a part.
    pub fn new(topic: &'static str, of: impl Into<String>) -> Self {
        Self { topic, of: of.into(), quantities: Vec::new(), text: String::new() }
    }

    /// The fact with one more number.
    pub fn with(mut self, name: &'static str, value: f64, unit: Unit) -> Self {
        self.quantities.push(Quantity { name, value, unit: unit.name() });
        self
    }

    /// The fact with this text.
    pub fn saying(mut self, text: impl Into<String>) -> Self {
        self.text = text.into();
        self
    }
}
