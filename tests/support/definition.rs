//! Short definitions of small machines, to which a test adds keys.
use serde_json::{Value, json};
use std::f64::consts::FRAC_PI_2;

/// Standard acceleration of the tests [m/s2].
pub const G: f64 = 9.81;

/// A definition with additional keys.
pub trait With {
    /// Objects are joined key by key, everything else is replaced.
    fn with(self, more: Value) -> Value;
}

impl With for Value {
    fn with(mut self, more: Value) -> Value {
        join(&mut self, more);
        self
    }
}

fn join(into: &mut Value, more: Value) {
    match (into, more) {
        (Value::Object(into), Value::Object(more)) => {
            more.into_iter().for_each(|(key, value)| join(into.entry(key).or_insert(Value::Null), value));
        }
        (into, more) => *into = more,
    }
}

/// Gravity downward, against the y axis.
pub fn weight() -> Value {
    json!({ "acceleration": G, "up_angle": FRAC_PI_2 })
}

pub fn pin(first: &str, second: &str) -> Value {
    json!({ "type": "revolute", "first": first, "second": second })
}

pub fn slide(first: &str, second: &str, axis_angle: f64) -> Value {
    json!({ "type": "prismatic", "first": first, "second": second, "axis_angle": axis_angle })
}

pub fn rod(length: f64, mass: f64) -> Value {
    json!({ "length": length, "mass": mass, "shape": "uniform_rod" })
}

/// Friction with a static and a kinetic coefficient, up to and from these slip speeds [m/s].
pub fn friction([low, high]: [f64; 2], [first, last]: [f64; 2]) -> Value {
    json!({ "enabled": true, "static_coefficient": low, "kinetic_coefficient": high,
        "static_speed": first, "kinetic_speed": last })
}

/// A block of a mass [kg] on a slide of the ground along x, at rest at 0.
pub fn block(mass: f64) -> Value {
    json!({
        "name": "Block",
        "bodies": { "ground": {}, "block": { "mass": mass } },
        "joints": { "slide": slide("ground.origin", "block.origin", 0.0) },
        "start": { "joint": "slide", "position": 0 }, "guess": { "slide": 0 },
    })
}

/// A wheel of a moment of inertia [kg.m2] on a hub at the origin, at rest at 0.
pub fn wheel(inertia: f64) -> Value {
    json!({
        "name": "Wheel",
        "bodies": { "ground": {}, "wheel": { "inertia": inertia } },
        "joints": { "hub": pin("ground.origin", "wheel.origin") },
        "start": { "body": "wheel", "angle": 0 }, "guess": { "wheel": 0 },
    })
}

/// A uniform rod on a pivot at the origin, at rest at an angle [rad].
pub fn arm(length: f64, mass: f64, angle: f64) -> Value {
    json!({
        "name": "Arm",
        "bodies": { "ground": {}, "arm": rod(length, mass) },
        "joints": { "pivot": pin("ground.origin", "arm.origin") },
        "start": { "body": "arm", "angle": angle }, "guess": { "arm": angle },
    })
}

/// A slider-crank from its bodies: a crank on a bearing at the origin, a rod, and a slider on a guide along x through
/// the origin. `angle` is start and guess of the crank [rad].
pub fn slider_crank([crank, rod, slider]: [Value; 3], angle: f64) -> Value {
    let [r, l] = [&crank, &rod].map(|body| body["length"].as_f64().unwrap());
    let lean = -(r * angle.sin() / l).asin();
    json!({
        "name": "SliderCrank",
        "bodies": { "ground": {}, "crank": crank, "rod": rod, "slider": slider },
        "joints": {
            "bearing": pin("ground.origin", "crank.origin"),
            "pin": pin("crank.end", "rod.origin"),
            "wrist": pin("rod.end", "slider.origin"),
            "guide": slide("ground.origin", "slider.origin", 0.0),
        },
        "start": { "body": "crank", "angle": angle },
        "guess": { "crank": angle, "rod": lean, "guide": r * angle.cos() + l * lean.cos() },
    })
}

/// A four-bar of uniform rods of 1 kg/m: lengths of ground, crank, coupler and rocker [m], and angles of the three
/// bodies at the guess [rad]. The start is the guess of the crank.
pub fn four_bar([ground, crank, coupler, rocker]: [f64; 4], guess: [f64; 3]) -> Value {
    json!({
        "name": "FourBar",
        "bodies": { "ground": { "length": ground }, "crank": rod(crank, crank), "coupler": rod(coupler, coupler),
            "rocker": rod(rocker, rocker) },
        "joints": {
            "a": pin("ground.origin", "crank.origin"), "b": pin("crank.end", "coupler.origin"),
            "c": pin("coupler.end", "rocker.end"), "d": pin("ground.end", "rocker.origin"),
        },
        "start": { "body": "crank", "angle": guess[0] },
        "guess": { "crank": guess[0], "coupler": guess[1], "rocker": guess[2] },
    })
}
