//! All faults of a definition with their places, however many stop the reader.
//!
//! In: a definition's text. Out: findings with their places. The reader stops at the first key that it cannot read.
//! That key is blanked out in a copy of the text, in which all others keep their places, and the copy is read again.

use super::spans::{Tree, byte_of, line_and_column};
use super::syntax::{overwrite, repair};
use super::units::FileUnits;
use crate::names;
use anyhow::Result;
use linkage_fmu::component::Component;
use linkage_fmu::inspection::{Finding, Inspection, Severity};
use std::ops::Range;

/// Key of the file of shared parameters, and path of its contents once they stand in its place.
const SHARED: &str = "parameters_from";
const SHARED_CONTENTS: &str = "parameters_from.contents";

/// Most faults of the form that are looked for.
pub const MOST: usize = 100;

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
    let form = repair(&mut repaired, &mut located);
    let mut removed: Vec<String> = Vec::new();
    let mut only_unknown = true;
    let mut inspection =
        if form.is_json || located.is_empty() { Component::inspect(kind, &repaired)? } else { Inspection::default() };
    while !inspection.is_readable && located.len() < MOST {
        let Some(finding) = inspection.findings.pop() else { break };
        let tree = Tree::new(&repaired);
        let path = told_twice(&finding).map_or(finding.path.clone(), |key| format!("{}.{key}", finding.path));
        let Some(place) = tree.find(path.trim_start_matches('.')).filter(|place| !place.path.is_empty()) else {
            let follows = removed.iter().any(|path| !path.contains('.') && names(&finding.message, path));
            if !(follows && is_missing(&finding)) {
                let missing =
                    tree.find("").filter(|_| is_missing(&finding)).map(|_| placeholder(kind, &repaired, &finding));
                drop(tree);
                // A key that is missing at the top is missing in the whole.
                let named = if is_missing(&finding) { "" } else { finding.message.as_str() };
                let span = of_message(text, named);
                located.push(at(text, finding, span));
                if let Some(Some(more)) = missing {
                    repaired = more;
                    removed.push(String::new());
                    only_unknown = false;
                    inspection = Component::inspect(kind, &repaired)?;
                    continue;
                }
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
        let follows = (is_missing(&finding) && removed.iter().any(own)) || reads_removed(&finding, &removed);
        // What stands behind the text was put there.
        if !follows && place.shown.end <= text.len() {
            let stands_twice = finding.message.contains("stands twice") || told_twice(&finding).is_some();
            let span = if is_unknown || stands_twice { place.key.clone() } else { place.shown.clone() };
            located.push(at(text, finding, span));
        }
        let range = tree.removal(&place);
        drop(tree);
        overwrite(&mut repaired, range, "");
        removed.push(place.path);
        inspection = Component::inspect(kind, &repaired)?;
    }
    let is_whole = inspection.is_readable && only_unknown;
    // Facts of a text that was repaired are those of another model.
    let is_repaired = !located.is_empty();
    if is_whole {
        let tree = Tree::new(&repaired);
        let units = FileUnits::of(&repaired);
        inspection.findings.extend(of_name(&inspection.name));
        for finding in inspection.findings.drain(..) {
            let place = tree.find(&finding.path).filter(|place| !place.path.is_empty() || !finding.path.is_empty());
            let span = place.map_or(0..0, |place| place.shown);
            // A value that was written over is at fault once, and the motion that follows from it is none of the file's.
            let follows = span.is_empty() && !form.places.is_empty();
            if !follows && !form.places.iter().any(|place| place.start < span.end && span.start < place.end) {
                located.push(at(text, units.told(finding), span));
            }
        }
    }
    if is_repaired && located.iter().any(|located| located.finding.severity == Severity::Error) {
        inspection.facts.clear();
    }
    inspection.findings.clear();
    located.sort_by_key(|located| (located.finding.severity != Severity::Error, located.span.start));
    Ok(All { inspection, located, is_whole })
}

/// A model whose name no FMU can have, as it names files in it.
fn of_name(name: &str) -> Option<Finding> {
    let refused = names::check(name).err().filter(|_| !name.is_empty())?;
    let refused = refused.to_string();
    let reason = refused.strip_prefix(name).unwrap_or(&refused);
    Some(Finding::error("name", format_args!("name = \"{name}\"{reason}")))
}

/// Whether an expression reads a parameter that is missing only because its own fault took it out of the copy.
fn reads_removed(finding: &Finding, removed: &[String]) -> bool {
    let Some((_, name)) = finding.message.split_once("no parameter of the file is called ") else { return false };
    // Without its file none of the shared parameters is known.
    if removed.iter().any(|path| path == SHARED || path == SHARED_CONTENTS) {
        return true;
    }
    // A parameter has the path of its key without the group that the key stands in.
    let own = |path| shared_path(path).unwrap_or(path);
    let mut parameters = removed.iter().filter_map(|path| own(path).split_once('.'));
    parameters.any(|(_, parameter)| name.strip_prefix(parameter).is_some_and(|rest| rest.starts_with(':')))
}

/// Path of a key of the shared parameters in their file; None of any other key.
fn shared_path(path: &str) -> Option<&str> {
    path.strip_prefix(SHARED_CONTENTS)?.strip_prefix('.')
}

/// A finding about a key of the shared parameters, as their reader tells it: at the key that names their file, with the
/// path in this file.
fn of_shared(text: &str, finding: &mut Finding, span: &mut Range<usize>) {
    let Some(path) = shared_path(&finding.path) else { return };
    let tree = Tree::new(text);
    let named = tree.find(&format!("{SHARED}.file")).and_then(|place| text.get(place.whole));
    let file = named.and_then(|file| serde_json::from_str::<String>(file.split_once(':')?.1.trim()).ok());
    let (Some(file), Some(place)) = (file, tree.find(SHARED)) else { return };
    let rest = finding.message.strip_prefix(finding.path.as_str()).unwrap_or(&finding.message);
    let rest = rest.strip_suffix(&format!(" (in {file})")).unwrap_or(rest);
    finding.message = format!("{SHARED}: {file}: {path}{rest}");
    (finding.path, *span) = (SHARED.to_owned(), place.key);
}

/// The key of an object that the reader found twice.
fn told_twice(finding: &Finding) -> Option<String> {
    let (_, rest) = finding.message.split_once("duplicate field `")?;
    rest.split_once('`').map(|(key, _)| key.to_owned())
}

/// The text with the key that this finding misses at its top, so that the next missing key is found too; none if no
/// value of the key lets the reader come further.
fn placeholder(kind: &str, text: &str, finding: &Finding) -> Option<String> {
    let (_, rest) = finding.message.split_once("missing field `")?;
    let (key, _) = rest.split_once('`')?;
    let (before, after) = text.rsplit_once('}')?;
    let comma = if before.trim_end().ends_with('{') { "" } else { "," };
    ["{}", "\"m\""].into_iter().map(|value| format!("{before}{comma}\"{key}\":{value}}}{after}")).find(|longer| {
        let read = Component::inspect(kind, longer);
        read.is_ok_and(|read| read.findings.iter().all(|next| next.path != key && next.message != finding.message))
    })
}

/// The character at the line and column that the reader's message ends with; the first of the text if it names none.
fn of_message(text: &str, message: &str) -> Range<usize> {
    let numbers = message.rsplit_once(" at line ").and_then(|(_, rest)| {
        let (line, rest) = rest.split_once(" column ")?;
        let column = rest.split(|c: char| !c.is_ascii_digit()).next()?;
        Some((line.parse().ok()?, column.parse().ok()?))
    });
    let start = numbers.map_or(0, |(line, column)| byte_of(text, line, column));
    let start = if is_blank_at(text, start) { text.find(|c: char| !c.is_whitespace()).unwrap_or(0) } else { start };
    start..start + text[start..].chars().next().map_or(0, char::len_utf8)
}

fn is_blank_at(text: &str, at: usize) -> bool {
    text[at..].chars().next().is_none_or(char::is_whitespace)
}

/// A finding about this range of the text.
pub fn at(text: &str, mut finding: Finding, mut span: Range<usize>) -> Located {
    of_shared(text, &mut finding, &mut span);
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A block whose mass is the shared parameter `load`, with this file of shared parameters.
    fn told_of_shared(from: &str) -> Vec<String> {
        let text = format!(
            r#"{{ "name": "A", "parameters_from": {from}, "bodies": {{ "ground": {{}}, "block": {{ "mass": "load" }} }},
            "joints": {{ "rail": {{ "type": "prismatic", "first": "ground.origin", "second": "block.origin" }} }},
            "start": {{ "joint": "rail", "position": 0 }}, "guess": {{ "rail": 0 }} }}"#
        );
        let all = all("mechanism.json", &text).unwrap();
        let shown = |one: &Located| format!("{} at {}", one.finding.message, &text[one.span.clone()]);
        all.located.iter().map(shown).collect()
    }

    /// The path is that in the file of the parameters, and what reads one at fault has no fault of its own.
    #[test]
    fn a_fault_of_a_shared_parameter_is_told_once_by_its_own_file() {
        let with = |parameters: &str| {
            told_of_shared(&format!(r#"{{ "file": "c.json", "contents": {{ "parameters": {parameters} }} }}"#))
        };
        for (parameters, said) in [
            (r#"{ "load": "x +" }"#, "load: \"x +\": it ends before its last value"),
            (r#"{ "load": "2 * y", "z": 3 }"#, "load: \"2 * y\": no parameter of the file is called y"),
            (r#"{ "load": "other", "other": "load" }"#, "load: \"other\": load reads other reads load is a circle"),
        ] {
            let told = with(parameters);
            let [one] = &told[..] else { panic!("{told:#?}") };
            assert!(one.starts_with(&format!("parameters_from: c.json: parameters.{said}")), "{one}");
            assert!(one.ends_with(" at \"parameters_from\"") && !one.contains("(in c.json)"), "{one}");
        }
        let told = told_of_shared("[1]");
        assert!(told.len() == 1 && told[0].starts_with("parameters_from: invalid type: a list"), "{told:#?}");
    }

    /// An expression that reads a parameter at fault has no fault of its own.
    #[test]
    fn a_circle_is_told_once() {
        let text = r#"{ "name": "A", "parameters": { "a": "b", "b": "a + c", "c": 2, "d": "f" },
            "bodies": { "ground": {}, "rod": { "length": "a", "mass": "b" } },
            "joints": { "j": { "type": "revolute", "first": "ground.origin", "second": "rod.origin" } },
            "start": { "body": "rod", "angle": 0 }, "guess": { "rod": 0 } }"#;
        let told: Vec<String> =
            all("mechanism.json", text).unwrap().located.iter().map(|one| one.finding.to_string()).collect();
        assert_eq!(told.len(), 2, "{told:#?}");
        assert!(told.iter().any(|one| one.contains("is a circle")), "{told:#?}");
        assert!(told.iter().any(|one| one.contains("is called f:")), "{told:#?}");
    }
}
