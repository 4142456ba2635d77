//! `cargo fmu package --ssp`: mechanisms and their hydraulics as systems of SSP 1.0.
//!
//! In: packed FMUs. Out: `<Name>.ssp` beside them. A master that holds inputs couples the FMUs as they are: the force
//! that a mechanism gets is the mean that its hydraulics predict for the next step.
use crate::archive::{self, Entry};
use crate::xml::ssd::{self, Part, System};
use anyhow::{Context, Result};
use linkage_fmu::hydraulics::ACTUATOR;
use linkage_fmu::variables::{Causality, Value, Variable};
use std::fs;
use std::path::{Path, PathBuf};

/// A system of FMUs of `modelDescription/`.
pub struct Example {
    /// Name of the package.
    name: &'static str,
    /// The FMUs, by their folders.
    pub fmus: &'static [&'static str],
    /// Text of the system structure, from the variables of the FMUs.
    structure: fn(&Example, &[&[Variable]]) -> Result<String>,
}

/// The landing gear and its hydraulic actuator: scene H1 of the coupling benchmark.
pub const PAIR: Example = Example {
    name: "LandingGearRetractionWithHydraulics",
    fmus: &["LandingGearRetraction", "HydraulicActuator"],
    structure: pair,
};
/// Gear, door and the hydraulic system that moves and unlocks both.
pub const LANDING_GEAR: Example = Example {
    name: "LandingGearSystem",
    fmus: &["LandingGearSystemGear", "LandingGearSystemDoor", "LandingGearSystemHydraulics"],
    structure: landing_gear,
};
/// All systems.
pub const SYSTEMS: [Example; 2] = [PAIR, LANDING_GEAR];

/// End of the retraction of the pair, with some time to spare [s].
const PAIR_STOP_TIME: f64 = 4.5;
/// End of the retraction of the landing-gear system [s].
const SYSTEM_STOP_TIME: f64 = 8.0;

/// Write the package of a system, with the variables of its FMUs, which are in the folder.
///
/// # Errors
/// A variable is missing, or a file cannot be read or written.
pub fn write(out: &Path, system: &Example, variables: &[&[Variable]]) -> Result<PathBuf> {
    let mut entries = Vec::new();
    for name in system.fmus {
        let path = out.join(name).with_extension("fmu");
        let content = fs::read(&path).with_context(|| format!("{}: cannot be read", path.display()))?;
        entries.push(Entry { name: format!("resources/{name}.fmu"), content });
    }
    let content = (system.structure)(system, variables)?.into_bytes();
    entries.push(Entry { name: ssd::PATH.to_owned(), content });
    let path = out.join(system.name).with_extension("ssp");
    archive::write(&path, entries)?;
    println!("{}", path.display());
    Ok(path)
}

/// Text of a system with these parts, connections and open connectors.
fn text(
    system: &Example,
    names: &[&str],
    variables: &[&[Variable]],
    values: &[&[(&str, Value)]],
    connections: &[[(usize, String); 2]],
    (open, stop_time): (&[(usize, &str)], f64),
) -> Result<String> {
    let files: Vec<String> = system.fmus.iter().map(|name| format!("{name}.fmu")).collect();
    let parts: Vec<Part<'_>> = (0..files.len())
        .map(|i| Part { name: names[i], file: &files[i], variables: variables[i], values: values[i] })
        .collect();
    let connections: Vec<[(usize, &str); 2]> =
        connections.iter().map(|ends| ends.each_ref().map(|(part, name)| (*part, name.as_str()))).collect();
    System { name: system.name, parts: &parts, connections: &connections, open, stop_time }.text()
}

fn pair(system: &Example, variables: &[&[Variable]]) -> Result<String> {
    // Both FMUs have what the gear tells of its motion and of itself under one name.
    let told = variables[1].iter().filter(|v| v.causality == Causality::Input && v.name.starts_with(ACTUATOR));
    let mut connections: Vec<_> = told.map(|v| [(0, v.name.clone()), (1, v.name.clone())]).collect();
    connections.push([(1, "preview.force_mean".to_owned()), (0, "actuator.force".to_owned())]);
    let of_gear = [("downstop.enabled", Value::Boolean(false))];
    let of_hydraulics =
        [("command.ramp_amplitude", 0.65), ("command.ramp_time", 0.1)].map(|(name, value)| (name, Value::Real(value)));
    let open = [(1, "valve.command"), (0, "crank.angle")];
    let ends = (&open[..], PAIR_STOP_TIME);
    text(system, &["gear", "hydraulics"], variables, &[&of_gear, &of_hydraulics], &connections, ends)
}

fn landing_gear(system: &Example, variables: &[&[Variable]]) -> Result<String> {
    const OIL: usize = 2;
    let names = ["gear", "door", "hydraulics"];
    let mut connections = Vec::new();
    for (lock, part) in [("uplock", 0), ("downlock", 0), ("doorlock", 1)] {
        connections.push([(OIL, format!("{lock}.engaged")), (part, format!("{lock}.engage"))]);
    }
    for (part, cylinder) in names[..OIL].iter().enumerate() {
        let inputs = variables[OIL].iter().filter(|v| v.causality == Causality::Input);
        let own = inputs.filter_map(|v| Some((v, v.name.strip_prefix(cylinder)?.strip_prefix('.')?)));
        connections.extend(own.map(|(v, name)| [(part, [ACTUATOR, name].concat()), (OIL, v.name.clone())]));
        connections.push([(OIL, format!("{cylinder}.preview.force_mean")), (part, [ACTUATOR, "force"].concat())]);
    }
    let pilot = ["selector.command", "engine_pump.speed", "gear_dump.open", "door_dump.open", "hand_pump.pressure"]
        .map(|n| (OIL, n));
    let open = [&pilot[..], &[(0, "crank.angle"), (1, "door.angle")]].concat();
    text(system, &names, variables, &[&[], &[], &[]], &connections, (&open, SYSTEM_STOP_TIME))
}
