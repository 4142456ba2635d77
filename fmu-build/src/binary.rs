//! Shared libraries that were built elsewhere: `--binary win64=path/to.dll` adds one more platform to an FMU.
//!
//! In: the name of a platform, and a file. Out: the bytes of the file, after a check that it is a library of the
//! platform with the functions of FMI.

mod universal;

use crate::archive::{BINARIES, Entry};
use crate::files;
use crate::library::served::SharedLibrary;
use crate::version::Version;
use anyhow::{Context, Result, bail};
use fmu_cli::Library;
use object::read::NameOrOrdinal;
use object::read::macho::{FatArch, MachOFatFile32, MachOFatFile64};
use object::{Architecture, BinaryFormat, FileKind, Object, ObjectKind};

/// A function that every library of an FMU exports.
const FUNCTION: &str = "fmi2Instantiate";
/// A function that a library with FMI 3.0 exports.
const FUNCTION_3: &str = "fmi3InstantiateCoSimulation";

/// Linux on ARM. FMI 2.0 has no separate name. Since 2.0.4 the name of FMI 3.0 is used.
pub const ARM_LINUX: &str = "aarch64-linux";
/// macOS, on both processors.
pub const MAC: &str = "darwin64";
/// The folder in which importers of FMI 2.0 look on every 64-bit Linux, if they only know x86_64.
pub const COMPATIBLE: &str = "linux64";

/// A platform of FMI 2.0.5, 2.3, with its names in FMI 3.0.2, 2.5.1.4.
#[derive(Clone, Copy, Debug)]
struct Platform {
    name: &'static str,
    /// One name per architecture.
    tuples: &'static [&'static str],
    extension: &'static str,
    format: BinaryFormat,
    architectures: &'static [Architecture],
}

const PLATFORMS: [Platform; 7] = [
    Platform {
        name: "win32",
        tuples: &["x86-windows"],
        extension: "dll",
        format: BinaryFormat::Pe,
        architectures: &[Architecture::I386],
    },
    Platform {
        name: "win64",
        tuples: &["x86_64-windows"],
        extension: "dll",
        format: BinaryFormat::Pe,
        architectures: &[Architecture::X86_64],
    },
    Platform {
        name: "linux32",
        tuples: &["x86-linux"],
        extension: "so",
        format: BinaryFormat::Elf,
        architectures: &[Architecture::I386],
    },
    Platform {
        name: "linux64",
        tuples: &["x86_64-linux"],
        extension: "so",
        format: BinaryFormat::Elf,
        architectures: &[Architecture::X86_64],
    },
    Platform {
        name: ARM_LINUX,
        tuples: &[ARM_LINUX],
        extension: "so",
        format: BinaryFormat::Elf,
        architectures: &[Architecture::Aarch64],
    },
    Platform {
        name: "darwin32",
        tuples: &["x86-darwin"],
        extension: "dylib",
        format: BinaryFormat::MachO,
        architectures: &[Architecture::I386],
    },
    // Importers on both kinds of processors look in this folder.
    Platform {
        name: MAC,
        tuples: &["x86_64-darwin", "aarch64-darwin"],
        extension: "dylib",
        format: BinaryFormat::MachO,
        architectures: &[Architecture::X86_64, Architecture::Aarch64],
    },
];

/// A checked library.
#[derive(Debug)]
pub struct Binary {
    platform: &'static Platform,
    /// Folder in an FMU of FMI 2.0.
    folder: &'static str,
    content: Vec<u8>,
    /// The library of the project. None for a library built elsewhere, which serves the models that the user states.
    library: Option<&'static SharedLibrary>,
}

impl Binary {
    /// Read the file and check it.
    ///
    /// # Errors
    /// The file does not exist, or is no library of the platform.
    pub fn read(named: &Library) -> Result<Self> {
        let file = named.file.display();
        if !named.file.is_file() {
            bail!("{file}: there is no such file; give the path of the library for {}", named.platform);
        }
        Self::new(named.platform, files::read(&named.file, u64::MAX)?, &file.to_string())
    }

    /// Check a library for the platform with this name in FMI 2.0. `shown` is its name in messages.
    ///
    /// # Errors
    /// The content is no library of the platform, or the platform does not exist.
    pub fn new(name: &str, content: Vec<u8>, shown: &str) -> Result<Self> {
        let Some(platform) = PLATFORMS.iter().find(|platform| platform.name == name) else {
            bail!("FMI 2.0 has no platform {name}");
        };
        check(platform, &content, FUNCTION)
            .with_context(|| format!("{shown}: the file is not the library of an FMU for {name}"))?;
        Ok(Self { platform, folder: platform.name, content, library: None })
    }

    /// This binary as the given library of the project.
    pub fn of(self, library: &'static SharedLibrary) -> Self {
        Self { library: Some(library), ..self }
    }

    /// Whether the binary belongs to the FMUs of this library of the project.
    pub fn serves(&self, library: &SharedLibrary) -> bool {
        self.library.is_none_or(|own| own == library)
    }

    /// The same binary in the folder [`COMPATIBLE`] of an FMU of FMI 2.0.
    pub fn compatible(self) -> Self {
        Self { folder: COMPATIBLE, ..self }
    }

    /// Whether both binaries have the same path in an FMU.
    pub fn shares_file(&self, other: &Self) -> bool {
        self.folder == other.folder && self.library == other.library
    }

    /// Add the library for another processor of macOS to the file.
    ///
    /// # Errors
    /// One of the two is no library of macOS.
    pub fn join(&mut self, other: Self) -> Result<()> {
        if self.content != other.content {
            self.content = universal::file(&[&self.content, &other.content])?;
        }
        Ok(())
    }

    /// Bytes of the file.
    pub fn content(&self) -> &[u8] {
        &self.content
    }

    /// Name of the platform, or of the platform whose folder it uses.
    pub fn platform(&self) -> &'static str {
        self.folder
    }

    /// The entries in the FMU of a model with this modelIdentifier: one entry, or for FMI 3.0 one entry per
    /// architecture in the file. No entry for FMI 3.0 if the library lacks its functions.
    pub fn entries(&self, version: Version, model_identifier: &str) -> Vec<Entry> {
        let Platform { tuples, architectures, .. } = self.platform;
        let holds = |architecture: &'static Architecture| {
            let one = Platform { architectures: std::slice::from_ref(architecture), ..*self.platform };
            check(&one, &self.content, FUNCTION_3).is_ok()
        };
        let parts: Vec<(&str, &[u8])> = match version {
            Version::Two => vec![(self.folder, &self.content)],
            Version::Three => {
                let held = tuples.iter().zip(*architectures).filter(|(_, of)| holds(of));
                held.map(|(tuple, of)| (*tuple, universal::part(&self.content, *of))).collect()
            }
        };
        let named = |(folder, content): (&str, &[u8])| {
            Some(Entry { name: path(folder, model_identifier)?, content: content.to_vec() })
        };
        parts.into_iter().filter_map(named).collect()
    }
}

/// The platform with this name in FMI 2.0 or FMI 3.0.
fn platform(name: &str) -> Option<&'static Platform> {
    PLATFORMS.iter().find(|known| known.name == name || known.tuples.contains(&name))
}

/// Path of the library for this platform in an FMU. None if FMI has no such platform.
pub fn path(name: &str, model_identifier: &str) -> Option<String> {
    Some(format!("{BINARIES}/{name}/{model_identifier}.{}", platform(name)?.extension))
}

/// Whether this is a library of FMI 2.0 for the platform of this name.
///
/// # Errors
/// The content is no such library, or the platform does not exist.
pub fn check_for(name: &str, content: &[u8]) -> Result<()> {
    match platform(name) {
        Some(platform) => check(platform, content, FUNCTION),
        None => bail!("FMI has no platform {name}; the platforms of FMI 2.0 are {}", fmu_cli::PLATFORMS.join(", ")),
    }
}

/// Whether one of the libraries in the file is for the platform and exports this function.
fn check(platform: &Platform, content: &[u8], function: &str) -> Result<()> {
    match FileKind::parse(content).map_err(|_| anyhow::anyhow!("the file is not a library"))? {
        FileKind::MachOFat32 => check_each(platform, content, MachOFatFile32::parse(content)?.arches(), function),
        FileKind::MachOFat64 => check_each(platform, content, MachOFatFile64::parse(content)?.arches(), function),
        _ => check_one(platform, content, function),
    }
}

fn check_each<A: FatArch>(platform: &Platform, content: &[u8], parts: &[A], function: &str) -> Result<()> {
    let mut result = Err(anyhow::anyhow!("the file contains no library"));
    for part in parts {
        result = check_one(platform, part.data(content)?, function);
        if result.is_ok() {
            break;
        }
    }
    result
}

fn check_one(platform: &Platform, content: &[u8], function: &str) -> Result<()> {
    let library = object::File::parse(content)?;
    let (format, architecture) = (library.format(), library.architecture());
    if format != platform.format || !platform.architectures.contains(&architecture) {
        bail!(
            "the file has the format {format:?} for the processor {architecture:?}, but must have the format {:?} for \
             {}",
            platform.format,
            platform.architectures.iter().map(|a| format!("{a:?}")).collect::<Vec<_>>().join(" or ")
        );
    }
    // Bundles of macOS are loaded like dynamic libraries.
    if library.kind() != ObjectKind::Dynamic && format != BinaryFormat::MachO {
        bail!("the file is not a shared library");
    }
    if !exports(&library)?.iter().any(|name| name == function) {
        bail!("the library does not export {function}");
    }
    Ok(())
}

/// Check that a library exports functions of FMI only. Other functions could clash with those of an importer's other
/// libraries.
///
/// # Errors
/// The message names another exported function, or the file is no library.
pub fn exports_fmi_only(content: &[u8]) -> Result<()> {
    let names = exports(&object::File::parse(content)?)?;
    match names.iter().find(|name| !name.starts_with("fmi2") && !name.starts_with("fmi3")) {
        Some(name) => bail!("the library exports {name}, which is not a function of FMI"),
        None => Ok(()),
    }
}

/// C names of the exported functions of a library.
fn exports(library: &object::File) -> Result<Vec<String>> {
    let mut names = Vec::new();
    for export in library.exports()? {
        if let NameOrOrdinal::Name(name) = export?.name() {
            let name = String::from_utf8_lossy(name);
            // On macOS a C name has the prefix `_`.
            let plain = name.strip_prefix('_').filter(|_| library.format() == BinaryFormat::MachO);
            names.push(plain.unwrap_or(&name).to_owned());
        }
    }
    Ok(names)
}

#[cfg(test)]
mod tests {
    use super::*;
    use fmu_cli::library;
    use std::path::PathBuf;

    fn platform(name: &str) -> &'static Platform {
        PLATFORMS.iter().find(|platform| platform.name == name).unwrap()
    }

    #[test]
    fn a_platform_and_a_path_are_named() {
        let named = library("win64=a b=c.dll").unwrap();
        assert_eq!((named.platform, named.file), ("win64", PathBuf::from("a b=c.dll")));
        assert!(library("win64").unwrap_err().contains("PLATFORM=PATH"));
        let message = library("win16=x.dll").unwrap_err();
        assert!(message.contains("win16") && message.contains("win32, win64, linux32"), "{message}");
        assert_eq!(PLATFORMS.map(|platform| platform.name), fmu_cli::PLATFORMS);
    }

    #[test]
    fn a_file_that_is_no_library_is_rejected() {
        for content in
            [&b""[..], b"MZ", b"#!/bin/sh\n", &[0x7f, b'E', b'L', b'F'], &[0xca, 0xfe, 0xba, 0xbe, 0, 0, 0, 9]]
        {
            for platform in &PLATFORMS {
                assert!(check(platform, content, FUNCTION).is_err(), "{content:?}");
            }
        }
        let missing = library("win64=no/such.dll").unwrap();
        assert!(Binary::read(&missing).unwrap_err().to_string().contains("no/such.dll: there is no such file"));
    }

    #[test]
    #[cfg(all(target_os = "linux", target_arch = "x86_64"))]
    fn a_program_is_no_library() {
        let program = std::fs::read(std::env::current_exe().unwrap()).unwrap();
        let message = check(platform("win64"), &program, FUNCTION).unwrap_err().to_string();
        assert!(message.contains("Elf for the processor X86_64") && message.contains("Pe for X86_64"), "{message}");
        assert!(exports_fmi_only(b"not a library").is_err());
        let message = check(platform("linux64"), &program, FUNCTION).unwrap_err().to_string();
        assert!(message.contains("does not export") || message.contains("not a shared library"), "{message}");
    }
}
