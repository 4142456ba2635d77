//! Paths of folders and files. Only this module knows the layout of the repository and of an installation. An
//! installation has the same parts of the repository in the same folders, and prebuilt libraries.

use crate::archive::BINARIES;
use anyhow::{Context, Result, bail};
use fmu_cli::{Task, installed};
use linkage_fmu::component::Component;
use std::env;
use std::fs;
use std::path::{Path, PathBuf};

/// Name of a mechanism's file, in a folder of `modelDescription/` and in an FMU.
pub const MECHANISM: &str = "mechanism.json";
/// Folder that contains one folder per FMU.
const DESCRIPTIONS: &str = "modelDescription";
/// Folder of the default FMU of `package` and `demo`.
pub const DEFAULT_FMU: &str = "LandingGearRetraction";

/// Folder of an installation, relative to the environment into which pip has installed it.
pub const INSTALLED: &str = "share/linkage-fmu";

/// The checked-out repository, or an installation.
pub struct Workspace {
    root: PathBuf,
    is_installed: bool,
}

impl Workspace {
    /// The repository from which this program was built. `cargo run` states its present path.
    pub fn locate() -> Self {
        let package =
            env::var_os("CARGO_MANIFEST_DIR").map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")), PathBuf::from);
        let is_root = |folder: &&Path| folder.join(DESCRIPTIONS).is_dir();
        let root = package.ancestors().find(is_root).map_or_else(|| PathBuf::from("."), Path::to_path_buf);
        Self { root, is_installed: false }
    }

    /// The installation of the Python package in this folder: `share/linkage-fmu` in the nearest parent folder that
    /// contains it, which is the folder of the Python environment.
    ///
    /// # Errors
    /// There is no installation.
    pub fn installed(package: &Path) -> Result<Self> {
        let roots = package.ancestors().skip(1).map(|folder| folder.join(INSTALLED));
        match roots.into_iter().find(|root| root.join(BINARIES).is_dir()) {
            Some(root) => Ok(Self { root, is_installed: true }),
            None => bail!(
                "{}: no folder above this one has {INSTALLED}, the files of the program; install the wheel again with \
                 pip",
                package.display()
            ),
        }
    }

    /// Name with which the user calls the program.
    pub fn program(&self) -> &'static str {
        if self.is_installed { installed::PROGRAM } else { "cargo fmu" }
    }

    /// Check that a task can be run here.
    ///
    /// # Errors
    /// The task needs the source, and this is an installation.
    pub fn serves(&self, task: &Task) -> Result<()> {
        match installed::needs_source(task) {
            Some(name) if self.is_installed => bail!(
                "{name}: this command needs the source code, which an installation does not contain; run `cargo fmu \
                 {name}` in a checked-out repository"
            ),
            _ => Ok(()),
        }
    }

    /// The installation, which contains prebuilt libraries. None for the repository, where libraries are built.
    pub fn installation(&self) -> Option<&Path> {
        self.is_installed.then_some(&self.root)
    }

    /// The top folder of the repository or of the installation.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Folder that contains one folder per FMU.
    pub fn descriptions(&self) -> PathBuf {
        self.root.join(DESCRIPTIONS)
    }

    /// Every folder of `modelDescription/` with a definition file, sorted by name.
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

    /// Whether this folder contains descriptions of FMUs next to their definitions: `modelDescription/` of the
    /// repository.
    pub fn keeps_descriptions(&self, folder: &Path) -> bool {
        !self.is_installed && self.descriptions().canonicalize().is_ok_and(|own| own == folder)
    }

    /// Default folder for FMUs. It does not depend on `CARGO_TARGET_DIR`.
    pub fn fmu_folder(&self) -> PathBuf {
        self.output("fmu")
    }

    /// Default folder for results of this kind: in `target/` of the repository, or the present folder for an installed
    /// program.
    pub fn output(&self, kind: &str) -> PathBuf {
        if self.is_installed { PathBuf::from(".") } else { self.target(kind) }
    }

    /// A folder for intermediate data: Python's virtual environments, data of benchmarks. For an installed program it
    /// is in the user's data folder.
    pub fn target(&self, name: &str) -> PathBuf {
        let folder = match self.is_installed {
            true => dirs::cache_dir().unwrap_or_else(env::temp_dir).join(installed::PROGRAM),
            false => self.root.join("target"),
        };
        folder.join(name)
    }

    /// The command line of the wheel, with its settings.
    pub fn wheel(&self) -> PathBuf {
        self.root.join("fmu-build").join("wheel")
    }

    /// The Python tests, with their requirements and settings.
    pub fn python_tests(&self) -> PathBuf {
        self.root.join("tests").join("fmpy")
    }

    /// The tests of the Python module, with their requirements.
    pub fn module_tests(&self) -> PathBuf {
        self.root.join("tests").join("python")
    }

    /// The tests of pages in a browser, with their requirements.
    pub fn browser_tests(&self) -> PathBuf {
        self.root.join("tests").join("browser")
    }

    /// The Python scripts of the demo.
    pub fn python_scripts(&self) -> PathBuf {
        self.root.join("fmu-build").join("python")
    }

    /// Measured results, the programs that measure and draw them, and the report on the papers.
    pub fn validation(&self) -> PathBuf {
        self.root.join("validation")
    }

    /// Mechanisms at which other programs fail, with their films.
    pub fn gallery(&self) -> PathBuf {
        self.root.join("docs").join("gallery")
    }

    /// The committed results of the benchmarks.
    pub fn results(&self) -> PathBuf {
        self.validation().join("results")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;
    use fmu_cli::Cli;

    #[test]
    fn an_installation_without_its_files_is_rejected() {
        let message = Workspace::installed(Path::new("/nowhere/linkage_fmu")).err().unwrap().to_string();
        assert!(
            message.starts_with("/nowhere/linkage_fmu: ") && message.contains("install the wheel again"),
            "{message}"
        );
    }

    #[test]
    fn an_installation_rejects_commands_that_need_the_source() {
        let installation = Workspace { root: PathBuf::from("/nowhere"), is_installed: true };
        let serves = |workspace: &Workspace, words: &[&str]| {
            let line = ["linkage-fmu"].iter().chain(words);
            workspace.serves(&Cli::try_parse_from(line).unwrap().task).map_err(|error| error.to_string())
        };
        for words in [&["test"][..], &["bench"], &["demo", "--gallery"], &["report"], &["dist"]] {
            let message = serves(&installation, words).unwrap_err();
            let named = words.join(" ");
            assert!(message.contains(&format!("run `cargo fmu {named}` in a checked-out repository")), "{message}");
            serves(&Workspace::locate(), words).unwrap();
        }
        serves(&installation, &["package"]).unwrap();
        serves(&installation, &["demo"]).unwrap();
        assert_eq!(installation.output("fmu"), Path::new("."));
        assert!(!installation.keeps_descriptions(&installation.descriptions()));
        assert!(!installation.target("venv-cluster").starts_with("/nowhere"));
    }
}
