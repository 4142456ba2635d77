//! Warnings of `check` about contacts at the start: slack belts, overlapping pulleys, followers that lose contact.

use crate::cams::{ROLLER, parsed, translating};
use crate::couplings::{BELT, shafts};
use crate::support::{Run, assert_says, changed};
use linkage_fmu::mechanism::inspection::inspect;
use serde_json::{Value, json};

/// The findings of a coupling.
fn warnings_of(text: &str, coupling: &str) -> Vec<String> {
    let path = format!("couplings.{coupling}");
    let findings = inspect(text).findings.into_iter().filter(|finding| finding.path.starts_with(&path));
    findings.map(|finding| finding.to_string()).collect()
}

/// Two shafts 0.3 m apart with a belt: inertias 0.02 and 0.5 kg.m2, torques 3 and -1 N.m.
fn belt(keys: Value) -> String {
    changed(shafts(BELT), |m| {
        let mut belt = m["couplings"]["mesh"].take();
        belt.as_object_mut().unwrap().extend(keys.as_object().unwrap().clone());
        m["couplings"] = json!({ "loop": belt });
    })
}

#[test]
fn a_belt_whose_span_is_slack_at_the_start() {
    for crossed in [false, true] {
        // The inertia at the first shaft is J1 + i^2 J2 = 0.02 + 0.625^2 0.5. Second shaft: J2 alpha2 = 0.08 m x force
        // - 1 N.m.
        let ratio = if crossed { -0.05 / 0.08 } else { 0.05 / 0.08 };
        let transmitted: f64 = (0.5 * ratio * (3.0 - ratio) / (0.02 + ratio * ratio * 0.5) + 1.0) / 0.08;
        let (half, number) = (0.5 * transmitted.abs(), |value: f64| value.to_string()[..6].to_owned());
        let with = |pretension: f64| belt(json!({ "crossed": crossed, "pretension": pretension }));
        assert!((Run::new(with(1.0)).started().get("loop.transmitted_force") - transmitted).abs() < 1e-12);
        for (pretension, shown) in [(0.0, "0 N".to_owned()), (0.999 * half, number(0.999 * half))] {
            let [warning] = &warnings_of(&with(pretension), "loop")[..] else { panic!("{crossed} {pretension}") };
            let (force, shown) = (format!("transmits {}", number(transmitted)), format!("the pretension of {shown}"));
            assert_says(warning, &["couplings.loop.pretension: ", &force, &shown, "slack"]);
            assert_says(warning, &[&format!("use a pretension of more than {}", number(half))]);
        }
        assert_eq!(warnings_of(&with(1.001 * half), "loop"), [""; 0]);
    }
    // The default pretension is 0. Without loads the belt transmits no force and is not slack.
    assert_says(warnings_of(&belt(json!({})), "loop").join(""), &["the pretension of 0 N"]);
    let idle = changed(belt(json!({})), |m| {
        m["torques"] = json!({});
    });
    assert_eq!(warnings_of(&idle, "loop"), [""; 0]);
}

#[test]
fn pulleys_that_overlap() {
    let pulleys = |first: f64, crossed: bool| {
        belt(json!({ "first_radius": first, "second_radius": 0.1, "crossed": crossed, "pretension": 1e3 }))
    };
    let [warning] = &warnings_of(&pulleys(0.21, false), "loop")[..] else { panic!() };
    assert_says(warning, &["0.21 and 0.1 m", "0.3 m apart", "overlap", "move a centre"]);
    assert_eq!(warnings_of(&pulleys(0.19, false), "loop"), [""; 0]);
    // A crossed belt with these radii cannot exist: an error.
    assert_says(warnings_of(&pulleys(0.21, true), "loop").join("\n"), &["must be larger than the sum of the radii"]);
}

#[test]
fn a_follower_that_lifts_off_at_the_start() {
    let cam = |change: &dyn Fn(&mut Value)| changed(translating("polynomial_345", parsed(ROLLER)), |m| change(m));
    let about_lift = |text: &str| -> Vec<String> {
        warnings_of(text, "cam").into_iter().filter(|warning| warning.contains("contact_force")).collect()
    };
    assert_eq!(about_lift(&cam(&|_| {})), [""; 0]);
    // A spring in tension lifts the follower off the cam.
    let pulled = |m: &mut Value| m["springs"]["spring"]["preload"] = json!(-900);
    let text = cam(&pulled);
    let force = Run::new(&text).started().get("cam.contact_force");
    assert!(force < -100.0, "{force}");
    let [warning] = &about_lift(&text)[..] else { panic!("{:?}", warnings_of(&text, "cam")) };
    let force = format!("{force:.2}");
    assert_says(warning, &["cam.contact_force is", &force[..5], "at the start, below 0", "would lift off", "grooved"]);
    let grooved = cam(&|m| {
        pulled(m);
        m["couplings"]["cam"]["grooved"] = json!(true);
    });
    assert_eq!(about_lift(&grooved), [""; 0]);
}

#[test]
fn a_belt_that_goes_slack_in_a_run_gives_one_warning() {
    let mut run = Run::new(belt(json!({ "pretension": 80 }))).started();
    let mut warnings = Vec::new();
    for (k, torque) in [3.0, 3.0, 60.0, 60.0].into_iter().enumerate() {
        run.set("motor.torque", torque);
        run.0.model_mut().step_from(Some(0.01 * k as f64), 0.01).unwrap();
        warnings.push(run.0.model_mut().take_warning());
    }
    let force = run.get("loop.transmitted_force");
    assert!(0.5 * force > 80.0, "{force}");
    let [None, None, Some(warning), None] = &warnings[..] else { panic!("{warnings:?}") };
    let force = format!("transmits {force:.2}");
    assert_says(warning, &["loop ", &force[..13], "at t = 0.03 s", "the pretension of 80 N", "slack"]);
    // After the next initialisation the warning is returned again.
    run.initialize();
    run.set("motor.torque", -60.0);
    run.step(0.01);
    assert!(run.0.model_mut().take_warning().is_some());
}
