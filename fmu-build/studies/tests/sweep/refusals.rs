//! A fault of a study is reported in one line.

use crate::support::{Folder, assert_rejected, sweep};
use fmu_build::workspace::Workspace;
use serde_json::{Value, json};

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
    folder.write("points.csv", "crank.mass,crank.mass\n1,2\n");
    folder.write("words.csv", "crank.mass\n1,5\n");
    folder.write("lengths.csv", "size,crank.length\n0.3,0.1\n");
    let gear = json!({ "responses": { "r": { "final": "crank.angle" } } });
    assert_rejected("studies", &gear, |study| refusal(&folder, study));
    let family = Workspace::locate().descriptions().join("FourBarFamily");
    let family = json!({ "mechanism": family, "responses": { "r": { "final": "tip.x" } } });
    assert_rejected("studies of a family", &family, |study| refusal(&folder, study));
}
