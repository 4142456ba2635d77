//! Test of the wheel in a new virtual environment, without Rust and without the repository.
//!
//! In: the wheel. Out: an error if a command fails, or if its files differ from those of `cargo fmu`.

use crate::fmu::Fmu;
use crate::workspace::{MECHANISM, Workspace};
use crate::{command, package};
use anyhow::{Context, Result, bail, ensure};
use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Folder of the test: its path has spaces, percent signs and letters beyond ASCII.
const FOLDER: &str = "a wheel 100% tried é";
/// The model of the test.
const MODEL: &str = "FourBar";
/// A study of the model.
const STUDY: &str = r#"{
    "mechanism": "my four-bar.json",
    "factors": { "load_factor": { "values": [0.5, 1, 1.5] } },
    "scenario": { "stop_time": 0.2, "output_interval": 0.01 },
    "responses": { "drift": { "maximum": "energy.drift" } }
}"#;

/// The installed program.
struct Installed {
    program: PathBuf,
    /// Interpreter of its environment.
    interpreter: PathBuf,
    /// Folder in which the program runs.
    here: PathBuf,
    /// An empty folder.
    empty: PathBuf,
    home: PathBuf,
    /// Folder in which Python's environments are kept between two tests.
    kept: PathBuf,
    /// Interpreter that creates environments.
    python: PathBuf,
}

impl Installed {
    /// Install the wheel, without network, in a new environment.
    fn new(workspace: &Workspace, wheel: &Path) -> Result<Self> {
        let folder = workspace.target("dist").join(FOLDER);
        if folder.is_dir() {
            fs::remove_dir_all(&folder).with_context(|| format!("{}: cannot be removed", folder.display()))?;
        }
        let [here, empty, home] = ["my mechanisms", "empty", "home"].map(|name| folder.join(name));
        for made in [&here, &empty, &home] {
            fs::create_dir_all(made).with_context(|| format!("{}: cannot be created", made.display()))?;
        }
        let environment = folder.join("environment");
        let tools = command::Python::Wheel.interpreter(workspace)?;
        command::run(Command::new(&tools).args(["-m", "venv", "--without-pip"]).arg(&environment), "python -m venv")?;
        let (scripts, suffix) = if cfg!(windows) { ("Scripts", ".exe") } else { ("bin", "") };
        let scripts = environment.join(scripts);
        let mut pip = Command::new(&tools);
        let interpreter = scripts.join(format!("python{suffix}"));
        pip.args(["-m", "pip", "--disable-pip-version-check", "--python"]).arg(&interpreter);
        // The command needs no other package.
        pip.args(["install", "--quiet", "--no-index", "--no-deps"]).arg(wheel);
        command::run(&mut pip, "pip install")?;
        let kept = workspace.target("dist").join("kept");
        let program = scripts.join(format!("linkage-fmu{suffix}"));
        Ok(Self { program, interpreter, here, empty, home, kept, python: tools })
    }

    /// Run the program with these arguments. Returns its output if it exits with this code.
    fn call(&self, words: &[&str], code: i32) -> Result<String> {
        self.output(&self.program, words, code)
    }

    /// Run a program of the environment, as in [`Self::call`].
    fn output(&self, program: &Path, words: &[&str], code: i32) -> Result<String> {
        let mut command = Command::new(program);
        command.args(words).current_dir(&self.here);
        // Neither cargo nor rustc is on the path, and no variable contains their folders.
        let names = env::vars_os().map(|(name, _)| name);
        for name in names.filter(|name| ["CARGO", "RUST"].iter().any(|tool| name.to_string_lossy().starts_with(tool))) {
            command.env_remove(name);
        }
        command.env("PATH", &self.empty).env("HOME", &self.home).env("XDG_CACHE_HOME", &self.kept);
        command.env("PYTHON", &self.python);
        let output = command.output().with_context(|| command::cannot_start(&command, "the installed program"))?;
        let text = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).concat();
        let name = program.file_name().unwrap_or_default().display();
        ensure!(output.status.code() == Some(code), "{name} {}: {}\n{text}", words.join(" "), output.status);
        Ok(text)
    }

    /// Content of a file that the program should have written.
    fn made(&self, name: &str) -> Result<Vec<u8>> {
        fs::read(self.here.join(name)).with_context(|| format!("{name}: was not made"))
    }
}

/// Test the wheel. `packing` gives the same libraries here.
///
/// # Errors
/// The wheel cannot be installed, a command fails, or files differ.
pub fn run(workspace: &Workspace, packing: &package::Arguments, wheel: &Path) -> Result<()> {
    let installed = Installed::new(workspace, wheel)?;
    let own = format!("{MODEL}.fmu");
    let definition = workspace.descriptions().join(MODEL).join("resources").join(MECHANISM);
    let copied = installed.here.join("my four-bar.json");
    fs::copy(&definition, &copied).with_context(|| format!("{}: cannot be copied", definition.display()))?;
    fs::write(installed.here.join("study.json"), STUDY)?;
    for words in [
        &["check", "my four-bar.json"][..],
        &["package", "my four-bar.json"],
        &["validate", &own, "FourBar.fmi3.fmu"],
        &["info", &own, "--json"],
        &["view", &own],
        &["simulate", &own, "--output-file", "of the FMU.csv", "--plot", "run.png"],
        &["simulate", "my four-bar.json", "--output-file", "of the file.csv"],
        &["sweep", "study.json", "--csv"],
        &["chain", "3", "--out", "chain.json"],
        &["package", "--no-animation", "--no-results", "--out", "own"],
    ] {
        installed.call(words, 0)?;
    }
    for name in ["FourBar.fmi3.fmu", "FourBar.html", "run.png", "study/runs.parquet", "own/LandingGearRetraction.fmu"] {
        installed.made(name)?;
    }
    ensure!(installed.made("of the FMU.csv")? == installed.made("of the file.csv")?, "two runs of one model differ");
    let rows = String::from_utf8_lossy(&installed.made("study/runs.csv")?).lines().count();
    ensure!(rows == 4, "study/runs.csv has {rows} lines instead of four: a header and three runs");
    let retraction = installed.call(&["demo", "--out", "demo"], 0)?;
    ensure!(retraction.contains("retraction time       0.132059852"), "linkage-fmu demo: {retraction}");
    installed.made("demo/retraction.png")?;
    let message = installed.call(&["test"], 1)?;
    ensure!(message.lines().count() == 1 && message.contains("`cargo fmu test`"), "linkage-fmu test: {message}");
    let help = installed.output(&installed.interpreter, &["-m", "linkage_fmu", "--help"], 0)?;
    ensure!(help.contains("Usage: linkage-fmu"), "python -m linkage_fmu --help: {help}");
    let help = installed.call(&["--help"], 0)?;
    ensure!(help.contains("Usage: linkage-fmu") && !help.contains("cargo"), "linkage-fmu --help: {help}");
    let out = workspace.target("dist").join("expected");
    let same = package::Arguments { paths: vec![copied], out: Some(out), ..packing.clone() };
    for expected in package::run(workspace, &same)? {
        let found = installed.here.join(expected.file_name().unwrap_or_default());
        check_equal(&expected, &found)?;
    }
    println!("the installed program does its tasks without Rust, and packs the same FMU as `cargo fmu package`");
    module(workspace, &installed, wheel)
}

/// Test the Python module in an environment with the packages of its tests.
fn module(workspace: &Workspace, installed: &Installed, wheel: &Path) -> Result<()> {
    let tests = workspace.module_tests();
    let python = command::Python::Module.interpreter(workspace)?;
    super::install(&python, wheel)?;
    let mut pytest = command::pytest(workspace, &python);
    pytest.args(["-p", "no:cacheprovider", "-c"]).arg(tests.join("pyproject.toml")).arg(&tests);
    pytest.current_dir(&installed.empty).env("PATH", &installed.empty);
    command::run(&mut pytest, "pytest of the module")
}

/// Compare two FMUs, entry by entry. The installed program packs only its own library.
fn check_equal(expected: &Path, found: &Path) -> Result<()> {
    let (mut expected, mut found) = (Fmu::open(expected)?, Fmu::open(found)?);
    for name in found.names().to_vec() {
        if expected.read(&name)? != found.read(&name)? {
            bail!("{name} of {MODEL}.fmu differs between the installed program and `cargo fmu package`");
        }
    }
    let others = |name: &&String| !name.starts_with("binaries/");
    ensure!(
        expected.names().iter().filter(others).eq(found.names().iter().filter(others)),
        "{MODEL}.fmu has other entries when the installed program packs it than with `cargo fmu package`"
    );
    Ok(())
}
