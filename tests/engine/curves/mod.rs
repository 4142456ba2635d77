//! Dampers and drives with a curve over speed, bumpers with a curve over depth, springs with a curve over several
//! revolutions. References: closed forms, Runge-Kutta integration, energy, constant loads of the same size.
mod alike;
mod bumpers;
mod points;
mod speed;
mod springs;

use crate::support::definition::{With, block, wheel};
use serde_json::{Value, json};

/// Mass of the carriage [kg], moment of inertia of the wheel [kg.m2].
const MASS: f64 = 3.0;

/// A carriage on a horizontal rail, or a wheel in a bearing, with its start position and start speed.
fn body(is_rotary: bool, [start, speed]: [f64; 2]) -> Value {
    let precise =
        |definition: Value, at: Value| definition.with(json!({ "start": at, "solver": { "tolerance": 1e-12 } }));
    if is_rotary {
        precise(wheel(MASS), json!({ "angle": start, "speed": speed })).with(json!({ "guess": { "wheel": start } }))
    } else {
        precise(block(MASS), json!({ "position": start, "speed": speed })).with(json!({ "guess": { "slide": start } }))
    }
}

/// Name of the joint.
fn joint(is_rotary: bool) -> &'static str {
    if is_rotary { "hub" } else { "slide" }
}

/// Names of position and speed.
fn names(is_rotary: bool) -> [&'static str; 2] {
    if is_rotary { ["wheel.angle", "wheel.speed"] } else { ["slide.position", "slide.speed"] }
}
