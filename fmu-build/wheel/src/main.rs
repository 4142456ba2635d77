//! `linkage-fmu`: the tasks of `cargo fmu` that need no Rust, as `cargo fmu dist` packs them for `pip install`.
use fmu_build::task;
use fmu_build::workspace::Workspace;
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = fmu_cli::installed::parse();
    match Workspace::installed() {
        Ok(workspace) => task::run(&workspace, cli, fmu_studies::task::run),
        Err(error) => task::refused(&error),
    }
}
