//! Scene S1 with this project and with other Rust solvers: run time against error, one line a setting.
//!
//! usage: peers MECHANISM.json OUT.csv
mod explicit;
mod four_bar;
mod measure;
mod multistep;
mod project;

use std::error::Error;
use std::process::ExitCode;

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<_> = std::env::args().skip(1).collect();
    let [mechanism, target] = &arguments[..] else {
        return Err("usage: peers MECHANISM.json OUT.csv".into());
    };
    let text = std::fs::read_to_string(mechanism).map_err(|e| format!("{mechanism}: {e}"))?;
    let mut points = project::points(&text)?;
    points.extend(explicit::points());
    points.extend(multistep::points()?);
    let lines: String = points.iter().map(measure::Point::line).collect();
    std::fs::write(target, measure::HEADER.to_string() + &lines).map_err(|e| format!("{target}: {e}"))?;
    println!("{} settings of Rust solvers measured", points.len());
    Ok(())
}
