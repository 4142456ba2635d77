//! `SystemStructure.ssd` of SSP 1.0: FMUs, their connections, values of parameters, units.
//!
//! In: the variables of the FMUs and what is connected. Out: the text of the file. It must not know what the FMUs
//! model.
use super::common::{Xml, document, element, empty, group, number, write_unit};
use anyhow::{Context, Result, bail};
use linkage_fmu::variables::{Causality, Kind, Unit, Value, Variable};
use std::collections::BTreeSet;
use std::io;

/// Name of the file in the package.
pub const PATH: &str = "SystemStructure.ssd";
/// Name of the set of values of each FMU. One name for all: ECOS takes the values of one name from all of them.
const VALUES: &str = "initialValues";

/// One FMU of a system.
#[derive(Clone, Copy, Debug)]
pub struct Part<'a> {
    /// Name in the system.
    pub name: &'a str,
    /// Name of the FMU file in the folder `resources`.
    pub file: &'a str,
    /// Variables of the FMU.
    pub variables: &'a [Variable],
    /// Values other than the FMU's own, of parameters and inputs.
    pub values: &'a [(&'a str, Value)],
}

/// A system: name, FMUs, connections from an output of one to an input of another, connectors left open, stop time [s].
///
/// The system has no connectors of its own: libcosim and ECOS refuse a connection that begins or ends at the system.
#[derive(Clone, Copy, Debug)]
pub struct System<'a> {
    /// Name.
    pub name: &'a str,
    /// FMUs.
    pub parts: &'a [Part<'a>],
    /// Part and output, part and input.
    pub connections: &'a [[(usize, &'a str); 2]],
    /// Part and variable of connectors that are connected with nothing.
    pub open: &'a [(usize, &'a str)],
    /// End of the default experiment [s].
    pub stop_time: f64,
}

impl Part<'_> {
    fn find(&self, name: &str) -> Result<&Variable> {
        let found = self.variables.iter().find(|variable| variable.name == name);
        found.with_context(|| format!("{} has no variable {name}; pack an FMU that has this variable", self.name))
    }
}

impl System<'_> {
    /// Text of the file.
    ///
    /// # Errors
    /// A variable does not exist, a connection does not lead from an output to an input of the same type and unit, an
    /// input has two connections, or a value has another type than its variable.
    pub fn text(&self) -> Result<String> {
        self.check()?;
        let namespace = |part: &str| format!("http://ssp-standard.org/SSP1/SystemStructure{part}");
        let header = [
            ("xmlns:ssc", namespace("Common")),
            ("xmlns:ssd", namespace("Description")),
            ("xmlns:ssv", namespace("ParameterValues")),
            ("version", "1.0".to_owned()),
            ("name", self.name.to_owned()),
            ("generationTool", format!("linkage-fmu {}", env!("CARGO_PKG_VERSION"))),
        ];
        document("ssd:SystemStructureDescription", &header, |xml| {
            element(xml, "ssd:System", &[("name", self.name.to_owned())], |xml| self.write_system(xml))?;
            write_units(xml, "ssd:Units", (0..self.parts.len()).flat_map(|part| self.connectors(part)))?;
            let experiment = [("startTime", number(0.0)), ("stopTime", number(self.stop_time))];
            empty(xml, "ssd:DefaultExperiment", &experiment)
        })
    }

    fn check(&self) -> Result<()> {
        let mut ends = BTreeSet::new();
        for &[(from, output), (to, input)] in self.connections {
            let (output, input) = (self.parts[from].find(output)?, self.parts[to].find(input)?);
            let directed = output.causality == Causality::Output && input.causality == Causality::Input;
            if !directed || output.unit != input.unit || output.kind != input.kind {
                let unit = |variable: &Variable| variable.unit.map_or("no unit", Unit::name);
                bail!(
                    "{} ({:?}, {}) cannot be connected with {} ({:?}, {}): connect an output with an input of the \
                     same unit",
                    output.name,
                    output.causality,
                    unit(output),
                    input.name,
                    input.causality,
                    unit(input)
                );
            }
            if !ends.insert((to, &input.name)) {
                bail!("{} has two connections; remove one of the two connections", input.name);
            }
        }
        for &(part, name) in self.open {
            self.parts[part].find(name)?;
        }
        for part in self.parts {
            for (name, value) in part.values {
                let variable = part.find(name)?;
                let kind = match value {
                    Value::Real(_) => Kind::Real,
                    Value::Boolean(_) => Kind::Boolean,
                    Value::Item(_) => Kind::Enumeration,
                };
                if variable.kind != kind {
                    bail!("{name} is a {}; give {name} a value of this type", variable.kind.word());
                }
            }
        }
        Ok(())
    }

    /// Variables of a part that are connected, left open or given a value, each once, in the order of the FMU.
    fn connectors(&self, part: usize) -> impl Iterator<Item = &Variable> {
        let ends = self.connections.iter().flatten().chain(self.open);
        let named: BTreeSet<&str> = ends.filter(|end| end.0 == part).map(|end| end.1).collect();
        let given: BTreeSet<&str> = self.parts[part].values.iter().map(|(name, _)| *name).collect();
        let is_wanted = move |v: &&Variable| named.contains(v.name.as_str()) || given.contains(v.name.as_str());
        self.parts[part].variables.iter().filter(is_wanted)
    }

    fn write_system(&self, xml: &mut Xml) -> io::Result<()> {
        group(xml, "ssd:Elements", |xml| (0..self.parts.len()).try_for_each(|part| self.write_part(xml, part)))?;
        group(xml, "ssd:Connections", |xml| {
            self.connections.iter().try_for_each(|&[(from, output), (to, input)]| {
                let [start, end] = [from, to].map(|part| self.parts[part].name.to_owned());
                let ends = [
                    ("startElement", start),
                    ("startConnector", output.to_owned()),
                    ("endElement", end),
                    ("endConnector", input.to_owned()),
                ];
                empty(xml, "ssd:Connection", &ends)
            })
        })
    }

    fn write_part(&self, xml: &mut Xml, index: usize) -> io::Result<()> {
        let Part { name, file, values, .. } = self.parts[index];
        let attributes = [
            ("name", name.to_owned()),
            ("type", "application/x-fmu-sharedlibrary".to_owned()),
            ("source", format!("resources/{file}")),
            ("implementation", "CoSimulation".to_owned()),
        ];
        element(xml, "ssd:Component", &attributes, |xml| {
            group(xml, "ssd:Connectors", |xml| {
                self.connectors(index).try_for_each(|variable| write_connector(xml, variable))
            })?;
            if values.is_empty() {
                return Ok(());
            }
            let header = [("version", "1.0".to_owned()), ("name", VALUES.to_owned())];
            let variable = |name: &str| self.parts[index].variables.iter().find(|variable| variable.name == name);
            let write_set = |xml: &mut Xml| {
                group(xml, "ssv:Parameters", |xml| {
                    values.iter().try_for_each(|(parameter, value)| {
                        write_value(xml, parameter, value, variable(parameter).and_then(|variable| variable.unit))
                    })
                })?;
                // A set is read by itself, and so has the units that it names (SSP 1.0.1, 6).
                write_units(xml, "ssv:Units", values.iter().filter_map(|(parameter, _)| variable(parameter)))
            };
            group(xml, "ssd:ParameterBindings", |xml| {
                group(xml, "ssd:ParameterBinding", |xml| {
                    group(xml, "ssd:ParameterValues", |xml| element(xml, "ssv:ParameterSet", &header, write_set))
                })
            })
        })
    }
}

/// The units of these variables, each once; no element without one.
fn write_units<'a>(xml: &mut Xml, name: &str, variables: impl Iterator<Item = &'a Variable>) -> io::Result<()> {
    let units: BTreeSet<Unit> = variables.filter_map(|variable| variable.unit).collect();
    if units.is_empty() {
        return Ok(());
    }
    group(xml, name, |xml| {
        units.into_iter().try_for_each(|unit| write_unit(xml, unit, ["ssc:Unit", "ssc:BaseUnit", ""]))
    })
}

fn write_connector(xml: &mut Xml, variable: &Variable) -> io::Result<()> {
    let kind = match variable.causality {
        Causality::Parameter => "parameter",
        Causality::CalculatedParameter => "calculatedParameter",
        Causality::Input => "input",
        Causality::Output => "output",
        // Nothing is connected with one, and none is given a value.
        Causality::Local => return Ok(()),
    };
    let attributes = [("name", variable.name.clone()), ("kind", kind.to_owned())];
    element(xml, "ssd:Connector", &attributes, |xml| {
        let unit: Vec<_> = variable.unit.iter().map(|unit| ("unit", unit.name().to_owned())).collect();
        empty(xml, &format!("ssc:{}", variable.kind.word()), &unit)
    })
}

fn write_value(xml: &mut Xml, name: &str, value: &Value, unit: Option<Unit>) -> io::Result<()> {
    let unit = unit.map(|unit| ("unit", unit.name().to_owned()));
    let (kind, attributes) = match value {
        Value::Real(value) => ("ssv:Real", [("value", number(*value))].into_iter().chain(unit).collect::<Vec<_>>()),
        Value::Boolean(value) => ("ssv:Boolean", vec![("value", value.to_string())]),
        Value::Item(item) => ("ssv:Enumeration", vec![("value", item.clone())]),
    };
    element(xml, "ssv:Parameter", &[("name", name.to_owned())], |xml| empty(xml, kind, &attributes))
}

#[cfg(test)]
mod tests {
    use super::*;
    use linkage_fmu::variables::{Details, Variability};

    fn real(name: &str, causality: Causality, unit: Unit) -> Variable {
        Variable {
            name: name.into(),
            description: String::new(),
            kind: Kind::Real,
            causality,
            variability: Variability::Continuous,
            unit: Some(unit),
            start: None,
            dependencies: Vec::new(),
            details: Details::default(),
        }
    }

    /// A mass and a spring, and what is wrong with their system.
    fn system(connections: &[[(usize, &str); 2]], values: &[(&str, Value)]) -> Result<String> {
        let mass = [real("force", Causality::Input, Unit::Newton), real("length", Causality::Output, Unit::Metre)];
        let spring = [
            real("force", Causality::Output, Unit::Newton),
            real("length", Causality::Input, Unit::Metre),
            real("stiffness", Causality::Parameter, Unit::NewtonPerMetre),
            real("preload", Causality::Input, Unit::Newton),
        ];
        let parts = [
            Part { name: "mass", file: "Mass.fmu", variables: &mass, values: &[] },
            Part { name: "spring", file: "Spring.fmu", variables: &spring, values },
        ];
        System { name: "Pair", parts: &parts, connections, open: &[(1, "preload"), (0, "length")], stop_time: 2.0 }
            .text()
    }

    #[test]
    fn parts_connections_values_and_units_stand_in_the_file() {
        let values = [("stiffness", Value::Real(2e6))];
        let text = system(&[[(1, "force"), (0, "force")], [(0, "length"), (1, "length")]], &values).unwrap();
        for piece in [
            "<ssd:System name=\"Pair\">",
            "source=\"resources/Spring.fmu\" implementation=\"CoSimulation\"",
            "<ssd:Connection startElement=\"spring\" startConnector=\"force\" endElement=\"mass\" \
             endConnector=\"force\"/>",
            "<ssd:Connector name=\"preload\" kind=\"input\">",
            "<ssv:Real value=\"2000000\" unit=\"N/m\"/>",
            "<ssc:BaseUnit kg=\"1\" s=\"-2\"/>",
            "<ssd:DefaultExperiment startTime=\"0\" stopTime=\"2\"/>",
        ] {
            assert!(text.contains(piece), "no {piece} in\n{text}");
        }
    }

    #[test]
    fn what_does_not_fit_is_refused_by_name() {
        let twice = [[(1, "force"), (0, "force")], [(1, "force"), (0, "force")]];
        let text = [("stiffness", Value::Item("stiff".into()))];
        for (connections, values, piece) in [
            (&[[(1, "force"), (1, "length")]][..], &[][..], "an output with an input of the same unit"),
            (&[[(0, "force"), (1, "preload")]], &[], "an output with an input of the same unit"),
            (&[[(1, "force"), (0, "torque")]], &[], "mass has no variable torque"),
            (&twice, &[], "force has two connections"),
            (&[], &text, "stiffness is a Real"),
        ] {
            let message = system(connections, values).unwrap_err().to_string();
            assert!(message.contains(piece), "{message}");
        }
    }
}
