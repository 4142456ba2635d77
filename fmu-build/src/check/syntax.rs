//! Faults of the JSON syntax of a text: each fault with its place and its remedy.
//!
//! In: a text. Out: findings, and the same text with each fault overwritten without moving the rest, so that the rest
//! can be read. The module must not know what the keys mean.

use super::located::{Located, MOST, at};
use jsonc_parser::errors::{ParseError, ParseErrorKind};
use jsonc_parser::{CollectOptions, ParseOptions, parse_to_ast};
use linkage_fmu::inspection::Finding;
use linkage_fmu::numerics::decimal::Decimal;
use linkage_fmu::variables::Unit;
use std::f64::consts::PI;
use std::ops::Range;

/// Options for strict JSON.
const STRICT: ParseOptions = ParseOptions {
    allow_comments: false,
    allow_loose_object_property_names: false,
    allow_trailing_commas: false,
    allow_missing_commas: false,
    allow_single_quoted_strings: false,
    allow_hexadecimal_numbers: false,
    allow_unary_plus_numbers: false,
    allow_bare_decimal_point_numbers: false,
    allow_non_finite_numbers: false,
    allow_extended_string_escapes: false,
};

/// A fault of the syntax.
struct Fault {
    message: String,
    /// Range of bytes that is underlined.
    shown: Range<usize>,
    /// Range to overwrite and replacement of the same length with which the rest can be read. None if there is no safe
    /// replacement.
    cure: Option<(Range<usize>, String)>,
}

impl Fault {
    fn new(message: impl Into<String>, shown: Range<usize>) -> Self {
        Self { message: message.into(), shown, cure: None }
    }

    /// The fault, with its range overwritten by this text and blanks.
    fn written(mut self, text: &str) -> Self {
        let length = self.shown.len();
        self.cure = (text.len() <= length).then(|| (self.shown.clone(), format!("{text:<length$}")));
        self
    }

    /// The fault, with the blank before it replaced by a character, if there is a blank.
    fn preceded(mut self, text: &str, by: char) -> Self {
        let start = self.shown.start;
        let is_blank = text[..start].ends_with([' ', '\t', '\n', '\r']);
        self.cure = is_blank.then(|| (start - 1..start, by.to_string()));
        self
    }
}

/// Ranges of bytes that were written over.
pub struct Repaired {
    /// Each place.
    pub places: Vec<Range<usize>>,
    /// Whether the text is JSON now.
    pub is_json: bool,
}

/// Find the faults of the JSON syntax, and overwrite them.
pub fn repair(text: &mut String, located: &mut Vec<Located>) -> Repaired {
    let mut places = Vec::new();
    while located.len() < MOST {
        let Err(error) = parse_to_ast(text, &CollectOptions::default(), &STRICT).map(drop) else {
            return Repaired { places, is_json: true };
        };
        // Faults without a text here get the engine's message.
        let Some(Fault { message, shown, cure }) = fault(text, &error) else { break };
        located.push(at(text, None, Finding::error("", message), shown.clone()));
        let Some((range, replacement)) = cure else { break };
        overwrite(text, range, &replacement);
        places.push(shown);
    }
    Repaired { places, is_json: false }
}

/// Overwrite a range. Line breaks remain, and the part beyond the replacement becomes blank.
pub fn overwrite(text: &mut String, range: Range<usize>, replacement: &str) {
    let blank = replacement.trim().is_empty();
    let written: String = match blank {
        false => replacement.to_owned(),
        true => text[range.clone()]
            .chars()
            .flat_map(|c| std::iter::repeat_n(if matches!(c, '\n' | '\r') { c } else { ' ' }, c.len_utf8()))
            .collect(),
    };
    text.replace_range(range, &written);
}

/// The fault at which the parser stopped.
fn fault(text: &str, error: &ParseError) -> Option<Fault> {
    let (start, end) = (error.range().start, error.range().end);
    let rest = &text[start..];
    if let Some(comma) = decimal_comma(text, start) {
        let number = number_at(text, comma);
        let fault = fmu_cli::words::comma(&text[number.clone()]).map(|fault| format!("{} {fault}", &text[number]));
        let message = fault.unwrap_or_else(|| "a decimal comma: write a point, such as 0.5".to_owned());
        return Some(Fault::new(message, comma..comma + 1).written("."));
    }
    if let Some(open) = open_text(text) {
        let message = "a text has no closing quote: add a quote \" at the end of the text, on the same line";
        return Some(Fault::new(message, open));
    }
    let first = rest.chars().next();
    let one = start..start + first.map_or(0, char::len_utf8);
    Some(match error.kind() {
        ParseErrorKind::CommentsNotAllowed => {
            let length = match rest.strip_prefix("/*") {
                Some(inner) => inner.find("*/").map_or(rest.len(), |at| at + 4),
                None => rest.find('\n').unwrap_or(rest.len()),
            };
            let message = "JSON has no comments: remove the comment, or move the text into description";
            Fault::new(message, start..start + length).written("")
        }
        ParseErrorKind::TrailingCommasNotAllowed => {
            Fault::new("a comma stands before the closing bracket: remove the comma", start..end).written("")
        }
        ParseErrorKind::UnaryPlusNumbersNotAllowed => {
            Fault::new("JSON has no plus sign before a number: remove the plus", start..start + 1).written("")
        }
        ParseErrorKind::SingleQuotedStringsNotAllowed => {
            let length = rest[1..].find(['\'', '\n']).map_or(rest.len(), |at| at + 2);
            let inner = rest[1..length].trim_end_matches(['\'', '\n', '\r']);
            let text = format!("\"{inner}\"");
            let is_closed = rest[..length].ends_with('\'') && !inner.contains(['"', '\\']);
            let fault = Fault::new(format!("JSON has texts in double quotes: write {text}"), start..start + length);
            if is_closed { fault.written(&text) } else { fault }
        }
        ParseErrorKind::UnterminatedObject | ParseErrorKind::UnterminatedArray => {
            let (open, bracket) = open_brackets(text).pop()?;
            let close = if bracket == '{' { '}' } else { ']' };
            Fault::new(format!("this `{bracket}` has no closing bracket: add `{close}`"), open..open + 1)
        }
        _ if matches!(first, Some('}' | ']')) => {
            Fault::new("a surplus or wrong closing bracket: remove or correct this bracket", one).written("")
        }
        ParseErrorKind::MultipleRootJsonValues => Fault::new(
            "the definition ends before this place: remove the text after the end, or a surplus closing bracket before \
             this place",
            one,
        )
        .blanked_to(text.len()),
        _ if first == Some('=') => {
            Fault::new("JSON has a colon between key and value: write : instead of =", one).written(":")
        }
        _ => {
            return after_number(text, start)
                .or_else(|| word(text, start))
                .or_else(|| missing(text, error.kind(), start));
        }
    })
}

impl Fault {
    /// The fault, with the text from its start up to this byte replaced by blanks.
    fn blanked_to(mut self, end: usize) -> Self {
        self.cure = Some((self.shown.start..end, String::new()));
        self
    }
}

/// A missing comma or colon before the next token from here on.
fn missing(text: &str, kind: &ParseErrorKind, start: usize) -> Option<Fault> {
    let place = token(text, text.len() - text[start..].trim_start().len());
    match kind {
        ParseErrorKind::ExpectedComma => {
            // A bracket may be missing too. A comma would then put the rest into the wrong object.
            match open_brackets(text).is_empty() {
                true => {
                    Some(Fault::new("a comma is missing before this place: add a comma", place).preceded(text, ','))
                }
                false => Some(Fault::new(
                    "a closing bracket is missing before this place: add the bracket and a comma",
                    place,
                )),
            }
        }
        ParseErrorKind::ExpectedColonAfterObjectKey => {
            Some(Fault::new("a colon is missing before this place: add a colon", place).preceded(text, ':'))
        }
        _ => None,
    }
}

/// A text in quotes, or a single character, that starts here.
fn token(text: &str, start: usize) -> Range<usize> {
    let rest = &text[start..];
    let length = match rest.strip_prefix('"').and_then(|inner| inner.find('"')) {
        Some(at) => at + 2,
        None => rest.find(ends_word).filter(|length| *length > 0).unwrap_or(1),
    };
    start..start + length
}

fn ends_word(c: char) -> bool {
    c.is_whitespace() || ",:{}[]\"'=".contains(c)
}

/// Quotes of a text processor.
const CURLY: [char; 5] = ['\u{201c}', '\u{201d}', '\u{201e}', '\u{ab}', '\u{bb}'];

/// A text in quotes of a text processor. `length`: length of its first word.
fn curly(text: &str, start: usize, length: usize) -> Option<Fault> {
    let line = text[start..].lines().next()?;
    let rest = line.strip_prefix(CURLY).unwrap_or_default();
    let close = rest.char_indices().find(|(_, c)| CURLY.contains(c));
    let length = close.map_or(length, |(at, c)| line.len() - rest.len() + at + c.len_utf8());
    let inner = line[..length].trim_matches(CURLY);
    let fault =
        Fault::new(format!("JSON has texts in straight double quotes: write \"{inner}\""), start..start + length);
    Some(if inner.contains(['"', '\\']) { fault } else { fault.written(&format!("\"{inner}\"")) })
}

/// A word without quotes at this place that is no value of JSON.
fn word(text: &str, at: usize) -> Option<Fault> {
    let start = text[..at].char_indices().rev().take_while(|(_, c)| !ends_word(*c)).last().map_or(at, |(k, _)| k);
    let length = text[start..].find(ends_word).unwrap_or(text.len() - start);
    let place = start..start + length;
    let word = &text[place.clone()];
    if word.contains(CURLY) {
        return curly(text, start, length);
    }
    if word.is_empty() || serde_json::from_str::<serde_json::Value>(word).is_ok() {
        return None;
    }
    let bare = word.trim_start_matches(['+', '-']).to_ascii_lowercase();
    if text[place.end..].trim_start().starts_with(':') {
        let message = format!("JSON has keys in double quotes: write \"{word}\"");
        let blanks = text[..start].ends_with("  ");
        let cure = blanks.then(|| (start - 2..place.end, format!("\"{word}\"")));
        return Some(Fault { message, shown: place, cure });
    }
    match bare.as_str() {
        "nan" | "inf" | "infinity" => {
            let message = "JSON has finite numbers only: write a number, or leave the key out";
            return Some(Fault::new(message, place).written("0"));
        }
        "true" | "false" | "null" => {
            let message = "JSON has these words in small letters: true, false, null";
            return Some(Fault::new(message, place).written(&bare));
        }
        "none" => {
            let message = "JSON does not have this word: leave the key out if the key has no value";
            return Some(Fault::new(message, place).written("0"));
        }
        _ => {}
    }
    if let Some(value) = formula(word) {
        let is_number = word.parse::<f64>().is_ok();
        let what = if is_number { "write this number as" } else { "JSON allows no formula here; write the number" };
        let message = format!("`{word}`: {what} {}", Decimal::rounded(value));
        let fits = (0..=17).rev().map(|digits| format!("{value:.digits$}")).find(|text| text.len() <= length);
        return Some(Fault::new(message, place).written(&fits.unwrap_or_else(|| "1".into())));
    }
    let digits = word.find(|c: char| !(c.is_ascii_digit() || "+-.".contains(c))).unwrap_or(length);
    let message = match word[..digits].parse::<f64>() {
        Ok(value) => with_unit(word, value, &word[digits..]),
        Err(_) => format!("`{word}` is not a JSON value: write texts in double quotes, and numbers with digits"),
    };
    Some(Fault::new(message, place).written("1"))
}

/// Message about a number with a unit. The quantity of the key is not known here.
fn with_unit(word: &str, value: f64, unit: &str) -> String {
    let Some((own, si)) = Unit::of_quantity(value, unit) else {
        return format!(
            "`{word}` is not a number: write a number without a unit; lengths are in m and angles in rad, unless the \
             key \"units\" states other units"
        );
    };
    let other = match own {
        Unit::Metre => format!(", or {} if the key \"units\" states mm", Decimal::rounded(1e3 * si)),
        Unit::Radian => format!(", or {} if the key \"units\" states deg", Decimal::rounded(si.to_degrees())),
        _ => String::new(),
    };
    format!("`{word}` is not a number: write {} (in {}), without a unit{other}", Decimal::rounded(si), own.name())
}

/// A word or a number at this place after a number and blanks: a unit, or the next group of digits.
fn after_number(text: &str, at: usize) -> Option<Fault> {
    let at = text.len() - text[at..].trim_start_matches(' ').len();
    let before = text[..at].trim_end_matches(' ');
    let from = before.len() - before.bytes().rev().take_while(|byte| is_of_number(*byte)).count();
    let value: f64 = before[from..].parse().ok()?;
    let mut end = at + text[at..].find(ends_word).unwrap_or(text.len() - at);
    if before.len() == at || end == at || text[end..].trim_start().starts_with(':') {
        return None;
    }
    let group = |word: &str| word.len() == 3 && word.bytes().all(|byte| byte.is_ascii_digit());
    if text[at..].starts_with(|c: char| c.is_ascii_digit()) {
        // In a list, a comma between two numbers is missing.
        let is_in_list = open_brackets(&text[..at]).last().is_some_and(|(_, bracket)| *bracket == '[');
        if is_in_list || !group(&text[at..end]) {
            return None;
        }
        while text[end..].starts_with(' ') && text.get(end + 1..end + 4).is_some_and(group) {
            end += 4;
        }
        let number = text[from..end].replace(' ', "");
        let message = format!("`{}` is not a number: write {number}, without blanks", &text[from..end]);
        return Some(Fault::new(message, from..end).written(&number));
    }
    let is_unit = text[at..].starts_with(|c: char| c.is_alphabetic() || "%\u{b0}".contains(c));
    is_unit.then(|| Fault::new(with_unit(&text[from..end], value, &text[at..end]), from..end).written("1"))
}

fn is_of_number(byte: u8) -> bool {
    byte.is_ascii_digit() || b"+-.,eE".contains(&byte)
}

/// Range of the number that contains this place, with its commas.
fn number_at(text: &str, at: usize) -> Range<usize> {
    let count = |bytes: &mut dyn Iterator<Item = u8>| bytes.take_while(|byte| is_of_number(*byte)).count();
    let [start, end] = [at - count(&mut text[..at].bytes().rev()), at + count(&mut text[at..].bytes())];
    start..start + text[start..end].trim_end_matches(',').len()
}

/// The value of a product or quotient of numbers and pi, such as `-3*pi/4`, or of one number.
fn formula(word: &str) -> Option<f64> {
    let (mut value, mut rest, mut divides) = (1.0, word, false);
    loop {
        let (factor, after) = match rest.find(['*', '/']) {
            Some(at) => (&rest[..at], Some((at, &rest[at + 1..]))),
            None => (rest, None),
        };
        let (sign, name) = factor.strip_prefix('-').map_or((1.0, factor), |name| (-1.0, name));
        let name = name.strip_prefix("math.").or_else(|| name.strip_prefix("np.")).unwrap_or(name);
        let is_digits = name.starts_with(|c: char| c.is_ascii_digit() || c == '.');
        let number = match name {
            "pi" | "Pi" | "PI" | "\u{3c0}" => PI,
            _ if is_digits => name.parse().ok()?,
            _ => return None,
        };
        let number: f64 = sign * number;
        value = if divides { value / number } else { value * number };
        let Some((at, next)) = after else { break };
        (divides, rest) = (rest.as_bytes()[at] == b'/', next);
    }
    Some(value).filter(|value| value.is_finite())
}

/// The first text without a closing quote on its line: from its quote to the end of the line.
fn open_text(text: &str) -> Option<Range<usize>> {
    let mut from = None;
    let mut is_escaped = false;
    for (at, c) in text.char_indices() {
        match (from, c) {
            (None, '"') => from = Some(at),
            (Some(start), '\n') => return Some(start..at - usize::from(text[..at].ends_with('\r'))),
            (Some(_), '"') if !is_escaped => from = None,
            _ => {}
        }
        is_escaped = c == '\\' && !is_escaped && from.is_some();
    }
    from.map(|start| start..text.len())
}

/// Brackets outside of texts that are not closed.
fn open_brackets(text: &str) -> Vec<(usize, char)> {
    let (mut open, mut is_text, mut is_escaped) = (Vec::new(), false, false);
    for (at, c) in text.char_indices() {
        match c {
            '"' if !is_escaped => is_text = !is_text,
            '{' | '[' if !is_text => open.push((at, c)),
            '}' | ']' if !is_text => drop(open.pop()),
            _ => {}
        }
        is_escaped = is_text && c == '\\' && !is_escaped;
    }
    open
}

/// The comma before this place if it is between two digits in a member of an object.
fn decimal_comma(text: &str, at: usize) -> Option<usize> {
    let bytes = text.as_bytes();
    let comma = [at.checked_sub(1)?, at].into_iter().find(|&at| bytes.get(at) == Some(&b','))?;
    let is_digit = |at: Option<usize>| at.and_then(|at| bytes.get(at)).is_some_and(u8::is_ascii_digit);
    (is_digit(comma.checked_sub(1)) && is_digit(Some(comma + 1))).then_some(comma)
}
