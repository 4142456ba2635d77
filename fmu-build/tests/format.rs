//! The schema, the examples of FORMAT.md and the engine agree on what a mechanism is.
#![allow(clippy::unwrap_used)]

use jsonschema::Validator;
use linkage_fmu::mechanism::Model;
use linkage_fmu::mechanism::definition::Mechanism;
use linkage_fmu::variables::{Causality, Kind};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::fs;
use std::path::PathBuf;

const SCHEMA: &str = include_str!("../../modelDescription/mechanism.schema.json");
const FORMAT: &str = include_str!("../../modelDescription/FORMAT.md");
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

fn schema() -> Value {
    serde_json::from_str(SCHEMA).unwrap()
}

fn validator() -> Validator {
    jsonschema::draft202012::new(&schema()).unwrap()
}

/// Has every element and, taken together, every key that goes with others.
fn full() -> Value {
    json!({
        "$schema": "mechanism.schema.json", "name": "Full", "description": "d",
        "about": { "author": "A", "copyright": "C", "license": "L" },
        "units": { "angle": "rad", "length": "m" },
        "gravity": { "acceleration": 9.81, "up_angle": 1.5, "load_factor": 1 },
        "bodies": {
            "ground": {
                "length": 1.0,
                "points": {
                    "anchor": [0.3, -2.0], "shaft": [-0.5, 0.0], "pulley": [0.0, 0.6], "oval": [0.7, 0.7], "bed": [0.0, -0.05],
                    "lifter": [0.0, -0.3]
                }
            },
            "crank": { "length": 0.1, "mass": 1.2, "shape": "uniform_rod", "points": { "eye": [0.05, 0.02] } },
            "weight": { "fixed_to": "crank.origin", "angle": 3.0, "mass": 0.3, "center": [0.02, 0.0], "inertia": 0.001 },
            "rod": { "length": 0.3, "mass": 0.9, "shape": "uniform_rod", "axial_stiffness": 1e7 },
            "slider": {
                "mass": 0.5,
                "drawn": { "origin": [0.38, 0.0], "angle": 0.0, "points": { "lug": [0.38, 0.05] }, "center": [0.38, 0.01] }
            },
            "wheel": { "mass": 0.1, "inertia": 1e-4 },
            "pulley": { "mass": 0.1, "inertia": 1e-4 },
            "oval": { "mass": 0.1, "inertia": 1e-4 },
            "table": { "mass": 0.2 },
            "tappet": { "mass": 0.1 }
        },
        "joints": {
            "bearing": { "type": "revolute", "first": "ground.origin", "second": "crank.origin" },
            "pin": { "type": "revolute", "first": "crank.end", "second": "rod.origin", "pin_radius": 0.01 },
            "wrist": { "type": "revolute", "first": "rod.end", "second": "slider.origin" },
            "guide": {
                "type": "prismatic", "first": "ground.origin", "second": "slider.origin", "axis_angle": 0.0, "angle": 0.0,
                "static_coefficient": 0.1, "kinetic_coefficient": 0.05
            },
            "wheel_pin": { "type": "revolute", "first": "ground.shaft", "second": "wheel.origin" },
            "pulley_pin": { "type": "revolute", "first": "ground.pulley", "second": "pulley.origin" },
            "oval_pin": { "type": "revolute", "first": "ground.oval", "second": "oval.origin" },
            "slide": { "type": "prismatic", "first": "ground.bed", "second": "table.origin" },
            "lifter": {
                "type": "prismatic", "first": "ground.lifter", "second": "tappet.origin", "axis_angle": 1.5707963267948966
            }
        },
        "couplings": {
            "mesh": {
                "type": "gears", "first": "crank.origin", "second": "wheel.origin", "first_teeth": 20, "second_teeth": 40,
                "pressure_angle": 0.0
            },
            "belt": {
                "type": "belt", "first": "crank.origin", "second": "pulley.origin", "first_radius": 0.05, "second_radius": 0.1
            },
            "ovals": {
                "type": "elliptic_gears", "first": "crank.origin", "second": "oval.origin", "eccentricity": 0.2,
                "pressure_angle": 0.0
            },
            "rack": {
                "type": "rack", "first": "crank.origin", "joint": "slide", "radius": 0.05, "pressure_angle": 0.0
            },
            "cam": {
                "type": "cam", "first": "crank.origin", "joint": "lifter", "follower": "roller", "contact": "tappet.origin",
                "base_radius": 0.05, "roller_radius": 0.01,
                "segments": [
                    { "law": "cycloidal", "angle": 2.0, "rise": 0.01 }, { "law": "polynomial_345", "angle": 2.0, "rise": -0.01 },
                    { "law": "dwell" }
                ]
            }
        },
        "actuators": {
            "cylinder": { "first": "ground.anchor", "second": "crank.end", "force": 1.0, "efficiency": 0.9 },
            "servo": { "joint": "bearing", "torque": 1.0 },
            "spindle": { "joint": "guide", "torque": 0.1, "screw": { "lead": 0.01, "inertia": 1e-6 } }
        },
        "forces": { "push": { "at": "slider.origin", "force": [0.0, 0.0], "constant": true } },
        "torques": { "motor": { "on": "crank", "torque": 2.0, "constant": false } },
        "springs": {
            "coil": {
                "first": "ground.anchor", "second": "slider.origin", "stiffness": 1.0, "damping": 0.1, "free_length": 0.2,
                "preload": 1.0
            },
            "torsion": { "joint": "bearing", "stiffness": 1.0, "free_angle": 0.3 }
        },
        "markers": { "eye": { "at": "crank.eye" } },
        "friction": {
            "enabled": true, "static_coefficient": 0.2, "kinetic_coefficient": 0.1, "static_speed": 0.02, "kinetic_speed": 0.9
        },
        "air": { "density": 1.2, "flow_angle": 0.3, "relative_wind": true, "airspeed": 5.0 },
        "surfaces": {
            "vane": { "from": "rod.origin", "to": "rod.end", "width": 0.02, "drag_coefficient": 1.1 },
            "plate": { "at": "crank.eye", "area": 0.01, "surface_angle": 0.4, "drag_coefficient": 0.9 }
        },
        "stops": {
            "up": {
                "body": "crank", "limit": "upper", "angle": 2.5, "enabled": true, "rigid": true, "restitution": 0.4,
                "stiffness": 1e4, "damping": 10.0, "flag": "is_up"
            },
            "in": { "joint": "guide", "limit": "lower", "position": 0.22 },
            "far": { "first": "ground.anchor", "second": "slider.origin", "limit": "upper", "length": 2.1 }
        },
        "locks": { "latch": { "stop": "up", "at": "crank.end", "engage": true } },
        "start": { "body": "crank", "angle": 0.5, "speed": 1.0 },
        "guess": {
            "crank": 0.5, "rod": -0.16, "guide": 0.38, "wheel": 0.0, "pulley": 0.0, "oval": 0.0, "slide": 0.0, "lifter": 0.24
        },
        "solver": { "tolerance": 1e-9, "method": "reduced", "fem_step": 1e-5, "tables": true },
        "experiment": { "stop_time": 1.0, "step_size": 1e-3 }
    })
}

/// Where one instance of each definition of the schema stands in the full mechanism.
const LEVELS: [(&str, &str); 22] = [
    ("", ""),
    ("units", "/units"),
    ("gravity", "/gravity"),
    ("body", "/bodies/crank"),
    ("drawn", "/bodies/slider/drawn"),
    ("joint", "/joints/guide"),
    ("coupling", "/couplings/mesh"),
    ("cam_segment", "/couplings/cam/segments/0"),
    ("actuator", "/actuators/cylinder"),
    ("force", "/forces/push"),
    ("torque", "/torques/motor"),
    ("spring", "/springs/coil"),
    ("marker", "/markers/eye"),
    ("friction", "/friction"),
    ("air", "/air"),
    ("surface", "/surfaces/vane"),
    ("stop", "/stops/up"),
    ("lock", "/locks/latch"),
    ("start", "/start"),
    ("solver", "/solver"),
    ("experiment", "/experiment"),
    ("ground", "/bodies/ground"),
];

fn definition(schema: &Value, name: &str) -> Value {
    if name.is_empty() { schema.clone() } else { schema["$defs"][name].clone() }
}

fn refusal(mechanism: &Value) -> Option<String> {
    Mechanism::from_json(&mechanism.to_string()).err().map(|e| e.to_string())
}

/// The names in backticks after a word of serde's message.
fn names_after<'a>(message: &'a str, word: &str) -> BTreeSet<&'a str> {
    let rest = message.split_once(word).unwrap_or_else(|| panic!("`{message}` lacks `{word}`")).1;
    rest.split('`').skip(1).step_by(2).collect()
}

fn keys(object: &Value) -> BTreeSet<&str> {
    object.as_object().unwrap().keys().map(String::as_str).collect()
}

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
        let known = names_after(&message, "expected");
        if name == "ground" {
            // A body like others to the parser; the rest of its keys is refused by the check that follows.
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
            assert_eq!(message.contains(&format!("missing field `{key}`")), required.contains(key), "{path}/{key}");
            // Where a key is missing to others, geometry included, the schema may see less than the check but not more.
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
        assert_eq!(names_after(&message, "expected"), choices, "{path}/{key}");
    }
}

/// A default that is written down changes nothing.
#[test]
fn defaults_agree() {
    let schema = schema();
    // One load and one spring of either kind, and nothing that has a default.
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
        // An efficiency that is stated has an event indicator.
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
            let mut mechanism = plain.clone();
            if mechanism.pointer(path).is_none() {
                // A section that is left out: as its own default says.
                mechanism[name] = definition["default"].clone();
            }
            let element = mechanism.pointer_mut(path).unwrap();
            if element.get(key).is_some() {
                continue;
            }
            element[key] = default.clone();
            if refusal(&mechanism).is_some() {
                // Does not go with this element's other keys, or with the joint that it names.
                let in_joint = mechanism.pointer(path).unwrap().get("joint").is_some();
                assert!(in_joint || !validator().is_valid(&mechanism), "{path}/{key} = {default}");
                continue;
            }
            let now = read(&mechanism);
            assert_eq!(now.len(), before.len(), "{path}/{key} = {default}");
            for ((name, value), (same, known)) in now.iter().zip(&before) {
                assert_eq!(name, same, "{path}/{key} = {default}");
                // A default that is stated may be computed with, as an efficiency of 1: then the last digits differ, by
                // as much as the tables resolve of values that are of the order of 10 here, accelerations of 100. Derivatives of
                // the holding force and of the reduced mass are slopes of polynomials: each of two tables of one function
                // misses its exact slope by up to 6e-12 of the largest.
                let resolved = if name.ends_with("_derivative") { 1e-11 } else { 1e-13 };
                let miss = (value - known).abs();
                assert!(
                    miss <= resolved * known.abs().max(10.0),
                    "{path}/{key} = {default}: {name} {value}, not {known}"
                );
            }
            compared += 1;
        }
    }
    assert!(compared >= 30, "{compared} defaults compared");
}

/// Wrong values, by where they are put into the full mechanism: refused by both, or by the engine alone where the
/// schema cannot know.
#[test]
fn both_refuse_what_is_wrong() {
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

/// Put a part of a file into a whole one: entries of groups one by one, other keys as they are.
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
    let mut above = Value::Null;
    let (mut wholes, mut parts) = (0, 0);
    for block in FORMAT.split("```json\n").skip(1) {
        let text = block.split_once("```").unwrap().0;
        let example: Value = serde_json::from_str(text).unwrap_or_else(|e| panic!("{e} in\n{text}"));
        let whole = if example.get("name").is_some() {
            above = example;
            wholes += 1;
            above.clone()
        } else {
            // As the text says: into the whole file that stands last above it.
            let mut whole = above.clone();
            add_part(&mut whole, &example);
            parts += 1;
            whole
        };
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
            // As the text says of reactions where branches cross.
            let is_of_exchange = whole["solver"]["method"] == "rigid_fem" && variable.name.starts_with("along_curve.");
            let may_be_undefined = crosses && variable.name.contains(".force") || is_of_exchange;
            let reason = model.undefined(reference);
            assert!(value.is_finite() || may_be_undefined, "{} = {value}, {reason:?} in\n{text}", variable.name);
        }
        let lost = model.real(drift).unwrap();
        assert!(lost.abs() < 1e-6, "energy.drift {lost} J in\n{text}");
    }
    assert!(wholes >= 3 && parts >= 10, "{wholes} whole mechanisms and {parts} parts found");
}

/// The keys of a schema with numbers alone where expressions are allowed too.
fn without_expressions(schema: &mut Value) {
    match schema {
        Value::Object(object) => {
            if object.get("type") == Some(&json!(["number", "string"])) {
                object["type"] = json!("number");
            }
            object.values_mut().for_each(without_expressions);
        }
        Value::Array(list) => list.iter_mut().for_each(without_expressions),
        _ => {}
    }
}

/// The circuit of a drive is that of a hydraulic actuator, which may be left out, but for expressions.
#[test]
fn a_circuit_is_described_once() {
    let mut actuator: Value =
        serde_json::from_str(include_str!("../../modelDescription/hydraulics.schema.json")).unwrap();
    let circuit = actuator["properties"]["circuit"].as_object_mut().unwrap();
    assert_eq!(circuit.remove("default"), Some(json!({})));
    let mut of_drive = schema()["$defs"]["circuit"].clone();
    without_expressions(&mut of_drive);
    assert_eq!(of_drive.as_object().unwrap(), circuit);
}

#[test]
fn the_documented_keys_are_all_keys() {
    let schema = schema();
    for (name, _) in LEVELS {
        for key in keys(&definition(&schema, name)["properties"]) {
            assert!(FORMAT.contains(&format!("`{key}`")), "FORMAT.md does not explain {name}.{key}");
        }
    }
}
