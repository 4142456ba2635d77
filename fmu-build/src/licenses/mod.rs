//! The licences that every FMU has under `documentation/licenses` (FMI 2.0.5, 2.3).
//!
//! Out: files of an FMU. A user's own files with these names replace them.

#[cfg(test)]
mod notices;

use crate::archive::Entry;

/// Folder in an FMU.
const FOLDER: &str = "documentation/licenses";
/// Each file with its content. The first file is the one to read first.
const FILES: [(&str, &str); 4] = [
    ("license.txt", include_str!("license.txt")),
    ("LICENSE-MIT", include_str!("../../../LICENSE-MIT")),
    ("LICENSE-APACHE", include_str!("../../../LICENSE-APACHE")),
    ("THIRD-PARTY.txt", include_str!("library.txt")),
];

/// The files.
pub fn entries() -> impl Iterator<Item = Entry> {
    FILES.iter().map(|(name, content)| Entry { name: format!("{FOLDER}/{name}"), content: content.as_bytes().to_vec() })
}
