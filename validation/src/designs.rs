//! Random designs: the time of a study that evaluates each geometry once.
//!
//! In: the landing gear. Out: times of designs with random attachments and lengths: set the parameters, initialise, one
//! run to the end of the travel, read reactions.
use crate::attack::random::Random;
use crate::measure::{self, Pages, heading};
use linkage_fmu::mechanism::{Model, ModelError};
use std::fmt::{Display, Write};
use std::path::Path;
use std::time::Instant;

/// Number of designs, and seed of the random numbers.
const DESIGNS: usize = 1500;
const SEED: u64 = 1;
/// Coordinates of the attachments, and their greatest displacement [m].
const ATTACHMENTS: [&str; 4] = ["crank.actuator_x", "crank.actuator_y", "follower.actuator_x", "follower.actuator_y"];
const MOVED: f64 = 0.3;
/// Lengths, and their greatest relative change.
const LENGTHS: [&str; 4] = ["ground.length", "crank.length", "coupler.length", "follower.length"];
const CHANGED: f64 = 0.1;
/// Reactions that are read.
const REACTIONS: [&str; 4] = ["joint1.force", "joint2.force", "joint3.force", "joint4.force"];
/// Number of steps of a run, and their length [s].
const STEPS: usize = 130;
const STEP: f64 = 1e-3;

/// Times of one design [s].
#[derive(Clone, Copy)]
struct Times {
    /// Set the parameters and initialise.
    start: f64,
    /// A run in one step.
    run: f64,
    /// Read one reaction after the run.
    one: f64,
    /// A run of [`STEPS`] steps with all reactions read after each.
    all: f64,
}

/// The table as Markdown.
pub fn table(descriptions: &Path) -> Result<Pages, String> {
    let text = measure::mechanism(&descriptions.join("LandingGearRetraction"))?;
    let mut model = Model::from_json(&text).map_err(|e| e.to_string())?;
    let mut random = Random::new(SEED);
    let (mut times, mut refused) = (Vec::new(), 0);
    for _ in 0..DESIGNS {
        match design(&mut model, &mut random) {
            Ok(own) => times.push(own),
            Err(_) => refused += 1,
        }
    }
    let values: [(&str, &dyn Display); 4] =
        [("moved", &MOVED), ("changed", &(100.0 * CHANGED)), ("designs", &DESIGNS), ("refused", &refused)];
    let mut page = measure::page("designs", &values);
    page += &heading(&["", "median", "99 %"]);
    type Of = fn(&Times) -> f64;
    let rows: [(&str, Of); 5] = [
        ("parameters set, initialised", |t| t.start),
        ("a run in one step", |t| t.run),
        ("the first reaction, at its end", |t| t.one),
        ("**design, run, one reaction**", |t| t.start + t.run + t.one),
        ("**design, 130 steps, four reactions after each**", |t| t.start + t.all),
    ];
    for (name, of) in rows {
        let mut all: Vec<f64> = times.iter().map(|times| of(times) * 1e6).collect();
        all.sort_by(f64::total_cmp);
        let part = |part: f64| all.get((part * all.len() as f64) as usize).copied().unwrap_or(f64::NAN);
        let _ = writeln!(page, "| {name} | {:.0} | {:.0} |", part(0.5), part(0.99));
    }
    Ok(Pages { page, csv: String::new() })
}

/// Times of one random design. The run with reactions in each step uses a separate copy with separate tables.
fn design(model: &mut Model, random: &mut Random) -> Result<Times, ModelError> {
    let references = |names: [&str; 4]| names.map(|name| model.variables().find(name).unwrap_or_default());
    let (attachments, lengths, reactions) = (references(ATTACHMENTS), references(LENGTHS), references(REACTIONS));
    model.reset();
    let mut values = Vec::new();
    for reference in attachments {
        values.push((reference, model.real(reference)? + MOVED * random.within(-1.0, 1.0)));
    }
    for reference in lengths {
        values.push((reference, model.real(reference)? * (1.0 + CHANGED * random.within(-1.0, 1.0))));
    }
    let set = |model: &mut Model| {
        values.iter().try_for_each(|(reference, value)| model.set_real(*reference, *value))?;
        model.initialize()
    };
    // The copy was made before, so that it shares no table of this design.
    let mut twin = model.clone();
    let start = measured(|| set(model))?;
    let run = measured(|| model.step(STEPS as f64 * STEP))?;
    let one = measured(|| model.real(reactions[0]).map(|_| ()))?;
    set(&mut twin)?;
    let all = measured(|| {
        (0..STEPS).try_for_each(|_| {
            twin.step(STEP)?;
            reactions.iter().try_for_each(|reference| twin.real(*reference).map(|_| ()))
        })
    })?;
    Ok(Times { start, run, one, all })
}

/// Time of a call [s].
fn measured(call: impl FnOnce() -> Result<(), ModelError>) -> Result<f64, ModelError> {
    let began = Instant::now();
    std::hint::black_box(call())?;
    Ok(began.elapsed().as_secs_f64())
}
