//! `--static TARGET`: the library as an archive of objects, for hosts that link FMUs instead of loading them.
//!
//! In: a target of Rust. Out: an archive for each model, whose functions have the name of the model as a prefix (FMI
//! 2.0.5, 2.1.2; FMI 3.0.2, 2.5.1.4), and `documentation/staticLinking.txt`. All other names are local to the archive,
//! so that a host can link several archives.

use crate::archive::{BINARIES, Entry};
use crate::library::served::SharedLibrary;
use crate::library::sources;
use crate::version::Version;
use crate::workspace::Workspace;
use crate::{command, files, library, platform};
use anyhow::{Context, Result, bail, ensure};
use std::fs;
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// The text with the link instructions.
pub const PAGE: &str = "documentation/staticLinking.txt";
/// First bytes of an archive, and length of the header of a member (System V's ar).
const MARK: &[u8] = b"!<arch>\n";
const HEADER: usize = 60;
/// Text in rustc's output before the list of libraries that an archive needs.
const NEEDED: &str = "native-static-libs: ";

/// The objects of the library in one file, which exports only the functions of FMI.
pub struct StaticLibrary {
    /// The shared library with the same functions.
    pub library: &'static SharedLibrary,
    /// Rust's name of the target.
    triple: String,
    /// Processor, system and binary interface of the target, if it has one.
    parts: [String; 3],
    /// Folder with the objects.
    folder: PathBuf,
    /// Names of the functions.
    functions: Vec<String>,
    /// Libraries that a host must link in addition.
    needed: String,
}

impl StaticLibrary {
    /// Build the library in release mode.
    ///
    /// # Errors
    /// This is an installation; the target is not for Linux; Rust's standard library for the target or a tool is
    /// missing; the build fails.
    pub fn build(workspace: &Workspace, library: &'static SharedLibrary, triple: &str) -> Result<Self> {
        let shown = format!("--static {triple}");
        ensure!(
            workspace.installation().is_none(),
            "{shown}: a static library is built from the source; use `cargo fmu`"
        );
        let [processor, _, "linux", interface] = triple.split('-').collect::<Vec<_>>()[..] else {
            bail!("{shown}: static libraries are built for Linux only, such as x86_64-unknown-linux-gnu");
        };
        let parts = [processor, "linux", interface].map(str::to_owned);
        let arguments = platform::standard_library(triple, "").context(shown.clone())?;
        let folder = workspace.target("static").join(triple).join(library.name);
        fs::create_dir_all(&folder).with_context(|| format!("{}: cannot be created", folder.display()))?;
        let mut cargo = command::cargo(workspace);
        cargo.args(["rustc", "--release", "--package", library.package, "--lib", "--crate-type", "staticlib"]);
        cargo.arg("--message-format=json-render-diagnostics").args(arguments);
        // On this machine the engine is already compiled for the shared library.
        if !platform::is_this_machine(triple)? {
            cargo.args(["--target", triple]).envs([sources::variable(triple)?]);
        }
        cargo.args(["--", "--print", &format!("native-static-libs={}/needed", folder.display())]);
        let output = cargo.stderr(Stdio::inherit()).output().with_context(|| command::cannot_start(&cargo, "cargo"))?;
        ensure!(
            output.status.success(),
            "{shown}: cargo rustc failed ({}); the messages above state the reason",
            output.status
        );
        let built = library::artifact(&String::from_utf8_lossy(&output.stdout), library.name, "a");
        let archive = built.with_context(|| format!("{shown}: cargo wrote no archive"))?;
        let functions =
            functions(&fs::read(&archive)?).with_context(|| format!("{}: is damaged", archive.display()))?;
        let text = fs::read_to_string(folder.join("needed")).unwrap_or_default();
        let needed = text.trim().trim_start_matches(NEEDED).to_owned();
        let own = Self { library, triple: triple.to_owned(), parts, folder, functions, needed };
        let mut link = own.tool("ld");
        link.args(["-r", "--gc-sections", "-o", "all.o"]).args(own.functions.iter().flat_map(|name| ["-u", name]));
        command::run(link.arg(archive), "ld")?;
        fs::write(own.folder.join("kept"), own.functions.join("\n"))?;
        let keep = ["--strip-unneeded", "--keep-global-symbols=kept", "all.o", "functions.o"];
        command::run(own.tool("objcopy").args(keep), "objcopy")?;
        let object = own.folder.join("functions.o");
        let mut content = files::read(&object, u64::MAX)?;
        sources::leave_out(&mut content, &sources::folder()?);
        files::replace(&object, &content)?;
        Ok(own)
    }

    /// A tool of binutils for the target.
    fn tool(&self, name: &str) -> Command {
        let [processor, _, _] = &self.parts;
        let prefix =
            if *processor == std::env::consts::ARCH { String::new() } else { format!("{processor}-linux-gnu-") };
        let mut tool = Command::new(format!("{prefix}{name}"));
        tool.current_dir(&self.folder);
        tool
    }

    /// Path of the archive in an FMU. FMI 2.0 has a folder per compiler below the folder of the platform.
    fn path(&self, version: Version, model: &str) -> String {
        let [processor, system, interface] = &self.parts;
        match (version, processor.as_str()) {
            (Version::Two, "x86_64") => format!("{BINARIES}/linux64/{interface}/{model}.a"),
            (Version::Two, _) => format!("{BINARIES}/{processor}-{system}/{interface}/{model}.a"),
            (Version::Three, _) => format!("{BINARIES}/{processor}-{system}-{interface}/{model}.a"),
        }
    }

    /// The archive for a model.
    ///
    /// # Errors
    /// A tool fails.
    pub fn entry(&self, version: Version, model: &str) -> Result<Entry> {
        let renamed = self.functions.iter().map(|name| format!("{name} {model}_{name}\n")).collect::<String>();
        fs::write(self.folder.join("renamed"), renamed)?;
        command::run(self.tool("objcopy").args(["--redefine-syms=renamed", "functions.o", "model.o"]), "objcopy")?;
        let object = files::read(&self.folder.join("model.o"), u64::MAX)?;
        let names: Vec<String> = self.functions.iter().map(|name| format!("{model}_{name}")).collect();
        Ok(Entry { name: self.path(version, model), content: archive(&object, &names)? })
    }
}

/// An archive of one object: an index of its names, and the object, without a time.
///
/// # Errors
/// The object is too large.
fn archive(object: &[u8], names: &[String]) -> Result<Vec<u8>> {
    let header = |name: &str, size: usize| format!("{name:<16}{:<12}{:<6}{:<6}{:<8}{size:<10}`\n", 0, 0, 0, 644);
    let mut text = names.join("\0") + "\0";
    // Members start at even offsets.
    if text.len() % 2 == 1 {
        text.push('\0');
    }
    let index = 4 + 4 * names.len() + text.len();
    let place =
        u32::try_from(MARK.len() + HEADER + index).and_then(|place| u32::try_from(object.len()).map(|_| place))?;
    let mut content = [MARK, header("/", index).as_bytes(), &u32::try_from(names.len())?.to_be_bytes()].concat();
    content.extend(names.iter().flat_map(|_| place.to_be_bytes()));
    content.extend([text.as_bytes(), header("model.o/", object.len()).as_bytes(), object].concat());
    if content.len() % 2 == 1 {
        content.push(b'\n');
    }
    Ok(content)
}

/// The link instructions for these libraries of a model.
pub fn page(libraries: &[&StaticLibrary], version: Version, model: &str) -> Entry {
    let function = match version {
        Version::Two => "fmi2Instantiate",
        Version::Three => "fmi3InstantiateCoSimulation",
    };
    let mut text = format!(
        "Static libraries of {model}\n\nA program can link these archives instead of loading a shared library. The \
         name of each function starts with\nthe name of the model: {model}_{function}. All other names are local, so \
         one program can link several FMUs.\n\n"
    );
    for library in libraries {
        text += &format!("{}\n", library.path(version, model));
        text += &format!("    target {}; link in addition: {}\n", library.triple, library.needed);
    }
    text += &format!(
        "\n\
         Example: cc host.c {model}.a LIBRARIES -o host\n\n\
         Pass the folder of the resources to {model}_{function}: a linked FMU cannot find this folder itself.\n\
         When an instance is created, the code needs an operating system with memory allocation and files. So the\n\
         code does not run on a processor without an operating system. A step allocates no memory.\n\n\
         This FMU contains no source code: the library is written in Rust, and FMI has source code in C only.\n"
    );
    Entry { name: PAGE.to_owned(), content: text.into_bytes() }
}

/// Functions of FMI in the index of an archive. None without an index.
fn functions(archive: &[u8]) -> Option<Vec<String>> {
    /// Range of the size in the header of a member.
    const SIZE: std::ops::Range<usize> = 48..58;
    let members = archive.get(MARK.len()..)?;
    let header = members.get(..HEADER).filter(|header| header.starts_with(b"/ "))?;
    let size: usize = str::from_utf8(&header[SIZE]).ok()?.trim().parse().ok()?;
    let index = members.get(HEADER..HEADER + size)?;
    let count = u32::from_be_bytes(index.get(..4)?.try_into().ok()?) as usize;
    let names = index.get(4 + 4 * count..)?.split(|byte| *byte == 0).filter_map(|name| str::from_utf8(name).ok());
    let mut all: Vec<String> =
        names.filter(|name| name.starts_with("fmi2") || name.starts_with("fmi3")).map(str::to_owned).collect();
    all.sort();
    (!all.is_empty()).then_some(all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::library::served::MECHANISMS;

    #[test]
    fn functions_stand_in_the_index_of_an_archive() {
        let names = ["fmi3Reset", "_ZN4core3fmt", "fmi2Reset"].map(str::to_owned);
        let archive = super::archive(b"the object", &names).unwrap();
        assert_eq!(functions(&archive).unwrap(), ["fmi2Reset", "fmi3Reset"]);
        assert!(archive.ends_with(b"`\nthe object") && archive.len().is_multiple_of(2));
        assert_eq!(functions(b"!<arch>\n"), None);
        assert_eq!(functions(&archive[..90]), None);
    }

    #[test]
    fn a_target_has_its_folder_and_an_unsupported_one_is_rejected() {
        let library = |triple: &str, parts: [&str; 3]| StaticLibrary {
            library: &MECHANISMS,
            triple: triple.to_owned(),
            parts: parts.map(str::to_owned),
            folder: PathBuf::new(),
            functions: Vec::new(),
            needed: "-lc -lm".to_owned(),
        };
        let own = library("x86_64-unknown-linux-gnu", ["x86_64", "linux", "gnu"]);
        assert_eq!(own.path(Version::Two, "Gear"), "binaries/linux64/gnu/Gear.a");
        assert_eq!(own.path(Version::Three, "Gear"), "binaries/x86_64-linux-gnu/Gear.a");
        let arm = library("aarch64-unknown-linux-musl", ["aarch64", "linux", "musl"]);
        assert_eq!(arm.path(Version::Two, "Gear"), "binaries/aarch64-linux/musl/Gear.a");
        let text = String::from_utf8(page(&[&own, &arm], Version::Two, "Gear").content).unwrap();
        for piece in ["Gear_fmi2Instantiate", "binaries/linux64/gnu/Gear.a", "-lc -lm", "no source code"] {
            assert!(text.contains(piece), "{piece}: {text}");
        }
        for triple in ["thumbv7em-none-eabihf", "x86_64-pc-windows-gnu", "linux"] {
            let message = StaticLibrary::build(&Workspace::locate(), &MECHANISMS, triple).err().unwrap().to_string();
            assert!(message.contains("for Linux only"), "{message}");
        }
    }
}
