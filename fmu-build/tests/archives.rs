//! The commands with FMUs of other programs, and with archives instead of a definition.
#![allow(clippy::unwrap_used)]

#[path = "../../tests/support/folder.rs"]
mod folder;

use folder::Folder;
use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::Command;
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

/// An FMU of another program with sources only. Its name contains an escape sequence that would colour a terminal.
const DESCRIPTION: &str = "<?xml version=\"1.0\"?><fmiModelDescription fmiVersion=\"2.0\" modelName=\"\u{1b}[31mBall\" \
    guid=\"{1}\" generationTool=\"Another\"><ModelExchange \
    modelIdentifier=\"ball\"/><ModelVariables/></fmiModelDescription>";

fn zip(path: &Path, entries: &[(&str, &str)]) {
    let mut zip = ZipWriter::new(fs::File::create(path).unwrap());
    for (name, content) in entries {
        zip.start_file(*name, SimpleFileOptions::default()).unwrap();
        zip.write_all(content.as_bytes()).unwrap();
    }
    zip.finish().unwrap();
}

/// Exit code, standard output and standard error.
fn run(words: &[&str], path: &Path) -> (i32, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_fmu-build")).args(words).arg(path).output().unwrap();
    let [printed, said] = [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
    (output.status.code().unwrap(), printed, said)
}

#[test]
fn archives_of_others_are_checked_and_named() {
    let folder = Folder::new("archives");
    let [sound, evil, system] = ["ball.fmu", "evil.fmu", "pair.ssp"].map(|name| folder.join(name));
    let description = ("modelDescription.xml", DESCRIPTION);
    zip(&sound, &[description, ("sources/ball.c", "int ball;")]);
    zip(&evil, &[description, ("../../evil.txt", "")]);
    zip(&system, &[("SystemStructure.ssd", "")]);
    let (code, printed, _) = run(&["validate"], &sound);
    assert!(
        code == 0 && printed.contains("another program built this FMU") && printed.contains("valid: 0 errors"),
        "{printed}"
    );
    let (code, printed, _) = run(&["info"], &sound);
    assert!(code == 0 && printed.contains("\\u{1b}[31mBall") && !printed.contains('\u{1b}'), "{printed}");
    let (code, printed, _) = run(&["validate"], &evil);
    assert!(code == 1 && printed.contains("leads out of the folder") && !printed.contains("Windows"), "{printed}");
    for (words, path, remedy) in
        [(&["package"][..], &sound, "this is a packed FMU"), (&["info"], &system, "a system of FMUs")]
    {
        let (code, _, said) = run(words, path);
        assert!(code == 1 && said.contains(remedy) && !said.contains("UTF-8"), "{words:?}: {said}");
    }
}

#[test]
fn a_study_is_another_programs_task() {
    for words in [&["simulate"][..], &["demo", "--gallery", "--out"]] {
        let (code, printed, said) = run(words, Path::new("crane.json"));
        let expected = "error: fmu-studies contains this command: run `cargo fmu`, or `cargo run --release --package \
                        fmu-studies --`\n";
        assert_eq!((code, &*printed, &*said), (1, "", expected));
    }
}
