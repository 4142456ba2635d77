//! Instructions per scene, counted by callgrind: reproducible on every machine with the same compiler.
//!
//! A count is the difference of two runs of this program that differ in the number of repetitions only, so that it
//! contains neither set-up nor program start.

use crate::callgrind::difference;
use crate::gear::Gear;
use crate::measure::{self, Pages, heading};
use crate::scene::{After, DEFAULT, PRESCRIBED, SCENES, SPAN, Scene};
use crate::versions;
use std::fmt::Write;
use std::path::Path;
use std::process::Command;

/// Argument of this program for the repetition of one scene.
pub const REPEAT: &str = "repeat";
/// Tolerance of all runs.
const TOLERANCE: f64 = 1e-9;
/// Counted instead of a retraction: fmi2Reset and all calls up to the first doStep.
const RESET: &str = "reset";
/// Repetitions of the run that is subtracted, in which tables are built on first use.
const FEW: u32 = 1;
/// Total number of doSteps of the additional repetitions, unless one repetition has more; greatest number of
/// repetitions.
const FURTHER: u32 = 6500;
const MOST: u32 = 200;
/// Scenes of doSteps: name, and calls after a step.
const READS: [(&str, &[After]); 7] = [
    ("nothing", &[]),
    ("motion", &[After::Motion]),
    ("reactions", &[After::Reactions]),
    ("each_reaction", &[After::EachReaction]),
    ("outputs", &[After::Outputs]),
    ("changed_force", &[After::Force, After::Reactions]),
    ("serialised", &[After::Serialised]),
];
/// Number of doSteps in a retraction: of 0.13 s, 10 ms, 1 ms and 10 us.
const COUNTS: [u32; 4] = [1, 13, 130, 13_000];

/// The table as Markdown and CSV; None without callgrind.
pub fn table() -> Result<Option<Pages>, String> {
    if !Command::new("valgrind").arg("--version").output().is_ok_and(|output| output.status.success()) {
        return Ok(None);
    }
    let mut rows = String::from("## A retraction, by scene\n\n");
    rows += &heading(&["scene", "one doStep of 0.13 s", "to bare", "130 of 1 ms", "to bare"]);
    let mut csv = String::from("scene,reads,steps,instructions_per_run,instructions_per_step\n");
    let mut bare = [0.0; 2];
    for scene in &SCENES {
        let _ = write!(rows, "| {} |", scene.title);
        for (steps, bare) in [1, 130].into_iter().zip(&mut bare) {
            let count = instructions(scene.name, "scene", steps)?;
            if scene.name == SCENES[0].name {
                *bare = count;
            }
            let _ = write!(rows, " {count:.0} | {:.2} |", count / *bare);
            let _ = writeln!(csv, "{},scene,{steps},{count:.0},{:.1}", scene.name, count / f64::from(steps));
        }
        rows.push('\n');
    }
    rows += "\n## A doStep, default scene, with what is read after it\n\n";
    rows += &heading(&["read", "0.13 s", "10 ms", "1 ms", "10 us"]);
    for (name, _) in READS {
        rows += &row(&name.replace('_', " "), (DEFAULT.name, name), &mut csv)?;
    }
    rows += "\n## A doStep under a prescribed motion\n\n";
    rows += &heading(&["friction", "0.13 s", "10 ms", "1 ms", "10 us"]);
    for scene in &PRESCRIBED {
        rows += &row(scene.title, (scene.name, READS[0].0), &mut csv)?;
    }
    rows += &format!("\n{}", measure::page("reset", &[]));
    rows += &heading(&["scene", "instructions"]);
    for scene in SCENES.iter().filter(|scene| scene.after.is_empty()) {
        let count = instructions(scene.name, RESET, 1)?;
        let _ = writeln!(rows, "| {} | {count:.0} |", scene.title);
        let _ = writeln!(csv, "{},{RESET},0,{count:.0},", scene.name);
    }
    let (versions, lines) = versions::table()?;
    rows += &versions;
    csv += &lines;
    let words = measure::page("instructions", &[("tolerance", &format!("{TOLERANCE:.0e}")), ("most", &MOST)]);
    Ok(Some(Pages { page: words + &rows, csv }))
}

/// The row of a scene with its calls: instructions of a step, by step size.
fn row(title: &str, (scene, reads): (&str, &str), csv: &mut String) -> Result<String, String> {
    let mut row = format!("| {title} |");
    for steps in COUNTS {
        let count = instructions(scene, reads, steps)?;
        let _ = write!(row, " {:.0} |", count / f64::from(steps));
        let _ = writeln!(csv, "{scene},{reads},{steps},{count:.0},{:.1}", count / f64::from(steps));
    }
    Ok(row + "\n")
}

/// Instructions of one run of the scene.
fn instructions(scene: &str, reads: &str, steps: u32) -> Result<f64, String> {
    let further = (FURTHER / steps).clamp(1, MOST);
    let words =
        |repetitions| [REPEAT, scene, reads].map(str::to_owned).into_iter().chain([steps.to_string(), repetitions]);
    difference(|repetitions| words(repetitions).collect(), FEW, FEW + further)
}

/// Run one scene: its name, `scene` or the calls after a step, number of doSteps in a retraction, repetitions.
pub fn repeat(descriptions: &Path, words: [&str; 4]) -> Result<(), String> {
    let [name, reads, steps, repetitions] = words;
    let number = |word: &str| word.parse::<u32>().map_err(|e| format!("{word}: {e}"));
    let scene: &Scene =
        SCENES.iter().chain(&PRESCRIBED).find(|s| s.name == name).ok_or_else(|| format!("no scene {name}"))?;
    let after = READS.iter().find(|(word, _)| *word == reads).map_or(scene.after, |(_, after)| after);
    let (steps, repetitions) = (number(steps)?, number(repetitions)?);
    let mut gear = Gear::new(&descriptions.join(scene.mechanism), scene, TOLERANCE)?;
    if reads == RESET {
        return (0..repetitions).try_for_each(|_| gear.restart(scene, TOLERANCE));
    }
    for _ in 0..repetitions {
        gear.run(steps, SPAN / f64::from(steps), after, &mut [f64::INFINITY])?;
    }
    Ok(())
}
