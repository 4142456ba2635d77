//! The shared libraries of the FMUs: one for mechanisms without hydraulics and states of controllers, one for
//! all other models.

pub mod served;
pub mod sources;

use crate::binary;
use crate::command;
use crate::workspace::Workspace;
use anyhow::{Context, Result, bail};
use serde_json::Value;
use served::SharedLibrary;
use std::env::consts::DLL_EXTENSION;
use std::ffi::OsString;
use std::fs;
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// The package of the running program. Built together with it, the library shares the compiled engine. Built alone, the
/// library might need other features of the dependencies, and everything would be compiled again.
const PROGRAM: &str = env!("CARGO_PKG_NAME");

/// Build settings for another machine.
#[derive(Debug)]
pub struct Target {
    /// Cargo's subcommand: `build`, or a subcommand that links differently.
    pub subcommand: &'static str,
    /// Rust's name for the machine, in the form for this subcommand.
    pub triple: String,
    /// Extension of its shared libraries.
    pub extension: &'static str,
    /// Further arguments for Cargo.
    pub arguments: Vec<&'static str>,
    /// Environment variables for Cargo.
    pub variables: Vec<(String, OsString)>,
}

/// Build a library in release mode and read it. With `target` it is built for another machine.
///
/// # Errors
/// The build fails, or its output names no shared library.
pub fn build(workspace: &Workspace, library: &SharedLibrary, target: Option<&Target>) -> Result<Vec<u8>> {
    let package = library.package;
    let extension = target.map_or(DLL_EXTENSION, |target| target.extension);
    let mut cargo = command(workspace, library, target);
    let output = cargo.output().with_context(|| command::cannot_start(&cargo, "cargo build"))?;
    let what = target.map_or_else(|| package.to_owned(), |target| format!("{package} for {}", target.triple));
    if !output.status.success() {
        bail!("cargo build of {what} failed ({}); the messages above state the reason", output.status);
    }
    let path = artifact(&String::from_utf8_lossy(&output.stdout), library.name, extension).with_context(|| {
        format!("cargo build of {what} wrote no .{extension}; check that [lib] crate-type is cdylib")
    })?;
    let mut content = fs::read(&path).with_context(|| format!("{}: cannot be read", path.display()))?;
    sources::leave_out(&mut content, &sources::folder()?);
    binary::exports_fmi_only(&content).with_context(|| format!("{}: cannot be packed", path.display()))?;
    Ok(content)
}

/// The call of Cargo that builds a library. `target` is as for [`build`].
pub fn command(workspace: &Workspace, library: &SharedLibrary, target: Option<&Target>) -> Command {
    let mut cargo = command::cargo(workspace);
    cargo.arg(target.map_or("build", |target| target.subcommand));
    cargo.args(["--release", "--message-format=json-render-diagnostics"]).stderr(Stdio::inherit());
    match target {
        None => cargo.args(["--package", PROGRAM, "--package", library.package]),
        Some(target) => {
            cargo.args(["--package", library.package, "--lib", "--target", &target.triple]);
            cargo.args(&target.arguments).envs(target.variables.iter().cloned())
        }
    };
    cargo
}

/// The path of the library with this name and extension in Cargo's messages, one JSON object per line.
pub fn artifact(messages: &str, name: &str, extension: &str) -> Option<PathBuf> {
    messages
        .lines()
        .filter_map(|line| serde_json::from_str::<Value>(line).ok())
        .filter(|message| message["reason"] == "compiler-artifact" && message["target"]["name"] == name)
        .flat_map(|message| message["filenames"].as_array().cloned().unwrap_or_default())
        .filter_map(|name| name.as_str().map(PathBuf::from))
        .find(|path| path.extension().is_some_and(|other| other == extension))
}

#[cfg(test)]
mod tests {
    use super::*;
    use served::MECHANISMS;

    #[test]
    fn the_library_is_found_among_cargos_messages() {
        let messages = concat!(
            "{\"reason\":\"compiler-artifact\",\"target\":{\"name\":\"libc\"},\"filenames\":[\"/t/libc.dll\"]}\n",
            "not JSON\n",
            "{\"reason\":\"compiler-artifact\",\"target\":{\"name\":\"linkage_fmu_exports\"},",
            "\"filenames\":[\"/t/x.rlib\",\"/t/x.dll.a\",\"/t/x.dll\"]}\n",
            "{\"reason\":\"build-finished\",\"success\":true}\n"
        );
        assert_eq!(artifact(messages, MECHANISMS.name, "dll"), Some(PathBuf::from("/t/x.dll")));
        assert_eq!(artifact(messages, MECHANISMS.name, "so"), None);
        assert_eq!(artifact("{\"reason\":\"build-finished\"}", MECHANISMS.name, "dll"), None);
    }
}
