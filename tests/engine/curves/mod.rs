//! Dampers and drives with a curve over the speed, bumpers with a curve over the depth, springs with a curve over
//! several revolutions: against closed forms, Runge-Kutta's method, the energy, and constant loads of the same size.
mod alike;
mod bumpers;
mod points;
mod speed;
mod springs;

use serde_json::{Value, json};

/// Mass of the carriage [kg], moment of inertia of the wheel [kg.m2].
const MASS: f64 = 3.0;

/// A carriage on a level rail, or a wheel on a bearing, with a start position and a start speed.
fn body(is_rotary: bool, [start, speed]: [f64; 2]) -> Value {
    let (joint, mass, at) = match is_rotary {
        true => (json!({ "type": "revolute" }), json!({ "mass": 1, "inertia": MASS }), json!({ "body": "part" })),
        false => (json!({ "type": "prismatic", "axis_angle": 0 }), json!({ "mass": MASS }), json!({ "joint": "way" })),
    };
    let (mut joint, mut at) = (joint, at);
    (joint["first"], joint["second"]) = (json!("ground.origin"), json!("part.origin"));
    at[if is_rotary { "angle" } else { "position" }] = json!(start);
    at["speed"] = json!(speed);
    let guess = if is_rotary { json!({ "part": start }) } else { json!({ "way": start }) };
    json!({
        "name": "Part", "bodies": { "ground": {}, "part": mass }, "joints": { "way": joint }, "start": at,
            "guess": guess,
        "solver": { "tolerance": 1e-12 },
    })
}

/// Names of position and speed.
fn names(is_rotary: bool) -> [&'static str; 2] {
    if is_rotary { ["part.angle", "part.speed"] } else { ["way.position", "way.speed"] }
}

/// A state after a time by the classical Runge-Kutta method, in so many steps.
fn runge_kutta<const N: usize>(
    rate: impl Fn(f64, [f64; N]) -> [f64; N],
    start: [f64; N],
    span: f64,
    steps: u32,
) -> [f64; N] {
    let (mut y, h) = (start, span / f64::from(steps));
    for step in 0..steps {
        let t = h * f64::from(step);
        let add = |k: [f64; N], part: f64| std::array::from_fn(|i| y[i] + part * h * k[i]);
        let k1 = rate(t, y);
        let k2 = rate(t + 0.5 * h, add(k1, 0.5));
        let k3 = rate(t + 0.5 * h, add(k2, 0.5));
        let k4 = rate(t + h, add(k3, 1.0));
        y = std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
    }
    y
}
