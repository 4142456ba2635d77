//! The libraries of an installed program: an archive per platform, named by its folder in FMUs of FMI 2.0, with all
//! libraries for it.
//!
//! In: the folder of a platform. Out: the library, or a list of the available platforms. `dist` writes the archives.
//! The module must not know how an archive is read: the host of the program provides the function.

use crate::archive::BINARIES;
use crate::binary;
use crate::library::served::SharedLibrary;
use anyhow::{Context, Result, bail};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// End of the name of an archive.
pub const EXTENSION: &str = ".tar.xz";

/// Function that reads a file from an archive.
type Read = fn(&Path, &str) -> Result<Vec<u8>>;
static READ: OnceLock<Read> = OnceLock::new();

/// State the function that reads archives.
pub fn set_reader(read: Read) {
    let _ = READ.set(read);
}

/// The archive for the platform of this folder, in the installation in `root`.
///
/// # Errors
/// The installation does not contain the archive.
pub fn archive(root: &Path, folder: &str) -> Result<PathBuf> {
    let path = root.join(BINARIES).join(format!("{folder}{EXTENSION}"));
    if path.is_file() {
        return Ok(path);
    }
    let entries = fs::read_dir(root.join(BINARIES)).into_iter().flatten().flatten();
    let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
    let mut others: Vec<_> = names.filter_map(|name| name.strip_suffix(EXTENSION).map(str::to_owned)).collect();
    others.sort();
    bail!(
        "the library for {folder} is not part of this program, which contains libraries for: {}; install a wheel with \
         this library (`cargo fmu dist` builds one), or give a library with --binary {folder}=PATH",
        if others.is_empty() { "none".to_owned() } else { others.join(" and ") }
    )
}

/// A library for the platform of this folder, in the installation in `root`.
///
/// # Errors
/// The installation does not contain the library, or the archive cannot be read.
pub fn content(root: &Path, library: &SharedLibrary, folder: &str) -> Result<Vec<u8>> {
    let path = archive(root, folder)?;
    let name = name(library, folder);
    let read = READ.get().context("internal fault: nothing reads the archives of libraries")?;
    read(&path, &name).with_context(|| format!("{}: {name} cannot be read", path.display()))
}

/// Name of a library in the archive for the platform of this folder.
pub fn name(library: &SharedLibrary, folder: &str) -> String {
    let path = binary::path(folder, library.installed).unwrap_or_default();
    path.rsplit('/').next().unwrap_or_default().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::library::served::MECHANISMS;

    #[test]
    fn a_library_that_is_not_there_is_named_with_those_that_are() {
        let root = std::env::temp_dir().join(format!("linkage-fmu prebuilt {}", std::process::id()));
        let message = archive(&root, "win64").unwrap_err().to_string();
        assert!(
            message.contains("which contains libraries for: none") && message.contains("--binary win64=PATH"),
            "{message}"
        );
        let packed = root.join("binaries").join("linux64.tar.xz");
        fs::create_dir_all(packed.parent().unwrap()).unwrap();
        fs::write(&packed, b"").unwrap();
        assert_eq!(archive(&root, "linux64").unwrap(), packed);
        assert!(archive(&root, "win64").unwrap_err().to_string().contains("libraries for: linux64;"));
        fs::remove_dir_all(&root).unwrap();
    }

    #[test]
    fn a_library_has_the_extension_of_its_platform() {
        assert_eq!(name(&MECHANISMS, "win64"), "linkage_fmu.dll");
    }
}
