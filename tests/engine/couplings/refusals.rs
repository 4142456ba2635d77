//! Invalid couplings are rejected and doubtful ones reported as warnings, with the key in the message.
use super::{GEARS, five_bar, shafts};
use crate::support::{Run, assert_says, changed, refusal, replaced};
use serde_json::json;

#[test]
fn impossible_couplings_are_rejected() {
    let refused = |coupling: &str, pieces: &[&str]| {
        assert_says(refusal(shafts(coupling)), pieces);
    };
    refused(&GEARS.replace("43", "-43"), &["couplings.mesh.second_teeth", "-43", "> 0"]);
    refused(r#""type": "gears", "first_teeth": 20"#, &["couplings.mesh.second_teeth", "needs this key"]);
    refused(&format!(r#"{GEARS}, "crossed": true"#), &["couplings.mesh.crossed", "this type", "first_teeth"]);
    refused(&format!(r#"{GEARS}, "carrier": "two""#), &["couplings.mesh.second", "on two"]);
    refused(&format!(r#"{GEARS}, "carrier": "arm""#), &["couplings.mesh.carrier", "arm", "bodies"]);
    refused(&format!(r#"{GEARS}, "pressure_angle": 1.5"#), &["couplings.mesh.pressure_angle", "1.5", "1.2"]);
    refused(
        r#""type": "gears", "internal": true, "first_teeth": 20, "second_teeth": 20"#,
        &["internal", "the same number of teeth"],
    );
    refused(r#""type": "screw""#, &["couplings.mesh.type", "screw", "plane", "actuator"]);
    refused(r#""type": "belt", "first_radius": 0.5, "second_radius": 0.1"#, &["second_radius", "0.3 m apart", "0.4 m"]);
    refused(r#""type": "worm""#, &["worm", "gears", "rack", "belt"]);
    let moved = |from: &str, to: &str| refusal(replaced(&shafts(GEARS), &[(from, to)]));
    assert_says(
        moved(r#""second": "two.origin", "type""#, r#""second": "one.origin", "type""#),
        &["couplings.mesh.second", "one"],
    );
    assert_says(moved("[0.18, 0.24]", "[0, 0]"), &["couplings.mesh.second", "distance"]);
    let other = changed(shafts(GEARS), |m| m["bodies"]["two"]["points"] = json!({ "rim": [0.1, 0.0] }));
    let other =
        replaced(&other, &[(r#""second":"two.origin","second_teeth""#, r#""second":"two.rim","second_teeth""#)]);
    assert_says(refusal(other), &["two.rim", "has no revolute joint on ground", "revolute"]);
    // A second, different ratio between the same shafts leaves no degree of freedom.
    let twice = changed(shafts(GEARS), |m| {
        m["couplings"]["belt"] = json!({ "type": "belt", "first": "one.origin", "second": "two.origin",
            "first_radius": 0.05, "second_radius": 0.08 });
    });
    assert_says(refusal(twice), &["0 degrees of freedom", "coupling"]);
}

#[test]
fn the_other_formulation_names_the_coupling() {
    let text = changed(five_bar(), |m| {
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
