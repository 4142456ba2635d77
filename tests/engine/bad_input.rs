//! Messages about bad input: each message is one line that names the key or variable, the value, and the limit or
//! remedy.

use crate::support::{self, GEAR, Run, TWO_DRIVES, assert_rejected, assert_says};
use linkage_fmu::component::Component;
use linkage_fmu::mechanism::Model;
use serde_json::{Value, json};
use std::f64::consts::PI;

/// The message of the error that reading this text returns.
fn refusal(text: &str) -> String {
    let line = Model::from_json(text).map_or_else(|error| error.to_string(), |_| panic!("accepted: {text}"));
    assert!(!line.contains('\n'), "more than one line: {line}");
    line
}

fn check(text: &str, fragments: &[&str]) {
    assert_says(refusal(text), fragments);
}

/// The text of the gear with the first occurrence of `from` replaced by `to`.
fn changed(from: &str, to: &str) -> String {
    assert!(GEAR.contains(from), "the gear has no {from}");
    GEAR.replacen(from, to, 1)
}

#[test]
fn text_that_is_no_mechanism() {
    for (text, fragments) in [
        ("", &["not a valid mechanism", "the file is empty"][..]),
        ("{", &["not a valid mechanism", "ends before", "line 1"]),
        ("[]", &["an object { }", "not a list", "line 1"]),
        ("null", &["not a valid mechanism", "line 1"]),
        (r#"{ "name": "A", }"#, &["a comma stands before the closing bracket", "line 1, column 16"]),
        ("{ name: 1 }", &["key in double quotes", "line 1"]),
        (r#"{ "name": "A" }"#, &["not a valid mechanism", "`bodies` is missing: add this key"]),
    ] {
        check(text, fragments);
    }
}

#[test]
fn keys_and_types() {
    for (from, to, fragments) in [
        (r#""mass": 13.689"#, r#""mas": 13.689"#, &["bodies.crank.mas", "`mas`", "`mass`", "line"][..]),
        (r#""mass": 13.689"#, "\"ma\\nss\": 13.689", &["bodies.crank.ma\\nss", "`ma\\nss`", "`mass`"]),
        (r#""mass": 13.689"#, r#""mass": true"#, &["bodies.crank.mass", "not true", "must be a number", "line"]),
        (r#""mass": 13.689"#, r#""mass": "13 kg""#, &["bodies.crank.mass", r#""13 kg""#, "write 13", "in kg"]),
        (r#""mass": 13.689"#, r#""mass": "13 lb""#, &["bodies.crank.mass", "the number in kg"]),
        (r#""crank": 0.8"#, r#""crank": "46 deg""#, &["guess.crank", "write 0.8028514559 without a unit", "in rad"]),
        (r#""stop_time": 0.15"#, r#""stop_time": "150 ms""#, &["experiment.stop_time", "write 0.15 ", "is in s"]),
        (r#""stop_time": 0.15"#, r#""stop_time": "1 N""#, &["experiment.stop_time", "the number in s, without"]),
        (r#""force": 30000"#, r#""force": "40 kN""#, &["force: ", "write 40000 ", "is in N"]),
        (r#""bodies": {"#, r#""parameters": { "p": "4 kN" }, "bodies": {"#, &[r#"{ "value": 4000, "unit": "N" }"#]),
        (r#""actuators": {"#, r#""actuator": {"#, &["actuator", "did you mean `actuators`?"]),
        (
            r#""length": 0.1755"#,
            r#""length": 1e999"#,
            &["bodies.crank.length", "larger than the largest number", "line"],
        ),
        (r#""length": 0.1755"#, r#""length": NaN"#, &["bodies.crank.length", "line"]),
        (r#""shape": "uniform_rod""#, r#""shape": "sphere""#, &["bodies.crank.shape", "`sphere`", "`uniform_rod`"]),
        ("revolute", "hinge", &["joints.joint1.type", "not `hinge`", "`revolute`, `prismatic` or `slot`"]),
        ("[-0.050, -0.138]", "[-0.050]", &["bodies.crank.points.actuator", "a list of 2 numbers", "not a list of 1"]),
        ("[-0.050, -0.138]", "[-0.050, true]", &["bodies.crank.points.actuator[1]", "not true", "must be a number"]),
        (r#", "second": "coupler.origin""#, "", &["joints.joint2", "`second` is missing: add this key"]),
        (r#""joint2":"#, r#""joint1":"#, &["joints.joint1", "occurs twice"]),
        (r#""stop_time": 0.15, "#, "", &["experiment", "`stop_time` is missing"]),
        (r#""name": "LandingGearRetraction""#, r#""name": "Landing Gear""#, &[r#"name = "Landing Gear""#, "letter"]),
        (r#""follower": { "on""#, r#""f-1": { "on""#, &[r#"torques = "f-1""#, "letter"]),
    ] {
        check(&changed(from, to), fragments);
    }
    let other = changed(r#""name": "#, r#""units": { "length": "mm", "angle": "deg" }, "name": "#);
    for (from, to, fragments) in [
        (r#""crank": 0.8"#, r#""crank": "0.5 rad""#, &["guess.crank", "write 28.64788976 ", "is in deg"]),
        ("[-0.050,", r#"["-0.75 m","#, &["points.actuator[0]", "write -750 ", "is in mm"]),
    ] {
        check(&other.replacen(from, to, 1), fragments);
    }
}

/// Values that a lenient reader would accept: a list for an object, null for an optional key, an object for a word.
#[test]
fn other_kinds_of_values() {
    let sequence = &["must be an object { }", "not a list [ ]", "line"][..];
    let null = &["not null", "line", "leave the key out"][..];
    let air =
        r#""air": { "density": 1.225, "flow_angle": -0.4407963267948966, "relative_wind": false, "airspeed": 0 }"#;
    for (from, to, key, fragments) in [
        (
            r#""solver": { "tolerance": 1e-9, "method": "reduced", "fem_step": 1e-5 }"#,
            r#""solver": [1e-9, null, null, true]"#,
            "solver",
            sequence,
        ),
        (air, r#""air": [1, 0, false, 0]"#, "air", sequence),
        (r#""bodies": {"#, r#""markers": { "m": ["crank.end"] }, "bodies": {"#, "markers.m", sequence),
        (r#""mass": 13.689"#, r#""mass": null"#, "bodies.crank.mass", null),
        (r#""mass": 13.689"#, r#""points": null"#, "bodies.crank.points", null),
        (r#""shape": "uniform_rod""#, r#""shape": null"#, "bodies.crank.shape", null),
        (air, r#""air": null"#, "air", null),
        (r#""revolute""#, r#"{ "revolute": null }"#, "joints.joint1.type", &["not an object", "a word"]),
    ] {
        let start = refusal(&changed(from, to));
        assert!(start.starts_with(&format!("{key}: ")), "`{start}` does not begin with `{key}`");
        check(&changed(from, to), fragments);
    }
}

#[test]
fn definitions_with_a_change() {
    assert_rejected("gear", GEAR);
    assert_rejected("two drives", TWO_DRIVES);
}

#[test]
fn names_of_missing_elements() {
    for (from, to, fragments) in [
        (r#""coupler.end""#, r#""coupler.origin.end""#, &["joints.joint3.first", "origin, end"]),
        (r#""leg.end""#, r#""wheel.origin""#, &["bodies.wheel.fixed_to", "circle"]),
    ] {
        check(&changed(from, to), fragments);
    }
}

#[test]
fn linkages_that_cannot_move_as_one() {
    // Wrong numbers of degrees of freedom, loops that cannot close, and a body without a joint.
    let without = ",\n    \"joint4\": { \"type\": \"revolute\", \"first\": \"ground.end\", \"second\": \
                   \"follower.origin\", \"pin_radius\": 0.015 }";
    check(&changed(without, ""), &["3 degrees of freedom", "must have 1"]);
    let more = "\"joint1\": { \"type\": \"revolute\", \"first\": \"ground.origin\", \"second\": \"coupler.end\" \
        },\n    \"joint0\":";
    let text = changed(r#""length": 0.217"#, r#""length": 0.317"#).replace(r#""joint1":"#, more);
    check(&text, &["cannot close", "on coupler are 0.317 m apart", "reach over only 0.1755 m"]);
    check(&changed(r#""coupler": {"#, r#""loose": {}, "coupler": {"#), &["bodies.loose", "ground", "add a joint"]);
    let fixed = "\"joint5\": { \"type\": \"revolute\", \"first\": \"ground.rest\", \"second\": \"crank.rest\" \
        },\n    \"joint1\":";
    let text = changed(r#""joint1":"#, fixed)
        .replace(
            r#""ground": { "length": 0.5729 }"#,
            r#""ground": { "length": 0.5729, "points": { "rest": [0, 0.1] } }"#,
        )
        .replace("[-0.050, -0.138]", r#"[-0.050, -0.138], "rest": [0.0717356090899523, 0.0696706709347165]"#);
    check(&text, &["0 degrees of freedom", "remove a joint"]);
    check(
        &changed(r#""length": 0.217"#, r#""length": 0.001"#),
        &["cannot close", "on ground are 0.5729 m apart", "reach over only 0.5165 m"],
    );
    // The ground is exactly as long as both bars together: the loop equations are singular, but the bars cannot move.
    let triangle = r#"{ "name": "Straight", "bodies": { "ground": { "length": 0.2 }, "a": { "length": 0.1, "mass": 1 },
        "c": { "length": 0.1, "mass": 1 }, "wheel": { "mass": 1, "inertia": 0.1 } },
        "joints": { "p": { "type": "revolute", "first": "ground.origin", "second": "a.origin" },
        "q": { "type": "revolute", "first": "a.end", "second": "c.end" },
        "r": { "type": "revolute", "first": "ground.end", "second": "c.origin" },
        "w": { "type": "revolute", "first": "ground.origin", "second": "wheel.origin" } },
        "start": { "body": "wheel", "angle": 0 }, "guess": { "a": 0, "c": 3.141592653589793, "wheel": 0 } }"#;
    check(triangle, &["stretched flat", "on ground are 0.2 m apart", "reach over exactly 0.2 m (a 0.1 m, c 0.1 m)"]);
    // Crank and rod just reach the axis of the slide, for several guesses and gaps: a rigid position, not a crossing.
    for (lack, guess) in
        [(0.0, [0.5, -0.2, 0.02]), (0.0, [0.0; 3]), (1e-9, [0.1, -0.1, 0.01]), (1e-7, [0.1, -0.1, 0.01])]
    {
        let slide = json!({ "name": "Flat", "bodies": { "ground": { "points": { "far": [0.4 * (1.0 - lack), 0] } },
            "crank": { "length": 0.1, "mass": 1 }, "rod": { "length": 0.3, "mass": 1 }, "block": { "mass": 1 } },
            "joints": { "p": { "type": "revolute", "first": "ground.origin", "second": "crank.origin" },
            "q": { "type": "revolute", "first": "crank.end", "second": "rod.origin" },
            "r": { "type": "revolute", "first": "rod.end", "second": "block.origin" },
            "s": { "type": "prismatic", "first": "ground.far", "second": "block.origin", "axis_angle": PI / 2.0 } },
            "start": { "body": "crank", "angle": 0 }, "guess": { "crank": guess[0], "rod": guess[1], "s": guess[2] } });
        check(&slide.to_string(), &["flat", "across the slide s", "0.4 m", "(crank 0.1 m, rod 0.3 m)", "nearer"]);
    }
    check(&changed(r#""second": "crank.origin""#, r#""second": "ground.end""#), &["joints.joint1", "to itself"]);
}

#[test]
fn loads_without_a_direction() {
    let force = r#""first": "crank.actuator", "second": "follower.actuator""#;
    let one = force.replace("follower.actuator", "crank.actuator");
    check(&changed(force, &one), &["actuators.actuator", "both ends are the same point", "give two different points"]);
    let one = force.replace("follower.actuator", "leg.end");
    check(&changed(force, &one), &["actuators.actuator", "both ends are on crank", "give points of two bodies"]);
    let met = force.replace("crank.actuator", "coupler.origin").replace("follower.actuator", "crank.end");
    check(
        &changed(force, &met),
        &["actuators.actuator", "both ends are the point joint2", "give two different points"],
    );
    let spring = changed(r#""markers":"#, "\"springs\": { \"coil\": { \"first\": \"crank.end\" } },\n  \"markers\":");
    check(&spring, &["springs.coil", "give the keys \"first\" and \"second\", the key \"joint\"", "\"first_body\""]);
}

const RODS: &str = r#"{
  "name": "FourBar", "bodies": {
    "ground": { "length": 0.4 }, "left": { "length": LEFT, "mass": MASS }, "coupler": { "length": 0.4 },
    "right": { "length": 0.1 }
  },
  "joints": {
    "a": { "type": "revolute", "first": "ground.origin", "second": "left.origin" },
    "b": { "type": "revolute", "first": "left.end", "second": "coupler.origin" },
    "c": { "type": "revolute", "first": "coupler.end", "second": "right.end" },
    "d": { "type": "revolute", "first": "ground.end", "second": "right.origin" }
  },
  "start": { "body": "left", "angle": START }, "guess": { "left": GUESS, "coupler": 0, "right": GUESS }
}"#;

fn rods(left: &str, mass: &str, start: &str, guess: &str) -> String {
    RODS.replace("LEFT", left).replace("MASS", mass).replace("START", start).replace("GUESS", guess)
}

#[test]
fn positions_without_an_answer() {
    // A point mass in the bearing of the left rod never moves.
    check(&rods("0.1", "1", "0.5", "0.5"), &["almost zero at left = 0.5", "add a mass or an inertia"]);
    // Without any mass the program computes the motion alone.
    Model::from_json(&rods("0.1", "0", "0.5", "0.5")).unwrap();
    // In the flat position the branches of the parallelogram and of the antiparallelogram cross.
    let massive = |text: String| text.replace(r#""mass": 1"#, r#""mass": 1, "shape": "uniform_rod""#);
    check(
        &massive(rods("0.1", "1", "0", "0")),
        &["two branches of motion cross at the guess", "from the crossing", "`start` contains"],
    );
    Model::from_json(&massive(rods("0.1", "1", "0", "0.5"))).unwrap();
    // The longer rod oscillates. In its extreme position no body with mass moves.
    let swings = massive(rods("0.15", "1", "3.1", "0.9"));
    check(&swings, &["almost zero at left = 2.168", "add a mass or an inertia"]);
    check(
        &swings.replace(r#""right": { "#, r#""right": { "inertia": 0.01, "#),
        &["left.start_angle = 3.1 rad", "cannot be reached", "moves from", "to"],
    );
}

/// Some editors write a byte order mark. A byte order mark is accepted.
#[test]
fn a_byte_order_mark_is_read_over() {
    Model::from_json(&format!("\u{feff}{GEAR}")).unwrap();
}

/// The slider-crank with changed values. Each path has the form `section.name`.
fn slider_crank(changes: &[(&str, Value)]) -> String {
    support::changed(TWO_DRIVES, |mechanism| {
        for (path, value) in changes {
            *path.split('.').fold(&mut *mechanism, |object, key| &mut object[key]) = value.clone();
        }
    })
}

#[test]
fn locks_that_cannot_act() {
    for (at, fragments) in [
        (
            "ground.end",
            &["locks.uplock.at", "ground.end is on the ground", "has no effect", "give a point that moves"][..],
        ),
        (
            "crank.origin",
            &["locks.uplock.at", "does not move at the position of upstop, near crank = -1.3", "use a point that"],
        ),
    ] {
        let lock = format!("\"uplock\": {{ \"stop\": \"upstop\", \"at\": \"{at}\" }}");
        check(&changed(r#""uplock": { "stop": "upstop", "at": "wheel.origin" }"#, &lock), fragments);
    }
    // At the dead centre no force on the slider holds the mechanism. One degree away from the dead centre a force does.
    let held = |angle: f64, at: &str| {
        slider_crank(&[
            ("stops", json!({ "far": { "body": "crank", "limit": "upper", "angle": angle } })),
            ("locks", json!({ "latch": { "stop": "far", "at": at } })),
        ])
    };
    let dead_centre = PI;
    check(
        &held(dead_centre, "slider.origin"),
        &["locks.latch.at", "does not move at the position of far, near crank = 3.14"],
    );
    Model::from_json(&held(dead_centre, "crank.end")).unwrap();
    Model::from_json(&held(dead_centre - 0.017, "slider.origin")).unwrap();
}

/// Positions in messages agree with the outputs, including whole turns.
#[test]
fn positions_in_messages_are_those_of_the_outputs() {
    let friction = json!({ "enabled": true, "static_coefficient": 0.1, "kinetic_coefficient": 0.1 });
    let text = slider_crank(&[
        ("joints.bearing.pin_radius", 1e9.into()),
        ("friction", friction),
        ("start.speed", 1.into()),
        ("start.angle", 13.0.into()),
    ]);
    let mut run = Run::new(&text).started();
    let line = run.0.undefined("crank.acceleration").unwrap().unwrap();
    let position = format!("near crank = {:.6} rad, rod = {:.6} rad", run.get("crank.angle"), run.get("rod.angle"));
    assert_says(line, &[&position]);
    assert_says(position, &["13.000000"]);
}

#[test]
fn starts_out_of_reach() {
    // With its stops the gear moves between the two stops. Without the lower stop it moves to its toggle.
    let start = |stated: &str| changed("\"angle\": 0.8, \"speed\"", &format!("\"angle\": {stated}, \"speed\""));
    let free = |text: &str| text.replace(r#""angle": -1.3, "#, r#""angle": -1.3, "enabled": false, "#);
    check(&start("0.9"), &["downstop.angle = 0.8", "the start, at 0.9 rad, is beyond this stop"]);
    check(&start("-1.4"), &["upstop.angle = -1.3", "the start, at -1.4 rad, is beyond this stop"]);
    check(&free(&start("-1.4")), &["crank.start_angle = -1.4 rad cannot", "moves from -1.325844931 rad to 0.8 rad"]);
    // The start is stated by another body of the same group: the message states the range in the angle of this body.
    let by_leg = start("-3.8").replace(r#""start": { "body": "crank""#, r#""start": { "body": "leg""#);
    check(&free(&by_leg), &["leg.start_angle = -3.8 rad cannot", "moves from -3.725844931 rad to -1.6 rad"]);
    // The follower has no stop, but the stops of the crank also limit the follower.
    let by_follower = start("4.5").replace(r#""start": { "body": "crank""#, r#""start": { "body": "follower""#);
    check(
        &by_follower,
        &["follower.start_angle = 4.5 rad cannot be reached", "moves from 2.409512947 rad to 3.350866873 rad"],
    );
    // An angle that differs by whole turns is the same position, but another value.
    let around = start("7.0");
    let text =
        around.replace(r#""limit": "upper", "angle": 0.8"#, r#""limit": "upper", "enabled": false, "angle": 0.8"#);
    check(
        &text,
        &["crank.start_angle = 7 rad cannot be reached", "0.7168146928 rad is the same position: write this value"],
    );
    let degrees = text.replace(r#""angle": 7.0"#, r#""angle": 45"#);
    check(&degrees, &["crank.start_angle = 45 rad cannot be reached", "; if you mean 45 degrees, write 45deg after"]);
    // A crank that rotates fully may start in any turn.
    Model::from_json(&slider_crank(&[("start.angle", 700.into())])).unwrap();
}

#[test]
fn angles_that_count_too_many_turns() {
    for (path, line) in [
        ("guess.crank", "guess.crank = 1000000000 rad: must be an angle from -1e6 rad to 1e6 rad"),
        ("start.angle", "start.angle = 1000000000 rad: must be an angle from -1e6 rad to 1e6 rad"),
    ] {
        assert_eq!(refusal(&slider_crank(&[(path, 1e9.into())])), line);
    }
    Model::from_json(&slider_crank(&[("guess.crank", (0.9 + 2e3 * std::f64::consts::TAU).into())])).unwrap();
}

/// Two bars and the ground are a rigid triangle. A third bar rotates freely.
#[test]
fn a_rigid_loop_is_reported_with_its_bodies_and_those_that_still_move() {
    let text = |start: &str| {
        json!({
            "name": "Triangle",
            "bodies": {
                "ground": { "length": 0.4 }, "left": { "length": 0.3, "mass": 1.0 }, "right": { "length": 0.3,
                    "mass": 1.0 },
                "spinner": { "length": 0.1, "mass": 1.0, "inertia": 0.01 }
            },
            "joints": {
                "a": { "type": "revolute", "first": "ground.origin", "second": "left.origin" },
                "b": { "type": "revolute", "first": "left.end", "second": "right.end" },
                "c": { "type": "revolute", "first": "ground.end", "second": "right.origin" },
                "d": { "type": "revolute", "first": "ground.end", "second": "spinner.origin" }
            },
            "start": { "body": start, "angle": 1.2 },
            "guess": { "left": 0.8, "right": 2.3, "spinner": 1.0 }
        })
        .to_string()
    };
    Model::from_json(&text("spinner")).unwrap();
    // cos(angle of the left bar) = 0.2 / 0.3.
    let held = (2.0_f64 / 3.0).acos();
    let held = format!("hold left at {held:.10}");
    check(&text("left"), &["left.start_angle = 1.2", &held, "rigid", "spinner moves freely", "remove a joint"]);
    // Gears 24:24 from sun to planet and from ground to planet hold the sun in place.
    let wheels = |first: &str| {
        json!({ "type": "gears", "first": first, "second": "planet.origin", "carrier": "arm", "first_teeth": 24,
            "second_teeth": 24 })
    };
    let planetary = json!({ "name": "Planetary",
        "bodies": { "ground": {}, "sun": { "inertia": 0.01 }, "arm": { "length": 0.1, "mass": 1 }, "planet": {
            "mass": 1 } },
        "joints": { "a": { "type": "revolute", "first": "ground.origin", "second": "sun.origin" },
            "b": { "type": "revolute", "first": "ground.origin", "second": "arm.origin" },
            "c": { "type": "revolute", "first": "arm.end", "second": "planet.origin" } },
        "couplings": { "inner": wheels("sun.origin"), "outer": wheels("ground.origin") },
        "start": { "body": "sun", "angle": 0.3 }, "guess": { "sun": 0, "arm": 0, "planet": 0 } });
    let says = ["hold sun at 0 rad", "joints or couplings", "arm, planet move freely", "a joint or a coupling"];
    check(&planetary.to_string(), &says);
}

#[test]
fn a_guess_of_an_element_without_a_coordinate_is_rejected_with_the_reason() {
    let text = |guess: Value| {
        json!({
            "name": "Carriage",
            "bodies": { "ground": { "length": 1.0 }, "carriage": { "length": 0.2, "mass": 1.0 } },
            "joints": {
                "rail": { "type": "prismatic", "first": "ground.origin", "second": "carriage.origin" },
                "guide": { "type": "prismatic", "first": "ground.end", "second": "carriage.end" }
            },
            "stops": {
                "in": { "joint": "guide", "limit": "lower", "position": 0.0 },
                "out": { "joint": "guide", "limit": "upper", "position": 1.0 }
            },
            "start": { "joint": "guide", "position": 0.3 },
            "guess": guess
        })
        .to_string()
    };
    // If two joints connect the same bodies, the first joint of the file has the position.
    Model::from_json(&text(json!({ "guide": 0.3 }))).unwrap();
    check(&text(json!({ "rail": 0.3, "guide": 0.1 })), &["guess.rail", "follows from other prismatic joints"]);
    check(&text(json!({ "guide": 0.3, "carriage": 0.0 })), &["guess.carriage", "does not turn", "remove this key"]);
    let pin = changed("\"guess\": { \"crank\": 0.8", "\"guess\": { \"joint2\": 1, \"crank\": 0.8");
    check(&pin, &["guess.joint2", "is a revolute joint", "angles of bodies"]);
}

#[test]
fn names_have_a_length_that_files_can_have() {
    let name = "N".repeat(300);
    check(
        &changed("\"LandingGearRetraction\"", &format!("\"{name}\"")),
        &["name", "300 letters", "at most 200", "shorten"],
    );
}

/// Restoring a state of another mechanism or another kind of model is an error and changes nothing.
#[test]
fn a_state_of_another_model_is_rejected() {
    const FOUR_BAR: &str = include_str!("../../modelDescription/FourBar/resources/mechanism.json");
    const ACTUATOR: &str = include_str!("../../modelDescription/HydraulicActuator/resources/hydraulics.json");
    let model = |file: &str, text: &str| {
        let mut model = Component::from_definition(file, text).unwrap();
        model.initialize().unwrap();
        model
    };
    let models = || [("mechanism.json", GEAR), ("mechanism.json", FOUR_BAR), ("hydraulics.json", ACTUATOR)];
    for (own, (file, text)) in models().into_iter().enumerate() {
        let mut one = model(file, text);
        for (other, (file, text)) in models().into_iter().enumerate() {
            let mut before = Vec::new();
            one.snapshot().write(&mut before).unwrap();
            let mut state = model(file, text).snapshot();
            let restored = one.restore(&state);
            if own == other {
                restored.unwrap();
                continue;
            }
            assert_says(restored.unwrap_err(), &["belongs to another model", "restore a state of a model with"]);
            let mut after = Vec::new();
            one.snapshot().write(&mut after).unwrap();
            assert_eq!(before, after);
            one.snapshot_into(&mut state);
            one.restore(&state).unwrap();
        }
    }
}
