//! The writer of `modelDescription.xml` (FMI 2.0.5, 2.2).
//!
//! In: the table of variables and the default experiment. Out: the text of the file, the same for the same interface:
//! it holds no time stamp. It must not know kinds of model.

use super::common::{
    Attributes, Xml, check_texts, document, element, empty, group, is_c_identifier, number, write_units,
};
use anyhow::{Result, bail};
use linkage_fmu::component::Component;
use linkage_fmu::fmi::logger::LOG_CATEGORIES;
use linkage_fmu::format::Experiment;
use linkage_fmu::variables::{Causality, Kind, Reference, Unit, Value, Variability, Variable};
use std::io;

/// Version of this repository, for `version` and `generationTool`.
const VERSION: &str = env!("CARGO_PKG_VERSION");
/// Parameter whose start value is the default experiment's tolerance.
const TOLERANCE: &str = "solver.tolerance";

/// The text of `modelDescription.xml`.
///
/// # Errors
/// The name is not a C identifier, a text holds a character that XML cannot, the tolerance is missing, or a parameter
/// may not change a little.
pub fn to_xml(component: &Component) -> Result<String> {
    Interface::of(component)?.to_xml()
}

/// All that the description says about one model.
struct Interface<'a> {
    name: &'a str,
    description: &'a str,
    guid: &'a str,
    variables: &'a [Variable],
    /// Of each variable; none where the model is too large to find them. The attribute is then left out, which says that
    /// each output depends on all that is known (FMI 2.0.5, 2.2.8).
    initial_dependencies: Option<Vec<Vec<Reference>>>,
    experiment: Experiment,
    tolerance: f64,
    /// Largest orders of the derivatives in time of inputs and outputs.
    orders: [i32; 2],
}

impl<'a> Interface<'a> {
    /// The interface of a model as read from its file.
    fn of(component: &'a Component) -> Result<Self> {
        let (name, interface) = (component.name(), component.interface());
        if !is_c_identifier(name) {
            bail!("name: \"{name}\" is not a C identifier; use letters, digits and _ only, and begin with no digit");
        }
        let parameter = interface.list().iter().find(|variable| variable.name == TOLERANCE);
        let Some(&Value::Real(tolerance)) = parameter.and_then(|parameter| parameter.start.as_ref()) else {
            bail!("{TOLERANCE}: there is no such parameter; the model must declare it");
        };
        Ok(Self {
            name,
            description: component.description(),
            guid: interface.guid(),
            variables: interface.list(),
            initial_dependencies: component.initial_dependencies()?,
            experiment: component.experiment(),
            tolerance,
            orders: [component.input_order(), component.output_order()],
        })
    }

    fn to_xml(&self) -> Result<String> {
        check_texts(self.name, self.description, self.variables)?;
        let header = [
            ("fmiVersion", "2.0".to_owned()),
            ("modelName", self.name.to_owned()),
            ("guid", self.guid.to_owned()),
            ("description", self.description.to_owned()),
            ("version", VERSION.to_owned()),
            ("generationTool", format!("linkage-fmu {VERSION}")),
            ("variableNamingConvention", "structured".to_owned()),
        ];
        document("fmiModelDescription", &header, |xml| self.write_content(xml))
    }

    fn write_content(&self, xml: &mut Xml) -> io::Result<()> {
        let slave = [
            ("modelIdentifier", self.name.to_owned()),
            ("canHandleVariableCommunicationStepSize", "true".to_owned()),
            ("canInterpolateInputs", (self.orders[0] > 0).to_string()),
            ("maxOutputDerivativeOrder", self.orders[1].to_string()),
            ("canNotUseMemoryManagementFunctions", "true".to_owned()),
            ("providesDirectionalDerivative", "true".to_owned()),
            ("canGetAndSetFMUstate", "true".to_owned()),
            ("canSerializeFMUstate", "true".to_owned()),
        ];
        empty(xml, "CoSimulation", &slave)?;
        write_units(xml, self.variables)?;
        group(xml, "LogCategories", |xml| {
            LOG_CATEGORIES.iter().try_for_each(|&(name, description)| {
                let name = name.to_string_lossy().into_owned();
                empty(xml, "Category", &[("name", name), ("description", description.to_owned())])
            })
        })?;
        let experiment = [
            ("startTime", number(0.0)),
            ("stopTime", number(self.experiment.stop_time)),
            ("tolerance", number(self.tolerance)),
            ("stepSize", number(self.experiment.step_size)),
        ];
        empty(xml, "DefaultExperiment", &experiment)?;
        group(xml, "ModelVariables", |xml| {
            (0..).zip(self.variables).try_for_each(|(reference, variable)| write_variable(xml, reference, variable))
        })?;
        group(xml, "ModelStructure", |xml| self.write_structure(xml))
    }

    fn write_structure(&self, xml: &mut Xml) -> io::Result<()> {
        let outputs = || (0..).zip(self.variables).filter(|(_, variable)| variable.causality == Causality::Output);
        if outputs().next().is_none() {
            return Ok(());
        }
        group(xml, "Outputs", |xml| {
            outputs().try_for_each(|(reference, output)| write_unknown(xml, reference, Some(&output.dependencies)))
        })?;
        group(xml, "InitialUnknowns", |xml| {
            outputs().try_for_each(|(reference, _)| {
                let dependencies = self.initial_dependencies.as_ref().map(|all| &*all[reference as usize]);
                write_unknown(xml, reference, dependencies)
            })
        })
    }
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
        Causality::Local => ("local", Some("calculated")),
    };
    let variability = match variable.variability {
        Variability::Fixed => "fixed",
        Variability::Discrete => "discrete",
        Variability::Continuous => "continuous",
    };
    attributes.extend([("causality", causality.to_owned()), ("variability", variability.to_owned())]);
    attributes.extend(initial.map(|initial| ("initial", initial.to_owned())));
    let kind = match variable.kind {
        Kind::Real => "Real",
        Kind::Integer => "Integer",
        Kind::Boolean => "Boolean",
        Kind::String => "String",
    };
    element(xml, "ScalarVariable", &attributes, |xml| empty(xml, kind, &kind_attributes(variable)))
}

/// Attributes of the element that tells the kind of a variable: unit, start value and the like.
pub fn kind_attributes(variable: &Variable) -> Attributes<'static> {
    let unit = variable.unit.map(|unit| ("unit", unit.name().to_owned()));
    let display = variable.unit.and_then(Unit::display).map(|(name, _)| ("displayUnit", name.to_owned()));
    let start = variable.start.as_ref().map(|start| {
        let text = match start {
            Value::Real(value) => number(*value),
            Value::Boolean(value) => value.to_string(),
            Value::String(text) => text.clone(),
        };
        ("start", text)
    });
    unit.into_iter().chain(display).chain(start).collect()
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
        let (experiment, tolerance) = (Experiment { stop_time: 0.133, step_size: 1e-3 }, 1e-9);
        // As if every output began with what the variables before it do.
        let of = |i: usize| (0..i as Reference).collect();
        let initial_dependencies = Some((0..variables.len()).map(of).collect());
        let orders = [2, 1];
        Interface { name, description, guid, variables, initial_dependencies, experiment, tolerance, orders }.to_xml()
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
    fn control_characters_are_refused() {
        let mut bad = variable("y", Causality::Output, None);
        bad.description = "two\nlines".to_owned();
        let message = xml_of(&[bad]).unwrap_err().to_string();
        assert!(message.starts_with("y: the text holds the character '\\n'"), "{message}");
    }
}
