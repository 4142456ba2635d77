//! Folders and disks: packed, rejected and omitted files, and many programs that write one FMU.
#![cfg(unix)]
#![allow(clippy::unwrap_used)]

#[path = "../../tests/support/folder.rs"]
mod folder;

use fmu_build::archive::{self, Entry};
use fmu_build::source::Source;
use fmu_build::workspace::Workspace;
use folder::Folder;
use std::fs;
use std::os::unix::fs::symlink;
use std::os::unix::net::UnixListener;
use std::path::Path;
use std::process::{Child, Command};
use std::time::{Duration, Instant};
use std::{env, process, thread};

/// Environment variable that turns a test into a program that writes an FMU to this path repeatedly.
const WRITES: &str = "FMU_BUILD_TEST_WRITES";

impl Folder {
    fn names(&self) -> Vec<String> {
        let mut names: Vec<_> =
            fs::read_dir(&self.0).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }
}

/// A folder with a definition, a page and a file in a subfolder.
fn model(test: &str) -> Folder {
    let folder = Folder::new(test);
    let put = |name: &str, text: &str| {
        let path = folder.0.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    };
    put("resources/mechanism.json", "{}");
    put("documentation/index.html", "<p>");
    put("extra/vendor/data.csv", "1");
    folder
}

fn found(folder: &Path) -> anyhow::Result<Source> {
    Source::find(&Workspace::locate(), folder)
}

/// Names of packed and omitted files, or the error message, which is one line.
fn packed(folder: &Folder) -> Result<(Vec<String>, Vec<String>), String> {
    let companions = found(&folder.0).and_then(|source| {
        source.text()?;
        source.companions()
    });
    match companions {
        Ok(all) => Ok((all.entries.into_iter().map(|entry| entry.name).collect(), all.left_out)),
        Err(error) => {
            let message = format!("{error:#}");
            assert!(!message.contains('\n'), "{message}");
            Err(message)
        }
    }
}

/// The error message contains the path relative to the folder, and the kind of object.
fn assert_refused(folder: &Folder, path: &str, words: &str) {
    let message = packed(folder).unwrap_err();
    assert!(message.contains(path) && message.contains(words), "{message}");
}

#[test]
fn every_file_is_packed_or_reported_as_omitted() {
    let folder = model("all");
    for name in ["extra/.git", "extra/vendor/.hidden", "notes.txt", "resources/table.csv", "README.md"] {
        fs::write(folder.0.join(name), "").unwrap();
    }
    fs::create_dir(folder.0.join("sources")).unwrap();
    symlink("/", folder.0.join("root")).unwrap();
    let (entries, left_out) = packed(&folder).unwrap();
    assert_eq!(entries, ["documentation/index.html", "extra/vendor/data.csv"]);
    let expected = ["extra/.git", "extra/vendor/.hidden", "notes.txt", "resources/table.csv", "root", "sources"];
    assert_eq!(left_out, expected);
}

/// A link may lead to any file of the system, to a parent folder, or nowhere.
#[test]
fn symbolic_links_are_rejected_with_their_name() {
    for (k, target) in ["/etc/passwd", "/", "..", "data.csv", "nowhere"].into_iter().enumerate() {
        let folder = model(&format!("link{k}"));
        symlink(target, folder.0.join("extra/vendor/link")).unwrap();
        let before = Instant::now();
        assert_refused(&folder, "extra/vendor/link: ", "this is a symbolic link; replace the entry by a regular file");
        assert!(before.elapsed() < Duration::from_secs(5));
    }
}

#[test]
fn links_instead_of_a_folder_or_file_are_rejected() {
    for name in ["documentation", "extra", "licenses", "model.png", "terminalsAndIcons"] {
        let folder = model(&format!("whole-{name}"));
        let _ = fs::remove_dir_all(folder.0.join(name));
        symlink("/etc", folder.0.join(name)).unwrap();
        assert_refused(&folder, &format!("{name}: "), "this is a symbolic link");
    }
    let other = model("elsewhere");
    let folder = model("resources");
    fs::remove_dir_all(folder.0.join("resources")).unwrap();
    symlink(other.0.join("resources"), folder.0.join("resources")).unwrap();
    assert_refused(&folder, "resources: ", "this is a symbolic link");
    fs::remove_file(folder.0.join("resources")).unwrap();
    fs::create_dir(folder.0.join("resources")).unwrap();
    symlink(other.0.join("resources/mechanism.json"), folder.0.join("resources/mechanism.json")).unwrap();
    assert_refused(&folder, "resources/mechanism.json: ", "this is a symbolic link");
}

fn make_pipe(path: &Path) {
    assert!(Command::new("mkfifo").arg(path).status().unwrap().success());
}

#[test]
fn pipes_and_sockets_are_rejected_with_their_name() {
    let folder = model("pipe");
    make_pipe(&folder.0.join("documentation/pipe"));
    assert_refused(&folder, "documentation/pipe: ", "this is a pipe");
    let folder = model("socket");
    let _socket = UnixListener::bind(folder.0.join("extra/s")).unwrap();
    assert_refused(&folder, "extra/s: ", "this is a socket");
}

/// Reading a device could continue, and reading a pipe could wait, without end.
#[test]
fn a_definition_is_a_regular_file() {
    let message = found(Path::new("/dev/zero")).unwrap_err().to_string();
    assert!(message.starts_with("/dev/zero: this is not a regular file"), "{message}");
    let folder = model("definition");
    let definition = folder.0.join("resources/mechanism.json");
    fs::remove_file(&definition).unwrap();
    make_pipe(&definition);
    assert_refused(&folder, "resources/mechanism.json: ", "this is a pipe");
    assert!(found(&definition).unwrap_err().to_string().contains("this is not a regular file"));
    fs::remove_file(&definition).unwrap();
    // A sparse file of 1 TB that contains only zeros.
    fs::File::create(&definition).unwrap().set_len(1 << 40).unwrap();
    assert_refused(&folder, "resources/mechanism.json: ", "bytes, but at most 16777216");
}

#[test]
fn names_that_windows_cannot_unpack_are_rejected() {
    for name in ["CON", "nul.txt", "a:b", "a?", "trailing.", "trailing ", "line\nbreak", "back\\slash"] {
        let folder = model("windows");
        fs::write(folder.0.join("extra").join(name), "").unwrap();
        assert_refused(&folder, "extra/", "Windows cannot unpack this file");
    }
    let folder = model("deep");
    let mut path = folder.0.join("extra");
    (0..40).for_each(|_| path.push("0123456789"));
    fs::create_dir_all(&path).unwrap();
    fs::write(path.join("file"), "").unwrap();
    assert_refused(&folder, "extra/0123456789/", "characters, but Windows can unpack at most 240");
}

fn entry(name: &str, content: Vec<u8>) -> Entry {
    Entry { name: name.to_owned(), content }
}

/// 300 kB that can hardly be compressed.
fn entries(seed: u64) -> Vec<Entry> {
    let mut state = seed.wrapping_mul(2).wrapping_add(1);
    let noise = (0..300_000).map(|_| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 56) as u8
    });
    vec![entry("modelDescription.xml", b"<xml/>".to_vec()), entry("binaries/linux64/A.so", noise.collect())]
}

#[test]
fn names_that_differ_by_case_are_rejected_before_anything_is_written() {
    let folder = Folder::new("case");
    let path = folder.0.join("A.fmu");
    let error = archive::write(&path, vec![entry("extra/a", vec![]), entry("extra/A", vec![])]).unwrap_err();
    assert!(format!("{error:#}").contains("extra/A and extra/a: the names differ by case only"), "{error:#}");
    assert!(folder.names().is_empty());
}

/// Check that the FMU is complete and from one of the writers.
fn assert_whole(path: &Path, folder: &Folder) {
    let content = fs::read(path).unwrap();
    let own = folder.0.join("whole.fmu");
    let is_of = |seed| {
        archive::write(&own, entries(seed)).unwrap();
        fs::read(&own).unwrap() == content
    };
    assert!((0..8).any(is_of));
    fs::remove_file(own).unwrap();
}

#[test]
fn threads_write_one_fmu_at_the_same_time() {
    let folder = Folder::new("threads");
    let path = folder.0.join("A.fmu");
    thread::scope(|scope| {
        for seed in 0..8 {
            let path = &path;
            scope.spawn(move || (0..10).for_each(|_| archive::write(path, entries(seed)).unwrap()));
        }
    });
    assert_eq!(folder.names(), ["A.fmu"]);
    assert_whole(&path, &folder);
}

/// The program that [`writer`] starts. Without the variable the test does nothing.
#[test]
fn writes_an_fmu_over_and_over() {
    let Ok(arguments) = env::var(WRITES) else { return };
    let (seed, path) = arguments.split_once(' ').unwrap();
    let (seed, end) = (seed.parse().unwrap(), Instant::now() + Duration::from_secs(2));
    while Instant::now() < end {
        archive::write(Path::new(path), entries(seed)).unwrap();
    }
}

fn writer(seed: u64, path: &Path) -> Child {
    let mut command = Command::new(env::current_exe().unwrap());
    command.args(["--exact", "writes_an_fmu_over_and_over", "--quiet"]);
    command.env(WRITES, format!("{seed} {}", path.display())).stdout(process::Stdio::null()).spawn().unwrap()
}

/// Half of eight programs are killed while they write. The others succeed, and in the end only the FMU remains.
#[test]
fn programs_write_one_fmu_at_the_same_time_and_some_are_killed() {
    let folder = Folder::new("programs");
    let path = folder.0.join("A.fmu");
    let mut writers: Vec<Child> = (0..8).map(|seed| writer(seed, &path)).collect();
    thread::sleep(Duration::from_millis(700));
    for writer in &mut writers[..4] {
        writer.kill().unwrap();
        writer.wait().unwrap();
    }
    for writer in &mut writers[4..] {
        assert!(writer.wait().unwrap().success());
    }
    archive::write(&path, entries(0)).unwrap();
    assert_eq!(folder.names(), ["A.fmu"]);
    assert_whole(&path, &folder);
}

/// With a limit on file sizes, writing fails halfway like on a full disk: one message, and the old file remains.
#[test]
fn a_failed_write_keeps_the_previous_file() {
    let folder = Folder::new("bound");
    let path = folder.0.join("A.fmu");
    archive::write(&path, entries(1)).unwrap();
    let before = fs::read(&path).unwrap();
    // 64 blocks of 512 or 1024 bytes. The signal at the limit is ignored.
    let script = "ulimit -f 64; trap '' XFSZ; exec \"$0\" --exact writes_an_fmu_over_and_over --nocapture";
    let mut command = Command::new("sh");
    command.args(["-c", script]).arg(env::current_exe().unwrap()).env(WRITES, format!("2 {}", path.display()));
    let output = command.output().unwrap();
    assert!(!output.status.success());
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(message.matches("cannot be written; free disk space").count(), 1, "{message}");
    assert!(!message.contains("ZipWriter"), "{message}");
    assert_eq!(folder.names(), ["A.fmu"]);
    assert_eq!(fs::read(&path).unwrap(), before);
}
