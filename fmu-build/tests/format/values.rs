//! Values that both schema and engine accept, values that both reject, and defaults of missing keys.

use crate::support::{LEVELS, definition, full, refusal, schema, validator};
use linkage_fmu::mechanism::Model;
use linkage_fmu::variables::{Causality, Kind};
use serde_json::{Value, json};
use std::fs;
use std::path::PathBuf;

#[test]
fn both_accept_the_full_mechanism_and_those_of_this_repository() {
    let folders = fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../modelDescription")).unwrap();
    let files = folders.map(|folder| folder.unwrap().path().join("resources/mechanism.json")).filter(|f| f.is_file());
    let read = |file: PathBuf| -> Value { serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap() };
    let committed: Vec<Value> = files.map(read).collect();
    assert!(!committed.is_empty());
    for mechanism in committed.into_iter().chain([full()]) {
        let errors: Vec<String> = validator().iter_errors(&mechanism).map(|e| e.to_string()).collect();
        assert!(errors.is_empty(), "{errors:?}");
        Model::from_json(&mechanism.to_string()).unwrap();
    }
}

/// Writing a default explicitly changes nothing.
#[test]
fn defaults_agree() {
    let schema = schema();
    // One load and one spring of either kind, without any key that has a default.
    let mut plain = full();
    for (path, keys) in [
        ("/gravity", "load_factor"),
        ("/bodies/weight", "angle center inertia"),
        ("/joints/guide", "axis_angle angle"),
        ("/actuators/cylinder", "force efficiency"),
        ("/actuators/servo", "torque"),
        ("/forces/push", "force constant"),
        ("/torques/motor", "torque constant"),
        ("/springs/coil", "stiffness damping free_length preload"),
        ("/springs/torsion", "free_angle"),
        ("/friction", "enabled static_speed kinetic_speed"),
        ("/air", "relative_wind airspeed"),
        ("/stops/up", "enabled rigid restitution stiffness damping"),
        ("/locks/latch", "engage"),
        ("/start", "speed"),
        ("/bodies/rod", "points"),
        ("", "description solver experiment"),
    ] {
        for key in keys.split(' ') {
            plain.pointer_mut(path).unwrap().as_object_mut().unwrap().remove(key);
        }
    }
    let read = |mechanism: &Value| -> Vec<(String, f64)> {
        let mut model = Model::from_json(&mechanism.to_string()).unwrap();
        model.initialize().unwrap();
        let e = model.experiment();
        let list = model.variables().list().to_vec();
        // An explicit efficiency has an event indicator.
        let indicators = model.indicators();
        let values = (0..).zip(list).filter(|(r, v)| v.causality != Causality::Parameter && !indicators.contains(r));
        let mut value = |r, kind| match kind {
            Kind::Boolean => f64::from(u8::from(model.boolean(r).unwrap())),
            Kind::Enumeration => model.item(r).unwrap() as f64,
            Kind::Real => model.real(r).unwrap(),
        };
        let mut read: Vec<_> = values.map(|(r, v)| (v.name, value(r, v.kind))).collect();
        read.extend([("stop_time".into(), e.stop_time), ("step_size".into(), e.step_size)]);
        read
    };
    let before = read(&plain);
    let mut compared = 0;
    // All compatible defaults together, and each of the other defaults alone.
    let mut runs: Vec<(Value, Vec<String>)> = vec![(plain.clone(), Vec::new())];
    for (name, path) in LEVELS.into_iter().chain([
        ("body", "/bodies/weight"),
        ("body", "/bodies/rod"),
        ("actuator", "/actuators/servo"),
        ("spring", "/springs/torsion"),
        ("stop", "/stops/in"),
        ("surface", "/surfaces/plate"),
    ]) {
        let definition = definition(&schema, name);
        for (key, property) in definition["properties"].as_object().unwrap() {
            let target = match property["$ref"].as_str() {
                Some(path) => schema.pointer(path.trim_start_matches('#')).unwrap().clone(),
                None => json!({}),
            };
            let Some(default) = property.get("default").or(target.get("default")) else { continue };
            let with_default = |mechanism: &Value| {
                let mut mechanism = mechanism.clone();
                // None for an omitted element.
                mechanism.pointer_mut(path)?[key] = default.clone();
                Some(mechanism)
            };
            if plain.pointer(path).is_none_or(|element| element.get(key).is_some()) {
                continue;
            }
            let Some(mechanism) = with_default(&plain) else { continue };
            if refusal(&mechanism).is_some() {
                // The key cannot be combined with other keys of this element, or with its joint.
                let in_joint = mechanism.pointer(path).unwrap().get("joint").is_some();
                assert!(in_joint || !validator().is_valid(&mechanism), "{path}/{key} = {default}");
                continue;
            }
            if key == "frictionloss" {
                // The friction law of this mechanism cannot hold at rest, which constant friction requires.
                let refused = Model::from_json(&mechanism.to_string()).unwrap_err().to_string();
                assert!(refused.contains("write \"law\": \"stick\""), "{refused}");
                continue;
            }
            match with_default(&runs[0].0).filter(|together| refusal(together).is_none()) {
                Some(together) => {
                    runs[0].0 = together;
                    runs[0].1.push(format!("{path}/{key}"));
                }
                None => runs.push((mechanism, vec![format!("{path}/{key}")])),
            }
        }
    }
    for (mechanism, keys) in runs.into_iter().filter(|(_, keys)| !keys.is_empty()) {
        let now = read(&mechanism);
        assert_eq!(now.len(), before.len(), "defaults {keys:?}");
        for ((name, value), (same, known)) in now.iter().zip(&before) {
            assert_eq!(name, same, "defaults {keys:?}");
            // An explicit default may take part in the computation, such as an efficiency of 1. The last digits may
            // then differ within the resolution of the tables, for values of the order of 10 and accelerations of
            // 100. Derivatives of the holding force and of the reduced mass are slopes of polynomials: the slopes of
            // two tables of one function have errors of up to 6e-12 of the largest slope.
            let resolved = if name.ends_with("_derivative") { 1e-11 } else { 1e-13 };
            let miss = (value - known).abs();
            assert!(miss <= resolved * known.abs().max(10.0), "defaults {keys:?}: {name} {value}, not {known}");
        }
        compared += keys.len();
    }
    assert!(compared >= 30, "{compared} defaults compared");
}

/// Wrong values with their paths in the full mechanism. Both reject them, or only the engine if the schema cannot know
/// them.
#[test]
fn both_reject_wrong_input() {
    let validator = validator();
    let wrong: Value = serde_json::from_str(include_str!("wrong.json")).unwrap();
    let mut taken = Vec::new();
    for (group, schema_too) in [("both", true), ("engine", false)] {
        for (path, values) in wrong[group].as_object().unwrap() {
            let (parent, key) = path.rsplit_once('/').unwrap();
            for value in values.as_array().unwrap() {
                let mut mechanism = full();
                mechanism.pointer_mut(parent).unwrap()[key] = value.clone();
                if Model::from_json(&mechanism.to_string()).is_ok() {
                    taken.push(format!("the engine takes {path} = {value}"));
                }
                if validator.is_valid(&mechanism) == schema_too {
                    taken.push(format!("the schema takes or refuses {path} = {value}"));
                }
            }
        }
    }
    assert!(taken.is_empty(), "{taken:#?}");
}
