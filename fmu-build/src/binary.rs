//! Shared libraries that were built elsewhere: `--binary win64=path/to.dll` adds one more platform to an FMU.
//!
//! In: a platform's name and a file. Out: the file's bytes, after a look whether it is a library of that platform with
//! the functions of FMI in it.

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

/// A function that every library of an FMU has.
const FUNCTION: &str = "fmi2Instantiate";
/// A function that a library has which also serves FMI 3.0.
const FUNCTION_3: &str = "fmi3InstantiateCoSimulation";

/// Linux on ARM. FMI 2.0 has no name of its own for it: since 2.0.4 the one of FMI 3.0 stands.
pub const ARM_LINUX: &str = "aarch64-linux";
/// macOS, on both processors.
pub const MAC: &str = "darwin64";
/// The folder in which importers of FMI 2.0 look on every 64-bit Linux if they know no processor but x86_64.
pub const COMPATIBLE: &str = "linux64";

/// A platform of FMI 2.0.5, 2.3, with its names in FMI 3.0.2, 2.5.1.4.
#[derive(Clone, Copy, Debug)]
struct Platform {
    name: &'static str,
    /// One name for each architecture.
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
    // Importers look here on both kinds of processors.
    Platform {
        name: MAC,
        tuples: &["x86_64-darwin", "aarch64-darwin"],
        extension: "dylib",
        format: BinaryFormat::MachO,
        architectures: &[Architecture::X86_64, Architecture::Aarch64],
    },
];

/// A library that was looked at.
#[derive(Debug)]
pub struct Binary {
    platform: &'static Platform,
    /// Folder in an FMU of FMI 2.0.
    folder: &'static str,
    content: Vec<u8>,
    /// Which library of the project it is; None for one that was built elsewhere, which serves what the user says.
    library: Option<&'static SharedLibrary>,
}

impl Binary {
    /// Read the file and look at it.
    ///
    /// # Errors
    /// There is no such file, or it is no library of the platform.
    pub fn read(named: &Library) -> Result<Self> {
        let file = named.file.display();
        if !named.file.is_file() {
            bail!("{file}: there is no such file; give the path of the library for {}", named.platform);
        }
        Self::new(named.platform, files::read(&named.file, u64::MAX)?, &file.to_string())
    }

    /// Look at a library for the platform of this name in FMI 2.0; `shown` names it in messages.
    ///
    /// # Errors
    /// It is no library of the platform, or there is no such platform.
    pub fn new(name: &str, content: Vec<u8>, shown: &str) -> Result<Self> {
        let Some(platform) = PLATFORMS.iter().find(|platform| platform.name == name) else {
            bail!("FMI 2.0 has no platform {name}");
        };
        check(platform, &content, FUNCTION)
            .with_context(|| format!("{shown}: is not the library of an FMU for {name}"))?;
        Ok(Self { platform, folder: platform.name, content, library: None })
    }

    /// The same as this library of the project.
    pub fn of(self, library: &'static SharedLibrary) -> Self {
        Self { library: Some(library), ..self }
    }

    /// Whether it goes into the FMUs of a library of the project.
    pub fn serves(&self, library: &SharedLibrary) -> bool {
        self.library.is_none_or(|own| own == library)
    }

    /// The same library in the folder [`COMPATIBLE`] of an FMU of FMI 2.0.
    pub fn compatible(self) -> Self {
        Self { folder: COMPATIBLE, ..self }
    }

    /// Whether both have one path in an FMU.
    pub fn shares_file(&self, other: &Self) -> bool {
        self.folder == other.folder && self.library == other.library
    }

    /// Put the library of another processor of macOS into the same file.
    ///
    /// # Errors
    /// One of the two is none of macOS.
    pub fn join(&mut self, other: Self) -> Result<()> {
        if self.content != other.content {
            self.content = universal::file(&[&self.content, &other.content])?;
        }
        Ok(())
    }

    /// Its bytes.
    pub fn content(&self) -> &[u8] {
        &self.content
    }

    /// Name of its platform, or of the one in whose folder it lies.
    pub fn platform(&self) -> &'static str {
        self.folder
    }

    /// The entries in the FMU of a model with this modelIdentifier: one, or in FMI 3.0 one for each architecture that
    /// the file holds, with what is for it; none of FMI 3.0 if the library has not its functions.
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

/// The platform of this name in FMI 2.0 or FMI 3.0.
fn platform(name: &str) -> Option<&'static Platform> {
    PLATFORMS.iter().find(|known| known.name == name || known.tuples.contains(&name))
}

/// Path in an FMU of the library for the platform of this name; None if FMI has no such platform.
pub fn path(name: &str, model_identifier: &str) -> Option<String> {
    Some(format!("{BINARIES}/{name}/{model_identifier}.{}", platform(name)?.extension))
}

/// Whether this is a library of FMI 2.0 for the platform of this name.
///
/// # Errors
/// It is none; there is no such platform.
pub fn check_for(name: &str, content: &[u8]) -> Result<()> {
    match platform(name) {
        Some(platform) => check(platform, content, FUNCTION),
        None => bail!("FMI has no platform {name}; the platforms of FMI 2.0 are {}", fmu_cli::PLATFORMS.join(", ")),
    }
}

/// Whether one library in the file, which may hold several, is the platform's and exports this function.
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
    // Bundles of macOS are loaded as dynamic libraries are.
    if library.kind() != ObjectKind::Dynamic && format != BinaryFormat::MachO {
        bail!("the file is not a shared library");
    }
    if !exports(&library)?.iter().any(|name| name == function) {
        bail!("the library does not export {function}");
    }
    Ok(())
}

/// Whether a library exports functions of FMI only: others could clash with those of an importer's other libraries.
///
/// # Errors
/// The name of one that is none, or the file is no library.
pub fn exports_fmi_only(content: &[u8]) -> Result<()> {
    let names = exports(&object::File::parse(content)?)?;
    match names.iter().find(|name| !name.starts_with("fmi2") && !name.starts_with("fmi3")) {
        Some(name) => bail!("the library exports {name}, which is not a function of FMI"),
        None => Ok(()),
    }
}

/// Names that a library exports, as C has them.
fn exports(library: &object::File) -> Result<Vec<String>> {
    let mut names = Vec::new();
    for export in library.exports()? {
        if let NameOrOrdinal::Name(name) = export?.name() {
            let name = String::from_utf8_lossy(name);
            // On macOS a C name has a `_` before it.
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
    fn what_is_no_library_is_refused() {
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
