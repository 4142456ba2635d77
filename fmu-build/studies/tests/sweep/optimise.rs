//! A fault of an optimisation is reported in one line before any run.

use crate::support::Folder;
use fmu_build::workspace::Workspace;
use fmu_studies::sweep::optimise::{self, Arguments};
use serde_json::{Value, json};

/// The message of a rejected optimisation.
fn refusal(folder: &Folder, study: Value) -> String {
    println!("{study}");
    let (study, out) = (folder.study("wrong.json", study), Some(folder.0.join("refused")));
    let arguments = Arguments { study, out, ..Default::default() };
    let message = format!("{:#}", optimise::run(&Workspace::locate(), &arguments, None).unwrap_err());
    assert!(!message.contains('\n') && !folder.0.join("refused").exists(), "{message}");
    message
}

#[test]
fn wrong_optimisations_are_rejected_in_one_line() {
    let folder = Folder::new("optimise-refusals");
    let whole = json!({
        "factors": { "crank.mass": { "bounds": [10, 20] } },
        "responses": { "r": { "final": "crank.angle" } },
        "objective": { "minimise": "r" },
    });
    let with = |key: &str, value: Value| {
        let mut study = whole.clone();
        match value {
            Value::Null => study.as_object_mut().unwrap().remove(key),
            value => study.as_object_mut().unwrap().insert(key.to_owned(), value),
        };
        study
    };
    for (study, said) in [
        (with("objective", json!(null)), "objective: this key is missing"),
        (with("objective", json!({ "minimise": "q" })), "objective.minimise: there is no response \"q\""),
        (with("constraints", json!({ "q": { "at_most": 1 } })), "constraints.q: there is no response"),
        (with("factors", json!({})), "factors: an optimisation needs at least one factor"),
        (
            with("factors", json!({ "crank.mass": { "values": [1] } })),
            "give only the key `bounds`, as [least, largest]",
        ),
        (with("factors", json!({ "crank.mass": { "bounds": [1, 2], "steps": 2 } })), "give only the key `bounds`"),
        (with("factors", json!({ "crank.mass": { "bounds": [2, 2] } })), "factors.crank.mass.bounds = [2.0, 2.0]"),
        (with("factors", json!({ "friction.enabled": { "bounds": [0, 1] } })), "friction.enabled is not a number"),
        (
            with("start_values", json!({ "crank.mass": 12 })),
            "factors.crank.mass: this factor is also set by `start_values`",
        ),
        (with("search", json!({ "evaluations": 3 })), "search.evaluations = 3: must be from 20 to 1000000"),
        (with("points", json!("points.csv")), "the keys `points` and `sampling` belong to `sweep`"),
        (
            with("responses", json!({ "r": { "final": "crank.angle" }, "violation": { "final": "crank.angle" } })),
            "responses.violation",
        ),
    ] {
        let message = refusal(&folder, study);
        assert!(message.contains(said), "{said}\n{message}");
    }
}
