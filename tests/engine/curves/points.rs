//! The points of a curve in the file: their units, and the messages about invalid points.
use super::body;
use crate::support::{FOUR_BAR, Run, assert_says, changed};
use linkage_fmu::mechanism::Model;
use linkage_fmu::simulation::Simulation;
use serde_json::{Value, json};

#[test]
fn wrong_curves_are_rejected_with_their_key() {
    let damper = |points: Value| json!({ "springs": { "d": { "joint": "slide", "damping_points": points } } });
    let motor = |drive: Value| json!({ "actuators": { "m": drive } });
    let buffer = |points: Value| {
        json!({ "stops": { "b": { "joint": "slide", "limit": "upper", "position": 1,
        "rigid": false, "points": points } } })
    };
    let rigid =
        json!({ "stops": { "b": { "joint": "slide", "limit": "upper", "position": 1, "points": [[0, 0], [1, 1]] } } });
    for (more, pieces) in [
        (
            damper(json!([[0, 0]])),
            &["springs.d.damping_points", "has 1 points [speed, force], but a curve needs 2 or more"][..],
        ),
        (damper(json!([[-1, -1], [1, 1]])), &["springs.d.damping_points", "add the point [0, 0]"]),
        (damper(json!([[-1, 1], [0, 0], [1, 1]])), &["damping_points[0]", "the force 1 at the speed -1 would drive"]),
        (
            damper(json!([[0, 0], [1, 5], [2, 3]])),
            &["damping_points", "point at the speed 2", "at least as large in magnitude"],
        ),
        (
            damper(json!([[-2, -1], [-1, -5], [0, 0], [1, 5]])),
            &["damping_points", "point at the speed -2", "at least as large in magnitude"],
        ),
        (damper(json!([[1, 1], [0, 0]])), &["damping_points[1]", "speed = 0 must be larger than speed = 1"]),
        (
            motor(json!({ "joint": "slide", "points": [[0, 1]] })),
            &["actuators.m.points", "has 1 points", "needs 2 or more"],
        ),
        (motor(json!({ "joint": "slide", "command": 0.5 })), &["actuators.m.command", "pairs [speed, force]"]),
        (
            motor(json!({ "joint": "slide", "points": [[0, 1], [1, 0]], "motion": { "position": 0 } })),
            &["actuators.m.points", "remove the key `points` or the key `motion`"],
        ),
        (buffer(json!([[0, 1], [1, 2]])), &["stops.b.points[0]", "start with [0, 0]"]),
        (
            buffer(json!([[0, 0], [1, 2], [2, 1]])),
            &["stops.b.points[2]", "the force 1 is smaller than 2 at the preceding point"],
        ),
        (rigid, &["stops.b.points", "only a bumper has this key", "\"rigid\": false"]),
    ] {
        let mut text = body(false, [0.0, 0.0]);
        text.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        let error = Model::from_json(&text.to_string()).map(drop).expect_err(&text.to_string());
        assert_says(error, pieces);
    }
    let fem = changed(FOUR_BAR, |m| {
        m["actuators"] = json!({ "motor": { "joint": "S", "points": [[0, 1], [9, 0]] } });
        m["solver"] = json!({ "tolerance": 1e-9, "method": "rigid_fem" });
        for (_, body) in m["bodies"].as_object_mut().unwrap().iter_mut().filter(|(name, _)| *name != "ground") {
            body["axial_stiffness"] = json!(1e8);
        }
    });
    let error = Simulation::open(&fem).map(drop).expect_err("rigid finite elements take a drive with a curve");
    assert_says(error, &["actuators.motor.points", "rigid_fem", "use a torque or a force instead"]);
}

#[test]
fn lengths_of_points_have_the_unit_of_the_file() {
    let mut text = body(false, [100.0, 0.0]);
    text["units"] = json!({ "length": "mm" });
    text["springs"] = json!({ "s": { "joint": "slide", "points": [[0, 0], [100, 5], [200, 10]],
                                     "damping_points": [[0, 0], [1, 2]] } });
    text["stops"] = json!({ "b": { "joint": "slide", "limit": "upper", "position": 95, "rigid": false,
                                   "points": [[0, 0], [10, 1], [20, 4]] } });
    text["stops"]["b"]["enabled"] = json!(false);
    let mut run = Run::new(&text).started();
    assert!((run.get("s.force") - 5.0).abs() < 1e-12, "{}", run.get("s.force"));
}
