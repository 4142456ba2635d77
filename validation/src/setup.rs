//! Set-up: what it costs to read a mechanism, trace its curve and build the tables that a first step needs, what a
//! changed parameter costs, and a whole life through the C functions.
use crate::gear::{LAST, live};
use crate::measure;
use fmu_build::chain::mechanism;
use linkage_fmu::fmi2::host::Description;
use linkage_fmu::mechanism::definition::Mechanism;
use linkage_fmu::mechanism::interface;
use linkage_fmu::mechanism::reduced::Reduced;
use linkage_fmu::mechanism::{Model, ModelError};
use std::fmt::Write;
use std::path::Path;
use std::time::Instant;

/// Runs of which the fastest counts, and those of the longest mechanism.
const RUNS: usize = 100;
const LONG_RUNS: usize = 10;

/// Times [us], each the fastest of all runs.
struct Parts {
    read: f64,
    variables: f64,
    curve: f64,
    reduced: f64,
    model: f64,
    initialize: f64,
    step: f64,
}

/// The tables in Markdown.
pub fn table(descriptions: &Path) -> Result<String, String> {
    let mut out = String::from("# Set-up\n\n");
    let _ = writeln!(
        out,
        "In the engine, without a host, one core, in us; each part is the fastest of {RUNS} runs, {LONG_RUNS} for the \
         chain of 40 four-bars, the parts taken in turn. \
         Read: JSON and its checks. Variables: names, units, texts, GUID. Curve: closing the loops, tracing. Tables: \
         influences, coordinates and displacements, as many as a default start needs. All: from the text of the file to the \
         initialised model, in one go; besides the parts, it finds the start and tabulates what acts there besides loads of \
         given sizes, springs' dampers, friction or bumpers. First step: one of the default experiment, after that.\n"
    );
    out.push_str(
        "| mechanism | read | variables | curve | tables | all | first step |\n|---|---|---|---|---|---|---|\n",
    );
    for name in names(descriptions)? {
        let text = measure::mechanism(&descriptions.join(&name))?;
        let parts = Parts::measure(&text, RUNS).map_err(|e| format!("{name}: {e}"))?;
        out.push_str(&parts.line(&name));
    }
    let chain = Parts::measure(&mechanism::text(40), LONG_RUNS).map_err(|e| e.to_string())?;
    out.push_str(&chain.line("Chain of 40 four-bars"));
    let gear = descriptions.join("LandingGearRetraction");
    changes(&mut out, &measure::mechanism(&gear)?).map_err(|e| e.to_string())?;
    life(&mut out, &gear)?;
    Ok(out)
}

/// The mechanisms of the repository, by name.
fn names(descriptions: &Path) -> Result<Vec<String>, String> {
    let entries = std::fs::read_dir(descriptions).map_err(|e| format!("{}: {e}", descriptions.display()))?;
    let mut names: Vec<String> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|folder| folder.join("resources/mechanism.json").is_file())
        .filter_map(|folder| Some(folder.file_name()?.to_string_lossy().into_owned()))
        .collect();
    names.sort();
    Ok(names)
}

/// Call, and keep the time [us] in `least` if it is the least; what the call gave is dropped after the clock has
/// stopped.
fn timed<T>(least: &mut f64, call: impl FnOnce() -> T) -> T {
    let began = Instant::now();
    let given = std::hint::black_box(call());
    *least = least.min(began.elapsed().as_secs_f64() * 1e6);
    given
}

impl Parts {
    fn measure(text: &str, runs: usize) -> Result<Self, ModelError> {
        let never = f64::INFINITY;
        let mut least = Self {
            read: never,
            variables: never,
            curve: never,
            reduced: never,
            model: never,
            initialize: never,
            step: never,
        };
        for _ in 0..runs {
            let mechanism = timed(&mut least.read, || Mechanism::from_json(text))?;
            timed(&mut least.variables, || interface::variables(&mechanism))?;
            timed(&mut least.curve, || Reduced::trace(&mechanism))?;
            timed(&mut least.reduced, || Reduced::new(&mechanism))?;
            let mut model = timed(&mut least.model, || Model::from_json(text))?;
            timed(&mut least.initialize, || model.initialize())?;
            let h = model.experiment().step_size;
            timed(&mut least.step, || model.step(h))?;
        }
        Ok(least)
    }

    fn line(&self, name: &str) -> String {
        let Self { read, variables, curve, reduced, model, initialize, step } = self;
        let (tables, all) = (reduced - curve, model + initialize);
        format!("| {name} | {read:.0} | {variables:.0} | {curve:.0} | {tables:.0} | {all:.0} | {step:.1} |\n")
    }
}

/// What it costs to initialise the gear again after a parameter has changed.
fn changes(out: &mut String, text: &str) -> Result<(), ModelError> {
    let _ = writeln!(
        out,
        "\n## A changed parameter\n\nOf the landing gear, from the change to the initialised model, in us.\n\n\
         | parameter | what is built again | time |\n|---|---|---|"
    );
    let mut model = Model::from_json(text)?;
    for (name, again) in [
        ("crank.start_speed", "nothing"),
        ("downstop.restitution", "nothing but the names and laws of the loads"),
        ("gravity.acceleration", "tables"),
        ("crank.length", "curve and tables"),
    ] {
        let reference = model.variables().find(name).unwrap_or_default();
        let stated = model.real(reference)?;
        let mut least = f64::INFINITY;
        for run in 0..RUNS {
            let value = stated + 1e-6 * (1 + run % 2) as f64;
            timed(&mut least, || model.set_real(reference, value).and_then(|()| model.initialize()))?;
        }
        let _ = writeln!(out, "| {name} | {again} | {least:.0} |");
        model.reset();
    }
    Ok(())
}

/// A whole life through the C functions.
fn life(out: &mut String, folder: &Path) -> Result<(), String> {
    let description = Description::read(folder)?;
    let (mut whole, mut instantiation) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..RUNS {
        timed(&mut instantiation, || description.instantiate(None, false))?;
        timed(&mut whole, || live(&description))?;
    }
    let _ = writeln!(
        out,
        "\n## A whole life\n\nOf the landing gear through the FMI functions, in us: instantiate with the file read from the \
         disk's cache, set up and initialise, scene S1 in one doStep of 0.13 s, read {} outputs, free: **{whole:.0}**, of \
         which instantiate {instantiation:.0}.",
        LAST.len()
    );
    Ok(())
}
