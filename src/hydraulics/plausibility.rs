//! Numbers of a circuit that look wrong: in another unit, or against one another.
//!
//! In: values by name. Out: warnings. It must not know laws.
use super::definition::Circuit;
use foundation::inspection::Finding;
use foundation::numerics::decimal::Decimal;
use std::f64::consts::FRAC_PI_4;

/// Numbers beyond which another unit is probable: name, least and largest plausible value, unit, what to check.
const PLAUSIBLE: [(&str, f64, f64, &str, &str); 14] = [
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
    ("valve.overlap", -1.0, 1.0, "1", "spool positions are from -1 to 1: write a small fraction of 1"),
    ("valve.frequency", 0.5, 1e4, "Hz", "write the frequency in Hz"),
];

/// Flows that limit the speed, by their names: each with the chamber, A or B, whose area it is for, and what to do.
const THROTTLES: [(&str, usize, &str); 5] = [
    ("valve.rated_flow", 0, "state the rated flow of the valve"),
    ("restrictor_a.rated_flow", 0, "state the rated flow of the restrictor, or 0 for no restrictor"),
    ("restrictor_b.rated_flow", 1, "state the rated flow of the restrictor, or 0 for no restrictor"),
    ("cushion_a.rated_flow", 0, "state the rated flow of the cushion, or 0 for no cushion"),
    ("cushion_b.rated_flow", 1, "state the rated flow of the cushion, or 0 for no cushion"),
];
/// Part of the speed of the default cylinder below which a default flow throttles another cylinder.
const THROTTLED: f64 = 0.5;

/// Warnings about flows that a definition leaves at their defaults, which suit the default cylinder, where the cylinder
/// is so much larger that they limit its speed.
fn throttled(path: &str, value: &impl Fn(&str) -> Option<f64>, all: &mut Vec<Finding>) {
    let default = Circuit::default();
    let (bore, rod) = (default.cylinder.bore, default.cylinder.rod);
    let areas = |bore: f64, rod: f64| [bore * bore, bore * bore - rod * rod].map(|square| FRAC_PI_4 * square);
    let [Some(own_bore), Some(own_rod)] = ["cylinder.bore", "cylinder.rod"].map(value) else { return };
    let defaults = [
        default.valve.rated_flow,
        default.restrictor_a.rated_flow,
        default.restrictor_b.rated_flow,
        default.cushion_a.rated_flow,
        default.cushion_b.rated_flow,
    ];
    for ((name, side, remedy), flow) in THROTTLES.into_iter().zip(defaults) {
        let [speed, usual] = [areas(own_bore, own_rod)[side], areas(bore, rod)[side]].map(|area| flow / area);
        if flow > 0.0 && value(name) == Some(flow) && speed < THROTTLED * usual {
            let message = format_args!(
                "the rated flow is {} m3/s, the default value, which suits a bore of {} m: in this cylinder, the rated \
                 flow limits the piston speed to {} m/s at the rated pressure drop",
                Decimal(flow),
                Decimal(bore),
                Decimal::rounded(speed)
            );
            all.push(Finding::warning(format_args!("{path}{name}"), message, remedy));
        }
    }
}

/// Keys of circuit and network alike whose numbers have the same plausible values; 0 leaves out what they are about.
const SHARED: [&str; 9] = [
    "ambient_pressure",
    "bulk_modulus",
    "air_fraction",
    "bore",
    "stroke",
    "closed_length",
    "rated_pressure_drop",
    "overlap",
    "frequency",
];

/// Remedy for a pressure in another unit.
const PASCAL: &str = "pressures are in Pa: 1 bar = 1e5 Pa, 1 MPa = 1e6 Pa";

/// What is wrong with a number of a network that is probably in another unit, by the path of its key, and the remedy.
pub fn implausible(path: &str, value: f64) -> Option<(String, &'static str)> {
    let last = |path: &str| path.rsplit('.').next().map(str::to_owned);
    let key = last(path)?;
    let (_, least, most, unit, remedy) = match (path.split('.').next()?, key.as_str()) {
        ("accumulators", "volume") => ("", 1e-5, 1.0, "m3", "volumes are in m3: 1 l = 1e-3 m3"),
        (_, "start_pressure" | "precharge_pressure" | "release_pressure" | "max_pressure" | "full_pressure")
        | ("reliefs", "pressure") => ("", 1e4, 1e9, "Pa", PASCAL),
        (_, shared) if SHARED.contains(&shared) => {
            PLAUSIBLE.into_iter().find(|(name, ..)| last(name).as_ref() == Some(&key))?
        }
        _ => return None,
    };
    // A pressure may be below that of the air.
    let is_usual = value == 0.0 || (least..=most).contains(&if unit == "Pa" { value.abs() } else { value });
    (!is_usual).then(|| (unusual(value, [least, most], unit), remedy))
}

fn unusual(value: f64, [least, most]: [f64; 2], unit: &str) -> String {
    let unit = if unit == "1" { String::new() } else { [" ", unit].concat() };
    format!("the value is {}{unit}, but usual values are from {} to {}", Decimal(value), Decimal(least), Decimal(most))
}

/// Warnings about a circuit whose keys stand under `path`, which is empty or ends with a dot; `value`: the start value
/// of a variable by its name.
pub fn circuit_warnings(path: &str, value: impl Fn(&str) -> Option<f64>) -> Vec<Finding> {
    let mut all = Vec::new();
    for (name, least, most, unit, remedy) in PLAUSIBLE {
        if let Some(value) = value(name).filter(|value| !(least..=most).contains(value)) {
            all.push(Finding::warning(format_args!("{path}{name}"), unusual(value, [least, most], unit), remedy));
        }
    }
    throttled(path, &value, &mut all);
    let mut compare = |name: &str, other: &str, ordered: fn(f64, f64) -> bool, words: &str, remedy: &str| {
        if let (Some(one), Some(two)) = (value(name), value(other))
            && !ordered(one, two)
        {
            let message = format_args!("the value is {} Pa, {words} {other} = {} Pa", Decimal(one), Decimal(two));
            all.push(Finding::warning(format_args!("{path}{name}"), message, remedy));
        }
    };
    let remedy = "raise supply.pressure or lower tank.pressure";
    compare("supply.pressure", "tank.pressure", |a, b| a > b, "which is not above", remedy);
    let remedy = "raise relief.pressure; otherwise the relief valves are always open";
    compare("relief.pressure", "supply.pressure", |a, b| a > b, "which is not above", remedy);
    all
}

#[cfg(test)]
mod tests {
    use crate::Model;

    fn warned(json: &str) -> Vec<String> {
        Model::from_json(json).unwrap().warnings().into_iter().map(|finding| finding.path).collect()
    }

    #[test]
    fn a_default_flow_that_throttles_a_larger_cylinder_is_named() {
        assert!(warned(r#"{ "name": "A" }"#).is_empty());
        let larger = r#"{ "name": "A", "circuit": { "cylinder": { "bore": 0.085, "rod": 0.05 },
            "valve": { "rated_flow": 1.5e-4 } } }"#;
        let paths = ["restrictor_a", "cushion_a", "cushion_b"].map(|name| format!("circuit.{name}.rated_flow"));
        assert_eq!(warned(larger), paths);
    }
}
