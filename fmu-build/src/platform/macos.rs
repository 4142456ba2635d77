//! Libraries for macOS, linked by the linker that comes with Rust.
//!
//! zig's linker passes over the list of what a library exports, so that Rust's standard library would be exported too.
//! Rust's linker keeps to the list and signs what is for ARM, which runs nothing else. It lacks the names of the
//! system's functions: zig's package has them. In: that package. Out: variables and arguments for Cargo.
use super::{answer, asked, zig};
use crate::files;
use crate::workspace::Workspace;
use anyhow::{Context, Result, bail};
use std::env::consts::EXE_SUFFIX;
use std::ffi::OsString;
use std::fs;
use std::path::Path;

/// Rust does not strip: for that it needs a program that not every Rust has, and on ARM the signature would have to
/// follow. The linker does.
pub const STRIPPED_BY_LINKER: [&str; 4] = [
    "--config",
    "profile.release.package.linkage-fmu-exports.strip=\"none\"",
    "--config",
    "profile.release.package.linkage-fmu-exports-hydraulics.strip=\"none\"",
];

/// Further flags of Rust: no symbols but those that are exported, and no path of this machine as the library's name.
#[cfg(target_os = "macos")]
pub const FLAGS: &str = " -Clink-arg=-Wl,-S,-x,-install_name,@rpath/FMU.dylib";
/// Further flags of Rust: its own linker, no symbols but those that are exported, and no path of this machine as the
/// library's name.
#[cfg(not(target_os = "macos"))]
pub const FLAGS: &str = " -Clinker=rust-lld -Clinker-flavor=ld64.lld -Clink-arg=-S -Clink-arg=-x \
                         -Clink-arg=-install_name -Clink-arg=@rpath/FMU.dylib";

/// Libraries of the system by the names under which Rust asks for them; all are one file. Nothing of iconv is called.
const NAMES: [&str; 4] = ["libSystem.tbd", "libc.tbd", "libm.tbd", "libiconv.tbd"];
/// The second version of a processor, which no linker of Rust knows, and the one that libraries are built for.
const PROCESSORS: [&str; 2] = ["arm64e.x1-", "arm64-"];
/// Prints where the names of the system's functions are.
const PLACE: &str =
    "import pathlib, ziglang; print(pathlib.Path(ziglang.__file__).with_name('lib') / 'libc/darwin/libSystem.tbd')";

/// Variable for Cargo with the place of the system's libraries; none on macOS, which has them.
///
/// # Errors
/// Rust came without its linker; zig cannot be installed.
pub fn libraries(workspace: &Workspace) -> Result<Option<(String, OsString)>> {
    if cfg!(target_os = "macos") {
        return Ok(None);
    }
    let linker = asked(&["--print", "target-libdir"])?.with_file_name("bin").join(format!("rust-lld{EXE_SUFFIX}"));
    if !linker.is_file() {
        bail!("Rust came without its linker rust-lld; install Rust by rustup, whose toolchains have this linker");
    }
    let root = workspace.target("macos");
    write_names(&answer(zig(workspace)?, &["-c", PLACE])?, &root)?;
    Ok(Some(("SDKROOT".to_owned(), root.into())))
}

/// The names of the system's functions where a linker looks for them.
fn write_names(source: &Path, root: &Path) -> Result<()> {
    let text = fs::read_to_string(source).with_context(|| format!("{}: cannot be read", source.display()))?;
    let text = text.replace(PROCESSORS[0], PROCESSORS[1]);
    NAMES.iter().try_for_each(|name| files::replace(&root.join("usr/lib").join(name), text.as_bytes()))
}
