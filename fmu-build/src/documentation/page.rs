//! The page `documentation/index.html` of an FMU.
//!
//! In: a model, its drawing, what the check has found out about it, the user's text. Out: one HTML document without
//! scripts that loads nothing. It must not know how anything is drawn.

use super::results::Results;
use super::variables::tables;
use super::{Picture, Subject, markdown, parts};
use crate::check;
use crate::drawing::{Colours, to_svg};
use crate::xml::common::number;
use anyhow::{Context, Result};
use linkage_fmu::component::Component;
use linkage_fmu::inspection::Severity;
use linkage_fmu::mechanism::definition::{JointKind, Mechanism};
use minijinja::value::{Serde, Value};
use minijinja::{Environment, context};
use serde::Serialize;
use std::f64::consts::PI;

const TEMPLATE: &str = include_str!("page/template.html");
const STYLE: &str = include_str!("page/page.css");

/// What conventions a page tells.
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
    let drawing = picture.of_the_page();
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
        drawing => Value::from_safe_string(to_svg(&drawing, Colours::OfThePage, "drawing")?),
        has_markers => picture.scene().is_some_and(|scene| !scene.markers.is_empty()),
        conventions => Serde(conventions(component, mechanism.as_ref())),
        parts => Serde(mechanism.as_ref().map(parts::tables)),
        topics => Serde(topics(subject)),
        warnings => warnings.map(|located| located.finding.to_string()).collect::<Vec<_>>(),
        tables => Serde(tables(component.interface())),
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

/// Facts of the check, by topics.
fn topics(subject: &Subject) -> Vec<Topic> {
    let mut topics: Vec<Topic> = Vec::new();
    for fact in &subject.checked.inspection.facts {
        let line = check::line(fact);
        match topics.iter_mut().find(|topic| topic.topic == fact.topic) {
            Some(topic) => topic.lines.push(line),
            None => topics.push(Topic { topic: fact.topic, lines: vec![line] }),
        }
    }
    topics
}
