//! Unusable resource folders and mechanisms.

use crate::host::{Arguments, Folder, RESOURCES, c, mechanism};
use std::fs::{self, File};
use std::path::Path;
use std::time::{Duration, Instant};

/// Longest time that an error may take.
const PATIENCE: Duration = Duration::from_secs(5);

/// The message for a location: one line, in time.
fn refusal(location: &str) -> String {
    let start = Instant::now();
    let message = Arguments::at(location).refused().unwrap_or_else(|| panic!("accepted: {location}"));
    assert!(start.elapsed() < PATIENCE, "{location}: {:?}", start.elapsed());
    assert!(message.starts_with("fmi2Instantiate: ") && !message.contains('\n'), "{message}");
    message
}

#[test]
fn locations_that_lead_nowhere() {
    for (location, expected) in [
        ("file:///no/such/folder", "'/no/such/folder/mechanism.json'"),
        ("/no/such/folder", "'/no/such/folder/mechanism.json'"),
        ("no/such/folder", "'no/such/folder/mechanism.json'"),
        ("file:///no/such/f%C3%B6lder", "'/no/such/földer/mechanism.json'"),
        ("file:///tmp/a%00b", "cannot read"),
        ("file:///no/a%0Ab", "'/no/a\\nb/mechanism.json'"),
        ("file:///tmp/%FF%FE", "cannot read"),
        ("file:", "'mechanism.json'"),
        ("file:///", "'/mechanism.json'"),
        ("file://", "names another computer"),
        ("file://server/share", "names another computer"),
        ("https://example.org/resources", "the scheme 'https'"),
        ("data:,{}", "the scheme 'data'"),
        (&"x".repeat(1 << 20), "cannot read"),
        (&format!("file:///{}", "../".repeat(10_000)), "cannot read"),
        (&format!("file:///{}", "%".repeat(100_000)), "cannot read"),
    ] {
        let message = refusal(location);
        assert!(message.contains(expected), "{}", &message[..message.len().min(300)]);
    }
}

#[test]
fn the_file_is_named_in_place_of_the_folder() {
    assert!(refusal(&format!("{RESOURCES}/mechanism.json")).contains("mechanism.json/mechanism.json"));
}

#[test]
fn no_file() {
    let folder = Folder::new("not a file");
    let location = folder.location();
    let file = folder.0.join("mechanism.json");
    assert!(refusal(location).contains("No such file"));
    fs::create_dir(&file).unwrap();
    assert!(refusal(location).contains("this is not a file"));
    fs::remove_dir(&file).unwrap();
    std::os::unix::fs::symlink(&file, &file).unwrap();
    assert!(refusal(location).contains("cannot read"));
}

#[test]
#[cfg(unix)]
fn a_pipe_or_a_device_does_not_hold_up_the_host() {
    let folder = Folder::new("pipe");
    let file = folder.0.join("mechanism.json");
    let path = c(file.to_str().unwrap());
    // SAFETY: a string.
    assert_eq!(unsafe { libc::mkfifo(path.as_ptr(), 0o600) }, 0);
    assert!(refusal(folder.location()).contains("this is not a file"));
    fs::remove_file(&file).unwrap();
    std::os::unix::fs::symlink("/dev/zero", &file).unwrap();
    assert!(refusal(folder.location()).contains("this is not a file"));
}

#[test]
#[cfg(unix)]
fn a_file_that_may_not_be_read() {
    use std::os::unix::fs::PermissionsExt;
    let folder = Folder::new("unreadable");
    let file = folder.0.join("mechanism.json");
    fs::write(&file, mechanism()).unwrap();
    fs::set_permissions(&file, fs::Permissions::from_mode(0o000)).unwrap();
    // The superuser may read everything.
    if File::open(&file).is_err() {
        assert!(refusal(folder.location()).contains("ermission"));
    }
    // Memory at the address 0, which no process can read.
    let unreadable = Path::new("/proc/self/mem");
    if unreadable.exists() {
        fs::remove_file(&file).unwrap();
        std::os::unix::fs::symlink(unreadable, &file).unwrap();
        assert!(refusal(folder.location()).contains("cannot read"));
    }
}

#[test]
fn a_huge_file_is_rejected_because_of_its_size() {
    let folder = Folder::new("huge");
    let location = folder.location();
    let file = folder.0.join("mechanism.json");
    // A sparse file needs no space on the disk.
    File::create(&file).unwrap().set_len(100_000_000).unwrap();
    let message = refusal(location);
    for expected in ["mechanism.json'", "100000000 bytes", "16777216"] {
        assert!(message.contains(expected), "{message}");
    }
    // A file up to the limit is read. Additional blanks are allowed.
    let mut text = mechanism();
    text.extend(std::iter::repeat_n(' ', (16 << 20) - text.len()));
    fs::write(&file, &text).unwrap();
    assert_eq!(Arguments::at(location).refused(), None);
    text.push(' ');
    fs::write(&file, text).unwrap();
    assert!(refusal(location).contains("16777217 bytes"));
}

#[test]
fn a_file_without_a_size_is_read_up_to_the_limit() {
    // Files of /proc have no size.
    let endless = Path::new("/proc/self/maps");
    if endless.exists() {
        let folder = Folder::new("proc");
        std::os::unix::fs::symlink(endless, folder.0.join("mechanism.json")).unwrap();
        assert!(refusal(folder.location()).contains("not a valid mechanism"));
    }
}

#[test]
fn text_that_is_none() {
    let folder = Folder::new("text");
    let location = folder.location();
    let file = folder.0.join("mechanism.json");
    let nested =
        |open: &str, close: &str| format!("{}{}", open.repeat(1_000_000), close.repeat(1_000_000)).into_bytes();
    let truncated = &mechanism().into_bytes()[..700];
    for (content, expected) in [
        (vec![], "not a valid mechanism"),
        (vec![0; 1000], "not a valid mechanism"),
        (vec![0xff; 1000], "UTF-8"),
        (mechanism().encode_utf16().flat_map(u16::to_le_bytes).collect(), "mechanism.json"),
        (nested("[", "]"), "more than 128 brackets"),
        (nested("{\"bodies\":", "}"), "more than 128 brackets"),
        (truncated.to_vec(), "line"),
    ] {
        fs::write(&file, &content).unwrap();
        let message = refusal(location);
        assert!(message.contains(expected), "{}", &message[..message.len().min(300)]);
    }
}
