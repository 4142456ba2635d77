//! The libraries that came with an installed program, in the folders that they have in FMUs of FMI 2.0.
//!
//! In: a platform's folder. Out: the library's file, or which there are instead. `dist` writes them.

use crate::archive::BINARIES;
use crate::binary;
use crate::library::served::SharedLibrary;
use anyhow::{Result, bail};
use std::fs;
use std::path::{Path, PathBuf};

/// A library for the platform of this folder, in the installation in `root`.
///
/// # Errors
/// It did not come with the program.
pub fn path(root: &Path, library: &SharedLibrary, folder: &str) -> Result<PathBuf> {
    let path = root.join(binary::path(folder, library.installed).unwrap_or_default());
    if path.is_file() {
        return Ok(path);
    }
    let entries = fs::read_dir(root.join(BINARIES)).into_iter().flatten().flatten();
    let mut others: Vec<_> = entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    others.sort();
    bail!(
        "the library for {folder} is not part of this program, which contains libraries for: {}; install a wheel with \
         this library (`cargo fmu dist --platforms` builds one), or give a library with --binary {folder}=PATH",
        if others.is_empty() { "none".to_owned() } else { others.join(" and ") }
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::library::served::MECHANISMS;

    #[test]
    fn a_library_that_is_not_there_is_named_with_those_that_are() {
        let root = std::env::temp_dir().join(format!("linkage-fmu prebuilt {}", std::process::id()));
        let message = path(&root, &MECHANISMS, "win64").unwrap_err().to_string();
        assert!(
            message.contains("which contains libraries for: none") && message.contains("--binary win64=PATH"),
            "{message}"
        );
        let library = root.join("binaries").join("linux64").join("linkage_fmu.so");
        fs::create_dir_all(library.parent().unwrap()).unwrap();
        fs::write(&library, b"").unwrap();
        assert_eq!(path(&root, &MECHANISMS, "linux64").unwrap(), library);
        assert!(path(&root, &MECHANISMS, "win64").unwrap_err().to_string().contains("libraries for: linux64;"));
        fs::remove_dir_all(&root).unwrap();
    }
}
