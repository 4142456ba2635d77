//! The kinds of models: their definition files, constructors and inspectors.
use super::outermost::outermost_keys;
use super::{Component, Refused};
use crate::codec::sections::Sections;
use crate::format::{Described, Table};
use crate::hydraulics::{self, network};
use crate::inspection::Inspection;
use crate::mechanism;
use std::sync::Arc;

type Constructor = fn(&str, Option<Arc<Sections>>) -> Result<Component, Refused>;
type Inspector = fn(&str) -> Inspection;

/// A kind of model.
#[derive(Debug)]
pub struct ModelKind {
    /// Name of the definition file.
    pub(super) file: &'static str,
    /// Creates a component from the text of the definition and the stored tables.
    pub(super) construct: Constructor,
}

impl ModelKind {
    /// Name of the definition file.
    pub fn file(&self) -> &'static str {
        self.file
    }
}

/// A planar linkage with one degree of freedom, with or without a hydraulic circuit or network.
pub const MECHANISM: ModelKind = ModelKind {
    file: "mechanism.json",
    construct: |text, tables| {
        mechanism::allow_hydraulics();
        (PLAIN_MECHANISM.construct)(text, tables)
    },
};
/// A planar linkage with one degree of freedom and no hydraulics.
pub const PLAIN_MECHANISM: ModelKind = ModelKind {
    file: MECHANISM.file,
    construct: |text, tables| Ok(Component::Mechanism(mechanism::Model::shared(text, tables)?)),
};
/// A hydraulic actuator alone.
pub const HYDRAULIC_ACTUATOR: ModelKind = ModelKind {
    file: hydraulics::FILE,
    construct: |text, _| Ok(Component::Hydraulic(Box::new(hydraulics::Model::from_json(text)?))),
};
/// A supply network with cylinders.
pub const HYDRAULIC_SYSTEM: ModelKind = ModelKind {
    file: network::FILE,
    construct: |text, _| Ok(Component::Hydraulic(Box::new(network::Model::from_json(text)?))),
};
/// All kinds of models. A library built for some of them does not contain the code of the others.
pub const KINDS: [ModelKind; 3] = [MECHANISM, HYDRAULIC_ACTUATOR, HYDRAULIC_SYSTEM];
/// Inspector of each kind. The table is separate, so that a library without inspections does not contain their code.
const INSPECTORS: [Inspector; KINDS.len()] =
    [mechanism::inspection::inspect, hydraulics::inspection::inspect, network::inspection::inspect];

#[cold]
fn no_kind(file: &str) -> Refused {
    let files = Component::definition_files().join(" or ");
    Refused(format!("'{file}' is not the name of a definition file; name the file {files}"))
}

impl Component {
    /// Names of the definition files, one for each kind of model.
    pub fn definition_files() -> [&'static str; KINDS.len()] {
        KINDS.map(|kind| kind.file)
    }

    /// The component described by the definition file with this name and text.
    ///
    /// # Errors
    /// No kind of model has a definition file with this name, or the text is faulty.
    pub fn from_definition(file: &str, text: &str) -> Result<Self, Refused> {
        match KINDS.iter().find(|kind| kind.file == file) {
            Some(kind) => (kind.construct)(text, None),
            None => Err(no_kind(file)),
        }
    }

    /// All faults in the text of the definition file with this name, and facts about the model.
    ///
    /// # Errors
    /// No kind of model has a definition file with this name.
    pub fn inspect(file: &str, text: &str) -> Result<Inspection, Refused> {
        match KINDS.iter().zip(INSPECTORS).find(|(kind, _)| kind.file == file) {
            Some((_, inspect)) => Ok(inspect(text)),
            None => Err(no_kind(file)),
        }
    }

    /// Name of the definition file of the kind of model that a text describes. This is the kind for which the text
    /// contains the most keys that no other kind has. The text may contain errors of JSON. None without a unique kind.
    pub fn kind_of(text: &str) -> Option<&'static str> {
        let keys = outermost_keys(text);
        let tables: [&Table; KINDS.len()] = [
            mechanism::definition::Mechanism::TABLE,
            hydraulics::definition::HydraulicActuator::TABLE,
            network::definition::HydraulicSystem::TABLE,
        ];
        let has = |kind: usize, key: &str| tables[kind].position(key).is_some();
        let is_own =
            |kind: usize, key: &str| has(kind, key) && (0..tables.len()).all(|other| other == kind || !has(other, key));
        let own = |kind: usize| keys.iter().filter(|key| is_own(kind, key)).count();
        let counts: [usize; KINDS.len()] = std::array::from_fn(own);
        let most = counts.iter().copied().max().filter(|most| *most > 0)?;
        let mut kinds = (0..KINDS.len()).filter(|kind| counts[*kind] == most);
        kinds.next().filter(|_| kinds.next().is_none()).map(|kind| KINDS[kind].file)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_kind_has_a_separate_definition_file() {
        let gear = Component::from_definition("mechanism.json", mechanism::GEAR).unwrap();
        assert_eq!(gear.definition_file(), "mechanism.json");
        assert!(Component::from_definition("mechanism.json", "{}").is_err());
        let actuator = Component::from_definition("hydraulics.json", r#"{ "name": "Actuator" }"#).unwrap();
        assert_eq!(actuator.definition_file(), "hydraulics.json");
        let system = r#"{ "name": "System", "nodes": { "line": { "volume": 1e-3 } } }"#;
        assert_eq!(Component::from_definition("network.json", system).unwrap().definition_file(), "network.json");
        assert_eq!(Component::kind_of(system), Some("network.json"));
        let ram = r#"{ "name": "Ram", "circuit": { "cylinder": { "bore": 0.03, "rod": 0.018 } } }"#;
        assert_eq!(Component::kind_of(ram), Some("hydraulics.json"));
        assert_eq!(Component::kind_of(mechanism::GEAR), Some("mechanism.json"));
        assert_eq!(Component::kind_of(r#"{ "name": "Ram" }"#), None);
        // Faults of JSON do not hide the kind.
        for (from, to) in [
            ("1e-3 } }", "1e-3 } "),
            ("\"System\",", "\"System\""),
            ("1e-3", "1e-3,"),
            ("{ \"name\"", "// a\n{ \"name\""),
        ] {
            assert!(system.contains(from), "{from}");
            assert_eq!(Component::kind_of(&system.replacen(from, to, 1)), Some("network.json"), "{to}");
        }
        assert_eq!(Component::kind_of(&ram.replace("}", "")), Some("hydraulics.json"));
        assert!(Component::from_definition("other.json", mechanism::GEAR).unwrap_err().0.contains("other.json"));
    }
}
