//! Findings and facts as text and as JSON.

use super::{Checked, FileUnits, Located};
use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};
use linkage_fmu::inspection::{Fact, Quantity, Severity};
use serde_json::{Value, json};
use std::collections::HashSet;
use std::fmt::Write;

/// Distance from the guess that counts as rounding [rad or m].
const SAME: f64 = 1e-9;

/// All findings and facts of a definition.
pub fn text(checked: &Checked) -> String {
    let mut out = findings(checked);
    let facts = &checked.inspection.facts;
    let mut printed = HashSet::new();
    for topic in facts.iter().map(|fact| fact.topic).filter(|topic| printed.insert(*topic)) {
        let _ = writeln!(out, "{topic}");
        let of_topic = || facts.iter().filter(|fact| fact.topic == topic);
        if of_topic().all(is_idle) {
            let _ = writeln!(out, "  all joints fit in the position that the key guess states");
        }
        for fact in &together(of_topic().filter(|fact| !is_idle(fact))) {
            let _ = writeln!(out, "  {}", line(fact, &checked.units));
        }
    }
    let _ = writeln!(out, "{}", summary(checked));
    out
}

/// Whether a fact contains no information: a coordinate whose guess is its assembled value.
fn is_idle(fact: &Fact) -> bool {
    let apart = fact.quantities.iter().find(|quantity| quantity.name == "apart");
    apart.is_some_and(|apart| apart.value.abs() < SAME)
}

/// These facts. Facts without numbers and with the same topic are joined: at one dead centre several bodies may stand
/// still.
fn together<'f>(facts: impl Iterator<Item = &'f Fact>) -> Vec<Fact> {
    let mut all: Vec<Fact> = Vec::new();
    for fact in facts {
        let is_same = |other: &&mut Fact| {
            other.text == fact.text && !fact.of.is_empty() && fact.quantities.is_empty() && other.quantities.is_empty()
        };
        match all.iter_mut().find(is_same) {
            Some(other) => other.of = [&other.of, ", ", &fact.of].concat(),
            None => all.push(fact.clone()),
        }
    }
    all
}

/// All findings of a definition: each with its place, the text underlined, and the remedy.
pub fn findings(checked: &Checked) -> String {
    checked.findings.iter().map(|located| finding(checked, located) + "\n\n").collect()
}

/// Findings of this severity, one per line: place, message, remedy.
pub fn listed(checked: &Checked, severity: Severity) -> Vec<String> {
    let found = checked.findings.iter().filter(|located| located.finding.severity == severity);
    found.map(|located| format!("{}: {}", place(checked, located), located.finding)).collect()
}

/// One line: number of findings, and the travel of the mechanism.
pub fn summary(checked: &Checked) -> String {
    let counted = |count: usize, word: &str| format!("{count} {word}{}", if count == 1 { "" } else { "s" });
    let found = [(Severity::Error, "error"), (Severity::Warning, "warning")]
        .map(|(severity, word)| counted(checked.count(severity), word));
    let name = if checked.inspection.name.is_empty() { "no model could be built" } else { &checked.inspection.name };
    let mut out = format!("{}: {name}: {}", checked.shown, found.join(", "));
    let facts = &checked.inspection.facts;
    for topic in ["Crossings", "Near misses", "Redundant joints"] {
        let count = facts.iter().filter(|fact| fact.topic == topic).count();
        if count > 0 {
            let _ = write!(out, ", {} {count}", topic.to_lowercase());
        }
    }
    if !checked.is_whole {
        out.push_str("; correct these errors first, because names and numbers are checked only after this correction");
    }
    let start = facts.iter().filter(|fact| fact.topic == "Travel").find_map(|fact| {
        let start = fact.quantities.iter().find(|quantity| quantity.name == "start")?;
        Some(format!("{} = {}", fact.of, checked.units.quantity(start.value, start.unit)))
    });
    if let Some(start) = start {
        let _ = write!(out, "; start at {start}");
    }
    if let Some(fact) = facts.iter().find(|fact| fact.topic.starts_with("Equilibrium at")) {
        let _ = write!(out, "; {}", fact.text.split(':').next().unwrap_or_default());
    }
    out
}

fn place(checked: &Checked, located: &Located) -> String {
    let [line, column] = located.position;
    if located.span.is_empty() { checked.shown.clone() } else { format!("{}:{line}:{column}", checked.shown) }
}

fn finding(checked: &Checked, located: &Located) -> String {
    let finding = &located.finding;
    let level = if finding.severity == Severity::Error { Level::ERROR } else { Level::WARNING };
    let title = match finding.severity {
        Severity::Warning if !finding.path.is_empty() => format!("{}: {}", finding.path, finding.message),
        _ => finding.message.clone(),
    };
    let mut group = Group::with_title(level.primary_title(title));
    if located.span.is_empty() {
        group = group.element(annotate_snippets::Origin::path(checked.shown.as_str()));
    } else {
        let annotation = AnnotationKind::Primary.span(located.span.clone());
        group =
            group.element(Snippet::source(checked.text.as_str()).path(checked.shown.as_str()).annotation(annotation));
    }
    if !finding.remedy.is_empty() {
        group = group.element(Level::HELP.message(finding.remedy.as_str()));
    }
    Renderer::plain().render(&[group])
}

/// A fact in one line, in the units of the file.
pub fn line(fact: &Fact, units: &FileUnits) -> String {
    let of = if fact.of.is_empty() { String::new() } else { format!("{}: ", fact.of) };
    let numbers: Vec<String> = fact.quantities.iter().map(|one| quantity(one, units)).collect();
    let numbers = numbers.join(", ");
    let text = without_repeated_word(fact);
    let joint = if numbers.is_empty() || text.is_empty() { "" } else { "; " };
    format!("{of}{numbers}{joint}{}", units.text(text))
}

/// The text of a fact without the word that the name of its first number already contains.
fn without_repeated_word(fact: &Fact) -> &str {
    let word = fact.quantities.first().and_then(|quantity| quantity.name.strip_suffix(" position"));
    let rest = word.and_then(|word| fact.text.strip_prefix(word));
    rest.and_then(|rest| if rest.is_empty() { Some(rest) } else { rest.strip_prefix(": ") }).unwrap_or(&fact.text)
}

fn quantity(quantity: &Quantity, units: &FileUnits) -> String {
    let Quantity { name, value, unit } = quantity;
    // The largest number represents an infinite value.
    match value.abs() >= f64::MAX && *unit != "1" {
        true => format!("{name} infinite"),
        false => format!("{name} {}", units.quantity(*value, unit)),
    }
}

/// Findings and facts of all definitions as JSON.
pub fn json(all: &[Checked]) -> Value {
    let finding = |located: &Located| {
        let [line, column] = located.position;
        json!({
            "severity": located.finding.severity,
            "path": located.finding.path,
            "message": located.finding.message,
            "remedy": located.finding.remedy,
            "line": line,
            "column": column,
            "bytes": [located.span.start, located.span.end],
        })
    };
    let one = |checked: &Checked| {
        json!({
            "file": checked.shown,
            "name": checked.inspection.name,
            "errors": checked.count(Severity::Error),
            "warnings": checked.count(Severity::Warning),
            "findings": checked.findings.iter().map(finding).collect::<Vec<_>>(),
            "facts": checked.inspection.facts,
        })
    };
    Value::Array(all.iter().map(one).collect())
}
