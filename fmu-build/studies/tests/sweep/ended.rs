//! Rows do not depend on threads, interruptions and memory.

use crate::support::{Folder, Rows, sweep};
use serde_json::{Value, json};
use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::Duration;

/// A study of the gear with this number of runs.
fn many(folder: &Folder, name: &str, runs: u32) -> PathBuf {
    of(folder, name, runs, json!({ "met": { "event": "retracted" } }))
}

/// [`many`] with these responses.
fn of(folder: &Folder, name: &str, runs: u32, responses: Value) -> PathBuf {
    folder.study(
        name,
        json!({
            "factors": { "actuator.force": { "uniform": [28e3, 40e3] }, "load_factor": { "uniform": [1, 3] } },
            "sampling": { "method": "sobol", "count": runs },
            "scenario": { "stop_time": 0.3, "stop_at": "retracted" },
            "responses": responses,
        }),
    )
}

fn start(study: &Path, out: &Path, options: &[&str]) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_fmu-studies"));
    command.arg("sweep").arg(study).arg("--out").arg(out).args(options);
    command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
}

/// The warning is printed before the first run is stored. Then the study is ended.
#[test]
fn a_study_of_too_many_runs_gives_a_warning_before_its_first_run() {
    let folder = Folder::new("many");
    let of = |steps: u64| json!({ "range": [1, 2], "steps": steps });
    let study = json!({
        "factors": { "load_factor": of(100_000), "crank.mass": of(20_000) }, "scenario": { "stop_time": 0.001 },
        "responses": { "angle": { "final": "crank.angle" } }
    });
    let study = folder.study("study.json", study);
    let mut command = Command::new(env!("CARGO_BIN_EXE_fmu-studies"));
    command.arg("sweep").arg(study).arg("--out").arg(folder.0.join("out"));
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let mut line = String::new();
    BufReader::new(child.stderr.take().unwrap()).read_line(&mut line).unwrap();
    child.kill().unwrap();
    child.wait().unwrap();
    // Two factors, a response and the number of the run.
    assert!(line.starts_with("warning: 2000000000 runs: the results will need about 64 GB on the disk"), "{line}");
    assert!(line.contains("the study will need about") && line.contains("on one core"), "{line}");
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
    // Complete results stay unchanged.
    assert!(start(&study, &folder.0.join("1"), &["--resume"]).wait().unwrap().success());
}

/// A study that the user or a signal ends several times gives identical bytes.
#[cfg(unix)]
#[test]
fn a_study_that_was_ended_is_resumed() {
    let folder = Folder::new("resume");
    // An instant in between makes steps necessary, which last longer than the energy integral.
    let course = json!({ "course": "crank.angle", "times": [0.01] });
    let responses = json!({ "met": { "event": "retracted" }, "course": course });
    let study = of(&folder, "study.json", 30_000, responses);
    let (whole, parts) = (folder.0.join("whole"), folder.0.join("parts"));
    assert!(start(&study, &whole, &["--csv"]).wait().unwrap().success());
    let size = || fs::metadata(parts.join("runs.journal")).map_or(0, |file| file.len());
    let (mut ended, mut options) = (0, vec!["--csv"]);
    for signal in ["-INT", "-KILL", "-INT", "-KILL"] {
        let before = size();
        let mut child = start(&study, &parts, &options);
        options = vec!["--csv", "--resume"];
        // Until some more chunks are completed.
        while size() < before + 50_000 && child.try_wait().unwrap().is_none() {
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
    assert_eq!(Rows::read(&parts.join("runs.csv")).rows.len(), 30_000);
}

/// If the disk is full, first for the journal and then for the results, completed chunks remain.
#[cfg(unix)]
#[test]
fn a_full_disk_loses_nothing() {
    let folder = Folder::new("a full disk");
    let study = many(&folder, "study.json", 60_000);
    let (whole, parts) = (folder.0.join("whole"), folder.0.join("parts"));
    assert!(start(&study, &whole, &["--csv"]).wait().unwrap().success());
    // Blocks of 512 or 1024 bytes, depending on the shell. The journal has 1.4 MB, the table 2.2 MB, its CSV file 4 MB.
    for (blocks, options, said) in [
        (900, &["--csv"][..], "runs.journal: the file cannot be written; free disk space; then continue with --resume"),
        (3300, &["--csv", "--resume"][..], "all runs are complete; --resume writes the results"),
    ] {
        let limited = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$@\"");
        let mut command = Command::new("sh");
        command.args(["-c", &limited, "sh", env!("CARGO_BIN_EXE_fmu-studies"), "sweep"]).arg(&study).arg("--out");
        let ended = command.arg(&parts).args(options).output().unwrap();
        let message = String::from_utf8_lossy(&ended.stderr).into_owned();
        assert!(!ended.status.success() && message.contains(said), "{message}");
        let names: Vec<_> = fs::read_dir(&parts).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        assert_eq!(names, ["runs.journal"]);
    }
    assert!(start(&study, &parts, &["--csv", "--resume"]).wait().unwrap().success());
    for name in ["runs.csv", "runs.parquet", "study.json"] {
        assert!(fs::read(whole.join(name)).unwrap() == fs::read(parts.join(name)).unwrap(), "{name}");
    }
}

#[cfg(target_os = "linux")]
#[test]
#[ignore = "makes 1e6 runs: cargo test --release -p fmu-studies --test sweep -- --ignored --nocapture"]
fn memory_does_not_grow_with_the_runs() {
    let folder = Folder::new("memory");
    let [few, lots] = [100_000, 1_000_000].map(|runs| {
        let study = many(&folder, "study.json", runs);
        crate::memory::largest(start(&study, &folder.0.join(runs.to_string()), &["--csv", "--threads", "2"]))
    });
    println!("{few} kB for 1e5 runs, {lots} kB for 1e6");
    // Rows of 1e6 runs need 40 MB. The number of chunks that wait to be stored varies slightly.
    assert!(lots < few + 4_000, "{few} kB for 1e5 runs, {lots} kB for 1e6");
}
