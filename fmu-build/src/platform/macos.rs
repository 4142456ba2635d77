//! Libraries for macOS, linked by the linker that comes with Rust.
//!
//! zig's linker ignores the list of exports, so that the library would also export Rust's standard library. Rust's
//! linker uses the list, and signs libraries for ARM, which loads signed libraries only. It lacks the names of the
//! system functions, which zig's package contains. In: this package. Out: variables and arguments for Cargo.
use super::{answer, asked, zig};
use crate::files;
use crate::library::Target;
use crate::workspace::Workspace;
use anyhow::{Context, Result, bail};
use std::env::consts::EXE_SUFFIX;
use std::ffi::OsString;
use std::fs;
use std::path::Path;

/// Rust does not strip the library: this needs a program that not every Rust has, and on ARM the library would have to
/// be signed again. The linker strips it.
const STRIPPED_BY_LINKER: [&str; 4] = [
    "--config",
    "profile.release.package.linkage-fmu-exports.strip=\"none\"",
    "--config",
    "profile.release.package.linkage-fmu-exports-hydraulics.strip=\"none\"",
];
/// Flags of Rust on macOS: only exported symbols, and a library name without a path of this machine.
const ON_MACOS: &str = " -Clink-arg=-Wl,-S,-x,-install_name,@rpath/FMU.dylib";
/// The same flags on other systems, for Rust's own linker.
const ELSEWHERE: &str = " -Clinker=rust-lld -Clinker-flavor=ld64.lld -Clink-arg=-S -Clink-arg=-x \
                         -Clink-arg=-install_name -Clink-arg=@rpath/FMU.dylib";

/// Add the flags that omit symbols and paths of this machine to the build of a library for macOS.
pub fn complete(target: &mut Target, is_on_macos: bool) {
    target.arguments.extend(STRIPPED_BY_LINKER);
    // The last variable contains the flags of Rust.
    if let Some((_, flags)) = target.variables.last_mut() {
        flags.push(if is_on_macos { ON_MACOS } else { ELSEWHERE });
    }
}

/// Libraries of the system, by the names that Rust uses. All of them are one file. No function of iconv is called.
const NAMES: [&str; 4] = ["libSystem.tbd", "libc.tbd", "libm.tbd", "libiconv.tbd"];
/// The second version of a processor, which Rust's linkers do not know, and the version for which libraries are built.
const PROCESSORS: [&str; 2] = ["arm64e.x1-", "arm64-"];
/// Prints the folder with the names of the system functions.
const PLACE: &str =
    "import pathlib, ziglang; print(pathlib.Path(ziglang.__file__).with_name('lib') / 'libc/darwin/libSystem.tbd')";

/// Variable for Cargo with the folder of the system libraries. None on macOS, which has these libraries.
///
/// # Errors
/// Rust has no linker of its own, or zig cannot be installed.
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

/// Write the names of the system functions into the folder in which the linker looks.
fn write_names(source: &Path, root: &Path) -> Result<()> {
    let text = fs::read_to_string(source).with_context(|| format!("{}: cannot be read", source.display()))?;
    let text = text.replace(PROCESSORS[0], PROCESSORS[1]);
    NAMES.iter().try_for_each(|name| files::replace(&root.join("usr/lib").join(name), text.as_bytes()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::library::{self, served, sources};

    /// The command line on a Mac, for its own processor and for the other processor.
    #[test]
    fn a_library_for_macos_has_neither_names_nor_paths() {
        for is_on_macos in [true, false] {
            let mut target = Target {
                subcommand: "build",
                triple: "aarch64-apple-darwin".to_owned(),
                extension: "dylib",
                arguments: Vec::new(),
                variables: vec![sources::variable("aarch64-apple-darwin").unwrap()],
            };
            complete(&mut target, is_on_macos);
            let cargo = library::command(&Workspace::locate(), &served::MECHANISMS, Some(&target));
            let words: Vec<_> = cargo.get_args().map(|word| word.to_string_lossy()).collect();
            let words = words.join(" ");
            assert!(words.contains("--lib --target aarch64-apple-darwin --config"), "{words}");
            assert!(words.contains("package.linkage-fmu-exports.strip=\"none\""), "{words}");
            let flags = cargo.get_envs().find(|(name, _)| *name == "CARGO_BUILD_RUSTFLAGS").unwrap().1.unwrap();
            let flags = flags.to_string_lossy();
            assert!(flags.starts_with("--remap-path-prefix=") && flags.contains("=crates -C"), "{flags}");
            assert_eq!(flags.contains("-Wl,-S,-x,-install_name,@rpath/FMU.dylib"), is_on_macos, "{flags}");
            assert_eq!(flags.contains("-Clinker=rust-lld"), !is_on_macos, "{flags}");
        }
    }
}
