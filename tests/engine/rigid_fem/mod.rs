//! Rigid-link finite elements ([HF08] section 3): comparison with the reduced model, convergence, limits.
mod agreement;
mod both;
mod steps;

use crate::support::{FOUR_BAR, changed};
use serde_json::{Value, json};

/// theta2 of the gear with elastic rods minus theta2 with rigid rods at 0.13 s [rad]. Measured by these tests, which
/// show that it is proportional to 1 / (E A).
pub const ELASTIC_LIMIT: f64 = 1.389_484e-4;

/// A spring with a damper between the gear's ground and its wheel.
pub fn strut() -> Value {
    json!({ "first": "ground.end", "second": "wheel.origin", "stiffness": 4e3, "damping": 60, "free_length": 0.6,
        "preload": 50 })
}

/// The four-bar with masses of crank and rocker, fast enough for a full turn.
pub fn heavy_four_bar() -> String {
    changed(FOUR_BAR, |m| {
        for (body, length) in [("crank", 0.1), ("rocker", 0.25)] {
            m["bodies"][body] = json!({ "length": length, "mass": 0.5, "shape": "uniform_rod" });
        }
        m["start"]["speed"] = json!(25);
    })
}
