//! The examples of the pages of the elements, each in its complete file.

use crate::support::{examples, validator};
use linkage_fmu::mechanism::Model;
use linkage_fmu::variables::Kind;
use serde_json::{Value, json};

/// Groups of named entries.
const GROUPS: [&str; 12] = [
    "bodies",
    "joints",
    "couplings",
    "actuators",
    "forces",
    "torques",
    "springs",
    "markers",
    "surfaces",
    "stops",
    "locks",
    "guess",
];

/// Add a part of a file to a complete file: entries of groups one by one, other keys unchanged.
fn add_part(whole: &mut Value, part: &Value) {
    for (key, value) in part.as_object().unwrap() {
        if GROUPS.contains(&key.as_str()) {
            let group = whole.as_object_mut().unwrap().entry(key).or_insert_with(|| json!({}));
            for (name, entry) in value.as_object().unwrap() {
                group[name] = entry.clone();
            }
        } else {
            whole[key] = value.clone();
        }
    }
}

#[test]
fn every_example_runs() {
    let validator = validator();
    let (mut wholes, mut parts) = (0, 0);
    for (page, above, example) in examples() {
        let text = format!("{page}:\n{example:#}");
        let mut whole = above.clone();
        if whole == example {
            wholes += 1;
        } else {
            add_part(&mut whole, &example);
            parts += 1;
        }
        let errors: Vec<String> =
            validator.iter_errors(&whole).map(|e| format!("{}: {e}", e.instance_path())).collect();
        assert!(errors.is_empty(), "{errors:?} in\n{text}");
        let mut model = Model::from_json(&whole.to_string()).unwrap_or_else(|e| panic!("{e} in\n{text}"));
        model.initialize().unwrap_or_else(|e| panic!("{e} in\n{text}"));
        let drift = model.variables().find("energy.drift").unwrap();
        for _ in 0..10 {
            model.step(1e-3).unwrap_or_else(|e| panic!("{e} in\n{text}"));
        }
        let crosses = whole["name"] == "Parallelogram";
        for (reference, variable) in (0..).zip(model.variables().list().to_vec()) {
            if variable.kind == Kind::Boolean {
                model.boolean(reference).unwrap_or_else(|e| panic!("{e} in\n{text}"));
                continue;
            }
            if variable.kind == Kind::Enumeration {
                model.item(reference).unwrap_or_else(|e| panic!("{e} in\n{text}"));
                continue;
            }
            let value = model.real(reference).unwrap_or_else(|e| panic!("{e} in\n{text}"));
            // The page describes this for reactions at crossings.
            let is_of_exchange = whole["solver"]["method"] == "rigid_fem" && variable.name.starts_with("along_curve.");
            let may_be_undefined = crosses && variable.name.contains(".force") || is_of_exchange;
            let reason = model.undefined(reference);
            assert!(value.is_finite() || may_be_undefined, "{} = {value}, {reason:?} in\n{text}", variable.name);
        }
        let lost = model.real(drift).unwrap();
        assert!(lost.abs() < 1e-6, "energy.drift {lost} J in\n{text}");
    }
    assert!(wholes >= 5 && parts >= 25, "{wholes} whole mechanisms and {parts} parts found");
}
