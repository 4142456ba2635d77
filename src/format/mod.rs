//! What every kind of definition file needs: JSON read to the letter, ordered names, errors with the path of the key,
//! the texts and ranges of parameters, and the default experiment.
//!
//! In: the text of a file. Out: a value of the definition's type, or an error for whoever writes the file. It must not
//! know what any definition says.
mod about;
mod experiment;
mod expression;
mod named;
mod numbers;
mod parameter;
mod strict;

pub use about::About;
pub use experiment::Experiment;
pub use expression::{Expression, LONGEST_EXPRESSION, is_reserved, number_with_unit};
pub use named::Named;
pub use numbers::{Numbers, index_of};
pub use parameter::{Flag, Owner, Parameter, Range};

use crate::variables::{edits, nearest};
use serde::de::DeserializeOwned;
use std::fmt::{self, Display};
use strict::{Reading, Strict};

/// A refused definition; the text names the key, the value and what is allowed.
#[derive(Clone, Debug, PartialEq)]
pub struct DefinitionError {
    path: String,
    text: String,
}

impl DefinitionError {
    /// A missing key, a key that excludes another, or a text that is not JSON of this format.
    pub fn key(key: impl Display, message: impl Display) -> Self {
        Self::new(&key, format_args!(": {message}"))
    }

    /// A number or text out of its range.
    pub fn value(key: impl Display, value: impl Display, allowed: impl Display) -> Self {
        Self::new(&key, format_args!(" = {value}: must be {allowed}"))
    }

    /// A name that no element has.
    pub fn unknown(key: impl Display, name: &str, allowed: impl Display) -> Self {
        Self::new(&key, format_args!(" = \"{name}\": there is none; {allowed}"))
    }

    /// One copy of this for all types of keys and texts.
    #[cold]
    #[inline(never)]
    fn new(key: &dyn Display, text: fmt::Arguments) -> Self {
        let path = key.to_string();
        Self { text: format!("{path}{text}"), path }
    }

    /// Path of the key at fault, such as `bodies.crank.length`.
    pub fn path(&self) -> &str {
        &self.path
    }
}

/// All faults of a definition, in the order in which they are found.
#[derive(Debug, Default)]
pub struct Faults(Vec<DefinitionError>);

impl Faults {
    /// The value that was checked; None if it is at fault, which is kept.
    pub fn keep<T>(&mut self, checked: Result<T, DefinitionError>) -> Option<T> {
        checked.map_err(|fault| self.0.push(fault)).ok()
    }

    /// Number of faults.
    #[expect(clippy::len_without_is_empty, reason = "nobody asks")]
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Nothing, or the first fault.
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

impl Display for DefinitionError {
    /// A key in the file may hold any character.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&on_one_line(&self.text))
    }
}

impl std::error::Error for DefinitionError {}

/// A message on one line: control characters are made visible.
pub(crate) fn on_one_line(message: &str) -> String {
    let mut line = String::with_capacity(message.len());
    for c in message.chars() {
        match c.is_control() {
            true => line.extend(c.escape_default()),
            false => line.push(c),
        }
    }
    line
}

/// Largest number of bytes of a definition; a mechanism of 100 bodies has about 30 thousand.
pub const LARGEST_DEFINITION: u64 = 16 << 20;

/// Read a definition of a `kind`, a word of the message where the text as a whole is at fault.
///
/// # Errors
/// More than [`LARGEST_DEFINITION`]; the path of the key at which the parser stopped, with its message.
pub fn read<T: DeserializeOwned>(kind: &str, text: &str) -> Result<T, DefinitionError> {
    read_with(kind, text, &Numbers::default())
}

/// [`read`] with what becomes of expressions in the place of numbers.
///
/// # Errors
/// As [`read`]; a value of `numbers` that is none.
pub fn read_with<T: DeserializeOwned>(kind: &str, text: &str, numbers: &Numbers) -> Result<T, DefinitionError> {
    if text.len() as u64 > LARGEST_DEFINITION {
        let message = format!("it has {} bytes, and a definition at most {LARGEST_DEFINITION}", text.len());
        return Err(DefinitionError::key(format!("no {kind}"), message));
    }
    // Some editors begin a file with a byte order mark.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut json = serde_json::Deserializer::from_str(text);
    let reading = Reading::new(numbers);
    let read = T::deserialize(Strict::new(&mut json, &reading)).and_then(|read| json.end().map(|()| read));
    read.map_err(|error| {
        let key = reading.into_path();
        let message = message(&error, text, key.is_empty());
        DefinitionError::key(if key.is_empty() { format!("no {kind}") } else { key }, message)
    })
}

/// The parser's message, for whoever writes the file; `is_top`: about the text as a whole.
fn message(error: &serde_json::Error, text: &str, is_top: bool) -> String {
    if text.trim().is_empty() {
        return "the file is empty; a definition is one object { \"name\": ... }".to_owned();
    }
    let message = error.to_string().replace("expected f64", "expected a number");
    let message = message.replace("EOF while parsing", "the text ends within");
    let message = message.replace("invalid type: sequence", "invalid type: a list [ ]");
    let message = message.replace("invalid type: map", "invalid type: an object { }");
    if let Some(meant) = meant(&message) {
        // A list of many words would hide the one that is meant.
        if message.matches('`').count() <= 2 + 2 * MOST_WORDS {
            return format!("{message}; did you mean `{meant}`?");
        }
        let said = message.split_once(", expected ").map_or(&*message, |(said, _)| said);
        let place = message.rfind(" at line ").map_or("", |at| &message[at..]);
        return format!("{said}; did you mean `{meant}`?{place}");
    }
    let remedy = if message.contains("invalid type: null") {
        "; leave the key out if it has no value"
    } else if is_top && message.contains("expected an object") {
        "; a definition is one object { \"name\": ... }"
    } else if message.contains("a list [ ], expected an object") {
        "; write { \"name\": value } in place of [ value ]"
    } else if message.contains("duplicate field") {
        "; remove one of the two"
    } else if message.contains("invalid length") || (!is_top && message.contains("trailing characters")) {
        // A list with more numbers than it has places.
        "; decimals are written with a point, such as 0.5"
    } else if message.contains("trailing characters") {
        "; the object ends before this: remove what follows, or a closing bracket too many before it"
    } else if error.is_syntax() {
        syntax_remedy(text, error.line(), error.column())
    } else {
        ""
    };
    message + remedy
}

/// Most words that may stand in a place which are told beside the one that is meant.
const MOST_WORDS: usize = 4;
/// Words of other programs and of everyday speech, with those of a definition.
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

/// Of the words that the parser expected in the place of another one, the one that was probably meant.
fn meant(message: &str) -> Option<String> {
    let rest = message.strip_prefix("unknown field `").or_else(|| message.strip_prefix("unknown variant `"))?;
    let (word, expected) = rest.split_once("`, expected ")?;
    let expected = || expected.split('`').skip(1).step_by(2);
    if let Some((_, own)) = SYNONYMS.iter().find(|(other, own)| *other == word && expected().any(|one| one == *own)) {
        return Some((*own).to_owned());
    }
    let nearest = nearest(expected(), word).into_iter().next()?;
    let is_alike = edits(word, nearest) <= 1 + word.len() / 5 || nearest.starts_with(word) || word.starts_with(nearest);
    is_alike.then(|| nearest.to_owned())
}

/// What is no JSON at this line and column, from 1, where it is known.
fn syntax_remedy(text: &str, line: usize, column: usize) -> &'static str {
    let Some(of_line) = text.split('\n').nth(line.saturating_sub(1)) else { return "" };
    let (bytes, at) = (of_line.as_bytes(), column.saturating_sub(1));
    // The parser stops at the fault, or one behind it.
    let starts = |from: usize, word: &str| {
        bytes.get(from..from + word.len()).is_some_and(|part| part.eq_ignore_ascii_case(word.as_bytes()))
    };
    let near = |words: &[&str]| {
        let places = at.saturating_sub(3)..=at;
        places.into_iter().any(|from| words.iter().any(|word| starts(from, word)))
    };
    let is_digit = |at: usize| bytes.get(at).is_some_and(u8::is_ascii_digit);
    if near(&["//", "/*"]) || starts(at, "#") {
        "; JSON has no comments: remove this one"
    } else if near(&["nan", "inf"]) {
        "; numbers are finite in JSON: give one, or leave the key out"
    } else if at > 1 && is_digit(at) && bytes[at - 1] == b',' && is_digit(at - 2) {
        "; decimals are written with a point, such as 0.5"
    } else {
        ""
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_json_is_named() {
        for (text, said) in [
            ("{ // none\n}", "no comments"),
            ("{\n  /* none */ \"a\": 1 }", "no comments"),
            ("{ \"a\": 1 # none\n}", "no comments"),
            ("{ \"a\": NaN }", "finite"),
            ("{ \"a\": -Infinity }", "finite"),
            ("{ \"a\": 0,5 }", "with a point"),
            ("{ \"a\": [1.0, 2.0] }", "a list [ ], expected"),
        ] {
            let message = read::<std::collections::HashMap<String, f64>>("test", text).unwrap_err().to_string();
            assert!(message.contains(said), "{text}: {message}");
        }
        for (text, said) in [("", "the file is empty"), (" \n", "the file is empty"), ("{ \"a\": 1", "ends within")] {
            let message = read::<Named<f64>>("test", text).unwrap_err().to_string();
            assert!(message.contains(said) && !message.contains("EOF"), "{text}: {message}");
        }
        let message = read::<std::collections::HashMap<String, [f64; 2]>>("test", "{ \"a\": [0,5, 0,2] }");
        let message = message.unwrap_err().to_string();
        assert!(message.contains("with a point"), "{message}");
        for (text, said) in [("[1]", "one object {"), ("{} {}", "remove what follows"), ("{} }", "bracket too many")] {
            let message = read::<Named<f64>>("test", text).unwrap_err().to_string();
            assert!(message.contains(said) && !message.contains("a point"), "{message}");
        }
        let message = read::<Named<Named<f64>>>("test", "{ \"a\": [1] }").unwrap_err().to_string();
        assert!(message.contains("expected an object") && message.contains("in place of"), "{message}");
    }

    #[test]
    fn a_message_is_one_line() {
        assert_eq!(on_one_line("räder\0 a\r\nb\u{7f} 'c'"), "räder\\u{0} a\\r\\nb\\u{7f} 'c'");
    }
}
