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
pub fn five_bar() -> String {
    r#"{ "name": "FiveBar", "gravity": { "acceleration": 9.81, "up_angle": 1.5707963267948966 },
      "bodies": { "ground": { "length": 0.3 },
        "one": { "length": 0.1, "mass": 1.5, "shape": "uniform_rod" }, "two": { "length": 0.12, "mass": 2,
            "shape": "uniform_rod" },
        "rod": { "length": 0.35, "mass": 0.8, "shape": "uniform_rod" }, "bar": { "length": 0.4, "mass": 0.9,
            "shape": "uniform_rod" } },
      "joints": { "a": { "type": "revolute", "first": "ground.origin", "second": "one.origin" },
        "b": { "type": "revolute", "first": "ground.end", "second": "two.origin" },
        "c": { "type": "revolute", "first": "one.end", "second": "rod.origin" },
        "d": { "type": "revolute", "first": "two.end", "second": "bar.origin" },
        "e": { "type": "revolute", "first": "rod.end", "second": "bar.end" } },
      "couplings": { "mesh": { "type": "gears", "first": "one.origin", "second": "two.origin", "first_teeth": 20,
          "second_teeth": 40 } },
      "markers": { "tip": { "at": "rod.end" } },
      "torques": { "motor": { "on": "one" } }, "forces": { "push": { "at": "bar.end" } },
      "solver": { "tolerance": 1e-12 }, "start": { "body": "one", "angle": 0.6, "speed": 3 },
      "guess": { "one": 0.6, "two": 2.0, "rod": 0.9, "bar": 2.2 } }"#
        .into()
}
