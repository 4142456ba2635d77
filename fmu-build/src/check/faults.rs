//! All faults of a definition with their places, however many stop the reader.
//!
//! In: a definition's text. Out: findings with their places. The reader stops at the first key that it cannot read.
//! That key is blanked out in a copy of the text, in which all others keep their places, and the copy is read again.

use super::spans::{Tree, line_and_column};
use anyhow::Result;
use jsonc_parser::errors::{ParseError, ParseErrorKind};
use jsonc_parser::{CollectOptions, ParseOptions, parse_to_ast};
use linkage_fmu::component::Component;
use linkage_fmu::inspection::{Finding, Inspection, Severity};
use std::ops::Range;

/// Most faults of the form that are looked for.
const MOST: usize = 100;

/// A finding with its place in the text.
#[derive(Clone, Debug)]
pub struct Located {
    /// The finding.
    pub finding: Finding,
    /// Range of bytes that is underlined; empty for the whole file.
    pub span: Range<usize>,
    /// Line and column of its beginning, from 1.
    pub position: [usize; 2],
}

/// What was found in a text.
pub struct All {
    /// Facts; findings are below.
    pub inspection: Inspection,
    /// Errors first, each by its place.
    pub located: Vec<Located>,
    /// Whether names and numbers were checked too.
    pub is_whole: bool,
}

/// All that is found in a text.
///
/// # Errors
/// There is no such kind of definition.
pub fn all(kind: &str, text: &str) -> Result<All> {
    let mut located = Vec::new();
    let mut repaired = text.to_owned();
    // An editor's byte order mark is no part of JSON.
    if repaired.starts_with('\u{feff}') {
        repaired.replace_range(..3, "   ");
    }
    repair_syntax(&mut repaired, &mut located);
    let mut removed: Vec<String> = Vec::new();
    let mut only_unknown = true;
    let mut inspection = Component::inspect(kind, &repaired)?;
    while !inspection.is_readable && located.len() < MOST {
        let Some(finding) = inspection.findings.pop() else { break };
        let tree = Tree::new(&repaired);
        let Some(place) = tree.find(&finding.path).filter(|place| !place.path.is_empty()) else {
            let follows = removed.iter().any(|path| !path.contains('.') && names(&finding.message, path));
            if !(follows && is_missing(&finding)) {
                located.push(at(text, finding, 0..0));
            }
            break;
        };
        // A key that is missing where one was taken out was there before.
        let own = |path: &String| {
            let parts = path.rsplit_once('.');
            parts.is_some_and(|(parent, key)| parent == place.path && names(&finding.message, key))
        };
        let is_unknown = finding.message.contains("unknown field");
        only_unknown &= is_unknown;
        if !(is_missing(&finding) && removed.iter().any(own)) {
            let stands_twice = finding.message.contains("stands twice");
            let span = if is_unknown || stands_twice { place.key.clone() } else { place.shown.clone() };
            located.push(at(text, finding, span));
        }
        let range = tree.removal(&place);
        drop(tree);
        blank(&mut repaired, range);
        removed.push(place.path);
        inspection = Component::inspect(kind, &repaired)?;
    }
    let is_whole = inspection.is_readable && only_unknown;
    if is_whole {
        let tree = Tree::new(&repaired);
        for finding in inspection.findings.drain(..) {
            let place = tree.find(&finding.path);
            let span = place.filter(|place| !place.path.is_empty()).map_or(0..0, |place| place.shown);
            located.push(at(text, finding, span));
        }
    }
    if located.iter().any(|located| located.finding.severity == Severity::Error) && !removed.is_empty() {
        inspection.facts.clear();
    }
    inspection.findings.clear();
    located.sort_by_key(|located| (located.finding.severity != Severity::Error, located.span.start));
    Ok(All { inspection, located, is_whole })
}

fn at(text: &str, mut finding: Finding, span: Range<usize>) -> Located {
    // The reader's own place is that in the repaired copy, and no better than the one that is shown.
    if let Some(end) = finding.message.rfind(" at line ").filter(|_| !span.is_empty()) {
        let after = finding.message[end..].find(';').map_or("", |rest| &finding.message[end + rest..]);
        finding.message = format!("{}{after}", &finding.message[..end]);
    }
    Located { position: line_and_column(text, span.start), finding, span }
}

fn is_missing(finding: &Finding) -> bool {
    finding.message.contains("missing field")
}

fn names(message: &str, key: &str) -> bool {
    message.contains(&format!("`{key}`"))
}

/// Overwrite a range with spaces; line breaks stay.
fn blank(text: &mut String, range: Range<usize>) {
    let spaces: String = text[range.clone()]
        .chars()
        .flat_map(|c| std::iter::repeat_n(if matches!(c, '\n' | '\r') { c } else { ' ' }, c.len_utf8()))
        .collect();
    text.replace_range(range, &spaces);
}

/// Find what is no JSON, and write over it what is, so that the rest of the text can be read in its place.
fn repair_syntax(text: &mut String, located: &mut Vec<Located>) {
    let strict = ParseOptions {
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
    while located.len() < MOST {
        let Err(error) = parse_to_ast(text, &CollectOptions::default(), &strict).map(drop) else { return };
        let Some((message, span, replacement)) = cure(text, &error) else {
            // The engine says it in its own words.
            return;
        };
        let path = String::new();
        let finding = Finding { severity: Severity::Error, path, message: message.to_owned(), remedy: String::new() };
        located.push(at(text, finding, span.clone()));
        match replacement {
            Some(replacement) => text.replace_range(span, &replacement),
            None => blank(text, span),
        }
    }
}

/// Message, range and replacement of the same length for an error of the syntax that has a cure; none blanks it out.
fn cure(text: &str, error: &ParseError) -> Option<(&'static str, Range<usize>, Option<String>)> {
    let (start, end) = (error.range().start, error.range().end);
    let rest = &text[start..];
    if let Some(comma) = decimal_comma(text, start) {
        let message = "a decimal comma: JSON writes decimals with a point, such as 0.5; put a point in its place";
        return Some((message, comma..comma + 1, Some(".".into())));
    }
    match error.kind() {
        ParseErrorKind::CommentsNotAllowed => {
            let length = match rest.strip_prefix("/*") {
                Some(inner) => inner.find("*/").map_or(rest.len(), |at| at + 4),
                None => rest.find('\n').unwrap_or(rest.len()),
            };
            let message = "a comment: JSON has none; remove it, or say it in description";
            Some((message, start..start + length, None))
        }
        ParseErrorKind::NonFiniteNumbersNotAllowed | ParseErrorKind::UnexpectedWord => {
            let length = rest.find(|c: char| !(c.is_alphanumeric() || "+-_.".contains(c))).unwrap_or(rest.len());
            let word = rest[..length].trim_start_matches(['+', '-']).to_ascii_lowercase();
            let message = match word.as_str() {
                "nan" | "inf" | "infinity" => {
                    "no number: numbers are finite in JSON; give a number, or leave the key out"
                }
                "true" | "false" | "null" => "in JSON this word is written in small letters: true, false, null",
                "none" => "no word of JSON: leave the key out if it has no value",
                _ => return None,
            };
            let number = ["nan", "inf", "infinity", "none"].contains(&word.as_str());
            let padded = if number { format!("{:<length$}", "0") } else { format!("{word:<length$}") };
            Some((message, start..start + length, Some(padded)))
        }
        ParseErrorKind::TrailingCommasNotAllowed => {
            Some(("a comma before the closing bracket: nothing follows it; remove it", start..end, None))
        }
        ParseErrorKind::UnaryPlusNumbersNotAllowed => {
            Some(("JSON writes positive numbers without a plus; remove it", start..start + 1, None))
        }
        _ => None,
    }
}

/// The comma before this place if it stands between two digits, inside a member of an object.
fn decimal_comma(text: &str, at: usize) -> Option<usize> {
    let bytes = text.as_bytes();
    let comma = [at.checked_sub(1)?, at].into_iter().find(|&at| bytes.get(at) == Some(&b','))?;
    let is_digit = |at: Option<usize>| at.and_then(|at| bytes.get(at)).is_some_and(u8::is_ascii_digit);
    (is_digit(comma.checked_sub(1)) && is_digit(Some(comma + 1))).then_some(comma)
}
