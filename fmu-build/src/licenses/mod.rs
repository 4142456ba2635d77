//! The licences that every FMU has under `documentation/licenses` (FMI 2.0.5, 2.3).
//!
//! Out: files of an FMU. A user's own files of these names take their places.

use crate::archive::Entry;

/// Folder in an FMU.
const FOLDER: &str = "documentation/licenses";
/// Each file with its content; the first is the one where a reader begins.
const FILES: [(&str, &str); 3] = [
    ("license.txt", include_str!("license.txt")),
    ("LICENSE-MIT", include_str!("../../../LICENSE-MIT")),
    ("LICENSE-APACHE", include_str!("../../../LICENSE-APACHE")),
];

/// The files.
pub fn entries() -> impl Iterator<Item = Entry> {
    FILES.iter().map(|(name, content)| Entry { name: format!("{FOLDER}/{name}"), content: content.as_bytes().to_vec() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::process::Command;

    /// The list of packages is that of the lock file.
    #[test]
    fn each_package_in_the_library_is_named() {
        let mut cargo = Command::new(env!("CARGO"));
        cargo.args(["tree", "--package", "linkage-fmu", "--edges", "normal,no-proc-macro", "--prefix", "none"]);
        let output = cargo.args(["--offline", "--format", "{p}"]).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let text = String::from_utf8(output.stdout).unwrap();
        let names: Vec<&str> = text.lines().filter_map(|line| line.split(' ').next()).collect();
        assert!(names.contains(&"nalgebra"), "{names:?}");
        let words: Vec<&str> = FILES[0].1.split([' ', ',', '\n', ':']).collect();
        for name in names.into_iter().filter(|name| *name != "linkage-fmu" && !name.is_empty()) {
            assert!(words.contains(&name), "license.txt does not name {name}; add it under its licence");
        }
    }
}
