//! The page `documentation/index.html` of an FMU.
//!
//! In: a model, its drawing, the facts of the check, the user's text. Out: one HTML document without scripts that loads
//! no other files. The module must not know how anything is drawn.

use super::results::Results;
use super::variables::tables;
use super::{Picture, Subject, markdown, parts};
use crate::check;
use crate::drawing::{Colours, to_svg};
use crate::xml::common::number;
use anyhow::{Context, Result};
use linkage_fmu::component::Component;
use linkage_fmu::inspection::{Fact, Severity};
use linkage_fmu::mechanism::definition::{JointKind, Mechanism};
use linkage_fmu::variables::{Causality, Unit, Variable};
use minijinja::value::{Serde, Value};
use minijinja::{Environment, context};
use serde::Serialize;
use std::f64::consts::PI;

const TEMPLATE: &str = include_str!("page/template.html");
const STYLE: &str = include_str!("page/page.css");

/// Conventions that the page states.
#[derive(Debug, Default, Serialize)]
struct Conventions {
    /// Gravity: its acceleration [m/s2], the angle of the downward direction [deg], the load factor at the start.
    gravity: Option<[String; 3]>,
    has_linkage: bool,
    has_prismatic: bool,
    has_drives: bool,
    has_circuit: bool,
    /// Whether the circuit moves the mechanism in the same FMU.
    is_coupled: bool,
    has_drag: bool,
    input_order: i32,
    output_order: i32,
}

/// Facts of one topic.
#[derive(Debug, Serialize)]
struct Topic {
    topic: &'static str,
    lines: Vec<String>,
}

/// The page.
///
/// # Errors
/// The template is wrong, or the drawing cannot be written.
pub fn html(subject: &Subject, picture: &Picture, animated: bool, results: Option<&Results>) -> Result<String> {
    let Subject { checked, component, readme } = subject;
    let mechanism = subject.is_mechanism().then(|| Mechanism::from_json(&checked.text)).transpose()?;
    let [wide, narrow] = picture.of_the_page();
    let experiment = component.experiment();
    let warnings = checked.findings.iter().filter(|located| located.finding.severity == Severity::Warning);
    let results = results.map(|results| {
        let above = |path: String| format!("../{path}");
        context! {
            outputs => above(results.outputs_path()),
            inputs => results.inputs_path().map(above),
            rows => results.rows,
        }
    });
    let mut environment = Environment::new();
    environment.add_template("index.html", TEMPLATE).context("template of the documentation")?;
    let template = environment.get_template("index.html").context("template of the documentation")?;
    let page = template.render(context! {
        name => component.name(),
        description => component.description(),
        style => Value::from_safe_string(STYLE.into()),
        drawing => Value::from_safe_string(to_svg(&wide, Colours::OfThePage, "drawing")?),
        small => Value::from_safe_string(to_svg(&narrow, Colours::OfThePage, "small")?),
        has_stops => picture.has_stops(),
        summary => Serde(summary(subject)),
        has_markers => picture.scene().is_some_and(|scene| !scene.markers.is_empty()),
        conventions => Serde(conventions(component, mechanism.as_ref())),
        parts => Serde(mechanism.as_ref().map(|mechanism| parts::tables(mechanism, &checked.units))),
        topics => Serde(topics(subject)),
        warnings => warnings.map(|located| located.finding.to_string()).collect::<Vec<_>>(),
        tables => Serde(tables(component.interface(), &checked.units)),
        readme => readme.map(|text| Value::from_safe_string(markdown::to_html(text))),
        animated,
        results,
        definition => subject.path(),
        stop_time => number(experiment.stop_time),
        step_size => number(experiment.step_size),
        version => env!("CARGO_PKG_VERSION"),
    });
    page.context("template of the documentation")
}

fn conventions(component: &Component, mechanism: Option<&Mechanism>) -> Conventions {
    let [input_order, output_order] = [component.input_order(), component.output_order()];
    let Some(mechanism) = mechanism else {
        return Conventions { has_circuit: true, input_order, output_order, ..Conventions::default() };
    };
    let gravity = mechanism.gravity.as_ref().filter(|gravity| gravity.acceleration > 0.0).map(|gravity| {
        let down = (gravity.up_angle * 180.0 / PI).rem_euclid(360.0) - 180.0;
        let rounded = format!("{down:.2}").parse().unwrap_or(down);
        [gravity.acceleration, rounded, gravity.load_factor].map(number)
    });
    let has_circuit = mechanism.actuators.iter().any(|(_, drive)| drive.hydraulics.is_some());
    Conventions {
        gravity,
        has_linkage: true,
        has_prismatic: mechanism.joints.iter().any(|(_, joint)| joint.kind == JointKind::Prismatic),
        has_drives: mechanism.actuators.iter().next().is_some(),
        has_circuit,
        is_coupled: has_circuit,
        has_drag: mechanism.air.is_some(),
        input_order,
        output_order,
    }
}

/// Facts of the check, grouped by topic.
fn topics(subject: &Subject) -> Vec<Topic> {
    let mut topics: Vec<Topic> = Vec::new();
    for fact in &subject.checked.inspection.facts {
        let line = check::line(fact, &subject.checked.units);
        match topics.iter_mut().find(|topic| topic.topic == fact.topic) {
            Some(topic) => topic.lines.push(line),
            None => topics.push(Topic { topic: fact.topic, lines: vec![line] }),
        }
    }
    topics
}

/// Largest number of names in a line of the summary.
const NAMED: usize = 8;

/// A line of the summary: its subject, and its text.
type Line = (&'static str, String);

/// Summary of the model: kind, travel, strokes and forces, inputs and outputs.
fn summary(subject: &Subject) -> Vec<Line> {
    let Subject { checked, component, .. } = subject;
    let facts = |topic: &'static str| checked.inspection.facts.iter().filter(move |fact| fact.topic == topic);
    let value = |fact: &Fact, name: &str| {
        let found = fact.quantities.iter().find(|quantity| quantity.name == name && quantity.value.is_finite());
        found.map(|quantity| checked.units.quantity(quantity.value, quantity.unit))
    };
    let mut lines: Vec<Line> = Vec::new();
    for fact in facts("Mass") {
        let mass = value(fact, "total").map_or_else(String::new, |mass| format!(", {mass}"));
        lines.push(("Mechanism", format!("{}{mass}", fact.text)));
    }
    let span = |fact: &Fact| Some(format!("{} {} to {}", fact.of, value(fact, "least")?, value(fact, "most")?));
    if let Some(travel) = facts("Travel").find_map(span) {
        let ends = facts("Ends of travel").map(|fact| fact.text.split(" at ").next().unwrap_or_default().to_owned());
        let mut ends: Vec<String> = ends.collect();
        ends.dedup();
        let start = facts("Travel").find_map(|fact| value(fact, "start")).unwrap_or_default();
        let stops = ends.iter().all(|end| !end.contains(' '));
        let ends = if stops { format!("stops {}", ends.join(" and ")) } else { ends.join("; ") };
        lines.push(("Travel", format!("{travel}, start {start}; {}", checked.units.text(&ends))));
    }
    let strokes = facts("Drives").filter(|fact| fact.text.is_empty()).filter_map(|fact| {
        let [stroke, least, most] = ["stroke", "least", "most"].map(|name| value(fact, name));
        Some(format!("{} {} ({} to {})", fact.of, stroke?, least?, most?))
    });
    let of_drive = |fact: &&Fact| fact.quantities.iter().any(|quantity| quantity.name == "holding");
    let forces = facts("Equilibrium at the start").filter(of_drive).filter_map(|fact| {
        let [given, holding] = ["given", "holding"].map(|name| value(fact, name));
        let given = given.map_or_else(String::new, |given| format!(", given {given}"));
        Some(format!("{}: holding {}{given}", fact.of, holding?))
    });
    let lists: [(_, Vec<String>); 2] = [("Stroke", strokes.collect()), ("Force at the start", forces.collect())];
    lines.extend(lists.into_iter().filter(|(_, list)| !list.is_empty()).map(|(about, list)| (about, list.join("; "))));
    for (about, causality) in [("Inputs", Causality::Input), ("Outputs", Causality::Output)] {
        let all: Vec<_> = component.interface().list().iter().filter(|v| v.causality == causality).collect();
        let named = |variable: &&&Variable| match variable.unit.map(Unit::name).filter(|unit| *unit != "1") {
            Some(unit) => format!("{} [{unit}]", variable.name),
            None => variable.name.clone(),
        };
        let mut text = all.iter().take(NAMED).map(|variable| named(&variable)).collect::<Vec<_>>().join(", ");
        match all.len().checked_sub(NAMED) {
            None if all.is_empty() => continue,
            None | Some(0) => {}
            Some(more) => text += &format!(" and {more} more"),
        }
        lines.push((about, text));
    }
    lines
}
