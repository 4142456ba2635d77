//! Run time over error, one line per setting: scene S1 with this project, by hand and with other Rust solvers, and
//! Andrews' squeezer with this project.
//!
//! usage: peers modelDescription OUT.csv
//!
//! usage: peers modelDescription OUT.csv
mod explicit;
mod four_bar;
mod measure;
mod multistep;
mod project;
mod quadrature;
mod rk4;

use std::error::Error;
use std::path::Path;
use std::process::ExitCode;

/// Rounds of all measurements; the fastest counts, so that a slow period of the processor does not affect one setting
/// alone.
const ROUNDS: u32 = 3;

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
    let [descriptions, target] = &arguments[..] else {
        return Err("usage: peers modelDescription OUT.csv".into());
    };
    let read = |name: &str| {
        let path = Path::new(descriptions).join(name).join("resources/mechanism.json");
        std::fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))
    };
    let gear = project::Scene {
        name: "S1",
        text: read("LandingGearRetraction")?,
        span: four_bar::SPAN,
        output: "crank.angle",
        exact: four_bar::THETA2,
    };
    let squeezer = project::Scene {
        name: "Andrews",
        text: read("AndrewsSqueezer")?,
        span: 0.03,
        output: "K1.angle",
        exact: 15.810_771_195_153_797,
    };
    let round = || -> Result<Vec<measure::Point>, Box<dyn Error>> {
        let mut points = project::landing_gear(&gear)?;
        points.extend(project::squeezer(&squeezer)?);
        points.extend(project::first_reaction(&gear)?);
        points.extend(rk4::points());
        points.extend(quadrature::points());
        points.extend(explicit::points());
        points.extend(multistep::points()?);
        Ok(points)
    };
    let mut points = round()?;
    for _ in 1..ROUNDS {
        points.iter_mut().zip(round()?).for_each(|(point, again)| point.keep_faster(&again));
    }
    let lines: String = points.iter().map(measure::Point::line).collect();
    std::fs::write(target, measure::HEADER.to_string() + &lines).map_err(|e| format!("{target}: {e}"))?;
    println!("{} settings of Rust solvers measured", points.len());
    Ok(())
}
