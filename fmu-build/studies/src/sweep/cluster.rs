//! A cluster of Dask that makes the chunks of a study.
//!
//! In: the chunks to be made. Out: their bytes, in the order in which they are done. A program in Python hands them to
//! the workers, which run the packed FMU through FMPy; Dask makes the chunk of a worker that is lost again.

use super::chunk::{self, Cut};
use super::design::Design;
use super::plan::plan;
use super::run::Task;
use anyhow::{Context, Result, bail};
use fmu_build::fmu::{self, Fmu};
use fmu_build::version::Version;
use fmu_build::workspace::Workspace;
use fmu_build::xml::{description::Description, fmi2};
use fmu_build::{command, files, info, package};
use fmu_cli::Naming;
use linkage_fmu::component::Component;
use linkage_fmu::variables::Interface;
use std::fs;
use std::io::{BufWriter, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{ChildStdin, ChildStdout, Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::{Duration, Instant};

/// The program, and what it needs.
const PROGRAM: &str = "cluster.py";
const REQUIREMENTS: &str = "cluster.txt";
/// Number of a chunk that stands for an error.
const FATAL: u64 = u64::MAX;
/// Time between two looks at the user's wish to stop.
const LOOK: Duration = Duration::from_millis(100);
/// Time in which the program may end by itself.
const PATIENCE: Duration = Duration::from_secs(10);

/// Where the workers are.
#[derive(Clone, Debug)]
pub enum Workers {
    /// So many processes on this machine.
    Local(u16),
    /// Those of a scheduler at this address.
    Of(String),
}

/// What the cluster runs.
pub struct Work<'a> {
    /// What all runs share.
    pub task: &'a Task,
    /// Values of the factors.
    pub design: &'a Design,
    /// How the runs are cut into chunks.
    pub cut: &'a Cut,
}

/// The FMU of the mechanism at this path: itself, if it is of FMI 2.0 and of this program, so that its variables and
/// its bits are those of the model here; else one that is packed into the folder.
///
/// # Errors
/// The FMU cannot be read; none can be packed.
pub fn packed(workspace: &Workspace, mechanism: &Path, model: &Component, folder: &Path) -> Result<PathBuf> {
    if !fmu::is_fmu(mechanism) {
        return pack(workspace, mechanism, folder);
    }
    let mut given = Fmu::open(mechanism)?;
    let there = info::description(&mut given)?;
    let here = Description::parse(&fmi2::to_xml(model, Naming::default())?)?;
    if Version::of(&there.fmi_version) == Version::Two
        && (there.guid, there.generation_tool) == (here.guid, here.generation_tool)
    {
        return Ok(mechanism.to_path_buf());
    }
    eprintln!(
        "{}: is not an FMU for FMI 2.0 from this version of the program; a new FMU is packed for the workers",
        mechanism.display()
    );
    let definition = given.definition()?;
    let own = folder.join(definition.kind);
    files::replace(&own, definition.text.as_bytes())?;
    let packed = pack(workspace, &own, folder);
    let _ = fs::remove_file(&own);
    packed
}

/// Pack the mechanism at this path into the folder, for workers.
fn pack(workspace: &Workspace, mechanism: &Path, folder: &Path) -> Result<PathBuf> {
    let arguments = package::Arguments {
        paths: vec![mechanism.to_path_buf()],
        out: Some(folder.to_path_buf()),
        no_animation: true,
        no_results: true,
        ..package::Arguments::of_fmi_2()
    };
    package::run(workspace, &arguments)?.into_iter().next().context("no FMU was packed")
}

/// Make these chunks; `keep` is called with each that is done. With `stop_wish`, chunks that are being made are left.
///
/// # Errors
/// Python's environment or the cluster fails; a chunk that no worker could make; an error of `keep`.
pub fn run(
    workspace: &Workspace,
    workers: &Workers,
    (work, interface): (&Work, &Interface),
    (fmu, folder): (&Path, &Path),
    chunks: &[u64],
    stop_wish: &AtomicBool,
    mut keep: impl FnMut(u64, Vec<u8>) -> Result<()>,
) -> Result<()> {
    let scripts = workspace.python_scripts();
    let python = command::environment(&workspace.target("venv-cluster"), &scripts.join(REQUIREMENTS))?;
    let told = folder.join("plan.json");
    fs::write(&told, plan(work.task, interface).to_string())
        .with_context(|| format!("{}: cannot be written", told.display()))?;
    let mut program = Command::new(python);
    program.arg(scripts.join(PROGRAM)).arg(fmu).arg(&told);
    match workers {
        Workers::Local(count) => program.args(["--workers", &count.to_string()]),
        Workers::Of(scheduler) => program.args(["--scheduler", scheduler]),
    };
    let mut child = program.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn();
    let child = child.as_mut().map_err(|_| anyhow::anyhow!(command::cannot_start(&program, PROGRAM)))?;
    let (Some(input), Some(output)) = (child.stdin.take(), child.stdout.take()) else {
        bail!("the standard input and output of {PROGRAM} cannot be opened");
    };
    let (sender, done) = channel();
    let mut left = chunks.len();
    let result = thread::scope(|scope| {
        scope.spawn(|| hand_over(input, work, chunks));
        scope.spawn(move || collect(output, &sender));
        let mut next = || -> Result<()> {
            while left > 0 && !stop_wish.load(Ordering::Relaxed) {
                match done.recv_timeout(LOOK) {
                    Ok((FATAL, text)) => bail!("the cluster: {}", String::from_utf8_lossy(&text)),
                    Ok((number, bytes)) => {
                        let runs = work.cut.runs_of(number);
                        let columns = work.design.factors().len() + work.task.responses.columns.len();
                        chunk::read(&bytes, runs.end - runs.start, columns, |_, _, _| Ok(()))?;
                        keep(number, bytes)?;
                        left -= 1;
                    }
                    Err(RecvTimeoutError::Timeout) => {}
                    Err(RecvTimeoutError::Disconnected) => {
                        bail!("{PROGRAM} ended early; the messages above state the reason; continue with --resume")
                    }
                }
            }
            Ok(())
        };
        let result = next();
        if result.is_err() || left > 0 {
            // The program leaves the workers as they were when its plan is gone. The pipes end with it, and with them
            // the two threads.
            let _ = fs::remove_file(&told);
            let patience = Instant::now() + PATIENCE;
            while matches!(child.try_wait(), Ok(None)) && Instant::now() < patience {
                thread::sleep(LOOK);
            }
            let _ = child.kill();
        }
        result
    });
    let status = child.wait().with_context(|| format!("the program cannot wait for the end of {PROGRAM}"))?;
    let _ = fs::remove_file(&told);
    result?;
    if left == 0 && !status.success() {
        eprintln!("warning: all parts are complete, but {PROGRAM} ended with {status}");
    }
    Ok(())
}

/// Write the chunks for the program, each with the values of the factors of its runs. The program reads as it goes on.
fn hand_over(input: ChildStdin, work: &Work, chunks: &[u64]) {
    let (mut input, mut design, mut point) = (BufWriter::new(input), work.design.clone(), Vec::new());
    let mut write = || -> std::io::Result<()> {
        for chunk in chunks {
            let runs = work.cut.runs_of(*chunk);
            input.write_all(&chunk.to_le_bytes())?;
            input.write_all(&((runs.end - runs.start) as u32).to_le_bytes())?;
            for run in runs {
                design.point(run, &mut point);
                point.iter().try_for_each(|value| input.write_all(&value.to_le_bytes()))?;
            }
            input.flush()?;
        }
        Ok(())
    };
    // A program that has ended tells why by itself.
    let _ = write();
}

/// Read the chunks that are made until the program ends.
fn collect(mut output: ChildStdout, sender: &Sender<(u64, Vec<u8>)>) {
    let mut next = || -> std::io::Result<()> {
        loop {
            let mut numbers = [[0; 8]; 2];
            for number in &mut numbers {
                output.read_exact(number)?;
            }
            let [chunk, length] = numbers.map(u64::from_le_bytes);
            let mut bytes = vec![0; length as usize];
            output.read_exact(&mut bytes)?;
            if sender.send((chunk, bytes)).is_err() {
                return Ok(());
            }
        }
    };
    // At the end of the pipe.
    let _ = next();
}
