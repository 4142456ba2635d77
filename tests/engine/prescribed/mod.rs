//! Prescribed motion of a drive: closed forms of kinematics and force, inverse against forward dynamics, the energy
//! balance, switches between motion and force, and impossible motions.
mod forces;
mod limits;
mod profiles;
mod small_steps;
mod switches;

use crate::support::definition::{self, G, With, block, rod, weight};
use crate::support::{GEAR, Run, changed};
use serde_json::{Value, json};
use std::f64::consts::PI;

const MASS: f64 = 2.0;

/// A mass on a vertical slide, lifted by a drive with this motion.
fn lift(motion: &Value) -> Value {
    block(MASS).with(json!({
        "joints": { "slide": { "axis_angle": PI / 2.0 } }, "start": { "position": 0.5 }, "gravity": weight(),
        "actuators": { "winch": { "joint": "slide", "motion": motion } },
    }))
}

/// A crank of radius 0.1 m with a rod of 0.35 m without mass and a piston of 3 kg, driven by a torque on the crank.
fn slider_crank(motion: &Value) -> Value {
    let bodies = [rod(0.1, 1.5), rod(0.35, 0.0), json!({ "mass": 3 })];
    let motor = json!({ "joint": "bearing", "motion": motion });
    definition::slider_crank(bodies, 0.3).with(json!({ "actuators": { "motor": motor } }))
}

fn opened(definition: &Value) -> Run {
    Run::new(definition)
}

/// The gear whose actuator has a prescribed motion, and further changes.
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
