//! The optimiser: a Python program that requests evaluations of designs.
//!
//! In: number of factors and limits, a start, a budget, a seed. Out: points of the unit cube to evaluate. Both sides
//! exchange lines of JSON. The module must not know what the factors are.

use super::goal::Worth;
use anyhow::{Context, Result, bail};
use fmu_build::command;
use fmu_build::workspace::Workspace;
use serde::Deserialize;
use serde_json::json;
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

/// The Python program.
const PROGRAM: &str = "optimise.py";
const REQUIREMENTS: &str = "study.txt";

/// The problem, which is sent to the optimiser at its start.
#[derive(Clone, Debug)]
pub struct Problem {
    /// Number of limits.
    pub limits: usize,
    /// Start point in the unit cube.
    pub start: Vec<f64>,
    /// Largest number of evaluations.
    pub evaluations: u64,
    /// Seed of the random numbers.
    pub seed: u64,
}

/// A message of the optimiser.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Said {
    /// Evaluate these points of the unit cube.
    Points(Vec<Vec<f64>>),
    /// The search has ended, with this reason.
    End(String),
}

/// The running program. It ends when this value is dropped.
pub struct Optimiser {
    child: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
}

impl Optimiser {
    /// Start the program.
    ///
    /// # Errors
    /// The Python environment cannot be created, or the program cannot be started.
    pub fn start(workspace: &Workspace, problem: &Problem) -> Result<Self> {
        let scripts = workspace.python_scripts();
        let python = command::environment(&workspace.target("venv-study"), &scripts.join(REQUIREMENTS))?;
        let mut program = Command::new(python);
        program.arg(scripts.join(PROGRAM)).stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut child = program.spawn().with_context(|| command::cannot_start(&program, PROGRAM))?;
        let (Some(input), Some(output)) = (child.stdin.take(), child.stdout.take()) else {
            bail!("the standard input and output of {PROGRAM} cannot be opened");
        };
        let mut own = Self { child, input, output: BufReader::new(output) };
        let Problem { limits, start, evaluations, seed } = problem;
        own.send(&json!({ "limits": limits, "start": start, "evaluations": evaluations, "seed": seed }))?;
        Ok(own)
    }

    /// The next message of the program.
    ///
    /// # Errors
    /// The program has ended early, or its message is invalid.
    pub fn next(&mut self) -> Result<Said> {
        let mut line = String::new();
        let length =
            self.output.read_line(&mut line).with_context(|| format!("the output of {PROGRAM} cannot be read"))?;
        if length == 0 {
            bail!("{PROGRAM} ended early; the messages above state the reason");
        }
        serde_json::from_str(&line).with_context(|| format!("{PROGRAM} printed a line that is not a valid answer"))
    }

    /// Send the values of the points. None stands for a failed run.
    ///
    /// # Errors
    /// The program has ended early.
    pub fn answer(&mut self, worth: &[Option<Worth>]) -> Result<()> {
        let costs: Vec<Option<f64>> = worth.iter().map(|worth| Some(worth.as_ref()?.cost)).collect();
        let excess: Vec<Option<&[f64]>> = worth.iter().map(|worth| Some(&*worth.as_ref()?.excess)).collect();
        self.send(&json!({ "costs": costs, "excess": excess }))
    }

    fn send(&mut self, line: &serde_json::Value) -> Result<()> {
        let written = writeln!(self.input, "{line}").and_then(|()| self.input.flush());
        written.with_context(|| format!("{PROGRAM} ended early; the messages above state the reason"))
    }
}

impl Drop for Optimiser {
    fn drop(&mut self) {
        // For a program that has ended, this only waits.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
