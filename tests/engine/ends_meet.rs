//! Drives and springs whose two ends coincide at a position of the curve: an error only for a motion that reaches this
//! position.

use crate::support::definition::{self, With, block, pin, rod};
use crate::support::{Run, assert_says, read_all, refusal};
use linkage_fmu::mechanism::inspection::inspect;
use serde_json::{Value, json};
use std::f64::consts::{PI, TAU};

/// Moment of inertia of the arm about its pivot [kg.m2]: a rod of 3 kg and 1 m.
const INERTIA: f64 = 1.0;

/// An arm of 1 m about the origin, which starts at 1 rad. A cylinder connects its tip with the ground point (1, 0),
/// where the tip is at the angle 0.
fn arm(further: &Value) -> String {
    let mut definition = definition::arm(1.0, 3.0, 1.0).with(json!({
        "bodies": { "ground": { "points": { "east": [1, 0], "west": [-1, 0] } } },
        "actuators": { "cylinder": { "first": "ground.east", "second": "arm.end" } },
        "solver": { "tolerance": 1e-12 },
    }));
    definition.as_object_mut().unwrap().extend(further.as_object().unwrap().clone());
    definition.to_string()
}

/// Length of the cylinder at an angle of the arm.
fn length(angle: f64) -> f64 {
    2.0 * (0.5 * angle).sin().abs()
}

#[test]
fn a_motion_that_stays_away_is_exact() {
    // The arm moves from 1 rad over the dead centre at pi to 2 pi - 1 and back.
    let mut run = Run::new(arm(&json!({}))).with(&[("cylinder.force", 2.0)]).started();
    let (mut least, mut most) = (1.0_f64, 1.0_f64);
    for _ in 0..400 {
        run.step(0.05);
        let (angle, speed) = (run.get("arm.angle"), run.get("arm.speed"));
        (least, most) = (least.min(angle), most.max(angle));
        assert!((run.get("cylinder.length") - length(angle)).abs() < 1e-12);
        let error = 0.5 * INERTIA * speed * speed - 2.0 * (length(angle) - length(1.0));
        assert!(error.abs() < 1e-9, "{angle}: {error:e} J");
        assert!((run.get("cylinder.reduced_mass") * (0.5 * angle).cos().powi(2) / INERTIA - 1.0).abs() < 1e-8);
    }
    assert!(least < 1.01 && most > TAU - 1.01, "{least} {most}");
}

/// The ends come close elsewhere without coinciding. Within the motion all outputs of the drive have values.
#[test]
fn ends_that_almost_coincide_elsewhere_leave_every_output_of_the_drive() {
    for k in 2..=80 {
        let reach = 1.0 + 10.0_f64.powf(-0.1 * f64::from(k));
        let ground = json!({ "ground": { "points": { "east": [reach, 0], "west": [-1, 0] } },
            "arm": rod(1.0, 3.0) });
        let mut run = Run::new(arm(&json!({ "bodies": ground }))).with(&[("cylinder.force", 2.0)]).started();
        for _ in 0..40 {
            run.step(0.05);
            let (angle, speed) = (run.get("arm.angle"), run.get("arm.speed"));
            let length = (reach * reach + 1.0 - 2.0 * reach * angle.cos()).sqrt();
            let slope = reach * angle.sin() / length;
            let off =
                (run.get("cylinder.length") - length).abs().max((run.get("cylinder.speed") - slope * speed).abs());
            assert!(off < 1e-11 * (1.0 + speed.abs()), "{reach}: {off:e}");
            if slope.abs() > 0.01 {
                let mass = run.get("cylinder.reduced_mass") * slope * slope / INERTIA;
                assert!((mass - 1.0).abs() < 1e-8, "{reach} {angle}: {mass}");
            }
            assert!(read_all(run.0.model_mut()).is_empty());
        }
    }
}

#[test]
fn a_motion_to_coinciding_ends_is_rejected_with_position_and_remedy() {
    let fragments =
        [": both ends are at the same place near arm = ", "move one of the attachment points", "add a stop"];
    let pulled = Run::new(arm(&json!({}))).with(&[("cylinder.force", -2.0)]).started();
    for h in [1e-3, 0.1, 10.0, 1000.0] {
        let mut run = pulled.clone();
        let mut steps = 0;
        let error = loop {
            let before = run.get("arm.angle");
            match run.0.step(h) {
                Ok(()) => steps += 1,
                Err(error) => {
                    assert_eq!(run.get("arm.angle").to_bits(), before.to_bits(), "a refused step changes nothing");
                    break error;
                }
            }
            assert!(run.get("arm.angle") > 0.0, "it has passed");
        };
        assert_says(&error, &fragments);
        assert_says(error, &["cylinder.force"]);
        if h == 1e-3 {
            // The motion ends at most 1e-3 sizes of the mechanism and one step before the position.
            let (angle, speed) = (run.get("arm.angle"), run.get("arm.speed"));
            assert!(angle < 1e-3 + 1.1 * h * speed.abs(), "{angle}");
            assert!((0.5 * speed * speed - 2.0 * (length(1.0) - length(angle))).abs() < 1e-9);
        } else if h >= 10.0 {
            assert_eq!(steps, 0);
        }
    }
    // There and back within one step: the drive is first pulled, then pushed.
    let mut run = Run::new(arm(&json!({}))).with(&[("cylinder.force", 1.0)]);
    run.place(("arm.start_angle", 0.3), ("arm.start_speed", -3.0));
    assert_says(run.0.step(1.0).unwrap_err(), &fragments);
    // The same from the other side, and with losses, friction and a damper.
    for further in [
        json!({ "springs": { "damper": { "joint": "pivot", "damping": 0.01 } } }),
        json!({ "springs": { "coil": { "first": "ground.east", "second": "arm.end", "stiffness": 1,
            "damping": 0.1 } } }),
    ] {
        for speed in [-9.0, 9.0] {
            let mut run = Run::new(arm(&further)).with(&[("arm.start_speed", speed)]).started();
            let error = (0..1000).find_map(|_| run.0.step(0.01).err()).unwrap();
            assert_says(error, &fragments);
            let angle = run.get("arm.angle");
            let left = if speed < 0.0 { angle } else { TAU - angle };
            assert!(left > 0.0 && left < 0.2, "{angle}");
        }
    }
}

#[test]
fn stops_prevent_the_motion_to_coinciding_ends() {
    for rigid in [true, false] {
        let mut stops = json!({
            "low": { "body": "arm", "angle": 0.5, "limit": "lower", "restitution": 1 },
            "high": { "body": "arm", "angle": 5.5, "limit": "upper", "restitution": 1 }
        });
        if !rigid {
            stops = json!({
                "low": { "body": "arm", "angle": 0.5, "limit": "lower", "rigid": false, "stiffness": 1e4 },
                "high": { "body": "arm", "angle": 5.5, "limit": "upper", "rigid": false, "stiffness": 1e4 }
            });
        }
        let mut run = Run::new(arm(&json!({ "stops": stops }))).with(&[("cylinder.force", -2.0)]).started();
        let mut least = 1.0_f64;
        for _ in 0..2000 {
            run.step(0.01);
            least = least.min(run.get("arm.angle"));
            assert!(run.get("energy.drift").abs() < 1e-8);
        }
        assert!(least < 0.52, "the stop must be met: {least}");
    }
}

/// Two cylinders whose ends coincide at 0 and at pi: the start determines on which of the two arcs the arm moves.
#[test]
fn the_start_decides_between_which_meetings_the_motion_is() {
    let two = json!({ "actuators": {
        "cylinder": { "first": "ground.east", "second": "arm.end" },
        "ram": { "first": "ground.west", "second": "arm.end" }
    } });
    let mut run = Run::new(arm(&two)).with(&[("cylinder.force", 1.0), ("ram.force", 1.0)]);
    for (start, middle) in [(1.0, 0.5 * PI), (4.0, 1.5 * PI), (5.0, 1.5 * PI), (2.0, 0.5 * PI)] {
        run.place(("arm.start_angle", start), ("arm.start_speed", 0.0));
        let potential = |angle: f64| length(angle) + 2.0 * (0.5 * angle).cos().abs();
        for _ in 0..200 {
            run.step(0.05);
            let (angle, speed) = (run.get("arm.angle"), run.get("arm.speed"));
            assert!((angle - middle).abs() <= (start - middle).abs() + 1e-9, "{start}: {angle}");
            let error = 0.5 * INERTIA * speed * speed - (potential(angle) - potential(start));
            assert!(error.abs() < 1e-9, "{start} {angle}: {error:e} J");
        }
    }
    // At the position where the ends coincide the guess gives no direction of the cylinder.
    run.set("arm.start_angle", 0.0);
    assert!(run.0.initialize().is_err());
}

/// A carriage on a rail with a spring to the origin of the rail, beyond the first stretch of the curve.
#[test]
fn coinciding_ends_on_a_stretch_end_the_motion_there_and_not_before() {
    let carriage = block(2.0).with(json!({
        "bodies": { "ground": { "points": { "far": [60, 0] } }, "block": { "length": 0.02 } },
        "springs": { "spring": { "first": "ground.far", "second": "block.origin", "stiffness": 0, "preload": 4 } },
        "start": { "speed": 1 },
    }));
    let mut run = Run::new(carriage).started();
    for k in 1..1000 {
        let error = run.0.step(0.05).err();
        // The force of the spring is 4 N.
        let t = 0.05 * f64::from(k);
        let exact = t + t * t;
        let limit = 60.0 * (1.0 - 1e-3);
        if exact < limit {
            assert!(error.is_none(), "{exact}: {error:?}");
            assert!((run.get("slide.position") - exact).abs() < 1e-9 * exact);
        } else {
            assert_says(
                error.unwrap(),
                &["spring: both ends are at the same place near slide = ", "move one of the attachment points"],
            );
            return;
        }
    }
    panic!("it has passed the meeting");
}

#[test]
fn the_check_reports_the_position_where_the_motion_ends() {
    let inspection = inspect(&arm(&json!({})));
    // A motion that reaches the position ends its run: one warning for each side.
    assert_eq!(inspection.findings.len(), 2, "{:?}", inspection.findings);
    for finding in &inspection.findings {
        assert_says(
            &finding.message,
            &["a run can end with an error", "cylinder.force: both ends are at the same place near arm = "],
        );
        assert_eq!(finding.path, "stops");
    }
    let ends: Vec<_> = inspection.facts.iter().filter(|fact| fact.topic == "Ends of travel").collect();
    assert_eq!(ends.len(), 2);
    ends.iter()
        .for_each(|fact| assert_says(&fact.text, &["cylinder.force: both ends are at the same place near arm = "]));
}

/// A drive between two points at constant distance has no effect: an error if both points are on one pin, else a
/// warning.
#[test]
fn ends_that_keep_their_distance_have_no_effect() {
    let bars = json!({ "name": "Bars",
        "bodies": {
            "ground": { "length": 0.4 }, "crank": { "length": 0.1, "mass": 1 }, "rocker": { "length": 0.25, "mass": 1 },
            "rod": { "length": 0.4, "mass": 2 }, "twin": { "length": 0.4, "mass": 1, "points": { "eye": [0.2, 0.1] } },
        },
        "joints": {
            "a": pin("ground.origin", "crank.origin"), "b": pin("crank.end", "rod.origin"),
            "b2": pin("crank.end", "twin.origin"), "c": pin("rod.end", "rocker.end"),
            "c2": pin("twin.end", "rocker.end"),
            "d": pin("ground.end", "rocker.origin"),
        },
        "start": { "body": "crank", "angle": 0.6, "speed": 1 },
        "guess": { "crank": 0.6, "rod": 0.5, "twin": 0.5, "rocker": 1.4 } });
    let between = |group: &str, first: &str, second: &str| {
        let mut text = bars.clone();
        text[group] = json!({ "idle": { "first": first, "second": second } });
        text.to_string()
    };
    // Both ends are on one pin, through the crank.
    let error = refusal(between("actuators", "rod.origin", "twin.origin"));
    assert_says(error, &["actuators.idle", "both ends are the point b", "give two different points"]);
    // The ends of a crank, and points of two bars that move as one body.
    for (first, second) in [("ground.origin", "crank.end"), ("rod.origin", "twin.eye")] {
        let mut run = Run::new(between("actuators", first, second)).started();
        run.set("idle.force", 1e3);
        run.step(0.1);
        assert_eq!([run.get("idle.speed"), run.get("idle.holding_force")], [0.0; 2], "{first}");
        assert_eq!(run.get("idle.reduced_mass"), f64::MAX, "{first}");
        assert_says(run.undefined("idle.required_force"), &["in every position"]);
        for group in ["actuators", "springs"] {
            let findings = inspect(&between(group, first, second)).findings;
            let path = format!("{group}.idle");
            let mut texts = findings.iter().filter(|finding| finding.path == path).map(ToString::to_string);
            assert!(
                texts.any(|text| text.contains("apart in every position, so this element never moves")),
                "{findings:?}"
            );
        }
    }
    assert!(inspect(&between("actuators", "ground.origin", "twin.eye")).findings.is_empty());
    // A drive in a joint between two bars that move as one body.
    for (kind, unit) in [("revolute", "rad"), ("prismatic", "m")] {
        let within = |group: &str| {
            let mut text = bars.clone();
            text["joints"]["w"] = json!({ "type": kind, "first": "rod.origin", "second": "twin.origin" });
            if kind == "prismatic" {
                text["guess"]["w"] = json!(0);
            }
            text[group] = json!({ "idle": { "joint": "w" } });
            text.to_string()
        };
        let mut run = Run::new(within("actuators")).started();
        run.set(if kind == "revolute" { "idle.torque" } else { "idle.force" }, 1e3);
        run.step(0.1);
        assert_eq!(run.get("idle.speed"), 0.0, "{kind}");
        assert_says(run.undefined("idle.required_force"), &["in every position"]);
        for group in ["actuators", "springs"] {
            let findings = inspect(&within(group)).findings;
            let path = format!("{group}.idle");
            let mut texts = findings.iter().filter(|finding| finding.path == path).map(ToString::to_string);
            assert!(
                texts.any(|text| text.contains(&format!("0 {unit} in every position, so this element never moves"))),
                "{findings:?}"
            );
        }
    }
}
