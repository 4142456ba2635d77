//! `cargo fmu test --platforms`: Wine and QEMU run the libraries for other machines, whose results must agree with this
//! machine.
//!
//! In: the FMUs of modelDescription/ with the libraries that can be built here. Out: a table of the differences, and an
//! error if a difference is larger than rounding or a call fails.

use crate::fmu::Fmu;
use crate::needs::Needs;
use crate::workspace::Workspace;
use crate::xml::description::Description;
use crate::{binary, command, files, info, package, platform, version};
use anyhow::{Context, Result, bail};
use fmu_cli::{Library, Platform};
use std::ffi::OsString;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Folder of the FMUs, with special characters in its name.
const FOLDER: &str = "a b é 100% ü";
/// Number of communication steps of a run.
const STEPS: usize = 200;
/// Relative tolerance of the integrations, as in `host.c`. At the default 1e-9 the rounding of a platform changes which
/// steps the error control accepts, and a stiff model then differs by several times this tolerance.
const TOLERANCE: f64 = 1e-11;
/// Largest difference between platforms, relative to the largest value of an output. Reactions, accelerations and flows
/// of stiff models amplify the difference of the state. A difference of 1000 times the tolerance would be a fault.
const LARGEST: f64 = 1e3 * TOLERANCE;
/// Smallest reference value of a difference, relative to the nominal value of the output. FMI's absolute tolerance of a
/// solver is 0.01 x tolerance x nominal, which is allowed here. A smaller output is the remainder of larger quantities,
/// such as the flow through an orifice between two equal pressures.
const LEAST: f64 = 0.01 * TOLERANCE / LARGEST;

/// How a program for a platform is compiled and run on this machine.
#[derive(Clone, Copy)]
struct Machine {
    /// Folder of FMI 2.0.
    platform: &'static str,
    compiler: &'static str,
    options: &'static [&'static str],
    /// Program with arguments that runs programs of this platform. Empty for this machine.
    launcher: &'static [&'static str],
    /// Debian packages of compiler and launcher.
    packages: &'static str,
}

const MACHINES: [Machine; 3] = [
    Machine { platform: "linux64", compiler: "x86_64-linux-gnu-gcc", options: &[], launcher: &[], packages: "gcc" },
    Machine {
        platform: "win64",
        compiler: "x86_64-w64-mingw32-gcc",
        options: &["-municode"],
        launcher: &["wine"],
        packages: "gcc-mingw-w64-x86-64 wine64 wine",
    },
    Machine {
        platform: binary::ARM_LINUX,
        compiler: "aarch64-linux-gnu-gcc",
        options: &[],
        launcher: &["qemu-aarch64", "-L", "/usr/aarch64-linux-gnu"],
        packages: "gcc-aarch64-linux-gnu libc6-dev-arm64-cross qemu-user",
    },
];

/// An unpacked FMU on disk.
struct Unpacked {
    folder: PathBuf,
    description: Description,
    identifier: String,
    /// Names of the real outputs.
    outputs: Vec<String>,
    /// Nominal values of the outputs, 0 if none is stated.
    nominals: Vec<f64>,
    /// Their value references.
    references: Vec<String>,
}

/// Difference of the results of a platform from those of this machine.
struct Difference {
    numbers: usize,
    /// Number of values with different bits.
    others: usize,
    /// The output with the largest difference, and this difference relative to its largest value, or to a part of its
    /// nominal value.
    largest: (String, f64),
}

/// Pack all FMUs, run their libraries and compare. Returns the table.
///
/// # Errors
/// A library cannot be built or run although its toolchain is installed, or its results differ.
pub fn run(workspace: &Workspace, binaries: &[Library]) -> Result<String> {
    let out = workspace.target("platforms").join(FOLDER);
    let given = |name: &str| binaries.iter().any(|binary| binary.platform == name);
    let all = [Platform::X86Linux, Platform::X86Windows, Platform::ArmLinux];
    let platforms = all.into_iter().filter(|platform| !given(platform::folder(*platform))).collect();
    let arguments = package::Arguments {
        all: true,
        platforms,
        binaries: binaries.to_vec(),
        available: true,
        out: Some(out.clone()),
        no_animation: true,
        no_results: true,
        ..package::Arguments::of_fmi_2()
    };
    let packed = package::run(workspace, &arguments)?;
    let fmus: Vec<PathBuf> = packed.into_iter().filter(|path| path.extension().is_some_and(|e| e == "fmu")).collect();
    let mut unpacked = fmus.iter().map(|path| Unpacked::new(path, &out)).collect::<Result<Vec<_>>>()?;
    unpacked.sort_by(|a, b| a.identifier.cmp(&b.identifier));
    let own = version::platform()?;
    let own = MACHINES.iter().find(|m| m.platform == own).context("the platforms can be tested on Linux only")?;
    let own = &Machine { compiler: "cc", launcher: &[], ..*own };
    let host = own.host(workspace)?;
    let references = unpacked.iter().map(|fmu| fmu.run(own, &host)).collect::<Result<Vec<_>>>()?;
    let mut text = String::new();
    for machine in MACHINES.iter().filter(|machine| machine.platform != own.platform) {
        let shown = machine.platform;
        if !unpacked.iter().all(|fmu| fmu.library(machine).is_file()) {
            println!("{shown}: not tested, because its library cannot be built here");
            continue;
        }
        if let Some(missing) = machine.missing() {
            println!(
                "{shown}: not tested, because {missing} is missing (Debian: apt-get install {})",
                machine.packages
            );
            continue;
        }
        let host = machine.host(workspace)?;
        if let Some(first) = unpacked.first() {
            let needs = Needs::of(&fs::read(first.library(machine))?)?.words();
            let needs = if needs.is_empty() { "needs only the system".to_owned() } else { needs };
            let _ = writeln!(text, "\n## {shown}\nRun by `{}`; the library {needs}.\n", machine.launcher.join(" "));
        }
        text.push_str(
            "| FMU | numbers | with other bits | largest difference | in |\n| --- | --- | --- | --- | --- |\n",
        );
        for (fmu, reference) in unpacked.iter().zip(&references) {
            let Difference { numbers, others, largest: (name, size) } =
                fmu.compare(reference, &fmu.run(machine, &host)?);
            let place = if others == 0 { String::new() } else { format!("`{name}`") };
            let _ = writeln!(text, "| {} | {numbers} | {others} | {size:.0e} | {place} |", fmu.identifier);
            if size > LARGEST {
                bail!(
                    "{shown}: {name} of {} differs by {size:.1e} of its largest value, or of {LEAST:.0e} of its \
                     nominal value; at most {LARGEST:e} is allowed",
                    fmu.identifier
                );
            }
        }
    }
    if text.is_empty() {
        bail!("no other platform was tested; the missing tools are listed above");
    }
    Ok(text)
}

impl Machine {
    /// The first program that cannot be started on this machine.
    fn missing(&self) -> Option<&'static str> {
        let mut programs = [self.compiler].into_iter().chain(self.launcher.first().copied());
        programs.find(|program| {
            Command::new(program).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status().is_err()
        })
    }

    /// Compile the host. For Wine also build a system library that may be missing.
    fn host(&self, workspace: &Workspace) -> Result<PathBuf> {
        let host = workspace.target("platforms").join(format!("host-{}.exe", self.platform));
        let mut compiler = Command::new(self.compiler);
        compiler.args(["-O1", "-Wall", "-Wextra", "-Werror"]).args(self.options).arg("-o").arg(&host);
        compiler.arg(workspace.validation().join("platforms").join("host.c")).args(["-lm"]);
        if self.platform != "win64" {
            compiler.arg("-ldl");
        }
        command::run(&mut compiler, self.compiler)?;
        if self.platform == "win64" {
            let source = workspace.validation().join("platforms").join("bcryptprimitives.c");
            let library = host.with_file_name("bcryptprimitives.dll");
            let mut compiler = Command::new(self.compiler);
            compiler.args(["-O1", "-Wall", "-Wextra", "-Werror", "-shared", "-o"]).arg(library).arg(source);
            command::run(compiler.arg("-ladvapi32"), self.compiler)?;
        }
        Ok(host)
    }

    /// A path for programs of this platform. In Wine the drive Z is the root.
    fn path(&self, path: &Path) -> OsString {
        if self.platform != "win64" {
            return path.into();
        }
        format!("Z:{}", path.display()).replace('/', "\\").into()
    }

    /// The URI of a folder.
    fn uri(&self, folder: &Path) -> String {
        let mut uri = String::from(if self.platform == "win64" { "file:///Z:" } else { "file://" });
        for byte in folder.to_string_lossy().bytes() {
            match byte {
                b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'/' | b'-' | b'.' | b'_' => uri.push(byte.into()),
                _ => {
                    let _ = write!(uri, "%{byte:02X}");
                }
            }
        }
        uri
    }
}

impl Unpacked {
    fn new(path: &Path, out: &Path) -> Result<Self> {
        let mut fmu = Fmu::open(path)?;
        let description = info::description(&mut fmu)?;
        let identifier = description.interfaces.values().next().context("the FMU has no interface")?.clone();
        let folder = out.join(&identifier);
        if folder.is_dir() {
            fs::remove_dir_all(&folder).with_context(|| format!("{}: cannot be removed", folder.display()))?;
        }
        for name in fmu.names().to_vec() {
            files::replace(&folder.join(&name), &fmu.read(&name)?.unwrap_or_default())?;
        }
        let is_output = |v: &&crate::xml::description::Described| v.causality == "output" && v.kind == "Real";
        let of_outputs = || description.variables.iter().filter(is_output);
        let outputs = of_outputs().map(|v| v.name.clone()).collect();
        let nominals = of_outputs().map(|v| v.nominal.unwrap_or_default()).collect();
        let references = of_outputs().map(|v| v.reference.clone()).collect();
        Ok(Self { folder: folder.canonicalize()?, description, identifier, outputs, nominals, references })
    }

    fn library(&self, machine: &Machine) -> PathBuf {
        self.folder.join(binary::path(machine.platform, &self.identifier).unwrap_or_default())
    }

    /// The outputs at each communication point, for the resource location as a URI, as a plain path and as NULL. All
    /// three must agree.
    fn run(&self, machine: &Machine, host: &Path) -> Result<Vec<u64>> {
        let resources = self.folder.join("resources");
        let locations = [machine.uri(&resources).into(), machine.path(&resources), "-".into()];
        let stop = self.description.experiment.stop_time.unwrap_or(1.0);
        let mut first: Option<Vec<u64>> = None;
        for location in locations {
            let shown = location.to_string_lossy().into_owned();
            let program: Vec<OsString> = machine.launcher.iter().map(OsString::from).chain([host.into()]).collect();
            let mut command = Command::new(&program[0]);
            command
                .args(&program[1..])
                .arg(machine.path(&self.library(machine)))
                .arg(&self.description.guid)
                .arg(location);
            command.arg(format!("{:?}", stop / STEPS as f64)).arg(STEPS.to_string()).args(&self.references);
            command.env("WINEDEBUG", "-all").stderr(Stdio::inherit());
            let output = command.output().with_context(|| command::cannot_start(&command, machine.platform))?;
            if !output.status.success() {
                let name = &self.identifier;
                bail!(
                    "{}: {name} failed with the resources at {shown}; the message of the program is above",
                    machine.platform
                );
            }
            let bits = String::from_utf8_lossy(&output.stdout)
                .split_whitespace()
                .map(|word| u64::from_str_radix(word, 16).context("the host printed no results"))
                .collect::<Result<Vec<_>>>()?;
            if bits.len() != (STEPS + 1) * self.references.len() {
                bail!("{}: {} returned {} numbers", machine.platform, self.identifier, bits.len());
            }
            match &first {
                Some(first) if *first != bits => {
                    bail!("{}: the results differ with the resources at {shown}", machine.platform)
                }
                Some(_) => {}
                None => first = Some(bits),
            }
        }
        first.context("no run was made")
    }

    fn compare(&self, expected: &[u64], found: &[u64]) -> Difference {
        let width = self.references.len();
        let mut largest = (String::new(), 0.0);
        let values = |bits: &[u64], column: usize| -> Vec<f64> {
            bits.iter().skip(column).step_by(width).map(|bits| f64::from_bits(*bits)).collect()
        };
        let scale = |column: usize| {
            let own = values(expected, column);
            let least = LEAST * self.nominals[column];
            own.into_iter().filter(|value| value.is_finite()).fold(least, |most, value| most.max(value.abs()))
        };
        let columns = self.outputs.iter().enumerate();
        for (column, name) in columns.clone() {
            let scale = match name.rsplit_once('.') {
                // These outputs contain only the rounding of the other outputs of their group, of energies or volumes.
                Some((group, "drift" | "balance")) => {
                    let of_group =
                        columns.clone().filter(|(_, other)| other.rsplit_once('.').is_some_and(|o| o.0 == group));
                    of_group.map(|(column, _)| scale(column)).fold(0.0, f64::max)
                }
                _ => scale(column),
            };
            let (expected, found) = (values(expected, column), values(found, column));
            for (a, b) in expected.iter().zip(&found) {
                // Both values may be NaN. A single NaN is a fault.
                let difference = match (a.is_nan(), b.is_nan()) {
                    (true, true) => 0.0,
                    (false, false) if a == b => 0.0,
                    (false, false) => (a - b).abs() / scale,
                    _ => f64::INFINITY,
                };
                if difference > largest.1 {
                    largest = (name.clone(), difference);
                }
            }
        }
        let others = expected.iter().zip(found).filter(|(a, b)| a != b).count();
        Difference { numbers: expected.len(), others, largest }
    }
}
