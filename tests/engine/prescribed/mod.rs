//! Prescribed motion of a drive: closed forms of kinematics and force, inverse against forward dynamics, the energy
//! balance, switches between motion and force, and what a mechanism cannot do.
mod forces;
mod limits;
mod profiles;
mod switches;

use crate::support::{GEAR, Run, changed};
use serde_json::{Value, json};
use std::f64::consts::PI;

const MASS: f64 = 2.0;
const G: f64 = 9.81;

/// A mass on a vertical slide, lifted by a drive with this motion.
fn lift(motion: &Value) -> Value {
    json!({
        "name": "Lift",
        "bodies": { "ground": {}, "load": { "mass": MASS, "inertia": 1, "center": [0, 0] } },
        "joints": {
            "slide": {
                "type": "prismatic", "first": "ground.origin", "second": "load.origin", "axis_angle": PI / 2.0,
                    "angle": 0,
            },
        },
        "actuators": { "winch": { "joint": "slide", "motion": motion } },
        "guess": { "slide": 0 },
        "start": { "joint": "slide", "position": 0.5, "speed": 0 },
        "gravity": { "acceleration": G, "up_angle": PI / 2.0 },
    })
}

/// A crank of radius 0.1 m with a rod of 0.35 m without mass and a piston of 3 kg, driven by a torque on the crank.
fn slider_crank(motion: &Value) -> Value {
    json!({
        "name": "SliderCrank",
        "bodies": {
            "ground": {},
            "crank": { "length": 0.1, "mass": 1.5, "shape": "uniform_rod" },
            "rod": { "length": 0.35, "mass": 0, "shape": "uniform_rod" },
            "piston": { "mass": 3, "inertia": 0, "center": [0, 0] },
        },
        "joints": {
            "bearing": { "type": "revolute", "first": "ground.origin", "second": "crank.origin" },
            "pin": { "type": "revolute", "first": "crank.end", "second": "rod.origin" },
            "wrist": { "type": "revolute", "first": "rod.end", "second": "piston.origin" },
            "slide": {
                "type": "prismatic", "first": "ground.origin", "second": "piston.origin", "axis_angle": 0, "angle": 0,
            },
        },
        "actuators": { "motor": { "joint": "bearing", "motion": motion } },
        "guess": { "crank": 0.3, "rod": -0.1, "slide": 0.44 },
        "start": { "body": "crank", "angle": 0.3, "speed": 0 },
    })
}

fn opened(definition: &Value) -> Run {
    Run::new(&definition.to_string())
}

/// The gear whose actuator has a motion, with more changes.
fn gear(motion: &Value, change: impl FnOnce(&mut Value)) -> Run {
    let text = changed(GEAR, |gear| {
        gear["actuators"]["actuator"]["motion"] = motion.clone();
        gear["solver"] = json!({ "tolerance": 1e-10 });
        change(gear);
    });
    Run::new(&text)
}

/// Length of the actuator from gear down to gear up.
fn stroke() -> f64 {
    let at = |angle| Run::gear().with(&[("crank.start_angle", angle)]).started().get("actuator.length");
    at(-1.3) - at(0.8)
}

#[track_caller]
fn is_close(value: f64, exact: f64, size: f64) {
    assert!((value - exact).abs() <= size, "{value} for {exact}: {:e}", value - exact);
}
