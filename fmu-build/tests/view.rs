//! `cargo fmu view`: poses against closed forms and outputs, pages of valid and invalid definitions, hostile texts.
#![allow(clippy::unwrap_used)]

#[path = "../../tests/support/folder.rs"]
mod folder;

use fmu_build::archive::{self, Entry};
use fmu_build::check::{self, Checked};
use fmu_build::view::{self, Arguments, Data, Status, Wanted, as_script};
use fmu_build::workspace::Workspace;
use folder::Folder;
use linkage_fmu::mechanism::inspection::{On, Pose, attempt};
use linkage_fmu::simulation::Simulation;
use serde_json::{Value, json};
use std::fs;
use std::path::PathBuf;

/// A line of the licence of uPlot.
const NOTICE: &str = "Copyright (c) 2022 Leon Sorokin";

fn definition(name: &str) -> String {
    let folder = Workspace::locate().descriptions().join(name);
    fs::read_to_string(folder.join("resources/mechanism.json")).unwrap()
}

fn checked(text: &str) -> Checked {
    check::check("m.json".into(), "mechanism.json", text.into()).unwrap()
}

fn data(text: &str, start_values: &[&str]) -> Data {
    let words: Vec<String> = start_values.iter().map(|&word| word.to_owned()).collect();
    Data::collect(&checked(text), &Wanted::new(None, &words).unwrap()).unwrap()
}

/// The gear with another value at a path such as `/bodies/coupler/length`.
fn gear_with(path: &str, value: Value) -> String {
    let mut all: Value = serde_json::from_str(&definition("LandingGearRetraction")).unwrap();
    *all.pointer_mut(path).unwrap() = value;
    all.to_string()
}

/// A point in the mechanism frame.
fn place(poses: &[Pose], on: On) -> [f64; 2] {
    let [angle, x, y] = poses[on.frame];
    let (sin, cos) = angle.sin_cos();
    [x + cos * on.at[0] - sin * on.at[1], y + sin * on.at[0] + cos * on.at[1]]
}

fn apart(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

#[test]
fn poses_of_a_slider_crank_are_those_of_the_closed_form() {
    let mut simulation = Simulation::open(&definition("SliderCrank")).unwrap();
    let scene = simulation.model_mut().scene().unwrap();
    assert_eq!(scene.frames, ["ground", "crank", "rod", "piston"]);
    assert_eq!(simulation.model().poses(), None);
    simulation.initialize().unwrap();
    for _ in 0..40 {
        let poses = simulation.model().poses().unwrap();
        let angle = poses[1][0];
        // Outputs come from tables, poses from the exact evaluator.
        let computed = simulation.get("crank.angle").unwrap();
        assert!((angle - computed).abs() < 1e-13 * (1.0 + computed.abs()), "{angle} {computed}");
        // The piston moves on the Y axis: a crank of 0.05 m, a rod of 0.2 m.
        let height = 0.05 * angle.sin() + (0.04 - (0.05 * angle.cos()).powi(2)).sqrt();
        assert!(apart([poses[3][1], poses[3][2]], [0.0, height]) < 1e-14, "{poses:?}");
        for joint in scene.joints.iter().filter(|joint| joint.axis.is_none()) {
            assert!(apart(place(&poses, joint.first), place(&poses, joint.second)) < 1e-15, "{}", joint.name);
        }
        simulation.step(5e-3).unwrap();
    }
    // The angle continues over whole turns.
    assert!(simulation.model().poses().unwrap()[1][0] > 20.0);
}

#[test]
fn poses_of_the_gear_agree_with_its_markers_and_weights() {
    let mut gear = Simulation::open(&definition("LandingGearRetraction")).unwrap();
    let scene = gear.model_mut().scene().unwrap();
    gear.initialize().unwrap();
    for _ in 0..13 {
        gear.step(0.01).unwrap();
        let poses = gear.model().poses().unwrap();
        let wheel = [gear.get("wheel.x").unwrap(), gear.get("wheel.y").unwrap()];
        assert!(apart(place(&poses, scene.markers[0].on), wheel) < 1e-13);
        let ends = scene.actuators[0].ends.unwrap().map(|end| place(&poses, end));
        assert!((apart(ends[0], ends[1]) - gear.get("actuator.length").unwrap()).abs() < 1e-13);
    }
    let weight: f64 = scene.weights.iter().map(|weight| weight.force[0].hypot(weight.force[1])).sum();
    let mass: f64 = scene.bodies.iter().map(|body| body.mass).sum();
    assert!((weight - 9.81 * mass).abs() < 1e-11 * weight, "{weight} {mass}");
    let leg = scene.bodies.iter().find(|body| body.name == "leg").unwrap();
    let [origin, end] = [0, 1].map(|k| leg.points[k].on.at);
    assert!(apart(leg.center.at, [0.5 * (origin[0] + end[0]), 0.5 * (origin[1] + end[1])]) < 1e-15);
}

#[test]
fn the_travel_goes_from_stop_to_stop_with_all_joints_closed() {
    let mut gear = Simulation::open(&definition("LandingGearRetraction")).unwrap();
    let scene = gear.model_mut().scene().unwrap();
    let sweep = gear.model_mut().sweep(60).unwrap();
    assert_eq!((sweep.poses.len(), sweep.goes_on), (61, [false, false]));
    let angles: Vec<f64> = sweep.poses.iter().map(|poses| poses[1][0]).collect();
    let (least, most) = angles.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)));
    assert!((least + 1.3).abs() < 1e-10 && (most - 0.8).abs() < 1e-10, "{least} {most}");
    let names: Vec<&str> = sweep.stops.iter().map(|met| scene.stops[met.stop].name.as_str()).collect();
    assert!(names.contains(&"upstop") && names.contains(&"downstop"), "{names:?}");
    for poses in &sweep.poses {
        for joint in &scene.joints {
            assert!(apart(place(poses, joint.first), place(poses, joint.second)) < 1e-14, "{}", joint.name);
        }
    }
    assert_eq!(sweep.coordinates[0], ("crank".into(), angles));
    assert_eq!((sweep.drives[0].0.as_str(), sweep.drives[0].1), ("actuator.length", false));
}

/// The ends of cylinders have names, like stops.
#[test]
fn a_travel_that_cylinders_end_names_their_ends() {
    let sweep = Simulation::open(&definition("LiftArm")).unwrap().model_mut().sweep(8).unwrap();
    assert_eq!(sweep.ends, ["guy.extended", "lift.extended"].map(|name| Some(name.to_owned())));
    let angles = &sweep.coordinates[0].1;
    let facts = checked(&definition("LiftArm")).inspection.facts;
    let arm = facts.iter().find(|fact| fact.topic == "Travel").unwrap();
    assert_eq!([0, 1].map(|k| arm.quantities[k].value), [angles[0], angles[8]]);
}

/// The error message uses the units of the file.
#[test]
fn the_reason_why_there_is_no_motion_is_in_the_units_of_the_file() {
    let text = gear_with("/bodies/coupler/length", json!(0.02));
    let error = data(&text.replacen('{', r#"{ "units": { "length": "mm" }, "#, 1), &[]).error.unwrap();
    assert!(error.contains(" mm apart") && !error.contains(" m "), "{error}");
}

#[test]
fn a_whole_round_is_shown_where_nothing_stops_the_motion() {
    let mut four_bar = Simulation::open(&definition("FourBar")).unwrap();
    let sweep = four_bar.model_mut().sweep(48).unwrap();
    let (first, last) = (&sweep.poses[0], &sweep.poses[48]);
    assert!(sweep.is_closed && sweep.stops.is_empty());
    assert!(((last[1][0] - first[1][0]).abs() - std::f64::consts::TAU).abs() < 1e-10);
    for (one, other) in first.iter().zip(last) {
        assert!(apart([one[1], one[2]], [other[1], other[2]]) < 1e-12);
    }
}

/// By virtual work, holding force x displacement of the drive is the increase of the potential energy.
#[test]
fn forces_along_the_travel_agree_with_the_potential() {
    for (name, drive) in [("Jib", "cylinder"), ("FourBar", "drive"), ("LandingGearRetraction", "actuator")] {
        let mut simulation = Simulation::open(&definition(name)).unwrap();
        let model = simulation.model_mut();
        let sweep = model.sweep(1000).unwrap();
        let holding = ["holding_force", "holding_torque"].map(|word| format!("{drive}.{word}"));
        let holding = holding.iter().find_map(|name| model.variables().find(name)).unwrap();
        let potential = model.variables().find("energy.potential").unwrap();
        let columns = model.at_rest(&sweep.sigma, &[holding, potential], None).unwrap();
        let slopes = &sweep.slopes[sweep.coordinates.len()];
        let rise = |k: usize| (columns[1][k + 1] - columns[1][k - 1]) / (sweep.sigma[k + 1] - sweep.sigma[k - 1]);
        let largest = (1..1000).map(|k| rise(k).abs()).fold(0.0, f64::max);
        for k in 1..1000 {
            // A central difference of a smooth function over a thousandth of its range.
            let off = columns[0][k] * slopes[k] - rise(k);
            assert!(off.abs() < 1e-3 * largest, "{name} {k}: {off} of {largest}");
        }
    }
}

/// The gear with a prescribed motion, with a hydraulic circuit and with a force has equal forces at rest.
#[test]
fn a_prescribed_motion_and_a_circuit_have_forces_at_rest_too() {
    let holding = |name: &str| {
        let json = serde_json::to_value(data(&definition(name), &[])).unwrap();
        let values = json["travel"]["values"].as_array().unwrap().clone();
        values.into_iter().find(|value| value["name"] == "actuator.holding_force").unwrap()["values"].clone()
    };
    for other in ["SmoothRetraction", "LandingGearRetractionHydraulic"] {
        assert_eq!(holding(other), holding("LandingGearRetraction"), "{other}");
    }
}

#[test]
fn dead_centres_are_those_of_the_closed_form() {
    let mut simulation = Simulation::open(&definition("SliderCrank")).unwrap();
    let sweep = simulation.model_mut().sweep(240).unwrap();
    let crank = |sigma: f64| {
        let k = sweep.sigma.partition_point(|s| *s < sigma).max(1);
        let u = (sigma - sweep.sigma[k - 1]) / (sweep.sigma[k] - sweep.sigma[k - 1]);
        let angles = &sweep.coordinates[0].1;
        angles[k - 1] + u * (angles[k] - angles[k - 1])
    };
    // The piston reverses when crank and rod are in line, the rod when the crank is normal to the axis of the piston.
    let of =
        |name: &str| sweep.dead_centres.iter().filter(|(_, of)| of == name).map(|(s, _)| crank(*s)).collect::<Vec<_>>();
    assert!(
        of("cylinder").iter().any(|angle| (angle - std::f64::consts::FRAC_PI_2).abs() < 1e-3),
        "{:?}",
        of("cylinder")
    );
    let rod = of("rod");
    assert!(rod.len() == 2 && rod[0].abs() < 1e-3 && (rod[1] - std::f64::consts::PI).abs() < 1e-3, "{rod:?}");
}

#[test]
fn two_runs_are_compared_under_their_names() {
    let text = definition("LandingGearRetraction");
    let changed = ["actuator.force".to_owned(), "2e4".to_owned()];
    let checked = checked(&text);
    let mut one = data(&text, &[]);
    one.compare_with(Data::collect(&checked, &Wanted::default().compared(&changed)).unwrap(), &changed);
    let json = serde_json::to_value(&one).unwrap();
    assert_eq!(
        (json["label"].as_str(), json["compare"]["label"].as_str()),
        (Some("as defined"), Some("actuator.force 2e4"))
    );
    let force = |data: &Value| {
        let all = data["motion"]["variables"].as_array().unwrap();
        all.iter().find(|v| v["name"] == "actuator.force").unwrap()["values"].as_f64().unwrap()
    };
    assert_eq!((force(&json), force(&json["compare"])), (3e4, 2e4));
    let unknown = ["actuator.farce".to_owned(), "1".to_owned()];
    let error = format!("{:#}", Data::collect(&checked, &Wanted::default().compared(&unknown)).unwrap_err());
    assert!(error.contains("--compare-set") && error.contains("actuator.farce"), "{error}");
}

#[test]
fn an_open_loop_is_shown_at_the_guess_with_its_gap() {
    let text = gear_with("/bodies/coupler/length", json!(0.02));
    let attempt = attempt(&text).unwrap();
    assert!(!attempt.is_assembled);
    // From the origin of the ground along crank and coupler to the end of the follower and back along the follower, at
    // the guess.
    let links = [(0.1755, 0.8_f64), (0.02, 0.46), (-0.34, 2.43)];
    let reached = links.iter().fold([0.0, 0.0], |[x, y], (l, a)| [x + l * a.cos(), y + l * a.sin()]);
    let expected = apart(reached, [0.5729, 0.0]);
    assert_eq!(attempt.gaps.len(), 1);
    let gap = &attempt.gaps[0];
    assert!((gap.gap - expected).abs() < 1e-15 && (apart(gap.first, gap.second) - expected).abs() < 1e-15, "{gap:?}");
    let data = data(&text, &[]);
    assert_eq!(data.status, Status::Still);
    let error = data.error.clone().unwrap();
    assert!(error.contains("the loop of joint4 cannot close"), "{error}");
    let html = view::html(&data).unwrap();
    assert!(html.contains("role=\"alert\"") && html.contains("the loop of joint4 cannot close"));
}

#[test]
fn a_mechanism_that_does_not_run_is_shown_assembled() {
    let data = data(&gear_with("/start/angle", json!(1.5)), &[]);
    assert_eq!(data.status, Status::Still);
    assert!(data.still.as_ref().unwrap().is_assembled());
    assert!(data.error.unwrap().contains("downstop"));
}

#[test]
fn an_unreadable_definition_gives_a_page_with_the_error() {
    for text in ["{", "[]", &gear_with("/joints/joint1/first", json!("ground.nowhere"))] {
        let data = data(text, &[]);
        assert_eq!(data.status, Status::Nothing);
        let html = view::html(&data).unwrap();
        assert!(html.contains("role=\"alert\""), "{text}");
    }
}

#[test]
fn start_values_change_the_motion_and_wrong_ones_are_rejected_with_their_name() {
    let crank = |data: &Data| serde_json::to_value(data).unwrap()["motion"]["poses"][1][0]["d"][0].as_i64().unwrap();
    let (plain, turned) = (data(&definition("LandingGearRetraction"), &[]), {
        data(&definition("LandingGearRetraction"), &["crank.start_angle", "30deg", "friction.enabled", "true"])
    });
    // The first sample of a series, in steps of 1e-6 rad.
    let ratio = crank(&turned) as f64 / crank(&plain) as f64;
    assert!((ratio - 30f64.to_radians() / 0.8).abs() < 1e-5, "{ratio}");
    let checked = checked(&definition("LandingGearRetraction"));
    for words in [["crank.angel", "1"], ["crank.angle", "1"], ["crank.mass", "-1"], ["friction.enabled", "2"]] {
        let wanted = Wanted::new(None, &words.map(String::from)).unwrap();
        let error = format!("{:#}", Data::collect(&checked, &wanted).unwrap_err());
        assert!(error.contains(words[0]), "{error}");
    }
}

/// A motion that ends early is shown up to its end.
#[test]
fn a_step_that_cannot_be_made_ends_the_motion_with_its_error() {
    let mut all: Value = serde_json::from_str(&definition("LandingGearRetraction")).unwrap();
    all["solver"] = json!({ "tolerance": 1e-9, "method": "rigid_fem", "fem_step": 1e-5 });
    all["friction"]["enabled"] = json!(false);
    // The finite elements have no stops: reaching a stop ends the run.
    all["experiment"] = json!({ "stop_time": 0.3, "step_size": 0.001 });
    let data = data(&all.to_string(), &[]);
    assert_eq!(data.status, Status::Part);
    let error = data.error.clone().unwrap();
    assert!(error.contains("the motion stopped with an error") && error.contains("upstop"), "{error}");
    let time = data.motion.unwrap().stop_time();
    assert!(time > 0.12 && time < 0.14, "{time}");
}

const HOSTILE: &str =
    "</script><img src=x onerror=alert(1)><!--\" ' & \u{202e}reversed\u{202c} \u{200f}\u{2028}\u{2029} ]]> {{ 7*7 }}";

#[test]
fn markup_in_texts_stays_text() {
    let text = gear_with("/description", json!(HOSTILE.replace(['\u{2028}', '\u{2029}'], "")));
    let data = data(&text, &[]);
    let html = view::html(&data).unwrap();
    assert!(!html.contains("<img") && !html.contains("<!--\""));
    assert_eq!(html.matches("</script>").count(), 3, "only the page's own");
    let text = html.split_once("<bdi id=\"lead\">").unwrap().1;
    assert!(["&lt;&#x2f;script&gt;&lt;img", "&lt;/script&gt;&lt;img"].iter().any(|start| text.starts_with(start)));
    assert!(html.contains("{{ 7*7 }}"));
    let (_, rest) = html.split_once("<script type=\"application/json\" id=\"data\">").unwrap();
    let (json, _) = rest.split_once("</script>").unwrap();
    let read: Value = serde_json::from_str(json).unwrap();
    assert_eq!(read["description"].as_str().unwrap(), data.description);
}

#[test]
fn json_in_a_script_is_the_same_json_without_marks() {
    let text = serde_json::to_string(&json!({ HOSTILE: [HOSTILE, "\u{2066}\u{2069}\u{061c}", 1.5, null] })).unwrap();
    let escaped = as_script(&text);
    assert!(!escaped.contains(['<', '>', '&', '\u{2028}', '\u{2029}', '\u{202e}', '\u{202c}', '\u{200f}', '\u{2066}']));
    assert_eq!(serde_json::from_str::<Value>(&escaped).unwrap(), serde_json::from_str::<Value>(&text).unwrap());
}

#[test]
fn every_mechanism_has_a_page_that_loads_nothing() {
    for folder in Workspace::locate().description_folders().unwrap() {
        let path = folder.join("resources/mechanism.json");
        let Ok(text) = fs::read_to_string(&path) else { continue };
        let data = data(&text, &[]);
        assert_eq!(data.status, Status::Whole, "{}: {:?}", path.display(), data.error);
        let html = view::html(&data).unwrap();
        assert!(html.contains("default-src 'none'") && html.contains(NOTICE));
        for outside in ["src=\"", "@import", "url(", "href=\"http", "fetch(", "XMLHttpRequest"] {
            assert!(!html.contains(outside), "{}: {outside}", path.display());
        }
        if data.name == "LandingGearRetraction" {
            assert!(html.len() < 300_000, "the page of the gear has {} bytes", html.len());
        }
    }
}

#[test]
fn a_page_is_written_and_hydraulics_are_rejected() {
    let workspace = Workspace::locate();
    let folder = Folder::new("view");
    let arguments = |path: PathBuf, out: &str| Arguments {
        path,
        out: Some(folder.join(out)),
        stop_time: Some(0.05),
        ..Arguments::default()
    };
    let gear = workspace.descriptions().join("LandingGearRetraction");
    assert!(view::run(&workspace, &arguments(gear, "gear.html")).unwrap());
    let page = fs::read_to_string(folder.join("gear.html")).unwrap();
    assert!(page.starts_with("<!DOCTYPE html>") && !page.contains("connect-src") && !page.contains("CodeMirror"));
    // In a folder the page has the name of the model.
    let gear = workspace.descriptions().join("LandingGearRetraction");
    assert!(view::run(&workspace, &arguments(gear, "new/")).unwrap());
    assert!(folder.join("new/LandingGearRetraction.html").exists());
    // A run of length 0 is the start.
    let gear = workspace.descriptions().join("LandingGearRetraction");
    assert!(view::run(&workspace, &Arguments { stop_time: Some(0.0), ..arguments(gear, "start.html") }).unwrap());
    assert!(fs::read_to_string(folder.join("start.html")).unwrap().contains("\"count\":1,\"stop_time\":0.0"));
    let entry =
        Entry { name: "resources/mechanism.json".into(), content: definition("LandingGearRetraction").into_bytes() };
    archive::write(&folder.join("Gear.fmu"), vec![entry]).unwrap();
    assert!(view::run(&workspace, &arguments(folder.join("Gear.fmu"), "fmu.html")).unwrap());
    let pages = ["gear.html", "fmu.html"].map(|page| fs::read_to_string(folder.join(page)).unwrap());
    // Both pages show the same motion, but name other sources.
    let motion = |page: &str| page.split_once("\"motion\":").unwrap().1.split_once("</script>").unwrap().0.to_owned();
    assert_eq!(motion(&pages[0]), motion(&pages[1]));
    let broken = folder.join("broken.json");
    fs::write(&broken, gear_with("/bodies/coupler/length", json!(0.02))).unwrap();
    assert!(!view::run(&workspace, &arguments(broken, "broken.html")).unwrap());
    assert!(fs::metadata(folder.join("broken.html")).unwrap().len() > 10_000);
    let actuator = workspace.descriptions().join("HydraulicActuator");
    let error = view::run(&workspace, &arguments(actuator, "actuator.html")).unwrap_err().to_string();
    assert!(error.contains("has no mechanism that can be drawn"), "{error}");
    assert!(!folder.join("actuator.html").exists());
}
