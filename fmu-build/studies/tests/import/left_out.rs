//! Notes about omitted parts of a file, and ranges whose ends are in the wrong order.

use super::{MJCF, URDF, assert_says, refusal};
use fmu_studies::import::{Form, import};
use serde_json::Value;

fn notes(form: Form, text: &str) -> String {
    import(form, "Imported", text).unwrap().notes.join("\n")
}

fn replaced(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "{from}");
    text.replacen(from, to, 1)
}

#[test]
fn gears_and_bounds_of_drives() {
    assert!(!notes(Form::Mjcf, MJCF).contains("gear"));
    let drive = r#"<motor name="m" joint="bearing" gear="50 0 0 0 0 0" ctrlrange="-1 1" forcerange="-9 9"/>"#;
    let text = replaced(MJCF, r#"<motor joint="bearing"/>"#, drive);
    assert_says(
        &notes(Form::Mjcf, &text),
        &[
            "line 20: <motor \"m\">: the input of the drive bearing_drive is the force or torque itself, 50 times",
            "<motor> ctrlrange is left out: the drive of the definition follows its input without delay and without \
                limits (line 20)",
            "<motor> forcerange is left out",
        ],
    );
    let same = replaced(MJCF, r#"<motor joint="bearing"/>"#, r#"<motor joint="bearing" gear="1"/>"#);
    assert!(!notes(Form::Mjcf, &same).contains("gear"));
    let by_default = r#"<default><motor ctrlrange="-2 2"/></default><option"#;
    assert_says(&notes(Form::Mjcf, &replaced(MJCF, "<option", by_default)), &["<motor> ctrlrange is left out"]);
    let joint = replaced(MJCF, r#"name="pin""#, r#"name="pin" actuatorfrcrange="-1 1""#);
    assert_says(&notes(Form::Mjcf, &joint), &["<joint> actuatorfrcrange is left out"]);
}

#[test]
fn medium_softness_and_second_drives() {
    assert!(!notes(Form::Mjcf, MJCF).contains("density"));
    let text = replaced(MJCF, "<option", r#"<option density="0" wind="1 0 0""#);
    assert_says(&notes(Form::Mjcf, &text), &["<option> wind is left out"]);
    let text = text.replace(r#"density="0""#, r#"density="1.2""#);
    assert_says(&refusal(Form::Mjcf, &text), &["<option>: density = \"1.2\"", "set `density` and `viscosity` to 0"]);
    let text = replaced(MJCF, r#"name="pin""#, r#"name="pin" margin="0.1" solreflimit="0.02 1""#);
    assert_says(&notes(Form::Mjcf, &text), &["<joint> margin is left out", "<joint> solreflimit is left out"]);
    let two = r#"<motor joint="bearing"/><position name="second" joint="bearing" kp="5" gear="2"/>"#;
    let text = replaced(MJCF, r#"<motor joint="bearing"/>"#, two);
    assert_says(
        &notes(Form::Mjcf, &text),
        &["<position \"second\">: the input of the drive bearing_drive_2 is the commanded position, 0.5 times"],
    );
}

#[test]
fn contact_between_geoms() {
    let said = "contact between geoms, such as line 10: <geom> and line 15: <geom>, is left out";
    assert_says(&notes(Form::Mjcf, MJCF), &[said]);
    // Geoms without contact cause no note, whether stated or by default.
    let one = replaced(MJCF, r#"type="box""#, r#"type="box" contype="0" conaffinity="0""#);
    assert!(!notes(Form::Mjcf, &one).contains("contact"));
    let none = replaced(MJCF, "<option", r#"<default><geom contype="0" conaffinity="0"/></default><option"#);
    assert!(!notes(Form::Mjcf, &none).contains("contact"));
}

#[test]
fn limits_of_urdf() {
    let found = notes(Form::Urdf, URDF);
    assert_says(&found, &["<limit> effort is left out", "<limit> velocity is left out"]);
    assert!(!found.contains("collision"));
    let bare = replaced(URDF, r#" effort="1" velocity="1""#, "");
    assert!(!notes(Form::Urdf, &bare).contains("<limit>"));
    let shapes = URDF.replace("<inertial>", "<collision/><inertial>");
    assert_says(
        &notes(Form::Urdf, &shapes),
        &["<collision> is left out: links of the definition can pass through each other (line 3, line 5)"],
    );
    let safe = URDF.replacen("<limit ", r#"<safety_controller k_velocity="1"/><limit "#, 1);
    assert_says(&notes(Form::Urdf, &safe), &["<safety_controller> is left out"]);
}

#[test]
fn reversed_ranges_are_rejected() {
    let ranged = |range: &str| replaced(MJCF, r#"name="guide""#, &format!(r#"name="guide" {range}"#));
    let said = [
        "line 14: <joint \"guide\">: range: the lower limit 0.3 is larger than the upper limit -0.1; exchange the two \
            limits",
    ];
    assert_says(&refusal(Form::Mjcf, &ranged(r#"range="0.3 -0.1""#)), &said);
    let stops = |text: &str| -> usize {
        let definition: Value =
            serde_json::from_str(&import(Form::Mjcf, "Imported", text).unwrap().definition).unwrap();
        definition["stops"].as_object().map_or(0, |stops| stops.len())
    };
    assert_eq!(stops(&ranged(r#"range="-0.1 0.3""#)), 2);
    // A range that is no limit is not checked. A range without width is valid.
    assert_eq!(stops(&ranged(r#"range="0.3 -0.1" limited="false""#)), 0);
    assert_eq!(stops(&ranged(r#"range="0 0""#)), 0);
    let turned = replaced(URDF, r#"lower="-1" upper="2""#, r#"lower="2" upper="-1""#);
    assert_says(
        &refusal(Form::Urdf, &turned),
        &["<joint \"swing\">: <limit>: the lower limit 2.0 is larger than the upper limit -1.0"],
    );
}

/// Parts that no definition can represent, each with the words of its message.
#[test]
fn elements_without_a_counterpart_are_rejected() {
    let second = r#"<body name="b" pos="1 0 0"><joint name="k" axis="0 1 0" ref="10"/><geom size=".1"/>
        <body name="c" pos="1 0 0"><joint name="l" axis="0 1 0"/><geom size=".1"/><site name="t"/></body></body>"#;
    let file = |joint: &str, rest: &str| {
        format!(
            r#"<mujoco><worldbody><site name="s"/><body name="a"><joint name="j" axis="0 1 0" {joint}/><geom size=".1"/>
            </body>{second}</worldbody>{rest}</mujoco>"#
        )
    };
    for (joint, rest, words) in [
        (r#"frictionloss="-.5""#, "", &["line 1: <joint \"j\">: frictionloss = -0.5", "must not be negative"][..]),
        (r#"stiffness="1 2""#, "", &["stiffness", "linear coefficient"]),
        (r#"damping="-1""#, "", &["damping = -1", "must not be negative"]),
        (r#"springdamper=".1 1""#, "", &["springdamper", "write `stiffness` and `damping`"]),
        (
            "",
            r#"<tendon><spatial frictionloss="1"><site site="s"/><site site="t"/></spatial></tendon>"#,
            &["frictionloss", "in a joint only"],
        ),
        (
            "",
            r#"<actuator><general joint="j" gaintype="affine" gainprm="1 2"/></actuator>"#,
            &["gainprm", "depends on position or speed"],
        ),
        ("", r#"<equality><joint joint1="j" joint2="l"/></equality>"#, &["joints j and l", "share no body"]),
        ("", r#"<equality><joint joint1="j" joint2="k" polycoef="0 1 .1"/></equality>"#, &["polycoef", "a cam"]),
        ("", r#"<equality><joint joint1="j" joint2="m"/></equality>"#, &["there is no joint m"]),
        (
            "",
            r#"<equality><weld body1="a" body2="c" relpose="1 0 0 1 0 0 0"/></equality>"#,
            &["differs from the welded position by 1.00e0"],
        ),
        ("", r#"<equality><tendon tendon1="t"/></equality>"#, &["<tendon>", "remove this equality"]),
        ("", r#"<tendon><fixed name="f"/></tendon>"#, &["<fixed \"f\">", "several joints"]),
        ("", r#"<tendon><spatial><site site="s"/><site site="t"/><site site="s"/></spatial></tendon>"#, &["two sites"]),
        ("", r#"<actuator><position joint="j" dampratio="1"/></actuator>"#, &["dampratio", "write `kv`"]),
        ("", r#"<actuator><general joint="j" biastype="affine" biasprm="0 1"/></actuator>"#, &["signs of the bias"]),
        ("", r#"<actuator><dcmotor joint="j"/></actuator>"#, &["<dcmotor>", "an element `motor`"]),
        ("", "<worldbody><replicate/></worldbody>", &["<replicate>", "mj_saveLastXML"]),
        ("", r#"<include file="other.xml"/>"#, &["<include>", "other.xml"]),
    ] {
        assert_says(&refusal(Form::Mjcf, &file(joint, rest)), words);
    }
    let said = notes(
        Form::Mjcf,
        &file(r#"colour="red" class="main""#, "<sensor/><odd/>").replace("<mujoco>", "<mujoco><default/>"),
    );
    assert_says(&said, &["<joint> colour is unknown", "<odd> is unknown", "<sensor> is left out"]);
}

/// Ranges are relative to `ref`. `limited`, `autolimits` and flags determine whether they are limits.
#[test]
fn ranges_count_from_the_reference() {
    let angles = |joint: &str, settings: &str| -> Vec<f64> {
        let text = format!(
            r#"<mujoco>{settings}<worldbody><body name="a"><joint name="j" axis="0 1 0" {joint}/>
            <geom size=".1"/></body></worldbody></mujoco>"#
        );
        let text = import(Form::Mjcf, "Imported", &text).unwrap().definition;
        let definition: Value = serde_json::from_str(&text).unwrap();
        let stops = definition["stops"].as_object();
        stops.into_iter().flatten().map(|(_, stop)| stop["angle"].as_f64().unwrap().to_degrees().round()).collect()
    };
    // The axis points against the normal of the plane.
    assert_eq!(angles(r#"range="-10 50" ref="20""#, ""), [-30.0, 30.0]);
    assert_eq!(angles(r#"range="-10 50" ref="10""#, ""), [-40.0, 20.0]);
    assert_eq!(angles(r#"range="-10 50" limited="false""#, ""), [0.0; 0]);
    assert_eq!(angles(r#"range="-10 50""#, r#"<compiler autolimits="false"/>"#), [0.0; 0]);
    assert_eq!(angles(r#"range="-10 50" limited="true""#, r#"<compiler autolimits="false"/>"#), [-50.0, 10.0]);
    assert_eq!(angles(r#"range="-10 50""#, r#"<option><flag limit="disable"/></option>"#), [0.0; 0]);
    assert_eq!(angles(r#"range="-10 50""#, r#"<option><flag constraint="disable"/></option>"#), [0.0; 0]);
}
