//! Mechanisms with calculated parameters: the factors of a run are set together.

use crate::support::{Folder, simulated_of};
use serde_json::json;
use std::fs;

/// A pendulum whose length is the difference of two parameters.
const PENDULUM: &str = r#"{
    "name": "Pendulum", "parameters": { "inner": 0.1, "outer": 0.3 }, "gravity": { "acceleration": 9.81,
        "up_angle": 1.5 },
    "bodies": { "ground": {}, "bar": { "length": "outer - inner", "mass": 1, "shape": "uniform_rod" } },
    "joints": { "pivot": { "type": "revolute", "first": "ground.origin", "second": "bar.origin" } },
    "start": { "body": "bar", "angle": 0.5 }, "guess": { "bar": 0.5 }, "experiment": { "stop_time": 0.5,
        "step_size": 0.01 }
}"#;

/// Set one after the other, 0.4 and 0.6 may give a negative length in between, depending on the previous run.
#[test]
fn a_row_does_not_depend_on_the_run_before_through_an_expression() {
    let folder = Folder::new("families");
    let pendulum = folder.0.join("mechanism.json");
    fs::write(&pendulum, PENDULUM).unwrap();
    let points = [(0.1, 0.3), (0.4, 0.6), (0.1, 0.3), (0.4, 0.3), (0.4, 0.6), (0.9, 1.4)];
    let lines: String = points.iter().map(|(inner, outer)| format!("{inner},{outer}\n")).collect();
    folder.write("points.csv", "inner,outer\n".to_owned() + &lines);
    let rows = folder.rows(json!({
        "mechanism": pendulum, "points": "points.csv", "scenario": { "stop_time": 0.5 },
        "responses": { "angle": { "final": "bar.angle" }, "length": { "final": "bar.length" } },
    }));
    for (row, (inner, outer)) in points.into_iter().enumerate() {
        let (failed, message) = (rows.text(row, "failed"), rows.text(row, "message"));
        if outer < inner {
            assert!(failed == "1" && message.contains("inner = 0.4, outer = 0.3: bar.length"), "{message}");
            continue;
        }
        assert_eq!((failed, message), ("0", ""), "{row}");
        assert_eq!(rows.number(row, "length"), outer - inner);
        let values = [format!("outer={outer}"), format!("inner={inner}")];
        let run = simulated_of(&folder, &pendulum, &values, (0.5, 0.5), None);
        let expected = *run.column("bar.angle").last().unwrap();
        assert_eq!(rows.number(row, "angle").to_bits(), expected.to_bits(), "{row}");
    }
}

/// Common start values of all runs are set together too.
#[test]
fn start_values_are_set_together() {
    let folder = Folder::new("shared");
    let pendulum = folder.0.join("mechanism.json");
    fs::write(&pendulum, PENDULUM).unwrap();
    let rows = folder.rows(json!({
        "mechanism": pendulum, "start_values": { "inner": 0.4, "outer": 0.6 },
        "responses": { "length": { "final": "bar.length" } },
    }));
    assert_eq!(rows.number(0, "length"), 0.6 - 0.4);
}
