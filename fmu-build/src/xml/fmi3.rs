//! The writer of `modelDescription.xml` of FMI 3.0 (FMI 3.0.2, 2.4).
//!
//! In: the table of variables and the default experiment. Out: the text of the file, the same for the same interface.
//! Value references are those of FMI 2.0; the time, which FMI 3.0 has as a variable, comes after all others. It must not
//! know kinds of model.

use super::common::{Xml, check_texts, document, element, empty, group};
use super::fmi2::kind_attributes;
use super::interface::{Interface, variable_attributes};
use anyhow::Result;
use linkage_fmu::component::Component;
use linkage_fmu::variables::{Causality, Kind, Reference, Value, Variable};
use std::io;

/// The text of `modelDescription.xml`.
///
/// # Errors
/// The name is not a C identifier, a text holds a character that XML cannot, the tolerance is missing, or a parameter
/// may not change a little.
pub fn to_xml(component: &Component) -> Result<String> {
    let interface = Interface::of(component)?;
    check_texts(interface.name, interface.description, interface.variables)?;
    let header = interface.header("3.0", "instantiationToken");
    document("fmiModelDescription", &header, |xml| write_content(&interface, xml))
}

fn write_content(interface: &Interface, xml: &mut Xml) -> io::Result<()> {
    let mut co_simulation = vec![
        ("modelIdentifier", interface.name.to_owned()),
        ("canGetAndSetFMUState", "true".to_owned()),
        ("canSerializeFMUState", "true".to_owned()),
        ("providesDirectionalDerivatives", "true".to_owned()),
        ("providesAdjointDerivatives", "true".to_owned()),
        ("canHandleVariableCommunicationStepSize", "true".to_owned()),
        ("maxOutputDerivativeOrder", interface.orders[1].to_string()),
    ];
    if interface.has_events {
        let provided = ["mightReturnEarlyFromDoStep", "hasEventMode", "providesEvaluateDiscreteStates"];
        co_simulation.extend(provided.map(|name| (name, "true".to_owned())));
    }
    if interface.has_internal_steps {
        let provided = ["providesIntermediateUpdate", "canReturnEarlyAfterIntermediateUpdate"];
        co_simulation.extend(provided.map(|name| (name, "true".to_owned())));
    }
    empty(xml, "CoSimulation", &co_simulation)?;
    interface.write_common(xml)?;
    group(xml, "ModelVariables", |xml| {
        let mut variables = (0..).zip(interface.variables);
        variables.try_for_each(|(reference, variable)| write_variable(xml, interface, reference, variable))?;
        let time = [
            ("name", "time".to_owned()),
            ("valueReference", interface.variables.len().to_string()),
            ("description", "Time [s]".to_owned()),
            ("causality", "independent".to_owned()),
            ("variability", "continuous".to_owned()),
        ];
        empty(xml, "Float64", &time)
    })?;
    group(xml, "ModelStructure", |xml| {
        for (reference, output) in interface.outputs() {
            write_unknown(xml, "Output", reference, Some(&output.dependencies))?;
        }
        for (reference, _) in interface.outputs() {
            write_unknown(xml, "InitialUnknown", reference, interface.initial_dependencies_of(reference))?;
        }
        Ok(())
    })
}

fn write_variable(xml: &mut Xml, interface: &Interface, reference: Reference, variable: &Variable) -> io::Result<()> {
    let kind = match variable.kind {
        Kind::Real => "Float64",
        Kind::Integer => "Int32",
        Kind::Boolean => "Boolean",
        Kind::String => "String",
    };
    let mut attributes = variable_attributes(reference, variable);
    if interface.has_internal_steps && variable.causality == Causality::Output {
        attributes.push(("intermediateUpdate", "true".to_owned()));
    }
    if let Some(Value::String(text)) = &variable.start {
        return element(xml, kind, &attributes, |xml| empty(xml, "Start", &[("value", text.clone())]));
    }
    attributes.extend(kind_attributes(variable));
    empty(xml, kind, &attributes)
}

/// An element of ModelStructure.
fn write_unknown(
    xml: &mut Xml,
    element: &str,
    reference: Reference,
    dependencies: Option<&[Reference]>,
) -> io::Result<()> {
    let mut attributes = vec![("valueReference", reference.to_string())];
    attributes.extend(dependencies.map(|dependencies| {
        let references: Vec<String> = dependencies.iter().map(Reference::to_string).collect();
        ("dependencies", references.join(" "))
    }));
    empty(xml, element, &attributes)
}
