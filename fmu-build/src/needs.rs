//! Requirements of a library of an FMU on the machine that loads it: a version of glibc on Linux, other libraries on
//! Windows.
//!
//! In: the bytes of a library. Out: the newest version of glibc that it requires with the functions that require it, or
//! the libraries that are not part of Windows.

use anyhow::{Context, Result};
use object::elf::VER_FLG_WEAK;
use object::read::elf::ElfFile64;
use object::{Endianness, FileKind, Object};
use serde::Serialize;
use std::collections::BTreeSet;

/// Text before the number in the name of a version of glibc.
const GLIBC: &str = "GLIBC_";
/// Prefixes of libraries that compilers for Windows provide, but Windows does not.
const NOT_OF_WINDOWS: [&str; 3] = ["libgcc", "libwinpthread", "libstdc++"];

/// Requirements of a library.
#[derive(Debug, Default, PartialEq, Serialize)]
pub struct Needs {
    /// Oldest glibc with which the library loads, such as 2.17. None if it requires no version.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub glibc: Option<String>,
    /// Functions that require this version.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub functions: Vec<String>,
    /// Libraries that must be next to it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub libraries: Vec<String>,
}

impl Needs {
    /// Requirements of a library. Libraries of macOS have none here.
    ///
    /// # Errors
    /// The file is damaged.
    pub fn of(content: &[u8]) -> Result<Self> {
        match FileKind::parse(content)? {
            FileKind::Elf64 => of_linux(&ElfFile64::parse(content)?, content),
            FileKind::Pe32 | FileKind::Pe64 => of_windows(content),
            _ => Ok(Self::default()),
        }
    }

    /// The requirements as text. Empty if there are none.
    pub fn words(&self) -> String {
        let mut parts = Vec::new();
        if let Some(version) = &self.glibc {
            parts.push(format!("needs glibc {version}"));
        }
        if !self.libraries.is_empty() {
            parts.push(format!("needs {}", self.libraries.join(" and ")));
        }
        parts.join(", ")
    }
}

fn of_linux(file: &ElfFile64<Endianness>, content: &[u8]) -> Result<Needs> {
    let (endian, sections) = (file.endian(), file.elf_section_table());
    let mut newest: Option<&str> = None;
    if let Some((mut needs, strings)) = sections.gnu_verneed(endian, content)? {
        let strings = sections.strings(endian, content, strings)?;
        while let Some((_, mut versions)) = needs.next()? {
            while let Some(version) = versions.next()? {
                let name = str::from_utf8(version.name(endian, strings)?).context("a version is not text")?;
                // A weak requirement may be missing.
                let is_weak = version.vna_flags.get(endian).contains(VER_FLG_WEAK);
                if let Some(number) = name.strip_prefix(GLIBC)
                    && !is_weak
                    && newest.is_none_or(|other| parts(other) < parts(number))
                {
                    newest = Some(number);
                }
            }
        }
    }
    let Some(newest) = newest else { return Ok(Needs::default()) };
    let functions = functions(file, content, newest)?.into_iter().collect();
    Ok(Needs { glibc: Some(newest.to_owned()), functions, libraries: Vec::new() })
}

/// Names of the functions of this version that a library requires, in alphabetical order.
fn functions(file: &ElfFile64<Endianness>, content: &[u8], version: &str) -> Result<BTreeSet<String>> {
    let (endian, symbols) = (file.endian(), file.elf_dynamic_symbol_table());
    let mut found = BTreeSet::new();
    let versions = file.elf_section_table().versions(endian, content)?.unwrap_or_default();
    for (index, symbol) in symbols.enumerate() {
        if let Some(of) = versions.version(versions.version_index(endian, index).index())?
            && of.name().strip_prefix(GLIBC.as_bytes()) == Some(version.as_bytes())
        {
            let name = symbols.symbol_name(endian, symbol)?;
            found.insert(String::from_utf8_lossy(name).into_owned());
        }
    }
    Ok(found)
}

/// The numbers of a version, for comparison: 2.9 is older than 2.17.
pub fn parts(version: &str) -> Vec<u32> {
    version.split('.').map(|part| part.parse().unwrap_or(0)).collect()
}

fn of_windows(content: &[u8]) -> Result<Needs> {
    let mut libraries = BTreeSet::new();
    for import in object::File::parse(content)?.imports()? {
        let name = String::from_utf8_lossy(import?.library()).into_owned();
        if NOT_OF_WINDOWS.iter().any(|prefix| name.to_lowercase().starts_with(prefix)) {
            libraries.insert(name);
        }
    }
    Ok(Needs { libraries: libraries.into_iter().collect(), ..Needs::default() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_are_compared_by_their_numbers() {
        assert!(parts("2.9") < parts("2.17") && parts("2.2.5") < parts("2.3") && parts("2.35") == parts("2.35"));
    }

    /// This program itself requires functions of the glibc with which it was linked.
    #[test]
    #[cfg(all(target_os = "linux", target_env = "gnu", target_pointer_width = "64"))]
    fn a_program_for_linux_needs_glibc() {
        let needs = Needs::of(&std::fs::read(std::env::current_exe().unwrap()).unwrap()).unwrap();
        let version = needs.glibc.clone().unwrap();
        assert!(parts(&version) >= parts("2.17") && parts(&version)[0] == 2, "{version}");
        assert!(!needs.functions.is_empty() && needs.libraries.is_empty(), "{needs:?}");
        assert_eq!(needs.words(), format!("needs glibc {version}"));
    }

    #[test]
    fn a_file_that_is_no_library_is_rejected() {
        assert!(Needs::of(b"").is_err() && Needs::of(&[0x7f, b'E', b'L', b'F', 2, 1]).is_err());
    }
}
