//! Invalid couplings are rejected and doubtful ones reported as warnings, with the key in the message.
use super::{FIVE_BAR, GEARS, shafts};
use crate::support::{Run, assert_rejected, assert_says, changed, refusal, replaced};
use serde_json::json;

#[test]
fn impossible_couplings_are_rejected() {
    assert_rejected("couplings", shafts(GEARS));
    let one_axle = replaced(&shafts(GEARS), &[("[0.18, 0.24]", "[0, 0]")]);
    assert_says(refusal(one_axle), &["couplings.mesh.second", "distance"]);
}

#[test]
fn the_other_formulation_names_the_coupling() {
    let text = changed(FIVE_BAR, |m| {
        m["solver"] = json!({ "method": "rigid_fem", "tolerance": 1e-9, "fem_step": 1e-5 });
        for body in ["one", "two", "rod", "bar"] {
            m["bodies"][body]["axial_stiffness"] = json!(1e9);
        }
    });
    assert_says(refusal(&text), &["mesh", "gears", "solver.method = \"reduced\""]);
}

/// A planet of 24 teeth fits between a sun of 24 and a ring of 72. With a ring of 100 it would need two pitch circles.
#[test]
fn a_wheel_with_two_pitch_circles_gives_a_warning() {
    let train = |ring: u32, second: u32| {
        json!({
            "name": "Planetary",
            "bodies": {
                "ground": {}, "sun": { "mass": 1, "inertia": 0.01 },
                "arm": { "length": 0.1, "mass": 1, "inertia": 0.02 }, "planet": { "mass": 0.7, "inertia": 0.003 }
            },
            "joints": {
                "shaft": { "type": "revolute", "first": "ground.origin", "second": "sun.origin" },
                "output": { "type": "revolute", "first": "ground.origin", "second": "arm.origin" },
                "pin": { "type": "revolute", "first": "arm.end", "second": "planet.origin" }
            },
            "couplings": {
                "inner": { "type": "gears", "first": "sun.origin", "second": "planet.origin", "carrier": "arm",
                           "first_teeth": 24, "second_teeth": 24 },
                "outer": { "type": "gears", "first": "ground.origin", "second": "planet.origin", "carrier": "arm",
                           "first_teeth": ring, "second_teeth": second, "internal": true }
            },
            "start": { "body": "sun", "angle": 0 },
            "guess": { "sun": 0, "arm": 0, "planet": 0 }
        })
    };
    let warned = |ring: u32, second: u32| Run::new(train(ring, second)).warnings();
    assert_eq!(warned(72, 24), Vec::<String>::new());
    // A stepped planet has different numbers of teeth on its two wheels.
    assert_eq!(warned(100, 20), Vec::<String>::new());
    let all = warned(100, 24);
    assert_eq!(all.len(), 1, "{all:?}");
    // 0.1 m x 24 / (100 - 24), and half of 0.1 m.
    assert_says(
        &all[0],
        &["couplings.outer.second_teeth", "planet", "0.0315789", "couplings.inner", "0.05 m", "two planets"],
    );
}
