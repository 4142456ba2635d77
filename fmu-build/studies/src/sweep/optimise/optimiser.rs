//! The optimiser: a program in Python that asks for designs, answered here.
//!
//! In: number of factors and limits, a start, a budget, a seed. Out: points of the unit cube to be evaluated. Lines of
//! JSON go both ways. It must not know what the factors are.

use super::goal::Worth;
use anyhow::{Context, Result, bail};
use fmu_build::command;
use fmu_build::workspace::Workspace;
use serde::Deserialize;
use serde_json::json;
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

/// The program, and what it needs.
const PROGRAM: &str = "optimise.py";
const REQUIREMENTS: &str = "study.txt";

/// What the optimiser is told at its beginning.
#[derive(Clone, Debug)]
pub struct Problem {
    /// Number of limits.
    pub limits: usize,
    /// Point of the unit cube to begin with.
    pub start: Vec<f64>,
    /// Most evaluations.
    pub evaluations: u64,
    /// Seed of its random numbers.
    pub seed: u64,
}

/// What the optimiser says.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Said {
    /// Evaluate these points of the unit cube.
    Points(Vec<Vec<f64>>),
    /// The search is over, and why.
    End(String),
}

/// The program as it runs; it ends when this is dropped.
pub struct Optimiser {
    child: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
}

impl Optimiser {
    /// Start the program.
    ///
    /// # Errors
    /// Python's environment cannot be made; the program cannot be started.
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
        own.tell(&json!({ "limits": limits, "start": start, "evaluations": evaluations, "seed": seed }))?;
        Ok(own)
    }

    /// The next thing that the program says.
    ///
    /// # Errors
    /// The program has ended before its time, or says what is no answer.
    pub fn next(&mut self) -> Result<Said> {
        let mut line = String::new();
        let length =
            self.output.read_line(&mut line).with_context(|| format!("the output of {PROGRAM} cannot be read"))?;
        if length == 0 {
            bail!("{PROGRAM} ended early; the messages above state the reason");
        }
        serde_json::from_str(&line).with_context(|| format!("{PROGRAM} printed a line that is not a valid answer"))
    }

    /// Answer with what the points are worth; none for a run that failed.
    ///
    /// # Errors
    /// The program has ended before its time.
    pub fn answer(&mut self, worth: &[Option<Worth>]) -> Result<()> {
        let costs: Vec<Option<f64>> = worth.iter().map(|worth| Some(worth.as_ref()?.cost)).collect();
        let excess: Vec<Option<&[f64]>> = worth.iter().map(|worth| Some(&*worth.as_ref()?.excess)).collect();
        self.tell(&json!({ "costs": costs, "excess": excess }))
    }

    fn tell(&mut self, line: &serde_json::Value) -> Result<()> {
        let written = writeln!(self.input, "{line}").and_then(|()| self.input.flush());
        written.with_context(|| format!("{PROGRAM} ended early; the messages above state the reason"))
    }
}

impl Drop for Optimiser {
    fn drop(&mut self) {
        // One that has ended by itself is only waited for.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
