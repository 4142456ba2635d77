//! The reader of parameter sets of SSP 1.0 (SSV files): values of parameters and inputs with their units.
//!
//! In: the text of the file, of any program; the variables of a model. Out: values in the units of the variables. A
//! unit of the file has a factor, an offset and exponents of base units: SI value = factor * value + offset (SSP 1.0.1,
//! section 4.6.4). The module must not know what the variables mean.

use super::description::Attributes;
use crate::{files, start_values};
use anyhow::{Context, Result, bail};
use linkage_fmu::variables::{Causality, Interface, Kind, Reference, Unit, Value, Variable};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use std::collections::BTreeMap;
use std::path::Path;

/// Largest parameter set that is read [bytes].
const LARGEST: u64 = 16 << 20;
/// Base units of SSP, in the order of the exponents of a unit.
const BASE: [&str; 8] = ["kg", "m", "s", "rad", "A", "K", "mol", "cd"];

/// A value as it is in the file.
#[derive(Clone, Debug, PartialEq)]
enum Stated {
    /// A number with the name of its unit. The name is empty if there is none.
    Real(f64, String),
    Integer(i64),
    Boolean(bool),
    /// A String, or the name of an item of an Enumeration.
    Text(String),
}

/// A unit that the file defines.
#[derive(Clone, Debug, Default, PartialEq)]
struct Measure {
    exponents: [i32; BASE.len()],
    factor: f64,
    offset: f64,
}

/// Contents of a file.
#[derive(Debug, Default)]
struct ParameterSet {
    parameters: Vec<(String, Option<Stated>)>,
    units: Vec<(String, Option<Measure>)>,
}

/// The values of a parameter set for a model with these variables, in the order of the variables.
///
/// # Errors
/// The file cannot be read, or is no parameter set; a name is no parameter and no input, or is duplicate; a value has
/// another type than the variable, or the unit of another quantity.
pub fn read(path: &Path, interface: &Interface) -> Result<Vec<(Reference, Value)>> {
    let bytes = files::read(path, LARGEST)?;
    let shown = path.display();
    let text =
        String::from_utf8(bytes).ok().with_context(|| format!("{shown}: is not UTF-8 text; save the file as UTF-8"))?;
    ParameterSet::parse(&text).and_then(|set| set.values(interface)).with_context(|| shown.to_string())
}

impl ParameterSet {
    fn parse(xml: &str) -> Result<Self> {
        let mut reader = Reader::from_str(xml.trim_start_matches('\u{feff}'));
        let mut set = Self::default();
        // Open elements, without the prefixes of their namespaces.
        let mut open: Vec<String> = Vec::new();
        let mut is_set = false;
        loop {
            let event = reader.read_event();
            let event = event.with_context(|| format!("the text is not XML at byte {}", reader.error_position()))?;
            match &event {
                Event::Start(element) | Event::Empty(element) => {
                    let tag = element.local_name().as_ref().to_owned();
                    if open.is_empty() && tag != "ParameterSet" {
                        bail!("the root element is {tag}; give a parameter set of SSP, whose root is ParameterSet");
                    }
                    is_set = true;
                    set.take(&open, &tag, element)?;
                    if matches!(event, Event::Start(_)) {
                        open.push(tag);
                    }
                }
                Event::End(_) => drop(open.pop()),
                Event::Eof => break,
                _ => {}
            }
        }
        if let Some(element) = open.last() {
            bail!("the text is not XML: it ends within the element {element}");
        }
        if !is_set {
            bail!("the file has no element; give a parameter set of SSP, whose root is ParameterSet");
        }
        Ok(set)
    }

    /// Read the data of an element with these parents.
    fn take(&mut self, open: &[String], tag: &str, element: &BytesStart) -> Result<()> {
        let path: Vec<&str> = open.iter().skip(1).map(String::as_str).collect();
        let attributes = || Attributes::of(element).with_context(|| format!("element {tag}"));
        match path[..] {
            ["Parameters"] if tag == "Parameter" => self.parameters.push((attributes()?.take("name"), None)),
            ["Units"] if tag == "Unit" => self.units.push((attributes()?.take("name"), None)),
            ["Parameters", "Parameter"] if tag != "Annotations" => {
                if let Some((name, value)) = self.parameters.last_mut() {
                    *value = Some(stated(tag, attributes()?).with_context(|| format!("parameter {name}"))?);
                }
            }
            ["Units", "Unit"] if tag == "BaseUnit" => {
                if let Some((name, measure)) = self.units.last_mut() {
                    *measure = Some(Measure::of(attributes()?).with_context(|| format!("unit {name}"))?);
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn values(&self, interface: &Interface) -> Result<Vec<(Reference, Value)>> {
        let mut values = BTreeMap::new();
        for (name, value) in &self.parameters {
            let reference = start_values::find(interface, name)?;
            let variable = &interface.list()[reference as usize];
            if !matches!(variable.causality, Causality::Parameter | Causality::CalculatedParameter | Causality::Input) {
                bail!("{name} is an output; a parameter set has values of parameters and inputs, so remove {name}");
            }
            let value =
                value.as_ref().with_context(|| format!("parameter {name}: the value is missing; add a Real"))?;
            if values.insert(reference, self.value(variable, value)?).is_some() {
                bail!("{name} occurs twice; remove one of the two values");
            }
        }
        Ok(values.into_iter().collect())
    }

    /// A value in the unit of its variable.
    fn value(&self, variable: &Variable, value: &Stated) -> Result<Value> {
        let name = &variable.name;
        Ok(match (variable.kind, value) {
            (Kind::Real, Stated::Real(value, unit)) => Value::Real(self.in_si(variable, *value, unit)?),
            (Kind::Real, Stated::Integer(value)) => Value::Real(*value as f64),
            (Kind::Boolean, Stated::Boolean(value)) => Value::Boolean(*value),
            (Kind::Enumeration, Stated::Text(item)) => start_values::value(variable, item)?,
            (Kind::Enumeration, Stated::Integer(number)) => {
                let items = variable.details.items;
                let index = usize::try_from(*number).ok().and_then(|number| number.checked_sub(1));
                let item = index.and_then(|index| items.get(index)).with_context(|| {
                    format!(
                        "{name} = {number}: the items are {}, with the numbers 1 to {}",
                        items.join(", "),
                        items.len()
                    )
                })?;
                Value::Item((*item).to_owned())
            }
            (kind, value) => {
                let (kind, other) = (kind.word(), value.word());
                bail!("{name} is a {kind}, but the parameter set states a {other}; write a {kind}")
            }
        })
    }

    /// A number with a unit, converted to the SI unit of its variable.
    fn in_si(&self, variable: &Variable, value: f64, unit: &str) -> Result<f64> {
        let name = &variable.name;
        let own = variable.unit.unwrap_or_default();
        let measure = self.units.iter().find(|(defined, _)| defined == unit);
        let in_si = match measure {
            _ if unit.is_empty() => value,
            Some((_, Some(measure))) if measure.exponents == exponents(own) => measure.factor * value + measure.offset,
            Some((_, Some(measure))) => bail!(
                "{name}: the unit \"{}\" is {}, but the unit of {name} is {}, which is {}; state the value in a unit \
                 of the same quantity",
                unit.escape_debug(),
                in_words(measure.exponents),
                own.name(),
                in_words(exponents(own))
            ),
            // Programs omit the definitions of common units.
            _ => start_values::number(&variable.name, variable.unit, &format!("{value:?} {unit}"))
                .context("the element Units of the parameter set does not define the unit")?,
        };
        if !in_si.is_finite() {
            bail!("{name} = {value} {unit}: the value must be finite");
        }
        Ok(in_si)
    }
}

impl Stated {
    /// The type in SSP.
    fn word(&self) -> &'static str {
        match self {
            Self::Real(..) => "Real",
            Self::Integer(_) => "Integer",
            Self::Boolean(_) => "Boolean",
            Self::Text(_) => "String or an item of an Enumeration",
        }
    }
}

/// The value in an element with this name.
fn stated(tag: &str, mut attributes: Attributes) -> Result<Stated> {
    if !attributes.0.contains_key("value") {
        bail!("the element {tag} has no attribute value");
    }
    Ok(match tag {
        "Real" => {
            let value = attributes.number("value")?.unwrap_or_default();
            Stated::Real(value, attributes.take("unit"))
        }
        "Integer" => {
            let text = attributes.take("value");
            let value = text.trim().parse();
            Stated::Integer(value.with_context(|| format!("value is \"{text}\", which is not a whole number"))?)
        }
        "Boolean" => Stated::Boolean(start_values::truth(&attributes.take("value"))?),
        "String" | "Enumeration" => Stated::Text(attributes.take("value")),
        _ => bail!("the type {tag} is not supported; write Real, Integer, Boolean, String or Enumeration"),
    })
}

impl Measure {
    fn of(mut attributes: Attributes) -> Result<Self> {
        let mut exponents = [0; BASE.len()];
        for (exponent, base) in exponents.iter_mut().zip(BASE) {
            let text = attributes.take(base);
            if !text.is_empty() {
                let read = text.trim().parse();
                *exponent = read.with_context(|| format!("{base} is \"{text}\", which is not a whole number"))?;
            }
        }
        let factor = attributes.number("factor")?.unwrap_or(1.0);
        let offset = attributes.number("offset")?.unwrap_or(0.0);
        if !(factor.is_finite() && factor != 0.0 && offset.is_finite()) {
            bail!("factor = {factor} and offset = {offset} must be finite, and the factor must not be 0");
        }
        Ok(Self { exponents, factor, offset })
    }
}

/// Exponents of the base units of a variable's unit.
fn exponents(unit: Unit) -> [i32; BASE.len()] {
    let own = unit.base();
    BASE.map(|base| own.iter().find(|(name, _)| *name == base).map_or(0, |(_, exponent)| i32::from(*exponent)))
}

/// Base units with their exponents, such as `kg.m2/s2` as `kg m2 s-2`.
fn in_words(exponents: [i32; BASE.len()]) -> String {
    let parts = BASE.iter().zip(exponents).filter(|(_, exponent)| *exponent != 0);
    let parts =
        parts.map(|(base, exponent)| if exponent == 1 { (*base).to_owned() } else { format!("{base}{exponent}") });
    let words = parts.collect::<Vec<_>>().join(" ");
    if words.is_empty() { "1".to_owned() } else { words }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use linkage_fmu::component::Component;

    const GEAR: &str = include_str!("../../../modelDescription/LandingGearRetraction/resources/mechanism.json");
    const UNITS: &str = r#"<c:Unit name="kN"><c:BaseUnit kg="1" m="1" s="-2" factor="1000"/></c:Unit>
        <c:Unit name="grad"><c:BaseUnit rad="1" factor="0.015707963267948967"/></c:Unit>
        <c:Unit name="in"><c:BaseUnit m="1" factor="0.0254"/></c:Unit>
        <c:Unit name="shifted"><c:BaseUnit m="1" factor="0.5" offset="0.25"/></c:Unit>"#;

    /// The values of a parameter set with these parameters.
    fn values(parameters: &str) -> Result<BTreeMap<String, Value>> {
        let text = format!(
            "\u{feff}<?xml version=\"1.0\"?><v:ParameterSet version=\"1.0\" name=\"a\" \
             xmlns:v=\"http://ssp-standard.org/SSP1/SystemStructureParameterValues\" \
             xmlns:c=\"http://ssp-standard.org/SSP1/SystemStructureCommon\"><v:Parameters>{parameters}</v:Parameters>\
             <v:Units>{UNITS}</v:Units></v:ParameterSet>"
        );
        let gear = Component::from_definition("mechanism.json", GEAR).unwrap();
        let values = ParameterSet::parse(&text)?.values(gear.interface())?;
        Ok(values.into_iter().map(|(r, value)| (gear.interface().list()[r as usize].name.clone(), value)).collect())
    }

    fn parameter(name: &str, value: &str) -> String {
        format!("<v:Parameter name=\"{name}\"><v:{value}/></v:Parameter>")
    }

    #[test]
    fn values_are_converted_by_the_units_of_the_file() {
        for (name, value, expected) in [
            ("actuator.force", r#"Real value="31.5" unit="kN""#, Value::Real(31500.0)),
            ("crank.start_angle", r#"Real value="50" unit="grad""#, Value::Real(std::f64::consts::FRAC_PI_4)),
            ("crank.length", r#"Real value="10" unit="in""#, Value::Real(0.254)),
            ("crank.length", r#"Real value="2" unit="shifted""#, Value::Real(1.25)),
            // The file does not define these units.
            ("crank.start_angle", r#"Real value="180" unit="deg""#, Value::Real(std::f64::consts::PI)),
            ("crank.length", r#"Real value="1250" unit="mm""#, Value::Real(1.25)),
            ("crank.mass", r#"Real value="1.5e0""#, Value::Real(1.5)),
            ("crank.mass", r#"Integer value="-2""#, Value::Real(-2.0)),
            ("friction.enabled", r#"Boolean value="1""#, Value::Boolean(true)),
            ("solver.method", r#"Enumeration value="rigid_fem" name="x""#, Value::Item("rigid_fem".into())),
            ("solver.method", r#"String value="rigid_fem""#, Value::Item("rigid_fem".into())),
            ("solver.method", r#"Integer value="2""#, Value::Item("rigid_fem".into())),
        ] {
            let all = values(&parameter(name, value)).unwrap();
            let close = match (&all[name], &expected) {
                (Value::Real(own), Value::Real(other)) => (own - other).abs() <= 2.0 * f64::EPSILON * other.abs(),
                (own, other) => own == other,
            };
            assert!(close && all.len() == 1, "{value}: {all:?}");
        }
    }

    #[test]
    fn unsuitable_values_are_errors_with_a_remedy() {
        for (parameters, said) in [
            (parameter("crank.lenght", "Real value=\"1\""), "the most similar names are crank.length"),
            (
                parameter("crank.length", "Real value=\"1\" unit=\"kN\""),
                "the unit \"kN\" is kg m s-2, but the unit of \
             crank.length is m, which is m; state the value in a unit of the same quantity",
            ),
            (
                parameter("crank.mass", "Real value=\"1\" unit=\"lb\""),
                "does not define the unit: the unit of crank.mass",
            ),
            (parameter("crank.mass", "Real value=\"INF\""), "crank.mass = inf : the value must be finite"),
            (parameter("crank.mass", "Real value=\"1,5\""), "parameter crank.mass: value is \"1,5\", which is not"),
            (
                parameter("crank.mass", "Real unit=\"kg\""),
                "parameter crank.mass: the element Real has no attribute value",
            ),
            (
                parameter("crank.mass", "Boolean value=\"true\""),
                "crank.mass is a Real, but the parameter set states a \
             Boolean; write a Real",
            ),
            (parameter("crank.mass", "Binary value=\"00\""), "the type Binary is not supported"),
            (parameter("solver.method", "Integer value=\"3\""), "with the numbers 1 to 2"),
            (parameter("solver.method", "String value=\"magic\""), "solver.method must be one of reduced, rigid_fem"),
            (parameter("crank.angle", "Real value=\"1\""), "crank.angle is an output"),
            ("<v:Parameter name=\"crank.mass\"/>".to_owned(), "parameter crank.mass: the value is missing"),
            (parameter("crank.mass", "Real value=\"1\"").repeat(2), "crank.mass occurs twice"),
            ("<v:Parameter".to_owned(), "the text is not XML"),
        ] {
            let message = format!("{:#}", values(&parameters).unwrap_err());
            assert!(message.contains(said) && !message.contains('\n'), "{message}");
        }
        for (text, said) in [
            ("", "the file has no element"),
            ("<a/>", "the root element is a; give a parameter set of SSP"),
            ("<ParameterSet><Parameters>", "it ends within the element Parameters"),
            (
                "<ParameterSet><Units><Unit name=\"x\"><BaseUnit factor=\"0\"/></Unit></Units></ParameterSet>",
                "unit x: factor = 0",
            ),
        ] {
            let message = format!("{:#}", ParameterSet::parse(text).unwrap_err());
            assert!(message.contains(said), "{message}");
        }
    }
}
