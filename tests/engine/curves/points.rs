//! The points of a curve in the file: their units, and the messages about invalid points.
use super::body;
use crate::support::{FOUR_BAR, Run, assert_rejected, assert_says, changed, refusal};
use serde_json::json;

#[test]
fn wrong_curves_are_rejected_with_their_key() {
    assert_rejected("curves", body(false, [0.0, 0.0]));
    let fem = changed(FOUR_BAR, |m| {
        m["actuators"] = json!({ "motor": { "joint": "S", "points": [[0, 1], [9, 0]] } });
        m["solver"] = json!({ "tolerance": 1e-9, "method": "rigid_fem" });
        for (_, body) in m["bodies"].as_object_mut().unwrap().iter_mut().filter(|(name, _)| *name != "ground") {
            body["axial_stiffness"] = json!(1e8);
        }
    });
    assert_says(refusal(fem), &["actuators.motor.points", "rigid_fem", "use a torque or a force instead"]);
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
