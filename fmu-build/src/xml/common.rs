//! Common parts of all XML files of an FMU: documents, elements, numbers, unit definitions, legal texts.

use anyhow::{Result, bail};
use linkage_fmu::variables::{Unit, Value, Variable};
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, Event};
use std::collections::BTreeSet;
use std::io;

pub type Xml = Writer<Vec<u8>>;
pub type Attributes<'a> = Vec<(&'a str, String)>;

/// Text of a file with this root element.
pub fn document(
    root: &str,
    attributes: &[(&str, String)],
    content: impl FnOnce(&mut Xml) -> io::Result<()>,
) -> Result<String> {
    let mut xml = Writer::new_with_indent(Vec::new(), b' ', 2);
    xml.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    element(&mut xml, root, attributes, content)?;
    let mut text = String::from_utf8(xml.into_inner())?;
    text.push('\n');
    Ok(text)
}

pub fn element(
    xml: &mut Xml,
    name: &str,
    attributes: &[(&str, String)],
    content: impl FnOnce(&mut Xml) -> io::Result<()>,
) -> io::Result<()> {
    let attributes = attributes.iter().map(|(name, value)| (*name, value.as_str()));
    xml.create_element(name).with_attributes(attributes).write_inner_content(content).map(drop)
}

pub fn group(xml: &mut Xml, name: &str, content: impl FnOnce(&mut Xml) -> io::Result<()>) -> io::Result<()> {
    element(xml, name, &[], content)
}

pub fn empty(xml: &mut Xml, name: &str, attributes: &[(&str, String)]) -> io::Result<()> {
    let attributes = attributes.iter().map(|(name, value)| (*name, value.as_str()));
    xml.create_element(name).with_attributes(attributes).write_empty().map(drop)
}

/// The shortest decimal number that is read back with the same bits. It has an exponent if this saves many zeros.
pub fn number(value: f64) -> String {
    let magnitude = value.abs();
    if magnitude != 0.0 && !(1e-4..1e15).contains(&magnitude) { format!("{value:e}") } else { value.to_string() }
}

/// The units of these variables, without duplicates.
pub fn write_units(xml: &mut Xml, variables: &[Variable]) -> io::Result<()> {
    let units: BTreeSet<Unit> = variables.iter().filter_map(|variable| variable.unit).collect();
    if units.is_empty() {
        return Ok(());
    }
    group(xml, "UnitDefinitions", |xml| {
        let names = ["Unit", "BaseUnit", "DisplayUnit"];
        units.into_iter().try_for_each(|unit| write_unit(xml, unit, names))
    })
}

/// A unit, in elements with these names. If the last name is empty, without its display unit.
pub fn write_unit(xml: &mut Xml, unit: Unit, [outer, base, display]: [&str; 3]) -> io::Result<()> {
    let exponents: Attributes = unit
        .base()
        .into_iter()
        .filter(|&(_, exponent)| exponent != 0)
        .map(|(name, exponent)| (name, exponent.to_string()))
        .collect();
    element(xml, outer, &[("name", unit.name().to_owned())], |xml| {
        empty(xml, base, &exponents)?;
        unit.display().filter(|_| !display.is_empty()).map_or(Ok(()), |(name, factor)| {
            empty(xml, display, &[("name", name.to_owned()), ("factor", number(factor))])
        })
    })
}

/// Check that no text contains a control character (XML 1.0, production 2, and the one-line texts of the standard).
///
/// # Errors
/// The first character that XML cannot represent, with the name of its quantity.
pub fn check_texts(name: &str, description: &str, variables: &[Variable]) -> Result<()> {
    let header = [("name", name), ("description", description)];
    let variables = variables.iter().flat_map(|variable| {
        let start = match &variable.start {
            Some(Value::Item(text)) => text.as_str(),
            _ => "",
        };
        [&variable.name, &variable.description, start].map(|text| (variable.name.as_str(), text))
    });
    for (quantity, text) in header.into_iter().chain(variables) {
        if let Some(found) = text.chars().find(|&c| c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}')) {
            bail!(
                "{}: the text contains the character {found:?}; write the text on one line, without this character",
                quantity.escape_debug()
            );
        }
    }
    Ok(())
}

/// Whether a name is a C identifier: the modelIdentifier is the name of the library and the prefix of C functions (FMI
/// 2.0.5, 2.2.1).
pub fn is_c_identifier(name: &str) -> bool {
    !name.starts_with(|c: char| c.is_ascii_digit())
        && !name.is_empty()
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_back_as_the_same_bits() {
        for value in
            [0.0, -0.0, 0.1, 1e-9, 1e-13, 30000.0, 0.759, 2.1e11, 1.0 / 3.0, 5e-324, f64::MAX, -57.29577951308232]
        {
            let text = number(value);
            assert_eq!(text.parse::<f64>().unwrap().to_bits(), value.to_bits(), "{text}");
            assert!(text.len() <= 24, "{text}");
        }
    }

    #[test]
    fn a_model_identifier_is_a_c_identifier() {
        for good in ["Gear", "_g", "four_bar_2"] {
            assert!(is_c_identifier(good), "{good}");
        }
        for bad in ["", "2gear", "Gear-2", "Landing Gear", "Fahrwerk\u{e4}", "a/b", "a.b"] {
            assert!(!is_c_identifier(bad), "{bad}");
        }
    }
}
