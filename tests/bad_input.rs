//! Bad input as a user sees it: each message names the key or variable, the value, what is allowed or what to do.
#![allow(clippy::unwrap_used)]

use linkage_fmu::model::Model;

const GEAR: &str = include_str!("../modelDescription/LandingGearRetraction/resources/mechanism.json");

/// What reading and starting this text gives; one line.
fn refusal(text: &str) -> String {
    let error = match Model::from_json(text) {
        Err(error) => error,
        Ok(_) => panic!("accepted: {text}"),
    };
    let line = error.to_string();
    assert!(!line.contains('\n'), "more than one line: {line}");
    line
}

fn check(text: &str, fragments: &[&str]) {
    let line = refusal(text);
    for fragment in fragments {
        assert!(line.contains(fragment), "`{line}` lacks `{fragment}`");
    }
}

/// The gear with one piece of its text replaced.
fn changed(from: &str, to: &str) -> String {
    assert!(GEAR.contains(from), "the gear has no {from}");
    GEAR.replacen(from, to, 1)
}

#[test]
fn text_that_is_no_mechanism() {
    for (text, fragments) in [
        ("", &["no mechanism", "EOF", "line 1"][..]),
        ("{", &["no mechanism", "EOF", "line 1"]),
        ("[]", &["expected struct Mechanism", "line 1"]),
        ("null", &["no mechanism", "line 1"]),
        ("{ \"name\": \"A\", }", &["trailing comma", "line 1 column 16"]),
        ("{ name: 1 }", &["key must be a string", "line 1"]),
        ("{ \"name\": \"A\" }", &["no mechanism", "missing field `bodies`"]),
    ] {
        check(text, fragments);
    }
}

#[test]
fn keys_and_types() {
    for (from, to, fragments) in [
        ("\"mass\": 13.689", "\"mas\": 13.689", &["bodies.crank.mas", "`mas`", "`mass`", "line"][..]),
        ("\"mass\": 13.689", "\"ma\\nss\": 13.689", &["bodies.crank.ma\\nss", "`ma\\nss`", "`mass`"]),
        ("\"mass\": 13.689", "\"mass\": \"13\"", &["bodies.crank.mass", "\"13\"", "f64", "line"]),
        ("\"length\": 0.1755", "\"length\": 1e999", &["bodies.crank.length", "out of range", "line"]),
        ("\"length\": 0.1755", "\"length\": NaN", &["bodies.crank.length", "line"]),
        ("\"shape\": \"uniform_rod\"", "\"shape\": \"sphere\"", &["bodies.crank.shape", "`sphere`", "`uniform_rod`"]),
        ("revolute", "hinge", &["joints.joint1.type", "`hinge`", "`revolute` or `prismatic`"]),
        ("[-0.050, -0.138]", "[-0.050]", &["bodies.crank.points.actuator", "length 1", "array of length 2"]),
        ("[-0.050, -0.138]", "[-0.050, true]", &["bodies.crank.points.actuator[1]", "`true`", "f64"]),
        (", \"second\": \"coupler.origin\"", "", &["joints.joint2", "missing field `second`"]),
        ("\"joint2\":", "\"joint1\":", &["joints.joint1", "stands twice"]),
        ("\"stop_time\": 0.13, ", "", &["experiment", "missing field `stop_time`"]),
        ("\"name\": \"LandingGearRetraction\"", "\"name\": \"Landing Gear\"", &["name = \"Landing Gear\"", "letter"]),
        ("\"follower\": { \"on\"", "\"f-1\": { \"on\"", &["torques = \"f-1\"", "letter"]),
    ] {
        check(&changed(from, to), fragments);
    }
}

#[test]
fn numbers_out_of_range() {
    for (from, to, fragments) in [
        ("\"mass\": 13.689", "\"mass\": -1", &["bodies.crank.mass", "= -1", ">= 0"][..]),
        ("\"length\": 0.1755", "\"length\": 0", &["bodies.crank.length", "= 0", "> 0"]),
        ("\"length\": 0.1755", "\"length\": -0.1755", &["bodies.crank.length", "= -0.1755", "> 0"]),
        ("\"mass\": 19.5 }", "\"mass\": 19.5, \"inertia\": -2 }", &["bodies.wheel.inertia", "= -2", ">= 0"]),
        ("\"acceleration\": 9.81", "\"acceleration\": -9.81", &["gravity.acceleration", "= -9.81", ">= 0"]),
        ("\"force\": 30000", "\"force\": 1, \"efficiency\": 1.2", &["actuators.actuator.efficiency", "1.2", "<= 1"]),
        ("\"tolerance\": 1e-9", "\"tolerance\": 1", &["solver.tolerance", "= 1", "1e-14"]),
        ("\"stop_time\": 0.13", "\"stop_time\": 0", &["experiment.stop_time", "= 0", "> 0"]),
    ] {
        check(&changed(from, to), fragments);
    }
}

#[test]
fn names_that_nothing_carries() {
    for (from, to, fragments) in [
        ("crank.end", "crunk.end", &["joints.joint2.first", "\"crunk.end\"", "bodies are ground, crank"][..]),
        ("crank.end", "crank.tip", &["joints.joint2.first", "\"crank.tip\"", "origin, end, actuator"]),
        ("crank.end", "crank", &["joints.joint2.first", "body.point"]),
        ("\"coupler.end\"", "\"coupler.origin.end\"", &["joints.joint3.first", "origin, end"]),
        ("\"on\": \"crank\"", "\"on\": \"crnk\"", &["torques.crank.on", "\"crnk\"", "bodies are"]),
        (
            "\"start\": { \"body\": \"crank\"",
            "\"start\": { \"body\": \"crnk\"",
            &["start.body", "\"crnk\"", "bodies are"],
        ),
        ("\"leg.end\"", "\"wheel.origin\"", &["bodies.wheel.fixed_to", "circle"]),
        ("\"coupler\": 0.46", "\"copuler\": 0.46", &["guess.copuler", "crank, coupler, follower"]),
        ("\"coupler\": 0.46", "\"coupler\": 1e308", &["guess.coupler", "1e100"]),
        (", \"coupler\": 0.46", "", &["guess.coupler", "missing", "rough angle [rad]"]),
    ] {
        check(&changed(from, to), fragments);
    }
}

#[test]
fn linkages_that_cannot_move_as_one() {
    // Two degrees of freedom, none, and a body that hangs on nothing.
    let without = ",\n    \"joint4\": { \"type\": \"revolute\", \"first\": \"ground.end\", \"second\": \"follower.origin\", \"pin_radius\": 0.015 }";
    check(&changed(without, ""), &["3 degrees of freedom", "must have 1"]);
    let more = "\"joint1\": { \"type\": \"revolute\", \"first\": \"ground.origin\", \"second\": \"coupler.end\" },\n    \"joint0\":";
    let text = changed("\"length\": 0.217", "\"length\": 0.317").replace("\"joint1\":", more);
    check(&text, &["the loops do not close", "stays open by", "guess"]);
    check(&changed("\"coupler\": {", "\"loose\": {}, \"coupler\": {"), &["bodies.loose", "ground", "add a joint"]);
    let fixed = "\"joint5\": { \"type\": \"revolute\", \"first\": \"ground.rest\", \"second\": \"crank.rest\" },\n    \"joint1\":";
    let text = changed("\"joint1\":", fixed)
        .replace(
            "\"ground\": { \"length\": 0.5729 }",
            "\"ground\": { \"length\": 0.5729, \"points\": { \"rest\": [0, 0.1] } }",
        )
        .replace("[-0.050, -0.138]", "[-0.050, -0.138], \"rest\": [0.0717356090899523, 0.0696706709347165]");
    check(&text, &["0 degrees of freedom", "remove a joint"]);
    check(&changed("\"length\": 0.217", "\"length\": 0.001"), &["the loops do not close", "stays open by", "lengths"]);
    check(&changed("\"second\": \"crank.origin\"", "\"second\": \"ground.end\""), &["joints.joint1", "to itself"]);
}

#[test]
fn loads_without_a_direction() {
    let force = "\"first\": \"crank.actuator\", \"second\": \"follower.actuator\"";
    let one = force.replace("follower.actuator", "crank.actuator");
    check(&changed(force, &one), &["actuators.actuator", "one point", "name two points"]);
    let one = force.replace("follower.actuator", "leg.end");
    check(&changed(force, &one), &["actuators.actuator", "both ends are on crank", "name two bodies"]);
    let met = force.replace("crank.actuator", "coupler.origin").replace("follower.actuator", "crank.end");
    check(&changed(force, &met), &["actuators.actuator", "the one point of joint2", "name two points"]);
    // The piston's eye passes through the bracket once in a turn.
    let bracket = changed("{ \"length\": 0.5729 }", "{ \"length\": 0.5729, \"points\": { \"bracket\": [0.1755, 0] } }");
    check(
        &bracket.replace(force, "\"first\": \"ground.bracket\", \"second\": \"crank.end\""),
        &["actuator", "ends coincide near", "move one of its attachments"],
    );
    let spring = changed("\"markers\":", "\"springs\": { \"coil\": { \"first\": \"crank.end\" } },\n  \"markers\":");
    check(&spring, &["springs.coil", "give first and second, or joint"]);
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
    check(&rods("0.1", "1", "0.5", "0.5"), &["reduced inertia vanishes at left = 0.5", "give a mass or an inertia"]);
    check(&rods("0.1", "0", "0.5", "0.5"), &["reduced inertia vanishes", "give a mass or an inertia"]);
    // Flat: parallelogram and antiparallelogram meet.
    let massive = |text: String| text.replace("\"mass\": 1", "\"mass\": 1, \"shape\": \"uniform_rod\"");
    check(
        &massive(rods("0.1", "1", "0", "0")),
        &["two branches of motion cross at the guess", "guess a position off the crossing", "start may still"],
    );
    Model::from_json(&massive(rods("0.1", "1", "0", "0.5"))).unwrap();
    // The longer rod only swings; where it turns back, nothing with mass moves.
    let swings = massive(rods("0.15", "1", "3.1", "0.9"));
    check(&swings, &["reduced inertia vanishes at left = 2.168", "give a mass or an inertia"]);
    check(
        &swings.replace("\"right\": { ", "\"right\": { \"inertia\": 0.01, "),
        &["left.start_angle = 3.1", "cannot be reached", "moves from", "to"],
    );
}

#[test]
fn starts_that_contradict_themselves() {
    let start = "{ \"body\": \"crank\", \"angle\": 0.8, \"speed\": 0 }";
    for (to, fragments) in [
        ("{ \"body\": \"crank\" }", &["start", "body and angle, or joint and position"][..]),
        ("{ \"joint\": \"joint1\", \"position\": 0.8 }", &["start.joint", "prismatic"]),
        ("{ \"joint\": \"slot\", \"position\": 0.8 }", &["start.joint", "\"slot\"", "joint1, joint2"]),
        ("{ \"body\": \"ground\", \"angle\": 0.8 }", &["start", "ground", "crank, coupler, follower"]),
        ("{ \"body\": \"crank\", \"angle\": 0.8, \"velocity\": 1 }", &["start.velocity", "`velocity`", "`speed`"]),
    ] {
        check(&changed(start, to), fragments);
    }
}

/// A byte order mark, which some editors write, is no fault.
#[test]
fn a_byte_order_mark_is_read_over() {
    Model::from_json(&format!("\u{feff}{GEAR}")).unwrap();
}
