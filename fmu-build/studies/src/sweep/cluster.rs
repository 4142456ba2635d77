//! A cluster of Dask that makes the chunks of a study.
//!
//! In: the chunks to make. Out: their bytes, in the order in which they are completed. A Python program passes them to
//! the workers, which run the packed FMU through FMPy. Dask repeats the chunk of a lost worker.

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

/// The Python program.
const PROGRAM: &str = "cluster.py";
const REQUIREMENTS: &str = "cluster.txt";
/// Number of the chunk that represents an error.
const FATAL: u64 = u64::MAX;
/// Time between two checks of the user's request to stop.
const LOOK: Duration = Duration::from_millis(100);
/// Time in which the program may end by itself.
const PATIENCE: Duration = Duration::from_secs(10);

/// Location of the workers.
#[derive(Clone, Debug)]
pub enum Workers {
    /// This number of processes on this machine.
    Local(u16),
    /// Workers of the scheduler at this address.
    Of(String),
}

/// The work of the cluster.
pub struct Work<'a> {
    /// Common data of all runs.
    pub task: &'a Task,
    /// Values of the factors.
    pub design: &'a Design,
    /// Division of the runs into chunks.
    pub cut: &'a Cut,
}

/// The FMU of the mechanism at this path. A given FMU of FMI 2.0 from this program is used directly, so that its
/// variables and its results are identical to those of the model here. Otherwise an FMU is packed into the folder.
///
/// # Errors
/// The FMU cannot be read, or no FMU can be packed.
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
        "{}: the file is not an FMU for FMI 2.0 from this version of the program; a new FMU is packed for the workers",
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

/// Make these chunks. `keep` is called with each completed chunk. With `stop_wish`, active chunks are abandoned.
///
/// # Errors
/// The Python environment or the cluster fails; no worker could make a chunk; an error of `keep`.
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
    let plan_file = folder.join("plan.json");
    fs::write(&plan_file, plan(work.task, interface).to_string())
        .with_context(|| format!("{}: cannot be written", plan_file.display()))?;
    let mut program = Command::new(python);
    program.arg(scripts.join(PROGRAM)).arg(fmu).arg(&plan_file);
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
        scope.spawn(|| send_chunks(input, work, chunks));
        scope.spawn(move || collect(output, &sender));
        let mut next = || -> Result<()> {
            while left > 0 && !stop_wish.load(Ordering::Relaxed) {
                match done.recv_timeout(LOOK) {
                    Ok((FATAL, text)) => bail!("the cluster: {}", String::from_utf8_lossy(&text)),
                    Ok((number, bytes)) => {
                        let columns = work.design.factors().len() + work.task.responses.columns.len();
                        chunk::read(&bytes, work.cut.runs_of(number), columns)?;
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
            // When its plan is removed, the program ends and leaves the workers unchanged. The pipes end with the
            // program, and the two threads with the pipes.
            let _ = fs::remove_file(&plan_file);
            let patience = Instant::now() + PATIENCE;
            while matches!(child.try_wait(), Ok(None)) && Instant::now() < patience {
                thread::sleep(LOOK);
            }
            let _ = child.kill();
        }
        result
    });
    let status = child.wait().with_context(|| format!("the program cannot wait for the end of {PROGRAM}"))?;
    let _ = fs::remove_file(&plan_file);
    result?;
    if left == 0 && !status.success() {
        eprintln!("warning: all parts of the study are complete, but {PROGRAM} ended with {status}");
    }
    Ok(())
}

/// Write the chunks for the program, each with the factor values of its runs. The program reads them during its work.
fn send_chunks(input: ChildStdin, work: &Work, chunks: &[u64]) {
    let (mut input, mut design, mut point) =
        (BufWriter::new(input), work.design.clone(), vec![0.0; work.design.factors().len()]);
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
    // A program that has ended prints the reason itself.
    let _ = write();
}

/// Read the completed chunks until the program ends.
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
    // The pipe has ended.
    let _ = next();
}
