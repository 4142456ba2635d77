//! The writer of `modelDescription.xml` of FMI 3.0 (FMI 3.0.2, 2.4).
//!
//! In: the table of variables and the default experiment. Out: the text of the file. It depends only on the interface.
//! Value references are those of FMI 2.0. The time and the vectors, which FMI 3.0 has as variables, follow all other
//! variables. The module must not know kinds of model.

use super::common::{Attributes, Xml, check_texts, document, element, empty, group};
use super::fmi2::kind_attributes;
use super::interface::{Interface, variable_attributes};
use anyhow::Result;
use fmu_cli::Naming;
use linkage_fmu::component::Component;
use linkage_fmu::variables::{Details, Reference, Variable, Vector};
use std::io;

/// The text of `modelDescription.xml`.
///
/// # Errors
/// The name is no C identifier, a text contains a character that XML cannot represent, the tolerance is missing, or a
/// parameter cannot change.
pub fn to_xml(component: &Component, naming: Naming) -> Result<String> {
    let interface = Interface::of(component, naming)?;
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
        ("providesPerElementDependencies", "true".to_owned()),
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
    if interface.continuous_time.is_some() {
        let model = [
            ("modelIdentifier", interface.name.to_owned()),
            ("canGetAndSetFMUState", "true".to_owned()),
            ("canSerializeFMUState", "true".to_owned()),
            ("providesDirectionalDerivatives", "true".to_owned()),
            ("providesAdjointDerivatives", "true".to_owned()),
        ];
        empty(xml, "ModelExchange", &model)?;
    }
    empty(xml, "CoSimulation", &co_simulation)?;
    interface.write_common(xml, ["EnumerationType", ""])?;
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
        empty(xml, "Float64", &time)?;
        interface.numbered_vectors().try_for_each(|(reference, vector)| write_vector(xml, interface, reference, vector))
    })?;
    group(xml, "ModelStructure", |xml| {
        let write_present = |xml: &mut Xml, element: &str, reference: Reference| {
            write_unknown(xml, element, reference, Some(&interface.dependencies_of(reference)))
        };
        interface.outputs().try_for_each(|(reference, _)| write_present(xml, "Output", reference))?;
        for (reference, vector) in interface.numbered_vectors() {
            write_unknown(xml, "Output", reference, interface.dependencies_of_vector(vector, false).as_deref())?;
        }
        interface
            .states()
            .try_for_each(|(_, derivative)| write_present(xml, "ContinuousStateDerivative", derivative))?;
        for (reference, _) in interface.outputs() {
            write_unknown(xml, "InitialUnknown", reference, interface.initial_dependencies_of(reference))?;
        }
        for (reference, parameter) in interface.calculated() {
            write_unknown(xml, "InitialUnknown", reference, Some(&parameter.dependencies))?;
        }
        for (reference, vector) in interface.numbered_vectors() {
            let dependencies = interface.dependencies_of_vector(vector, true);
            write_unknown(xml, "InitialUnknown", reference, dependencies.as_deref())?;
        }
        for reference in interface.initial_states() {
            write_unknown(xml, "InitialUnknown", reference, None)?;
        }
        interface.indicators().iter().try_for_each(|&reference| write_present(xml, "EventIndicator", reference))
    })
}

fn write_variable(xml: &mut Xml, interface: &Interface, reference: Reference, variable: &Variable) -> io::Result<()> {
    let kind = variable.kind.word_of_fmi_3();
    let mut attributes = attributes_of(interface, reference, variable);
    attributes.extend(kind_attributes(variable, interface.nominal(reference, variable)));
    attributes.extend(interface.state_attributes(reference, 0));
    empty(xml, kind, &attributes)
}

/// A vector: its first element with another name and reference, and a dimension.
fn write_vector(xml: &mut Xml, interface: &Interface, reference: Reference, vector: &Vector) -> io::Result<()> {
    let first = &interface.variables[vector.elements[0] as usize];
    let (name, description) = (vector.name.clone(), vector.description.clone());
    let whole = Variable { name, description, details: Details::default(), ..first.clone() };
    let mut attributes = attributes_of(interface, reference, &whole);
    attributes.extend(kind_attributes(&whole, interface.sizes.nominal(&whole)));
    element(xml, whole.kind.word_of_fmi_3(), &attributes, |xml| {
        empty(xml, "Dimension", &[("start", vector.elements.len().to_string())])
    })
}

/// Attributes that all variables have.
fn attributes_of(interface: &Interface, reference: Reference, variable: &Variable) -> Attributes<'static> {
    let mut attributes = variable_attributes(reference, variable);
    if interface.has_internal_steps && variable.is_output() {
        attributes.push(("intermediateUpdate", "true".to_owned()));
    }
    attributes
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
