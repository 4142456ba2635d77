//! The versions of FMI that an FMU can be of, and what differs between them for the packer.
use crate::xml::{fmi2, fmi3};
use anyhow::{Result, bail};
use fmu_cli::Naming;
use linkage_fmu::component::Component;
use std::env::consts::{ARCH, OS};

/// A version of FMI.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Version {
    /// FMI 2.0.
    Two,
    /// FMI 3.0.
    Three,
}

impl Version {
    /// What follows the name of the model in the name of the file.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Two => "fmu",
            Self::Three => "fmi3.fmu",
        }
    }

    /// The version that a description is of, by its attribute `fmiVersion`.
    pub fn of(fmi_version: &str) -> Self {
        if fmi_version.starts_with('3') { Self::Three } else { Self::Two }
    }

    /// The text of `modelDescription.xml`.
    ///
    /// # Errors
    /// The model has a name or a text that XML cannot hold, or lacks what a description must say.
    pub fn describe(self, component: &Component, naming: Naming) -> Result<String> {
        match self {
            Self::Two => fmi2::to_xml(component, naming),
            Self::Three => fmi3::to_xml(component, naming),
        }
    }

    /// The folder in `binaries` for this machine's library.
    ///
    /// # Errors
    /// The version has no name for this operating system.
    pub fn platform(self) -> Result<String> {
        match self {
            Self::Two => platform().map(str::to_owned),
            Self::Three => Ok(tuple()),
        }
    }
}

/// This platform's name, after FMI 2.0.5, 2.3; on ARM too it is the one that importers there look for.
///
/// # Errors
/// FMI 2.0 has no name for this operating system.
pub fn platform() -> Result<&'static str> {
    Ok(match OS {
        "linux" => "linux64",
        "windows" => "win64",
        "macos" => "darwin64",
        other => bail!("{other}: FMI 2.0 has no platform for this system; build on Linux, Windows or macOS"),
    })
}

/// This platform's name, after FMI 3.0.2, 2.5.1.4: architecture and system.
pub fn tuple() -> String {
    let system = if OS == "macos" { "darwin" } else { OS };
    format!("{ARCH}-{system}")
}
