//! Start values from the command line.
//!
//! In: pairs of a name and a text. Out: a model with these parameters and inputs.

use anyhow::{Context, Result, bail};
use fmu_cli::words::comma;
use linkage_fmu::component::Component;
use linkage_fmu::variables::{Interface, Kind, Reference, Unit, Value, Variable};

/// The values in these words, as `name=value` or as two words, in the order of the variables of the model.
///
/// # Errors
/// A name has no value, is unknown, or is duplicate; a value has the wrong type, or a wrong unit.
pub fn parse(interface: &Interface, words: &[String]) -> Result<Vec<(Reference, Value)>> {
    let mut values: Vec<(Reference, Value)> = Vec::new();
    for (name, text) in pairs(words)? {
        let reference = find(interface, name).context("--start-values")?;
        if values.iter().any(|(other, _)| *other == reference) {
            bail!("--start-values: {name} occurs twice; remove one of the two values");
        }
        let variable = &interface.list()[reference as usize];
        values.push((reference, value(variable, text).context("--start-values")?));
    }
    // Values are set in the order of the variables, like in a host, because the check of a value may depend on previous
    // ones.
    values.sort_by_key(|(reference, _)| *reference);
    Ok(values)
}

/// The value for a variable in a text: a number with or without its unit, a Boolean, or an item of an Enumeration.
///
/// # Errors
/// The text has the wrong type, or a wrong unit.
pub fn value(variable: &Variable, text: &str) -> Result<Value> {
    Ok(match variable.kind {
        Kind::Real => Value::Real(number(&variable.name, variable.unit, text)?),
        Kind::Boolean => Value::Boolean(truth(text).with_context(|| variable.name.clone())?),
        Kind::Enumeration if variable.number_of(text).is_none() => {
            let (name, items) = (&variable.name, variable.details.items.join(", "));
            bail!("{name} must be one of {items}, not \"{}\"", text.escape_debug())
        }
        Kind::Enumeration => Value::Item(text.to_owned()),
    })
}

/// Set these pairs; see [`parse`].
///
/// # Errors
/// As for [`parse`], or the model rejects a value.
pub fn apply(model: &mut Component, words: &[String]) -> Result<()> {
    let values = parse(model.interface(), words)?;
    apply_all(model, values).context("--start-values")
}

/// Set these values, which are in the order of the variables.
///
/// # Errors
/// The model rejects a value.
pub fn apply_all(model: &mut Component, values: Vec<(Reference, Value)>) -> Result<()> {
    let (mut reals, mut others) = (Vec::new(), Vec::new());
    for (reference, value) in values {
        match value {
            Value::Real(value) => reals.push((reference, value)),
            other => others.push((reference, other)),
        }
    }
    for together in reals.chunks(model.most_together()) {
        let (references, values): (Vec<_>, Vec<_>) = together.iter().copied().unzip();
        model.set_reals(&references, &values)?;
    }
    for (reference, value) in others {
        let set = match &value {
            Value::Real(value) => model.set_real(reference, *value),
            Value::Boolean(value) => model.set_boolean(reference, *value),
            Value::Item(value) => model.set_text(reference, value),
        };
        set.with_context(|| model.interface().list()[reference as usize].name.clone())?;
    }
    Ok(())
}

/// Names with their values.
fn pairs(words: &[String]) -> Result<Vec<(&str, &str)>> {
    let (mut pairs, mut words) = (Vec::new(), words.iter());
    while let Some(word) = words.next() {
        match word.split_once('=') {
            Some(pair) => pairs.push(pair),
            None => match words.next() {
                Some(value) => pairs.push((word, value)),
                None => bail!("--start-values: {} has no value; write a value after each name", word.escape_debug()),
            },
        }
    }
    Ok(pairs)
}

/// A number in the unit of the variable `name`. The text may contain this unit, its display unit or another common
/// unit.
///
/// # Errors
/// The text is no number, or has the unit of another quantity.
pub fn number(name: &str, unit: Option<Unit>, text: &str) -> Result<f64> {
    if let Ok(value) = text.parse::<f64>() {
        return Ok(value);
    }
    if let Some(fault) = comma(text) {
        bail!("{name} = {text} {fault}");
    }
    let own = unit.unwrap_or_default();
    // The longest prefix that is a number.
    let ends = (1..text.len()).rev().filter(|&end| text.is_char_boundary(end));
    let split =
        ends.map(|end| text.split_at(end)).find_map(|(a, b)| Some((a.trim_end().parse::<f64>().ok()?, b.trim())));
    let Some((value, unit)) = split else {
        bail!("{name} needs a number, not \"{}\"", text.escape_debug());
    };
    own.convert(value, unit).with_context(|| {
        let others: String = own.others().map(|(other, ..)| format!(" or {other}")).collect();
        let own = own.name();
        format!(
            "the unit of {name} is {own}{others}, not \"{}\"; convert the value to {own}{others}",
            unit.escape_debug()
        )
    })
}

/// The variable with this name.
///
/// # Errors
/// No variable has the name. The message contains similar names.
pub fn find(interface: &Interface, name: &str) -> Result<Reference> {
    interface.find(name).with_context(|| {
        let nearest = interface.nearest(name).join(", ");
        format!("there is no variable \"{}\": the most similar names are {nearest}", name.escape_debug())
    })
}

/// A Boolean.
///
/// # Errors
/// The text is no Boolean.
pub fn truth(text: &str) -> Result<bool> {
    match text.trim().to_ascii_lowercase().as_str() {
        "true" | "1" => Ok(true),
        "false" | "0" => Ok(false),
        _ => bail!("\"{}\" is not true or false; write true or false", text.escape_debug()),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use linkage_fmu::variables::COMMON;

    const GEAR: &str = include_str!("../../modelDescription/LandingGearRetraction/resources/mechanism.json");

    fn gear(words: &[&str]) -> Result<Component> {
        let mut gear = Component::from_definition("mechanism.json", GEAR).unwrap();
        apply(&mut gear, &words.iter().map(|word| (*word).to_owned()).collect::<Vec<_>>())?;
        Ok(gear)
    }

    fn angle(words: &[&str]) -> f64 {
        let mut gear = gear(words).unwrap();
        let reference = gear.interface().find("crank.start_angle").unwrap();
        gear.real(reference).unwrap()
    }

    #[test]
    fn a_number_may_have_its_unit_or_its_display_unit() {
        assert_eq!(angle(&["crank.start_angle", "0.5"]), 0.5);
        assert_eq!(angle(&["crank.start_angle=0.5rad"]), 0.5);
        assert_eq!(angle(&["crank.start_angle", "-45 deg"]), -std::f64::consts::FRAC_PI_4);
        assert_eq!(angle(&["crank.start_angle=-4.5e1deg"]), -std::f64::consts::FRAC_PI_4);
    }

    #[test]
    fn a_number_may_have_a_common_unit() {
        let mut gear = gear(&["crank.mass=1500 g", "crank.length=175mm", "actuator.force=30 kN"]).unwrap();
        for (name, value) in [("crank.mass", 1.5), ("crank.length", 0.175), ("actuator.force", 3e4)] {
            let reference = gear.interface().find(name).unwrap();
            assert_eq!(gear.real(reference).unwrap(), value, "{name}");
        }
        // No common unit has the name of an SI unit or of a display unit.
        for (name, si, by, over) in COMMON {
            assert!(Unit::ALL.iter().all(|unit| unit.name() != name) && by > 0.0 && over > 0.0, "{name}");
            assert!(si.display().is_none_or(|(shown, _)| shown != name), "{name}");
        }
    }

    #[test]
    fn every_kind_is_set() {
        let words = ["solver.method=rigid_fem", "friction.enabled", "TRUE", "actuator.force", "-1e3"];
        let mut gear = gear(&words).unwrap();
        let find = |gear: &Component, name: &str| gear.interface().find(name).unwrap();
        let [method, friction, force] =
            ["solver.method", "friction.enabled", "actuator.force"].map(|name| find(&gear, name));
        assert_eq!(gear.item(method).unwrap(), 1);
        assert!(gear.boolean(friction).unwrap());
        assert_eq!(gear.real(force).unwrap(), -1e3);
    }

    #[test]
    fn wrong_start_values_are_rejected_with_their_name() {
        for (words, said) in [
            (&["crank.start_angle"][..], "crank.start_angle has no value"),
            (&["crank.start_angel=1"], "most similar names are crank.start_angle"),
            (&["crank.mass=1", "crank.mass=2"], "crank.mass occurs twice"),
            (&["crank.mass=12lb"], "the unit of crank.mass is kg or g or t, not \"lb\""),
            (&["crank.start_angle=12grad"], "the unit of crank.start_angle is rad or deg, not \"grad\""),
            (&["crank.length=12kN"], "the unit of crank.length is m or mm or cm, not \"kN\""),
            (&["crank.mass=heavy"], "crank.mass needs a number, not \"heavy\""),
            (&["actuator.force", "40,000"], "actuator.force = 40,000 is ambiguous; write 40000, or 40 if"),
            (&["crank.mass", "0,5"], "has a decimal comma; write a point: 0.5"),
            (&["crank.start_angle=-12,5 deg"], "has a decimal comma; write a point: -12.5 deg"),
            (&["crank.mass=-1"], "crank.mass"),
            (&["friction.enabled=2"], "\"2\" is not true or false"),
            (&["solver.method=magic"], "solver.method must be one of reduced, rigid_fem, not \"magic\""),
            (&["crank.angle=1"], "crank.angle"),
        ] {
            let error = format!("{:#}", gear(words).unwrap_err());
            assert!(error.contains(said), "{words:?}: {error}");
        }
    }
}
