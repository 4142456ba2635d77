//! The studies of the documentation, and the schema.

use crate::support::{Folder, sweep};
use fmu_build::workspace::Workspace;
use serde_json::{Value, json};
use std::fs;
use std::path::PathBuf;

/// Paths of the studies of docs/studies.md.
fn examples() -> Vec<PathBuf> {
    let folder = Workspace::locate().root().join("docs/studies");
    let mut all: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    all.retain(|path| path.extension().is_some_and(|extension| extension == "json"));
    all.sort();
    assert_eq!(all.len(), 5);
    all
}

/// The studies of docs/studies.md, with few values of each factor and few samples.
#[test]
fn the_worked_studies_run() {
    let folder = Folder::new("examples");
    for path in examples() {
        let mut study: Value = serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
        if study.get("objective").is_some() {
            // A grid over the bounds replaces the search.
            for key in ["objective", "constraints", "search"] {
                study.as_object_mut().unwrap().remove(key);
            }
            for factor in study["factors"].as_object_mut().unwrap().values_mut() {
                *factor = json!({ "range": factor["bounds"], "steps": 3 });
            }
        }
        for factor in study["factors"].as_object_mut().unwrap().values_mut() {
            if factor.get("steps").is_some() {
                factor["steps"] = json!(3);
            }
        }
        if study.get("sampling").is_some() {
            study["sampling"]["count"] = json!(20);
        }
        for file in ["mechanism", "points"] {
            if let Some(name) = study[file].as_str() {
                study[file] = json!(path.parent().unwrap().join(name));
            }
        }
        let rows = folder.rows(study);
        assert!(rows.rows.len() >= 9, "{}", path.display());
        for row in 0..rows.rows.len() {
            assert_eq!((rows.text(row, "failed"), rows.text(row, "message")), ("0", ""), "{}, {row}", path.display());
            let time = rows.number(row, "retraction");
            assert!(time > 0.05 && time < 0.6, "{}, {row}: {time}", path.display());
        }
        let times = rows.column("retraction");
        assert!(times.iter().any(|time| *time != times[0]));
    }
}

/// The optimum in the report is that of the study in docs/studies: its runs give the committed responses.
#[test]
fn the_committed_optimum_is_that_of_the_study() {
    let root = Workspace::locate().root().to_path_buf();
    let read = |path: &str| serde_json::from_str::<Value>(&fs::read_to_string(root.join(path)).unwrap()).unwrap();
    let (study, optimum) = (read("docs/studies/least_force.json"), read("validation/results/least_force_optimum.json"));
    let folder = Folder::new("optimum");
    for design in ["present", "best"] {
        let committed = &optimum[design];
        let mut study = study.clone();
        for key in ["objective", "constraints", "search"] {
            study.as_object_mut().unwrap().remove(key);
        }
        for (name, factor) in study["factors"].as_object_mut().unwrap() {
            assert_eq!(optimum["bounds"][name], factor["bounds"], "{name}");
            *factor = json!({ "values": [committed["factors"][name]] });
        }
        study["mechanism"] = json!(root.join("docs/studies").join(study["mechanism"].as_str().unwrap()));
        let rows = folder.rows(study);
        for (name, expected) in committed["responses"].as_object().unwrap() {
            let (value, expected) = (rows.number(0, name), expected.as_f64().unwrap());
            // Processors without fused multiply-add give other rounding errors. The tolerance of the integration is
            // 1e-9.
            assert!((value - expected).abs() <= 1e-7 * expected.abs(), "{design}, {name}: {value} and {expected}");
        }
    }
}

/// The examples of the reference, and every kind of key, with the schema. The schema rejects what the reader rejects.
#[test]
fn the_schema_agrees_with_the_reader() {
    let descriptions = Workspace::locate().descriptions();
    let schema = fs::read_to_string(descriptions.join("study.schema.json")).unwrap();
    let validator = jsonschema::draft202012::new(&serde_json::from_str(&schema).unwrap()).unwrap();
    let page = fs::read_to_string(descriptions.join("../docs/reference/study.md")).unwrap();
    let stated = page.split("```json").skip(1).map(|text| text.split("```").next().unwrap().to_owned());
    let texts = examples().into_iter().map(|path| fs::read_to_string(path).unwrap()).chain(stated);
    for text in texts {
        let study: Value = serde_json::from_str(&text).unwrap();
        assert!(validator.is_valid(&study), "{text}");
        for key in ["mechanism", "responses"] {
            let mut without = study.clone();
            without.as_object_mut().unwrap().remove(key);
            assert!(!validator.is_valid(&without), "{key}");
        }
    }
    let folder = Folder::new("schema");
    let response = json!({ "r": { "final": "crank.angle" } });
    for (study, is_right) in [
        (json!({ "responses": response }), true),
        (json!({ "responses": {} }), false),
        (json!({ "responses": response, "factor": {} }), false),
        (json!({ "responses": response, "factors": { "crank.mass": { "values": [1], "range": [1, 2] } } }), false),
        (json!({ "responses": response, "factors": { "crank.mass": { "range": [1, 2] } } }), false),
        (json!({ "responses": response, "factors": { "crank.mass": { "range": [1, 2], "steps": 2 } } }), true),
        (json!({ "responses": response, "factors": { "crank.mass": { "values": [1], "steps": 2 } } }), false),
        (json!({ "responses": response, "scenario": { "inputs": { "crank.torque": [] } } }), false),
        (json!({ "responses": response, "scenario": { "inputs": { "crank.torque": [[0, 1]] } } }), true),
        (json!({ "responses": response, "scenario": { "stop_time": -1 } }), false),
        (json!({ "responses": { "r": { "final": "crank.angle", "maximum": "crank.angle" } } }), false),
        (json!({ "responses": { "r": { "final": "crank.angle", "times": [0] } } }), false),
        (json!({ "responses": { "r": { "course": "crank.angle", "times": [0, 0.1] } } }), true),
        (json!({ "responses": { "r": { "course": "crank.angle", "times": [] } } }), false),
        (json!({ "responses": response, "objective": { "minimise": "r", "maximise": "r" } }), false),
        (json!({ "responses": response, "objective": { "minimise": "r" }, "constraints": { "r": {} } }), false),
        (json!({ "responses": response, "objective": { "minimise": "r" }, "search": { "evaluations": 3 } }), false),
    ] {
        let path = folder.study("study.json", study.clone());
        let stated: Value = serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
        assert_eq!(validator.is_valid(&stated), is_right, "the schema: {study}");
        let done = sweep(&path, &folder.0.join("out"), 1);
        assert_eq!(done.is_ok(), is_right, "the reader: {study}: {done:?}");
    }
}
