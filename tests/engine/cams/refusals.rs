//! Invalid cams and elliptic gears are rejected with the key in the message.
use super::{ROLLER, elliptic, oscillating, parsed, translating};
use crate::support::{Run, assert_says, changed, refusal};
use serde_json::{Value, json};

#[test]
fn wrong_cams_are_rejected() {
    let refused = |base: &str, key: &str, value: Value, pieces: &[&str]| {
        let text = changed(base, |m| match value {
            Value::Null => drop(m["couplings"]["cam"].as_object_mut().unwrap().remove(key)),
            value => m["couplings"]["cam"][key] = value,
        });
        assert_says(refusal(text), pieces);
    };
    let slides = &translating("cycloidal", parsed(ROLLER));
    let turns = &oscillating("cycloidal", parsed(ROLLER));
    refused(slides, "segments", Value::Null, &["couplings.cam", "no lift", "segments"]);
    refused(slides, "segments", json!([]), &["couplings.cam.segments"]);
    let dwell = json!([{ "law": "dwell", "angle": 1.0, "rise": 0.1 }, { "law": "dwell" }]);
    refused(slides, "segments", dwell, &["segments[0].rise", "dwell"]);
    let short = json!([{ "law": "dwell", "angle": 1.0 }, { "law": "dwell", "angle": 2.0 }]);
    refused(slides, "segments", short, &["couplings.cam.segments", "add up to 3 rad", "2 pi"]);
    let open = json!([{ "law": "cycloidal", "angle": 1.0, "rise": 0.02 }, { "law": "dwell" }]);
    refused(slides, "segments", open, &["couplings.cam.segments", "0.02", "return"]);
    let none = json!([{ "law": "cycloidal", "angle": 1.0 }, { "law": "dwell" }]);
    refused(slides, "segments", none, &["segments[0].rise", "missing"]);
    refused(
        slides,
        "points",
        json!([[0.0, 0.0], [1.0, 0.1], [2.0, 0.0]]),
        &["couplings.cam.points", "already defines the lift"],
    );
    refused(slides, "second", json!("disc.origin"), &["couplings.cam.second", "joint"]);
    refused(slides, "joint", Value::Null, &["couplings.cam", "no motion", "second"]);
    refused(slides, "joint", json!("bearing"), &["couplings.cam.joint", "prismatic", "follower"]);
    refused(slides, "roller_radius", Value::Null, &["couplings.cam.roller_radius", "needs this key"]);
    refused(slides, "face_angle", json!(0.0), &["couplings.cam.face_angle", "roller"]);
    refused(slides, "phase", json!(0.0), &["couplings.cam.phase", "base circle"]);
    refused(slides, "teeth", json!(3), &["teeth"]);
    refused(slides, "first_teeth", json!(3), &["couplings.cam.first_teeth", "base_radius"]);
    refused(slides, "contact", json!("disc.origin"), &["couplings.cam.contact", "on disc", "stem"]);
    refused(slides, "base_radius", json!(0.001), &["couplings.cam.base_radius", "0.012", "0.011"]);
    refused(turns, "base_radius", json!(0.5), &["couplings.cam.base_radius", "0.51", "0.0168"]);
    refused(turns, "carrier", json!("lever"), &["couplings.cam.second", "on lever"]);
    let steep = elliptic(json!({ "eccentricity": 0.9, "pressure_angle": 0.6 }));
    assert_says(refusal(steep), &["couplings.mesh.pressure_angle", "1.1197", "eccentricity"]);
    let beyond = elliptic(json!({ "eccentricity": 0.95 }));
    assert_says(refusal(beyond), &["couplings.mesh.eccentricity", "0.95", "0.9"]);
}

/// A cam may have the name of its disc. Gears with the name of a joint are rejected: both would have outputs of one
/// name.
#[test]
fn a_coupling_is_rejected_only_for_equal_variable_names() {
    let renamed = |text: &str, name: &str| {
        changed(text, |m| {
            let couplings = m["couplings"].as_object().unwrap().values().cloned();
            m["couplings"] = couplings.map(|coupling| (name.to_owned(), coupling)).collect();
        })
    };
    let text = changed(renamed(&translating("cycloidal", parsed(ROLLER)), "disc"), |m| {
        // The start has a parameter `disc.start_angle` too.
        m["couplings"]["disc"].as_object_mut().unwrap().remove("start_angle");
    });
    let mut cam = Run::new(text).started();
    assert!(cam.get("disc.contact_force").is_finite() && cam.get("disc.angle").is_finite());
    assert_says(
        refusal(renamed(&elliptic(json!({ "eccentricity": 0.3 })), "a")),
        &["couplings.a", "joints.a", "a.force", "rename"],
    );
}
