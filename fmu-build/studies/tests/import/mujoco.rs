//! Imported mechanisms compared with accelerations from MuJoCo, computed by `mujoco_values.py`.

use fmu_studies::import::{Form, Imported, import_with};
use linkage_fmu::simulation::Simulation;
use serde_json::{Value, json};

/// Allowed relative difference of accelerations.
const SAME: f64 = 1e-9;

/// Allowed difference of travels [rad]. MuJoCo's steps do not end at the instants at which a force reaches a limit.
const SAME_TRAVEL: f64 = 2e-6;

/// A definition at its start, with a speed and inputs.
fn started(case: &Value, imported: &Imported) -> Simulation {
    let mut definition: Value = serde_json::from_str(&imported.definition).unwrap();
    if let Some(speed) = case["speed"].as_f64() {
        // The angles of hinges about y have the opposite sign in the plane.
        let sign = if definition["start"]["body"].is_string() { -1.0 } else { 1.0 };
        definition["start"]["speed"] = json!(sign * speed);
    }
    let opened = Simulation::open(&definition.to_string());
    let mut simulation = opened.unwrap_or_else(|error| panic!("{}: {error} in\n{}", case["name"], imported.definition));
    for (name, value) in case["input"].as_object().into_iter().flatten() {
        simulation.set(name, value.as_f64().unwrap()).unwrap();
    }
    simulation.initialize().unwrap();
    simulation
}

/// Outputs of a simulation that are listed under a key of a case.
fn outputs(simulation: &mut Simulation, case: &Value, key: &str) -> Vec<(String, f64)> {
    let names = case[key].as_object().into_iter().flatten().map(|(name, _)| name);
    names.map(|name| (name.clone(), simulation.get(name).unwrap())).collect()
}

#[test]
fn accelerations_of_mujoco() {
    let cases: Value = serde_json::from_str(include_str!("files/mujoco.json")).unwrap();
    let mut wrong = Vec::new();
    for case in cases.as_array().unwrap() {
        let include = |file: &str| Ok(case["files"][file].as_str().unwrap().to_owned());
        let mut all = vec![(Form::Mjcf, case["mjcf"].as_str().unwrap())];
        all.extend(case["urdf"].as_str().map(|text| (Form::Urdf, text)));
        all.extend(case["sdf"].as_str().map(|text| (Form::Sdf, text)));
        for (form, text) in all {
            let imported = match import_with(form, "Imported", text, &include) {
                Ok(imported) => imported,
                Err(error) => {
                    wrong.push(format!("{} {form:?}: {error:#}", case["name"]));
                    continue;
                }
            };
            let mut simulation = started(case, &imported);
            for (name, own) in outputs(&mut simulation, case, "accelerations") {
                let expected = case["accelerations"][&name].as_f64().unwrap();
                if (own - expected).abs() > SAME * expected.abs().max(1.0) {
                    wrong.push(format!("{} {form:?}: {name} = {own}, but {expected} in MuJoCo", case["name"]));
                }
            }
            let Some(span) = case["span"].as_f64() else { continue };
            let before = outputs(&mut simulation, case, "travel");
            simulation.step(span).unwrap();
            for ((name, end), (_, start)) in outputs(&mut simulation, case, "travel").into_iter().zip(before) {
                let (own, expected) = (end - start, case["travel"][&name].as_f64().unwrap());
                if (own - expected).abs() > SAME_TRAVEL {
                    wrong.push(format!("{}: travel of {name} = {own}, but {expected} in MuJoCo", case["name"]));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(cases.as_array().unwrap().len() > 40);
}
