//! Benchmarks: run time against error, on scenes with exact references. Writes its tables beside this package.
mod benchmarks;
mod life;
mod measure;
mod retraction;
mod rigid_fem;
mod setup;

use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let descriptions = root.join("../modelDescription");
    let tables = [
        ("setup.md", setup::table(&descriptions)),
        ("retraction.md", retraction::table(&descriptions.join("LandingGearRetraction"))),
        ("rigid_fem.md", rigid_fem::table(&descriptions.join("LandingGearRetraction"))),
        ("benchmarks.md", benchmarks::table(&descriptions)),
    ];
    for (name, table) in tables {
        if let Err(message) = table.and_then(|table| publish(&root.join("results").join(name), &table)) {
            eprintln!("error: {message}");
            return ExitCode::FAILURE;
        }
    }
    ExitCode::SUCCESS
}

fn publish(target: &Path, table: &str) -> Result<(), String> {
    print!("{table}");
    std::fs::write(target, table).map_err(|e| format!("{}: {e}", target.display()))?;
    println!("\nwritten to {}", target.display());
    Ok(())
}
