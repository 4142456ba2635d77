//! `cargo fmu sweep`: many runs of a mechanism according to a study.
//!
//! In: a study: factors, a scenario, responses. Out: a table with a row for each run, in the order of the design, for
//! any number of threads and also if the study was ended and resumed. A failed run has a row with its reason.

mod bar;
mod by_energy;
mod chunk;
mod cluster;
mod csv;
mod definition;
mod design;
mod extent;
mod factor;
mod joe_kuo;
mod journal;
pub mod optimise;
mod page;
mod parquet;
mod plan;
mod points;
mod pool;
mod responses;
mod results;
mod run;
mod scenario;
mod table;
mod unit_cube;

use crate::progress::stop_wish;
use crate::simulate::Outcome;
use anyhow::{Context, Result, bail};
use bar::Bar;
pub use bar::Watch;
use by_energy::ByEnergy;
use chunk::Cut;
use cluster::Workers;
use definition::Definition;
use design::Design;
use factor::Factor;
use fmu_build::check;
use fmu_build::files;
use fmu_build::fmu;
use fmu_build::workspace::Workspace;
pub use fmu_cli::Sweep as Arguments;
use journal::Journal;
use linkage_fmu::codec::checksum::fnv1a_128;
use linkage_fmu::component::Component;
use responses::Responses;
use results::Unusual;
use run::{Runner, Task};
use scenario::Scenario;
use serde::{Deserialize, Serialize};
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// File of the results in the output folder.
const PARQUET: &str = "runs.parquet";
const CSV: &str = "runs.csv";
/// File of the completed chunks of an incomplete study.
const JOURNAL: &str = "runs.journal";
/// File with the summary of a complete study.
const SUMMARY: &str = "study.json";

/// Summary of a complete study.
#[derive(Debug, Deserialize, Serialize)]
struct Summary {
    /// Hash of the study and all files to which it refers.
    identity: String,
    runs: u64,
    failed: u64,
}

/// A study with all data to which it refers.
struct Study {
    definition: Definition,
    task: Task,
    design: Design,
    cut: Cut,
    model: fmu::Definition,
    /// Path of the mechanism.
    path: PathBuf,
    identity: u128,
}

/// Make the runs of a study and write their results.
///
/// # Errors
/// A fault of the study; the mechanism gives no model; a file cannot be written. A failed run is no error: the result
/// states whether all runs failed.
pub fn run(workspace: &Workspace, arguments: &Arguments, watch: Option<Watch>) -> Result<Outcome> {
    let study = Study::read(workspace, &arguments.study)?;
    let columns = results::columns(&study.task)?;
    let out = arguments
        .out
        .clone()
        .unwrap_or_else(|| workspace.output("sweep").join(arguments.study.file_stem().unwrap_or_default()));
    files::make_folder(&out, "--out")?;
    let identity = format!("{:032x}", study.identity);
    let draw = || -> Result<()> {
        if arguments.page {
            let name = arguments.study.file_stem().unwrap_or_default().to_string_lossy();
            let columns = (&*columns, study.task.factors.len());
            page::draw(workspace, (&name, &study.definition), columns, (&out, PARQUET))?;
            eprintln!("{}", out.join(page::PAGE).display());
        }
        Ok(())
    };
    if let Some(summary) = complete(&out, &identity, arguments.csv).filter(|_| arguments.resume) {
        eprintln!("{}: the results of all {} runs already exist", out.join(PARQUET).display(), study.design.runs());
        draw()?;
        return Ok(summary.outcome());
    }
    let component = || Ok(Component::from_definition(study.model.kind, &study.model.text)?);
    if let Some(warning) = study.design.far_from_definition(&mut component()?) {
        eprintln!("warning: {warning}");
    }
    if let Some(warning) = extent::warning(&study.task, &study.design, &study.cut, component)? {
        eprintln!("warning: {warning}");
    }
    let mut journal = Journal::open(&out.join(JOURNAL), study.identity, arguments.resume)?;
    let (started, before) = (Instant::now(), journal.len());
    if let Err(error) = make(workspace, &study, arguments, (&mut journal, &out), watch) {
        // Without a completed chunk there is nothing to resume: the next attempt is a new one.
        if journal.len() == 0 {
            journal.remove()?;
        }
        return Err(error);
    }
    let (chunks, seconds) = (journal.len(), started.elapsed().as_secs_f64());
    let runs_of = |chunks: u64| (chunks * study.cut.runs_of(0).end).min(study.design.runs());
    if chunks < study.cut.chunks() {
        eprintln!(
            "the study was stopped after about {} of {} runs; the option --resume continues the study",
            runs_of(chunks),
            study.design.runs()
        );
        return Ok(Outcome::Interrupted);
    }
    let csv = arguments.csv.then(|| out.join(CSV));
    let seed = study.definition.sampling.map(|sampling| sampling.seed);
    let Unusual { failed, reason, others, remarked, first } =
        results::write(&mut journal, &study.cut, (&columns, seed), &out.join(PARQUET), csv.as_deref()).with_context(
            || format!("{}: all runs are complete; --resume writes the results", out.join(JOURNAL).display()),
        )?;
    let summary = Summary { identity, runs: study.design.runs(), failed };
    files::replace(&out.join(SUMMARY), serde_json::to_string_pretty(&summary)?.as_bytes())?;
    journal.remove()?;
    let made = runs_of(chunks) - runs_of(before);
    eprintln!("{made} runs in {seconds:.3} s, {failed} of {} failed", study.design.runs());
    if failed > 0 {
        let others = if others > 0 { format!(" ({others} failed runs have other reasons)") } else { String::new() };
        eprintln!("warning: the first failed run: {reason}{others}");
    }
    if remarked > 0 {
        let runs = study.design.runs();
        eprintln!(
            "warning: {remarked} of {runs} runs have a text in the column `message` of the results; the first text is: \
             {first}"
        );
    }
    eprintln!("{}", out.join(PARQUET).display());
    csv.iter().for_each(|path| eprintln!("{}", path.display()));
    draw()?;
    Ok(summary.outcome())
}

/// Make the missing chunks.
fn make(
    workspace: &Workspace,
    study: &Study,
    arguments: &Arguments,
    (journal, out): (&mut Journal, &Path),
    watch: Option<Watch>,
) -> Result<()> {
    let Study { task, design, cut, model, path, .. } = study;
    let runs_of = |chunk: u64| cut.runs_of(chunk).end - cut.runs_of(chunk).start;
    let missing: Vec<u64> = (0..cut.chunks()).filter(|chunk| !journal.has(*chunk)).collect();
    let make_model = || Ok(Component::from_definition(model.kind, &model.text)?);
    let by_energy = ByEnergy::new(task, design, make_model()?)?;
    let workers = match (&arguments.scheduler, arguments.workers) {
        // The energy integral needs less time than a request to a worker.
        _ if by_energy.is_some() => None,
        (Some(address), _) => Some(Workers::Of(address.clone())),
        (None, count) => count.map(Workers::Local),
    };
    let fmu = match workers {
        Some(_) => Some(cluster::packed(workspace, path, &make_model()?, out)?),
        None => None,
    };
    let done = design.runs() - missing.iter().map(|chunk| runs_of(*chunk)).sum::<u64>();
    let bar = Bar::new(design.runs(), done, watch);
    let keep = |chunk: u64, bytes: Vec<u8>| {
        journal.add(chunk, &bytes)?;
        bar.add(runs_of(chunk));
        Ok(())
    };
    if let (Some(workers), Some(fmu)) = (&workers, &fmu) {
        let model = make_model()?;
        let work = cluster::Work { task, design, cut };
        return cluster::run(workspace, workers, (&work, model.interface()), (fmu, out), &missing, stop_wish(), keep);
    }
    let threads = match arguments.threads {
        Some(threads) => threads as usize,
        None => std::thread::available_parallelism().map_or(1, usize::from),
    };
    pool::run(threads, (task, design, cut), by_energy.as_ref(), &make_model, missing.into_iter(), stop_wish(), keep)
}

/// The summary of this study if the folder has its results.
fn complete(out: &Path, identity: &str, with_csv: bool) -> Option<Summary> {
    let summary: Summary = serde_json::from_slice(&fs::read(out.join(SUMMARY)).ok()?).ok()?;
    let has_files =
        out.join(PARQUET).is_file() && (!with_csv || out.join(CSV).is_file()) && !out.join(JOURNAL).exists();
    (has_files && summary.identity == identity).then_some(summary)
}

impl Summary {
    fn outcome(&self) -> Outcome {
        if self.failed == self.runs { Outcome::Failed } else { Outcome::Complete }
    }
}

impl Study {
    fn read(workspace: &Workspace, path: &Path) -> Result<Self> {
        let Stated { definition, text, folder, mechanism, model, component } = Stated::read(workspace, path)?;
        let shown = path.display();
        if definition.objective.is_some() || !definition.constraints.is_empty() || definition.search.is_some() {
            bail!(
                "{shown}: the keys `objective`, `constraints` and `search` belong to `{} optimise`; remove these \
                 keys",
                workspace.program()
            );
        }
        let design = Design::new(&definition, &folder, &component).with_context(|| format!("{shown}"))?;
        let task = task(&definition, &folder, &component, design.factors()).with_context(|| format!("{shown}"))?;
        // Invalid common values are rejected before the first run.
        Runner::new(&task, component).with_context(|| format!("{shown}"))?;
        let cut = Cut::new(design.runs());
        let mut all = format!("{text}\0{}\0{}\0", model.kind, model.text);
        let files = [&definition.points, &definition.parameters_file, &definition.scenario.input_file];
        for file in files.into_iter().flatten() {
            all.push_str(&format!("{}\0", files::digest(&folder.join(file))?));
        }
        let identity = fnv1a_128([all.as_str(), env!("CARGO_PKG_VERSION")]);
        Ok(Self { definition, task, design, cut, model, path: mechanism, identity })
    }
}

/// A study from its file, with the model of its mechanism.
struct Stated {
    definition: Definition,
    text: String,
    folder: PathBuf,
    /// Path of the mechanism.
    mechanism: PathBuf,
    model: fmu::Definition,
    component: Component,
}

impl Stated {
    fn read(workspace: &Workspace, path: &Path) -> Result<Self> {
        let (definition, text) = Definition::read(path)?;
        let folder = path.parent().map_or_else(PathBuf::new, Path::to_path_buf);
        let shown = path.display();
        let mechanism = folder.join(&definition.mechanism);
        let model = fmu::Definition::read(workspace, &mechanism).with_context(|| format!("{shown}: mechanism"))?;
        let component = check::model(workspace, &model).with_context(|| format!("{shown}: mechanism"))?;
        for finding in component.warnings() {
            eprintln!("warning: {finding}");
        }
        Ok(Self { definition, text, folder, mechanism, model, component })
    }
}

/// Common data of all runs of a study.
fn task(definition: &Definition, folder: &Path, component: &Component, factors: &[Factor]) -> Result<Task> {
    let scenario = Scenario::new(definition, folder, component, factors, &responses::instants(definition)?)?;
    if let Some(factor) = factors.iter().find(|factor| scenario.sets(factor.reference)) {
        bail!(
            "factors.{}: this factor is also set by `start_values` or `scenario`; remove one of the two settings",
            factor.name
        );
    }
    let responses = Responses::new(definition, &scenario, component)?;
    let calls = design::calls(component, factors);
    Ok(Task { factors: factors.to_vec(), calls, scenario, responses })
}
