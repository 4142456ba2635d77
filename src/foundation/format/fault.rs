//! Faults of a definition, each with its key, its place and the remedy.
use super::range::Range;
use crate::numerics::decimal::Decimal;
use crate::variables::{Unit, edits, nearest};
use std::fmt::{self, Display};
use std::ops;

/// Fault at a key.
#[derive(Clone, Debug, PartialEq)]
pub enum Fault {
    /// The text is not valid JSON.
    Syntax(String),
    /// The object has no key of this name, but these keys.
    UnknownKey(String, Vec<&'static str>),
    /// A required key is missing.
    Missing(&'static str),
    /// A name occurs twice in one object.
    Twice(String),
    /// A value of the wrong type.
    Type {
        /// The expected type.
        expected: String,
        /// The value found.
        found: String,
        /// The remedy, if it is not obvious; otherwise empty.
        remedy: &'static str,
    },
    /// The word is none of the allowed words.
    Word(String, &'static [&'static str]),
    /// A number out of range.
    Range(f64, Unit, Range),
    /// A text or number that is not allowed, and the allowed values.
    Value(String, String),
    /// Any other fault, as text.
    Other(String),
}

/// Place in the text of a definition.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// Range of bytes.
    pub bytes: ops::Range<usize>,
    /// Line and column of the start, from 1. Columns count characters.
    pub position: [usize; 2],
}

impl Place {
    /// The place of these bytes in a text.
    pub fn new(text: &str, bytes: ops::Range<usize>) -> Self {
        let before = text.get(..bytes.start).unwrap_or(text);
        let line = before.rfind('\n').map_or(0, |end| end + 1);
        let position = [before.matches('\n').count() + 1, before[line..].chars().count() + 1];
        Self { bytes, position }
    }
}

/// Error of a definition. The text states the key, the value and the allowed values.
#[derive(Clone, Debug, PartialEq)]
pub struct DefinitionError {
    path: String,
    fault: Box<Fault>,
    place: Option<Box<Place>>,
}

impl DefinitionError {
    /// A fault at a key.
    #[cold]
    pub fn new(path: impl Into<String>, fault: Fault) -> Self {
        Self { path: path.into(), fault: Box::new(fault), place: None }
    }

    /// A key that excludes another key, or any other fault as text.
    pub fn key(key: impl Display, message: impl Display) -> Self {
        Self::other(&key, &message)
    }

    // The code exists once for all types of texts, here and below.
    #[cold]
    #[inline(never)]
    fn other(key: &dyn Display, message: &dyn Display) -> Self {
        Self::new(key.to_string(), Fault::Other(message.to_string()))
    }

    /// A number or text that is out of range.
    pub fn value(key: impl Display, value: impl Display, allowed: impl Display) -> Self {
        Self::refused(&key, &value, &format_args!("must be {allowed}"))
    }

    /// A name of no element.
    pub fn unknown(key: impl Display, name: &str, allowed: impl Display) -> Self {
        Self::refused(&key, &format_args!("\"{name}\""), &format_args!("no element has this name; {allowed}"))
    }

    #[cold]
    #[inline(never)]
    fn refused(key: &dyn Display, value: &dyn Display, allowed: &dyn Display) -> Self {
        Self::new(key.to_string(), Fault::Value(value.to_string(), allowed.to_string()))
    }

    /// Adds the place to the fault.
    pub fn at(mut self, place: Place) -> Self {
        self.place = Some(Box::new(place));
        self
    }

    /// Path of the faulty key, such as `bodies.crank.length`.
    pub fn path(&self) -> &str {
        &self.path
    }

    /// The fault.
    pub fn fault(&self) -> &Fault {
        &self.fault
    }

    /// The place, if the fault was found when the text was read.
    pub fn place(&self) -> Option<&Place> {
        self.place.as_deref()
    }

    /// Path, fault and remedy on one line, without the place. Of a very deep path, only the start is shown.
    pub fn message(&self) -> String {
        const DEEPEST: usize = 20;
        let colon = if matches!(*self.fault, Fault::Range(..) | Fault::Value(..)) { "" } else { ":" };
        let is_deep = self.path.matches(['[', '.']).count() > DEEPEST;
        let (path, dots) =
            if is_deep { (self.path.chars().take(40).collect(), "...") } else { (self.path.clone(), "") };
        on_one_line(&format!("{path}{dots}{colon} {}", self.fault))
    }
}

impl Display for DefinitionError {
    /// Writes the message with its place. A key in the file may contain any character.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message())?;
        match &self.place {
            Some(place) => write!(f, " (line {}, column {})", place.position[0], place.position[1]),
            None => Ok(()),
        }
    }
}

impl std::error::Error for DefinitionError {}

impl Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Syntax(message) | Self::Other(message) => f.write_str(message),
            Self::UnknownKey(key, keys) => {
                write!(f, "there is no key `{key}` here; ")?;
                match meant(keys.iter().copied(), key) {
                    Some(meant) => write!(f, "did you mean `{meant}`?"),
                    None => write!(f, "the keys are {}", listed(keys.iter().copied(), "and")),
                }
            }
            Self::Missing(key) => write!(f, "the key `{key}` is missing: add this key"),
            Self::Twice(name) => write!(f, "`{name}` occurs twice: remove or rename one of the two"),
            Self::Type { expected, found, remedy } => write!(f, "must be {expected}, not {found}{remedy}"),
            Self::Word(word, words) if words.len() > MANY => {
                let nearest = nearest(words.iter().copied(), word);
                write!(f, "`{word}` is not allowed here; similar words are {}", listed(nearest.into_iter(), "and"))
            }
            Self::Word(word, words) => {
                write!(f, "must be {}, not `{word}`", listed(words.iter().copied(), "or"))?;
                meant(words.iter().copied(), word).map_or(Ok(()), |meant| write!(f, "; did you mean `{meant}`?"))
            }
            Self::Range(value, Unit::One, range) => write!(f, "= {}: must be {}", Decimal(*value), range.text()),
            Self::Range(value, unit, range) => {
                let name = unit.name();
                let allowed = match (range, unit) {
                    // The file may state lengths and angles in another unit.
                    (Range::Coordinate, Unit::Metre | Unit::Radian) => {
                        format!("a number from -1e100 {name} to 1e100 {name}")
                    }
                    _ => range.text(),
                };
                write!(f, "= {} {name}: must be {allowed}", Decimal(*value))
            }
            Self::Value(value, allowed) => write!(f, "= {value}: {allowed}"),
        }
    }
}

/// Largest number of words that are listed completely.
const MANY: usize = 8;

/// These words in backticks.
fn listed<'w>(words: impl Iterator<Item = &'w str>, and: &str) -> String {
    let words: Vec<String> = words.map(|word| format!("`{word}`")).collect();
    match words.as_slice() {
        [first @ .., before, last] => {
            let first = first.iter().map(|word| format!("{word}, ")).collect::<String>();
            format!("{first}{before} {and} {last}")
        }
        words => words.concat(),
    }
}

/// Words of other programs and of everyday language, with the corresponding words of a definition.
const SYNONYMS: [(&str, &str); 9] = [
    ("weight", "mass"),
    ("moment_of_inertia", "inertia"),
    ("links", "bodies"),
    ("hinges", "joints"),
    ("drives", "actuators"),
    ("motors", "actuators"),
    ("dampers", "springs"),
    ("spring_rate", "stiffness"),
    ("initial", "start"),
];

/// The allowed word that the user probably meant.
fn meant<'w>(words: impl Iterator<Item = &'w str> + Clone, word: &str) -> Option<&'w str> {
    let synonym = SYNONYMS.iter().find(|(other, _)| *other == word);
    if let Some(own) = synonym.and_then(|(_, own)| words.clone().find(|word| word == own)) {
        return Some(own);
    }
    let nearest = nearest(words, word).into_iter().next()?;
    let is_alike = edits(word, nearest) <= 1 + word.len() / 5 || nearest.starts_with(word) || word.starts_with(nearest);
    is_alike.then_some(nearest)
}

impl Range {
    /// Checks the value of a key.
    ///
    /// # Errors
    /// The value is out of the range.
    pub fn check(self, key: impl Display, value: f64) -> Result<(), DefinitionError> {
        self.check_in(Unit::One, key, value)
    }

    /// Checks the value of a key in this unit.
    ///
    /// # Errors
    /// The value is out of the range.
    pub fn check_in(self, unit: Unit, key: impl Display, value: f64) -> Result<(), DefinitionError> {
        if self.contains(value) { Ok(()) } else { Err(self.refused(unit, &key, value)) }
    }

    #[cold]
    #[inline(never)]
    fn refused(self, unit: Unit, key: &dyn Display, value: f64) -> DefinitionError {
        DefinitionError::new(key.to_string(), Fault::Range(value, unit, self))
    }
}

/// All faults of a definition, in the order in which they are found.
#[derive(Debug, Default)]
pub struct Faults(Vec<DefinitionError>);

impl Faults {
    /// Adds a fault.
    pub fn push(&mut self, fault: DefinitionError) {
        self.0.push(fault);
    }

    /// The checked value, or None if there is a fault, which is added.
    pub fn keep<T>(&mut self, checked: Result<T, DefinitionError>) -> Option<T> {
        checked.map_err(|fault| self.add(fault)).ok()
    }

    /// Adds a key that excludes another key, or any other fault as text.
    pub fn refuse(&mut self, key: impl Display, message: impl Display) {
        self.add_other(&key, &message);
    }

    #[cold]
    #[inline(never)]
    fn add_other(&mut self, key: &dyn Display, message: &dyn Display) {
        self.0.push(DefinitionError::other(key, message));
    }

    #[cold]
    #[inline(never)]
    fn add(&mut self, fault: DefinitionError) {
        self.0.push(fault);
    }

    /// Adds the faults of another reading of the same text, except for equal faults.
    pub fn join(&mut self, others: Self) {
        others.0.into_iter().for_each(|fault| {
            if !self.0.contains(&fault) {
                self.0.push(fault);
            }
        });
    }

    /// Removes the faults for which `is_none` is true.
    pub fn forgive(&mut self, is_none: impl Fn(&DefinitionError) -> bool) {
        self.0.retain(|fault| !is_none(fault));
    }

    /// Changes the paths of faults that were not found when the text was read.
    pub fn rename(&mut self, path: impl Fn(&str) -> String) {
        self.0.iter_mut().filter(|fault| fault.place.is_none()).for_each(|fault| fault.path = path(&fault.path));
    }

    /// Number of faults.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there is no fault.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Whether all faults are unknown keys, so that every known key has its value.
    pub fn are_of_unknown_keys(&self) -> bool {
        self.0.iter().all(|fault| matches!(fault.fault(), Fault::UnknownKey(..)))
    }

    /// Ok, or the first fault.
    ///
    /// # Errors
    /// The first fault.
    pub fn first(self) -> Result<(), DefinitionError> {
        self.0.into_iter().next().map_or(Ok(()), Err)
    }
}

impl IntoIterator for Faults {
    type Item = DefinitionError;
    type IntoIter = std::vec::IntoIter<DefinitionError>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.into_iter()
    }
}

/// A message on one line, with escaped control characters.
pub fn on_one_line(message: &str) -> String {
    let mut line = String::with_capacity(message.len());
    for c in message.chars() {
        match c.is_control() {
            true => line.extend(c.escape_default()),
            false => line.push(c),
        }
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_is_one_line() {
        assert_eq!(on_one_line("räder\0 a\r\nb\u{7f} 'c'"), "räder\\u{0} a\\r\\nb\\u{7f} 'c'");
    }

    #[test]
    fn columns_count_characters() {
        assert_eq!(Place::new("é\nöx", 6..7).position, [2, 3]);
        assert_eq!(Place::new("", 0..0).position, [1, 1]);
    }
}
