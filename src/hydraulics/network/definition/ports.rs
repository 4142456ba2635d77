//! Ports of a network by name: what an element can be connected to.
//!
//! In: a definition. Out: the index of a port by its name. It must not know laws.
use super::HydraulicSystem;
use std::collections::HashMap;

/// Ports in the order of their indices: nodes, the chambers A and B of each cylinder, reservoirs.
#[derive(Debug)]
pub struct Ports {
    names: Vec<String>,
    indices: HashMap<String, usize>,
    /// Number of ports with a volume: nodes and chambers.
    pub volumes: usize,
    /// Number of nodes.
    pub nodes: usize,
}

impl Ports {
    /// The ports of a definition.
    pub fn new(system: &HydraulicSystem) -> Self {
        let owned = |names: Vec<&str>| names.into_iter().map(str::to_owned).collect::<Vec<_>>();
        let mut names = owned(system.nodes.names());
        let nodes = names.len();
        names.extend(system.cylinders.iter().flat_map(|(name, _)| ["a", "b"].map(|side| format!("{name}.{side}"))));
        let volumes = names.len();
        names.extend(owned(system.reservoirs.names()));
        let indices = names.iter().enumerate().map(|(index, name)| (name.clone(), index)).collect();
        Self { names, indices, volumes, nodes }
    }

    /// Index of the port of this name.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.indices.get(name).copied()
    }

    /// Names of all ports.
    pub fn names(&self) -> &[String] {
        &self.names
    }
}
