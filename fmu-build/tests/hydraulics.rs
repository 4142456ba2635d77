//! The schema, the examples of the reference and the engine agree about valid hydraulic actuators.
#![allow(clippy::unwrap_used)]

use linkage_fmu::component::{Component, Stepped};
use linkage_fmu::format::written;
use linkage_fmu::hydraulics::definition::{Circuit, HydraulicActuator};
use linkage_fmu::variables::Kind;
use serde_json::{Value, json};

const SCHEMA: &str = include_str!("../../modelDescription/hydraulics.schema.json");
const PAGE: &str = include_str!("../../docs/reference/hydraulics/index.md");

fn schema() -> Value {
    serde_json::from_str(SCHEMA).unwrap()
}

#[test]
fn every_example_runs() {
    let validator = jsonschema::draft202012::new(&schema()).unwrap();
    let blocks: Vec<&str> = PAGE.split("```json\n").skip(1).map(|block| block.split_once("```").unwrap().0).collect();
    assert!(blocks.len() >= 2);
    for text in blocks {
        let example: Value = serde_json::from_str(text).unwrap();
        let errors: Vec<String> = validator.iter_errors(&example).map(|error| error.to_string()).collect();
        assert!(errors.is_empty(), "{errors:?} in\n{text}");
        let mut actuator = Component::from_definition("hydraulics.json", text).unwrap();
        actuator.initialize().unwrap();
        for _ in 0..10 {
            assert_eq!(actuator.step(1e-3).unwrap(), Stepped::Whole);
        }
        for (reference, variable) in (0..).zip(actuator.interface().list().to_vec()) {
            if variable.kind == Kind::Real {
                assert!(actuator.real(reference).unwrap().is_finite(), "{} in\n{text}", variable.name);
            }
        }
    }
}

/// Sections of the circuit in the schema, each with its keys.
fn sections() -> Vec<(String, Value)> {
    let schema = schema();
    let sections = schema["$defs"]["circuit"]["properties"].as_object().unwrap();
    sections.keys().map(|name| (name.clone(), schema["$defs"][name]["properties"].clone())).collect()
}

#[test]
fn keys_and_defaults_are_those_of_the_engine() {
    let defaults: Value = serde_json::from_str(&written(&mut Circuit::default())).unwrap();
    assert_eq!(defaults.as_object().unwrap().len(), sections().len());
    for (name, keys) in sections() {
        let own = defaults[&name].as_object().unwrap_or_else(|| panic!("the engine has no {name}"));
        assert_eq!(own.len(), keys.as_object().unwrap().len(), "{name}");
        for (key, value) in own {
            assert_eq!(keys[key]["default"].as_f64(), value.as_f64(), "{name}.{key}");
        }
    }
}

#[test]
fn the_engine_has_the_limits_of_the_schema() {
    for (name, keys) in sections() {
        let numbers = keys.as_object().unwrap().iter().filter(|(_, rule)| rule["default"].is_number());
        for (key, rule) in numbers {
            let reads = |value: f64| {
                let text = json!({ "name": "A", "circuit": { &name: { key: value } } }).to_string();
                HydraulicActuator::from_json(&text).is_ok()
            };
            match (rule.get("minimum"), rule.get("exclusiveMinimum")) {
                (Some(_), _) => assert!(reads(0.0) && !reads(-1e-9), "{name}.{key}"),
                (_, Some(_)) => assert!(!reads(0.0) && reads(rule["default"].as_f64().unwrap()), "{name}.{key}"),
                _ => assert!(reads(rule["default"].as_f64().unwrap()), "{name}.{key}"),
            }
        }
    }
}
