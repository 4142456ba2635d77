//! A fault of a study is reported in one line.

use crate::support::{Folder, sweep};
use fmu_build::workspace::Workspace;
use serde_json::{Value, json};
use std::fs;

/// The message of a rejected study.
fn refusal(folder: &Folder, study: Value) -> String {
    println!("{study}");
    let study = folder.study("wrong.json", study);
    let message = format!("{:#}", sweep(&study, &folder.0.join("refused"), 1).unwrap_err());
    assert!(!message.contains('\n'), "{message}");
    message
}

#[test]
fn wrong_studies_are_rejected_in_one_line() {
    let folder = Folder::new("refusals");
    fs::write(folder.0.join("points.csv"), "crank.mass,crank.mass\n1,2\n").unwrap();
    fs::write(folder.0.join("words.csv"), "crank.mass\n1,5\n").unwrap();
    let final_angle = json!({ "r": { "final": "crank.angle" } });
    let with = |key: &str, value: Value| json!({ key: value, "responses": final_angle.clone() });
    let response = |value: Value| json!({ "responses": { "r": value } });
    for (study, said) in [
        (with("mechanism", json!("no/such")), "mechanism: "),
        (with("factors", json!({ "crank.mas": { "values": [1] } })), "factors.crank.mas: there is no variable"),
        (
            with("factors", json!({ "crank.angle": { "values": [1] } })),
            "crank.angle is an output; a factor must be a parameter or an input; similar parameters and inputs are",
        ),
        (
            with("factors", json!({ "crank.mass": {} })),
            "give exactly one of the keys `values`, `range`, `uniform` and `normal`",
        ),
        (
            with("factors", json!({ "crank.mass": { "range": [1, 2] } })),
            "factors.crank.mass.steps: this key is missing",
        ),
        (with("factors", json!({ "crank.mass": { "values": [] } })), "factors.crank.mass.values: the list is empty"),
        (
            with("factors", json!({ "crank.mass": { "values": [true] } })),
            "values[0]: crank.mass must be a number, not true",
        ),
        (with("factors", json!({ "crank.mass": { "values": ["3 m"] } })), "values[0]: the unit of crank.mass is kg"),
        (with("factors", json!({ "crank.mass": { "uniform": [1, 2] } })), "sampling: this key is missing"),
        (
            with("factors", json!({ "crank.mass": { "normal": { "mean": 1, "standard_deviation": 0 } } })),
            "standard_deviation = 0: must be",
        ),
        (
            with(
                "factors",
                json!({ "crank.mass": { "range": [1, 2], "steps": 1_000_000 }, "crank.length": { "range": [1, 2],
                    "steps": 1_000_000 } }),
            ),
            "1000000000000 runs, but at most 100000000000 are allowed",
        ),
        (with("sampling", json!({ "method": "sobol", "count": 4 })), "sampling: no factor has a distribution"),
        (with("points", json!("none.csv")), "points: "),
        (with("parameters_file", json!("none.ssv")), "parameters_file: "),
        (with("parameters_file", json!("points.csv")), "parameters_file: "),
        (with("start_values", json!({ "crank.mass": "3 m" })), "start_values.crank.mass: the unit of crank.mass is kg"),
        (with("points", json!("points.csv")), "crank.mass occurs twice"),
        (with("points", json!("words.csv")), "line: 2"),
        (with("scenario", json!({ "stop_time": 0 })), "scenario.stop_time = 0.0: must be finite and > 0 s"),
        (with("scenario", json!({ "output_interval": 1e-12 })), "scenario.output_interval = 1e-12: must be"),
        (with("scenario", json!({ "stop_at": "upstop" })), "the flag variable of this stop is retracted; write"),
        (
            with("scenario", json!({ "stop_at": "upstop.enabled" })),
            "the flag variables of this mechanism are retracted, extended",
        ),
        (
            with("scenario", json!({ "inputs": { "actuator.force": [[1, 0], [0, 1]] } })),
            "the time decreases from 1 to 0 s",
        ),
        (
            with("scenario", json!({ "inputs": { "crank.mass": [[0, 1]] } })),
            "scenario.inputs.crank.mass: only an input of the type Real or Boolean can change over time",
        ),
        (
            with("scenario", json!({ "inputs": { "crank.mass": 20 } })),
            "scenario.inputs.crank.mass: this variable is not an input but a parameter; set this variable in",
        ),
        (
            with("scenario", json!({ "inputs": { "actuator.force": [[0, 0], [0.1, 1], [0.1, 2], [0.1, 3]] } })),
            "scenario.inputs.actuator.force: three points are at 0.1 s, but a jump has two",
        ),
        (with("start_values", json!({ "crank.mass": -1 })), "start values: crank.mass = -1"),
        (
            with("start_values", json!({ "friction.enabled": 1 })),
            "start_values.friction.enabled: friction.enabled must be true or false, not 1",
        ),
        (response(json!({ "maximum": "joint1.force" })), "add the key `scenario.output_interval`"),
        (response(json!({ "event": "crank.angle" })), "an event must be the flag variable of a stop"),
        (response(json!({ "event": "upstop" })), "the flag variable of this stop is retracted; write retracted"),
        (with("scenario", json!({ "stop_at": "up" })), "the flag variables of this mechanism are retracted, extended"),
        (response(json!({ "final": "crank.angle", "minimum": "crank.angle" })), "give exactly one of"),
        (response(json!({ "course": "crank.angle" })), "give the keys `course` and `times` together"),
        (response(json!({ "course": "crank.angle", "times": [] })), "responses.r.times: the list is empty"),
        (
            response(json!({ "course": "crank.angle", "times": [0.1, 0.2, 0.1] })),
            "responses.r.times[2] = 0.1 s occurs twice",
        ),
        (response(json!({ "course": "crank.angle", "times": [9] })), "the instant 9 s is after the end of the run"),
        (response(json!({ "final": "solver.method" })), "solver.method is a text"),
        (with("factors", json!({ "crank.mass": { "bounds": [1, 2] } })), "belongs to `optimise`"),
        (with("objective", json!({ "minimise": "r" })), "belong to `cargo fmu optimise`"),
        (
            json!({ "responses": { "run": { "final": "crank.angle" } } }),
            "two columns of the results would have the name \"run\"",
        ),
    ] {
        let message = refusal(&folder, study);
        assert!(message.contains(said), "{said}\n{message}");
    }
    let family = Workspace::locate().descriptions().join("FourBarFamily");
    let of_family = |key: &str, value: Value| {
        json!({ "mechanism": family, key: value, "responses": { "r": {
        "final": "tip.x" } } })
    };
    fs::write(folder.0.join("lengths.csv"), "size,crank.length\n0.3,0.1\n").unwrap();
    let calculated = "crank.length is calculated from \"size / 3\" and cannot be set: set size";
    for study in [
        of_family("factors", json!({ "crank.length": { "range": [0.1, 0.2], "steps": 2 } })),
        of_family("start_values", json!({ "crank.length": 0.1 })),
        of_family("points", json!("lengths.csv")),
    ] {
        let message = refusal(&folder, study);
        assert!(message.contains(calculated), "{message}");
    }
    let twice = json!({
        "factors": { "crank.mass": { "values": [1] } }, "start_values": { "crank.mass": 2 }, "responses": final_angle
    });
    assert!(refusal(&folder, twice).contains("factors.crank.mass: this factor is also set by `start_values`"));
}
