//! Where things are. The only part that knows the repository's layout.

use anyhow::{Context, Result};
use linkage_fmu::component::Component;
use std::env;
use std::fs;
use std::path::{Path, PathBuf};

/// Name of a mechanism's file, in a folder of `modelDescription/` and in an FMU.
pub const MECHANISM: &str = "mechanism.json";
/// Folder of the FMU that `package` and `demo` take when none is named.
pub const DEFAULT_FMU: &str = "LandingGearRetraction";

/// The checked-out repository.
pub struct Workspace {
    root: PathBuf,
}

impl Workspace {
    /// The repository this program was built from; `cargo run` says where that is now.
    pub fn locate() -> Self {
        let package =
            env::var_os("CARGO_MANIFEST_DIR").map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")), PathBuf::from);
        let root = package.parent().map_or_else(|| PathBuf::from("."), Path::to_path_buf);
        Self { root }
    }

    /// The repository's top folder.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Folder that holds one folder per FMU.
    pub fn descriptions(&self) -> PathBuf {
        self.root.join("modelDescription")
    }

    /// Every folder of `modelDescription/` that holds a definition file, in the order of their names.
    pub fn description_folders(&self) -> Result<Vec<PathBuf>> {
        let parent = self.descriptions();
        let mut folders = Vec::new();
        for entry in fs::read_dir(&parent).with_context(|| format!("{}: cannot be listed", parent.display()))? {
            let folder = entry?.path();
            let resources = folder.join("resources");
            if Component::definition_files().iter().any(|file| resources.join(file).is_file()) {
                folders.push(folder);
            }
        }
        folders.sort();
        Ok(folders)
    }

    /// Where FMUs are written when no other folder is named; the same place whatever `CARGO_TARGET_DIR` says.
    pub fn fmu_folder(&self) -> PathBuf {
        self.target("fmu")
    }

    /// A folder of what is made: FMUs, the demo, Python's virtual environments, what benchmarks keep on the way.
    pub fn target(&self, name: &str) -> PathBuf {
        self.root.join("target").join(name)
    }

    /// The Python tests, with their requirements and settings.
    pub fn python_tests(&self) -> PathBuf {
        self.root.join("tests").join("fmpy")
    }

    /// The tests of pages in a browser, with their requirements.
    pub fn browser_tests(&self) -> PathBuf {
        self.root.join("tests").join("browser")
    }

    /// The Python scripts of the demo.
    pub fn python_scripts(&self) -> PathBuf {
        self.root.join("fmu-build").join("python")
    }

    /// What was measured, with the programs that measure and draw it, and the report on the papers.
    pub fn validation(&self) -> PathBuf {
        self.root.join("validation")
    }

    /// Mechanisms that other programs fail at, with their films.
    pub fn gallery(&self) -> PathBuf {
        self.root.join("docs").join("gallery")
    }

    /// The committed results of the benchmarks.
    pub fn results(&self) -> PathBuf {
        self.validation().join("results")
    }
}
