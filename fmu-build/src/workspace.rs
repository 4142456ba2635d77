//! Where things are. The only part that knows the repository's layout.

use anyhow::{Context, Result};
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

    /// Every folder of `modelDescription/` that holds a mechanism, in the order of their names.
    pub fn description_folders(&self) -> Result<Vec<PathBuf>> {
        let parent = self.descriptions();
        let mut folders = Vec::new();
        for entry in fs::read_dir(&parent).with_context(|| format!("{}: cannot be listed", parent.display()))? {
            let folder = entry?.path();
            if folder.join("resources").join(MECHANISM).is_file() {
                folders.push(folder);
            }
        }
        folders.sort();
        Ok(folders)
    }

    /// Where FMUs are written when no other folder is named; the same place whatever `CARGO_TARGET_DIR` says.
    pub fn fmu_folder(&self) -> PathBuf {
        self.root.join("target").join("fmu")
    }

    /// Where the demo writes when no other folder is named.
    pub fn demo_folder(&self) -> PathBuf {
        self.root.join("target").join("demo")
    }

    /// Python's virtual environment.
    pub fn virtual_environment(&self) -> PathBuf {
        self.root.join("target").join("venv")
    }

    /// Python's virtual environment for the comparison of importers.
    pub fn importers_environment(&self) -> PathBuf {
        self.root.join("target").join("venv-importers")
    }

    /// Where the comparison of importers keeps what it makes on the way.
    pub fn importers_work(&self) -> PathBuf {
        self.root.join("target").join("importers")
    }

    /// The comparison of importers: its script, its requirements and the library that listens.
    pub fn importers(&self) -> PathBuf {
        self.root.join("validation").join("importers")
    }

    /// The comparison with other tools: a Cargo package of its own, and its Python half with its requirements.
    pub fn peers(&self) -> PathBuf {
        self.root.join("validation").join("peers")
    }

    /// Python's virtual environment for the comparison with other tools.
    pub fn peers_environment(&self) -> PathBuf {
        self.root.join("target").join("venv-peers")
    }

    /// Where the comparison with other tools is built, and keeps what it makes on the way.
    pub fn peers_work(&self) -> PathBuf {
        self.root.join("target").join("peers")
    }

    /// The committed results of the benchmarks.
    pub fn results(&self) -> PathBuf {
        self.root.join("validation").join("results")
    }

    /// The Python tests, with their requirements and settings.
    pub fn python_tests(&self) -> PathBuf {
        self.root.join("tests").join("fmpy")
    }

    /// The Python programs of the commands.
    pub fn scripts(&self) -> PathBuf {
        self.root.join("fmu-build").join("python")
    }

    /// The demo's Python script.
    pub fn demo_script(&self) -> PathBuf {
        self.scripts().join("demo.py")
    }

    /// What was measured, and the report on the papers.
    pub fn validation(&self) -> PathBuf {
        self.root.join("validation")
    }
}
