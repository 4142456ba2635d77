//! Numbers as expressions of parameters give results bit-identical to the definition with the numbers.

use crate::support::{Run, assert_rejected, assert_says, changed};
use linkage_fmu::component::{Component, MECHANISM};
use linkage_fmu::mechanism::Model;
use linkage_fmu::mechanism::definition::Mechanism;
use linkage_fmu::simulation::Simulation;
use linkage_fmu::variables::{Causality, Kind, Reference, Variability};
use serde_json::{Value, json};

const FILE: &str = "mechanism.json";
const FAMILY: &str = include_str!("../../modelDescription/FourBarFamily/resources/mechanism.json");

/// The scene `family` with sorted keys, as in all texts from [`changed`]: the order of keys affects the last digits.
fn family() -> String {
    changed(FAMILY, |_| {})
}

/// The scene `family` with the numbers for these parameters.
fn written_out(size: f64, line_density: f64, load_ratio: f64, acceleration: f64) -> String {
    let (crank, coupler, rocker) = (size / 3.0, 7.0 / 6.0 * size, 5.0 / 6.0 * size);
    let load = load_ratio * (line_density * coupler);
    let right = std::f64::consts::PI / 2.0;
    changed(FAMILY, |m| {
        m.as_object_mut().unwrap().remove("parameters");
        m["gravity"]["acceleration"] = json!(acceleration);
        m["gravity"]["up_angle"] = json!(right);
        m["bodies"]["ground"]["length"] = json!(size);
        for (body, length) in [("crank", crank), ("coupler", coupler), ("rocker", rocker)] {
            m["bodies"][body]["length"] = json!(length);
            m["bodies"][body]["mass"] = json!(line_density * length);
        }
        m["bodies"]["coupler"]["points"]["tip"] = json!([coupler / 2.0, size / 5.0]);
        m["bodies"]["load"]["mass"] = json!(load);
        m["springs"]["damper"]["damping"] = json!(0.02 * load * (size * size));
        m["start"]["angle"] = json!(std::f64::consts::PI / 3.0);
        m["start"]["speed"] = json!((acceleration / size).sqrt());
        m["guess"]["crank"] = json!(std::f64::consts::PI / 3.0);
    })
}

/// Bits of all Reals that both simulations have, by name, after the start and some steps.
fn bits(run: &mut Simulation, names: &[String]) -> Vec<(String, u64)> {
    run.initialize().unwrap();
    let mut all = Vec::new();
    for step in 0..4 {
        if step > 0 {
            run.step(0.05).unwrap();
        }
        all.extend(names.iter().map(|name| (name.clone(), run.get(name).unwrap().to_bits())));
    }
    all
}

fn reals(run: &Simulation) -> Vec<String> {
    let list = run.model().variables().list().iter();
    list.filter(|v| v.kind == Kind::Real).map(|v| v.name.clone()).collect()
}

fn reference(model: &Model, name: &str) -> Reference {
    model.variables().find(name).unwrap()
}

#[test]
fn numbers_are_those_written_out_after_any_sets() {
    let mut family = Simulation::open(&family()).unwrap();
    let mut values = [("size", 0.3), ("line_density", 2.5), ("load_ratio", 4.0), ("gravity.acceleration", 9.81)];
    let sets = [(0, 0.7), (1, 0.9), (2, 0.0), (0, 1.0 / 3.0), (3, 1.62), (0, 0.11), (2, 7.3), (1, 3.1), (0, 0.3)];
    for (index, value) in [(0, 0.3)].into_iter().chain(sets) {
        values[index].1 = value;
        family.set(values[index].0, value).unwrap();
        let mut written = Simulation::open(&written_out(values[0].1, values[1].1, values[2].1, values[3].1)).unwrap();
        let names = reals(&written);
        assert!(bits(&mut family, &names) == bits(&mut written, &names), "{values:?}");
    }
    family.model_mut().reset();
    let mut written = Simulation::open(&written_out(0.3, 2.5, 4.0, 9.81)).unwrap();
    let names = reals(&written);
    assert!(bits(&mut family, &names) == bits(&mut written, &names), "after a reset");
}

#[test]
fn the_period_grows_with_the_root_of_the_size() {
    // Under weight without the drive, motions of similar mechanisms are similar, and times grow with the root of the
    // size.
    let after = |text: &str, density: f64, size: f64| {
        let values = [("size", size), ("drive.torque", 0.0), ("line_density", density)];
        let mut run = Run::new(text).with(&values).started();
        run.step(0.4 * (size / 0.3).sqrt());
        run.get("crank.angle")
    };
    // Without the damping of the scene, which is proportional to the mass and the square of the size and would set
    // another time scale.
    let text = changed(FAMILY, |m| drop(m.as_object_mut().unwrap().remove("springs")));
    let [small, large] = [0.3, 1.2].map(|size| after(&text, 2.5, size));
    assert!((small - large).abs() < 1e-7, "{small} {large}");
    let [small, large] = [0.3, 1.2].map(|size| after(FAMILY, 0.5, size));
    assert!((small - large).abs() > 1e-4, "the damper has another time scale");
}

#[test]
fn numbers_by_expressions_are_calculated_parameters() {
    let model = Model::from_json(FAMILY).unwrap();
    let variables = model.variables();
    let named = |references: &[Reference]| -> Vec<&str> {
        references.iter().map(|r| variables.get(*r).unwrap().name.as_str()).collect()
    };
    for (name, bases) in [
        ("crank.length", &["size"][..]),
        ("load.mass", &["size", "line_density", "load_ratio"]),
        ("crank.start_speed", &["size", "gravity.acceleration"]),
        ("gravity.up_angle", &[]),
    ] {
        let variable = variables.get(reference(&model, name)).unwrap();
        assert_eq!(variable.causality, Causality::CalculatedParameter, "{name}");
        assert_eq!((variable.variability, &variable.start), (Variability::Fixed, &None), "{name}");
        assert_eq!(named(&variable.dependencies), bases, "{name}");
    }
    let initial = model.initial_dependencies().unwrap().unwrap();
    let of = |name: &str| named(&initial[reference(&model, name) as usize]);
    assert_eq!(of("load.mass"), ["size", "line_density", "load_ratio"]);
    assert!(of("tip.x").contains(&"size") && !of("tip.x").contains(&"line_density"), "{:?}", of("tip.x"));
    assert!(of("crank.acceleration").contains(&"load_ratio") && !of("crank.acceleration").contains(&"load.mass"));
    assert_eq!(of("crank.speed"), ["size", "gravity.acceleration"]);
    let size = variables.get(reference(&model, "size")).unwrap();
    assert_eq!((size.causality, size.unit.unwrap().name()), (Causality::Parameter, "m"));
    assert_eq!(size.description, "Distance of the two bearings");
}

#[test]
fn a_set_that_makes_no_mechanism_changes_nothing() {
    let mut run = Simulation::open(FAMILY).unwrap();
    let model = run.model_mut();
    let error = model.set_real(reference(model, "crank.length"), 1.0).unwrap_err().to_string();
    assert_says(&error, &["crank.length", "\"size / 3\"", "set size"]);
    let [size, ratio, mass, length] = ["size", "load_ratio", "load.mass", "crank.length"].map(|n| reference(model, n));
    let before = model.snapshot();
    for value in [-0.3, 0.0] {
        let error = model.set_real(size, value).unwrap_err().to_string();
        assert_says(&error, &["size = ", "ground.length = \"size\"", "> 0", "the expression uses size"]);
    }
    assert!(model.set_real(size, f64::NAN).is_err());
    let error = model.set_real(ratio, -1.0).unwrap_err().to_string();
    assert_says(&error, &["load_ratio = -1", "load.mass = \"load_ratio * coupler.mass\"", "coupler.mass = "]);
    let (mut now, mut then) = (Vec::new(), Vec::new());
    model.snapshot().write(&mut now).unwrap();
    before.clone().write(&mut then).unwrap();
    assert_eq!(now, then);
    assert_eq!(
        (model.real(size), model.real(mass), model.real(length)),
        (Ok(0.3), Ok(4.0 * (2.5 * (7.0 / 6.0 * 0.3))), Ok(0.3 / 3.0))
    );
}

#[test]
fn values_of_one_call_count_together() {
    let text = json!({
        "name": "Gap",
        "parameters": { "a": 1, "b": 3 },
        "bodies": { "ground": {}, "block": { "mass": "b - a" } },
        "joints": { "rail": { "type": "prismatic", "first": "ground.origin", "second": "block.origin" } },
        "start": { "joint": "rail", "position": 0 },
        "guess": { "rail": 0 },
    });
    let mut gap = Component::from_definition(FILE, &text.to_string()).unwrap();
    let [a, b, mass] = ["a", "b", "block.mass"].map(|name| gap.interface().find(name).unwrap());
    assert!(gap.set_real(a, 5.0).is_err(), "b - a would be below 0");
    assert!(gap.check_together(&[a], &[5.0]).is_err() && gap.check_together(&[a, b], &[5.0, 9.0]).is_ok());
    gap.take_real(a, 5.0).unwrap();
    gap.take_real(b, 9.0).unwrap();
    assert_eq!(gap.real(mass), Ok(4.0));
}

#[test]
fn saved_states_and_tables_contain_calculated_parameters() {
    let mut run = Run::new(FAMILY).with(&[("size", 0.55)]).started();
    run.step(0.1);
    let (mut bytes, mut other) = (run.saved(), Run::new(FAMILY));
    other.take(&bytes);
    assert_eq!(other.get("crank.length"), 0.55 / 3.0);
    let all = reals(&run.0);
    for _ in 0..3 {
        let [one, twin] = [&mut run, &mut other].map(|run| {
            run.0.model_mut().step(0.05).unwrap();
            all.iter().map(|name| run.get(name).to_bits()).collect::<Vec<_>>()
        });
        assert_eq!(one, twin);
    }
    // Damaged state: a crank length that differs from the value of the expression.
    let from = (0.55_f64 / 3.0).to_le_bytes();
    let at = bytes.windows(8).position(|eight| eight == from).unwrap();
    bytes[at..at + 8].copy_from_slice(&0.2_f64.to_le_bytes());
    assert_says(other.read_snapshot(&bytes).unwrap_err().to_string(), &["calculated parameter"]);
    // Another expression makes another mechanism. Another description does not.
    let model = Model::from_json(&family()).unwrap();
    let other = changed(FAMILY, |m| m["bodies"]["crank"]["length"] = json!("size / 4"));
    assert_ne!(Model::from_json(&other).unwrap().identity(), model.identity());
    let same = changed(FAMILY, |m| m["parameters"]["size"]["description"] = json!("Size"));
    assert_eq!(Model::from_json(&same).unwrap().identity(), model.identity());
    // Stored tables belong to the values of the expressions.
    let made = Component::from_definition(FILE, FAMILY).unwrap();
    let mut taken = Component::with_table_bytes(&MECHANISM, FAMILY, made.tables(FAMILY).unwrap()).unwrap();
    let [size, length] = ["size", "crank.length"].map(|name| taken.interface().find(name).unwrap());
    taken.set_real(size, 0.55).unwrap();
    taken.initialize().unwrap();
    assert_eq!(taken.real(length), Ok(0.55 / 3.0));
}

#[test]
fn wrong_expressions_are_errors_with_their_key() {
    assert_rejected("expressions", FAMILY);
    let text =
        changed(FAMILY, |m| m["guess"] = json!({ "crank": "pi/3", "coupler": "0.5", "rocker": "1.6 * size / 0.3" }));
    Model::from_json(&text).unwrap();
    // Expressions are in SI units in any file.
    let degrees = changed(&text, |m| m["units"] = json!({ "angle": "deg" }));
    let [plain, degrees] = [text, degrees].map(|text| Mechanism::from_json(&text).unwrap().guess);
    for (name, value) in plain.iter() {
        assert!((degrees.get(name).unwrap() - value).abs() < 1e-15, "{name}");
    }
}

/// Numbers of every kind that are read once: an expression is in SI units, a number in the units of the file.
#[test]
fn an_expression_of_a_number_that_is_read_once_is_in_si_units_too() {
    let file = |number: &dyn Fn(f64, &str) -> Value| {
        let (mm, deg) = (|mm: f64| number(mm, &format!("{mm} / 1000")), |deg: f64| number(deg, &format!("rad({deg})")));
        json!({
            "name": "Drawn", "units": { "length": "mm", "angle": "deg" },
            "bodies": {
                "ground": { "points": { "far": [500, 0] } },
                "arm": {
                    "drawn": { "origin": [mm(0.0), 0], "end": [mm(300.0), mm(40.0)],
                        "points": { "eye": [mm(90.0), 0] } }
                },
                "block": { "mass": 1, "drawn": { "origin": [mm(500.0), 0], "angle": deg(20.0) } }
            },
            "joints": {
                "pin": { "type": "revolute", "first": "ground.origin", "second": "arm.origin" },
                "wheel": { "type": "revolute", "first": "ground.far", "second": "block.origin" }
            },
            "couplings": { "mesh": { "type": "gears", "first": "arm.origin", "second": "block.origin",
                "first_teeth": 20, "second_teeth": 30 } },
            "springs": {
                "coil": { "joint": "pin", "points": [[deg(-30.0), -1], [deg(30.0), 1]] },
                "wire": { "first": "arm.eye", "second": "ground.far", "points": [[mm(100.0), 0], [mm(700.0), 5]] }
            },
            "stops": { "end": { "body": "arm", "limit": "upper", "angle": 90, "rigid": false,
                "points": [[0, 0], [deg(5.0), 2]] } },
            "start": { "body": "arm", "angle": 8 }, "guess": { "arm": deg(7.5) },
        })
        .to_string()
    };
    let numbers = Mechanism::from_json(&file(&|value, _| json!(value))).unwrap();
    let expressions = Mechanism::from_json(&file(&|_, text| json!(text))).unwrap();
    let [one, other] = [numbers, expressions]
        .map(|mut m| serde_json::from_str::<Value>(&linkage_fmu::format::written(&mut m)).unwrap());
    fn same(path: &str, one: &Value, other: &Value) {
        match (one, other) {
            (Value::Object(a), Value::Object(b)) => {
                assert_eq!(a.keys().collect::<Vec<_>>(), b.keys().collect::<Vec<_>>(), "{path}");
                a.iter().for_each(|(key, value)| same(&format!("{path}.{key}"), value, &b[key]));
            }
            (Value::Array(a), Value::Array(b)) => {
                assert_eq!(a.len(), b.len(), "{path}");
                a.iter().zip(b).for_each(|(a, b)| same(path, a, b));
            }
            (Value::Number(a), Value::Number(b)) => {
                let [a, b] = [a, b].map(|number| number.as_f64().unwrap());
                assert!((a - b).abs() <= 1e-15 * a.abs().max(1.0), "{path}: {a} {b}");
            }
            _ => assert_eq!(one, other, "{path}"),
        }
    }
    same("", &one, &other);
}

/// In a file in millimetres and degrees an expression gets a warning unless its terms have SI units.
#[test]
fn an_expression_with_an_unclear_unit_gives_a_warning() {
    let warned = |key: &str, text: &str| {
        let mut file = json!({
            "name": "Arm", "units": { "length": "mm", "angle": "deg" },
            "parameters": { "L": 100, "a": 30, "size": { "value": 0.1, "unit": "m" }, "k": { "value": 50,
                "unit": "N/m" },
                "f": { "value": 5, "unit": "N" }, "t": { "value": 0.5, "unit": "rad" } },
            "bodies": { "ground": {}, "arm": { "length": 200, "mass": 1, "shape": "uniform_rod" },
                "tip": { "fixed_to": "arm.end", "angle": 30, "length": 50 } },
            "joints": { "pin": { "type": "revolute", "first": "ground.origin", "second": "arm.origin" } },
            "start": { "body": "arm", "angle": 30 }, "guess": { "arm": 30 },
        });
        if key == "arm" {
            file["guess"]["arm"] = json!(text);
        } else {
            file["bodies"]["tip"][key] = json!(text);
        }
        let model = Model::from_json(&file.to_string()).unwrap();
        let found = model.warnings().iter().filter(|w| w.message.contains("expressions are in SI units"));
        let is_number = text.parse::<f64>().is_ok();
        assert!(found.clone().all(|w| w.remedy.contains("remove the quotes") == is_number), "{text}");
        found.map(|w| w.path.clone()).collect::<Vec<_>>()
    };
    for (key, text) in [
        ("length", "L"),
        ("length", "size + 10"),
        ("length", "0.1 * 2"),
        ("angle", "a"),
        ("angle", "t + 10"),
        ("angle", "deg(asin(0.5))"),
        ("arm", "30"),
        ("arm", "t * 2 + 1"),
    ] {
        let path = if key == "arm" { "guess.arm".to_owned() } else { format!("bodies.tip.{key}") };
        assert_eq!(warned(key, text), [path], "{text}");
    }
    for (key, text) in [
        ("length", "size"),
        ("length", "sqrt(size^2 + arm.length * size) / 3"),
        ("length", "f / k"),
        ("length", "0 * L + size"),
        ("angle", "rad(a)"),
        ("angle", "pi / 6"),
        ("angle", "t / 2"),
        ("angle", "atan2(size, arm.length)"),
        ("mass", "L / 100"),
        ("arm", "rad(a)"),
        ("arm", "t * 2"),
    ] {
        assert!(warned(key, text).is_empty(), "{text}");
    }
}

#[test]
fn a_drawing_does_not_shift_the_places_of_expressions() {
    let text = json!({
        "name": "Drawn",
        "units": { "length": "mm", "angle": "deg" },
        "parameters": { "m": 2 },
        "gravity": { "acceleration": 9.81, "up_angle": 90 },
        "bodies": {
            "ground": {},
            "arm": { "drawn": { "origin": [0, 0], "end": [300, 0] }, "mass": "m / 2", "inertia": "arm.mass * 0.01" },
        },
        "joints": { "pin": { "type": "revolute", "first": "ground.origin", "second": "arm.origin" } },
        "start": { "body": "arm", "angle": "pi / 4" },
    });
    let mut arm = Simulation::open(&text.to_string()).unwrap();
    assert_eq!(arm.get("arm.length"), Ok(0.3));
    arm.set("m", 5.0).unwrap();
    arm.set("arm.length", 0.4).unwrap();
    assert_eq!((arm.get("arm.mass"), arm.get("arm.inertia")), (Ok(2.5), Ok(2.5 * 0.01)));
    assert_eq!((arm.get("arm.length"), arm.get("arm.start_angle")), (Ok(0.4), Ok(std::f64::consts::PI / 4.0)));
}
