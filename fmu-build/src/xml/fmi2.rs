//! The writer of `modelDescription.xml` (FMI 2.0.5, 2.2).
//!
//! In: the table of variables and the default experiment. Out: the text of the file. It depends only on the interface
//! and contains no time stamp. The module must not know kinds of model.

use super::common::{Attributes, Xml, check_texts, document, element, empty, group, number};
use super::interface::{Interface, type_name, variable_attributes};
use super::sizes::quantity;
use anyhow::Result;
use fmu_cli::Naming;
use linkage_fmu::component::Component;
use linkage_fmu::variables::{Details, Reference, Unit, Value, Variable};
use std::io;

/// The text of `modelDescription.xml`.
///
/// # Errors
/// The name is no C identifier, a text contains a character that XML cannot represent, the tolerance is missing, or a
/// parameter cannot change.
pub fn to_xml(component: &Component, naming: Naming) -> Result<String> {
    write(&Interface::of(component, naming)?)
}

fn write(interface: &Interface) -> Result<String> {
    check_texts(interface.name, interface.description, interface.variables)?;
    let mut header = interface.header("2.0", "guid");
    if interface.continuous_time.is_some() {
        header.push(("numberOfEventIndicators", interface.indicators().len().to_string()));
    }
    document("fmiModelDescription", &header, |xml| write_content(interface, xml))
}

fn write_content(interface: &Interface, xml: &mut Xml) -> io::Result<()> {
    let slave = [
        ("modelIdentifier", interface.name.to_owned()),
        ("canHandleVariableCommunicationStepSize", "true".to_owned()),
        ("canInterpolateInputs", (interface.orders[0] > 0).to_string()),
        ("maxOutputDerivativeOrder", interface.orders[1].to_string()),
        ("canNotUseMemoryManagementFunctions", "true".to_owned()),
        ("providesDirectionalDerivative", "true".to_owned()),
        ("canGetAndSetFMUstate", "true".to_owned()),
        ("canSerializeFMUstate", "true".to_owned()),
    ];
    if interface.continuous_time.is_some() {
        let model = [
            ("modelIdentifier", interface.name.to_owned()),
            ("canNotUseMemoryManagementFunctions", "true".to_owned()),
            ("canGetAndSetFMUstate", "true".to_owned()),
            ("canSerializeFMUstate", "true".to_owned()),
            ("providesDirectionalDerivative", "true".to_owned()),
        ];
        empty(xml, "ModelExchange", &model)?;
    }
    empty(xml, "CoSimulation", &slave)?;
    interface.write_common(xml, ["SimpleType", "Enumeration"])?;
    group(xml, "ModelVariables", |xml| {
        (0..)
            .zip(interface.variables)
            .try_for_each(|(reference, variable)| write_variable(xml, interface, reference, variable))
    })?;
    group(xml, "ModelStructure", |xml| write_structure(interface, xml))
}

fn write_structure(interface: &Interface, xml: &mut Xml) -> io::Result<()> {
    if interface.outputs().next().is_none() && interface.continuous_time.is_none() {
        return Ok(());
    }
    group(xml, "Outputs", |xml| {
        interface
            .outputs()
            .try_for_each(|(reference, _)| write_unknown(xml, reference, Some(&interface.dependencies_of(reference))))
    })?;
    if interface.continuous_time.is_some() {
        group(xml, "Derivatives", |xml| {
            interface.states().try_for_each(|(_, derivative)| {
                write_unknown(xml, derivative, Some(&interface.dependencies_of(derivative)))
            })
        })?;
    }
    group(xml, "InitialUnknowns", |xml| {
        let mut outputs = interface.outputs();
        outputs.try_for_each(|(reference, _)| {
            write_unknown(xml, reference, interface.initial_dependencies_of(reference))
        })?;
        let mut calculated = interface.calculated();
        calculated
            .try_for_each(|(reference, parameter)| write_unknown(xml, reference, Some(&parameter.dependencies)))?;
        interface.initial_states().into_iter().try_for_each(|reference| write_unknown(xml, reference, None))
    })
}

fn write_variable(xml: &mut Xml, interface: &Interface, reference: Reference, variable: &Variable) -> io::Result<()> {
    let attributes = variable_attributes(reference, variable);
    let mut of_kind = kind_attributes(variable, interface.nominal(reference, variable));
    of_kind.extend(interface.state_attributes(reference, 1));
    element(xml, "ScalarVariable", &attributes, |xml| empty(xml, variable.kind.word(), &of_kind))
}

/// Attributes of the type element of a variable with this nominal value: quantity, unit, start value and others.
pub fn kind_attributes(variable: &Variable, nominal: Option<f64>) -> Attributes<'static> {
    let quantity = variable.unit.and_then(quantity).map(|quantity| ("quantity", quantity.to_owned()));
    let unit = variable.unit.map(|unit| ("unit", unit.name().to_owned()));
    let display = variable.unit.and_then(Unit::display).map(|(name, _)| ("displayUnit", name.to_owned()));
    let start = variable.start.as_ref().map(|start| {
        let text = match start {
            Value::Real(value) => number(*value),
            Value::Boolean(value) => value.to_string(),
            Value::Item(item) => variable.number_of(item).unwrap_or_default().to_string(),
        };
        ("start", text)
    });
    let declared = (!variable.details.items.is_empty()).then(|| ("declaredType", type_name(variable)));
    let Details { bounds: [least, most], .. } = variable.details;
    let numbers = [("min", least), ("max", most), ("nominal", nominal)];
    let numbers = numbers.into_iter().filter_map(|(name, value)| value.map(|value| (name, number(value))));
    declared.into_iter().chain(quantity).chain(unit).chain(display).chain(numbers).chain(start).collect()
}

/// An element of ModelStructure; the standard counts variables from 1.
fn write_unknown(xml: &mut Xml, reference: Reference, dependencies: Option<&[Reference]>) -> io::Result<()> {
    let mut attributes = vec![("index", (reference + 1).to_string())];
    attributes.extend(dependencies.map(|dependencies| {
        let indexes: Vec<String> = dependencies.iter().map(|dependency| (dependency + 1).to_string()).collect();
        ("dependencies", indexes.join(" "))
    }));
    empty(xml, "Unknown", &attributes)
}

#[cfg(test)]
mod tests {
    use super::super::sizes::Sizes;
    use super::*;
    use linkage_fmu::format::{About, Experiment};
    use linkage_fmu::variables::{Causality, Kind, Variability};

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
            details: Details::default(),
        }
    }

    fn xml_of(variables: &[Variable]) -> Result<String> {
        let (name, description, guid) = ("Gear", "A gear", "{1}");
        let (experiment, tolerance) = (Experiment { stop_time: 0.133, step_size: 1e-3 }, 1e-9);
        // The initial value of each variable depends on all previous variables.
        let of = |i: usize| (0..i as Reference).collect();
        let initial_dependencies = Some((0..variables.len()).map(of).collect());
        let orders = [2, 1];
        let (has_events, has_internal_steps) = (false, false);
        write(&Interface {
            name,
            description,
            about: About::default().attributes(),
            naming: Naming::default(),
            guid,
            variables,
            vectors: Vec::new(),
            initial_dependencies,
            experiment,
            tolerance,
            orders,
            has_events,
            has_internal_steps,
            continuous_time: None,
            state_nominals: None,
            sizes: Sizes::new(variables, experiment.stop_time),
        })
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
                "name=\"p\" valueReference=\"0\" {escaped} causality=\"parameter\" variability=\"fixed\" \
                 initial=\"exact\""
            ),
            format!("name=\"u\" valueReference=\"1\" {escaped} causality=\"input\" variability=\"continuous\">"),
            format!(
                "name=\"y\" valueReference=\"2\" {escaped} causality=\"output\" variability=\"continuous\" \
                 initial=\"calculated\""
            ),
            "<Real quantity=\"Angle\" unit=\"rad\" displayUnit=\"deg\" nominal=\"1\" start=\"30000\"/>".to_owned(),
            "<Real quantity=\"Angle\" unit=\"rad\" displayUnit=\"deg\" nominal=\"1\"/>".to_owned(),
            "<DefaultExperiment startTime=\"0\" stopTime=\"0.133\" tolerance=\"1e-9\" stepSize=\"0.001\"/>".to_owned(),
        ] {
            assert!(xml.contains(&expected), "{expected} is not in\n{xml}");
        }
    }

    #[test]
    fn dependencies_count_from_one_and_an_empty_list_is_written() {
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
            "<ModelStructure><Outputs><Unknown index=\"3\" dependencies=\"2\"/><Unknown index=\"4\" \
             dependencies=\"\"/></Outputs><InitialUnknowns><Unknown index=\"3\" dependencies=\"1 2\"/><Unknown \
             index=\"4\" dependencies=\"1 2 3\"/></InitialUnknowns></ModelStructure></fmiModelDescription>"
        );
    }

    #[test]
    fn control_characters_are_rejected() {
        let mut bad = variable("y", Causality::Output, None);
        bad.description = "two\nlines".to_owned();
        let message = xml_of(&[bad]).unwrap_err().to_string();
        assert!(message.starts_with("y: the text contains the character '\\n'"), "{message}");
    }
}
