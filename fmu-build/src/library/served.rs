//! Which shared library serves which models.

use crate::workspace::MECHANISM;

/// A shared library, by the models that it serves. A library has the code of no other models.
#[derive(Debug, PartialEq)]
pub struct SharedLibrary {
    /// Cargo's name for its package.
    pub package: &'static str,
    /// Name of which that of the file follows.
    pub name: &'static str,
    /// Name of its file in an installation, without extension.
    pub installed: &'static str,
}

/// The library of mechanisms, `src/exports`.
pub const MECHANISMS: SharedLibrary =
    SharedLibrary { package: "linkage-fmu-exports", name: "linkage_fmu_exports", installed: "linkage_fmu" };
/// The library of hydraulic actuators and systems, `src/exports/hydraulics`.
pub const HYDRAULICS: SharedLibrary = SharedLibrary {
    package: "linkage-fmu-exports-hydraulics",
    name: "linkage_fmu_exports_hydraulics",
    installed: "linkage_fmu_hydraulics",
};

/// The library that serves the models of this definition file.
pub fn of(definition_file: &str) -> &'static SharedLibrary {
    if definition_file == MECHANISM { &MECHANISMS } else { &HYDRAULICS }
}
