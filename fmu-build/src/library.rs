//! The shared library that goes into every FMU.

use crate::binary;
use crate::command;
use crate::version::Version;
use crate::workspace::Workspace;
use anyhow::{Context, Result, bail};
use serde_json::Value;
use std::env::consts::{ARCH, DLL_EXTENSION, OS};
use std::fs;
use std::path::PathBuf;
use std::process::Stdio;

/// Cargo's name for the engine's package.
const PACKAGE: &str = "linkage-fmu";
/// The package that is built: this one. The library comes with it as a dependency, already there when this program
/// runs; built for itself it would be compiled anew each time, because Cargo gives both the same file.
const BUILT: &str = env!("CARGO_PKG_NAME");

/// This platform's name, after FMI 2.0.5, 2.3.
///
/// # Errors
/// FMI 2.0 has no name for this operating system.
pub fn platform() -> Result<&'static str> {
    Ok(match OS {
        "linux" => "linux64",
        "windows" => "win64",
        "macos" => "darwin64",
        other => bail!("{other}: FMI 2.0 names no folder for this system; build on Linux, Windows or macOS"),
    })
}

/// This platform's name, after FMI 3.0.2, 2.5.1.4: architecture and system.
pub fn tuple() -> String {
    let system = if OS == "macos" { "darwin" } else { OS };
    format!("{ARCH}-{system}")
}

/// Path of the library in an FMU of this version.
///
/// # Errors
/// As for [`Version::platform`].
pub fn path(version: Version, model_identifier: &str) -> Result<String> {
    Ok(format!("binaries/{}/{model_identifier}.{DLL_EXTENSION}", version.platform()?))
}

/// Build the library in release and read it.
///
/// # Errors
/// The build fails, or it names no shared library.
pub fn build(workspace: &Workspace) -> Result<Vec<u8>> {
    let mut cargo = command::cargo(workspace);
    cargo
        .args(["build", "--release", "--package", BUILT, "--message-format=json-render-diagnostics"])
        .stderr(Stdio::inherit());
    let output = cargo.output().with_context(|| command::cannot_start(&cargo, "cargo build"))?;
    if !output.status.success() {
        bail!("cargo build of {PACKAGE} failed ({}); its own messages stand above", output.status);
    }
    let path = artifact(&String::from_utf8_lossy(&output.stdout))
        .with_context(|| format!("cargo build of {PACKAGE} made no .{DLL_EXTENSION}; has [lib] crate-type cdylib?"))?;
    let content = fs::read(&path).with_context(|| format!("{}: cannot be read", path.display()))?;
    binary::exports_fmi_only(&content).with_context(|| format!("{}: cannot be packed", path.display()))?;
    Ok(content)
}

/// The shared library among Cargo's messages, one JSON object a line.
fn artifact(messages: &str) -> Option<PathBuf> {
    messages
        .lines()
        .filter_map(|line| serde_json::from_str::<Value>(line).ok())
        .filter(|message| message["reason"] == "compiler-artifact" && message["target"]["name"] == "linkage_fmu")
        .flat_map(|message| message["filenames"].as_array().cloned().unwrap_or_default())
        .filter_map(|name| name.as_str().map(PathBuf::from))
        .find(|path| path.extension().is_some_and(|extension| extension == DLL_EXTENSION))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_library_is_found_among_cargos_messages() {
        let messages = format!(
            concat!(
                "{{\"reason\":\"compiler-artifact\",\"target\":{{\"name\":\"libc\"}},\"filenames\":[\"/t/libc.{0}\"]}}\n",
                "not JSON\n",
                "{{\"reason\":\"compiler-artifact\",\"target\":{{\"name\":\"linkage_fmu\"}},",
                "\"filenames\":[\"/t/x.rlib\",\"/t/x.{0}\"]}}\n",
                "{{\"reason\":\"build-finished\",\"success\":true}}\n"
            ),
            DLL_EXTENSION
        );
        assert_eq!(artifact(&messages), Some(PathBuf::from(format!("/t/x.{DLL_EXTENSION}"))));
        assert_eq!(artifact("{\"reason\":\"build-finished\"}"), None);
    }

    #[test]
    fn the_library_has_no_prefix() {
        let path = path(Version::Two, "Gear").unwrap();
        assert!(path.starts_with("binaries/") && path.ends_with(&format!("/Gear.{DLL_EXTENSION}")), "{path}");
    }
}
