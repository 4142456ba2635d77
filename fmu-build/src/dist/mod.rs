//! `cargo fmu dist`: builds a Python wheel, so that `pip install` installs the program without Rust and without the
//! repository.
//!
//! In: the command line of `fmu-build/wheel`, the libraries, the parts of the repository that tasks read. Out: the
//! wheel, whose name states a glibc version that suffices for all its files, and the source distribution, from which
//! pip builds the wheel if Rust is installed.

mod source;
mod test;

use crate::archive::BINARIES;
use crate::binary::Binary;
use crate::fmu::Fmu;
use crate::library::{served, sources};
use crate::needs::{self, Needs};
use crate::workspace::{INSTALLED, Workspace};
use crate::{command, files, package, platform, prebuilt};
use anyhow::{Context, Result, bail, ensure};
pub use fmu_cli::Dist as Arguments;
use std::collections::BTreeMap;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Folder of the wheel that pip copies into the environment, as in `pyproject.toml`.
const DATA: &str = "linkage_fmu.data/data";
/// Parts of the repository that tasks read, and the reference of the formats.
const PARTS: [&str; 3] = ["modelDescription", "fmu-build/python", "docs/reference"];
/// Licences of the crates and fonts in the wheel. `fmu-build/src/licenses/notices.rs` writes the file.
const NOTICES: &str = "THIRD-PARTY.txt";
/// Part of a wheel's name for a program that needs the glibc 2.N.
const PROMISE: &str = "manylinux_2_";

/// Build the wheel. With `test` install and test it.
///
/// # Errors
/// A library is not available; Python, its packages or the build fails; the wheel needs a newer glibc than its name
/// states; a command of the wheel fails.
pub fn run(workspace: &Workspace, arguments: &Arguments) -> Result<()> {
    let packing = packing(arguments);
    let binaries = package::libraries(workspace, &packing, &[&served::MECHANISMS, &served::HYDRAULICS])?;
    let stage = workspace.target("wheel");
    if stage.is_dir() {
        fs::remove_dir_all(&stage).with_context(|| format!("{}: cannot be removed", stage.display()))?;
    }
    lay_out(workspace, &stage, &binaries)?;
    let made = build(workspace, &stage, arguments)?;
    let content = fs::read(&made).with_context(|| format!("{}: cannot be read", made.display()))?;
    works_with_named_glibc(&made, &binaries)?;
    has_licences(&made)?;
    let out = arguments.out.clone().unwrap_or_else(|| workspace.target("dist"));
    let wheel = out.join(made.file_name().context("the wheel has no name")?);
    files::replace_named(&wheel, "--out", &content)?;
    let mut platforms: Vec<&str> = binaries.iter().map(Binary::platform).collect();
    platforms.dedup();
    println!("{} ({:.1} MB, libraries: {})", wheel.display(), content.len() as f64 / 1e6, platforms.join(", "));
    if let Some(source) = source::distribution(workspace, &made, &out)? {
        println!("{}", source.display());
    }
    if arguments.test {
        test::run(workspace, &packing, &wheel)?;
    }
    Ok(())
}

/// Arguments of `package` for the libraries.
fn packing(arguments: &Arguments) -> package::Arguments {
    let mut platforms = arguments.platforms.clone();
    if platforms.is_empty() {
        platforms.extend(platform::own_by_name());
    }
    package::Arguments {
        platforms,
        available: arguments.available,
        binaries: arguments.binaries.clone(),
        glibc: arguments.glibc.clone(),
        ..Default::default()
    }
}

/// Write the files from which maturin builds the wheel, except for the program.
fn lay_out(workspace: &Workspace, stage: &Path, binaries: &[Binary]) -> Result<()> {
    let source = workspace.wheel();
    let settings = source.join("pyproject.toml");
    let mut text = fs::read_to_string(&settings).with_context(|| format!("{}: cannot be read", settings.display()))?;
    // The last table is maturin's. Strings of JSON are valid strings of TOML.
    let manifest = source.join("Cargo.toml").display().to_string();
    text.push_str(&format!("manifest-path = {}\n", serde_json::to_string(&manifest)?));
    files::replace(&stage.join("pyproject.toml"), text.as_bytes())?;
    let of_repository = ["LICENSE-MIT", "LICENSE-APACHE"].map(|name| workspace.root().join(name));
    files::copy_all(&source.join("python"), &stage.join("python"))?;
    for file in of_repository.into_iter().chain(["README.md", NOTICES].map(|name| source.join(name))) {
        files::copy_all(&file, &stage.join(file.file_name().unwrap_or_default()))?;
    }
    let root = stage.join(DATA).join(INSTALLED);
    for part in PARTS {
        files::copy_all(&workspace.root().join(part), &root.join(part))?;
    }
    let libraries = stage.join("libraries");
    let mut archives: BTreeMap<&str, Vec<(PathBuf, String)>> = BTreeMap::new();
    for library in [&served::MECHANISMS, &served::HYDRAULICS] {
        for binary in binaries.iter().filter(|binary| binary.serves(library)) {
            let name = prebuilt::name(library, binary.platform());
            let path = libraries.join(binary.platform()).join(&name);
            files::replace(&path, binary.content())?;
            archives.entry(binary.platform()).or_default().push((path, name));
        }
    }
    for (platform, entries) in archives {
        let archive = root.join(BINARIES).join(format!("{platform}{}", prebuilt::EXTENSION));
        pack(workspace, &archive, &entries)?;
    }
    Ok(())
}

/// Pack files with these names into an archive.
fn pack(workspace: &Workspace, archive: &Path, entries: &[(PathBuf, String)]) -> Result<()> {
    fs::create_dir_all(archive.parent().unwrap_or(archive))?;
    let mut python = Command::new(command::Python::Wheel.interpreter(workspace)?);
    python.arg(workspace.wheel().join("pack.py")).arg(archive).stdin(Stdio::piped());
    let mut child = python.spawn().with_context(|| command::cannot_start(&python, "pack.py"))?;
    let lines: String = entries.iter().map(|(path, name)| format!("{}\t{name}\n", path.display())).collect();
    child.stdin.take().context("pack.py has no standard input for the list of files")?.write_all(lines.as_bytes())?;
    ensure!(
        child.wait()?.success(),
        "{}: the wheel cannot be packed; the messages above state the reason",
        archive.display()
    );
    Ok(())
}

/// Build the program and pack the wheel. Returns its path.
fn build(workspace: &Workspace, stage: &Path, arguments: &Arguments) -> Result<PathBuf> {
    let out = stage.join("out");
    let mut maturin = Command::new(command::Python::Wheel.interpreter(workspace)?);
    // A wheel for named platforms is for publication, so it is small. Other wheels are built fast.
    let (profile, level) = if arguments.platforms.is_empty() { ("release", "6") } else { ("small", "9") };
    maturin.args(["-m", "maturin", "build", "--profile", profile, "--locked", "--compression-level", level, "--out"]);
    maturin.arg(&out).current_dir(stage);
    // Cargo passes the folder of the running program to its child processes.
    maturin.env_remove("CARGO_MANIFEST_DIR");
    if let Some(glibc) = &arguments.glibc {
        maturin.args(["--zig", "--target", platform::own_triple()?, "--compatibility"]);
        maturin.arg(format!("manylinux_{}", glibc.replace('.', "_")));
        maturin.env("PATH", platform::path_with_zig(workspace)?).envs([sources::variable(platform::own_triple()?)?]);
    }
    command::run(&mut maturin, "maturin build")?;
    wheel_in(&out)
}

/// The wheel in a folder. If there are several, the one that was built last.
///
/// # Errors
/// There is none.
pub fn wheel_in(folder: &Path) -> Result<PathBuf> {
    let entries = fs::read_dir(folder).with_context(|| format!("{}: cannot be listed", folder.display()))?;
    let paths = entries.flatten().map(|entry| entry.path());
    let wheels = paths.filter(|path| path.extension().is_some_and(|extension| extension == "whl"));
    wheels
        .max_by_key(|path| fs::metadata(path).and_then(|known| known.modified()).ok())
        .with_context(|| format!("{}: there is no wheel", folder.display()))
}

/// Install a wheel into the environment of this interpreter, without network. An installed version is replaced.
///
/// # Errors
/// pip fails.
pub fn install(python: &Path, wheel: &Path) -> Result<()> {
    let mut pip = Command::new(python);
    pip.args(["-m", "pip", "--disable-pip-version-check", "install", "--quiet", "--no-index", "--no-deps"]);
    command::run(pip.arg("--force-reinstall").arg(wheel), "pip install")
}

/// Check that all files for Linux in the wheel work with the glibc in its name.
fn works_with_named_glibc(wheel: &Path, binaries: &[Binary]) -> Result<()> {
    let name = wheel.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let Some(promised) = promise(&name) else { return Ok(()) };
    let mut archive = Fmu::open(wheel)?;
    let mut parts: Vec<(String, Vec<u8>)> = Vec::new();
    for entry in archive.names().to_vec() {
        let content = archive.read(&entry)?.unwrap_or_default();
        parts.push((entry, content));
    }
    let libraries = binaries.iter().map(|binary| (format!("the library for {}", binary.platform()), binary.content()));
    let parts = parts.iter().map(|(name, content)| (name.clone(), &content[..])).chain(libraries);
    for (entry, content) in parts {
        let Ok(Needs { glibc: Some(needed), functions, .. }) = Needs::of(content) else { continue };
        if needs::parts(&promised) < needs::parts(&needed) {
            let functions = functions.join(", ");
            bail!(
                "{name}: {entry} needs glibc {needed} (for {functions}), but the name of the wheel states \
                 {promised}; build all parts of the wheel with --glibc {promised}"
            );
        }
    }
    Ok(())
}

/// Check that the wheel has its licences in the folder for installers (PEP 639).
fn has_licences(wheel: &Path) -> Result<()> {
    let archive = Fmu::open(wheel)?;
    for name in ["LICENSE-MIT", "LICENSE-APACHE", NOTICES] {
        let end = format!(".dist-info/licenses/{name}");
        let is_there = archive.names().iter().any(|entry| entry.ends_with(&end));
        ensure!(is_there, "{}: the file has no {end}; check license-files in pyproject.toml", wheel.display());
    }
    Ok(())
}

/// The glibc version in the name of a wheel, the oldest of several. None for other systems.
fn promise(name: &str) -> Option<String> {
    let minors = name.match_indices(PROMISE).filter_map(|(at, _)| {
        let rest = &name[at + PROMISE.len()..];
        rest[..rest.find(|letter: char| !letter.is_ascii_digit()).unwrap_or(rest.len())].parse::<u32>().ok()
    });
    minors.min().map(|minor| format!("2.{minor}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The extras of the wheel contain the packages that scripts import, from the pinned version on.
    #[test]
    fn extras_are_the_requirements_of_the_scripts() {
        let workspace = Workspace::locate();
        let settings = fs::read_to_string(workspace.wheel().join("pyproject.toml")).unwrap();
        for (name, file) in [("plot", "demo.txt"), ("studies", "study.txt"), ("cluster", "cluster.txt")] {
            let pinned = fs::read_to_string(workspace.python_scripts().join(file)).unwrap();
            let packages = pinned.lines().find_map(|line| line.strip_prefix(&format!("# extra {name}: "))).unwrap();
            let version = |package: &str| {
                let of = |line: &str| line.strip_prefix(&format!("{package}==")).map(str::to_owned);
                pinned.lines().find_map(of).unwrap_or_else(|| panic!("{file}: no {package}"))
            };
            let stated = packages.split(' ').map(|package| format!("\"{package}>={}\"", version(package)));
            let line = format!("{name} = [{}]", stated.collect::<Vec<_>>().join(", "));
            assert!(settings.contains(&line), "pyproject.toml: no line {line}");
        }
    }

    #[test]
    fn a_name_promises_a_glibc() {
        let glibc = |tag: &str| promise(&format!("linkage_fmu-0.2.0-py3-none-{tag}.whl"));
        assert_eq!(glibc("manylinux_2_17_x86_64.manylinux2014_x86_64").as_deref(), Some("2.17"));
        assert_eq!(glibc("manylinux_2_35_x86_64").as_deref(), Some("2.35"));
        assert_eq!(glibc("manylinux_2_35_x86_64.manylinux_2_28_x86_64").as_deref(), Some("2.28"));
        assert_eq!(glibc("win_amd64"), None);
    }

    /// A wheel with a library that needs a newer glibc than its name states.
    #[test]
    #[cfg(all(target_os = "linux", target_env = "gnu", target_pointer_width = "64"))]
    fn a_library_with_a_newer_glibc_than_declared_is_rejected() {
        use crate::archive::{self, Entry};
        // A small library that this program has loaded.
        let maps = fs::read_to_string("/proc/self/maps").unwrap();
        let library =
            maps.lines().find_map(|line| line.split(' ').next_back().filter(|path| path.contains("/libgcc_s")));
        let content = fs::read(library.unwrap()).unwrap();
        let needed = Needs::of(&content).unwrap().glibc.unwrap();
        let folder = std::env::temp_dir().join(format!("linkage-fmu promise {}", std::process::id()));
        let wheel = |glibc: &str| {
            let path = folder.join(format!("a-1-py3-none-manylinux_{}_x86_64.whl", glibc.replace('.', "_")));
            archive::write(&path, vec![Entry { name: "a.data/scripts/a".into(), content: content.clone() }]).unwrap();
            works_with_named_glibc(&path, &[])
        };
        wheel(&needed).unwrap();
        let message = wheel("2.1").unwrap_err().to_string();
        assert!(message.contains(&format!("a.data/scripts/a needs glibc {needed} (for ")), "{message}");
        fs::remove_dir_all(&folder).unwrap();
    }
}
