//! Invalid cams and elliptic gears are rejected with the key in the message.
use super::{ROLLER, elliptic, oscillating, parsed, translating};
use crate::support::{Run, assert_rejected, assert_says, changed, refusal};
use serde_json::json;

#[test]
fn wrong_cams_are_rejected() {
    assert_rejected("translating cams", translating("cycloidal", parsed(ROLLER)));
    assert_rejected("oscillating cams", oscillating("cycloidal", parsed(ROLLER)));
    assert_rejected("elliptic gears", elliptic(json!({ "eccentricity": 0.3 })));
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
