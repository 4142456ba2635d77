//! A fault of an optimisation is reported in one line before any run.

use crate::support::{Folder, assert_rejected};
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
    assert_rejected("optimisations", &whole, |study| refusal(&folder, study));
}
