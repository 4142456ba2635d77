//! Couplings of variable ratio against closed forms and the Newton-Euler equations: elliptic gears, and cams with
//! followers that slide or rotate, with rollers or flat faces.
mod elliptic_gears;
mod followers;
mod laws;
mod refusals;

pub use followers::lift;

use crate::support::definition::With;
use serde_json::{Value, json};
use std::f64::consts::PI;

/// Two elliptic gears 0.3 m apart along the direction 0.4 rad; inertias 0.02 and 0.05 kg.m2, masses 2 and 3 kg.
pub fn elliptic(keys: Value) -> String {
    let coupling = json!({ "type": "elliptic_gears", "first": "one.origin", "second": "two.origin" }).with(keys);
    json!({ "name": "Elliptic",
        "bodies": { "ground": { "points": { "far": [0.3 * 0.4_f64.cos(), 0.3 * 0.4_f64.sin()] } },
            "one": { "mass": 2, "inertia": 0.02 }, "two": { "mass": 3, "inertia": 0.05 } },
        "joints": { "a": { "type": "revolute", "first": "ground.origin", "second": "one.origin" },
            "b": { "type": "revolute", "first": "ground.far", "second": "two.origin" } },
        "couplings": { "mesh": coupling },
        "torques": { "motor": { "on": "one", "torque": 0.8 }, "load": { "on": "two", "torque": -0.3 } },
        "solver": { "tolerance": 1e-12 },
        "start": { "body": "one", "angle": 0.4, "speed": 5 }, "guess": { "one": 0.4, "two": 2.0 } })
    .to_string()
}

/// Segments of a cam: rise, dwell, return, dwell.
fn segments(law: &str, rise: f64) -> Value {
    json!([{ "law": law, "angle": 1.6, "rise": rise }, { "law": "dwell", "angle": 0.7 }, { "law": law, "angle": 2.2,
        "rise": -rise },
        { "law": "dwell" }])
}

/// A cam of 1.2 kg and 0.004 kg.m2 at (0.05, -0.02) with an eccentric centre of mass, and a follower of 0.6 kg with a
/// spring. The follower slides upward at an offset of 0.012 m from the axis of the cam.
pub fn translating(law: &str, follower: Value) -> String {
    let coupling = json!({ "type": "cam", "first": "disc.origin", "joint": "guide", "contact": "stem.tip",
        "base_radius": 0.04, "start_angle": 0.5, "segments": segments(law, 0.02) })
    .with(follower);
    json!({ "name": "Translating", "gravity": { "acceleration": 9.81, "up_angle": PI / 2.0 },
        "bodies": { "ground": { "points": { "axis": [0.05, -0.02], "guide": [0.062, 0.2] } },
            "disc": { "mass": 1.2, "inertia": 0.004, "center": [0.005, 0.002] },
            "stem": { "mass": 0.6, "points": { "tip": [0.0, -0.08] } } },
        "joints": { "bearing": { "type": "revolute", "first": "ground.axis", "second": "disc.origin" },
            "guide": { "type": "prismatic", "first": "ground.guide", "second": "stem.origin",
                "axis_angle": PI / 2.0 } },
        "couplings": { "cam": coupling },
        "springs": { "spring": { "joint": "guide", "stiffness": 1000, "free_length": -0.12 } },
        "torques": { "motor": { "on": "disc", "torque": 0.5 } },
        "solver": { "tolerance": 1e-14 },
        "start": { "body": "disc", "angle": 0.1, "speed": 40 }, "guess": { "disc": 0.1, "guide": -0.1 } })
    .to_string()
}

pub const ROLLER: &str = r#"{ "follower": "roller", "roller_radius": 0.01 }"#;

pub fn parsed(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

/// A cam of 0.004 kg.m2 at the origin and a lever of 0.16 m with its pivot at (0.14, 0.03).
pub fn oscillating(law: &str, follower: Value) -> String {
    let coupling = json!({ "type": "cam", "first": "disc.origin", "second": "lever.origin", "contact": "lever.end",
        "base_radius": 0.04, "start_angle": -0.3, "segments": segments(law, 0.25) })
    .with(follower);
    json!({ "name": "Oscillating",
        "bodies": { "ground": { "points": { "pivot": [0.14, 0.03] } },
            "disc": { "mass": 1.2, "inertia": 0.004 },
            "lever": { "length": 0.16, "mass": 0.3, "shape": "uniform_rod" } },
        "joints": { "bearing": { "type": "revolute", "first": "ground.origin", "second": "disc.origin" },
            "pin": { "type": "revolute", "first": "ground.pivot", "second": "lever.origin" } },
        "couplings": { "cam": coupling },
        "torques": { "motor": { "on": "disc", "torque": -0.5 }, "load": { "on": "lever", "torque": 1.5 } },
        "solver": { "tolerance": 1e-12 },
        "start": { "body": "disc", "angle": 0.1, "speed": -15 }, "guess": { "disc": 0.1, "lever": 2.8 } })
    .to_string()
}
