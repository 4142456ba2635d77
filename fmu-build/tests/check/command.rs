//! The output of the command as text and as JSON, for files, folders and FMUs.

use crate::support::{Folder, checked, slider_crank, with};
use fmu_build::archive::{self, Entry};
use fmu_build::check::{self, Arguments};
use fmu_build::workspace::Workspace;
use serde_json::{Value, json};

#[test]
fn the_printed_finding_shows_file_line_text_and_remedy() {
    let text = with("/gravity/up_angle", json!(90));
    let all = checked(&text);
    let printed = check::findings(&all);
    let [line, column] = all.findings[0].position;
    assert!(printed.contains(&format!("m.json:{line}:{column}")), "{printed}");
    assert!(
        printed.contains("\"up_angle\": 90") && printed.contains("^^") && printed.contains("help: if you mean 90"),
        "{printed}"
    );
    assert!(check::summary(&all).starts_with("m.json: M: 0 errors, 1 warning"), "{}", check::summary(&all));
}

/// A file, a folder and an FMU, with and without warnings.
#[test]
fn files_folders_and_fmus_are_checked() {
    let folder = Folder::new("check");
    let odd = with("/gravity/up_angle", json!(90));
    folder.write("resources/mechanism.json", &odd);
    folder.write("good.json", slider_crank().to_string());
    folder.write("bad.json", with("/start/body", json!("none")));
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
}

#[test]
fn the_json_for_programs_has_places_facts_and_counts() {
    let output = check::json(&[checked(&with("/gravity/up_angle", json!(90)))]);
    let one = &output[0];
    assert_eq!((&one["errors"], &one["warnings"], &one["name"]), (&json!(0), &json!(1), &json!("M")));
    let finding = &one["findings"][0];
    assert_eq!((&finding["severity"], &finding["path"]), (&json!("warning"), &json!("gravity.up_angle")));
    assert!(finding["line"].as_u64().unwrap() > 1 && finding["remedy"].as_str().unwrap().contains("degrees"));
    let mass = one["facts"].as_array().unwrap().iter().find(|fact| fact["topic"] == "Mass").unwrap();
    assert_eq!(mass["quantities"][0], json!({ "name": "total", "value": 3.0, "unit": "kg" }));
}

/// Unreadable paths have a separate object. Nothing is packed unless all definitions are valid.
#[test]
fn a_path_that_cannot_be_read_does_not_hide_the_others() {
    use std::process::Command;
    let folder = Folder::new("check-paths");
    folder.write("good.json", slider_crank().to_string());
    folder.write("bad.json", with("/guess/gude", json!(1)));
    folder.write("near/Mechanism.json", "{}");
    let run = |arguments: &[&str]| {
        let out = Command::new(env!("CARGO_BIN_EXE_fmu-build")).args(arguments).current_dir(&*folder).output().unwrap();
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
}
