//! Random hydraulic actuators and landing gears with a circuit, with any of the features of a definition.
//!
//! In: random numbers. Out: the text of a definition, and the middle and size of the values of its inputs. Must not
//! know what the test checks.
use super::mechanism;
use super::prepared::Definition;
use super::random::Random;
use serde_json::{Value, json};

const ACTUATOR: &str = include_str!("../../../modelDescription/HydraulicActuator/resources/hydraulics.json");
const CIRCUIT: &str = example!("LandingGearRetractionHydraulic");
/// Greatest nesting depth of a definition.
const DEPTH: usize = 6;

/// Multiply each number below a value by a random factor, with a probability of one in three.
pub fn scale(random: &mut Random, value: &mut Value, factor: f64, depth: usize) {
    match value {
        Value::Object(members) if depth > 0 => {
            members.values_mut().for_each(|member| scale(random, member, factor, depth - 1));
        }
        Value::Number(number) if random.chance(0.33) => {
            let scaled = number.as_f64().unwrap_or(1.0) * random.decades(1.0 / factor, factor);
            *value = json!(scaled);
        }
        _ => {}
    }
}

/// A circuit with random numbers and options; the definition may be rejected.
fn circuit(random: &mut Random, circuit: &mut Value) {
    let cylinder = circuit["cylinder"].clone();
    let factor = random.pick(&[1.0, 1.5, 3.0, 30.0]);
    scale(random, circuit, factor, DEPTH);
    if random.chance(0.7) {
        circuit["cylinder"] = cylinder;
    }
    circuit["chamber_a"]["start_pressure"] = json!(random.within(-5e4, 2e7));
    circuit["chamber_b"]["start_pressure"] = json!(random.within(-5e4, 2e7));
    if random.chance(0.25) {
        circuit["fluid"]["air_fraction"] = json!(0.0);
    }
    for cushion in ["cushion_a", "cushion_b"] {
        if random.chance(0.25) {
            circuit[cushion]["length"] = json!(0.0);
        }
    }
    if random.chance(0.3) {
        circuit["valve"]["overlap"] = json!(random.within(-0.1, 0.1));
    }
    if random.chance(0.3) {
        circuit["restrictor_b"]["rated_flow"] = json!(random.decades(1e-5, 1e-3));
    }
    if random.chance(0.3) {
        circuit["lock_valve"] = json!({ "pilot_ratio": random.decades(0.05, 2.0), "width": random.decades(1e3, 1e6) });
    }
    if random.chance(0.3) {
        let part = |random: &mut Random| 6e-5 * random.part();
        circuit["hose"] =
            json!({ "volume_a": part(random), "volume_b": part(random), "modulus": random.decades(1e8, 1e10) });
        circuit["cylinder"]["wall_modulus"] = json!(random.pick(&[0.0, 1e10]));
    }
    if random.chance(0.3) {
        circuit["seal"]["pressure_area"] = json!(random.decades(1e-7, 1e-4));
    } else if random.chance(0.3) {
        circuit["seal"] = json!({ "coulomb": 0.0, "static": 0.0, "viscous": 0.0 });
    }
    if random.chance(0.5) {
        circuit["command"] = json!({
            "ramp_amplitude": random.within(-1.5, 1.5), "ramp_time": random.pick(&[0.0, 0.01, 0.1]),
            "sine_amplitude": random.pick(&[0.0, 0.3, 1.5]), "sine_frequency": random.decades(0.1, 100.0),
        });
    }
}

/// A random definition of an actuator; it may be rejected.
pub fn definition(random: &mut Random) -> Definition {
    let mut json: Value = serde_json::from_str(ACTUATOR).unwrap_or_default();
    circuit(random, &mut json["circuit"]);
    let [closed, stroke] =
        ["closed_length", "stroke"].map(|key| json["circuit"]["cylinder"][key].as_f64().unwrap_or(0.3));
    json["actuator"] = json!({
        "length": closed + stroke * if random.chance(0.1) { 0.0 } else { random.part() },
        "speed": if random.chance(0.3) { 0.0 } else { random.within(-0.2, 0.2) },
    });
    json["coupling"] = json!({ "mode": random.pick(&["preview", "preview", "follow", "delayed"]) });
    if random.chance(0.3) {
        json["accumulator"] = json!({
            "volume": random.decades(1e-5, 1e-2), "precharge_pressure": random.decades(1e6, 2e7),
            "polytropic_exponent": random.within(1.0, 1.6),
        });
        let full = random.within(1e7, 2e7);
        json["pump"] = json!({
            "max_flow": random.decades(1e-5, 1e-3), "full_pressure": full, "max_pressure": full * random.within(1.01,
                1.3),
        });
    }
    mechanism::solver(random, &mut json);
    if let Some(solver) = json["solver"].as_object_mut() {
        solver.retain(|key, _| ["tolerance", "max_steps"].contains(&key.as_str()));
    }
    let h = random.decades(1e-4, 2e-2);
    json["experiment"] = json!({ "stop_time": 1.0, "step_size": h });
    let force = random.decades(1e2, 2e4);
    Definition { file: "hydraulics.json", text: json.to_string(), force, torque: 0.0, h }
}

/// A random landing gear driven by a circuit; the definition may be rejected.
pub fn gear(random: &mut Random) -> Definition {
    let (mut json, force, torque, _) = mechanism::gear(random);
    let own: Value = serde_json::from_str(CIRCUIT).unwrap_or_default();
    let mut hydraulics = own["actuators"]["actuator"]["hydraulics"].clone();
    circuit(random, &mut hydraulics);
    json["actuators"]["actuator"]["hydraulics"] = hydraulics;
    if let Some(actuator) = json["actuators"]["actuator"].as_object_mut() {
        actuator.remove("efficiency");
        actuator.remove("force");
    }
    if random.chance(0.7) {
        json["start"]["speed"] = json!(random.within(-0.5, 0.5));
    }
    mechanism::solver(random, &mut json);
    if let Some(solver) = json["solver"].as_object_mut() {
        // Without tables such a scene takes minutes.
        solver.remove("tables");
    }
    let h = random.decades(1e-4, 2e-2);
    Definition { file: "mechanism.json", text: json.to_string(), force: 0.2 * force, torque: 0.2 * torque, h }
}
