//! Benchmarks: run time against error, on scenes with exact references. Writes its tables beside this package.
mod asked;
mod benchmarks;
mod bodies;
mod gear;
mod instructions;
mod measure;
mod retraction;
mod rigid_fem;
mod scene;
mod scenes;
mod setup;
mod steps;
pub mod stress;
mod stress_report;
mod untabled;

use measure::Pages;
use std::path::Path;

/// Run the benchmarks that the command line names.
///
/// # Errors
/// The arguments are none of these, a call is refused, a scene fails, or a file cannot be written.
pub fn run(arguments: &[&str]) -> Result<(), String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let results = root.join("results");
    let gear = root.join("../modelDescription/LandingGearRetraction");
    match arguments {
        [] => tables(root, &results),
        ["instructions"] => count(&results),
        ["stress", groups @ ..] => stress_report::run(&results, groups),
        &[instructions::REPEAT, scene, reads, steps, repetitions] => {
            instructions::repeat(&gear, [scene, reads, steps, repetitions])
        }
        _ => {
            Err("arguments: none for the tables of run times, `instructions`, or `stress` with names of groups".into())
        }
    }
}

fn tables(root: &Path, results: &Path) -> Result<(), String> {
    let descriptions = root.join("../modelDescription");
    let gear = descriptions.join("LandingGearRetraction");
    publish(&results.join("setup.md"), &setup::table(&descriptions)?)?;
    publish_both(results, "steps", &steps::table(&gear)?)?;
    publish_both(results, "scenes", &scenes::table(&gear)?)?;
    publish_both(results, "bodies", &bodies::table()?)?;
    publish_both(results, "untabled", &untabled::table(&descriptions)?)?;
    publish_both(results, "retraction", &retraction::table(&gear)?)?;
    publish(&results.join("rigid_fem.md"), &rigid_fem::table(&gear)?)?;
    publish_both(results, "benchmarks", &benchmarks::table(&descriptions)?)
}

fn count(results: &Path) -> Result<(), String> {
    match instructions::table()? {
        Some(pages) => publish_both(results, "instructions", &pages),
        None => {
            println!("instructions are not counted: there is no valgrind (Debian: apt-get install valgrind)");
            Ok(())
        }
    }
}

fn publish_both(results: &Path, name: &str, pages: &Pages) -> Result<(), String> {
    let csv = results.join(name).with_extension("csv");
    std::fs::write(&csv, &pages.csv).map_err(|e| format!("{}: {e}", csv.display()))?;
    publish(&results.join(name).with_extension("md"), &pages.page)
}

fn publish(target: &Path, table: &str) -> Result<(), String> {
    print!("{table}");
    std::fs::write(target, table).map_err(|e| format!("{}: {e}", target.display()))?;
    println!("\nwritten to {}", target.display());
    Ok(())
}
