//! One mechanism in several equivalent definitions gives the same results: with exchanged sides of every joint, and
//! with every body carried by other bodies (`fixed_to`).

use crate::losses::TRAIN;
use crate::support::examples::{Example, examples};
use crate::support::{Run, assert_says, changed};
use crate::tables::committed;
use linkage_fmu::variables::{Causality, Kind};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Largest difference at the start and after the steps, relative to the largest output with the same unit. Tables have
/// an error of 1e-13 of a component, reactions near a singular position a larger one.
const AT_START: f64 = 1e-9;
const AFTER_STEPS: f64 = 1e-7;
/// Tolerance of the integration.
const TOLERANCE: f64 = 1e-12;
/// Angles of a body in its carrier, and of the carrier in the next carrier [rad, or deg in a file in degrees].
const TURNS: [f64; 2] = [0.7, -1.9];

/// The differences of the transformed definition.
#[derive(Default)]
struct Differs {
    /// Names of joints and loads whose signs depend on the order of a joint's sides.
    mirrored: Vec<String>,
    /// Names of bodies that other bodies carry in the transformed definition.
    carried: Vec<String>,
}

/// A number or an expression with the opposite sign.
fn negative(value: &Value) -> Value {
    match value {
        Value::Number(number) => json!(-number.as_f64().unwrap()),
        Value::String(text) => json!(format!("-({text})")),
        other => panic!("no number: {other}"),
    }
}

/// a - b.
fn less(a: &Value, b: &Value) -> Value {
    match (a.as_f64(), b.as_f64()) {
        (Some(a), Some(b)) => json!(a - b),
        _ => json!(format!("({}) - ({})", a.to_string().trim_matches('"'), b.to_string().trim_matches('"'))),
    }
}

fn negate(of: &mut Value, keys: &[&str]) {
    for key in keys {
        if let Some(value) = of.get_mut(key) {
            *value = negative(value);
        }
    }
}

/// Mirror a curve: f(x) becomes -f(-x).
fn mirror(of: &mut Value, keys: &[&str]) {
    for key in keys {
        if let Some(Value::Array(points)) = of.get_mut(key) {
            points.iter_mut().for_each(|pair| *pair = json!([negative(&pair[0]), negative(&pair[1])]));
            points.reverse();
        }
    }
}

/// Entries of a group that are loads in this joint, with their names.
fn in_joint<'v>(definition: &'v mut Value, group: &str, joint: &str) -> Vec<(String, &'v mut Value)> {
    let entries = definition.get_mut(group).and_then(Value::as_object_mut).into_iter().flatten();
    entries.filter(|(_, load)| load["joint"] == *joint).map(|(name, load)| (name.clone(), load)).collect()
}

/// Exchange the two sides of a joint, and reverse all values that refer to its displacement. The axis of a prismatic
/// joint keeps its direction, so the position changes its sign. Returns false if a load acts in one direction only.
fn exchange(definition: &mut Value, joint: &str, differs: &mut Differs) -> bool {
    let one_way = |(_, load): &(String, &mut Value)| load.get("gas").is_some() || load.get("hydraulics").is_some();
    // The curve of a slot is fixed in the first body.
    let is_slot = definition["joints"][joint]["type"] == "slot";
    if is_slot || ["springs", "actuators"].iter().any(|group| in_joint(definition, group, joint).iter().any(one_way)) {
        return false;
    }
    let own = &mut definition["joints"][joint];
    let [first, second] = ["first", "second"].map(|side| own[side].clone());
    (own["first"], own["second"]) = (second, first);
    if own["type"] == "prismatic" {
        let [axis, angle] = ["axis_angle", "angle"].map(|key| own.get(key).cloned().unwrap_or(json!(0)));
        (own["axis_angle"], own["angle"]) = (less(&axis, &angle), negative(&angle));
    }
    negate(own, &["surface_speed"]);
    differs.mirrored.push(joint.to_owned());
    for (name, drive) in in_joint(definition, "actuators", joint) {
        negate(drive, &["force", "torque"]);
        mirror(drive, &["points"]);
        if let Some(control) = drive.get_mut("control") {
            negate(control, &["command", "command_speed", "min_force", "max_force"]);
            let [least, most] = ["min_force", "max_force"].map(|key| control.as_object_mut().unwrap().remove(key));
            for (key, limit) in [("min_force", most), ("max_force", least)] {
                if let Some(limit) = limit {
                    control[key] = limit;
                }
            }
        }
        if let Some(motion) = drive.get_mut("motion") {
            negate(motion, &["position", "distance"]);
            for pair in motion.get_mut("points").and_then(Value::as_array_mut).into_iter().flatten() {
                pair[1] = negative(&pair[1]);
            }
        }
        differs.mirrored.push(name);
    }
    for (name, spring) in in_joint(definition, "springs", joint) {
        negate(spring, &["free_length", "free_angle", "preload"]);
        mirror(spring, &["points", "damping_points"]);
        differs.mirrored.push(name);
    }
    for (name, stop) in in_joint(definition, "stops", joint) {
        negate(stop, &["angle", "position"]);
        stop["limit"] = json!(if stop["limit"] == "lower" { "upper" } else { "lower" });
        differs.mirrored.push(name);
    }
    if definition["start"]["joint"] == *joint {
        negate(&mut definition["start"], &["position", "speed"]);
    }
    if let Some(guess) = definition.get_mut("guess").and_then(|guess| guess.get_mut(joint)) {
        *guess = negative(guess);
    }
    true
}

fn with_sides_exchanged(mut definition: Value) -> (Value, Differs) {
    let mut differs = Differs::default();
    let joints: Vec<String> = definition["joints"].as_object().unwrap().keys().cloned().collect();
    for joint in joints {
        exchange(&mut definition, &joint, &mut differs);
    }
    (definition, differs)
}

/// Every moving body is fixed to a second body, and this to a third body without mass. The guess states the third body.
fn with_bodies_carried(mut definition: Value) -> (Value, Differs) {
    let mut differs = Differs::default();
    let bodies: Vec<(String, Value)> = definition["bodies"].as_object().unwrap().clone().into_iter().collect();
    for (name, body) in bodies {
        let keeps = ["fixed_to", "drawn", "axial_stiffness"].iter().any(|key| body.get(key).is_some());
        if keeps || name == "ground" {
            continue;
        }
        let [seat, middle] = ["seat", "middle"].map(|part| format!("{name}_{part}"));
        definition["bodies"][&seat] = json!({ "points": { "at": [0.01, -0.02] } });
        definition["bodies"][&middle] = json!({ "fixed_to": format!("{seat}.at"), "angle": TURNS[0],
            "points": { "at": [-0.015, 0.03] } });
        definition["bodies"][&name]["fixed_to"] = json!(format!("{middle}.at"));
        definition["bodies"][&name]["angle"] = json!(TURNS[1]);
        let guess = definition["guess"].as_object_mut().unwrap_or_else(|| panic!("{name}"));
        if let Some(angle) = guess.remove(&name) {
            guess.insert(seat, less(&angle, &json!(TURNS[0] + TURNS[1])));
        }
        differs.carried.push(name);
    }
    (definition, differs)
}

/// Values and units of all outputs that do not measure errors. NaN stands for an output without a value.
fn outputs(run: &mut Run) -> BTreeMap<String, (String, f64)> {
    let list = run.variables().list().to_vec();
    let mut all = BTreeMap::new();
    for variable in list.iter().filter(|v| v.causality == Causality::Output && v.name != "energy.drift") {
        let value = match variable.kind {
            Kind::Boolean => f64::from(u8::from(run.is(&variable.name))),
            _ => run.0.get(&variable.name).unwrap_or_else(|e| panic!("{}: {e}", variable.name)),
        };
        all.insert(variable.name.clone(), (format!("{:?}", variable.unit), value));
    }
    all
}

/// Name of the output for the opposite direction of the drive.
fn turned_round(name: &str) -> String {
    match (name.strip_suffix("_forward"), name.strip_suffix("_backward")) {
        (Some(force), _) => format!("{force}_backward"),
        (_, Some(force)) => format!("{force}_forward"),
        _ => name.to_owned(),
    }
}

/// Compare all outputs of two models of one mechanism. Returns the number of compared outputs.
#[track_caller]
fn assert_same(what: &str, [one, other]: [&mut Run; 2], joints: &Value, differs: &Differs, tolerance: f64) -> usize {
    let (one, other) = (outputs(one), outputs(other));
    let mut sizes: BTreeMap<&str, f64> = BTreeMap::new();
    for (unit, value) in one.values().filter(|(_, value)| value.abs() < f64::MAX) {
        let size = sizes.entry(unit).or_default();
        *size = size.max(value.abs());
    }
    let mut compared = 0;
    for (name, (unit, value)) in &one {
        let of = name.split('.').next().unwrap();
        let is_mirrored = differs.mirrored.iter().any(|own| own == of);
        // The moment of a prismatic joint refers to the second point.
        if is_mirrored && joints[of]["type"] == "prismatic" && name.ends_with(".torque") {
            continue;
        }
        let found = if is_mirrored { other.get(&turned_round(name)) } else { other.get(name) };
        let Some((_, found)) = found else {
            assert!(differs.carried.iter().any(|body| body == of), "{what}: no {name}");
            continue;
        };
        let [a, b] = [*value, *found].map(|value| if is_mirrored { value.abs() } else { value });
        let size = tolerance * (sizes[unit.as_str()] + 1e-3);
        assert!(a.is_nan() && b.is_nan() || a == b || (a - b).abs() <= size, "{what}: {name} is {a}, then {b}");
        compared += 1;
    }
    compared
}

/// A definition and its transformed definition have the same outputs at the start and after some steps.
fn check(name: &str, definition: &Value, transform: fn(Value) -> (Value, Differs)) {
    if definition["solver"]["method"] == "rigid_fem" {
        return;
    }
    let mut definition = definition.clone();
    if definition["name"] == "Parallelogram" {
        // At a crossing the reactions are unbounded.
        definition["start"]["angle"] = json!(0.3);
    }
    if definition.get("solver").is_none() {
        definition["solver"] = json!({});
    }
    definition["solver"]["tolerance"] = json!(TOLERANCE);
    let (other, differs) = transform(definition.clone());
    let mut runs = [&definition, &other].map(|definition| {
        let text = definition.to_string();
        let mut run =
            Run(linkage_fmu::simulation::Simulation::open(&text).unwrap_or_else(|e| panic!("{name}: {e}: {text}")));
        run.0.initialize().unwrap_or_else(|e| panic!("{name}: {e}: {text}"));
        run
    });
    let joints = &definition["joints"];
    let compared = assert_same(&format!("{name} at the start"), runs.each_mut(), joints, &differs, AT_START);
    assert!(compared >= 5, "{name}: {compared} outputs compared");
    let span = runs[0].experiment().stop_time.min(0.5);
    for run in &mut runs {
        run.steps(5, 0.2 * span);
    }
    assert_same(&format!("{name} after steps"), runs.each_mut(), joints, &differs, AFTER_STEPS);
}

/// The mechanisms of the repository and of the reference, and additional ones with other elements.
fn scenes() -> Vec<(String, Value)> {
    let read = |text: String| serde_json::from_str::<Value>(&text).unwrap();
    let committed = committed().into_iter().map(read);
    let mut all: Vec<_> = committed.map(|own| (own["name"].as_str().unwrap().to_owned(), own)).collect();
    for Example { page, index, whole, .. } in examples() {
        all.push((format!("example {index} of {page}: {}", whole["name"]), whole));
    }
    // A four-bar linkage with a spring, a damper, a drive, a bumper and a stop in hinges between moving bodies.
    let hinges = include_str!("../fixtures/hinges.json").to_owned();
    let driven = |push: f64| {
        changed(TRAIN, |m| {
            m["forces"]["push"]["force"] = json!([push, 0.0]);
            m["torques"]["motor"]["torque"] = json!(-3.0);
        })
    };
    for (name, text) in [
        ("train with losses", TRAIN.to_owned()),
        ("train with losses, driven by 1 N", driven(1.0)),
        ("train with losses, driven by -30 N", driven(-30.0)),
        ("hinges between bodies", hinges),
    ] {
        all.push((name.into(), read(text)));
    }
    all
}

#[test]
fn the_sides_of_joints_may_be_exchanged() {
    scenes().iter().for_each(|(name, definition)| check(name, definition, with_sides_exchanged));
}

#[test]
fn bodies_may_be_carried_by_others() {
    for (name, mut definition) in scenes() {
        for (_, drive) in definition.get_mut("actuators").and_then(Value::as_object_mut).into_iter().flatten() {
            // A body and all bodies that it carries have one reduced mass, under the name of the carrier.
            drive.as_object_mut().unwrap().remove("by_body");
        }
        check(&name, &definition, with_bodies_carried);
    }
}

/// A shaft at 0.2 rad carries a lever at 1 rad. The angle of the hinge is that of the lever.
#[test]
fn the_angle_of_a_hinge_is_that_of_the_body_it_names() {
    let shaft = json!({ "name": "Shaft",
        "bodies": { "ground": {}, "shaft": { "mass": 1, "inertia": 0.1 }, "lever": { "fixed_to": "shaft.origin",
            "angle": 1.0 } },
        "joints": { "s": { "type": "revolute", "first": "ground.origin", "second": "lever.origin" } },
        "springs": { "coil": { "joint": "s", "stiffness": 10 } },
        "actuators": { "servo": { "joint": "s" } },
        "stops": { "end": { "joint": "s", "limit": "upper", "angle": 1.3 }, "own": { "body": "lever",
            "limit": "lower", "angle": 1.1 } },
        "start": { "body": "shaft", "angle": 0.2 }, "guess": { "shaft": 0 } });
    let mut run = Run::new(shaft.to_string()).started();
    for (name, value) in
        [("coil.angle", 1.2), ("coil.torque", 12.0), ("servo.angle", 1.2), ("servo.holding_torque", 12.0)]
    {
        assert!((run.get(name) - value).abs() < 1e-12, "{name}: {}", run.get(name));
    }
    for (angle, stop) in [
        (0.31, "stops.end.angle = 1.3 rad: the start, at 1.31 rad"),
        (0.09, "stops.own.angle = 1.1 rad: the start, at 1.09 rad"),
    ] {
        run.set("shaft.start_angle", angle);
        assert_says(run.refusal(), &[stop]);
    }
}

/// A wheel drives a rack with losses. Both orders of the joint's sides are allowed.
#[test]
fn a_rack_written_first_loses_in_the_direction_of_its_power() {
    for (torque, first, second) in
        [(3.0, "rack.origin", "ground.r"), (3.0, "ground.r", "rack.origin"), (-3.0, "rack.origin", "ground.r")]
    {
        let text = json!({ "name": "Rack",
            "bodies": { "ground": { "points": { "r": [0, -0.1] } }, "wheel": { "mass": 1, "inertia": 0.01 }, "rack": {
                "mass": 2 } },
            "joints": { "pin": { "type": "revolute", "first": "ground.origin", "second": "wheel.origin" },
                "s": { "type": "prismatic", "first": first, "second": second } },
            "couplings": { "mesh": { "type": "rack", "first": "wheel.origin", "joint": "s", "radius": 0.1,
                "pressure_angle": 0,
                "efficiency": 0.5 } },
            "torques": { "motor": { "on": "wheel", "torque": torque } },
            "start": { "body": "wheel", "angle": 0, "speed": 1 }, "guess": { "wheel": 0, "s": 0 } });
        let mut run = Run::new(text.to_string()).started();
        // The rack, m r^2 = 0.02 kg.m2, receives half of the wheel's power, or returns half of its power to the wheel.
        let exact = torque / (0.01 + 0.02 * if torque > 0.0 { 2.0 } else { 0.5 });
        assert!((run.get("wheel.acceleration") - exact).abs() < 1e-11, "{first}: {}", run.get("wheel.acceleration"));
        // Transmitted force and loss force act on the rack.
        let on_rack = run.get("mesh.transmitted_force") + run.get("mesh.loss_force");
        assert!((on_rack - 2.0 * 0.1 * exact).abs() < 1e-11, "{first}: {on_rack}");
    }
}
