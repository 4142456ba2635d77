//! The writer of `modelDescription.xml` (FMI 2.0.5, 2.2).
//!
//! In: the table of variables and the default experiment. Out: the text of the file, the same for the same interface:
//! it holds no time stamp. It must not know which variables a mechanism has.

use anyhow::{Context, Result, bail};
use linkage_fmu::fmi::logger::LOG_CATEGORIES;
use linkage_fmu::mechanism::Model;
use linkage_fmu::mechanism::OUTPUT_ORDER;
use linkage_fmu::variables::{BaseUnit, Causality, Kind, Reference, Unit, Value, Variability, Variable};
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, Event};
use std::collections::BTreeSet;
use std::io;

/// Version of this repository, for `version` and `generationTool`.
const VERSION: &str = env!("CARGO_PKG_VERSION");
/// Parameter whose start value is the default experiment's tolerance.
const TOLERANCE: &str = "solver.tolerance";

type Xml = Writer<Vec<u8>>;
type Attributes<'a> = Vec<(&'a str, String)>;

/// All that the description says about one mechanism.
pub struct Interface<'a> {
    name: &'a str,
    description: &'a str,
    guid: &'a str,
    variables: &'a [Variable],
    /// Of each variable.
    initial_dependencies: Vec<Vec<Reference>>,
    stop_time: f64,
    step_size: f64,
    tolerance: f64,
}

impl<'a> Interface<'a> {
    /// The interface of a model as read from its file.
    ///
    /// # Errors
    /// The name is not a C identifier, the tolerance is missing, or a parameter may not change a little.
    pub fn of(model: &'a Model) -> Result<Self> {
        let variables = model.variables();
        let name = model.name();
        if !is_c_identifier(name) {
            bail!("name: \"{name}\" is not a C identifier; use letters, digits and _ only, and begin with no digit");
        }
        let tolerance = variables
            .find(TOLERANCE)
            .and_then(|reference| variables.get(reference))
            .and_then(|variable| match variable.start {
                Some(Value::Real(start)) => Some(start),
                _ => None,
            })
            .with_context(|| format!("{TOLERANCE}: there is no such parameter; the model must declare it"))?;
        Ok(Self {
            name,
            description: model.description(),
            guid: variables.guid(),
            variables: variables.list(),
            initial_dependencies: model.initial_dependencies()?,
            stop_time: model.experiment().stop_time,
            step_size: model.experiment().step_size,
            tolerance,
        })
    }

    /// The text of `modelDescription.xml`.
    ///
    /// # Errors
    /// A text holds a character that XML cannot.
    pub fn to_xml(&self) -> Result<String> {
        self.check_texts()?;
        let mut xml = Writer::new_with_indent(Vec::new(), b' ', 2);
        xml.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
        xml.create_element("fmiModelDescription")
            .with_attributes(borrowed(&self.header()))
            .write_inner_content(|xml| self.write_content(xml))?;
        let mut text = String::from_utf8(xml.into_inner())?;
        text.push('\n');
        Ok(text)
    }

    fn header(&self) -> Attributes<'static> {
        vec![
            ("fmiVersion", "2.0".to_owned()),
            ("modelName", self.name.to_owned()),
            ("guid", self.guid.to_owned()),
            ("description", self.description.to_owned()),
            ("version", VERSION.to_owned()),
            ("generationTool", format!("linkage-fmu {VERSION}")),
            ("variableNamingConvention", "structured".to_owned()),
        ]
    }

    fn write_content(&self, xml: &mut Xml) -> io::Result<()> {
        empty(
            xml,
            "CoSimulation",
            &[
                ("modelIdentifier", self.name.to_owned()),
                ("canHandleVariableCommunicationStepSize", "true".to_owned()),
                ("canInterpolateInputs", "true".to_owned()),
                ("maxOutputDerivativeOrder", OUTPUT_ORDER.to_string()),
                ("canNotUseMemoryManagementFunctions", "true".to_owned()),
                ("providesDirectionalDerivative", "true".to_owned()),
                ("canGetAndSetFMUstate", "true".to_owned()),
                ("canSerializeFMUstate", "true".to_owned()),
            ],
        )?;
        self.write_units(xml)?;
        group(xml, "LogCategories", |xml| {
            LOG_CATEGORIES.iter().try_for_each(|&(name, description)| {
                empty(xml, "Category", &[("name", name.to_owned()), ("description", description.to_owned())])
            })
        })?;
        empty(
            xml,
            "DefaultExperiment",
            &[
                ("startTime", number(0.0)),
                ("stopTime", number(self.stop_time)),
                ("tolerance", number(self.tolerance)),
                ("stepSize", number(self.step_size)),
            ],
        )?;
        group(xml, "ModelVariables", |xml| {
            (0..).zip(self.variables).try_for_each(|(reference, variable)| write_variable(xml, reference, variable))
        })?;
        group(xml, "ModelStructure", |xml| self.write_structure(xml))
    }

    fn write_units(&self, xml: &mut Xml) -> io::Result<()> {
        let units: BTreeSet<Unit> = self.variables.iter().filter_map(|variable| variable.unit).collect();
        if units.is_empty() {
            return Ok(());
        }
        group(xml, "UnitDefinitions", |xml| units.into_iter().try_for_each(|unit| write_unit(xml, unit)))
    }

    fn write_structure(&self, xml: &mut Xml) -> io::Result<()> {
        let outputs = || (0..).zip(self.variables).filter(|(_, variable)| variable.causality == Causality::Output);
        if outputs().next().is_none() {
            return Ok(());
        }
        group(xml, "Outputs", |xml| {
            outputs().try_for_each(|(reference, output)| write_unknown(xml, reference, &output.dependencies))
        })?;
        group(xml, "InitialUnknowns", |xml| {
            outputs().try_for_each(|(reference, _)| {
                write_unknown(xml, reference, &self.initial_dependencies[reference as usize])
            })
        })
    }

    /// XML 1.0, production 2, and the standard's one-line texts: no control characters.
    fn check_texts(&self) -> Result<()> {
        let header = [("name", self.name), ("description", self.description)];
        let variables = self.variables.iter().flat_map(|variable| {
            let start = match &variable.start {
                Some(Value::String(text)) => text.as_str(),
                _ => "",
            };
            [&variable.name, &variable.description, start].map(|text| (variable.name.as_str(), text))
        });
        for (quantity, text) in header.into_iter().chain(variables) {
            if let Some(found) = text.chars().find(|&c| c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}')) {
                bail!(
                    "{}: the text holds the character {found:?}; write it on one line, without",
                    quantity.escape_debug()
                );
            }
        }
        Ok(())
    }
}

fn write_unit(xml: &mut Xml, unit: Unit) -> io::Result<()> {
    let BaseUnit { kg, m, s, rad } = unit.base();
    let exponents: Attributes = [("kg", kg), ("m", m), ("s", s), ("rad", rad)]
        .into_iter()
        .filter(|&(_, exponent)| exponent != 0)
        .map(|(name, exponent)| (name, exponent.to_string()))
        .collect();
    xml.create_element("Unit").with_attribute(("name", unit.name())).write_inner_content(|xml| {
        empty(xml, "BaseUnit", &exponents)?;
        match unit.display() {
            Some(display) => {
                empty(xml, "DisplayUnit", &[("name", display.name.to_owned()), ("factor", number(display.factor))])
            }
            None => Ok(()),
        }
    })?;
    Ok(())
}

fn write_variable(xml: &mut Xml, reference: Reference, variable: &Variable) -> io::Result<()> {
    let mut attributes = vec![
        ("name", variable.name.clone()),
        ("valueReference", reference.to_string()),
        ("description", variable.description.clone()),
    ];
    // FMI 2.0.5, 2.2.7: an input carries no `initial`, and only what is exact has a start value here.
    let (causality, initial) = match variable.causality {
        Causality::Parameter => ("parameter", Some("exact")),
        Causality::Input => ("input", None),
        Causality::Output => ("output", Some("calculated")),
    };
    let variability = match variable.variability {
        Variability::Fixed => "fixed",
        Variability::Discrete => "discrete",
        Variability::Continuous => "continuous",
    };
    attributes.push(("causality", causality.to_owned()));
    attributes.push(("variability", variability.to_owned()));
    attributes.extend(initial.map(|initial| ("initial", initial.to_owned())));
    xml.create_element("ScalarVariable")
        .with_attributes(borrowed(&attributes))
        .write_inner_content(|xml| empty(xml, kind_name(variable.kind), &kind_attributes(variable)))?;
    Ok(())
}

fn kind_name(kind: Kind) -> &'static str {
    match kind {
        Kind::Real => "Real",
        Kind::Integer => "Integer",
        Kind::Boolean => "Boolean",
        Kind::String => "String",
    }
}

fn kind_attributes(variable: &Variable) -> Attributes<'static> {
    let unit = variable.unit.map(|unit| ("unit", unit.name().to_owned()));
    let display = variable.unit.and_then(Unit::display).map(|display| ("displayUnit", display.name.to_owned()));
    let start = variable.start.as_ref().map(|start| {
        let text = match start {
            Value::Real(value) => number(*value),
            Value::Integer(value) => value.to_string(),
            Value::Boolean(value) => value.to_string(),
            Value::String(text) => text.clone(),
        };
        ("start", text)
    });
    unit.into_iter().chain(display).chain(start).collect()
}

/// An element of ModelStructure; the standard counts variables from 1.
fn write_unknown(xml: &mut Xml, reference: Reference, dependencies: &[Reference]) -> io::Result<()> {
    let indexes: Vec<String> = dependencies.iter().map(|dependency| (dependency + 1).to_string()).collect();
    empty(xml, "Unknown", &[("index", (reference + 1).to_string()), ("dependencies", indexes.join(" "))])
}

fn group(xml: &mut Xml, name: &str, content: impl FnOnce(&mut Xml) -> io::Result<()>) -> io::Result<()> {
    xml.create_element(name).write_inner_content(content)?;
    Ok(())
}

fn empty(xml: &mut Xml, name: &str, attributes: &[(&str, String)]) -> io::Result<()> {
    xml.create_element(name).with_attributes(borrowed(attributes)).write_empty()?;
    Ok(())
}

fn borrowed<'a>(attributes: &'a [(&'a str, String)]) -> impl Iterator<Item = (&'a str, &'a str)> {
    attributes.iter().map(|(name, value)| (*name, value.as_str()))
}

/// The shortest decimal number that reads back as the same bits; with an exponent where that spares many zeros.
fn number(value: f64) -> String {
    let magnitude = value.abs();
    if magnitude != 0.0 && !(1e-4..1e15).contains(&magnitude) { format!("{value:e}") } else { value.to_string() }
}

/// FMI 2.0.5, 2.2.1: the modelIdentifier names the library and prefixes C functions.
fn is_c_identifier(name: &str) -> bool {
    !name.starts_with(|c: char| c.is_ascii_digit())
        && !name.is_empty()
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

#[cfg(test)]
mod tests {
    use super::*;

    fn variable(name: &str, causality: Causality, start: Option<f64>) -> Variable {
        Variable {
            name: name.to_owned(),
            description: "An \"angle\" < 1 & so on".to_owned(),
            kind: Kind::Real,
            causality,
            variability: if causality == Causality::Parameter { Variability::Fixed } else { Variability::Continuous },
            unit: Some(Unit::Radian),
            start: start.map(Value::Real),
            dependencies: Vec::new(),
        }
    }

    fn xml_of(variables: &[Variable]) -> Result<String> {
        let (name, description, guid) = ("Gear", "A gear", "{1}");
        let (stop_time, step_size, tolerance) = (0.133, 1e-3, 1e-9);
        // As if every output began with what the variables before it do.
        let of = |i: usize| (0..i as Reference).collect();
        let initial_dependencies = (0..variables.len()).map(of).collect();
        Interface { name, description, guid, variables, initial_dependencies, stop_time, step_size, tolerance }.to_xml()
    }

    #[test]
    fn causality_decides_on_initial_and_start() {
        let xml = xml_of(&[
            variable("p", Causality::Parameter, Some(0.1)),
            variable("u", Causality::Input, Some(30000.0)),
            variable("y", Causality::Output, None),
        ])
        .unwrap();
        let escaped = "description=\"An &quot;angle&quot; &lt; 1 &amp; so on\"";
        for expected in [
            format!(
                "name=\"p\" valueReference=\"0\" {escaped} causality=\"parameter\" variability=\"fixed\" initial=\"exact\""
            ),
            format!("name=\"u\" valueReference=\"1\" {escaped} causality=\"input\" variability=\"continuous\">"),
            format!(
                "name=\"y\" valueReference=\"2\" {escaped} causality=\"output\" variability=\"continuous\" initial=\"calculated\""
            ),
            "<Real unit=\"rad\" displayUnit=\"deg\" start=\"30000\"/>".to_owned(),
            "<Real unit=\"rad\" displayUnit=\"deg\"/>".to_owned(),
            "<DefaultExperiment startTime=\"0\" stopTime=\"0.133\" tolerance=\"1e-9\" stepSize=\"0.001\"/>".to_owned(),
        ] {
            assert!(xml.contains(&expected), "{expected} is not in\n{xml}");
        }
    }

    #[test]
    fn dependencies_count_from_one_and_an_empty_list_stands() {
        let mut first = variable("y", Causality::Output, None);
        first.dependencies = vec![1];
        let xml = xml_of(&[
            variable("p", Causality::Parameter, Some(0.1)),
            variable("u", Causality::Input, Some(1.0)),
            first,
            variable("z", Causality::Output, None),
        ])
        .unwrap();
        let structure: String =
            xml.lines().skip_while(|line| !line.contains("<ModelStructure>")).map(str::trim).collect();
        assert_eq!(
            structure,
            "<ModelStructure>\
             <Outputs><Unknown index=\"3\" dependencies=\"2\"/><Unknown index=\"4\" dependencies=\"\"/></Outputs>\
             <InitialUnknowns><Unknown index=\"3\" dependencies=\"1 2\"/><Unknown index=\"4\" dependencies=\"1 2 3\"/></InitialUnknowns>\
             </ModelStructure></fmiModelDescription>"
        );
    }

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
    fn control_characters_are_refused() {
        let mut bad = variable("y", Causality::Output, None);
        bad.description = "two\nlines".to_owned();
        let message = xml_of(&[bad]).unwrap_err().to_string();
        assert!(message.starts_with("y: the text holds the character '\\n'"), "{message}");
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
