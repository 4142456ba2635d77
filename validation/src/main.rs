//! Benchmarks: run time against error, on scenes with exact references. Writes its tables beside this package.
mod retraction;

use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let table = match retraction::table(&root.join("../modelDescription/LandingGearRetraction")) {
        Ok(table) => table,
        Err(message) => {
            eprintln!("error: {message}");
            return ExitCode::FAILURE;
        }
    };
    print!("{table}");
    let target = root.join("results/retraction.md");
    match std::fs::write(&target, table) {
        Ok(()) => {
            println!("\nwritten to {}", target.display());
            ExitCode::SUCCESS
        }
        Err(e) => {
            eprintln!("error: {}: {e}", target.display());
            ExitCode::FAILURE
        }
    }
}
