//! Files that other programs wrote, compared with manual definitions or closed forms. `files/README.md` lists the
//! program versions.

use super::{assert_says, compare, refusal, slider_crank, values};
use fmu_studies::import::{Form, import};
use linkage_fmu::simulation::Simulation;
use serde_json::{Value, json};
use std::f64::consts::PI;

const PLUS: &str = include_str!("files/slider_crank.pmks");
const PLUS_LINK: &str = include_str!("files/four_bar.url");

fn definition(form: Form, text: &str) -> Value {
    serde_json::from_str(&import(form, "Imported", text).unwrap().definition).unwrap()
}

/// The slider-crank of PMKS+ in centimetres and grams, with a point, a force there and a speed of the input.
#[test]
fn pmks_plus() {
    let mut hand = slider_crank();
    let rod = f64::hypot(0.28, 0.06);
    hand["bodies"]["crank"] = json!({ "length": 0.1, "mass": 1.5, "center": [0.05, 0], "inertia": 0.0025 });
    let (cos, sin) = (0.28 / rod, -0.06 / rod);
    let tip = [0.12 * cos + 0.04 * sin, 0.04 * cos - 0.12 * sin];
    hand["bodies"]["rod"] =
        json!({ "length": rod, "mass": 0.9, "center": [0.5 * rod, 0], "inertia": 0.009, "points": { "tip": tip } });
    hand["bodies"]["slider"] = json!({ "mass": 0.7 });
    hand["forces"] = json!({ "push": { "at": "rod.tip", "force": [4, -3] } });
    hand["markers"] = json!({ "tip": { "at": "rod.tip" } });
    hand["start"]["speed"] = json!(20.0 * 2.0 * PI / 60.0);
    let pairs = [
        ("crank.speed", "crank.speed", 0.0),
        ("BCE.speed", "rod.speed", 0.0),
        ("D.position", "guide.position", 0.36),
        ("tool_tip.x", "tip.x", 0.0),
        ("tool_tip.velocity_y", "tip.velocity_y", 0.0),
        ("F1.force_x", "push.force_x", 0.0),
    ];
    let notes = compare(Form::PmksPlus, PLUS, &hand, [("drive.torque", 0.4), ("motor.torque", 0.4)], &pairs);
    assert_says(&notes.join("\n"), &["cm (length), g (mass), kg cm2", "gravity", "the speed of the input"]);
    let cut = &PLUS[..PLUS.len() - 9];
    assert_says(&refusal(Form::PmksPlus, cut), &["incomplete"]);
    // A force that turns with its link; a joint without its link; a letter that is no digit.
    for (from, to, words) in [
        ("..2F1,BCE", "..3F1,BCE", &["force 1", "turns with its link"][..]),
        (",A,B,,.", ",A,Q,,.", &["AB", "no joint Q"]),
        ("GB,B,1z0", "GB,B,1!0", &["joint 2", "x", "not a digit"]),
        ("F1,BCE,", "F1,BCQ,", &["force 1", "no link BCQ"]),
    ] {
        assert!(PLUS.contains(from));
        assert_says(&refusal(Form::PmksPlus, &PLUS.replacen(from, to, 1)), words);
    }
}

/// A four-bar linkage in a link, in metres, with a rocker of two welded bars and a clockwise input.
#[test]
fn link_of_pmks_plus() {
    let (coupler, rocker) = (f64::hypot(3.25, 2.5), f64::hypot(0.75, 3.5));
    let (cos, sin) = (-0.75 / rocker, 3.5 / rocker);
    let center = |x: f64, y: f64| json!([x * cos + y * sin, y * cos - x * sin]);
    let hand = json!({
        "name": "ByHand",
        "bodies": {
            "ground": { "points": { "a": [-1, 0], "d": [3, 0] } },
            "crank": { "length": 1, "mass": 1, "center": [0.5, 0], "inertia": 0.2 },
            "coupler": { "length": coupler, "mass": 2.5, "center": [0.5 * coupler, 0], "inertia": 1.75 },
            "rocker": { "length": rocker, "mass": 3.2, "center": center(0.0, 2.5), "inertia": 4.1,
                        "points": { "tip": center(1.0, 4.5) } }
        },
        "joints": {
            "a": { "type": "revolute", "first": "ground.a", "second": "crank.origin" },
            "b": { "type": "revolute", "first": "crank.end", "second": "coupler.origin" },
            "c": { "type": "revolute", "first": "coupler.end", "second": "rocker.end" },
            "d": { "type": "revolute", "first": "ground.d", "second": "rocker.origin" }
        },
        "actuators": { "motor": { "joint": "a", "torque": 0 } },
        "markers": { "tip": { "at": "rocker.tip" } },
        "start": { "body": "crank", "angle": 0.5 * PI, "speed": -PI },
        "guess": { "crank": 0.5 * PI, "coupler": f64::atan2(2.5, 3.25), "rocker": f64::atan2(3.5, -0.75) }
    });
    let pairs = [
        ("AB.speed", "crank.speed", 0.0),
        ("BC.speed", "coupler.speed", 0.0),
        ("CDE.speed", "rocker.speed", 0.0),
        ("E.x", "tip.x", 0.0),
        ("E.velocity_x", "tip.velocity_x", 0.0),
    ];
    // The weld is at the joint of the parts, where the coupler has its pin, and at the ground, which is no part of a
    // weld.
    let at_pin = PLUS_LINK.replacen(".GC,C,", ".OC,C,", 1).replacen(".OE,E,", ".GE,E,", 1);
    let at_ground = at_pin.replacen(".KD,D,", ".SD,D,", 1);
    assert!(at_pin != PLUS_LINK && at_ground != at_pin);
    for link in [PLUS_LINK, &at_pin, &at_ground] {
        compare(Form::PmksPlus, link, &hand, [("drive.torque", 3.0), ("motor.torque", 3.0)], &pairs);
    }
    // The parts of the weld are no separate bodies.
    assert_eq!(definition(Form::PmksPlus, PLUS_LINK)["bodies"].as_object().unwrap().len(), 4);
}

/// One letter of the record contains its flags. The last letter of a file depends on its length.
fn plus_file(joints: &str, links: &str) -> String {
    const CHECKS: &str = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz";
    let body = format!("2O.Fe,Fe.K,0.2011.{joints}.{links}..N");
    let check = CHECKS.chars().nth(body.len() % 62).unwrap();
    format!("{body}{check}")
}

/// The quick return of later versions with a slide in a link: with a block, and as one joint without a block.
#[test]
fn slots_of_pmks_plus() {
    let lever = "YRCD,CD,Fe,38,7q,Fe,,C,D,,.";
    let with_block = plus_file(
        "MA,A,0,0,0.GB,B,Fe,0,0.KC,C,0Fe,0,0.GD,D,VG,0,0.HP,P,Fe,0,0,CD,C,D.",
        &format!("YRAB,AB,Fe,38,7q,0,,A,B,,.{lever}YPBP,BP,7q,0,0,0,,B,P,,."),
    );
    let alone = plus_file(
        "MA,A,0,0,0.HB,B,Fe,0,0,CD,C,D.KC,C,0Fe,0,0.GD,D,VG,0,0.",
        &format!("YRAB,AB,Fe,38,7q,0,,A,B,,.{lever}"),
    );
    for (text, block, position) in [(with_block, 0.5, "P.position"), (alone, 0.0, "B.position")] {
        let hand = json!({
            "name": "ByHand",
            "bodies": {
                "ground": { "points": { "pivot": [-1, 0] } },
                "crank": { "length": 1, "mass": 1, "center": [0.5, 0], "inertia": 0.2 },
                "lever": { "mass": 1, "center": [1.5, 1], "inertia": 0.2 },
                "block": { "mass": block }
            },
            "joints": {
                "bearing": { "type": "revolute", "first": "ground.origin", "second": "crank.origin" },
                "pivot": { "type": "revolute", "first": "ground.pivot", "second": "lever.origin" },
                "slot": { "type": "prismatic", "first": "lever.origin", "second": "block.origin" },
                "pin": { "type": "revolute", "first": "crank.end", "second": "block.origin" }
            },
            "actuators": { "motor": { "joint": "bearing", "torque": 0 } },
            "start": { "body": "crank", "angle": 0, "speed": 2.0 * PI / 3.0 },
            "guess": { "crank": 0, "lever": 0, "slot": 2 }
        });
        let pairs =
            [("AB.speed", "crank.speed", 0.0), ("CD.speed", "lever.speed", 0.0), (position, "slot.position", 2.0)];
        compare(Form::PmksPlus, &text, &hand, [("drive.torque", 2.0), ("motor.torque", 2.0)], &pairs);
    }
}

/// PMKS's JSON and text give the same definition. The angle of a slide is relative to its first link.
#[test]
fn json_of_pmks() {
    let text = "name=Imported\nmech=\nground,crank,R,0.000,0.000,tfft\ncrank,coupler,R,80.000,60.000,tfff\n\
                coupler,rocker,R,280.000,180.000,tfff\nrocker,ground,R,300.000,0.000,tfff\n\
                coupler,R,200.000,220.000,tfff\n";
    let json = include_str!("files/pmks_four_bar.json");
    assert_eq!(definition(Form::Pmks, json), definition(Form::Pmks, text));
    let link = "http://localhost/pmks.html?set=s5&mech=ground%20crank%20R%200%200%200%20tfft|crank%20coupler%20R%2080\
                %2060%200%20tfff|coupler%20rocker%20R%20280%20180%200%20tfff|rocker%20gnd%20R%20300%200%200%20tfff|\
                coupler%20R%20200%20220%200%20tfff|";
    assert_eq!(definition(Form::Pmks, link), definition(Form::Pmks, text));
    let text =
        "ground,crank,R,0,0,tfft\ncrank,rod,R,80,60,tfff\nrod,slider,R,360,0,tfff\nground,slider,P,360,0,0,tfff\n";
    let json = include_str!("files/pmks_slider_crank.json");
    assert_eq!(definition(Form::Pmks, json), definition(Form::Pmks, text));
    // The fourth flag determines the position of the drive, not the order of the joints.
    let elsewhere = text.replace("tfft", "tfff").replace("360,0,0,tfff", "360,0,0,tfft");
    assert_eq!(definition(Form::Pmks, &elsewhere)["actuators"]["drive"]["joint"], "joint_4");
    assert_says(&refusal(Form::Pmks, "{}"), &["Joints"]);
    assert_says(&refusal(Form::Pmks, &json.replace("\"P\"", "\"G\"")), &["joint", "gear"]);
}

/// A quick return that Pyslvs wrote, and the expression of the other tests.
#[test]
fn file_of_pyslvs() {
    let text = include_str!("files/quick_return.pyslvs");
    let own =
        values(&definition(Form::Pyslvs, text).to_string(), ("drive.torque", 1.5), &["link_2.angle", "point_4.y"]);
    let table = "type,x,y,angle,links,driven\nR,0,0,,ground link_1,1\nRP,0.2,0,0,link_2 link_1,\nR,0.5,0,,ground \
        link_2,\n\
                 R,-0.4,0,,link_2,\n";
    let expected =
        values(&definition(Form::Table, table).to_string(), ("drive.torque", 1.5), &["link_2.angle", "point_4.y"]);
    assert!(own.iter().zip(&expected).all(|(own, expected)| (own - expected).abs() < 1e-9), "{own:?} {expected:?}");
    assert!(own[0].abs() > 1e-2);
}

/// MuJoCo writes defaults as classes, and capsules by position and quaternion.
#[test]
fn file_of_mujoco() {
    let text = include_str!("files/slider_crank.xml");
    let mut hand = slider_crank();
    let capsule = |h: f64| {
        let (r, density) = (0.01f64, 2000.0);
        let (cylinder, balls) = (density * PI * r * r * h, density * 4.0 / 3.0 * PI * r * r * r);
        let half = 0.5 * balls;
        let of_half = half * (83.0 / 320.0 * r * r + (0.5 * h + 0.375 * r).powi(2));
        let inertia = cylinder * (h * h / 12.0 + r * r / 4.0) + 2.0 * of_half;
        json!({ "length": h, "mass": cylinder + balls, "center": [0.5 * h, 0], "inertia": inertia })
    };
    hand["gravity"] = json!({ "acceleration": 9.81, "up_angle": 0.5 * PI });
    hand["bodies"]["crank"] = capsule(0.1);
    // The file contains six digits of this half length.
    hand["bodies"]["rod"] = capsule(2.0 * 0.143178);
    hand["bodies"]["rod"]["length"] = json!(f64::hypot(0.28, 0.06));
    hand["bodies"]["rod"]["center"] = json!([0.5 * f64::hypot(0.28, 0.06), 0]);
    hand["bodies"]["slider"] = json!({ "mass": 0.7 });
    hand["springs"] = json!({
        "spring": { "joint": "guide", "stiffness": 40, "damping": 3, "free_length": 0.38 },
        "bearing_damper": { "joint": "bearing", "damping": 0.01 },
        "pin_damper": { "joint": "pin", "damping": 0.01 }
    });
    hand["stops"] = json!({
        "inner": { "joint": "guide", "limit": "lower", "position": 0.06 },
        "outer": { "joint": "guide", "limit": "upper", "position": 0.41 }
    });
    let pairs = [
        ("crank.speed", "crank.speed", 0.0),
        ("rod.speed", "rod.speed", 0.0),
        ("guide.position", "guide.position", 0.36),
    ];
    compare(Form::Mjcf, text, &hand, [("bearing_drive.torque", 0.1), ("motor.torque", 0.1)], &pairs);
    let unknown = text.replace("geom class=\"bar\"", "geom class=\"pipe\"");
    assert_says(&refusal(Form::Mjcf, &unknown), &["line 18", "no default class \"pipe\""]);
}

/// A boom in xacro with a welded jib at 60 degrees: its acceleration from rest in closed form.
#[test]
fn file_of_xacro() {
    let text = include_str!("files/boom.urdf");
    // An axis in the other direction changes the sign of the torque, which is 0.
    let reversed = import(Form::Urdf, "Imported", &text.replace("0 -1 0", "0 1 0")).unwrap().definition;
    assert!(reversed.contains("\"torque\": 0.0"), "{reversed}");
    let mut simulation = Simulation::open(&import(Form::Urdf, "Imported", text).unwrap().definition).unwrap();
    simulation.set("shoulder_drive.torque", 12.0).unwrap();
    simulation.initialize().unwrap();
    // The boom is inclined 30 degrees up, the jib 30 degrees down from the end of the boom.
    let (l, m) = (0.8f64, 3.2f64);
    let (boom, jib) = (30f64.to_radians(), -30f64.to_radians());
    let x = l * boom.cos() + 0.25 * l * jib.cos();
    let y = l * boom.sin() + 0.25 * l * jib.sin();
    let inertia = m * l * l / 3.0 + 0.5 * m * (0.25 * l * l / 12.0 + x * x + y * y);
    let moment = 12.0 - 9.81 * (m * 0.5 * l * boom.cos() + 0.5 * m * x);
    let acceleration = simulation.get("boom.acceleration").unwrap();
    assert!((acceleration.abs() - (moment / inertia).abs()).abs() < 1e-9, "{acceleration} {}", moment / inertia);
}

/// A table of a spreadsheet with semicolons and decimal commas.
#[test]
fn file_of_a_spreadsheet() {
    let text = include_str!("files/slider_crank.csv");
    let plain = "type,x,y,angle,links,driven\nR,0,0,,ground crank,1\nR,0.08,0.06,,crank rod,\nR,0.36,0,,rod slider,\n\
                 P,0.36,0,0,ground slider,0\nR,0.2,0.1,,rod,no\n";
    assert_eq!(definition(Form::Table, text), definition(Form::Table, plain));
    assert_eq!(definition(Form::Table, &format!("\u{feff}{text}")), definition(Form::Table, plain));
    assert_says(&refusal(Form::Table, &plain.replace("no\n", "maybe\n")), &["line 6", "driven = \"maybe\""]);
}

/// A slider-crank in a link of PMKS+ from 2022, in the form of its template.
#[test]
fn old_link_of_pmks_plus() {
    let link = "https://pmks.example/?j=A,0,0,AB,R,t,0,0.1,t,%0AB,8,6,AB%7CBC,R,f,0,0.1,f,%0A\
        C,36,0,BC,P,t,0,0.1,f,%0A&l=\
                AB,1.5,0.0025,4,3,A%7CB,,l,0,0,8,0,8,6,0,6%0ABC,0.9,0.009,22,3,B%7CC,,l,8,0,36,0,36,6,8,6%0A\
                &f=F1,BC,20,1,20,4,t,true,0,100%0A&pp=&tp=&s=20,true,false,cm";
    let mut hand = slider_crank();
    let rod = f64::hypot(0.28, 0.06);
    hand["bodies"]["crank"] = json!({ "length": 0.1, "mass": 1.5, "center": [0.05, 0], "inertia": 0.0025 });
    hand["bodies"]["rod"] = json!({ "length": rod, "mass": 0.9, "center": [0.5 * rod, 0], "inertia": 0.009 });
    hand["bodies"]["slider"] = json!({});
    hand["start"]["speed"] = json!(-20.0 * 2.0 * PI / 60.0);
    let pairs =
        [("AB.speed", "crank.speed", 0.0), ("BC.speed", "rod.speed", 0.0), ("C.position", "guide.position", 0.36)];
    let inputs = [("drive.torque", 0.4), ("motor.torque", 0.4)];
    let notes = compare(Form::PmksPlus, link, &hand, inputs, &pairs);
    assert_says(&notes.join("\n"), &["lengths are read in cm", "F1,BC", "their direction differs"]);
    // Without masses the input turns at its speed.
    let bare = link.replace("AB,1.5,0.0025", "AB,0,0").replace("BC,0.9,0.009", "BC,0,0");
    let imported = import(Form::PmksPlus, "Imported", &bare).unwrap();
    assert_says(&imported.notes.join("\n"), &["no link has a mass"]);
    let mut run = Simulation::open(&imported.definition).unwrap();
    run.initialize().unwrap();
    run.step(0.1).unwrap();
    let turn = -20.0 * 2.0 * PI / 60.0;
    let (sin, cos) = (f64::atan2(0.06, 0.08) + 0.1 * turn).sin_cos();
    let expected = -turn * 0.1 * sin * (1.0 + 0.1 * cos / (rod * rod - 0.01 * sin * sin).sqrt());
    assert!((run.get("AB.speed").unwrap() - turn).abs() < 1e-12);
    assert!((run.get("C.speed").unwrap() - expected).abs() < 1e-10, "{} {expected}", run.get("C.speed").unwrap());
    // The oldest links contain neither angles nor friction.
    let short = link.replace("0,0.1,t,%0A", "Null,t%0A").replace("0,0.1,f,%0A", "Null,f%0A");
    assert_eq!(definition(Form::PmksPlus, link), definition(Form::PmksPlus, &short));
    assert_says(
        &refusal(Form::PmksPlus, &link.replace("P,t,0,", "P,t,30,")),
        &["j: C,36,0", "angle 30", "--form table"],
    );
    assert_says(
        &refusal(Form::PmksPlus, &link.replace("s=20,true,false,cm", "s=20,true,false,ft")),
        &["\"ft\" is unknown"],
    );
}

/// Projects of Pyslvs, in blocks and on one line.
#[test]
fn project_of_pyslvs() {
    let expected = definition(Form::Pyslvs, include_str!("files/quick_return.pyslvs"));
    for text in [include_str!("files/project.pyslvs"), include_str!("files/project_compressed.pyslvs")] {
        let imported = import(Form::Pyslvs, "Imported", text).unwrap();
        let own: Value = serde_json::from_str(&imported.definition).unwrap();
        assert_eq!([&own["bodies"], &own["joints"]], [&expected["bodies"], &expected["joints"]]);
        // The input is the second pivot on the ground, not the first.
        assert_eq!(own["actuators"]["drive"]["joint"], "joint_3");
        assert_says(&imported.notes.join("\n"), &["path is left out: recorded paths", "storage is left out"]);
    }
    let text = include_str!("files/project.pyslvs");
    assert_says(&refusal(Form::Pyslvs, &text.replace("- - 2", "- - 9")), &["the project has 4 points", "[9"]);
}
