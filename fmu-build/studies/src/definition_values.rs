//! Writes values of variables into the text of a definition.
//!
//! In: a definition, values of parameters and inputs by name. Out: the text with other numbers, otherwise unchanged.
//! The number for a start value is found by trial: a model of the new text has the value, and all other values are
//! unchanged.

use anyhow::{Context, Result, bail};
use linkage_fmu::component::Component;
use linkage_fmu::format::{Json, Node, parse};
use linkage_fmu::variables::{Causality, Kind, Reference};
use std::ops::Range;

/// Relative difference below which two numbers are equal except for the rounding of a unit.
const CLOSE: f64 = 1e-12;

/// The text with these start values.
///
/// # Errors
/// The text is no definition; a variable is unknown, or no single number of the text determines its value.
pub fn with_values(kind: &str, text: &str, values: &[(&str, f64)]) -> Result<String> {
    let mut text = text.to_owned();
    for (name, value) in values {
        text = with_value(kind, &text, name, *value)?;
    }
    Ok(text)
}

fn with_value(kind: &str, text: &str, name: &str, value: f64) -> Result<String> {
    let mut model = Component::from_definition(kind, text)?;
    let reference = model.interface().find(name).with_context(|| format!("there is no variable {name}"))?;
    let before = starts(&mut model)?;
    let own = model.real(reference)?;
    if own == value {
        return Ok(text.to_owned());
    }
    let mut numbers = Vec::new();
    collect(&parse("definition", text)?, &mut numbers);
    // In a file with other units the number differs from the value.
    let scale = |number: f64| if own == 0.0 || number == own { 1.0 } else { number / own };
    numbers.sort_by_key(|(_, number)| !is_close(*number, own));
    for (range, number) in numbers {
        let changed = value * scale(number);
        if !changed.is_finite() {
            continue;
        }
        let written = [&text[..range.start], &serde_json::to_string(&changed)?, &text[range.end..]].concat();
        let Ok(mut other) = Component::from_definition(kind, &written) else { continue };
        let after = starts(&mut other)?;
        let is_own = |found: f64| found == value || is_close(found, value);
        let fits = after.len() == before.len()
            && before.iter().zip(&after).all(|((place, before), (other, after))| {
                place == other && if *place == reference { is_own(*after) } else { before.to_bits() == after.to_bits() }
            });
        if fits {
            return Ok(written);
        }
    }
    bail!(
        "{name} = {value}: this value cannot be written into the definition, because no single number of the \
         definition sets {name} alone; change the definition, or use a start value"
    )
}

/// Start values of all numbers that a host can set.
fn starts(model: &mut Component) -> Result<Vec<(Reference, f64)>> {
    let settable = |(reference, variable): (Reference, &linkage_fmu::variables::Variable)| {
        let is_set = matches!(variable.causality, Causality::Parameter | Causality::Input);
        (is_set && variable.kind == Kind::Real).then_some(reference)
    };
    let all: Vec<Reference> = (0..).zip(model.interface().list()).filter_map(settable).collect();
    all.into_iter().map(|reference| Ok((reference, model.real(reference)?))).collect()
}

fn is_close(a: f64, b: f64) -> bool {
    (a - b).abs() <= CLOSE * a.abs().max(b.abs())
}

/// Numbers of a text, with their ranges of bytes.
fn collect(node: &Node, numbers: &mut Vec<(Range<usize>, f64)>) {
    match &node.json {
        Json::Number(number) => numbers.push((node.span.clone(), *number)),
        Json::List(nodes) => nodes.iter().for_each(|node| collect(node, numbers)),
        Json::Object(members) => members.iter().for_each(|member| collect(&member.value, numbers)),
        Json::Null | Json::Flag(_) | Json::Text(_) => {}
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    const GEAR: &str = include_str!("../../../modelDescription/LandingGearRetraction/resources/mechanism.json");

    #[test]
    fn only_the_numbers_of_the_variables_change() {
        let values = [("crank.actuator_y", -0.1525), ("joint3.pin_radius", 0.016), ("actuator.force", 25000.0)];
        let text = with_values("mechanism.json", GEAR, &values).unwrap();
        // Of the three pins of 0.015 m only that of joint3 has changed.
        let expected = GEAR.replace("[-0.050, -0.138]", "[-0.050, -0.1525]");
        let expected = expected.replace("\"force\": 30000", "\"force\": 25000.0");
        let expected = expected.replace(
            "\"second\": \"follower.end\", \"pin_radius\": 0.015",
            "\"second\": \"follower.end\", \"pin_radius\": 0.016",
        );
        assert_eq!(text, expected);
    }

    #[test]
    fn a_value_in_the_unit_of_the_file_is_written_in_it() {
        let degrees = GEAR.replacen('{', "{ \"units\": { \"angle\": \"deg\" },", 1);
        let degrees = degrees
            .replace("\"up_angle\": 1.13", "\"up_angle\": 64.74")
            .replace("\"angle\": -2.4", "\"angle\": -137.5");
        let degrees = degrees.replace("\"flow_angle\": -0.4407963267948966", "\"flow_angle\": -25.25");
        let degrees =
            degrees.replace("\"angle\": -1.3", "\"angle\": -74.5").replace("\"angle\": 0.8", "\"angle\": 45.8");
        let degrees = degrees.replace(
            "\"crank\": 0.8, \"coupler\": 0.46, \"follower\": 2.43",
            "\"crank\": 45.8, \"coupler\": 26, \"follower\": 139",
        );
        let text = with_values("mechanism.json", &degrees, &[("upstop.angle", -1.25)]).unwrap();
        let mut model = Component::from_definition("mechanism.json", &text).unwrap();
        let reference = model.interface().find("upstop.angle").unwrap();
        assert!((model.real(reference).unwrap() + 1.25).abs() < 1e-15);
        assert!(text.contains("\"limit\": \"lower\", \"angle\": -71.6"), "{text}");
    }

    #[test]
    fn variables_without_a_number_in_the_definition_are_errors() {
        let error = with_values("mechanism.json", GEAR, &[("solver.max_steps", 7.0)]).unwrap_err().to_string();
        assert!(error.contains("no single number of the definition sets solver.max_steps alone"), "{error}");
    }
}
