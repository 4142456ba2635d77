//! Libraries for macOS, linked by the linker that comes with Rust.
//!
//! zig's linker passes over the list of what a library exports, so that Rust's standard library would be exported too.
//! Rust's linker keeps to the list and signs what is for ARM, which runs nothing else. It lacks the names of the
//! system's functions: zig's package has them. In: that package. Out: variables and arguments for Cargo.
use super::{answer, asked, zig};
use crate::files;
use crate::library::Target;
use crate::workspace::Workspace;
use anyhow::{Context, Result, bail};
use std::env::consts::EXE_SUFFIX;
use std::ffi::OsString;
use std::fs;
use std::path::Path;

/// Rust does not strip: for that it needs a program that not every Rust has, and on ARM the signature would have to
/// follow. The linker does.
const STRIPPED_BY_LINKER: [&str; 4] = [
    "--config",
    "profile.release.package.linkage-fmu-exports.strip=\"none\"",
    "--config",
    "profile.release.package.linkage-fmu-exports-hydraulics.strip=\"none\"",
];
/// Flags of Rust on macOS: no symbols but those that are exported, and no path of this machine as the library's name.
const ON_MACOS: &str = " -Clink-arg=-Wl,-S,-x,-install_name,@rpath/FMU.dylib";
/// The same flags elsewhere, for Rust's own linker.
const ELSEWHERE: &str = " -Clinker=rust-lld -Clinker-flavor=ld64.lld -Clink-arg=-S -Clink-arg=-x \
                         -Clink-arg=-install_name -Clink-arg=@rpath/FMU.dylib";

/// Add to the build of a library for macOS, on macOS or elsewhere, what leaves out symbols and paths of this machine.
pub fn complete(target: &mut Target, is_on_macos: bool) {
    target.arguments.extend(STRIPPED_BY_LINKER);
    // The last variable has the flags of Rust.
    if let Some((_, flags)) = target.variables.last_mut() {
        flags.push(if is_on_macos { ON_MACOS } else { ELSEWHERE });
    }
}

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::library::{self, served, sources};

    /// The command line on a Mac, for its own processor as for the other one.
    #[test]
    fn a_library_for_macos_has_neither_names_nor_paths() {
        for is_on_macos in [true, false] {
            let mut target = Target {
                subcommand: "build",
                triple: "aarch64-apple-darwin".to_owned(),
                extension: "dylib",
                arguments: Vec::new(),
                variables: vec![sources::variable().unwrap()],
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
