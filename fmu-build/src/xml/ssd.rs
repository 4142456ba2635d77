//! `SystemStructure.ssd` of SSP 1.0: FMUs, their connections, values of parameters, units, positions in a diagram.
//!
//! In: consistent variables, connections and values. Out: the text of the file. The module must not know what the FMUs
//! model.
use super::common::{Xml, document, element, empty, group, number, write_unit};
use super::interface::{type_name, write_items};
use anyhow::Result;
use linkage_fmu::variables::{Causality, Kind, Reference, Unit, Value, Variable};
use std::collections::{BTreeMap, BTreeSet};
use std::io;

/// Name of the file in the package.
pub const PATH: &str = "SystemStructure.ssd";
/// Name of the parameter set of each FMU. ECOS needs one name: it reads the values with one name from all sets.
const VALUES: &str = "initialValues";

/// One FMU of a system.
#[derive(Clone, Debug)]
pub struct Part<'a> {
    /// Name in the system.
    pub name: &'a str,
    /// Name of the FMU file in the folder `resources`.
    pub file: &'a str,
    /// Variables of the FMU.
    pub variables: &'a [Variable],
    /// Connected, shown or set variables.
    pub connectors: Vec<&'a Variable>,
    /// Positions of the connectors, relative to width and height from the lower left corner of the FMU.
    pub places: Vec<[f64; 2]>,
    /// Values of parameters and inputs that differ from those of the FMU, in the units of the variables.
    pub values: &'a [(Reference, Value)],
    /// Lower left and upper right corner in the diagram.
    pub area: [f64; 4],
}

/// A system: name, FMUs, connections from an output of one FMU to an input of another FMU, diagram, stop time [s].
///
/// The system itself has no connectors, because libcosim and ECOS reject a connection that starts or ends at the
/// system.
#[derive(Clone, Debug)]
pub struct System<'a> {
    /// Name.
    pub name: &'a str,
    /// One line of text; may be empty.
    pub description: &'a str,
    /// FMUs.
    pub parts: &'a [Part<'a>],
    /// Part and output, part and input.
    pub connections: &'a [[(usize, Reference); 2]],
    /// Lower left and upper right corner of the diagram.
    pub area: [f64; 4],
    /// End of the default experiment [s].
    pub stop_time: f64,
}

impl System<'_> {
    /// Text of the file.
    ///
    /// # Errors
    /// The text cannot be written.
    pub fn text(&self) -> Result<String> {
        let namespace = |part: &str| format!("http://ssp-standard.org/SSP1/SystemStructure{part}");
        let mut header = vec![
            ("xmlns:ssc", namespace("Common")),
            ("xmlns:ssd", namespace("Description")),
            ("xmlns:ssv", namespace("ParameterValues")),
            ("version", "1.0".to_owned()),
            ("name", self.name.to_owned()),
            ("generationTool", format!("linkage-fmu {}", env!("CARGO_PKG_VERSION"))),
        ];
        if !self.description.is_empty() {
            header.push(("description", self.description.to_owned()));
        }
        document("ssd:SystemStructureDescription", &header, |xml| {
            element(xml, "ssd:System", &[("name", self.name.to_owned())], |xml| self.write_system(xml))?;
            let connectors = || self.parts.iter().flat_map(|part| part.connectors.iter().copied());
            write_enumerations(xml, connectors())?;
            write_units(xml, "ssd:Units", connectors())?;
            let experiment = [("startTime", number(0.0)), ("stopTime", number(self.stop_time))];
            empty(xml, "ssd:DefaultExperiment", &experiment)
        })
    }

    fn write_system(&self, xml: &mut Xml) -> io::Result<()> {
        group(xml, "ssd:Elements", |xml| self.parts.iter().try_for_each(|part| part.write(xml)))?;
        if !self.connections.is_empty() {
            group(xml, "ssd:Connections", |xml| {
                self.connections.iter().try_for_each(|ends| {
                    let [start, end] = ends.map(|(part, reference)| {
                        let part = &self.parts[part];
                        [part.name.to_owned(), part.variables[reference as usize].name.clone()]
                    });
                    let names = ["startElement", "startConnector", "endElement", "endConnector"];
                    let ends: Vec<_> = names.into_iter().zip(start.into_iter().chain(end)).collect();
                    empty(xml, "ssd:Connection", &ends)
                })
            })?;
        }
        empty(xml, "ssd:SystemGeometry", &corners(self.area))
    }
}

/// Attributes of a rectangle.
fn corners(area: [f64; 4]) -> Vec<(&'static str, String)> {
    ["x1", "y1", "x2", "y2"].into_iter().zip(area.map(number)).collect()
}

impl Part<'_> {
    fn write(&self, xml: &mut Xml) -> io::Result<()> {
        let attributes = [
            ("name", self.name.to_owned()),
            ("type", "application/x-fmu-sharedlibrary".to_owned()),
            ("source", format!("resources/{}", self.file)),
            ("implementation", "CoSimulation".to_owned()),
        ];
        element(xml, "ssd:Component", &attributes, |xml| {
            if !self.connectors.is_empty() {
                group(xml, "ssd:Connectors", |xml| {
                    let mut all = self.connectors.iter().zip(&self.places);
                    all.try_for_each(|(variable, place)| write_connector(xml, variable, *place))
                })?;
            }
            empty(xml, "ssd:ElementGeometry", &corners(self.area))?;
            if self.values.is_empty() {
                return Ok(());
            }
            let header = [("version", "1.0".to_owned()), ("name", VALUES.to_owned())];
            let values = || self.values.iter().map(|(reference, value)| (&self.variables[*reference as usize], value));
            let write_set = |xml: &mut Xml| {
                group(xml, "ssv:Parameters", |xml| {
                    values().try_for_each(|(variable, value)| write_value(xml, variable, value))
                })?;
                // A parameter set is read separately, so it contains the units that it uses (SSP 1.0.1, 6).
                write_units(xml, "ssv:Units", values().map(|(variable, _)| variable))
            };
            group(xml, "ssd:ParameterBindings", |xml| {
                group(xml, "ssd:ParameterBinding", |xml| {
                    group(xml, "ssd:ParameterValues", |xml| element(xml, "ssv:ParameterSet", &header, write_set))
                })
            })
        })
    }
}

/// The types of these Enumerations, without duplicates. No element if there is none.
fn write_enumerations<'a>(xml: &mut Xml, variables: impl Iterator<Item = &'a Variable>) -> io::Result<()> {
    let types: BTreeMap<String, &Variable> = variables
        .filter(|variable| variable.kind == Kind::Enumeration)
        .map(|variable| (type_name(variable), variable))
        .collect();
    if types.is_empty() {
        return Ok(());
    }
    group(xml, "ssd:Enumerations", |xml| {
        types.into_iter().try_for_each(|(name, variable)| {
            element(xml, "ssc:Enumeration", &[("name", name)], |xml| write_items(xml, "ssc:Item", variable))
        })
    })
}

/// The units of these variables, without duplicates. No element if there is none.
fn write_units<'a>(xml: &mut Xml, name: &str, variables: impl Iterator<Item = &'a Variable>) -> io::Result<()> {
    let units: BTreeSet<Unit> = variables.filter_map(|variable| variable.unit).collect();
    if units.is_empty() {
        return Ok(());
    }
    group(xml, name, |xml| {
        units.into_iter().try_for_each(|unit| write_unit(xml, unit, ["ssc:Unit", "ssc:BaseUnit", ""]))
    })
}

fn write_connector(xml: &mut Xml, variable: &Variable, [x, y]: [f64; 2]) -> io::Result<()> {
    let kind = match variable.causality {
        Causality::Parameter => "parameter",
        Causality::CalculatedParameter => "calculatedParameter",
        Causality::Input => "input",
        Causality::Output | Causality::Local => "output",
    };
    let attributes = [("name", variable.name.clone()), ("kind", kind.to_owned())];
    element(xml, "ssd:Connector", &attributes, |xml| {
        let attributes: Vec<_> = match variable.kind {
            Kind::Enumeration => vec![("name", type_name(variable))],
            _ => variable.unit.iter().map(|unit| ("unit", unit.name().to_owned())).collect(),
        };
        empty(xml, &format!("ssc:{}", variable.kind.word()), &attributes)?;
        empty(xml, "ssd:ConnectorGeometry", &[("x", number(x)), ("y", number(y))])
    })
}

fn write_value(xml: &mut Xml, variable: &Variable, value: &Value) -> io::Result<()> {
    let unit = variable.unit.map(|unit| ("unit", unit.name().to_owned()));
    let (kind, attributes) = match value {
        Value::Real(value) => ("ssv:Real", [("value", number(*value))].into_iter().chain(unit).collect::<Vec<_>>()),
        Value::Boolean(value) => ("ssv:Boolean", vec![("value", value.to_string())]),
        Value::Item(item) => ("ssv:Enumeration", vec![("value", item.clone())]),
    };
    let name = [("name", variable.name.clone())];
    element(xml, "ssv:Parameter", &name, |xml| empty(xml, kind, &attributes))
}

#[cfg(test)]
mod tests {
    use super::*;
    use linkage_fmu::variables::{Details, Unit, Variability};

    fn variable(name: &str, causality: Causality, kind: Kind, unit: Option<Unit>) -> Variable {
        let items: &[&str] = if kind == Kind::Enumeration { &["fast", "exact"] } else { &[] };
        Variable {
            name: name.into(),
            description: String::new(),
            kind,
            causality,
            variability: Variability::Continuous,
            unit,
            start: None,
            dependencies: Vec::new(),
            details: Details { items, ..Details::default() },
        }
    }

    /// A mass and a spring.
    #[test]
    fn parts_connections_values_units_and_geometry_are_in_the_file() {
        let real = |name, causality, unit| variable(name, causality, Kind::Real, Some(unit));
        let mass = [real("force", Causality::Input, Unit::Newton), real("length", Causality::Output, Unit::Metre)];
        let spring = [
            real("force", Causality::Output, Unit::Newton),
            real("length", Causality::Input, Unit::Metre),
            real("stiffness", Causality::Parameter, Unit::NewtonPerMetre),
            variable("method", Causality::Parameter, Kind::Enumeration, None),
        ];
        let values = [(2, Value::Real(2e6)), (3, Value::Item("exact".into()))];
        let part = |name, file, variables, values| Part {
            name,
            file,
            variables,
            connectors: <[Variable]>::iter(variables).collect(),
            places: vec![[0.0, 0.5]; variables.len()],
            values,
            area: [0.0, -20.0, 160.0, 0.0],
        };
        let parts = [part("mass", "Mass.fmu", &mass, &[]), part("spring", "Spring.fmu", &spring, &values[..])];
        let (connections, area) = ([[(1, 0), (0, 0)], [(0, 1), (1, 1)]], [-40.0, -60.0, 440.0, 40.0]);
        let system = System {
            name: "Pair",
            description: "Mass & spring",
            parts: &parts,
            connections: &connections,
            area,
            stop_time: 2.0,
        };
        let text = system.text().unwrap();
        for piece in [
            "description=\"Mass &amp; spring\"",
            "<ssd:System name=\"Pair\">",
            "source=\"resources/Spring.fmu\" implementation=\"CoSimulation\"",
            "<ssd:Connection startElement=\"spring\" startConnector=\"force\" endElement=\"mass\" \
             endConnector=\"force\"/>",
            "<ssd:Connector name=\"length\" kind=\"input\">",
            "<ssd:ConnectorGeometry x=\"0\" y=\"0.5\"/>",
            "<ssd:ElementGeometry x1=\"0\" y1=\"-20\" x2=\"160\" y2=\"0\"/>",
            "<ssd:SystemGeometry x1=\"-40\" y1=\"-60\" x2=\"440\" y2=\"40\"/>",
            "<ssv:Real value=\"2000000\" unit=\"N/m\"/>",
            "<ssv:Enumeration value=\"exact\"/>",
            "<ssc:Enumeration name=\"method.item\">",
            "<ssc:Item name=\"exact\" value=\"2\"/>",
            "<ssc:BaseUnit kg=\"1\" s=\"-2\"/>",
            "<ssd:DefaultExperiment startTime=\"0\" stopTime=\"2\"/>",
        ] {
            assert!(text.contains(piece), "no {piece} in\n{text}");
        }
    }
}
