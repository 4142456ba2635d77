//! The schema, the examples of the reference, and a mechanism with every element.

use jsonschema::Validator;
use linkage_fmu::mechanism::definition::Mechanism;
use serde_json::Value;
use std::collections::BTreeSet;
use std::sync::LazyLock;

const SCHEMA: &str = include_str!("../../../modelDescription/mechanism.schema.json");

pub fn schema() -> Value {
    serde_json::from_str(SCHEMA).unwrap()
}

pub fn validator() -> &'static Validator {
    static VALIDATOR: LazyLock<Validator> = LazyLock::new(|| jsonschema::draft202012::new(&schema()).unwrap());
    &VALIDATOR
}

/// A mechanism with every element and, taken together, every key that can be combined with others.
pub fn full() -> Value {
    serde_json::from_str(include_str!("full.json")).unwrap()
}

/// Path of one instance of each definition of the schema in the full mechanism.
pub const LEVELS: [(&str, &str); 22] = [
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

pub fn definition(schema: &Value, name: &str) -> Value {
    if name.is_empty() { schema.clone() } else { schema["$defs"][name].clone() }
}

pub fn refusal(mechanism: &Value) -> Option<String> {
    Mechanism::from_json(&mechanism.to_string()).err().map(|e| e.to_string())
}

/// The names in backticks after a word of a message.
pub fn names_after<'a>(message: &'a str, word: &str) -> BTreeSet<&'a str> {
    let rest = message.split_once(word).unwrap_or_else(|| panic!("`{message}` lacks `{word}`")).1;
    rest.split('`').skip(1).step_by(2).collect()
}

pub fn keys(object: &Value) -> BTreeSet<&str> {
    object.as_object().unwrap().keys().map(String::as_str).collect()
}
