//! Paths of package sources in built files. These paths contain the user name of the builder.
//!
//! In: a library, the folder of the sources. Out: the library without these paths, and a variable with which Cargo
//! omits the folder, for builds that share nothing with the running program.

use anyhow::{Context, Result};
use std::env;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// Replacement of the folder with the sources of packages in a library.
const PLACE: &[u8] = b"crates";
/// Target with separate flags in `.cargo/config.toml`, and the variable that adds flags.
const SEPARATE: (&str, &str) = ("x86_64-unknown-linux-gnu", "CARGO_TARGET_X86_64_UNKNOWN_LINUX_GNU_RUSTFLAGS");
/// First bytes of a library of macOS for one 64-bit processor.
const MACH_O: [u8; 4] = [0xcf, 0xfa, 0xed, 0xfe];

/// Folder in which Cargo stores the sources of packages, according to Cargo's own rule.
///
/// # Errors
/// There is no home folder.
pub fn folder() -> Result<PathBuf> {
    let home = env::var_os("CARGO_HOME").filter(|home| !home.is_empty()).map(PathBuf::from);
    let home = home.or_else(|| Some(dirs::home_dir()?.join(".cargo"))).context("there is no home folder")?;
    Ok(home.join("registry").join("src"))
}

/// Variable for Cargo with which Rust omits the folder from all files compiled for a target. Cargo adds its flags to
/// the flags of `.cargo/config.toml`, where this target has separate flags.
///
/// # Errors
/// There is no home folder.
pub fn variable(triple: &str) -> Result<(String, OsString)> {
    let mut flag = OsString::from("--remap-path-prefix=");
    flag.push(folder()?);
    flag.push("=crates");
    let name = if triple == SEPARATE.0 { SEPARATE.1 } else { "CARGO_BUILD_RUSTFLAGS" };
    Ok((name.to_owned(), flag))
}

/// Replace the path of the folder with the sources by `crates/////` in the messages of panics, because the path
/// contains the user name of the builder. Rust can omit the path with `--remap-path-prefix`, but would then compile the
/// engine separately for the program and the library. The length of the text remains, because the program finds the
/// text by its length. A library of macOS is signed and stays unchanged.
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
    fn a_library_does_not_reveal_who_built_it() {
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
