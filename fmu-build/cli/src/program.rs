//! The two programs for the tasks of `cargo fmu`.
//!
//! In: a task. Out: the program of the task. The second program needs additional crates for tables, plots and samples.
//! It is built when one of its tasks is called.

use crate::Task;

/// A program for tasks. It has the name of its package.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Program {
    /// Checks and shows mechanisms, and packs mechanisms as FMUs.
    Packer,
    /// Runs, imports and studies mechanisms. The program also contains the commands that check, show and pack
    /// mechanisms.
    Studies,
}

impl Program {
    /// Name of the package and of the program.
    pub fn name(self) -> &'static str {
        match self {
            Self::Packer => "fmu-build",
            Self::Studies => "fmu-studies",
        }
    }

    /// Usual time of the first build.
    pub fn time(self) -> &'static str {
        match self {
            Self::Packer => "about two minutes",
            Self::Studies => "about one minute more than fmu-build",
        }
    }
}

impl Task {
    /// The program that does this task.
    pub fn program(&self) -> Program {
        match self {
            Self::Simulate(_) | Self::Import(_) | Self::Linearise(_) | Self::Sweep(_) | Self::Optimise(_) => {
                Program::Studies
            }
            Self::Demo(demo) if demo.gallery => Program::Studies,
            Self::View(view) if view.live => Program::Studies,
            _ => Program::Packer,
        }
    }

    /// Whether this task is a demo, which runs an FMU through FMPy.
    pub fn is_demo(&self) -> bool {
        matches!(self, Self::Demo(demo) if !demo.gallery)
    }
}
