//! Studies of the landing gear in separate folders, and their rows.

#[path = "../../../../tests/support/folder.rs"]
mod folder;

use fmu_build::workspace::Workspace;
use fmu_studies::simulate;
use fmu_studies::sweep::{self, Arguments};
pub use folder::Folder;
use serde_json::{Map, Value, json};
use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

impl Folder {
    /// A study of the landing gear with these additional sections.
    pub fn study(&self, name: &str, mut study: Value) -> PathBuf {
        let gear = Workspace::locate().descriptions().join("LandingGearRetraction");
        study.as_object_mut().unwrap().entry("mechanism").or_insert(json!(gear));
        self.write(name, study.to_string())
    }

    /// Make the runs of the study. Returns its rows.
    pub fn rows(&self, study: Value) -> Rows {
        let study = self.study("study.json", study);
        let out = self.0.join("out");
        let _ = fs::remove_dir_all(&out);
        sweep(&study, &out, 2).unwrap();
        Rows::read(&out.join("runs.csv"))
    }
}

/// Sections of a study, and the words of the message that rejects them.
type Refusal = (Map<String, Value>, String);

/// For each row of a group of `refusals.json`, the study with these sections, of which null removes one, is rejected.
pub fn assert_rejected(group: &str, whole: &Value, refusal: impl Fn(Value) -> String) {
    let mut rows: HashMap<String, Vec<Refusal>> = serde_json::from_str(include_str!("refusals.json")).unwrap();
    for (sections, said) in rows.remove(group).unwrap() {
        let mut study = whole.as_object().unwrap().clone();
        study.extend(sections);
        study.retain(|_, section| !section.is_null());
        let message = refusal(study.into());
        assert!(message.contains(&said), "{said}\n{message}");
    }
}

/// Make the runs of a study with this number of threads.
pub fn sweep(study: &Path, out: &Path, threads: u16) -> anyhow::Result<simulate::Outcome> {
    let (study, out) = (study.to_path_buf(), Some(out.to_path_buf()));
    let arguments = Arguments { study, out, csv: true, threads: Some(threads), ..Default::default() };
    sweep::run(&Workspace::locate(), &arguments, None)
}

/// A table.
pub struct Rows {
    pub names: HashMap<String, usize>,
    pub rows: Vec<Vec<String>>,
}

impl Rows {
    pub fn read(path: &Path) -> Self {
        let mut reader = csv::Reader::from_path(path).unwrap();
        let names = reader.headers().unwrap().iter().map(String::from).zip(0..).collect();
        let rows = reader.records().map(|row| row.unwrap().iter().map(String::from).collect()).collect();
        Self { names, rows }
    }

    pub fn text(&self, row: usize, name: &str) -> &str {
        &self.rows[row][self.names[name]]
    }

    pub fn number(&self, row: usize, name: &str) -> f64 {
        self.text(row, name).parse().unwrap()
    }

    pub fn column(&self, name: &str) -> Vec<f64> {
        (0..self.rows.len()).map(|row| self.number(row, name)).collect()
    }
}

/// The rows of `cargo fmu simulate` with these start values.
pub fn simulated(folder: &Folder, values: &[String], stop: f64, interval: f64, inputs: Option<PathBuf>) -> Rows {
    let gear = Workspace::locate().descriptions().join("LandingGearRetraction");
    simulated_of(folder, &gear, values, (stop, interval), inputs)
}

/// The rows of `cargo fmu simulate` of this mechanism.
pub fn simulated_of(
    folder: &Folder,
    mechanism: &Path,
    values: &[String],
    (stop, interval): (f64, f64),
    inputs: Option<PathBuf>,
) -> Rows {
    let file = folder.0.join("simulated.csv");
    let arguments = simulate::Arguments {
        path: mechanism.to_path_buf(),
        stop_time: Some(stop),
        output_interval: Some(interval),
        start_values: values.to_vec(),
        set_input_derivatives: inputs.is_some(),
        input_file: inputs,
        output_file: Some(file.clone()),
        ..Default::default()
    };
    simulate::run(&Workspace::locate(), &arguments).unwrap();
    Rows::read(&file)
}
