//! Drawn geometry, angles in degrees and lengths in millimetres give the same mechanisms as lengths, local points and
//! SI units.

use crate::support::assert_rejected;
use linkage_fmu::mechanism::definition::Mechanism;
use linkage_fmu::mechanism::reduced::Reduced;
use linkage_fmu::simulation::Simulation;
use serde_json::{Map, Value, json};

const EXAMPLES: [(&str, &str); 6] = [
    ("gear", include_str!("../../modelDescription/LandingGearRetraction/resources/mechanism.json")),
    ("four-bar", include_str!("../../modelDescription/FourBar/resources/mechanism.json")),
    ("slider-crank", include_str!("../../modelDescription/SliderCrank/resources/mechanism.json")),
    ("squeezer", include_str!("../../modelDescription/AndrewsSqueezer/resources/mechanism.json")),
    ("six-bar", include_str!("../fixtures/six_bar.json")),
    ("Watt's six-bar with a slider", include_str!("../fixtures/watt_with_a_slider.json")),
];

fn mechanism(text: &str) -> Mechanism {
    Mechanism::from_json(text).unwrap_or_else(|error| panic!("{error}"))
}

/// The definition with every body given by the coordinates of its points in the assembled guess.
fn drawn(text: &str) -> Value {
    let defined = mechanism(text);
    let curve = Reduced::trace(&defined).unwrap();
    let (linkage, positions) = (curve.linkage(), curve.configuration(0.0).positions);
    let place = |body: &str, point: &str| {
        let point = linkage.locate(&defined, format_args!("test"), &format!("{body}.{point}")).unwrap();
        let at = positions.point(point);
        json!([at.x, at.y])
    };
    let mut all: Value = serde_json::from_str(text).unwrap();
    for (name, body) in all["bodies"].as_object_mut().unwrap().iter_mut().filter(|(name, _)| *name != "ground") {
        let body = body.as_object_mut().unwrap();
        let (carrier, own) = linkage.carrier(&defined, name).unwrap();
        let angle = positions.angle[carrier] + own;
        let origin = place(name, "origin");
        let mut drawing = json!({ "origin": origin });
        match body.remove("length") {
            Some(_) => drawing["end"] = place(name, "end"),
            None => drawing["angle"] = json!(angle),
        }
        if let Some(Value::Object(points)) = body.remove("points") {
            let points: Map<_, _> = points.keys().map(|point| (point.clone(), place(name, point))).collect();
            drawing["points"] = points.into();
        }
        if let Some(center) = body.remove("center") {
            let [x, y] = [0, 1].map(|axis| center[axis].as_f64().unwrap());
            let [x, y] = [x * angle.cos() - y * angle.sin(), x * angle.sin() + y * angle.cos()];
            let [x0, y0] = [0, 1].map(|axis| origin[axis].as_f64().unwrap());
            drawing["center"] = json!([x0 + x, y0 + y]);
        }
        body.remove("angle");
        body.insert("drawn".into(), drawing);
    }
    for (_, joint) in all["joints"].as_object_mut().unwrap() {
        joint.as_object_mut().unwrap().remove("angle");
    }
    all.as_object_mut().unwrap().remove("guess");
    all
}

fn parameters(text: &str) -> Vec<(String, f64)> {
    let mut all = Vec::new();
    mechanism(text).parameters(&mut |parameter, value| all.push((parameter.name.concat(), *value)));
    all.sort_by(|a, b| a.0.cmp(&b.0));
    all
}

fn assert_same_parameters(name: &str, one: &str, other: &str, tolerance: f64) {
    let (one, other) = (parameters(one), parameters(other));
    let names = |all: &[(String, f64)]| all.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
    assert_eq!(names(&one), names(&other), "{name}");
    for ((parameter, a), (_, b)) in one.iter().zip(&other) {
        assert!((a - b).abs() <= tolerance * (1.0 + a.abs()), "{name}: {parameter} = {a} and {b}");
    }
}

/// Largest difference of any output over a run, relative to the output's largest value and 1.
fn difference(one: &str, other: &str) -> f64 {
    let run = |text: &str| {
        let mut simulation = Simulation::open(text).unwrap();
        simulation.initialize().unwrap();
        let names: Vec<String> = simulation
            .names()
            .filter(|n| n.ends_with(".angle") || n.ends_with(".force_x") || n.ends_with(".acceleration"))
            .map(str::to_owned)
            .collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let trace = simulation.run(0.01, 1e-3, &names).unwrap();
        names.iter().map(|name| (name.to_string(), trace.column(name).unwrap().to_vec())).collect::<Vec<_>>()
    };
    let (one, other) = (run(one), run(other));
    assert!(one.len() > 3);
    let mut most = 0.0_f64;
    for (name, values) in &one {
        let (_, others) = other.iter().find(|(known, _)| known == name).unwrap();
        let size = values.iter().fold(1.0, |size: f64, value| size.max(value.abs()));
        let off = values.iter().zip(others).fold(0.0, |off: f64, (a, b)| off.max((a - b).abs()));
        most = most.max(off / size);
    }
    most
}

#[test]
fn a_mechanism_drawn_is_the_mechanism_in_lengths_and_points() {
    for (name, text) in EXAMPLES {
        let drawn = drawn(text).to_string();
        assert!(!drawn.contains("\"guess\"") && drawn.contains("\"drawn\""), "{name}");
        assert_same_parameters(name, text, &drawn, 1e-12);
        let difference = difference(text, &drawn);
        assert!(difference < 1e-9, "{name}: outputs differ by {difference:e}");
    }
}

#[test]
fn degrees_and_millimetres_are_the_same_mechanism() {
    for (name, text) in EXAMPLES {
        let mut all: Value = serde_json::from_str(text).unwrap();
        all["units"] = json!({ "angle": "deg", "length": "mm" });
        let mut factors = Vec::new();
        mechanism(text).parameters(&mut |parameter, _| {
            let factor = match parameter.unit.name() {
                "rad" => 180.0 / std::f64::consts::PI,
                "m" => 1000.0,
                _ => return,
            };
            factors.push((parameter.key.concat(), factor));
        });
        for (key, factor) in factors {
            let pointer = format!("/{}", key.replace(['.', '['], "/").replace(']', ""));
            if let Some(value) = all.pointer_mut(&pointer) {
                *value = json!(value.as_f64().unwrap() * factor);
            }
        }
        let bodies = all["bodies"].clone();
        for (coordinate, value) in all["guess"].as_object_mut().unwrap() {
            let factor = if bodies.get(coordinate).is_some() { 180.0 / std::f64::consts::PI } else { 1000.0 };
            *value = json!(value.as_f64().unwrap() * factor);
        }
        assert_same_parameters(name, text, &all.to_string(), 1e-14);
        assert!(difference(text, &all.to_string()) < 1e-9, "{name}");
    }
}

/// A triangle 3-4-5 in millimetres: the crank from the origin to (30, 40), the slider at (110, 40).
fn triangle() -> Value {
    serde_json::from_str(include_str!("../fixtures/drawn_triangle.json")).unwrap()
}

#[test]
fn lengths_points_and_guess_follow_from_the_drawing() {
    let read = mechanism(&triangle().to_string());
    let near = |value: f64, expected: f64| assert!((value - expected).abs() < 1e-15, "{value}, expected {expected}");
    let crank = read.bodies.get("crank").unwrap();
    near(crank.length.unwrap(), 0.05);
    let [x, y] = *crank.points.get("eye").unwrap();
    // (26, 43) along (0.6, 0.8), and across it.
    near(x, 0.026 * 0.6 + 0.043 * 0.8);
    near(y, 0.043 * 0.6 - 0.026 * 0.8);
    near(crank.center.unwrap()[0], 0.025);
    near(*read.guess.get("crank").unwrap(), 0.8_f64.asin());
    near(*read.guess.get("guide").unwrap(), 0.11);
    assert!(read.guess.get("slider").is_none(), "the guide holds the slider");
    near(read.joints.get("guide").unwrap().angle.unwrap(), std::f64::consts::FRAC_PI_2);
    near(read.bodies.get("flag").unwrap().angle.unwrap(), std::f64::consts::FRAC_PI_2);
    near(read.start.angle.unwrap(), std::f64::consts::FRAC_PI_4);
    Simulation::open(&triangle().to_string()).unwrap().initialize().unwrap();
}

#[test]
fn contradictions_to_the_drawing_are_rejected() {
    assert_rejected("drawings", triangle());
    // If a length and coordinates agree up to the rounding of the coordinates, the length is used.
    let mut all = triangle();
    all["bodies"]["crank"]["length"] = json!(50.000_01);
    assert_eq!(mechanism(&all.to_string()).bodies.get("crank").unwrap().length, Some(50.000_01 / 1000.0));
}
