//! Set-up: the time to read a mechanism, trace its curve and build the tables for a first step, the time after a
//! parameter change, of the whole life of an instance through the C functions, and of the first calls in a process.
use crate::cosim::fmus::first_calls;
use crate::gear::{Gear, LAST, live};
use crate::instructions::REPEAT;
use crate::measure::{self, Pages, digits, heading, timed};
use crate::scene::{DEFAULT, SCENES, SPAN};
use fmu_build::chain;
use fmu_build::workspace::{MECHANISM, Workspace};
use linkage_fmu::component::{Component, TABLES};
use linkage_fmu::fmi2::host::Description;
use linkage_fmu::fmi2::types::Status;
use linkage_fmu::mechanism::definition::Mechanism;
use linkage_fmu::mechanism::interface;
use linkage_fmu::mechanism::reduced::Reduced;
use linkage_fmu::mechanism::{Model, ModelError};
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Numbers of runs, of which the fastest counts, in general and for the longest mechanism.
const RUNS: usize = 100;
const LONG_RUNS: usize = 10;
/// Word of this program's command line for the first calls in a process, and the number of processes.
pub const FIRST: &str = "first";
const PROCESSES: usize = 50;
/// Tolerance of runs after fmi2Reset.
const TOLERANCE: f64 = 1e-9;

/// The tables as Markdown.
pub fn table(descriptions: &Path) -> Result<Pages, String> {
    let mut page = measure::page("setup", &[("runs", &RUNS), ("long_runs", &LONG_RUNS)]);
    page += &heading(&["mechanism", "read", "variables", "curve", "tables", "all", "first step"]);
    for folder in Workspace::locate().description_folders().map_err(|e| format!("{e:#}"))? {
        // Other kinds of models have no curve.
        if !folder.join("resources").join(MECHANISM).is_file() {
            continue;
        }
        let name = folder.file_name().unwrap_or_default().to_string_lossy();
        page += &parts(&name, &measure::mechanism(&folder)?, RUNS).map_err(|e| format!("{name}: {e}"))?;
    }
    page += &parts("Chain of 40 four-bars", &chain::text(40), LONG_RUNS).map_err(|e| e.to_string())?;
    let gear = descriptions.join("LandingGearRetraction");
    changes(&mut page, descriptions)?;
    resets(&mut page, &gear)?;
    life(&mut page, &gear)?;
    fresh(&mut page)?;
    Ok(Pages { page, csv: String::new() })
}

/// The row of a mechanism: times of the parts of its set-up [us], each the fastest of all runs.
fn parts(name: &str, text: &str, runs: usize) -> Result<String, ModelError> {
    let mut least = [f64::INFINITY; 7];
    let [read, variables, curve, reduced, model, initialize, step] = &mut least;
    for _ in 0..runs {
        let mechanism = timed(read, || Mechanism::from_json(text))?;
        timed(variables, || interface::variables(&mechanism))?;
        timed(curve, || Reduced::trace(&mechanism))?;
        timed(reduced, || Reduced::new(&mechanism))?;
        let mut gear = timed(model, || Model::from_json(text))?;
        timed(initialize, || gear.initialize())?;
        let h = gear.experiment().step_size;
        timed(step, || gear.step(h))?;
    }
    let [read, variables, curve, reduced, model, initialize, step] = least.map(|seconds| seconds * 1e6);
    let (tables, all) = (reduced - curve, model + initialize);
    Ok(format!("| {name} | {read:.0} | {variables:.0} | {curve:.0} | {tables:.0} | {all:.0} | {step:.1} |\n"))
}

/// Two shafts with gears between them.
const GEARS: &str = r#"{ "name": "Shafts",
    "bodies": { "ground": { "points": { "far": [0.18, 0.24] } }, "one": { "mass": 2, "inertia": 0.02 },
        "two": { "mass": 5, "inertia": 0.5 } },
    "joints": { "a": { "type": "revolute", "first": "ground.origin", "second": "one.origin" },
        "b": { "type": "revolute", "first": "ground.far", "second": "two.origin" } },
    "couplings": { "mesh": { "type": "gears", "first": "one.origin", "second": "two.origin", "first_teeth": 17,
        "second_teeth": 43, "phase": 0, "pressure_angle": 0.35 } },
    "torques": { "motor": { "on": "one", "torque": 3 } },
    "start": { "body": "one", "angle": 0.4, "speed": 0 }, "guess": { "one": 0.4, "two": 1.1 } }"#;

/// A parameter, and what its change rebuilds.
type Change = (&'static str, &'static str);

/// Time to initialise a mechanism again after a parameter change.
fn changes(out: &mut String, descriptions: &Path) -> Result<(), String> {
    *out += &format!("\n{}", measure::page("changes", &[]));
    *out += &heading(&["mechanism", "parameter", "what is built again", "time"]);
    let of = |name: &str| measure::mechanism(&descriptions.join(name));
    let loads = "nothing but the names and laws of the loads";
    let curve = "curve and tables";
    let gear: &[Change] = &[
        ("crank.start_speed", "nothing"),
        ("solver.tolerance", "nothing"),
        ("downstop.restitution", loads),
        ("friction.kinetic_coefficient", loads),
        ("joint1.pin_radius", "names and laws; tables of friction when it acts"),
        ("crank.actuator_x", "tables"),
        ("gravity.acceleration", "two tables, as sums"),
        ("gravity.up_angle", "two tables, as sums"),
        ("crank.mass", curve),
        ("crank.length", curve),
    ];
    let drive: &[Change] = &[("actuator.motion.duration", loads), ("actuator.motion.distance", loads)];
    let family: &[Change] = &[("load_ratio", curve), ("size", curve)];
    let shafts: &[Change] = &[("mesh.pressure_angle", loads), ("mesh.phase", curve), ("mesh.first_teeth", curve)];
    for (mechanism, text, list) in [
        ("Gear", of("LandingGearRetraction")?, gear),
        ("Drive", of("SmoothRetraction")?, drive),
        ("Family", of("FourBarFamily")?, family),
        ("Shafts", GEARS.to_owned(), shafts),
    ] {
        for (name, again) in list {
            let time = change(&text, name).map_err(|e| format!("{mechanism}, {name}: {e}"))?;
            let _ = writeln!(out, "| {mechanism} | {name} | {again} | {:.0} |", time * 1e6);
        }
    }
    Ok(())
}

/// Least time from the change of a parameter to the initialised model [s].
fn change(text: &str, name: &str) -> Result<f64, ModelError> {
    let mut model = Model::from_json(text)?;
    let reference = model.variables().find(name).unwrap_or(u32::MAX);
    let stated = model.real(reference)?;
    let mut least = f64::INFINITY;
    for run in 0..RUNS {
        // A new value each time, as results for recent values are cached.
        let value = stated + 1e-6 * (1 + run) as f64;
        timed(&mut least, || model.set_real(reference, value).and_then(|()| model.initialize()))?;
    }
    Ok(least)
}

/// The calls from fmi2Reset up to the first doStep of the run with this number.
type Restart<'a> = &'a dyn Fn(usize) -> Result<(), String>;

/// Time from fmi2Reset to the first doStep.
fn resets(out: &mut String, folder: &Path) -> Result<(), String> {
    *out += &format!("\n{}", measure::page("resets", &[]));
    *out += &heading(&["set after the reset", "up to the first step", "with the step"]);
    let gear = Gear::new(folder, &DEFAULT, TOLERANCE)?;
    let friction = SCENES.iter().find(|scene| scene.name == "friction").ok_or("no scene with friction")?;
    let turns = |name: &'static str| {
        let stated = gear.get(name)?;
        Ok::<_, String>((name, [stated, stated + 1e-3]))
    };
    let [gravity, length] = [turns("gravity.acceleration")?, turns("crank.length")?];
    let ways: [(&str, Restart); 4] = [
        ("nothing", &|_| gear.restart(&DEFAULT, TOLERANCE)),
        ("friction.enabled", &|_| gear.restart(friction, TOLERANCE)),
        (gravity.0, &|run| gear.restart_with(gravity.0, gravity.1[run % 2])),
        (length.0, &|run| gear.restart_with(length.0, length.1[run % 2])),
    ];
    for (name, restart) in ways {
        let (mut start, mut whole) = (f64::INFINITY, f64::INFINITY);
        for run in 0..RUNS {
            timed(&mut start, || restart(run))?;
            timed(&mut whole, || restart(run).and_then(|()| gear.step(SPAN)))?;
        }
        let _ = writeln!(out, "| {name} | {:.1} | {:.1} |", start * 1e6, whole * 1e6);
    }
    Ok(())
}

/// Time of an instance's whole life through the C functions, with and without the FMU's stored tables.
fn life(out: &mut String, folder: &Path) -> Result<(), String> {
    let text = measure::mechanism(folder)?;
    let bytes = Component::from_definition(MECHANISM, &text).map_err(|e| e.0)?.tables(&text).unwrap_or_default();
    let size = bytes.len() / 1000;
    *out += &format!("\n{}", measure::page("life", &[("outputs", &LAST.len()), ("kilobytes", &size)]));
    *out += &heading(&["", "instantiate", "first reaction after the start", "whole life"]);
    for (name, tables) in [("with tables", Some(&bytes)), ("without", None)] {
        let packed = TempDir::new(name)?;
        let resources = packed.0.join("resources");
        let failed = |e| format!("{}: {e}", resources.display());
        fs::create_dir_all(&resources).map_err(failed)?;
        fs::write(resources.join(MECHANISM), &text).map_err(failed)?;
        let description = Description::read(&packed.0)?;
        // Instances of one text without tables share what was computed, also with the description.
        match &tables {
            Some(tables) => fs::write(resources.join(TABLES), tables),
            None => fs::write(resources.join(MECHANISM), format!("{text} ")),
        }
        .map_err(failed)?;
        let [mut whole, mut instantiation, mut reaction] = [f64::INFINITY; 3];
        for _ in 0..RUNS {
            let host = timed(&mut instantiation, || description.instantiate(None, false))?;
            if (host.set_up(None, 0.0, None), host.initialize()) != (Status::Ok, Status::Ok) {
                return Err("the gear cannot be initialised".to_owned());
            }
            timed(&mut reaction, || host.get("joint1.force")).map_err(|status| format!("{status:?}"))?;
            drop(host);
            timed(&mut whole, || live(&description))?;
        }
        let [instantiation, reaction, whole] = [instantiation, reaction, whole].map(|seconds| seconds * 1e6);
        let _ = writeln!(out, "| {name} | {instantiation:.0} | {reaction:.0} | {whole:.0} |");
    }
    Ok(())
}

/// Least and median times of the first calls of the packed FMU in new processes.
fn fresh(out: &mut String) -> Result<(), String> {
    let (file, folder) = (crate::pack("LandingGearRetraction")?, TempDir::new("fresh")?);
    let program = std::env::current_exe().map_err(|e| e.to_string())?;
    let mut times: [Vec<f64>; 5] = Default::default();
    for _ in 0..PROCESSES {
        let done = Command::new(&program).args([REPEAT, FIRST]).args([&file, &folder.0]).output();
        let done = done.map_err(|e| format!("{}: {e}", program.display()))?;
        let text = String::from_utf8_lossy(&done.stdout);
        let own: Vec<f64> = text.split_whitespace().filter_map(|number| number.parse().ok()).collect();
        if own.len() != times.len() {
            return Err(format!("first calls: {text}{}", String::from_utf8_lossy(&done.stderr)));
        }
        times.iter_mut().zip(own).for_each(|(all, time)| all.push(time));
    }
    *out += &format!("\n{}", measure::page("fresh", &[("processes", &PROCESSES)]));
    *out += &heading(&["", "load", "instantiate", "initialise", "first step", "first four reactions"]);
    times.iter_mut().for_each(|all| all.sort_by(f64::total_cmp));
    for (name, at) in [("least", 0), ("median", PROCESSES / 2)] {
        let row = times.each_ref().map(|all| digits(all[at]));
        let _ = writeln!(out, "| {name} | {} |", row.join(" | "));
    }
    Ok(())
}

/// Prints the times of the first calls in this process [us].
///
/// # Errors
/// As [`first_calls`].
pub fn first(file: &Path, folder: &Path) -> Result<(), String> {
    let reactions = ["joint1.force", "joint2.force", "joint3.force", "joint4.force"];
    first_calls(file, folder, reactions)?.iter().for_each(|time| println!("{}", time * 1e6));
    Ok(())
}

/// A folder that is deleted with this value.
struct TempDir(PathBuf);

impl TempDir {
    fn new(name: &str) -> Result<Self, String> {
        let path = std::env::temp_dir().join(format!("linkage-fmu {} {name}", std::process::id()));
        fs::create_dir_all(&path).map_err(|e| format!("{}: {e}", path.display()))?;
        Ok(Self(path))
    }
}

impl Drop for TempDir {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}
