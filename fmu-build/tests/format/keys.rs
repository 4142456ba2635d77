//! The keys of every level: known and required keys, and choices.

use crate::support::{LEVELS, definition, full, keys, names_after, refusal, schema, validator};
use serde_json::{Value, json};
use std::collections::BTreeSet;

#[test]
fn keys_agree_at_every_level() {
    let schema = schema();
    for (name, path) in LEVELS {
        let mut mechanism = full();
        mechanism.pointer_mut(path).unwrap()["no_such_key"] = json!(0);
        assert!(!validator().is_valid(&mechanism), "the schema takes an unknown key at {path}");
        let message = refusal(&mechanism).unwrap();
        let definition = definition(&schema, name);
        let described = keys(&definition["properties"]);
        assert_eq!(definition["additionalProperties"], json!(false), "{path}");
        let known = names_after(&message, "the keys are");
        if name == "ground" {
            // The parser reads the ground like other bodies. A later check rejects the rest of its keys.
            assert!(described.is_subset(&known));
            for key in known.difference(&described) {
                let mut mechanism = full();
                mechanism["bodies"]["ground"][key] =
                    full()["bodies"]["weight"].get(key).cloned().unwrap_or(json!("uniform_rod"));
                assert!(refusal(&mechanism).is_some() && !validator().is_valid(&mechanism), "ground.{key}");
            }
        } else {
            assert_eq!(described, known, "keys at {path}");
        }
    }
}

#[test]
fn required_keys_agree_at_every_level() {
    let schema = schema();
    for (name, path) in LEVELS {
        let definition = definition(&schema, name);
        let required: BTreeSet<&str> =
            definition["required"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
        let full = full();
        for key in keys(full.pointer(path).unwrap()) {
            let mut mechanism = full.clone();
            mechanism.pointer_mut(path).unwrap().as_object_mut().unwrap().remove(key);
            let message = refusal(&mechanism).unwrap_or_default();
            assert_eq!(
                message.contains(&format!("the key `{key}` is missing")),
                required.contains(key),
                "{path}/{key}"
            );
            // If a key is missing for other keys or for the geometry, the schema may accept what the check rejects, but
            // not vice versa.
            assert!(!message.is_empty() || validator().is_valid(&mechanism), "{path}/{key}");
        }
        assert!(required.iter().all(|key| keys(full.pointer(path).unwrap()).contains(key)), "{path} lacks a key");
    }
}

#[test]
fn choices_agree() {
    let schema = schema();
    for (name, path, key) in [
        ("body", "/bodies/crank", "shape"),
        ("joint", "/joints/guide", "type"),
        ("stop", "/stops/up", "limit"),
        ("coupling", "/couplings/rack", "side"),
        ("coupling", "/couplings/cam", "follower"),
        ("cam_segment", "/couplings/cam/segments/0", "law"),
        ("solver", "/solver", "method"),
        ("units", "/units", "angle"),
        ("units", "/units", "length"),
    ] {
        let mut mechanism = full();
        mechanism.pointer_mut(path).unwrap()[key] = json!("no_such_choice");
        let message = refusal(&mechanism).unwrap();
        let choices: BTreeSet<&str> = schema["$defs"][name]["properties"][key]["enum"]
            .as_array()
            .unwrap()
            .iter()
            .map(|v| v.as_str().unwrap())
            .collect();
        let (message, _) = message.split_once(", not").unwrap();
        assert_eq!(names_after(message, "must be"), choices, "{path}/{key}");
    }
}
