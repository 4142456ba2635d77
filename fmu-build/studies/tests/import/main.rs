//! `cargo fmu import`: each format as its program writes it, compared with the same mechanism as a manual definition.
#![allow(clippy::unwrap_used)]

#[allow(dead_code)]
#[path = "../../../../tests/support/definition.rs"]
mod definition;
mod left_out;
mod mujoco;
mod written;

use definition::With;
use fmu_studies::import::{Form, import};
use linkage_fmu::component::{Component, Linearisation};
use linkage_fmu::simulation::Simulation;
use serde_json::{Value, json};

/// Difference of two runs at the tolerance 1e-9, which have other steps and other body frames.
const SAME: f64 = 1e-7;

/// Slider-crank with a crank of 0.1 m, given by joints at its first position.
const PMKS: &str =
    "ground,input,R,0,0\ninput coupler,R,0.08,0.06\ncoupler,slider,R,0.36,0\nground,slider,P,0.36,0.00,0.00\n";

fn slider_crank() -> Value {
    let rod = f64::hypot(0.28, 0.06);
    let crank = json!({ "length": 0.1, "mass": 1, "center": [0.05, 0], "inertia": 0.0025 });
    let rod = json!({ "length": rod, "mass": 1, "center": [0.5 * rod, 0], "inertia": 0.25 * rod * rod });
    let motor = json!({ "actuators": { "motor": { "joint": "bearing", "torque": 0 } } });
    definition::slider_crank([crank, rod, json!({ "mass": 1 })], f64::atan2(0.06, 0.08)).with(motor)
}

/// Values of variables of a definition after a motion with an input.
fn values(definition: &str, input: (&str, f64), names: &[&str]) -> Vec<f64> {
    let mut simulation = Simulation::open(definition).unwrap_or_else(|error| panic!("{error} in\n{definition}"));
    simulation.set(input.0, input.1).unwrap();
    simulation.initialize().unwrap();
    (0..50).for_each(|_| simulation.step(4e-3).unwrap());
    names.iter().map(|name| simulation.get(name).unwrap()).collect()
}

/// Compare variables of an imported definition with those of a manual definition. Each pair may have an offset.
fn compare(form: Form, text: &str, hand: &Value, inputs: [(&str, f64); 2], pairs: &[(&str, &str, f64)]) -> Vec<String> {
    let imported = import(form, "Imported", text).unwrap();
    let names: Vec<&str> = pairs.iter().map(|(name, ..)| *name).collect();
    let own = values(&imported.definition, inputs[0], &names);
    let names: Vec<&str> = pairs.iter().map(|(_, name, _)| *name).collect();
    let expected = values(&hand.to_string(), inputs[1], &names);
    for ((own, expected), (name, _, offset)) in own.iter().zip(expected).zip(pairs) {
        assert!(
            (own + offset - expected).abs() <= SAME * (1.0 + expected.abs()),
            "{name}: {own} + {offset}, {expected}"
        );
        assert!(expected.abs() > 1e-3, "{name} tells nothing");
    }
    imported.notes
}

fn refusal(form: Form, text: &str) -> String {
    format!("{:#}", import(form, "Imported", text).unwrap_err())
}

fn assert_says(text: &str, words: &[&str]) {
    for word in words {
        assert!(text.contains(word), "`{text}` lacks `{word}`");
    }
}

#[test]
fn pmks() {
    let pairs = [
        ("input.speed", "crank.speed", 0.0),
        ("coupler.speed", "rod.speed", 0.0),
        ("input.angle", "crank.angle", f64::atan2(0.06, 0.08)),
        ("joint_4.position", "guide.position", 0.36),
    ];
    let notes = compare(Form::Pmks, PMKS, &slider_crank(), [("drive.torque", 2.0), ("motor.torque", 2.0)], &pairs);
    assert_says(&notes.join("\n"), &["no masses", "no units", "no drive"]);
    assert_says(&refusal(Form::Pmks, "ground,a,G,0,0\n"), &["line 1", "gear"]);
    let notes = import(Form::Pmks, "Imported", "ground,a,R,0,0\na,c,P,1,2\n").unwrap().notes;
    assert_says(&notes.join("\n"), &["a c P 1 2", "angle of the slide is missing"]);
    assert_says(&refusal(Form::Pmks, "a,b,R,0,0\n"), &["ground"]);
}

/// A quick return with a pin in a slot, and a table with the same joints.
#[test]
fn pyslvs_and_a_table() {
    let hand = json!({
        "name": "ByHand",
        "bodies": {
            "ground": { "points": { "pivot": [0.5, 0] } },
            "crank": { "length": 0.2, "mass": 1, "center": [0.1, 0], "inertia": 0.01 },
            "lever": { "mass": 1, "points": { "tip": [0.9, 0] }, "center": [0.4, 0], "inertia": 0.14 },
            "block": {}
        },
        "joints": {
            "bearing": { "type": "revolute", "first": "ground.origin", "second": "crank.origin" },
            "pivot": { "type": "revolute", "first": "ground.pivot", "second": "lever.origin" },
            "slot": { "type": "prismatic", "first": "lever.origin", "second": "block.origin" },
            "pin": { "type": "revolute", "first": "crank.end", "second": "block.origin" }
        },
        "actuators": { "motor": { "joint": "bearing", "torque": 0 } },
        "markers": { "tip": { "at": "lever.tip" } },
        "start": { "body": "crank", "angle": 0 },
        "guess": { "crank": 0, "lever": std::f64::consts::PI, "slot": 0.3 }
    });
    let pyslvs = "M[J[R, color[Green], P[0.0, 0.0], L[ground, link_1]], J[RP, A[0.0], color[(1, 2, 3)], P[0.2, 0.0], \
                  L[link_2, link_1]], # the slot\nJ[R, P[0.5, 0.0], L[ground, link_2]], J[R, P[-0.4, 0.0], L[link_2]]]";
    let pairs = [
        ("link_1.speed", "crank.speed", 0.0),
        ("link_2.speed", "lever.speed", 0.0),
        ("point_4.x", "tip.x", 0.0),
        ("point_4.y", "tip.y", 0.0),
    ];
    // Three points of the lever at 0, 0.3 and 0.9 m: centre 0.4 m, mean square distance 0.14 m2.
    let inputs = [("drive.torque", 1.5), ("motor.torque", 1.5)];
    compare(Form::Pyslvs, pyslvs, &hand, inputs, &pairs);
    let table = "type,x,y,angle,links,driven\nR,0,0,,ground link_1,1\nRP,0.2,0,0,link_2 link_1,\nR,0.5,0,,ground \
        link_2,\n\
                 R,-0.4,0,,link_2,\n";
    let notes = compare(Form::Table, table, &hand, inputs, &pairs);
    assert!(!notes.join("\n").contains("no drive"));
    assert_says(&refusal(Form::Pyslvs, "M[J[R, P[0, 0], L[ground, a]]"), &["closing bracket is missing"]);
    assert_says(&refusal(Form::Pyslvs, "M[J[Q, P[0, 0], L[ground, a]]]"), &["joint 1", "R, P or RP"]);
    assert_says(&refusal(Form::Table, "type,x,y\nR,0,0\n"), &["no column \"links\""]);
    assert_says(&refusal(Form::Table, "type,x,y,links\nR,0,b,ground a\n"), &["line 2", "\"b\" is not a number"]);
    let far = table.replace("-0.4,0", "-1e308,1e308");
    assert_says(&refusal(Form::Table, &far), &["bodies.link_2.", "is not finite", "use larger units"]);
}

/// The slider-crank in the vertical xz plane. Its rod is a capsule, its slider has a damped slide with a spring.
const MJCF: &str = include_str!("crank.mjcf");

#[test]
fn mjcf() {
    let mut hand = slider_crank();
    let (h, r) = (f64::hypot(0.28, 0.06), 0.01f64);
    let pi = std::f64::consts::PI;
    let (cylinder, balls) = (2000.0 * pi * r * r * h, 2000.0 * 4.0 / 3.0 * pi * r * r * r);
    // The centre of half a ball is 3/8 r from its flat side, its inertia about the centre 83/320 m r^2.
    let half = 0.5 * balls;
    let of_half = half * (83.0 / 320.0 * r * r + (0.5 * h + 0.375 * r).powi(2));
    let inertia = cylinder * (h * h / 12.0 + r * r / 4.0) + 2.0 * of_half;
    hand["gravity"] = json!({ "acceleration": 9.81, "up_angle": 0.5 * pi });
    hand["bodies"]["crank"] = json!({ "length": 0.1, "mass": 1.5, "center": [0.05, 0], "inertia": 0.002 });
    hand["bodies"]["rod"] =
        json!({ "length": h, "mass": cylinder + balls, "center": [0.5 * h, 0], "inertia": inertia });
    hand["bodies"]["slider"] = json!({ "mass": 0.7 });
    hand["springs"] = json!({ "spring": { "joint": "guide", "stiffness": 40, "damping": 3, "free_length": 0.38 } });
    let pairs = [
        ("crank.speed", "crank.speed", 0.0),
        ("rod.speed", "rod.speed", 0.0),
        ("guide.position", "guide.position", 0.36),
    ];
    let inputs = [("bearing_drive.torque", 0.8), ("motor.torque", 0.8)];
    let notes = compare(Form::Mjcf, MJCF, &hand, inputs, &pairs);
    let (text, mut notes) = (import(Form::Mjcf, "Imported", MJCF).unwrap().definition, notes.iter());
    assert!(text.contains("\"mark\"") && !notes.any(|note| note.contains("site")));
    for (from, to, words) in [
        ("axis=\"0 1 0\"", "axis=\"1 1 0\"", &["pin", "planar"][..]),
        ("type=\"slide\"", "type=\"ball\"", &["ball", "line 14", "guide"]),
        ("<option", "<include file=\"a.xml\"/><option", &["include"]),
        ("body2=\"slider\"", "body2=\"slyder\"", &["slyder", "no such body"]),
        ("mass=\"0.7\"", "mass=\"x\"", &["mass", "not a number"]),
    ] {
        assert_says(&refusal(Form::Mjcf, &MJCF.replace(from, to)), words);
    }
    assert_says(&refusal(Form::Mjcf, "<mujoco"), &["not XML"]);
    for (geom, named) in [("mass=\"-2\"", "mass = \"-2\""), ("density=\"-1\"", "density = \"-1\"")] {
        let text = format!(
            "<mujoco><worldbody><body><joint axis=\"0 1 0\"/><geom type=\"sphere\" size=\"0.1\" \
             {geom}/></body></worldbody></mujoco>"
        );
        assert_says(&refusal(Form::Mjcf, &text), &[named, "must not be negative"]);
    }
    let (open, close) = ("<body>".repeat(20_000), "</body>".repeat(20_000));
    let deep = format!("<mujoco><worldbody>{open}{close}</worldbody></mujoco>");
    assert_says(&refusal(Form::Mjcf, &deep), &["at most 250 are supported"]);
}

/// A pendulum with a bob fixed to it, rotated by its origins.
const URDF: &str = include_str!("pendulum.urdf");

#[test]
fn urdf() {
    let imported = import(Form::Urdf, "Imported", URDF).unwrap();
    assert_says(&imported.notes.join("\n"), &["base", "gravity"]);
    let mut definition: Value = serde_json::from_str(&imported.definition).unwrap();
    definition["start"]["equilibrium"] = json!(true);
    let mut model = Component::from_definition("mechanism.json", &definition.to_string()).unwrap();
    let find = |name: &str| model.interface().find(name).unwrap();
    let (coordinate, held_by) = (find("arm.angle"), None);
    let what = Linearisation { coordinate, inputs: vec![find("swing_drive.torque")], outputs: Vec::new(), held_by };
    let at = model.linearise_here(&what).unwrap();
    // About the joint: 0.02 of the arm, 0.5 kg at 0.2 m, 0.003 of the bob, 2 kg at 0.4 m.
    let inertia: f64 = 0.02 + 0.5 * 0.04 + 0.003 + 2.0 * 0.16;
    let omega = (9.81 * (0.5 * 0.2 + 2.0 * 0.4) / inertia).sqrt();
    assert!((at.omega - omega).abs() < 1e-6, "{} {omega}", at.omega);
    assert!((at.damping_ratio - 0.05 / (2.0 * inertia * omega)).abs() < 1e-9);
    assert!((at.b[0][1].abs() - 1.0 / inertia).abs() < 1e-6);
    // The equilibrium is 0.4 rad from the drawn position, the stops are 1 and 2 rad from the drawn position.
    assert!((at.coordinate.abs() - 0.4).abs() < 1e-9, "{}", at.coordinate);
    let mut angles: Vec<f64> =
        definition["stops"].as_object().unwrap().values().map(|s| s["angle"].as_f64().unwrap()).collect();
    angles.sort_by(f64::total_cmp);
    let expected = if at.coordinate > 0.0 { [-2.0, 1.0] } else { [-1.0, 2.0] };
    assert_eq!(angles, expected);
    let copied = URDF.replace("<dynamics", "<mimic joint=\"weld\"/><dynamics");
    assert_says(&refusal(Form::Urdf, &copied), &["line 7: <mimic>", "no moving joint weld"]);
    let macros = "<robot xmlns:xacro=\"http://www.ros.org/wiki/xacro\"><xacro:arm/></robot>";
    assert_says(&refusal(Form::Urdf, macros), &["line 1: <xacro:arm>", "xacro FILE > robot.urdf"]);
    assert_says(&refusal(Form::Urdf, &URDF.replace("revolute", "floating")), &["floating", "swing"]);
    assert_says(&refusal(Form::Urdf, "<mujoco/>"), &["the first element of a URDF file must be <robot>"]);
    let negative = URDF.replacen("<mass value=\"", "<mass value=\"-", 1);
    assert_ne!(negative, URDF);
    assert_says(&refusal(Form::Urdf, &negative), &["<mass>", "must not be negative"]);
}
