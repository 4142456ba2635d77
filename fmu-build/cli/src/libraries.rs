//! Arguments of the tasks that build libraries for platforms: `package`, `dist`, `test`.
//!
//! In: words. Out: versions of FMI, platforms, libraries built elsewhere. It must not know how a library is built.
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// Arguments of `package`.
#[derive(Args, Clone, Default)]
pub struct Package {
    /// Definition file (mechanism.json), or folder that contains a definition file. With --ssp, system file
    /// (system.json) [default: modelDescription/LandingGearRetraction]
    #[arg(value_name = "PATH", conflicts_with = "all")]
    pub paths: Vec<PathBuf>,
    /// Pack every example mechanism and every example system in modelDescription/
    #[arg(long)]
    pub all: bool,
    /// Pack each system as an SSP package <name>.ssp, and also write the FMUs of the system. A system file states the
    /// mechanisms and circuits, and their connections and values [default: the example systems in modelDescription/]
    #[arg(long, conflicts_with = "all")]
    pub ssp: bool,
    /// Folder for the FMUs [default: target/fmu in the repository]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Library for another platform, such as win64=path/to.dll. A library that was built on another machine must come
    /// from this version of the program. Give --binary once for each library
    #[arg(long = "binary", value_name = "PLATFORM=PATH", value_parser = library)]
    pub binaries: Vec<Library>,
    /// Version of FMI: 2 writes <Name>.fmu, 3 writes <Name>.fmi3.fmu, and both writes both files
    #[arg(long, value_enum, default_value_t, value_name = "VERSION")]
    pub fmi: Fmi,
    /// Attribute variableNamingConvention in modelDescription.xml. With `structured`, dots divide the variable names
    /// into levels, for simulation tools that show a tree. With `flat`, dots have no meaning. The names of the
    /// variables stay the same
    #[arg(long, value_enum, default_value_t, value_name = "CONVENTION")]
    pub naming: Naming,
    /// Platforms on which the FMU must run, separated by commas. The program builds and packs a library for each
    /// platform [default: this machine]
    #[arg(long, value_enum, value_delimiter = ',', value_name = "PLATFORMS")]
    pub platforms: Vec<Platform>,
    /// Pack only the libraries that this machine can build, and list the missing platforms [default: a missing platform
    /// is an error]
    #[arg(long, requires = "platforms")]
    pub available: bool,
    /// Put the library for Linux on ARM into binaries/linux64, for simulation tools that do not know the platform
    /// aarch64-linux in FMI 2.0
    #[arg(long, requires = "platforms")]
    pub compatible: bool,
    /// Oldest version of glibc (the C library of Linux) with which the FMU must run, 2.17 or later. The first use of
    /// --glibc installs the linker zig from PyPI
    #[arg(long, value_name = "VERSION", value_parser = glibc)]
    pub glibc: Option<String>,
    /// Add a static library for the platform with this Rust target triple, such as x86_64-unknown-linux-gnu. Simulation
    /// tools can link the static library into a program. Give --static once for each platform
    #[arg(long = "static", value_name = "TARGET")]
    pub statics: Vec<String>,
    /// Do not pack documentation/animation.html, a page that shows the motion of the default experiment
    #[arg(long)]
    pub no_animation: bool,
    /// Do not pack the file tables.bin, which contains positions, masses and loads along the motion. With --no-tables,
    /// the FMU is smaller, but an instance of the FMU starts more slowly, because the instance computes these values
    /// itself
    #[arg(long)]
    pub no_tables: bool,
    /// Do not pack the results of the default experiment, with which a simulation tool can compare its own results
    #[arg(long)]
    pub no_results: bool,
}

impl Package {
    /// No argument except the version FMI 2.0, for tasks that run the FMU.
    pub fn of_fmi_2() -> Self {
        Self { fmi: Fmi::Two, ..Self::default() }
    }
}

/// Platforms that libraries are built for, by the names of FMI 3.0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Platform {
    /// Linux on Intel and AMD; the name of this platform in FMI 2.0 is linux64
    #[value(name = "x86_64-linux", alias = "linux64")]
    X86Linux,
    /// Windows on Intel and AMD; the name of this platform in FMI 2.0 is win64
    #[value(name = "x86_64-windows", alias = "win64")]
    X86Windows,
    /// Linux on ARM with 64 bits; the name of this platform in FMI 2.0 is aarch64-linux
    #[value(name = "aarch64-linux")]
    ArmLinux,
    /// macOS on Intel; the name of this platform in FMI 2.0 is darwin64
    #[value(name = "x86_64-darwin")]
    X86Mac,
    /// macOS on ARM; the name of this platform in FMI 2.0 is darwin64. With x86_64-darwin, one file contains the
    /// libraries for Intel and ARM
    #[value(name = "aarch64-darwin")]
    ArmMac,
}

/// Versions of FMI that `package` makes FMUs of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Fmi {
    /// FMI 2.0
    #[value(name = "2")]
    Two,
    /// FMI 3.0
    #[value(name = "3")]
    Three,
    /// FMI 2.0 and FMI 3.0: one file for each version
    #[default]
    Both,
}

/// Conventions of FMI for names of variables (FMI 2.0.5, 2.2.9).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Naming {
    /// Dots in the variable names have no meaning
    Flat,
    /// Dots divide the variable names into levels
    #[default]
    Structured,
}

impl Naming {
    /// Word in the description of an FMU.
    pub fn word(self) -> &'static str {
        match self {
            Self::Flat => "flat",
            Self::Structured => "structured",
        }
    }
}

/// Arguments of `dist`.
#[derive(Args, Default)]
pub struct Dist {
    /// Platforms for which the installed program can pack FMUs, separated by commas. The installed program itself runs
    /// only on the platform of this machine. With --platforms, the program file is smaller, and the build needs some
    /// minutes more [default: this machine]
    #[arg(long, value_enum, value_delimiter = ',', value_name = "PLATFORMS")]
    pub platforms: Vec<Platform>,
    /// Build only the libraries that this machine can build, and list the missing platforms [default: a missing
    /// platform is an error]
    #[arg(long, requires = "platforms")]
    pub available: bool,
    /// Library for another platform, such as win64=path/to.dll. A library that was built on another machine must come
    /// from this version of the program. Give --binary once for each library
    #[arg(long = "binary", value_name = "PLATFORM=PATH", value_parser = library)]
    pub binaries: Vec<Library>,
    /// Oldest version of glibc (the C library of Linux) with which the program and the libraries for Linux must run,
    /// 2.17 or later. With --glibc, the linker zig links the program [default: the glibc of this machine]
    #[arg(long, value_name = "VERSION", value_parser = glibc)]
    pub glibc: Option<String>,
    /// Folder for the wheel and the source distribution [default: target/dist in the repository]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// After the build, install the wheel in a new virtual environment, and run its commands there without Rust
    #[arg(long)]
    pub test: bool,
}

/// Arguments of `test`.
#[derive(Args, Default)]
pub struct Test {
    /// Run only the test of other platforms: run their libraries with Wine and QEMU, and compare the results with this
    /// machine
    #[arg(long)]
    pub platforms: bool,
    /// Library for --platforms that was built on another machine, such as win64=path/to.dll. Give --binary once for
    /// each library
    #[arg(long = "binary", value_name = "PLATFORM=PATH", value_parser = library, requires = "platforms")]
    pub binaries: Vec<Library>,
    /// Write the results of the test of --platforms to validation/results/platforms.md
    #[arg(long, requires = "platforms")]
    pub write: bool,
    /// Run only the test that builds the library in two folders and compares the bytes
    #[arg(long, conflicts_with = "platforms")]
    pub reproducible: bool,
}

/// Oldest glibc that Rust's standard library knows.
const OLDEST_GLIBC: u32 = 17;

/// A version of glibc, such as 2.17.
///
/// # Errors
/// The text has another form, or the version is older than that of Rust's standard library.
pub fn glibc(text: &str) -> Result<String, String> {
    match text.strip_prefix("2.").and_then(|minor| minor.parse::<u32>().ok()) {
        Some(minor) if minor >= OLDEST_GLIBC => Ok(format!("2.{minor}")),
        _ => Err(format!("write a version of glibc, 2.{OLDEST_GLIBC} or later, such as 2.{OLDEST_GLIBC} or 2.28")),
    }
}

/// Platforms of FMI 2.0.5, 2.3. FMI 2.0 has no separate name for Linux on ARM.
pub const PLATFORMS: [&str; 7] = ["win32", "win64", "linux32", "linux64", "aarch64-linux", "darwin32", "darwin64"];

impl Platform {
    /// The platform with this name, of FMI 3.0 or 2.0.
    ///
    /// # Errors
    /// No platform has this name.
    pub fn named(name: &str) -> Result<Self, String> {
        let known = || Self::value_variants().iter().filter_map(ValueEnum::to_possible_value);
        let names = || known().map(|value| value.get_name().to_owned()).collect::<Vec<_>>().join(", ");
        Self::from_str(name, false).map_err(|_| format!("there is no platform {name}; the platforms are {}", names()))
    }
}

/// A platform and the library for it.
#[derive(Clone, Debug)]
pub struct Library {
    /// One of [`PLATFORMS`].
    pub platform: &'static str,
    /// The library.
    pub file: PathBuf,
}

/// `PLATFORM=PATH`.
///
/// # Errors
/// Another form, or an unknown platform.
pub fn library(text: &str) -> Result<Library, String> {
    let known = || PLATFORMS.join(", ");
    let (name, file) =
        text.split_once('=').ok_or_else(|| format!("write PLATFORM=PATH; the platforms are {}", known()))?;
    let platform = PLATFORMS
        .into_iter()
        .find(|platform| *platform == name)
        .ok_or_else(|| format!("FMI 2.0 has no platform {name}; the platforms are {}", known()))?;
    Ok(Library { platform, file: file.into() })
}
