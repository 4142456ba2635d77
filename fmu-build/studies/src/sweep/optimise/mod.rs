//! `cargo fmu optimise`: the best design of a mechanism according to a study.
//!
//! In: a study whose factors have bounds, an objective, limits of responses. Out: the definition with the best values,
//! its responses compared with the present ones, and all evaluations. The optimiser only requests points. This module
//! stores the evaluations and the best design, so that an ended search returns the best design up to then.

mod evaluate;
mod goal;
mod optimiser;

use super::bar::{Bar, Watch};
use super::chunk::{Remark, Rows};
use super::csv::Csv;
use super::parquet::Parquet;
use super::results::{Partial, columns};
use super::run::{Runner, Task};
use super::table::{Column, Content};
use super::{Stated, design, page, task};
use crate::definition_values;
use crate::progress::stop_wish;
use crate::simulate::Outcome;
use anyhow::{Context, Result, bail};
use evaluate::{Evaluation, Evaluator};
use fmu_build::workspace::Workspace;
use fmu_build::{drawing, files};
pub use fmu_cli::Optimise as Arguments;
use goal::{Goal, Worth};
use linkage_fmu::component::Component;
use linkage_fmu::mechanism::inspection::{Pose, Scene};
use optimiser::{Optimiser, Problem, Said};
use serde_json::{Map, Value, json};
use std::path::Path;

/// Names of the result files in the output folder. The definition has the name of its kind.
const PARQUET: &str = "evaluations.parquet";
const CSV: &str = "evaluations.csv";
const SUMMARY: &str = "optimum.json";
const PICTURE: &str = "designs.svg";
/// Column with the largest excess over a limit, relative to the limit.
const VIOLATION: &str = "violation";
/// Default number of evaluations per factor.
const FOR_EACH: u64 = 500;
/// Smallest and largest number of evaluations of a search.
const BUDGET: std::ops::RangeInclusive<u64> = 20..=1_000_000;
/// Width of the picture of one design [px].
const WIDTH: f64 = 600.0;

/// A design space: the factors with their bounds.
struct Space {
    bounds: Vec<[f64; 2]>,
}

impl Space {
    /// Values of the factors at a point of the unit cube. The ends are exact.
    fn values(&self, point: &[f64]) -> Vec<f64> {
        let value = |([least, largest], part): (&[f64; 2], &f64)| match part {
            part if *part <= 0.0 => *least,
            part if *part >= 1.0 => *largest,
            part => (least + (largest - least) * part).clamp(*least, *largest),
        };
        self.bounds.iter().zip(point).map(value).collect()
    }

    /// The point of the unit cube nearest to these values.
    fn nearest(&self, values: &[f64]) -> Vec<f64> {
        let part = |([least, largest], value): (&[f64; 2], &f64)| ((value - least) / (largest - least)).clamp(0.0, 1.0);
        self.bounds.iter().zip(values).map(part).collect()
    }

    fn contains(&self, values: &[f64]) -> bool {
        self.bounds.iter().zip(values).all(|([least, largest], value)| (least..=largest).contains(&value))
    }
}

/// All evaluations. The first one is the present mechanism.
#[derive(Default)]
struct Found {
    all: Vec<(Evaluation, Option<Worth>)>,
    /// Index of the best design within the bounds.
    best: Option<usize>,
}

impl Found {
    fn add(&mut self, evaluation: Evaluation, worth: Option<Worth>, is_allowed: bool) {
        if let Some(own) = worth.as_ref().filter(|_| is_allowed) {
            let best = self.best.and_then(|best| self.all[best].1.as_ref());
            if best.is_none_or(|best| own.is_better(best)) {
                self.best = Some(self.all.len());
            }
        }
        self.all.push((evaluation, worth));
    }
}

/// Search for the best design of a study and write it.
///
/// # Errors
/// A fault of the study; the Python environment cannot be created; no run gave a value of the objective; a file cannot
/// be written.
pub fn run(workspace: &Workspace, arguments: &Arguments, watch: Option<Watch>) -> Result<Outcome> {
    let stated = Stated::read(workspace, &arguments.study)?;
    let shown = arguments.study.display();
    let at = || format!("{shown}");
    let factors = design::bounded(&stated.definition, &stated.component).with_context(at)?;
    let (factors, bounds): (Vec<_>, Vec<_>) = factors.into_iter().unzip();
    let task = task(&stated.definition, &stated.folder, &stated.component, &factors).with_context(at)?;
    let goal = Goal::new(&stated.definition, &task.responses.columns).with_context(at)?;
    let columns = columns_of(&task).with_context(at)?;
    let search = stated.definition.search;
    let evaluations = search.map_or(FOR_EACH * factors.len() as u64, |search| search.evaluations);
    if !BUDGET.contains(&evaluations) {
        bail!("{shown}: search.evaluations = {evaluations}: must be from {} to {}", BUDGET.start(), BUDGET.end());
    }
    // Invalid common values are rejected before the optimiser starts.
    Runner::new(&task, stated.component.clone()).with_context(at)?;
    let out = arguments
        .out
        .clone()
        .unwrap_or_else(|| workspace.output("optimise").join(arguments.study.file_stem().unwrap_or_default()));
    files::make_folder(&out, "--out")?;
    let mut component = stated.component.clone();
    let present = factors.iter().map(|factor| Ok(component.real(factor.reference)?)).collect::<Result<Vec<f64>>>()?;
    let space = Space { bounds };
    let seed = search.map_or(0, |search| search.seed);
    let problem = Problem { limits: goal.limits(), start: space.nearest(&present), evaluations, seed };
    let mut found = Found::default();
    let why =
        look(workspace, &task, &stated.component, &goal, (&space, &present, &problem), (arguments, watch), &mut found)?;
    write_table(&out, arguments.csv, (&columns, seed), &found)?;
    let Some(best) = found.best else {
        let reason = found.all.iter().map(|(evaluation, _)| &*evaluation.message).find(|message| !message.is_empty());
        bail!(
            "none of {} runs has a value of the objective and of all responses with limits; the message of the first \
             run is: {}",
            found.all.len(),
            reason.unwrap_or("nothing")
        );
    };
    let made = Made { stated: &stated, task: &task, goal: &goal, found: &found };
    write_design(&made, best, &out)?;
    let outcome = if why.is_some() { Outcome::Complete } else { Outcome::Interrupted };
    let why = why.unwrap_or_else(|| "stopped by the user".to_owned());
    let summary = made.summary(best, (&space, seed, &why), &problem);
    files::replace(&out.join(SUMMARY), serde_json::to_string_pretty(&summary)?.as_bytes())?;
    made.print(best, &why, &out);
    if arguments.page {
        let name = arguments.study.file_stem().unwrap_or_default().to_string_lossy();
        page::draw(workspace, (&name, &stated.definition), (&columns, factors.len()), (&out, PARQUET))?;
        eprintln!("{}", out.join(page::PAGE).display());
    }
    Ok(outcome)
}

/// Factors, responses, and the excess over limits.
fn columns_of(task: &Task) -> Result<Vec<Column>> {
    let mut all = columns(task)?;
    if all.iter().any(|column| column.name == VIOLATION) {
        bail!("responses.{VIOLATION}: the results already have a column of this name; rename the response");
    }
    all.push(Column { name: VIOLATION.to_owned(), content: Content::Number, unit: String::new() });
    Ok(all)
}

/// Evaluate the present design and the points of the optimiser. Returns the reason for the end, or none if the user
/// ended the search.
fn look(
    workspace: &Workspace,
    task: &Task,
    model: &Component,
    goal: &Goal,
    (space, present, problem): (&Space, &[f64], &Problem),
    (arguments, watch): (&Arguments, Option<Watch>),
    found: &mut Found,
) -> Result<Option<String>> {
    let threads = match arguments.threads {
        Some(threads) => threads as usize,
        None => std::thread::available_parallelism().map_or(1, usize::from),
    };
    let stop_wish = stop_wish();
    let mut evaluator = Evaluator::new(task, model, threads)?;
    let worth_of = |evaluation: &Evaluation| match evaluation.is_failure {
        true => None,
        false => goal.worth(&evaluation.responses),
    };
    let Some(first) = evaluator.evaluate(&[present.to_vec()], stop_wish) else { return Ok(None) };
    for evaluation in first {
        let worth = worth_of(&evaluation);
        found.add(evaluation, worth, space.contains(present));
    }
    let mut optimiser = Optimiser::start(workspace, problem)?;
    let bar = Bar::new(problem.evaluations, 0, watch);
    loop {
        let points = match optimiser.next()? {
            Said::End(why) => return Ok(Some(why)),
            Said::Points(points) => points.iter().map(|point| space.values(point)).collect::<Vec<_>>(),
        };
        let Some(evaluations) = evaluator.evaluate(&points, stop_wish) else { return Ok(None) };
        let all: Vec<Option<Worth>> = evaluations.iter().map(worth_of).collect();
        optimiser.answer(&all)?;
        bar.add(evaluations.len() as u64);
        for (evaluation, worth) in evaluations.into_iter().zip(all) {
            found.add(evaluation, worth, true);
        }
        if let Some(best) = found.best {
            bar.show(format!(", best {}", goal.described(&found.all[best].0.responses)));
        }
    }
}

/// Write all evaluations in the order of the requests.
fn write_table(out: &Path, with_csv: bool, (columns, seed): (&[Column], u64), found: &Found) -> Result<()> {
    let mut parquet = Partial::<Parquet>::begin(&out.join(PARQUET), columns, Some(seed))?;
    let mut csv = with_csv.then(|| Partial::<Csv>::begin(&out.join(CSV), columns, Some(seed))).transpose()?;
    for ((evaluation, worth), run) in found.all.iter().zip(0..) {
        let Evaluation { point, responses, is_failure, message } = evaluation;
        let violation = worth.as_ref().map_or(f64::NAN, Worth::violation);
        let values = [point.as_slice(), responses, &[violation]].concat();
        let remark = Remark { is_failure: *is_failure, text: message };
        let rows = Rows { runs: run..run + 1, values, remarks: vec![(run, remark)] };
        parquet.add(&rows)?;
        csv.as_mut().map_or(Ok(()), |csv| csv.add(&rows))?;
    }
    parquet.end()?;
    csv.map_or(Ok(()), Partial::end)
}

/// The results with the data from which they were computed.
struct Made<'a> {
    stated: &'a Stated,
    task: &'a Task,
    goal: &'a Goal,
    found: &'a Found,
}

impl Made<'_> {
    /// One design with its responses.
    fn design(&self, index: usize) -> Value {
        let (evaluation, worth) = &self.found.all[index];
        let named = |names: &mut dyn Iterator<Item = &str>, values: &[f64]| -> Value {
            names.zip(values).map(|(name, value)| (name.to_owned(), json!(value))).collect::<Map<_, _>>().into()
        };
        json!({
            "evaluation": index,
            "factors": named(&mut self.task.factors.iter().map(|factor| &*factor.name), &evaluation.point),
            "responses": named(&mut self.task.responses.columns.iter().map(String::as_str), &evaluation.responses),
            "constraints": self.goal.limits_with_values(&evaluation.responses),
            "violation": worth.as_ref().map(Worth::violation),
            "failed": evaluation.is_failure,
            "message": evaluation.message,
        })
    }

    fn summary(&self, best: usize, (space, seed, why): (&Space, u64, &str), problem: &Problem) -> Value {
        let names = self.task.factors.iter().map(|factor| &factor.name);
        let bounds = names.zip(&space.bounds).map(|(name, bounds)| (name.clone(), json!(bounds)));
        json!({
            "ended": why,
            "seed": seed,
            "evaluations": self.found.all.len() - 1,
            "most_evaluations": problem.evaluations,
            "failed": self.found.all.iter().filter(|(evaluation, _)| evaluation.is_failure).count(),
            "bounds": bounds.collect::<Map<_, _>>(),
            "present": self.design(0),
            "best": self.design(best),
        })
    }

    /// Print the outcome.
    fn print(&self, best: usize, why: &str, out: &Path) {
        let worth = self.found.all[best].1.as_ref().map_or(f64::NAN, Worth::violation);
        let objective = |index: usize| self.goal.described(&self.found.all[index].0.responses);
        eprintln!("{why}; {} evaluations", self.found.all.len() - 1);
        if worth > 0.0 {
            eprintln!(
                "warning: no design satisfies all limits; the best design exceeds a limit by {:.3} %",
                100.0 * worth
            );
        }
        eprintln!("original design: {}; best design: {}", objective(0), objective(best));
        for (factor, value) in self.task.factors.iter().zip(&self.found.all[best].0.point) {
            eprintln!("  {} = {value}", factor.name);
        }
        eprintln!("{}", out.join(self.stated.model.kind).display());
        eprintln!("{}", out.join(SUMMARY).display());
        eprintln!("{}", out.join(PARQUET).display());
    }
}

/// Write the definition with the best values, and the picture of both designs.
fn write_design(made: &Made, best: usize, out: &Path) -> Result<()> {
    let source = &made.stated.model;
    let names = made.task.factors.iter().map(|factor| &*factor.name);
    let values: Vec<(&str, f64)> = names.zip(made.found.all[best].0.point.iter().copied()).collect();
    let text = definition_values::with_values(source.kind, &source.text, &values)
        .with_context(|| format!("{}: the definition with these values cannot be written", source.shown))?;
    files::replace(&out.join(source.kind), text.as_bytes())?;
    let after = Component::from_definition(source.kind, &text)?;
    if let (Some(before), Some(after)) = (placed(&made.stated.component), placed(&after)) {
        let designs = [("original design", &before.0, &*before.1), ("best", &after.0, &*after.1)];
        let picture = drawing::designs(made.stated.component.name(), designs, drawing::Format::Page { width: WIDTH });
        files::replace(&out.join(PICTURE), drawing::to_svg(&picture, drawing::Colours::Own, "designs")?.as_bytes())?;
    }
    Ok(())
}

/// Scene and start poses of a mechanism. None for another model.
fn placed(component: &Component) -> Option<(Scene, Vec<Pose>)> {
    let Component::Mechanism(model) = component else { return None };
    let mut model = model.clone();
    model.initialize().ok()?;
    Some((model.scene().ok()?, model.poses()?))
}
