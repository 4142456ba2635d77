//! All faults of a definition with their places.
//!
//! In: the text of a definition. Out: findings with their places. Faults of JSON syntax are overwritten in a copy of
//! the text without moving the rest, so that the rest can be read too.

use super::located::{Located, MOST, at};
use super::spans::find;
use super::syntax::repair;
use super::units::FileUnits;
use crate::names;
use anyhow::Result;
use linkage_fmu::component::Component;
use linkage_fmu::format::parse;
use linkage_fmu::inspection::{Finding, Inspection, Severity};
use std::ops::Range;

/// Range of a fault. For a fault after the last character, the range of the last character.
fn visible(text: &str, span: Range<usize>) -> Range<usize> {
    let end = span.end.min(text.len());
    let last = text[..end].char_indices().next_back().filter(|_| span.is_empty());
    last.map_or(span, |(start, _)| start..end)
}

/// Results of the inspection of a text.
pub struct All {
    /// Facts; findings are below.
    pub inspection: Inspection,
    /// Errors first, each group sorted by place.
    pub located: Vec<Located>,
    /// Whether names and numbers were checked too.
    pub is_whole: bool,
    /// Units of the file.
    pub units: FileUnits,
}

/// Inspect a text.
///
/// # Errors
/// There is no such kind of definition.
pub fn all(kind: &str, text: &str) -> Result<All> {
    let mut located = Vec::new();
    let mut repaired = text.to_owned();
    // A byte order mark of an editor is not part of the JSON.
    if repaired.starts_with('\u{feff}') {
        repaired.replace_range(..3, "   ");
    }
    let form = repair(&mut repaired, &mut located);
    let mut inspection =
        if form.is_json || located.is_empty() { Component::inspect(kind, &repaired)? } else { Inspection::default() };
    let is_whole = inspection.is_readable;
    if is_whole {
        inspection.findings.extend(of_name(&inspection.name));
    }
    // If a text was repaired, or a part of it was not read, its facts would describe another model.
    let is_other = !located.is_empty() || inspection.findings.iter().any(|finding| finding.bytes.is_some());
    let root = parse(kind, &repaired).ok();
    let units = FileUnits::stated(root.as_ref());
    let is_one_line = |bytes: &Range<usize>| !repaired[bytes.clone()].contains('\n');
    for finding in inspection.findings.drain(..) {
        let by_path = || {
            let place = root.as_ref().map(|root| find(&repaired, root, &finding.path));
            place.filter(|place| !place.path.is_empty() || !finding.path.is_empty()).map_or(0..0, |place| place.shown)
        };
        let span =
            finding.bytes.clone().filter(is_one_line).map(|span| visible(&repaired, span)).unwrap_or_else(by_path);
        // An overwritten value has one fault. Faults that follow from it are not faults of the file.
        let follows = span.is_empty() && !form.places.is_empty();
        if !follows && !form.places.iter().any(|place| place.start < span.end && span.start < place.end) {
            located.push(at(text, root.as_ref(), units.converted(finding), span));
        }
    }
    if is_other && located.iter().any(|located| located.finding.severity == Severity::Error) {
        inspection.facts.clear();
    }
    located.sort_by_key(|located| (located.finding.severity != Severity::Error, located.span.start));
    located.truncate(MOST);
    Ok(All { inspection, located, is_whole, units })
}

/// A finding about a model name that cannot be the name of a file.
fn of_name(name: &str) -> Option<Finding> {
    let refused = names::check(name).err().filter(|_| !name.is_empty())?;
    let refused = refused.to_string();
    let reason = refused.strip_prefix(name).unwrap_or(&refused);
    Some(Finding::error("name", format_args!("name = \"{name}\"{reason}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A block whose mass is the shared parameter `load`, with this file of shared parameters.
    fn findings_of_shared(from: &str) -> Vec<String> {
        let text = format!(
            r#"{{ "name": "A", "parameters_from": {from}, "bodies": {{ "ground": {{}}, "block": {{ "mass": "load" }} }},
            "joints": {{ "rail": {{ "type": "prismatic", "first": "ground.origin", "second": "block.origin" }} }},
            "start": {{ "joint": "rail", "position": 0 }}, "guess": {{ "rail": 0 }} }}"#
        );
        let all = all("mechanism.json", &text).unwrap();
        let shown = |one: &Located| format!("{} at {}", one.finding.message, &text[one.span.clone()]);
        all.located.iter().map(shown).collect()
    }

    /// The path refers to the file of the parameters. A value that uses a faulty parameter has no fault itself.
    #[test]
    fn a_fault_of_a_shared_parameter_is_reported_once_in_its_own_file() {
        let with = |parameters: &str| {
            findings_of_shared(&format!(r#"{{ "file": "c.json", "contents": {{ "parameters": {parameters} }} }}"#))
        };
        for (parameters, said) in [
            (r#"{ "load": "x +" }"#, "load: \"x +\": the expression ends with an operator: add the last value"),
            (r#"{ "load": "2 * y", "z": 3 }"#, "load: \"2 * y\": there is no parameter y"),
            (
                r#"{ "load": "other", "other": "load" }"#,
                "load: \"other\": the values refer to each other in a circle (load reads other reads load)",
            ),
        ] {
            let found = with(parameters);
            let [one] = &found[..] else { panic!("{found:#?}") };
            assert!(one.starts_with(&format!("parameters_from: c.json: parameters.{said}")), "{one}");
            assert!(one.ends_with(" at \"parameters_from\"") && !one.contains("(in c.json)"), "{one}");
        }
        let found = findings_of_shared("[1]");
        assert!(
            found.len() == 1
                && found[0].starts_with("parameters_from: must be a text in quotes, or an object { }, not a list"),
            "{found:#?}"
        );
    }

    /// An expression that uses a faulty parameter has no fault itself.
    #[test]
    fn a_circle_of_expressions_is_reported_once() {
        let text = r#"{ "name": "A", "parameters": { "a": "b", "b": "a + c", "c": 2, "d": "f" },
            "bodies": { "ground": {}, "rod": { "length": "a", "mass": "b" } },
            "joints": { "j": { "type": "revolute", "first": "ground.origin", "second": "rod.origin" } },
            "start": { "body": "rod", "angle": 0 }, "guess": { "rod": 0 } }"#;
        let found: Vec<String> =
            all("mechanism.json", text).unwrap().located.iter().map(|one| one.finding.to_string()).collect();
        assert_eq!(found.len(), 2, "{found:#?}");
        assert!(found.iter().any(|one| one.contains("in a circle")), "{found:#?}");
        assert!(found.iter().any(|one| one.contains("there is no parameter f;")), "{found:#?}");
    }
}
