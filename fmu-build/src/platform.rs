//! The platforms whose libraries can be built here, and the missing parts for other platforms. An installed program
//! uses the libraries that it contains.
//!
//! In: the requested platforms. Out: a library for each, or a line with the reason and the remedy for each missing one.

mod macos;
mod toolchain;

use crate::binary::{ARM_LINUX, Binary, COMPATIBLE};
use crate::library::served::SharedLibrary;
use crate::library::{self, Target, sources};
use crate::needs::{self, Needs};
use crate::workspace::Workspace;
use crate::{command, prebuilt, version};
use anyhow::{Context, Result, bail};
use fmu_cli::{Package as Arguments, Platform};
use std::env;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use toolchain::{ARM, TOOLCHAINS, Toolchain, X86_LINUX, toolchain};

/// Folder of a platform's library in FMUs of FMI 2.0.
pub fn folder(platform: Platform) -> &'static str {
    toolchain(platform).folder
}

/// The requested platforms without duplicates. Empty for this machine alone.
fn wanted(arguments: &Arguments) -> Vec<&'static Toolchain> {
    let mut wanted: Vec<&Toolchain> = Vec::new();
    for toolchain in arguments.platforms.iter().map(|platform| toolchain(*platform)) {
        if !wanted.iter().any(|other| other.tuple == toolchain.tuple) {
            wanted.push(toolchain);
        }
    }
    wanted
}

/// Folders of the built libraries in FMUs of FMI 2.0.
///
/// # Errors
/// Two libraries for one folder; `--compatible` without a library for ARM; FMI 2.0 has no name for this system.
pub fn folders(arguments: &Arguments) -> Result<Vec<&'static str>> {
    let wanted = wanted(arguments);
    if wanted.is_empty() {
        return Ok(vec![version::platform()?]);
    }
    let mut folders: Vec<_> = wanted.iter().map(|toolchain| toolchain.folder).collect();
    // One file of macOS contains the libraries of both processors.
    folders.dedup();
    if arguments.compatible {
        let Some(arm) = folders.iter_mut().find(|folder| **folder == ARM_LINUX) else {
            bail!(
                "--compatible applies to the library for ARM; add {ARM_LINUX} to --platforms, or remove --compatible"
            );
        };
        *arm = COMPATIBLE;
        if wanted.iter().any(|toolchain| toolchain.folder == COMPATIBLE) {
            bail!(
                "--compatible: the folder binaries/{COMPATIBLE} of an FMU can contain only one library, and the \
                 library for x86_64-linux is already in this folder; build two FMUs, one of them with --platforms \
                 {ARM_LINUX} --compatible"
            );
        }
    }
    Ok(folders)
}

/// Source of a library.
enum Way {
    /// Built here, with a target for another machine.
    Built(Option<Target>),
    /// Prebuilt, in the installation in this folder.
    Taken(PathBuf),
}

/// Build a library for each requested platform, or read the library of the installation. With `--available`, missing
/// platforms are omitted.
///
/// # Errors
/// A platform cannot be built here or is not in the installation, reported for all platforms before anything is built;
/// a build fails.
pub fn build(
    workspace: &Workspace,
    arguments: &Arguments,
    libraries: &[&'static SharedLibrary],
) -> Result<Vec<Binary>> {
    let mut wanted = wanted(arguments);
    if wanted.is_empty() {
        match (arguments.glibc.as_deref(), [&X86_LINUX, &ARM].into_iter().find(|own| own.tuple == version::tuple())) {
            (None, _) => return libraries.iter().map(|library| own(workspace, library)).collect(),
            (Some(_), Some(own)) => wanted.push(own),
            (Some(_), None) => {}
        }
    }
    if let Some(version) = arguments.glibc.as_deref().filter(|_| !wanted.iter().any(|toolchain| toolchain.is_linux())) {
        bail!("--glibc {version} applies to libraries for Linux, but none is built; add --platforms x86_64-linux");
    }
    let mut missing = Vec::new();
    let mut targets = Vec::new();
    for toolchain in wanted.drain(..) {
        let glibc = arguments.glibc.as_deref();
        let way = match workspace.installation() {
            Some(root) => prebuilt::archive(root, toolchain.folder).map(|_| Way::Taken(root.to_path_buf())),
            None => target(workspace, toolchain, glibc).map(Way::Built).context("cannot be built here"),
        };
        match way {
            Ok(way) => targets.push((toolchain, way)),
            Err(reason) => missing.push(format!("{}: {reason:#}", toolchain.tuple)),
        }
    }
    if !missing.is_empty() && (!arguments.available || targets.is_empty()) {
        let more = if arguments.available { "" } else { "; or add --available to pack the other platforms" };
        bail!("nothing was packed: {}{more}", missing.join("\n"));
    }
    missing.iter().for_each(|line| println!("left out: {line}"));
    let build = |toolchain: &Toolchain, way: &Way, index: usize| -> Result<Binary> {
        let library = libraries[index];
        let content = match way {
            Way::Built(target) => library::build(workspace, library, target.as_ref())?,
            Way::Taken(root) => prebuilt::content(root, library, toolchain.folder)?,
        };
        // A library for this machine only may need any library of this machine.
        if !matches!(way, Way::Built(None)) {
            check_portable(&content, arguments.glibc.as_deref())
                .with_context(|| format!("the library for {}", toolchain.tuple))?;
        }
        let binary = Binary::new(toolchain.folder, content, toolchain.triple)?.of(library);
        Ok(if arguments.compatible && toolchain.folder == ARM_LINUX { binary.compatible() } else { binary })
    };
    let all = targets.iter().flat_map(|target| (0..libraries.len()).map(move |index| (target, index)));
    let mut binaries: Vec<Binary> = Vec::new();
    for ((toolchain, way), index) in all {
        let binary = build(toolchain, way, index)?;
        match binaries.iter_mut().find(|other| other.shares_file(&binary)) {
            Some(other) => other.join(binary)?,
            None => binaries.push(binary),
        }
    }
    Ok(binaries)
}

/// The library for this machine, in the folder in which its importers look.
fn own(workspace: &Workspace, library: &'static SharedLibrary) -> Result<Binary> {
    let content = match workspace.installation() {
        Some(root) => {
            let folder = if version::tuple() == ARM.tuple { ARM.folder } else { version::platform()? };
            prebuilt::content(root, library, folder)?
        }
        None => {
            let toolchain = TOOLCHAINS.into_iter().find(|toolchain| toolchain.tuple == version::tuple());
            let target = toolchain.map_or(Ok(None), |toolchain| target(workspace, toolchain, None))?;
            library::build(workspace, library, target.as_ref())?
        }
    };
    if version::tuple() == ARM.tuple {
        return Ok(Binary::new(ARM.folder, content, ARM.triple)?.of(library).compatible());
    }
    Ok(Binary::new(version::platform()?, content, "this machine's library")?.of(library))
}

/// Arguments for `cargo rustc` with which Rust omits unused functions itself, because the linker cannot: Rust optimises
/// the library as a whole (LTO). Rust can do so for a `cdylib` alone, not together with an rlib.
const WITHOUT_UNUSED: [&str; 4] = ["--crate-type", "cdylib", "--config", "profile.release.lto=\"fat\""];
/// Arguments for Cargo with which the standard library is compiled. It is optimised, unlike most other dependencies.
const STANDARD_LIBRARY: [&str; 3] =
    ["-Zbuild-std=std,panic_abort", "--config", "profile.release.package.\"*\".opt-level=3"];

/// The build target of the library for a platform. None for this machine, if Cargo's normal build suffices.
///
/// # Errors
/// The missing part, with the command that installs it.
fn target(workspace: &Workspace, toolchain: &Toolchain, glibc: Option<&str>) -> Result<Option<Target>> {
    let &Toolchain { triple, extension, .. } = toolchain;
    let glibc = glibc.filter(|_| toolchain.is_linux());
    if glibc.is_none() && toolchain.is_built_plainly(&version::tuple()) {
        return Ok(None);
    }
    let (subcommand, linked) = match toolchain.linker {
        None => ("build", macos::libraries(workspace)),
        Some(named) if glibc.is_none() => ("build", linker(triple, named).map(Some)),
        Some(_) => ("zigbuild", path_with_zig(workspace).map(|path| Some(("PATH".to_owned(), path)))),
    };
    let (arguments, linked) = both(standard_library(triple, toolchain.debian), linked)?;
    let triple = glibc.map_or_else(|| triple.to_owned(), |glibc| format!("{triple}.{glibc}"));
    let variables = linked.into_iter().chain([sources::variable(toolchain.triple)?]).collect();
    let mut target = Target { subcommand, triple, extension, arguments, variables };
    if toolchain.linker.is_none() {
        macos::complete(&mut target, cfg!(target_os = "macos"));
    }
    if toolchain.is_in_one_section() {
        target.subcommand = "rustc";
        target.arguments.extend(WITHOUT_UNUSED);
    }
    Ok(Some(target))
}

/// Both parts of a toolchain.
///
/// # Errors
/// All missing parts.
fn both<A, B>(first: Result<A>, second: Result<B>) -> Result<(A, B)> {
    match (first, second) {
        (Ok(first), Ok(second)) => Ok((first, second)),
        (Err(first), Err(second)) => bail!("{first:#}; {second:#}"),
        (Err(error), _) | (_, Err(error)) => Err(error),
    }
}

/// The path on which Cargo finds zig and the subcommand that links with zig.
///
/// # Errors
/// zig and the subcommand cannot be installed from PyPI.
pub fn path_with_zig(workspace: &Workspace) -> Result<OsString> {
    let python = zig(workspace)?;
    let folder = python.parent().map(Path::to_path_buf).into_iter();
    Ok(env::join_paths(folder.chain(env::split_paths(&env::var_os("PATH").unwrap_or_default())))?)
}

/// Interpreter of the environment with zig.
fn zig(workspace: &Workspace) -> Result<PathBuf> {
    let requirements = workspace.python_scripts().join("zig").join("requirements.txt");
    command::environment(&workspace.target("venv-zig"), &requirements).context("zig")
}

/// Rust's name for this machine, which the linker needs for `--glibc`.
///
/// # Errors
/// Libraries for Linux are not built for this machine.
pub fn own_triple() -> Result<&'static str> {
    let own = [&X86_LINUX, &ARM].into_iter().find(|own| own.tuple == version::tuple());
    own.map(|own| own.triple)
        .with_context(|| format!("--glibc applies to Linux, but this machine is {}", version::tuple()))
}

/// The platform of this machine whose library has a separate folder in FMI 2.0, if it has another folder by default.
pub fn own_by_name() -> Option<Platform> {
    (version::tuple() == ARM.tuple).then_some(Platform::ArmLinux)
}

/// Check that a library for other machines needs nothing special from them.
fn check_portable(content: &[u8], glibc: Option<&str>) -> Result<()> {
    suffices(&Needs::of(content)?, glibc)
}

fn suffices(needs: &Needs, glibc: Option<&str>) -> Result<()> {
    if let (Some(needed), Some(asked)) = (&needs.glibc, glibc)
        && needs::parts(asked) < needs::parts(needed)
    {
        let functions = needs.functions.join(", ");
        bail!(
            "the library needs glibc {needed} (for {functions}), but --glibc {asked} was given; write --glibc {needed}"
        );
    }
    if let [first, ..] = &needs.libraries[..] {
        bail!(
            "the library needs {first}, which Windows does not have; link this library statically (rustflags -C \
             target-feature=+crt-static)"
        );
    }
    Ok(())
}

/// Arguments for Cargo with which the standard library is available. None if it is installed. A Rust with unstable
/// options can compile it, if its source is installed.
///
/// # Errors
/// Neither is installed. `debian` describes the packages for Debian's own Rust.
pub fn standard_library(triple: &str, debian: &str) -> Result<Vec<&'static str>> {
    // A toolchain that does not know the machine has no folder for it either.
    if asked(&["--print", "target-libdir", "--target", triple]).is_ok_and(|folder| has_standard_library(&folder)) {
        return Ok(Vec::new());
    }
    let takes_unstable = env::var_os("RUSTC_BOOTSTRAP").is_some_and(|value| value == "1")
        || asked(&["--version"])?.to_string_lossy().contains("nightly");
    let source = asked(&["--print", "sysroot"])?.join("lib/rustlib/src/rust/library/std/Cargo.toml");
    if takes_unstable && source.is_file() {
        return Ok(STANDARD_LIBRARY.to_vec());
    }
    bail!("Rust has no standard library for {triple}; run: rustup target add {triple}{debian}")
}

/// Whether a target is this machine.
///
/// # Errors
/// rustc cannot be started.
pub fn is_this_machine(triple: &str) -> Result<bool> {
    Ok(asked(&["--print", "host-tuple"])?.as_os_str() == triple)
}

/// The answer of rustc as a path.
fn asked(arguments: &[&str]) -> Result<PathBuf> {
    answer(env::var_os("RUSTC").unwrap_or_else(|| "rustc".into()), arguments)
}

/// The answer of a program as a path.
fn answer(program: impl Into<OsString>, arguments: &[&str]) -> Result<PathBuf> {
    let program = program.into();
    let name = Path::new(&program).file_name().unwrap_or_default().display();
    let output = Command::new(&program)
        .args(arguments)
        .stderr(Stdio::null())
        .output()
        .with_context(|| format!("{name} cannot be started; check that it is installed"))?;
    if !output.status.success() {
        bail!("{name} {} failed ({})", arguments.join(" "), output.status);
    }
    Ok(PathBuf::from(String::from_utf8_lossy(&output.stdout).trim()))
}

fn has_standard_library(folder: &Path) -> bool {
    let names = folder.read_dir().into_iter().flatten().flatten().map(|entry| entry.file_name());
    names.into_iter().any(|name| name.to_string_lossy().starts_with("libstd-"))
}

/// Cargo's variable for the linker of a machine, with the installed linker.
fn linker(triple: &str, (linker, package): (&str, &str)) -> Result<(String, OsString)> {
    let variable = format!("CARGO_TARGET_{}_LINKER", triple.to_uppercase().replace('-', "_"));
    let named = env::var(&variable).ok().filter(|name| !name.is_empty());
    let program = named.unwrap_or_else(|| linker.to_owned());
    let started = Command::new(&program).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
    if started.is_err() {
        bail!(
            "the linker {program} cannot be started; install this linker (Debian: apt-get install \
             {package}), or set another linker in {variable}"
        );
    }
    Ok((variable, program.into()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::binary::MAC;
    use crate::library::served;

    fn asking(platforms: &[Platform], compatible: bool) -> Arguments {
        Arguments { platforms: platforms.to_vec(), compatible, ..Default::default() }
    }

    #[test]
    fn each_platform_has_its_folder_once() {
        use Platform::{ArmLinux, ArmMac, X86Linux, X86Mac, X86Windows};
        assert_eq!(folders(&asking(&[], false)).unwrap(), [version::platform().unwrap()]);
        let all = asking(&[ArmLinux, X86Windows, X86Linux, X86Windows], false);
        assert_eq!(folders(&all).unwrap(), ["aarch64-linux", "win64", "linux64"]);
        assert_eq!(folders(&asking(&[X86Windows, ArmLinux], true)).unwrap(), ["win64", "linux64"]);
        assert_eq!(folders(&asking(&[X86Mac, ArmMac], false)).unwrap(), [MAC]);
    }

    #[test]
    fn a_library_that_needs_a_newer_platform_than_requested_is_rejected() {
        let needs = Needs { glibc: Some("2.35".into()), functions: vec!["hypot".into()], ..Needs::default() };
        let message = suffices(&needs, Some("2.17")).unwrap_err().to_string();
        assert!(message.contains("glibc 2.35 (for hypot), but --glibc 2.17 was given"), "{message}");
        assert!(suffices(&needs, Some("2.100")).is_ok() && suffices(&needs, None).is_ok());
        let needs = Needs { libraries: vec!["libgcc_s_seh-1.dll".into()], ..Needs::default() };
        assert!(
            suffices(&needs, None).unwrap_err().to_string().contains("libgcc_s_seh-1.dll, which Windows does not have")
        );
    }

    #[test]
    fn an_old_glibc_for_windows_alone_is_rejected() {
        let arguments = Arguments { glibc: Some("2.17".into()), ..asking(&[Platform::X86Windows], false) };
        let message = build(&Workspace::locate(), &arguments, &[&served::MECHANISMS]).unwrap_err().to_string();
        assert!(message.contains("--glibc 2.17 applies to libraries for Linux"), "{message}");
    }

    /// The folder `linux64` cannot contain the libraries of two processors.
    #[test]
    fn two_libraries_in_one_folder_are_rejected() {
        let refused = |platforms: &[Platform]| folders(&asking(platforms, true)).unwrap_err().to_string();
        assert!(refused(&[Platform::ArmLinux, Platform::X86Linux]).contains("build two FMUs"));
        assert!(refused(&[Platform::X86Windows]).contains("add aarch64-linux to --platforms"));
    }

    #[test]
    fn a_missing_toolchain_is_an_error_with_the_remedy() {
        let named = ("no-such-linker", "gcc-aarch64-linux-gnu");
        let toolchain = Toolchain { tuple: "no", triple: "no-such-machine", linker: Some(named), ..ARM };
        let message = target(&Workspace::locate(), &toolchain, None).unwrap_err().to_string();
        assert!(message.contains("apt-get install gcc-aarch64-linux-gnu"), "{message}");
        assert!(message.contains("CARGO_TARGET_NO_SUCH_MACHINE_LINKER"), "{message}");
        if env::var_os("RUSTC_BOOTSTRAP").is_none() {
            assert!(message.contains("rustup target add no-such-machine"), "both are named at once: {message}");
        }
        assert_eq!(both(Ok(1), Ok("a")).unwrap(), (1, "a"));
        assert_eq!(both::<(), _>(Err(anyhow::anyhow!("one")), Ok(1)).unwrap_err().to_string(), "one");
    }
}
