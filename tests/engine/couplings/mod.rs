//! Couplings against closed forms: gears, racks and belts, single, in trains and on a carrier.
mod refusals;
mod shafts;
mod trains;

/// Two shafts 0.3 m apart with one coupling of these keys: inertias 0.02 and 0.5 kg.m2, masses 2 and 5 kg.
pub fn shafts(coupling: &str) -> String {
    format!(
        r#"{{ "name": "Shafts", "gravity": {{ "acceleration": 9.81, "up_angle": 1.5707963267948966 }},
          "bodies": {{ "ground": {{ "points": {{ "far": [0.18, 0.24] }} }},
            "one": {{ "mass": 2, "inertia": 0.02 }}, "two": {{ "mass": 5, "inertia": 0.5 }} }},
          "joints": {{ "a": {{ "type": "revolute", "first": "ground.origin", "second": "one.origin" }},
            "b": {{ "type": "revolute", "first": "ground.far", "second": "two.origin" }} }},
          "couplings": {{ "mesh": {{ "first": "one.origin", "second": "two.origin", {coupling} }} }},
          "torques": {{ "motor": {{ "on": "one", "torque": 3 }}, "load": {{ "on": "two", "torque": -1 }} }},
          "start": {{ "body": "one", "angle": 0.4, "speed": 0 }}, "guess": {{ "one": 0.4, "two": 1.1 }} }}"#
    )
}

pub const GEARS: &str = r#""type": "gears", "first_teeth": 17, "second_teeth": 43"#;
pub const BELT: &str = r#""type": "belt", "first_radius": 0.05, "second_radius": 0.08"#;

#[track_caller]
fn assert_near(value: f64, expected: f64, scale: f64, what: &str) {
    assert!((value - expected).abs() <= 1e-13 * scale, "{what}: {value} instead of {expected}");
}

/// Geared five-bar linkage: cranks of 0.1 and 0.12 m with gears 2 : 1, rods of 0.35 and 0.4 m.
pub const FIVE_BAR: &str = include_str!("../../fixtures/five_bar.json");
