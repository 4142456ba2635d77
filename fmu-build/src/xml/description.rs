//! The reader of `modelDescription.xml`.
//!
//! In: the text of the file, of FMI 2.0 or 3.0 and of any program. Out: the model, its default experiment, its
//! variables. Other elements and attributes are skipped.

use anyhow::{Context, Result, bail};
use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};
use serde::Serialize;
use std::collections::BTreeMap;

/// Elements for the kinds of simulation of an FMU.
const INTERFACES: [&str; 3] = ["CoSimulation", "ModelExchange", "ScheduledExecution"];

/// The interface of an FMU.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Description {
    /// Version of FMI.
    pub fmi_version: String,
    /// Name of the model.
    pub name: String,
    /// Its description.
    pub description: String,
    /// GUID, or token of FMI 3.0.
    pub guid: String,
    /// Program that wrote the FMU.
    pub generation_tool: String,
    /// Kinds of simulation, each with its modelIdentifier.
    pub interfaces: BTreeMap<String, String>,
    /// Default experiment.
    pub experiment: Experiment,
    /// Variables, in their order.
    pub variables: Vec<Described>,
}

/// Default experiment as it is written.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Experiment {
    /// Start time [s].
    pub start_time: Option<f64>,
    /// Stop time [s].
    pub stop_time: Option<f64>,
    /// Communication step [s].
    pub step_size: Option<f64>,
    /// Relative tolerance.
    pub tolerance: Option<f64>,
}

/// A variable as it is written. Missing parts are empty.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Described {
    /// Name.
    pub name: String,
    /// Value reference.
    pub reference: String,
    /// Type, such as Real. An array has its dimensions, such as Float64[2].
    pub kind: String,
    /// Causality.
    pub causality: String,
    /// Variability.
    pub variability: String,
    /// Unit.
    pub unit: String,
    /// Start value.
    pub start: Option<String>,
    /// Usual magnitude.
    #[serde(skip)]
    pub nominal: Option<f64>,
    /// Description.
    pub description: String,
}

/// Largest number of parent elements of an element about a variable.
const DEEPEST: usize = 3;

/// Attributes of an element by name.
pub(super) struct Attributes(pub(super) BTreeMap<String, String>);

impl Attributes {
    pub(super) fn of(element: &BytesStart) -> Result<Self> {
        let mut all = BTreeMap::new();
        // The reader's own check for duplicates compares all pairs.
        for attribute in element.attributes().with_checks(false) {
            let attribute = attribute?;
            let value = attribute.normalized_value(XmlVersion::Implicit1_0)?.into_owned();
            let name = attribute.key.as_ref().to_owned();
            if all.insert(name.clone(), value).is_some() {
                bail!("the attribute {name} occurs twice");
            }
        }
        Ok(Self(all))
    }

    pub(super) fn take(&mut self, name: &str) -> String {
        self.0.remove(name).unwrap_or_default()
    }

    pub(super) fn number(&mut self, name: &str) -> Result<Option<f64>> {
        let read =
            |text: String| text.trim().parse().with_context(|| format!("{name} is \"{text}\", which is not a number"));
        self.0.remove(name).map(read).transpose()
    }
}

impl Description {
    /// Read the file.
    ///
    /// # Errors
    /// The text is no XML, or its root is not `fmiModelDescription`.
    pub fn parse(xml: &str) -> Result<Self> {
        let mut reader = Reader::from_str(xml.trim_start_matches('\u{feff}'));
        let mut out = Self::default();
        // Open elements.
        let mut open: Vec<String> = Vec::new();
        loop {
            let event = reader.read_event();
            match event.with_context(|| format!("the text is not XML at byte {}", reader.error_position()))? {
                Event::Start(element) => {
                    out.take(&open, &element)?;
                    open.push(element.name().as_ref().to_owned());
                }
                Event::Empty(element) => out.take(&open, &element)?,
                Event::End(_) => drop(open.pop()),
                Event::Eof => break,
                _ => {}
            }
        }
        if let Some(element) = open.last() {
            bail!("the text is not XML: it ends within the element {element}");
        }
        if out.fmi_version.is_empty() {
            bail!("there is no element fmiModelDescription with an fmiVersion");
        }
        Ok(out)
    }

    /// Read the data of an element with these parents.
    fn take(&mut self, open: &[String], element: &BytesStart) -> Result<()> {
        if open.len() > DEEPEST {
            return Ok(());
        }
        let name = element.name().as_ref().to_owned();
        let path: Vec<&str> = open.iter().map(String::as_str).collect();
        let mut attributes = Attributes::of(element).with_context(|| format!("element {name}"))?;
        match path[..] {
            [] if name == "fmiModelDescription" => {
                self.fmi_version = attributes.take("fmiVersion");
                self.name = attributes.take("modelName");
                self.description = attributes.take("description");
                self.generation_tool = attributes.take("generationTool");
                self.guid =
                    attributes.take(if self.fmi_version.starts_with('3') { "instantiationToken" } else { "guid" });
            }
            ["fmiModelDescription"] if INTERFACES.contains(&&*name) => {
                self.interfaces.insert(name, attributes.take("modelIdentifier"));
            }
            ["fmiModelDescription"] if name == "DefaultExperiment" => {
                self.experiment = Experiment {
                    start_time: attributes.number("startTime")?,
                    stop_time: attributes.number("stopTime")?,
                    step_size: attributes.number("stepSize")?,
                    tolerance: attributes.number("tolerance")?,
                };
            }
            ["fmiModelDescription", "ModelVariables"] => self.variables.push(Described {
                name: attributes.take("name"),
                reference: attributes.take("valueReference"),
                causality: attributes.take("causality"),
                variability: attributes.take("variability"),
                description: attributes.take("description"),
                // In FMI 2.0 the type is a separate element with unit and start value.
                kind: if name == "ScalarVariable" { String::new() } else { name },
                unit: attributes.take("unit"),
                start: attributes.0.remove("start"),
                nominal: attributes.number("nominal")?,
            }),
            ["fmiModelDescription", "ModelVariables", _] if name == "Dimension" => {
                if let Some(variable) = self.variables.last_mut() {
                    variable.kind += &format!("[{}]", attributes.take("start"));
                }
            }
            ["fmiModelDescription", "ModelVariables", "ScalarVariable"] if name != "Annotations" => {
                if let Some(variable) = self.variables.last_mut() {
                    (variable.kind, variable.unit) = (name, attributes.take("unit"));
                    variable.start = attributes.0.remove("start");
                    variable.nominal = attributes.number("nominal")?;
                }
            }
            _ => {}
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn variables_of_both_versions_are_read() {
        let second = "<?xml version=\"1.0\"?><fmiModelDescription fmiVersion=\"2.0\" modelName=\"A &amp; B\" \
                      guid=\"{1}\"><CoSimulation \
                      modelIdentifier=\"ab\"><SourceFiles/></CoSimulation><DefaultExperiment stopTime=\"2\" \
                      stepSize=\"1e-3\"/><ModelVariables><ScalarVariable name=\"x\" valueReference=\"7\" \
                      causality=\"input\"><Real unit=\"N\" nominal=\"2e3\" \
                      start=\"3\"/><Annotations/></ScalarVariable></ModelVariables></fmiModelDescription>";
        let read = Description::parse(second).unwrap();
        assert_eq!((&*read.name, &*read.guid, &*read.interfaces["CoSimulation"]), ("A & B", "{1}", "ab"));
        assert_eq!((read.experiment.stop_time, read.experiment.tolerance), (Some(2.0), None));
        let variable = &read.variables[0];
        assert_eq!((&*variable.name, &*variable.reference, &*variable.kind), ("x", "7", "Real"));
        assert_eq!((&*variable.unit, variable.start.as_deref(), variable.nominal), ("N", Some("3"), Some(2e3)));
        let third = "<fmiModelDescription fmiVersion=\"3.0\" instantiationToken=\"{2}\"><ModelVariables>\
            <Float64 name=\"x\" unit=\"N\" start=\"3\"/><Float64 name=\"y\"><Dimension \
            start=\"2\"/></Float64></ModelVariables>\
            </fmiModelDescription>";
        let read = Description::parse(third).unwrap();
        assert_eq!((&*read.guid, &*read.variables[0].kind, &*read.variables[0].unit), ("{2}", "Float64", "N"));
        assert_eq!(read.variables[1].kind, "Float64[2]");
    }

    #[test]
    fn a_text_that_is_no_description_is_rejected() {
        for text in ["", "{}", "<html/>", "<fmiModelDescription fmiVersion=\"2.0\"", "<a></b>", "<a b='1' b='2'/>"] {
            assert!(Description::parse(text).is_err(), "{text}");
        }
    }

    /// 2 MB of nested elements, and of attributes of one element.
    #[test]
    fn the_time_of_reading_is_proportional_to_the_length_of_the_text() {
        let nested = "<a>".repeat(300_000) + &"</a>".repeat(300_000);
        let many: String = (0..200_000).map(|k| format!(" a{k}='1'")).collect();
        let text = format!("<fmiModelDescription fmiVersion=\"2.0\"><b{many}/>{nested}</fmiModelDescription>");
        let start = std::time::Instant::now();
        assert!(Description::parse(&text).unwrap().variables.is_empty());
        assert!(start.elapsed().as_secs_f64() < 30.0, "{:?}", start.elapsed());
    }
}
