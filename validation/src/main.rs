//! Benchmarks: run time against error, on scenes with exact references. Writes its tables beside this package.
mod benchmarks;
mod life;
mod measure;
mod retraction;
mod rigid_fem;
mod setup;
mod stress;
mod stress_report;

use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let results = root.join("results");
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let done = match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [] => tables(root, &results),
        ["stress", ref groups @ ..] => stress_report::run(&results, groups),
        _ => {
            Err("arguments: none for the tables of run times, or `stress`, with names of groups for these alone".into())
        }
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::FAILURE
        }
    }
}

fn tables(root: &Path, results: &Path) -> Result<(), String> {
    let descriptions = root.join("../modelDescription");
    let gear = descriptions.join("LandingGearRetraction");
    publish(&results.join("setup.md"), &setup::table(&descriptions)?)?;
    publish(&results.join("retraction.md"), &retraction::table(&gear)?)?;
    publish(&results.join("rigid_fem.md"), &rigid_fem::table(&gear)?)?;
    publish(&results.join("benchmarks.md"), &benchmarks::table(&descriptions)?)
}

fn publish(target: &Path, table: &str) -> Result<(), String> {
    print!("{table}");
    std::fs::write(target, table).map_err(|e| format!("{}: {e}", target.display()))?;
    println!("\nwritten to {}", target.display());
    Ok(())
}
