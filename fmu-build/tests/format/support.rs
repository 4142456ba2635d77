//! The schema, the examples of the reference, and a mechanism with every element.

use jsonschema::Validator;
use linkage_fmu::mechanism::definition::Mechanism;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::fs;
use std::sync::LazyLock;

const SCHEMA: &str = include_str!("../../../modelDescription/mechanism.schema.json");
/// The pages of the elements.
const PAGES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/reference/mechanism");

/// The JSON blocks of the pages, each with its page and its complete file: the last complete file above it on the page,
/// or the file in `files` that the page names.
pub fn examples() -> Vec<(String, Value, Value)> {
    let mut pages: Vec<_> = fs::read_dir(PAGES).unwrap().map(|page| page.unwrap().path()).collect();
    pages.sort();
    let mut all = Vec::new();
    for path in pages {
        let (page, text) = (path.file_name().unwrap().to_string_lossy(), fs::read_to_string(&path).unwrap());
        let base = text.split_once("](../files/").and_then(|(_, rest)| rest.split_once(')'));
        let read = |text: &str| serde_json::from_str(text).unwrap_or_else(|e| panic!("{page}: {e} in\n{text}"));
        let mut whole = base.map_or(Value::Null, |(name, _)| {
            read(&fs::read_to_string(path.parent().unwrap().join("../files").join(name)).unwrap())
        });
        for block in text.split("```json\n").skip(1) {
            let example: Value = read(block.split_once("```").unwrap().0);
            if example.get("name").is_some() {
                whole = example.clone();
            }
            all.push((page.to_string(), whole.clone(), example));
        }
    }
    all
}

pub fn schema() -> Value {
    serde_json::from_str(SCHEMA).unwrap()
}

pub fn validator() -> &'static Validator {
    static VALIDATOR: LazyLock<Validator> = LazyLock::new(|| jsonschema::draft202012::new(&schema()).unwrap());
    &VALIDATOR
}

/// A mechanism with every element and, taken together, every key that can be combined with others.
pub fn full() -> Value {
    json!({
        "$schema": "mechanism.schema.json", "name": "Full", "description": "d",
        "about": { "author": "A", "copyright": "C", "license": "L" },
        "units": { "angle": "rad", "length": "m" },
        "gravity": { "acceleration": 9.81, "up_angle": 1.5, "load_factor": 1 },
        "bodies": {
            "ground": {
                "length": 1.0,
                "points": {
                    "anchor": [0.3, -2.0], "shaft": [-0.5, 0.0], "pulley": [0.0, 0.6], "oval": [0.7, 0.7],
                        "bed": [0.0, -0.05],
                    "lifter": [0.0, -0.3]
                }
            },
            "crank": { "length": 0.1, "mass": 1.2, "shape": "uniform_rod", "points": { "eye": [0.05, 0.02] } },
            "weight": { "fixed_to": "crank.origin", "angle": 3.0, "mass": 0.3, "center": [0.02, 0.0],
                "inertia": 0.001 },
            "rod": { "length": 0.3, "mass": 0.9, "shape": "uniform_rod", "axial_stiffness": 1e7 },
            "slider": {
                "mass": 0.5,
                "drawn": { "origin": [0.38, 0.0], "angle": 0.0, "points": { "lug": [0.38, 0.05] }, "center": [0.38,
                    0.01] }
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
                "type": "prismatic", "first": "ground.origin", "second": "slider.origin", "axis_angle": 0.0,
                    "angle": 0.0,
                "static_coefficient": 0.1, "kinetic_coefficient": 0.05
            },
            "wheel_pin": { "type": "revolute", "first": "ground.shaft", "second": "wheel.origin" },
            "pulley_pin": { "type": "revolute", "first": "ground.pulley", "second": "pulley.origin" },
            "oval_pin": { "type": "revolute", "first": "ground.oval", "second": "oval.origin" },
            "slide": { "type": "prismatic", "first": "ground.bed", "second": "table.origin" },
            "lifter": {
                "type": "prismatic", "first": "ground.lifter", "second": "tappet.origin",
                    "axis_angle": std::f64::consts::FRAC_PI_2
            }
        },
        "couplings": {
            "mesh": {
                "type": "gears", "first": "crank.origin", "second": "wheel.origin", "first_teeth": 20,
                    "second_teeth": 40,
                "pressure_angle": 0.0
            },
            "belt": {
                "type": "belt", "first": "crank.origin", "second": "pulley.origin", "first_radius": 0.05,
                    "second_radius": 0.1
            },
            "ovals": {
                "type": "elliptic_gears", "first": "crank.origin", "second": "oval.origin", "eccentricity": 0.2,
                "pressure_angle": 0.0
            },
            "rack": {
                "type": "rack", "first": "crank.origin", "joint": "slide", "radius": 0.05, "pressure_angle": 0.0
            },
            "cam": {
                "type": "cam", "first": "crank.origin", "joint": "lifter", "follower": "roller",
                    "contact": "tappet.origin",
                "base_radius": 0.05, "roller_radius": 0.01,
                "segments": [
                    { "law": "cycloidal", "angle": 2.0, "rise": 0.01 }, { "law": "polynomial_345", "angle": 2.0,
                        "rise": -0.01 },
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
                "first": "ground.anchor", "second": "slider.origin", "stiffness": 1.0, "damping": 0.1,
                    "free_length": 0.2,
                "preload": 1.0
            },
            "torsion": { "joint": "bearing", "stiffness": 1.0, "free_angle": 0.3 }
        },
        "markers": { "eye": { "at": "crank.eye" } },
        "friction": {
            "enabled": true, "static_coefficient": 0.2, "kinetic_coefficient": 0.1, "static_speed": 0.02,
                "kinetic_speed": 0.9
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
            "crank": 0.5, "rod": -0.16, "guide": 0.38, "wheel": 0.0, "pulley": 0.0, "oval": 0.0, "slide": 0.0,
                "lifter": 0.24
        },
        "solver": { "tolerance": 1e-9, "method": "reduced", "fem_step": 1e-5, "tables": true },
        "experiment": { "stop_time": 1.0, "step_size": 1e-3 }
    })
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
