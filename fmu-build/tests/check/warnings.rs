//! Warnings: each with its key, the value and the remedy. No warning without a reason.

use crate::support::{checked, found, slider_crank, with};
use fmu_build::check;
use linkage_fmu::inspection::Severity;
use serde_json::json;

#[test]
fn warnings_name_the_key_the_value_and_the_remedy() {
    for (path, value, key, shown, fragments) in [
        ("/gravity/up_angle", json!(90), "gravity.up_angle", "90", vec!["90 rad", "1.570796327 rad"]),
        ("/guess/crank", json!(28.6), "guess.crank", "28.6", vec!["4.55 turns", "degrees"]),
        ("/guess/rod", json!(2.5), "guess.rod", "2.5", vec!["from its guess of 2.5 rad"]),
        (
            "/stops",
            json!({ "up": { "joint": "guide", "limit": "upper", "position": 0.7 } }),
            "stops.up",
            "\"up\"",
            vec!["never reached", "0.3 m before"],
        ),
        (
            "/stops",
            json!({ "up": { "body": "rod", "limit": "upper", "angle": 115 } }),
            "stops.up.angle",
            "115",
            vec!["degrees", "2.00712864"],
        ),
        (
            "/stops",
            json!({ "up": { "joint": "guide", "limit": "upper", "position": 0.39, "rigid": false } }),
            "stops.up",
            "\"up\"",
            vec!["without stiffness, damping and points"],
        ),
        (
            "/stops",
            json!({ "up": { "joint": "guide", "limit": "upper", "position": 0.39, "rigid": true, "stiffness": 1e4 } }),
            "stops.up.stiffness",
            "10000.0",
            vec!["while the stop is rigid", "\"rigid\": false"],
        ),
        (
            "/friction",
            json!({ "static_coefficient": 0.2, "kinetic_coefficient": 0.1 }),
            "friction",
            "\"friction\"",
            vec!["`enabled` is missing", "\"enabled\": true"],
        ),
        (
            "/forces",
            json!({ "f": { "at": "ground.origin" } }),
            "forces.f.at",
            "\"ground.origin\"",
            vec!["has no effect"],
        ),
        ("/torques", json!({ "t": { "on": "ground" } }), "torques.t.on", "\"ground\"", vec!["give a body that moves"]),
        (
            "/bodies/rod",
            json!({ "length": 0.3, "shape": "uniform_rod" }),
            "bodies.rod.shape",
            "\"uniform_rod\"",
            vec!["has no mass"],
        ),
        (
            "/bodies/rod",
            json!({ "length": 0.3, "mass": 1, "center": [120, 5] }),
            "bodies.rod.center",
            "\"center\"",
            vec!["119.95", "0.3 m apart"],
        ),
    ] {
        let found = found(&with(path, value), Severity::Warning);
        let own = found.iter().find(|(place, ..)| place == key).unwrap_or_else(|| panic!("{key} in {found:#?}"));
        assert_eq!(own.2, shown, "{found:#?}");
        for fragment in fragments {
            assert!(own.1.contains(fragment), "`{}` lacks `{fragment}`", own.1);
        }
    }
}

/// A crank of 40 mm and 0.4 kg in a file without the key `length` in `units`.
#[test]
fn a_thin_body_may_be_stated_in_millimetres() {
    let pendulum = |length: f64| {
        json!({
            "name": "Pendulum",
            "bodies": { "ground": {}, "rod": { "length": length, "mass": 0.4, "shape": "uniform_rod" } },
            "joints": { "pin": { "type": "revolute", "first": "ground.origin", "second": "rod.origin" } },
            "start": { "body": "rod", "angle": 0 }, "guess": { "rod": 0 }
        })
    };
    let warned = found(&pendulum(40.0).to_string(), Severity::Warning);
    assert!(warned.len() == 1 && warned[0].1.contains("is 40 m long and has 0.4 kg; if you mean mill"), "{warned:#?}");
    assert!(found(&pendulum(4.0).to_string(), Severity::Warning).is_empty());
}

/// Two hinges of a door are one joint in the plane. They share its reaction, which is no fault.
#[test]
fn a_joint_that_is_given_twice_is_no_fault() {
    let hinge = json!({ "type": "revolute", "first": "rod.origin", "second": "crank.end" });
    assert_eq!(found(&with("/joints/second_pin", hinge), Severity::Warning), []);
}

#[test]
fn unused_friction_coefficients_give_a_warning() {
    let mut text = slider_crank();
    text["friction"] = json!({ "enabled": true, "static_coefficient": 0.2, "kinetic_coefficient": 0.1 });
    assert_eq!(found(&text.to_string(), Severity::Warning), [], "the guide rubs");
    // A four-bar has no prismatic joint.
    let text = include_str!("../../../modelDescription/FourBar/resources/mechanism.json").replacen(
        "\"forces\"",
        "\"friction\": { \"enabled\": true, \"static_coefficient\": 0.2, \"kinetic_coefficient\": 0.1 }, \"forces\"",
        1,
    );
    let found = found(&text, Severity::Warning);
    assert!(found.len() == 1 && found[0].1.contains("pin_radius"), "{found:#?}");
}

#[test]
fn millimetres_mixed_with_metres_give_a_warning() {
    let text = with("/bodies/extra", json!({ "fixed_to": "slider.origin", "length": 250 }));
    let found = found(&text, Severity::Warning);
    assert!(found.iter().any(|(place, text, _)| place == "bodies.extra" && text.contains("millimetres")), "{found:#?}");
}

#[test]
fn the_same_mechanism_without_cause_gives_no_warning() {
    for name in ["AndrewsSqueezer", "CraneJib", "FourBar", "FourBarChain", "Jib", "LandingGearRetraction", "SlCrank"] {
        let path = format!("{}/../modelDescription/{name}/resources/mechanism.json", env!("CARGO_MANIFEST_DIR"));
        let text = std::fs::read_to_string(path).unwrap();
        let all = checked(&text);
        assert_eq!(all.findings.len(), 0, "{}", check::findings(&all));
        assert!(!all.inspection.facts.is_empty());
    }
}

#[test]
fn settings_without_effect_give_a_warning() {
    let text = with("/experiment", json!({ "stop_time": 1.0, "step_size": 10.0 }));
    assert!(found(&text, Severity::Warning).iter().any(|(path, ..)| path == "experiment.step_size"));
    let text =
        with("/springs", json!({ "s": { "first": "ground.origin", "second": "slider.origin", "stiffness": 0 } }));
    assert!(found(&text, Severity::Warning).iter().any(|(path, ..)| path == "springs.s"));
}
