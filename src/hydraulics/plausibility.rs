//! Numbers of a circuit that look wrong: in another unit, or against one another.
//!
//! In: values by name. Out: warnings. It must not know laws.
use crate::inspection::Finding;
use crate::numerics::decimal::Decimal;

/// Numbers beyond which another unit is probable: name, least and largest plausible value, unit, what to check.
const PLAUSIBLE: [(&str, f64, f64, &str, &str); 13] = [
    ("supply.pressure", 1e5, 1e9, "Pa", "pressures are in Pa: 1 bar = 1e5 Pa, 1 MPa = 1e6 Pa"),
    ("relief.pressure", 1e5, 1e9, "Pa", "pressures are in Pa: 1 bar = 1e5 Pa, 1 MPa = 1e6 Pa"),
    ("fluid.ambient_pressure", 1e3, 1e7, "Pa", "the standard atmosphere is 101325 Pa"),
    ("fluid.bulk_modulus", 1e8, 1e11, "Pa", "the bulk modulus of oil is about 1.4e9 Pa"),
    ("fluid.air_fraction", 0.0, 0.5, "1", "write a fraction of 1, not a percentage"),
    ("cylinder.bore", 1e-3, 2.0, "m", "lengths are in m, not in mm"),
    ("cylinder.stroke", 1e-3, 30.0, "m", "lengths are in m, not in mm"),
    ("cylinder.closed_length", 0.0, 50.0, "m", "lengths are in m, not in mm"),
    ("chamber_a.dead_volume", 1e-9, 0.1, "m3", "volumes are in m3: 1 cm3 = 1e-6 m3"),
    ("chamber_b.dead_volume", 1e-9, 0.1, "m3", "volumes are in m3: 1 cm3 = 1e-6 m3"),
    ("valve.rated_flow", 1e-8, 0.2, "m3/s", "flows are in m3/s: 1 l/min = 1.667e-5 m3/s"),
    ("valve.rated_pressure_drop", 1e4, 1e9, "Pa", "pressures are in Pa: 1 bar = 1e5 Pa"),
    ("valve.frequency", 0.5, 1e4, "Hz", "write the frequency in Hz"),
];

/// Warnings about a circuit whose keys stand under `path`, which is empty or ends with a dot; `value`: the start value
/// of a variable by its name.
pub fn circuit_warnings(path: &str, value: impl Fn(&str) -> Option<f64>) -> Vec<Finding> {
    let mut all = Vec::new();
    for (name, least, most, unit, remedy) in PLAUSIBLE {
        if let Some(value) = value(name).filter(|value| !(least..=most).contains(value)) {
            let message =
                format!("is {} {unit}; usual values are {} to {}", Decimal(value), Decimal(least), Decimal(most));
            all.push(Finding::warning(format_args!("{path}{name}"), message, remedy));
        }
    }
    let mut compare = |name: &str, other: &str, ordered: fn(f64, f64) -> bool, words: &str, remedy: &str| {
        if let (Some(one), Some(two)) = (value(name), value(other))
            && !ordered(one, two)
        {
            let message = format!("is {} Pa, {words} {other} = {} Pa", Decimal(one), Decimal(two));
            all.push(Finding::warning(format_args!("{path}{name}"), message, remedy));
        }
    };
    let remedy = "raise supply.pressure or lower tank.pressure";
    compare("supply.pressure", "tank.pressure", |a, b| a > b, "not above", remedy);
    let remedy = "raise relief.pressure: the relief valves are always open";
    compare("relief.pressure", "supply.pressure", |a, b| a > b, "not above", remedy);
    all
}
