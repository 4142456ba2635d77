//! `cargo fmu package --ssp`: the gear and its hydraulic actuator as a system of SSP 1.0.
//!
//! In: the two packed FMUs. Out: `<Name>.ssp` beside them. A master that holds inputs couples them as they are: the
//! force handed over is the mean that the actuator foresees for the next step.
use crate::archive::{self, Entry};
use crate::xml::ssd::{self, Part, System};
use anyhow::{Context, Result};
use linkage_fmu::hydraulics::ACTUATOR;
use linkage_fmu::variables::{Causality, Value, Variable};
use std::fs;
use std::path::{Path, PathBuf};

/// Name of the package.
const NAME: &str = "LandingGearRetractionWithHydraulics";
/// The FMUs, by their folders in `modelDescription/`.
pub const FMUS: [&str; 2] = ["LandingGearRetraction", "HydraulicActuator"];
/// End of the retraction, with some time to spare [s].
const STOP_TIME: f64 = 4.5;

/// Write the package of two FMUs, with their variables.
///
/// # Errors
/// A variable is missing, or a file cannot be read or written.
pub fn write(out: &Path, fmus: [(&Path, &[Variable]); 2]) -> Result<PathBuf> {
    let mut entries = Vec::new();
    for ((path, _), name) in fmus.iter().zip(FMUS) {
        let content = fs::read(path).with_context(|| format!("{}: cannot be read", path.display()))?;
        entries.push(Entry { name: format!("resources/{name}.fmu"), content });
    }
    let content = structure([fmus[0].1, fmus[1].1])?.into_bytes();
    entries.push(Entry { name: ssd::PATH.to_owned(), content });
    let path = out.join(NAME).with_extension("ssp");
    archive::write(&path, entries)?;
    println!("{}", path.display());
    Ok(path)
}

/// The system structure: scene H1 of the coupling benchmark.
fn structure([gear, hydraulics]: [&[Variable]; 2]) -> Result<String> {
    // Both FMUs have what the gear tells of its motion and of itself under one name.
    let told = hydraulics.iter().filter(|v| v.causality == Causality::Input && v.name.starts_with(ACTUATOR));
    let mut connections: Vec<[(usize, &str); 2]> = told.map(|v| [(0, v.name.as_str()), (1, v.name.as_str())]).collect();
    connections.push([(1, "preview.force_mean"), (0, "actuator.force")]);
    let of_gear = [("downstop.enabled", Value::Boolean(false))];
    let of_hydraulics =
        [("command.ramp_amplitude", 0.65), ("command.ramp_time", 0.1)].map(|(name, value)| (name, Value::Real(value)));
    let parts = [
        Part { name: "gear", file: "LandingGearRetraction.fmu", variables: gear, values: &of_gear },
        Part { name: "hydraulics", file: "HydraulicActuator.fmu", variables: hydraulics, values: &of_hydraulics },
    ];
    let open = [(1, "valve.command"), (0, "crank.angle")];
    System { name: NAME, parts: &parts, connections: &connections, open: &open, stop_time: STOP_TIME }.text()
}
