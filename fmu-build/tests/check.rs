//! `cargo fmu check`: every finding with its place, and facts against closed forms.
#![allow(clippy::unwrap_used)]

use fmu_build::archive::{self, Entry};
use fmu_build::check::{self, Arguments, Checked};
use fmu_build::workspace::Workspace;
use linkage_fmu::inspection::{Fact, Severity};
use serde_json::{Value, json};

fn checked(text: &str) -> Checked {
    check::check("m.json".into(), "mechanism.json", text.into()).unwrap()
}

/// A crank of 0.1 m and a rod of 0.3 m in the plane of gravity, 2 kg in the slider on the X axis.
fn slider_crank() -> Value {
    json!({
        "name": "M",
        "gravity": { "acceleration": 10.0, "up_angle": std::f64::consts::FRAC_PI_2 },
        "bodies": {
            "ground": {}, "crank": { "length": 0.1, "mass": 1.0, "shape": "uniform_rod" }, "rod": { "length": 0.3 },
            "slider": { "mass": 2.0 }
        },
        "joints": {
            "bearing": { "type": "revolute", "first": "ground.origin", "second": "crank.origin" },
            "pin": { "type": "revolute", "first": "crank.end", "second": "rod.origin" },
            "wrist": { "type": "revolute", "first": "rod.end", "second": "slider.origin" },
            "guide": { "type": "prismatic", "first": "ground.origin", "second": "slider.origin" }
        },
        "actuators": { "motor": { "joint": "bearing" }, "push": { "joint": "guide" } },
        "start": { "body": "crank", "angle": 0.5 },
        "guess": { "crank": 0.5, "rod": -0.16, "guide": 0.38 }
    })
}

fn with(path: &str, value: Value) -> String {
    let mut all = slider_crank();
    let (parent, key) = path.rsplit_once('/').unwrap();
    all.pointer_mut(parent).unwrap()[key] = value;
    serde_json::to_string_pretty(&all).unwrap()
}

/// Place and message of each finding of this weight, and the underlined text.
fn found(text: &str, severity: Severity) -> Vec<(String, String, String)> {
    let all = checked(text);
    let located = all.findings.iter().filter(|located| located.finding.severity == severity);
    let shown = |span: std::ops::Range<usize>| text[span].to_owned();
    located.map(|l| (l.finding.path.clone(), l.finding.to_string(), shown(l.span.clone()))).collect()
}

fn fact<'a>(checked: &'a Checked, topic: &str, of: &str) -> &'a Fact {
    let found = checked.inspection.facts.iter().find(|fact| fact.topic == topic && fact.of == of);
    found.unwrap_or_else(|| panic!("{topic} of {of} in {:#?}", checked.inspection.facts))
}

fn number(checked: &Checked, topic: &str, of: &str, name: &str) -> f64 {
    fact(checked, topic, of).quantities.iter().find(|quantity| quantity.name == name).unwrap().value
}

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
    // Half of m l2 / 3 omega2 and of 2 kg v2; the slider's speed over the crank's by a central difference.
    let rate = (slider(angle + 1e-6) - slider(angle - 1e-6)) / 2e-6;
    let inertia = number(&all, "Reduced mass", "motor", "start");
    assert!((inertia - (0.01 / 3.0 + 2.0 * rate * rate)).abs() < 1e-9, "{inertia}");
    near("Reduced mass", "motor", "least", 0.01 / 3.0);
    assert!(number(&all, "Reduced mass", "push", "most").is_infinite(), "dead centres of the slider");
    // The motor carries the crank's weight at half its length; the slider moves across gravity.
    near("Equilibrium at the start", "motor", "holding", 10.0 * 0.05 * angle.cos());
    assert!(fact(&all, "Equilibrium at the start", "crank").text.starts_with("does not hold"));
    let toggles = all.inspection.facts.iter().filter(|fact| fact.topic == "Toggles" && fact.of == "guide").count();
    assert_eq!(toggles, 2);
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
    assert!(fact(&checked(&pendulum.to_string()), "Equilibrium at the start", "rod").text.contains("balance"));
    let mut stopped: Value = serde_json::from_str(&balanced).unwrap();
    stopped["actuators"]["motor"]["torque"] = json!(-1.0);
    stopped["stops"] = json!({ "down": { "body": "crank", "limit": "lower", "angle": 0.5 } });
    let all = checked(&stopped.to_string());
    assert!(fact(&all, "Equilibrium at the start", "crank").text.contains("pressed against down"));
    assert!(fact(&all, "Ends of travel", "backward").text.starts_with("down at crank = 0.5"));
}

#[test]
fn redundant_joints_and_crossings_are_told() {
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

/// A carriage of 0.2 m between stops far beyond the part of its rail that is traced first.
#[test]
fn a_long_travel_is_told_to_its_stops() {
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
            let told = number(&checked, topic, of, name);
            assert!((told - expected).abs() < 1e-9, "{topic} {name}: {told}");
        }
    }
    assert!((number(&checked, "Mass", "", "centre x") - 1000.0).abs() < 1e-9);
    let text = &fact(&checked, "Ends of travel", "forward").text;
    assert!(text.contains("east at rail = 6000.000000 m"), "{text}");
}

/// An elliptic trammel whose middle a crank holds too: some of its loop equations are singular at dead centres, all of them
/// are not. A platform that does not move has no toggles.
#[test]
fn singular_parts_of_redundant_loops_are_no_crossings() {
    let rod = |length: f64| json!({ "length": length, "mass": 1, "shape": "uniform_rod", "points": { "middle": [0.5 * length, 0] } });
    let pin = |first: &str, second: &str| json!({ "type": "revolute", "first": first, "second": second });
    let slide = |second: &str, axis: f64| json!({ "type": "prismatic", "first": "ground.origin", "second": second, "axis_angle": axis });
    let trammel = json!({
        "name": "Trammel",
        "bodies": { "ground": {}, "bar": rod(1.0), "arm": rod(0.5), "across": {}, "up": {} },
        "joints": {
            "h": slide("across.origin", 0.0), "v": slide("up.origin", std::f64::consts::FRAC_PI_2),
            "a": pin("bar.origin", "across.origin"), "b": pin("bar.end", "up.origin"), "o": pin("ground.origin", "arm.origin"),
            "p": pin("arm.end", "bar.middle")
        },
        "start": { "body": "bar", "angle": 2 }, "guess": { "bar": 2.0, "arm": 1.14, "h": 0.42, "v": 0.9 }
    });
    let checked = checked(&trammel.to_string());
    assert!(checked.inspection.facts.iter().any(|fact| fact.topic == "Redundant joints"));
    assert!(checked.inspection.facts.iter().all(|fact| fact.topic != "Crossings"), "{:?}", checked.inspection.facts);
}

#[test]
fn warnings_name_the_key_the_value_and_the_remedy() {
    for (path, value, key, shown, fragments) in [
        ("/gravity/up_angle", json!(90), "gravity.up_angle", "90", vec!["90 rad", "1.570796327"]),
        ("/guess/crank", json!(28.6), "guess.crank", "28.6", vec!["4.55 turns", "degrees"]),
        ("/guess/rod", json!(2.5), "guess.rod", "2.5", vec!["from its guess of 2.5 rad"]),
        (
            "/stops",
            json!({ "up": { "joint": "guide", "limit": "upper", "position": 0.7 } }),
            "stops.up",
            "\"up\"",
            vec!["never met", "0.3 m short"],
        ),
        (
            "/stops",
            json!({ "up": { "body": "rod", "limit": "upper", "angle": 115 } }),
            "stops.up.angle",
            "115",
            vec!["degrees", "2.00712864"],
        ),
        (
            "/stops",
            json!({ "up": { "joint": "guide", "limit": "upper", "position": 0.39, "rigid": false } }),
            "stops.up",
            "\"up\"",
            vec!["neither stiffness nor damping"],
        ),
        (
            "/stops",
            json!({ "up": { "joint": "guide", "limit": "upper", "position": 0.39, "rigid": true, "stiffness": 1e4 } }),
            "stops.up.stiffness",
            "10000.0",
            vec!["while the stop is rigid", "\"rigid\": false"],
        ),
        (
            "/friction",
            json!({ "static_coefficient": 0.2, "kinetic_coefficient": 0.1 }),
            "friction",
            "\"friction\"",
            vec!["not enabled", "\"enabled\": true"],
        ),
        (
            "/forces",
            json!({ "f": { "at": "ground.origin" } }),
            "forces.f.at",
            "\"ground.origin\"",
            vec!["does nothing"],
        ),
        ("/torques", json!({ "t": { "on": "ground" } }), "torques.t.on", "\"ground\"", vec!["name a body that moves"]),
        (
            "/bodies/rod",
            json!({ "length": 0.3, "shape": "uniform_rod" }),
            "bodies.rod.shape",
            "\"uniform_rod\"",
            vec!["there is no mass"],
        ),
        (
            "/bodies/rod",
            json!({ "length": 0.3, "mass": 1, "center": [120, 5] }),
            "bodies.rod.center",
            "\"center\"",
            vec!["119.95", "0.3 m apart"],
        ),
        (
            "/joints/second_pin",
            json!({ "type": "revolute", "first": "rod.origin", "second": "crank.end" }),
            "joints.second_pin",
            "\"second_pin\"",
            vec!["the same joint as pin", "remove one"],
        ),
    ] {
        let found = found(&with(path, value), Severity::Warning);
        let own = found.iter().find(|(place, ..)| place == key).unwrap_or_else(|| panic!("{key} in {found:#?}"));
        assert_eq!(own.2, shown, "{found:#?}");
        for fragment in fragments {
            assert!(own.1.contains(fragment), "`{}` lacks `{fragment}`", own.1);
        }
    }
}

#[test]
fn friction_that_nothing_has_is_warned_of() {
    let mut text = slider_crank();
    text["friction"] = json!({ "enabled": true, "static_coefficient": 0.2, "kinetic_coefficient": 0.1 });
    assert_eq!(found(&text.to_string(), Severity::Warning), [], "the guide rubs");
    // A four-bar has no prismatic joint.
    let text = include_str!("../../modelDescription/FourBar/resources/mechanism.json").replacen(
        "\"forces\"",
        "\"friction\": { \"enabled\": true, \"static_coefficient\": 0.2, \"kinetic_coefficient\": 0.1 }, \"forces\"",
        1,
    );
    let found = found(&text, Severity::Warning);
    assert!(found.len() == 1 && found[0].1.contains("pin_radius"), "{found:#?}");
}

#[test]
fn millimetres_beside_metres_are_warned_of() {
    let text = with("/bodies/extra", json!({ "fixed_to": "slider.origin", "length": 250 }));
    let found = found(&text, Severity::Warning);
    assert!(found.iter().any(|(place, text, _)| place == "bodies.extra" && text.contains("millimetres")), "{found:#?}");
}

#[test]
fn the_same_mechanism_without_cause_gives_no_warning() {
    for name in ["AndrewsSqueezer", "CraneJib", "FourBar", "FourBarChain", "Jib", "LandingGearRetraction", "SlCrank"] {
        let path = format!("{}/../modelDescription/{name}/resources/mechanism.json", env!("CARGO_MANIFEST_DIR"));
        let text = std::fs::read_to_string(path).unwrap();
        let all = checked(&text);
        assert_eq!(all.findings.len(), 0, "{}", check::findings(&all));
        assert!(!all.inspection.facts.is_empty());
    }
}

/// Comments, NaN, decimal and trailing commas, a misspelt key, a truth value for a number: each once, at its place.
#[test]
fn every_fault_of_the_form_is_found_at_its_place() {
    let text = "{\n  // none\n  \"name\": \"M\",\n  \"gravity\": { \"acceleration\": 9,81, \"up_angle\": NaN },\n  \
                \"bodies\": { \"ground\": {}, \"a\": { \"lenght\": 1, \"mass\": true, } },\n  \"joints\": [],\n  \
                \"start\": {},\n  \"guess\": {}\n}";
    let all = checked(text);
    let places: Vec<_> = all.findings.iter().map(|l| (l.position, &text[l.span.clone()])).collect();
    let expected = [
        ([2, 3], "// none"),
        ([4, 33], ","),
        ([4, 50], "NaN"),
        ([5, 36], "\"lenght\""),
        ([5, 57], "true"),
        ([5, 61], ","),
        ([6, 13], "[]"),
    ];
    assert_eq!(places, expected, "{}", check::findings(&all));
    for (located, fragment) in all.findings.iter().zip([
        "JSON has none",
        "0.5",
        "finite",
        "unknown field `lenght`",
        "expected a number",
        "nothing follows",
        "a list",
    ]) {
        assert!(located.finding.message.contains(fragment), "{}", located.finding.message);
    }
    assert!(!all.is_whole);
}

#[test]
fn every_fault_of_the_meaning_is_found() {
    let mut text = slider_crank();
    text["joints"]["pin"]["first"] = json!("crank.tip");
    text["joints"]["wrist"]["second"] = json!("slyder.origin");
    text["joints"]["bearing"]["pin_radius"] = json!(0.01);
    text["stops"] = json!({ "s": { "body": "crank", "limit": "upper", "angle": 1, "damping": 5 } });
    text["bodies"]["rod"]["mass"] = json!(-1);
    text["start"] = json!({ "body": "krank", "angle": 1 });
    text["extra"] = json!(1);
    let text = serde_json::to_string_pretty(&text).unwrap();
    let mut places: Vec<_> = found(&text, Severity::Error).into_iter().map(|(path, ..)| path).collect();
    places.sort();
    let expected = [
        "bodies.rod.mass",
        "extra",
        "joints.bearing.pin_radius",
        "joints.pin.first",
        "joints.wrist.second",
        "start.body",
        "stops.s.damping",
    ];
    assert_eq!(places, expected);
}

#[test]
fn errors_of_the_geometry_have_their_place() {
    for (path, value, key) in [
        ("/start/angle", json!(0.5), ""),
        ("/bodies/rod/length", json!(0.04), "start.angle"),
        ("/guess/extra", json!(1), "guess.extra"),
        ("/stops", json!({ "s": { "body": "crank", "limit": "upper", "angle": 0.2 } }), "stops.s.angle"),
        ("/start", json!({ "joint": "guide", "position": 3.0 }), "start.position"),
    ] {
        let found = found(&with(path, value), Severity::Error);
        let paths: Vec<&str> = found.iter().map(|(path, ..)| path.as_str()).collect();
        assert_eq!(paths, if key.is_empty() { vec![] } else { vec![key] }, "{found:#?}");
    }
}

#[test]
fn a_hydraulic_actuator_has_facts_and_warnings_of_its_own() {
    let text = include_str!("../../modelDescription/HydraulicActuator/resources/hydraulics.json");
    let check = |text: &str| check::check("h.json".into(), "hydraulics.json", text.into()).unwrap();
    let all = check(text);
    assert_eq!(all.findings.len(), 0, "{}", check::findings(&all));
    let area = std::f64::consts::PI * 0.045_f64.powi(2) / 4.0;
    assert!((number(&all, "Cylinder", "area", "piston") - area).abs() < 1e-15);
    for (from, to, key) in [
        ("\"pressure\": 20.7e6", "\"pressure\": 207", "circuit.supply.pressure"),
        ("\"bore\": 0.045", "\"bore\": 45", "circuit.cylinder.bore"),
        ("\"rated_flow\": 1e-4", "\"rated_flow\": 6", "circuit.valve.rated_flow"),
        ("\"pressure\": 28e6", "\"pressure\": 20e6", "circuit.relief.pressure"),
    ] {
        assert!(text.contains(from), "{from}");
        let all = check(&text.replacen(from, to, 1));
        let own = all.findings.iter().find(|located| located.finding.path == key);
        assert!(own.is_some_and(|own| !own.span.is_empty()), "{key}: {}", check::findings(&all));
    }
    let all = check(&text.replacen("\"rod\": 0.025", "\"rod\": 0.05", 1));
    assert_eq!(all.findings[0].finding.path, "circuit.cylinder.rod", "{}", check::findings(&all));
}

#[test]
fn a_circuit_in_a_drive_is_checked_at_its_place() {
    let text = include_str!("../../modelDescription/LandingGearRetractionHydraulic/resources/mechanism.json");
    for (from, to, key, severity) in [
        ("\"rod\": 0.025", "\"rod\": 0.05", "rod", Severity::Error),
        ("\"bore\": 0.045", "\"bore\": 4.5", "bore", Severity::Warning),
    ] {
        assert!(text.contains(from), "{from}");
        let found = found(&text.replacen(from, to, 1), severity);
        let path = format!("actuators.actuator.hydraulics.cylinder.{key}");
        let shown = to.split(": ").last().unwrap();
        assert!(found.iter().any(|(own, _, text)| *own == path && text == shown), "{found:#?}");
    }
}

#[test]
fn the_printed_finding_shows_file_line_text_and_remedy() {
    let text = with("/gravity/up_angle", json!(90));
    let all = checked(&text);
    let printed = check::findings(&all);
    let [line, column] = all.findings[0].position;
    assert!(printed.contains(&format!("m.json:{line}:{column}")), "{printed}");
    assert!(
        printed.contains("\"up_angle\": 90") && printed.contains("^^") && printed.contains("help: if 90"),
        "{printed}"
    );
    assert!(check::summary(&all).starts_with("m.json: M: 0 errors, 1 warning"), "{}", check::summary(&all));
}

/// A file, a folder and an FMU; what passes with warnings and without.
#[test]
fn files_folders_and_fmus_are_checked() {
    let folder = std::env::temp_dir().join(format!("fmu-build-check-{}", std::process::id()));
    std::fs::create_dir_all(folder.join("resources")).unwrap();
    let odd = with("/gravity/up_angle", json!(90));
    std::fs::write(folder.join("resources/mechanism.json"), &odd).unwrap();
    std::fs::write(folder.join("good.json"), slider_crank().to_string()).unwrap();
    std::fs::write(folder.join("bad.json"), with("/start/body", json!("none"))).unwrap();
    let entry = Entry { name: "resources/mechanism.json".into(), content: odd.into_bytes() };
    archive::write(&folder.join("M.fmu"), vec![entry]).unwrap();
    let workspace = Workspace::locate();
    let passes = |name: &str, deny_warnings: bool| {
        let paths = vec![folder.join(name)];
        check::run(&workspace, &Arguments { paths, json: false, deny_warnings }).unwrap()
    };
    for (name, without, denied) in [
        ("good.json", true, true),
        ("resources/mechanism.json", true, false),
        ("M.fmu", true, false),
        ("", true, false),
    ] {
        assert_eq!((passes(name, false), passes(name, true)), (without, denied), "{name}");
    }
    assert!(!passes("bad.json", false));
    let missing =
        check::run(&workspace, &Arguments { paths: vec![folder.join("no.fmu")], json: true, deny_warnings: false });
    assert!(!missing.unwrap(), "a path that cannot be read is an error");
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn the_json_for_programs_has_places_facts_and_counts() {
    let told = check::json(&[checked(&with("/gravity/up_angle", json!(90)))]);
    let one = &told[0];
    assert_eq!((&one["errors"], &one["warnings"], &one["name"]), (&json!(0), &json!(1), &json!("M")));
    let finding = &one["findings"][0];
    assert_eq!((&finding["severity"], &finding["path"]), (&json!("warning"), &json!("gravity.up_angle")));
    assert!(finding["line"].as_u64().unwrap() > 1 && finding["remedy"].as_str().unwrap().contains("degrees"));
    let mass = one["facts"].as_array().unwrap().iter().find(|fact| fact["topic"] == "Mass").unwrap();
    assert_eq!(mass["quantities"][0], json!({ "name": "total", "value": 3.0, "unit": "kg" }));
}

/// What the parser alone refuses has its place and its remedy, and what can be read besides is read.
#[test]
fn what_is_no_json_has_its_place_and_its_remedy() {
    let good = serde_json::to_string_pretty(&slider_crank()).unwrap();
    for (from, to, shown, said) in [
        ("\"name\": \"M\"", "'name': 'M'", "'name'", "double quotes"),
        ("\"mass\": 1.0", "\"mass\": .5", ".5", "0.5"),
        ("\"mass\": 1.0", "\"mass\": 1/2", "1/2", "write the number 0.5"),
        ("\"mass\": 1.0", "\"mass\": pi/2", "pi/2", "1.570796327"),
        ("\"mass\": 1.0", "\"mass\": 1.2x", "1.2x", "write 1.2 alone"),
        ("\"mass\": 1.0", "\"mass\" = 1.0", "=", "colon"),
        ("\"mass\": 1.0,", "\"mass\": 1.0", "\"shape\"", "comma is missing"),
        ("\"mass\": 1.0,", "\"mass\": 1.0, \"mass\": 2.0,", "\"mass\"", "remove one"),
        ("\"name\": \"M\"", "\"name\": \"M", "\"M", "closing quote"),
    ] {
        let text = good.replacen(from, to, 1);
        assert_ne!(text, good, "{from}");
        let all = found(&text, Severity::Error);
        assert!(all[0].1.contains(said), "{to}: {all:#?}");
        assert!(all[0].2.starts_with(shown) && all[0].2.len() <= shown.len() + 1, "{to}: {all:#?}");
    }
    for (text, said) in [
        (format!("{good}}}"), "bracket too many"),
        (format!("{good}\n{good}"), "ends before"),
        (good.trim_end().trim_end_matches('}').to_owned(), "never closed"),
        ("[]".into(), "one object"),
    ] {
        let all = checked(&text);
        let first = &all.findings[0];
        assert!(first.finding.message.contains(said) && !first.span.is_empty(), "{:#?}", all.findings);
        assert!(!first.finding.message.contains("decimals"), "{}", first.finding.message);
    }
}

#[test]
fn all_that_an_empty_definition_lacks_is_told() {
    let messages: Vec<_> = checked("{}").findings.into_iter().map(|located| located.finding.message).collect();
    for key in ["name", "bodies", "joints", "start"] {
        assert!(messages.iter().any(|message| message.contains(&format!("`{key}`"))), "{key}: {messages:#?}");
    }
}

#[test]
fn values_are_told_in_the_units_of_the_file() {
    let mut text = slider_crank();
    text["units"] = json!({ "length": "mm" });
    for (body, length) in [("crank", 100), ("rod", 300)] {
        text["bodies"][body]["length"] = json!(length);
    }
    (text["guess"]["guide"], text["start"]) = (json!(380), json!({ "joint": "guide", "position": 500 }));
    let all = found(&text.to_string(), Severity::Error);
    assert!(all[0].1.contains("= 500 mm") && all[0].1.contains("from 200 mm to 400 mm"), "{all:#?}");
    text["start"]["position"] = json!(390);
    text["stops"] = json!({ "s": { "joint": "guide", "limit": "upper", "position": 0.35 } });
    let all = found(&text.to_string(), Severity::Error);
    assert!(all[0].1.starts_with("stops.s.position = 0.35 mm: the start, at 390 mm") && all[0].2 == "0.35", "{all:#?}");
}

#[test]
fn names_and_guesses_at_fault_are_told_together() {
    let mut text = slider_crank();
    text["guess"] = json!({ "crank": 0.5 });
    let all = found(&text.to_string(), Severity::Error);
    assert!(all[0].1.contains("of guide") && all[0].1.contains("rod"), "{all:#?}");
    text["guess"] = json!({ "crank": 0.5, "rod": -0.16, "gude": 0.38 });
    text["start"]["body"] = json!("krank");
    let paths: Vec<String> = found(&text.to_string(), Severity::Error).into_iter().map(|(path, ..)| path).collect();
    assert!(
        paths.iter().any(|path| path == "start.body") && paths.iter().any(|path| path == "guess.gude"),
        "{paths:?}"
    );
    let text = with("/guess/slider", json!(0));
    assert!(found(&text, Severity::Error)[0].1.contains("remove this key"));
    let mut text = slider_crank();
    text["joints"]["slider"] = text["joints"]["guide"].take();
    text["joints"].as_object_mut().unwrap().remove("guide");
    let all = found(&text.to_string(), Severity::Error);
    assert!(all.iter().any(|(.., message, _)| message.contains("`slider` names a body and a joint")), "{all:#?}");
    let text = with("/name", json!("CON"));
    assert!(found(&text, Severity::Error)[0].1.contains("name of a device"));
}

#[test]
fn of_many_names_the_nearest_are_told() {
    let mut text = slider_crank();
    let points: serde_json::Map<_, _> = (0..20_000).map(|k| (format!("p{k}"), json!([0.0, 0.1]))).collect();
    text["bodies"]["rod"]["points"] = points.into();
    text["markers"] = json!({ "m": { "at": "rod.p123456" } });
    let all = found(&text.to_string(), Severity::Error);
    assert!(all[0].1.len() < 300 && all[0].1.contains("20002 in number") && all[0].1.contains("p12345"), "{all:#?}");
}

#[test]
fn settings_that_do_nothing_are_warned_of() {
    let text = with("/experiment", json!({ "stop_time": 1.0, "step_size": 10.0 }));
    assert!(found(&text, Severity::Warning).iter().any(|(path, ..)| path == "experiment.step_size"));
    let text =
        with("/springs", json!({ "s": { "first": "ground.origin", "second": "slider.origin", "stiffness": 0 } }));
    assert!(found(&text, Severity::Warning).iter().any(|(path, ..)| path == "springs.s"));
}

/// Paths that cannot be read have an object of their own; nothing is packed unless all is sound.
#[test]
fn a_path_that_cannot_be_read_does_not_hide_the_others() {
    use std::process::Command;
    let folder = std::env::temp_dir().join(format!("fmu-build-check-paths-{}", std::process::id()));
    std::fs::create_dir_all(folder.join("near")).unwrap();
    let put = |name: &str, text: &str| std::fs::write(folder.join(name), text).unwrap();
    put("good.json", &slider_crank().to_string());
    put("bad.json", &with("/guess/gude", json!(1)));
    put("near/Mechanism.json", "{}");
    let run = |arguments: &[&str]| {
        let out = Command::new(env!("CARGO_BIN_EXE_fmu-build")).args(arguments).current_dir(&folder).output().unwrap();
        let text = |bytes| String::from_utf8(bytes).unwrap();
        (text(out.stdout), text(out.stderr), out.status.code())
    };
    let (out, _, code) = run(&["check", "--json", "good.json", "missing.json", "bad.json"]);
    let all: Value = serde_json::from_str(&out).unwrap();
    let errors: Vec<_> = all.as_array().unwrap().iter().map(|one| one["errors"].as_u64().unwrap()).collect();
    assert_eq!((errors, code), (vec![0, 1, 1], Some(1)), "{out}");
    let (out, ..) = run(&["check", "missing.json", "good.json"]);
    assert!(out.contains("no such file") && out.contains("good.json: M: 0 errors"), "{out}");
    let (out, error, code) = run(&["package", "--out", "fmus", "good.json", "bad.json", "missing.json"]);
    assert!(error.contains("nothing was packed") && error.contains("missing.json: there is no such"), "{error}");
    assert_eq!((out.matches("guess.gude:").count(), error.matches("guess.gude").count(), code), (1, 0, Some(1)));
    assert!(!folder.join("fmus").exists());
    assert!(run(&["check", "near"]).0.contains("rename this file to mechanism.json"));
    std::fs::write(folder.join("in.csv"), "time;load\n0;1\n").unwrap();
    let (_, error, _) = run(&["simulate", "good.json", "--input-file", "in.csv"]);
    assert!(error.contains("separated by ';'"), "{error}");
    std::fs::remove_dir_all(folder).unwrap();
}
