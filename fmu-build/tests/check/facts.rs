//! Facts about mechanisms against closed forms.

use crate::support::definition::{With, pin, rod, slide};
use crate::support::{checked, fact, number, slider_crank, with};
use fmu_build::check;
use fmu_build::workspace::Workspace;
use serde_json::{Value, json};
use std::f64::consts::FRAC_PI_2;

#[test]
fn facts_of_a_slider_crank_are_those_of_the_closed_form() {
    let all = checked(&slider_crank().to_string());
    assert_eq!(all.findings.len(), 0, "{}", check::findings(&all));
    let near = |topic, of, name, expected: f64| {
        let value = number(&all, topic, of, name);
        assert!((value - expected).abs() < 1e-12, "{topic} {of} {name}: {value}, expected {expected}");
    };
    let (angle, slider) = (0.5_f64, |angle: f64| 0.1 * angle.cos() + (0.09 - (0.1 * angle.sin()).powi(2)).sqrt());
    near("Mass", "", "total", 3.0);
    near("Mass", "", "centre x", (0.05 * angle.cos() + 2.0 * slider(angle)) / 3.0);
    near("Mass", "", "centre y", 0.05 * angle.sin() / 3.0);
    near("Travel", "guide", "least", 0.2);
    near("Travel", "guide", "most", 0.4);
    near("Travel", "rod", "most", (1.0_f64 / 3.0).asin());
    near("Drives", "push", "stroke", 0.2);
    // Half of m l2 / 3 omega2 and of 2 kg v2. The ratio of slider speed to crank speed is a central difference.
    let rate = (slider(angle + 1e-6) - slider(angle - 1e-6)) / 2e-6;
    let inertia = number(&all, "Reduced mass", "motor", "start");
    assert!((inertia - (0.01 / 3.0 + 2.0 * rate * rate)).abs() < 1e-9, "{inertia}");
    near("Reduced mass", "motor", "least", 0.01 / 3.0);
    assert!(number(&all, "Reduced mass", "push", "most").is_infinite(), "dead centres of the slider");
    // The motor carries the weight of the crank at half its length. The slider moves normal to gravity.
    near("Equilibrium at the start", "motor", "holding", 10.0 * 0.05 * angle.cos());
    assert!(
        fact(&all, "Equilibrium at the start", "crank")
            .text
            .starts_with("at the start the loads move the mechanism (no equilibrium)")
    );
    let toggles = all.inspection.facts.iter().filter(|fact| fact.topic == "Toggles" && fact.of == "guide").count();
    assert_eq!(toggles, 2);
}

/// Angles, lengths and forces within rounding are printed as 0, and no large number represents infinity.
#[test]
fn rounding_errors_are_reported_as_zero() {
    let mut text = slider_crank();
    text["bodies"]["twin"] = json!({ "length": 0.1, "points": { "eye": [0.05, 0] } });
    for (name, first, at) in [("axis", "ground.origin", "origin"), ("twins", "crank.end", "end")] {
        text["joints"][name] = json!({ "type": "revolute", "first": first, "second": format!("twin.{at}") });
    }
    text["guess"]["twin"] = json!(0.5);
    text["bodies"]["crank"]["points"] = json!({ "eye": [0.05, 0] });
    text["actuators"]["idle"] = json!({ "joint": "twins" });
    text["actuators"]["short"] = json!({ "first": "ground.origin", "second": "twin.eye" });
    let all = checked(&text.to_string());
    for name in ["start", "least", "most", "stroke"] {
        assert_eq!(number(&all, "Drives", "idle", name), 0.0, "{name}");
    }
    assert_eq!(number(&all, "Drives", "short", "stroke"), 0.0);
    let messages: Vec<String> = all.findings.iter().map(|located| located.finding.to_string()).collect();
    let [idle, short] = &messages[..] else { panic!("{messages:#?}") };
    assert!(idle.contains("the angle is 0 rad in every position"), "{idle}");
    assert!(short.contains("the two ends are 0.05 m apart in every position"), "{short}");
    let lines: Vec<String> = all.inspection.facts.iter().map(|fact| check::line(fact, &all.units)).collect();
    assert!(lines.iter().all(|line| !line.contains("-0.000000") && !line.contains("e308")), "{lines:#?}");
    let small = |line: &String| line.contains("e-1") || line.contains("e-2") || line.contains("e-3");
    assert!(!lines.iter().any(small), "{lines:#?}");
}

#[test]
fn the_start_holds_in_balance_and_at_a_stop() {
    let balanced = with("/actuators/motor", json!({ "joint": "bearing", "torque": 0.5 * 0.5_f64.cos() }));
    assert!(fact(&checked(&balanced), "Equilibrium at the start", "crank").text.contains("balance"));
    // A pendulum that hangs straight down: the influence of gravity is the rounding of a cosine.
    let pendulum = json!({
        "name": "Pendulum", "gravity": { "acceleration": 9.81, "up_angle": 0.7 },
        "bodies": { "ground": {}, "rod": { "length": 1.0, "mass": 2.0, "shape": "uniform_rod" } },
        "joints": { "pin": { "type": "revolute", "first": "ground.origin", "second": "rod.origin" } },
        "start": { "body": "rod", "angle": 0.7 - std::f64::consts::PI }, "guess": { "rod": -2.0 }
    });
    let all = checked(&pendulum.to_string());
    assert!(fact(&all, "Equilibrium at the start", "rod").text.contains("balance"));
    for (name, expected) in [("stable position", 0.7 - std::f64::consts::PI), ("unstable position", 0.7)] {
        let equilibria = all.inspection.facts.iter().filter(|fact| fact.topic.starts_with("Equilibria"));
        let found = equilibria.flat_map(|fact| &fact.quantities).find(|quantity| quantity.name == name);
        let off = found.unwrap().value - expected;
        assert!((off / std::f64::consts::TAU - (off / std::f64::consts::TAU).round()).abs() < 1e-9, "{name}: {off}");
    }
    // A spring at its free angle, but for rounding.
    let mut sprung = slider_crank();
    sprung.as_object_mut().unwrap().remove("gravity");
    let free = -(0.1 * 0.5_f64.sin() / 0.3).asin() - 0.5 + 1e-15;
    sprung["springs"] = json!({ "coil": { "joint": "pin", "stiffness": 3, "free_angle": free } });
    let all = checked(&sprung.to_string());
    assert!(fact(&all, "Equilibrium at the start", "crank").text.contains("balance"));
    assert_eq!(number(&all, "Equilibrium at the start", "motor", "holding"), 0.0);
    let mut stopped: Value = serde_json::from_str(&balanced).unwrap();
    stopped["actuators"]["motor"]["torque"] = json!(-1.0);
    stopped["stops"] = json!({ "down": { "body": "crank", "limit": "lower", "angle": 0.5 } });
    let all = checked(&stopped.to_string());
    assert!(fact(&all, "Equilibrium at the start", "crank").text.contains("held at stop down"));
    assert!(fact(&all, "Ends of travel", "backward").text.starts_with("down at crank = 0.5"));
}

/// Forward is the direction in which the drive extends. At the start of the main gear, past the dead centre of its lock
/// links, this is towards the stop at which the gear is extended.
#[test]
fn the_stops_of_both_directions_are_named() {
    let path = Workspace::locate().descriptions().join("MainGear/resources/mechanism.json");
    let all = checked(&std::fs::read_to_string(path).unwrap());
    let expected =
        "forward (the length grows) is towards stop down, which holds the mechanism; backward is towards stop up";
    assert_eq!(fact(&all, "Equilibrium at the start", "jack").text, expected);
    // The unlocking actuator extends while the lock links open.
    let expected =
        "forward (the length grows) is towards stop up; backward is towards stop down, which holds the mechanism";
    assert_eq!(fact(&all, "Equilibrium at the start", "unlock").text, expected);
}

/// A flap whose link and rocker of 0.05 m each are in line before the flap is open.
#[test]
fn the_joints_that_end_a_motion_are_named() {
    let flap = |angle: f64| {
        json!({
            "name": "Flap", "units": { "angle": "deg", "length": "mm" },
            "bodies": {
                "ground": { "length": 100 }, "flap": rod(60.0, 1.0), "link": rod(50.0, 1.0), "rocker": rod(50.0, 1.0)
            },
            "joints": {
                "A": pin("ground.origin", "flap.origin"), "B": pin("flap.end", "link.origin"),
                "C": pin("link.end", "rocker.end"), "D": pin("ground.end", "rocker.origin")
            },
            "stops": {
                "open": { "body": "flap", "limit": "upper", "angle": 90 },
                "shut": { "body": "flap", "limit": "lower", "angle": angle },
                "far": { "body": "flap", "limit": "lower", "angle": angle - 5.0 }
            },
            "start": { "body": "flap", "angle": 20 }, "guess": { "flap": 20, "link": 36, "rocker": 94 }
        })
        .to_string()
    };
    let all = checked(&flap(10.0));
    let message_of = |path: &str| all.findings.iter().find(|l| l.finding.path == path).unwrap().finding.message.clone();
    // In line, both are the third side of a triangle with the sides 0.1, 0.06 and 0.1 m.
    let short = 90.0 - (0.0036_f64 / 0.012).acos().to_degrees();
    assert!(
        message_of("stops.open").contains(&format!("turns back {short:.2} deg")),
        "{} {short}",
        message_of("stops.open")
    );
    assert!(
        message_of("stops.open").ends_with("B, C and D come into line (dead centre)"),
        "{}",
        message_of("stops.open")
    );
    assert!(
        message_of("stops.far").contains("the stop shut ends the motion 5 deg before this stop"),
        "{}",
        message_of("stops.far")
    );
    let at = all.inspection.facts.iter().filter(|fact| fact.topic == "Toggles" && fact.of == "flap");
    let lines: Vec<String> = at.map(|fact| check::line(fact, &all.units)).collect();
    assert!(lines.len() == 1 && lines[0].ends_with("B, C and D are in line"), "{lines:?}");
    assert!(lines[0].contains(&format!("flap = {:.3} deg", 90.0 - short)), "{lines:?}");
}

#[test]
fn redundant_joints_and_crossings_are_reported() {
    let text = json!({
        "name": "P",
        "bodies": {
            "ground": { "length": 0.4, "points": { "m": [0.2, 0.0] } }, "left": { "length": 0.1, "mass": 1.0 },
            "middle": { "length": 0.1 }, "right": { "length": 0.1 },
            "coupler": { "length": 0.4, "mass": 1.0, "points": { "m": [0.2, 0.0] } }
        },
        "joints": {
            "a": { "type": "revolute", "first": "ground.origin", "second": "left.origin" },
            "b": { "type": "revolute", "first": "left.end", "second": "coupler.origin" },
            "c": { "type": "revolute", "first": "coupler.end", "second": "right.end" },
            "d": { "type": "revolute", "first": "ground.end", "second": "right.origin" },
            "e": { "type": "revolute", "first": "ground.m", "second": "middle.origin" },
            "f": { "type": "revolute", "first": "middle.end", "second": "coupler.m" }
        },
        "start": { "body": "left", "angle": 0.5 },
        "guess": { "left": 0.5, "coupler": 0.0, "right": 0.5, "middle": 0.5 }
    });
    let all = checked(&text.to_string());
    let redundant = all.inspection.facts.iter().filter(|fact| fact.topic == "Redundant joints").count();
    assert_eq!(redundant, 1, "{:#?}", all.inspection.facts);
    let mut four_bar = text;
    for (group, names) in [("joints", ["e", "f"]), ("bodies", ["middle", ""]), ("guess", ["middle", ""])] {
        names.iter().for_each(|name| drop(four_bar[group].as_object_mut().unwrap().remove(*name)));
    }
    let all = checked(&four_bar.to_string());
    assert_eq!(all.inspection.facts.iter().filter(|fact| fact.topic == "Crossings").count(), 2);
}

/// A carriage of 0.2 m between stops far beyond the first stretch of its rail.
#[test]
fn a_long_travel_is_reported_up_to_its_stops() {
    let stop = |limit: &str, position: f64| json!({ "joint": "rail", "limit": limit, "position": position });
    let gantry = json!({
        "name": "Gantry",
        "bodies": { "ground": {}, "carriage": { "mass": 200, "points": { "first": [-0.1, 0], "second": [0.1, 0] } } },
        "joints": { "rail": { "type": "prismatic", "first": "ground.origin", "second": "carriage.origin" } },
        "stops": { "east": stop("upper", 6000.0), "west": stop("lower", -60.0) },
        "actuators": { "drive": { "joint": "rail", "force": 100 } },
        "start": { "joint": "rail", "position": 1000 }, "guess": { "rail": 0 }
    });
    let checked = checked(&gantry.to_string());
    for (name, expected) in [("least", -60.0), ("most", 6000.0), ("start", 1000.0)] {
        for (topic, of) in [("Travel", "rail"), ("Drives", "drive")] {
            let value = number(&checked, topic, of, name);
            assert!((value - expected).abs() < 1e-9, "{topic} {name}: {value}");
        }
    }
    assert!((number(&checked, "Mass", "", "centre x") - 1000.0).abs() < 1e-9);
    let text = &fact(&checked, "Ends of travel", "forward").text;
    assert!(text.contains("east at rail = 6000.000000 m"), "{text}");
}

/// An elliptic trammel whose middle is also held by a crank: at dead centres some of its loop equations are singular,
/// but not all. A platform that does not move has no toggles.
#[test]
fn singular_parts_of_redundant_loops_are_no_crossings() {
    let bar = |length: f64| rod(length, 1.0).with(json!({ "points": { "middle": [0.5 * length, 0] } }));
    let trammel = json!({
        "name": "Trammel",
        "bodies": { "ground": {}, "bar": bar(1.0), "arm": bar(0.5), "across": {}, "up": {} },
        "joints": {
            "h": slide("ground.origin", "across.origin", 0.0), "v": slide("ground.origin", "up.origin", FRAC_PI_2),
            "a": pin("bar.origin", "across.origin"), "b": pin("bar.end", "up.origin"), "o": pin("ground.origin",
                "arm.origin"),
            "p": pin("arm.end", "bar.middle")
        },
        "start": { "body": "bar", "angle": 2 }, "guess": { "bar": 2.0, "arm": 1.14, "h": 0.42, "v": 0.9 }
    });
    let checked = checked(&trammel.to_string());
    assert!(checked.inspection.facts.iter().any(|fact| fact.topic == "Redundant joints"));
    assert!(checked.inspection.facts.iter().all(|fact| fact.topic != "Crossings"), "{:?}", checked.inspection.facts);
}
