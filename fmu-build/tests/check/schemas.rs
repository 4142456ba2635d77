//! The JSON of `check` and `info` agrees with the committed schemas, and the page explains each field.

use crate::support::{Folder, slider_crank, with};
use fmu_build::archive::{self, Entry};
use fmu_build::workspace::Workspace;
use serde_json::{Value, json};
use std::fs;
use std::path::Path;
use std::process::Command;

const PAGE: &str = include_str!("../../../docs/reference/json-output.md");

fn schema(name: &str) -> Value {
    let path = Workspace::locate().descriptions().join("../docs/reference/files").join(name);
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

/// The JSON output of a task for paths.
fn printed(task: &str, paths: &[&Path]) -> Value {
    let out = Command::new(env!("CARGO_BIN_EXE_fmu-build")).arg(task).args(paths).arg("--json").output().unwrap();
    serde_json::from_slice(&out.stdout).unwrap_or_else(|e| panic!("{e}: {}", String::from_utf8_lossy(&out.stderr)))
}

fn assert_valid(schema: &Value, value: &Value) {
    let validator = jsonschema::draft202012::new(schema).unwrap();
    let errors: Vec<String> = validator.iter_errors(value).map(|e| format!("{}: {e}", e.instance_path())).collect();
    assert!(errors.is_empty(), "{errors:?} in {value:#}");
}

/// The names of all fields of a schema.
fn fields(schema: &Value, found: &mut Vec<String>) {
    match schema {
        Value::Object(members) => {
            if let Some(Value::Object(properties)) = members.get("properties") {
                found.extend(properties.keys().cloned());
            }
            members.values().for_each(|member| fields(member, found));
        }
        Value::Array(items) => items.iter().for_each(|item| fields(item, found)),
        _ => {}
    }
}

#[test]
fn the_page_explains_each_field() {
    for name in ["check.schema.json", "info.schema.json"] {
        let mut found = Vec::new();
        fields(&schema(name), &mut found);
        assert!(found.len() > 10, "{found:?}");
        for field in found {
            let is_explained = ["`", ".", "]."].iter().any(|before| PAGE.contains(&format!("{before}{field}`")));
            assert!(is_explained, "{name}: {field}");
        }
    }
}

#[test]
fn output_of_check_conforms_to_its_schema() {
    let folder = Folder::new("schemas");
    folder.write("warned.json", with("/gravity/up_angle", json!(90)));
    folder.write("wrong.json", with("/start/body", json!("none")));
    folder.write("apart.json", with("/bodies/rod/length", json!(0.01)));
    folder.write("broken.json", "{ \"name\": 3,");
    let mut paths: Vec<_> =
        ["warned", "wrong", "apart", "broken", "missing"].map(|name| folder.join(format!("{name}.json"))).into();
    let examples = fs::read_dir(Workspace::locate().descriptions()).unwrap().map(|entry| entry.unwrap().path());
    paths.extend(examples.filter(|path| path.join("resources").is_dir()));
    let all = printed("check", &paths.iter().map(|path| path.as_path()).collect::<Vec<_>>());
    let schema = schema("check.schema.json");
    assert_valid(&schema, &all);
    let counts: Vec<_> = all.as_array().unwrap().iter().map(|one| [&one["errors"], &one["warnings"]]).collect();
    assert!(counts.len() > 15 && counts[0] == [&json!(0), &json!(1)] && counts[1] == [&json!(1), &json!(0)]);
    // The page lists the topics.
    for fact in all.as_array().unwrap().iter().flat_map(|one| one["facts"].as_array().unwrap()) {
        let topic = fact["topic"].as_str().unwrap();
        assert!(PAGE.contains(topic), "the page has no topic {topic}");
    }
    let mut other = all[0].clone();
    other["colour"] = json!("red");
    assert!(!jsonschema::draft202012::new(&schema).unwrap().is_valid(&json!([other])));
}

#[test]
fn output_of_info_conforms_to_its_schema() {
    let folder = Folder::new("schemas-info");
    folder.write("M.json", slider_crank().to_string());
    let gear = Workspace::locate().descriptions().join("LandingGearRetraction");
    let entry = |name: &str| Entry { name: name.into(), content: fs::read(gear.join(name)).unwrap() };
    let entries = ["modelDescription.xml", "resources/mechanism.json"].map(entry).into();
    archive::write(&folder.join("Gear.fmu"), entries).unwrap();
    let schema = schema("info.schema.json");
    for (path, definition) in [("M.json", json!("mechanism.json")), ("Gear.fmu", json!("mechanism.json"))] {
        let output = printed("info", &[&folder.join(path)]);
        assert_valid(&schema, &output);
        assert_eq!(output["definition"], definition);
    }
}
