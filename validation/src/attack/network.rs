//! Random supply networks with cylinders, with any of the features of a definition.
//!
//! In: random numbers. Out: the text of a definition, and the middle and size of the values of its inputs. Must not
//! know what the test checks.
use super::actuator::scale;
use super::mechanism;
use super::prepared::Definition;
use super::random::Random;
use serde_json::{Value, json};

const GIVEN: [&str; 4] = [
    include_str!("../../../modelDescription/HydraulicSystem/resources/network.json"),
    include_str!("../../../modelDescription/LandingGearSystemHydraulics/resources/network.json"),
    include_str!("../../../tests/networks/two_cylinders.json"),
    include_str!("../../../tests/networks/valve_options.json"),
];
/// One cylinder that moves a landing gear, with the name of the gear's actuator.
const RAM: &str = include_str!("../../../modelDescription/HydraulicSystem/resources/network.json");
/// Groups of which an element may be omitted.
const OPTIONAL: [&str; 10] = [
    "pumps",
    "accumulators",
    "reliefs",
    "resistances",
    "sequences",
    "bypasses",
    "checks",
    "position_valves",
    "pressure_locks",
    "valves",
];
/// Greatest nesting depth of a definition.
const DEPTH: usize = 6;

/// A network with random numbers and options; the definition may be rejected.
fn varied(random: &mut Random, json: &mut Value) {
    for group in OPTIONAL {
        if let Some(elements) = json[group].as_object_mut() {
            elements.retain(|_, _| !random.chance(0.15));
        } else if let Some(definition) = json.as_object_mut() {
            definition.remove(group);
        }
    }
    let factor = random.pick(&[1.0, 1.5, 3.0, 30.0]);
    for group in OPTIONAL.into_iter().chain(["nodes", "fluid"]) {
        if json[group].is_object() {
            scale(random, &mut json[group], factor, DEPTH);
        } else if let Some(definition) = json.as_object_mut() {
            definition.remove(group);
        }
    }
    for (_, cylinder) in json["cylinders"].as_object_mut().into_iter().flatten() {
        for chamber in ["chamber_a", "chamber_b"] {
            cylinder[chamber]["start_pressure"] = json!(random.within(-5e4, 2e7));
        }
        if random.chance(0.5) {
            cylinder["reduced_mass"] = json!(random.pick(&[0.0, 10.0, 300.0, 5000.0]));
            cylinder["holding_force"] = json!(random.within(-1e4, 1e4));
        }
        if random.chance(0.2) {
            cylinder["oil_volume"] = json!("constant");
        }
    }
    for (_, valve) in json["valves"].as_object_mut().into_iter().flatten() {
        valve["command"] = json!(random.within(-1.0, 1.0));
        if random.chance(0.3) {
            valve["overlap"] = json!(random.within(-0.1, 0.1));
        }
        if random.chance(0.2) {
            valve["transition"] = json!("switch");
        }
        if let (true, Some(valve)) = (random.chance(0.4), valve.as_object_mut()) {
            valve.remove("frequency");
        }
    }
    if random.chance(0.2) {
        json["fluid"]["air_fraction"] = json!(0.0);
    }
    json["coupling"] = json!({ "mode": random.pick(&["preview", "preview", "follow"]) });
    mechanism::solver(random, json);
    if let Some(solver) = json["solver"].as_object_mut() {
        solver.retain(|key, _| ["tolerance", "max_steps"].contains(&key.as_str()));
    }
}

fn whole(random: &mut Random, json: &mut Value) -> Definition {
    let h = random.decades(1e-4, 2e-2);
    json["experiment"] = json!({ "stop_time": 1.0, "step_size": h });
    let force = random.decades(1e2, 2e4);
    Definition { file: "network.json", text: json.to_string(), force, torque: 0.0, h }
}

/// A random definition of a network; it may be rejected.
pub fn definition(random: &mut Random) -> Definition {
    let mut json: Value = serde_json::from_str(random.pick(&GIVEN)).unwrap_or_default();
    varied(random, &mut json);
    whole(random, &mut json)
}

/// A random network whose cylinder `actuator` drives a landing gear and whose other cylinder drives a mass; the
/// definition may be rejected.
pub fn driving(random: &mut Random) -> Definition {
    let text = RAM.replace("\"gear\"", "\"actuator\"").replace("\"gear.", "\"actuator.");
    let mut json: Value = serde_json::from_str(&text).unwrap_or_default();
    let cylinder = json["cylinders"]["actuator"].clone();
    varied(random, &mut json);
    for key in ["bore", "rod", "stroke", "closed_length"] {
        json["cylinders"]["actuator"][key] = cylinder[key].clone();
    }
    if let Some(actuator) = json["cylinders"]["actuator"].as_object_mut() {
        actuator.retain(|key, _| !matches!(key.as_str(), "length" | "lower_limit" | "upper_limit"));
    }
    whole(random, &mut json)
}
