//! `cargo fmu sweep`: rows are those of `cargo fmu simulate` to the bit, the same whatever the threads and however often the
//! study was ended; failures are rows; memory does not grow.
#![allow(clippy::unwrap_used)]

use fmu_build::simulate;
use fmu_build::sweep::{self, Arguments};
use fmu_build::workspace::Workspace;
use serde_json::{Value, json};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Duration;
use std::{env, fs, process, thread};

/// A folder that is removed with all that is in it.
struct Folder(PathBuf);

impl Folder {
    fn new(test: &str) -> Self {
        let path = env::temp_dir().join(format!("fmu-build-sweep-{}-{test}", process::id()));
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    /// A study of the landing gear with these sections besides.
    fn study(&self, name: &str, mut study: Value) -> PathBuf {
        let gear = Workspace::locate().descriptions().join("LandingGearRetraction");
        study.as_object_mut().unwrap().entry("mechanism").or_insert(json!(gear));
        let path = self.0.join(name);
        fs::write(&path, study.to_string()).unwrap();
        path
    }

    /// Make the study; its rows.
    fn rows(&self, study: Value) -> Rows {
        let study = self.study("study.json", study);
        let out = self.0.join("out");
        let _ = fs::remove_dir_all(&out);
        sweep(&study, &out, 2).unwrap();
        Rows::read(&out.join("runs.csv"))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn sweep(study: &Path, out: &Path, threads: u16) -> anyhow::Result<simulate::Outcome> {
    let (study, out) = (study.to_path_buf(), Some(out.to_path_buf()));
    let arguments = Arguments { study, out, csv: true, threads: Some(threads), ..Default::default() };
    sweep::run(&Workspace::locate(), &arguments)
}

/// The message of a study that is refused.
fn refusal(folder: &Folder, study: Value) -> String {
    println!("{study}");
    let study = folder.study("wrong.json", study);
    let message = format!("{:#}", sweep(&study, &folder.0.join("refused"), 1).unwrap_err());
    assert!(!message.contains('\n'), "{message}");
    message
}

/// A table.
struct Rows {
    names: HashMap<String, usize>,
    rows: Vec<Vec<String>>,
}

impl Rows {
    fn read(path: &Path) -> Self {
        let mut reader = csv::Reader::from_path(path).unwrap();
        let names = reader.headers().unwrap().iter().map(String::from).zip(0..).collect();
        let rows = reader.records().map(|row| row.unwrap().iter().map(String::from).collect()).collect();
        Self { names, rows }
    }

    fn text(&self, row: usize, name: &str) -> &str {
        &self.rows[row][self.names[name]]
    }

    fn number(&self, row: usize, name: &str) -> f64 {
        self.text(row, name).parse().unwrap()
    }

    fn column(&self, name: &str) -> Vec<f64> {
        (0..self.rows.len()).map(|row| self.number(row, name)).collect()
    }
}

/// The rows of `cargo fmu simulate` with these start values.
fn simulated(folder: &Folder, values: &[String], stop: f64, interval: f64, inputs: Option<PathBuf>) -> Rows {
    let file = folder.0.join("simulated.csv");
    let arguments = simulate::Arguments {
        path: Workspace::locate().descriptions().join("LandingGearRetraction"),
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

/// Inputs and parameters that change from run to run, without order, so that each run follows a different one.
#[test]
fn rows_are_those_of_simulate_to_the_bit() {
    let folder = Folder::new("bits");
    let names = ["actuator.force", "load_factor", "crank.mass", "crank.start_angle", "friction.enabled"];
    let points = [
        (30e3, 3.0, 13.689, 0.8, false),
        (29e3, 1.0, 13.689, 0.8, true),
        (29e3, 1.0, 20.0, 0.7, false),
        (31e3, 2.0, 20.0, 0.7, true),
        (30e3, 3.0, 13.689, 0.8, false),
    ];
    let lines =
        points.map(|(force, load, mass, angle, friction)| format!("{force},{load},{mass},{angle},{friction}\n"));
    fs::write(folder.0.join("points.csv"), names.join(",") + "\n" + &lines.concat()).unwrap();
    // FMPy sets the slope after a corner if its time stands twice, and not at the first time.
    fs::write(folder.0.join("air.csv"), "time,airspeed\n-1,0\n0,0\n0,0\n0.05,80\n0.05,80\n0.14,60\n").unwrap();
    let rows = folder.rows(json!({
        "points": "points.csv",
        "start_values": { "uplock.engage": true },
        "scenario": { "stop_time": 0.14, "output_interval": 0.01, "input_file": "air.csv" },
        "responses": {
            "angle": { "final": "crank.angle" }, "drift": { "final": "energy.drift" }, "up": { "final": "retracted" },
            "peak": { "maximum": "joint1.force" }, "least": { "minimum": "joint2.force_x" },
            "work": { "integral": "actuator.required_force" }, "rms": { "root_mean_square": "joint3.force" },
            "course": { "course": "wheel.y", "times": [0, 0.05, 0.14] }, "met": { "event": "retracted" },
        },
    }));
    assert_eq!(rows.rows.len(), points.len());
    for (row, (force, load, mass, angle, friction)) in points.iter().enumerate() {
        let values = [
            format!("actuator.force={force}"),
            format!("load_factor={load}"),
            format!("crank.mass={mass}"),
            format!("crank.start_angle={angle}"),
            format!("friction.enabled={friction}"),
            "uplock.engage=true".to_owned(),
        ];
        let run = simulated(&folder, &values, 0.14, 0.01, Some(folder.0.join("air.csv")));
        let (last, times) = (run.rows.len() - 1, run.column("time"));
        let same = |name: &str, expected: f64| {
            let own = rows.number(row, name);
            assert!(own.to_bits() == expected.to_bits(), "run {row}, {name}: {own:?}, simulated {expected:?}");
        };
        assert_eq!(rows.number(row, "actuator.force"), *force);
        assert_eq!((rows.text(row, "failed"), rows.text(row, "message")), ("0", ""));
        same("angle", run.number(last, "crank.angle"));
        same("drift", run.number(last, "energy.drift"));
        same("up", run.number(last, "retracted"));
        let force = run.column("joint1.force");
        let peak = (0..=last).rev().max_by(|a, b| force[*a].total_cmp(&force[*b])).unwrap();
        same("peak", force[peak]);
        same("peak.time", times[peak]);
        same("least", run.column("joint2.force_x").into_iter().fold(f64::INFINITY, f64::min));
        let trapezoids =
            |y: &[f64]| (0..last).fold(0.0, |sum, k| sum + 0.5 * (y[k] + y[k + 1]) * (times[k + 1] - times[k]));
        same("work", trapezoids(&run.column("actuator.required_force")));
        let squares: Vec<f64> = run.column("joint3.force").iter().map(|force| force * force).collect();
        same("rms", (trapezoids(&squares) / times[last]).sqrt());
        for (name, k) in [("course@0", 0), ("course@0.05", 5), ("course@0.14", last)] {
            same(name, run.number(k, "wheel.y"));
        }
        let met = run.number(last, "upstop.impact_time");
        same("met", if met < 0.0 { f64::NAN } else { met });
    }
    assert!(rows.column("met").iter().any(|time| !time.is_nan()));
}

#[test]
fn a_run_ends_at_its_event() {
    let folder = Folder::new("event");
    let rows = folder.rows(json!({
        "factors": { "upstop.restitution": { "values": [0, 0.5, 0.9] }, "actuator.force": { "values": [-20000, 30000, 34000] } },
        "scenario": { "stop_time": 0.5, "stop_at": "retracted" },
        "responses": {
            "met": { "event": "retracted" }, "down": { "event": "extended" }, "count": { "final": "upstop.impact_count" },
            "angle": { "final": "crank.angle" }, "up": { "final": "retracted" }, "blow": { "final": "upstop.impact_impulse" },
        },
    }));
    for row in 0..9 {
        let force = rows.number(row, "actuator.force");
        if force < 25e3 {
            // The actuator is too weak.
            assert_eq!(rows.text(row, "message"), "retracted did not come true within 0.5 s");
            assert!(rows.number(row, "met").is_nan() && rows.number(row, "up") == 0.0);
            continue;
        }
        // The first impact, found by steps that have one impact at most.
        let values = [
            format!("actuator.force={force}"),
            format!("upstop.restitution={}", rows.number(row, "upstop.restitution")),
        ];
        let run = simulated(&folder, &values, 0.5, 1e-4, None);
        let first = run.column("upstop.impact_count").iter().position(|count| *count > 0.0).unwrap();
        let expected = run.number(first, "upstop.impact_time");
        let met = rows.number(row, "met");
        assert!((met - expected).abs() < 1e-9, "{row}: {met} {expected}");
        assert_eq!(rows.number(row, "count"), 1.0);
        // A stop that gives speed back is left at once: within rounding of the impact either value is right.
        assert!(rows.number(row, "upstop.restitution") > 0.0 || rows.number(row, "up") == 1.0);
        assert!((rows.number(row, "angle") + 1.3).abs() < 1e-12 && rows.number(row, "blow") > 0.0);
        assert!(rows.number(row, "down").is_nan());
        assert_eq!((rows.text(row, "failed"), rows.text(row, "message")), ("0", ""));
    }
}

/// With ramps the slopes are set: the result does not depend on the communication instants.
#[test]
fn a_ramp_is_followed_within_a_step() {
    let folder = Folder::new("ramp");
    let study = |interval: Option<f64>| {
        let mut scenario = json!({
            "stop_time": 0.5, "stop_at": "retracted", "inputs": { "actuator.force": [[0, 0], [0.05, 30000]], "load_factor": 1 }
        });
        if let Some(interval) = interval {
            scenario["output_interval"] = json!(interval);
        }
        json!({ "scenario": scenario, "responses": { "met": { "event": "retracted" } } })
    };
    let [few, many] = [None, Some(1e-3)].map(|interval| folder.rows(study(interval)).number(0, "met"));
    assert!((few - many).abs() < 1e-8 && few > 0.05, "{few} {many}");
}

#[test]
fn a_failed_run_is_a_row() {
    let folder = Folder::new("failures");
    let rows = folder.rows(json!({
        "factors": {
            "crank.length": { "values": [0.1755, -1, 0.9, 0.1755] }, "solver.max_steps": { "values": [100_000, 3] },
            "solver.method": { "values": ["reduced", "rigid"] },
        },
        "scenario": { "stop_time": 0.1 },
        "responses": { "angle": { "final": "crank.angle" }, "met": { "event": "retracted" } },
    }));
    let expected = ["", "solver.method = \"rigid\"", "step at 0 s: ", "solver.method = \"rigid\""];
    let unreachable = ["initialisation at 0 s", expected[1], "initialisation at 0 s", expected[1]];
    let expected = expected.into_iter().chain(["crank.length"; 4]).chain(unreachable).chain(expected);
    for (row, said) in expected.enumerate() {
        let (message, failed) = (rows.text(row, "message"), rows.text(row, "failed"));
        println!("{message}");
        let is_whole = failed == "0" && message.is_empty() && rows.number(row, "angle") < 0.8;
        let is_failed = failed == "1" && message.contains(said) && rows.number(row, "angle").is_nan();
        assert!(if said.is_empty() { is_whole } else { is_failed }, "{row}: {failed} {message}");
    }
    // A run after failures is what it is alone.
    assert_eq!(rows.text(0, "angle"), rows.text(12, "angle"));
}

#[test]
fn what_is_wrong_is_said_in_one_line() {
    let folder = Folder::new("refusals");
    fs::write(folder.0.join("points.csv"), "crank.mass,crank.mass\n1,2\n").unwrap();
    fs::write(folder.0.join("words.csv"), "crank.mass\n1,5\n").unwrap();
    let final_angle = json!({ "r": { "final": "crank.angle" } });
    let with = |key: &str, value: Value| json!({ key: value, "responses": final_angle.clone() });
    let response = |value: Value| json!({ "responses": { "r": value } });
    for (study, said) in [
        (with("mechanism", json!("no/such")), "mechanism: "),
        (with("factors", json!({ "crank.mas": { "values": [1] } })), "factors.crank.mas: no variable is called"),
        (with("factors", json!({ "crank.angle": { "values": [1] } })), "a factor is a parameter or an input"),
        (with("factors", json!({ "crank.mass": {} })), "state exactly one of values, range, uniform and normal"),
        (with("factors", json!({ "crank.mass": { "range": [1, 2] } })), "factors.crank.mass.steps: is missing"),
        (with("factors", json!({ "crank.mass": { "values": [] } })), "factors.crank.mass.values: is empty"),
        (
            with("factors", json!({ "crank.mass": { "values": [true] } })),
            "values[0]: crank.mass is a Real; true is none",
        ),
        (with("factors", json!({ "crank.mass": { "uniform": [1, 2] } })), "sampling: is missing"),
        (
            with("factors", json!({ "crank.mass": { "normal": { "mean": 1, "standard_deviation": 0 } } })),
            "standard_deviation = 0: must be",
        ),
        (with("sampling", json!({ "method": "sobol", "count": 4 })), "sampling: no factor has a distribution"),
        (with("points", json!("none.csv")), "points: "),
        (with("points", json!("points.csv")), "crank.mass stands twice"),
        (with("points", json!("words.csv")), "line: 2"),
        (with("scenario", json!({ "stop_time": 0 })), "scenario.stop_time = 0.0: must be finite and > 0 s"),
        (with("scenario", json!({ "output_interval": 1e-12 })), "scenario.output_interval = 1e-12: must be"),
        (with("scenario", json!({ "stop_at": "upstop.enabled" })), "those of this mechanism are retracted, extended"),
        (
            with("scenario", json!({ "inputs": { "actuator.force": [[1, 0], [0, 1]] } })),
            "the time goes back from 1 to 0 s",
        ),
        (with("scenario", json!({ "inputs": { "crank.mass": [[0, 1]] } })), "scenario.inputs.crank.mass: is no input"),
        (with("start_values", json!({ "crank.mass": -1 })), "start value of crank.mass"),
        (
            with("start_values", json!({ "friction.enabled": 1 })),
            "start_values.friction.enabled = 1: must be a Boolean",
        ),
        (response(json!({ "maximum": "joint1.force" })), "state their distance, scenario.output_interval"),
        (response(json!({ "event": "crank.angle" })), "an event is told by the flag of a stop"),
        (response(json!({ "final": "crank.angle", "minimum": "crank.angle" })), "state exactly one of"),
        (response(json!({ "course": "crank.angle" })), "a course has times"),
        (response(json!({ "course": "crank.angle", "times": [9] })), "the instant 9 s is after the end of the run"),
        (response(json!({ "final": "solver.method" })), "solver.method is a text"),
        (
            json!({ "responses": { "run": { "final": "crank.angle" } } }),
            "two columns of the results are called \"run\"",
        ),
    ] {
        let message = refusal(&folder, study);
        assert!(message.contains(said), "{said}\n{message}");
    }
    let twice = json!({
        "factors": { "crank.mass": { "values": [1] } }, "start_values": { "crank.mass": 2 }, "responses": final_angle
    });
    assert!(refusal(&folder, twice).contains("factors.crank.mass: is set by start_values"));
}

/// A study of so many runs of the gear.
fn many(folder: &Folder, name: &str, runs: u32) -> PathBuf {
    folder.study(
        name,
        json!({
            "factors": { "actuator.force": { "uniform": [28e3, 40e3] }, "load_factor": { "uniform": [1, 3] } },
            "sampling": { "method": "sobol", "count": runs },
            "scenario": { "stop_time": 0.3, "stop_at": "retracted" },
            "responses": { "met": { "event": "retracted" } },
        }),
    )
}

fn start(study: &Path, out: &Path, options: &[&str]) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_fmu-build"));
    command.arg("sweep").arg(study).arg("--out").arg(out).args(options);
    command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
}

#[test]
fn rows_do_not_depend_on_the_threads() {
    let folder = Folder::new("threads");
    let study = many(&folder, "study.json", 3000);
    let all = [1, 2, 7].map(|threads| {
        let out = folder.0.join(threads.to_string());
        sweep(&study, &out, threads).unwrap();
        ["runs.csv", "runs.parquet"].map(|name| fs::read(out.join(name)).unwrap())
    });
    assert!(all[0] == all[1] && all[0] == all[2]);
    assert!(!folder.0.join("1/runs.journal").exists());
    // What is complete is left as it is.
    assert!(start(&study, &folder.0.join("1"), &["--resume"]).wait().unwrap().success());
}

/// Ended in the middle, by the user and by force, as often as the study allows: what results is the same to the byte.
#[cfg(unix)]
#[test]
fn a_study_that_was_ended_is_resumed() {
    let folder = Folder::new("resume");
    let study = many(&folder, "study.json", 60_000);
    let (whole, parts) = (folder.0.join("whole"), folder.0.join("parts"));
    assert!(start(&study, &whole, &["--csv"]).wait().unwrap().success());
    let size = || fs::metadata(parts.join("runs.journal")).map_or(0, |file| file.len());
    let (mut ended, mut options) = (0, vec!["--csv"]);
    for signal in ["-INT", "-KILL", "-INT", "-KILL"] {
        let before = size();
        let mut child = start(&study, &parts, &options);
        options = vec!["--csv", "--resume"];
        // Until some chunks more are done.
        while size() < before + 100_000 && child.try_wait().unwrap().is_none() {
            thread::sleep(Duration::from_millis(1));
        }
        if child.try_wait().unwrap().is_some() {
            break;
        }
        Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
        let status = child.wait().unwrap();
        if status.success() {
            break;
        }
        if signal == "-INT" {
            assert_eq!(status.code(), Some(130));
        }
        ended += 1;
        assert!(!parts.join("runs.parquet").exists());
        assert!(
            !start(&study, &parts, &[]).wait().unwrap().success(),
            "an unfinished study is not begun anew in silence"
        );
    }
    assert!(ended >= 2, "the study was ended {ended} times only");
    assert!(start(&study, &parts, &options).wait().unwrap().success());
    for name in ["runs.csv", "runs.parquet", "study.json"] {
        assert!(fs::read(whole.join(name)).unwrap() == fs::read(parts.join(name)).unwrap(), "{name}");
    }
    assert_eq!(Rows::read(&parts.join("runs.csv")).rows.len(), 60_000);
}

/// Largest memory of a study [kB].
#[cfg(target_os = "linux")]
fn memory(study: &Path, out: &Path) -> u64 {
    let mut child = start(study, out, &["--csv", "--threads", "2"]);
    let mut most = 0;
    let status = loop {
        let told = fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
        let peak = told.lines().find_map(|line| line.strip_prefix("VmHWM:")?.split_whitespace().next());
        most = most.max(peak.map_or(0, |peak| peak.parse().unwrap()));
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        thread::sleep(Duration::from_millis(1));
    };
    assert!(status.success());
    most
}

#[cfg(target_os = "linux")]
#[test]
#[ignore = "makes 1e6 runs: cargo test --release -p fmu-build --test sweep -- --ignored --nocapture"]
fn memory_does_not_grow_with_the_runs() {
    let folder = Folder::new("memory");
    let [few, lots] = [100_000, 1_000_000].map(|runs| {
        let study = many(&folder, "study.json", runs);
        memory(&study, &folder.0.join(runs.to_string()))
    });
    println!("{few} kB for 1e5 runs, {lots} kB for 1e6");
    // Rows of 1e6 runs take 40 MB. Chunks that wait to be kept may be a few more or fewer.
    assert!(lots < few + 4_000, "{few} kB for 1e5 runs, {lots} kB for 1e6");
}

/// Path of the studies of docs/studies.md.
fn examples() -> Vec<PathBuf> {
    let folder = Workspace::locate().root().join("docs/studies");
    let mut all: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    all.retain(|path| path.extension().is_some_and(|extension| extension == "json"));
    all.sort();
    assert_eq!(all.len(), 3);
    all
}

/// The studies of docs/studies.md, with few values of each factor and few samples.
#[test]
fn the_worked_studies_run() {
    let folder = Folder::new("examples");
    for path in examples() {
        let mut study: Value = serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
        for factor in study["factors"].as_object_mut().unwrap().values_mut() {
            if factor.get("steps").is_some() {
                factor["steps"] = json!(3);
            }
        }
        if study.get("sampling").is_some() {
            study["sampling"]["count"] = json!(20);
        }
        for file in ["mechanism", "points"] {
            if let Some(name) = study[file].as_str() {
                study[file] = json!(path.parent().unwrap().join(name));
            }
        }
        let rows = folder.rows(study);
        assert!(rows.rows.len() >= 9, "{}", path.display());
        for row in 0..rows.rows.len() {
            assert_eq!((rows.text(row, "failed"), rows.text(row, "message")), ("0", ""), "{}, {row}", path.display());
            let time = rows.number(row, "retraction");
            assert!(time > 0.05 && time < 0.6, "{}, {row}: {time}", path.display());
        }
        let times = rows.column("retraction");
        assert!(times.iter().any(|time| *time != times[0]));
    }
}

/// The whole examples of the format page, and every kind of key, under the schema; what the reader refuses is refused.
#[test]
fn the_schema_agrees_with_the_reader() {
    let descriptions = Workspace::locate().descriptions();
    let schema = fs::read_to_string(descriptions.join("study.schema.json")).unwrap();
    let validator = jsonschema::draft202012::new(&serde_json::from_str(&schema).unwrap()).unwrap();
    let page = fs::read_to_string(descriptions.join("STUDY.md")).unwrap();
    let stated = page.split("```json").nth(1).and_then(|text| text.split("```").next()).unwrap();
    let texts = examples().into_iter().map(|path| fs::read_to_string(path).unwrap()).chain([stated.to_owned()]);
    for text in texts {
        let study: Value = serde_json::from_str(&text).unwrap();
        assert!(validator.is_valid(&study), "{text}");
        for key in ["mechanism", "responses"] {
            let mut without = study.clone();
            without.as_object_mut().unwrap().remove(key);
            assert!(!validator.is_valid(&without), "{key}");
        }
    }
    let folder = Folder::new("schema");
    let response = json!({ "r": { "final": "crank.angle" } });
    for (study, is_right) in [
        (json!({ "responses": response }), true),
        (json!({ "responses": {} }), false),
        (json!({ "responses": response, "factor": {} }), false),
        (json!({ "responses": response, "factors": { "crank.mass": { "values": [1], "range": [1, 2] } } }), false),
        (json!({ "responses": response, "factors": { "crank.mass": { "range": [1, 2] } } }), false),
        (json!({ "responses": response, "factors": { "crank.mass": { "range": [1, 2], "steps": 2 } } }), true),
        (json!({ "responses": response, "factors": { "crank.mass": { "values": [1], "steps": 2 } } }), false),
        (json!({ "responses": response, "scenario": { "inputs": { "crank.torque": [] } } }), false),
        (json!({ "responses": response, "scenario": { "inputs": { "crank.torque": [[0, 1]] } } }), true),
        (json!({ "responses": response, "scenario": { "stop_time": -1 } }), false),
        (json!({ "responses": { "r": { "final": "crank.angle", "maximum": "crank.angle" } } }), false),
        (json!({ "responses": { "r": { "final": "crank.angle", "times": [0] } } }), false),
        (json!({ "responses": { "r": { "course": "crank.angle", "times": [0, 0.1] } } }), true),
    ] {
        let path = folder.study("study.json", study.clone());
        let stated: Value = serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
        assert_eq!(validator.is_valid(&stated), is_right, "the schema: {study}");
        let done = sweep(&path, &folder.0.join("out"), 1);
        assert_eq!(done.is_ok(), is_right, "the reader: {study}: {done:?}");
    }
}
