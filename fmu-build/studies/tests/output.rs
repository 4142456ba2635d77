//! Every command that prints, with a closed pipe and with a full disk as its output.
#![allow(clippy::unwrap_used)]

#[path = "../../../tests/support/folder.rs"]
mod folder;

use fmu_build::workspace::Workspace;
use folder::Folder;
use std::fs;
use std::io::pipe;
use std::process::{Command, Output, Stdio};

const TABLE: &str = "type,x,y,angle,links,driven\nR,0,0,,ground a,1\nR,0,1,,a b,\nR,4,3,,b c,\nR,3,0,,ground c,\n";

/// The arguments of each command, which writes its files into this folder.
fn commands(folder: &str) -> Vec<Vec<String>> {
    let crank = Workspace::locate().descriptions().join("SliderCrank").display().to_string();
    let table = format!("{folder}/four_bar.csv");
    fs::write(&table, TABLE).unwrap();
    let page = format!("{folder}/page.html");
    [
        &["check", &crank][..],
        &["check", "--json", &crank],
        &["info", &crank],
        &["info", "--json", &crank],
        &["validate", &crank],
        &["view", &crank, "--out", &page],
        &["simulate", &crank, "--stop-time", "0.01"],
        &["linearise", &crank, "--held-by", "drive.torque"],
        &["import", &table],
        &["chain", "3"],
    ]
    .map(|words| words.iter().map(|word| (*word).to_owned()).collect())
    .to_vec()
}

fn run(words: &[String], stdout: Stdio, stderr: Stdio) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_fmu-studies"));
    command.args(words).stdout(stdout).stderr(stderr).spawn().unwrap().wait_with_output().unwrap()
}

/// If the file is the standard output, it contains only the file, for a pipe and for a file.
#[cfg(target_os = "linux")]
#[test]
fn a_file_is_written_to_standard_output_by_its_name() {
    let folder = Folder::new("stdout");
    let crank = Workspace::locate().descriptions().join("SliderCrank").display().to_string();
    let own = folder.join("own");
    for (words, option, [first, last]) in [
        (&["simulate", &crank, "--stop-time", "0.01"][..], "--output-file", ["\"time\",", "\n"]),
        (&["view", &crank, "--stop-time", "0.01"], "--out", ["<!", "</html>"]),
    ] {
        let command =
            |path: &str| -> Vec<String> { words.iter().chain([&option, &path]).map(|w| (*w).to_owned()).collect() };
        let expected = {
            assert!(run(&command(own.to_str().unwrap()), Stdio::null(), Stdio::null()).status.success());
            fs::read_to_string(&own).unwrap()
        };
        assert!(expected.starts_with(first) && expected.ends_with(last), "{words:?}: {expected}");
        for path in ["/dev/stdout", "/dev/fd/1"] {
            let output = run(&command(path), Stdio::piped(), Stdio::piped());
            let said = String::from_utf8_lossy(&output.stderr).into_owned();
            assert!(output.status.success() && said.contains(path), "{words:?} {path}: {said}");
            assert_eq!(String::from_utf8(output.stdout).unwrap(), expected, "{words:?} {path}");
        }
    }
}

#[test]
fn output_to_a_closed_pipe_or_a_full_disk_does_not_panic() {
    let folder = Folder::new("output");
    let closed = || {
        let (reader, writer) = pipe().unwrap();
        drop(reader);
        Stdio::from(writer)
    };
    for words in commands(folder.to_str().unwrap()) {
        // The task is completed also without a reader.
        let output = run(&words, closed(), Stdio::piped());
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success() && !said.contains("error:"), "{words:?}: {said}");
        assert!(run(&words, Stdio::null(), closed()).status.success(), "{words:?}");
        if cfg!(target_os = "linux") {
            let full = || Stdio::from(fs::OpenOptions::new().write(true).open("/dev/full").unwrap());
            let output = run(&words, full(), Stdio::piped());
            let said = String::from_utf8_lossy(&output.stderr).into_owned();
            let last = said.lines().last().unwrap_or_default();
            assert!(last.starts_with("error: standard output cannot be written: No space left"), "{words:?}: {said}");
            assert_eq!(output.status.code(), Some(1), "{words:?}");
            assert!(run(&words, Stdio::null(), full()).status.success(), "{words:?}");
        }
    }
}
