//! The versions of FMI, and their differences for the packer.
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
    /// End of the file name of an FMU, after the name of the model.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Two => "fmu",
            Self::Three => "fmi3.fmu",
        }
    }

    /// The version of a description, from its attribute `fmiVersion`.
    pub fn of(fmi_version: &str) -> Self {
        if fmi_version.starts_with('3') { Self::Three } else { Self::Two }
    }

    /// The text of `modelDescription.xml`.
    ///
    /// # Errors
    /// The model has a name or a text that XML cannot represent, or lacks data that a description needs.
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

/// Name of this platform according to FMI 2.0.5, 2.3. On ARM it is the name that importers use.
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

/// Name of this platform according to FMI 3.0.2, 2.5.1.4: architecture and system.
pub fn tuple() -> String {
    let system = if OS == "macos" { "darwin" } else { OS };
    format!("{ARCH}-{system}")
}
