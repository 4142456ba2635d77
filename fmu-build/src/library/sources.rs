//! Paths of packages' sources in what is built: they tell the name of who built it.
//!
//! In: a library, the folder of the sources. Out: the library without it; a variable with which Cargo leaves the folder
//! out, for builds that share nothing with the program that runs.

use anyhow::{Context, Result};
use std::env;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// What stands in a library for the folder with the sources of packages.
const PLACE: &[u8] = b"crates";
/// How a library of macOS for one 64-bit processor begins.
const MACH_O: [u8; 4] = [0xcf, 0xfa, 0xed, 0xfe];

/// Folder in which Cargo keeps the sources of packages, by Cargo's own rule.
///
/// # Errors
/// There is no home folder.
pub fn folder() -> Result<PathBuf> {
    let home = env::var_os("CARGO_HOME").filter(|home| !home.is_empty()).map(PathBuf::from);
    let home = home.or_else(|| Some(dirs::home_dir()?.join(".cargo"))).context("there is no home folder")?;
    Ok(home.join("registry").join("src"))
}

/// Variable for Cargo with which Rust leaves the folder out of all that it compiles.
///
/// # Errors
/// There is no home folder.
pub fn variable() -> Result<(String, OsString)> {
    let mut flag = OsString::from("--remap-path-prefix=");
    flag.push(folder()?);
    flag.push("=crates");
    Ok(("CARGO_BUILD_RUSTFLAGS".to_owned(), flag))
}

/// Write `crates/////` in place of the path of the folder with the sources, wherever messages of panics name this
/// folder: the path tells who built the library. Rust can leave the path out with `--remap-path-prefix`, but then
/// compiles the engine once for the program and once for the library. The length stays, as the text is found by its
/// length. A library of macOS is signed, and stays as it is.
pub fn leave_out(content: &mut [u8], folder: &Path) {
    let path = folder.as_os_str().as_encoded_bytes();
    if path.len() < PLACE.len() || content.starts_with(&MACH_O) {
        return;
    }
    let mut at = 0;
    while let Some(found) = content[at..].windows(path.len()).position(|bytes| bytes == path) {
        let named = &mut content[at + found..at + found + path.len()];
        named.fill(b'/');
        named[..PLACE.len()].copy_from_slice(PLACE);
        at += found + path.len();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_library_does_not_tell_who_built_it() {
        let mut content =
            b"\x7fELF at /home/a/.cargo/registry/src/index/b.rs and /home/a/.cargo/registry/src/c".to_vec();
        leave_out(&mut content, Path::new("/home/a/.cargo/registry/src"));
        let expected = format!("\x7fELF at crates{0}/index/b.rs and crates{0}/c", "/".repeat(21));
        assert_eq!(String::from_utf8(content).unwrap(), expected);
        let mut signed = [&MACH_O[..], b"/home/a"].concat();
        leave_out(&mut signed, Path::new("/home/a"));
        assert!(signed.ends_with(b"/home/a"));
    }
}
