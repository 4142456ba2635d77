//! A child process whose output goes straight to the terminal.

use crate::workspace::Workspace;
use anyhow::{Context, Result, bail};
use std::env;
use std::process::Command;

/// Cargo, the one that runs this program, in the repository's top folder.
pub fn cargo(workspace: &Workspace) -> Command {
    let mut command = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(workspace.root());
    command
}

/// Run to the end.
///
/// # Errors
/// The program cannot be started, or it ends with anything but success; `task` names it in the message.
pub fn run(command: &mut Command, task: &str) -> Result<()> {
    let status = command.status().with_context(|| cannot_start(command, task))?;
    if !status.success() {
        bail!("{task} failed ({status}); its own messages stand above");
    }
    Ok(())
}

/// Message for a program that cannot be started.
pub fn cannot_start(command: &Command, task: &str) -> String {
    format!("{task}: {} cannot be started; is it installed and on the PATH?", command.get_program().display())
}
