//! Run time by scene: a whole retraction through the C functions, in one step and in 130, with different loads and
//! outputs.

use crate::gear::Gear;
use crate::measure::{self, Asked, Pages, digits, heading};
use crate::scene::{After, SCENES, SPAN};
use linkage_fmu::integrator::Method;
use linkage_fmu::mechanism::Statistics;
use std::fmt::Write;
use std::path::Path;

/// Tolerance of all runs.
const TOLERANCE: f64 = 1e-9;
/// Title for a table, doSteps in a retraction, and additional calls after each.
const RUNS_OF: [(&str, u32, &[After]); 3] = [
    ("One doStep of 0.13 s", 1, &[]),
    ("130 doSteps of 1 ms", 130, &[]),
    ("130 doSteps of 1 ms, the force changed after each", 130, &[After::Force]),
];
/// Number of runs; the fastest counts.
const RUNS: usize = 400;

/// The table as Markdown and CSV.
pub fn table(descriptions: &Path) -> Result<Pages, String> {
    let folder = &descriptions.join("LandingGearRetraction");
    let text = measure::mechanism(folder)?;
    let mut gears = SCENES.iter().map(|scene| Gear::new(folder, scene, TOLERANCE)).collect::<Result<Vec<_>, _>>()?;
    let mut tables = String::new();
    let mut csv = String::from("scene,steps,inputs,time_us,ratio,evaluations,jacobians,accepted,rejected,methods\n");
    let mut figures = Vec::new();
    for (title, steps, further) in RUNS_OF {
        let inputs = if further.is_empty() { "constant" } else { "changing" };
        let work = ["evaluations", "Jacobians", "steps", "rejected", "steps by method"];
        tables += &format!("## {title}\n\n{}", heading(&[&["scene", "time [us]", "to bare"], &work[..]].concat()));
        let mut times = [f64::INFINITY; SCENES.len()];
        for _ in 0..RUNS {
            for ((time, gear), scene) in times.iter_mut().zip(&mut gears).zip(&SCENES) {
                let after = [scene.after, further].concat();
                gear.run(steps, SPAN / f64::from(steps), &after, std::slice::from_mut(time))?;
            }
        }
        let times = times.map(|seconds| seconds * 1e6);
        for (time, scene) in times.iter().zip(&SCENES) {
            let work = scene.work(&text, TOLERANCE, steps, further).map_err(|e| format!("{}: {e}", scene.name))?;
            let Statistics { evaluations, jacobians, accepted, rejected, .. } = work;
            let (ratio, methods) = (time / times[0], methods(work));
            let _ = writeln!(
                tables,
                "| {} | {} | {} | {evaluations} | {jacobians} | {accepted} | {rejected} | {methods} |",
                scene.title,
                digits(*time),
                digits(ratio)
            );
            let _ = writeln!(
                csv,
                "{},{steps},{inputs},{time:.2},{ratio:.3},{evaluations},{jacobians},{accepted},{rejected},{}",
                scene.name,
                methods.replace(", ", " ")
            );
            if scene.name == "friction" {
                figures.push(Asked::at_most(format!("friction against bare, {title}"), ratio, 5.0, " times"));
            }
        }
        tables.push('\n');
    }
    let words = measure::page("scenes", &[("tolerance", &format!("{TOLERANCE:.0e}")), ("runs", &RUNS)]);
    let page = words + &measure::asked(&figures) + &tables;
    Ok(Pages { page, csv })
}

/// Accepted steps of each method that was used.
fn methods(work: Statistics) -> String {
    let names = [
        ("RKN", Method::Rkn86),
        ("DOP853", Method::Dop853),
        ("DOPRI5", Method::Dopri5),
        ("RK4", Method::Rk4),
        ("Radau", Method::Radau),
    ];
    names
        .map(|(name, method)| (name, work.accepted_by(method)))
        .iter()
        .filter(|(_, count)| *count > 0)
        .map(|(name, count)| format!("{name} {count}"))
        .collect::<Vec<_>>()
        .join(", ")
}
