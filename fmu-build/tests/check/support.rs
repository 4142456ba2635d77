//! A slider-crank, texts made from it, and their findings.

#[allow(dead_code)]
#[path = "../../../tests/support/definition.rs"]
pub mod definition;
#[path = "../../../tests/support/folder.rs"]
mod folder;

use definition::{With, rod};
use fmu_build::check::{self, Checked};
pub use folder::Folder;
use linkage_fmu::inspection::{Fact, Severity};
use serde_json::{Value, json};

pub fn checked(text: &str) -> Checked {
    check::check("m.json".into(), "mechanism.json", text.into()).unwrap()
}

/// A crank of 0.1 m and a rod of 0.3 m in the plane of gravity, 2 kg in the slider on the X axis.
pub fn slider_crank() -> Value {
    definition::slider_crank([rod(0.1, 1.0), json!({ "length": 0.3 }), json!({ "mass": 2.0 })], 0.5).with(json!({
        "name": "M", "gravity": { "acceleration": 10.0, "up_angle": std::f64::consts::FRAC_PI_2 },
        "actuators": { "motor": { "joint": "bearing" }, "push": { "joint": "guide" } },
        "guess": { "rod": -0.16, "guide": 0.38 },
    }))
}

pub fn with(path: &str, value: Value) -> String {
    let mut all = slider_crank();
    let (parent, key) = path.rsplit_once('/').unwrap();
    all.pointer_mut(parent).unwrap()[key] = value;
    serde_json::to_string_pretty(&all).unwrap()
}

/// Place and message of each finding with this severity, and the underlined text.
pub fn found(text: &str, severity: Severity) -> Vec<(String, String, String)> {
    let all = checked(text);
    let located = all.findings.iter().filter(|located| located.finding.severity == severity);
    let shown = |span: std::ops::Range<usize>| text[span].to_owned();
    located.map(|l| (l.finding.path.clone(), l.finding.to_string(), shown(l.span.clone()))).collect()
}

pub fn fact<'a>(checked: &'a Checked, topic: &str, of: &str) -> &'a Fact {
    let found = checked.inspection.facts.iter().find(|fact| fact.topic == topic && fact.of == of);
    found.unwrap_or_else(|| panic!("{topic} of {of} in {:#?}", checked.inspection.facts))
}

pub fn number(checked: &Checked, topic: &str, of: &str, name: &str) -> f64 {
    fact(checked, topic, of).quantities.iter().find(|quantity| quantity.name == name).unwrap().value
}
