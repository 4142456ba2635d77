//! The shared libraries, and the models that each of them serves.

use linkage_fmu::component::Component;

/// A shared library for a group of models.
#[derive(Debug, PartialEq)]
pub struct SharedLibrary {
    /// Cargo's name for its package.
    pub package: &'static str,
    /// Name from which the name of the file follows.
    pub name: &'static str,
    /// Name of its file in an installation, without extension.
    pub installed: &'static str,
}

/// The library of mechanisms without both, `src/exports`. It contains no code of other models.
pub const MECHANISMS: SharedLibrary =
    SharedLibrary { package: "linkage-fmu-exports", name: "linkage_fmu_exports", installed: "linkage_fmu" };
/// The library of all models with hydraulics or with states of controllers, `src/exports/hydraulics`.
pub const HYDRAULICS: SharedLibrary = SharedLibrary {
    package: "linkage-fmu-exports-hydraulics",
    name: "linkage_fmu_exports_hydraulics",
    installed: "linkage_fmu_hydraulics",
};

/// The library that serves this model.
pub fn of(model: &Component) -> &'static SharedLibrary {
    if model.has_more_states() { &HYDRAULICS } else { &MECHANISMS }
}
