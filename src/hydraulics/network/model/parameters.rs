//! The definition of a model as read, and its present parameters.
//!
//! In: a definition, values of its parameters. Out: the laws that follow from them. It must not know steps.
use crate::format::{Range, Role};
use crate::hydraulics::network::definition::HydraulicSystem;
use crate::hydraulics::network::inputs::Inputs;
use crate::hydraulics::network::interface::Quantity;
use crate::hydraulics::network::laws::Laws;
use crate::hydraulics::network::state::Setting;
use crate::variables::Variables;
use std::sync::Arc;

/// A definition as read, before any value is set.
#[derive(Debug)]
pub struct Original {
    pub parameters: Arc<Parameters>,
    pub variables: Variables<Quantity>,
    pub ranges: Vec<(Range, Role)>,
    pub inputs: Inputs,
}

/// A definition with the values of its parameters, and the laws that follow from them.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameters {
    pub system: HydraulicSystem,
    /// Numeric parameters, in the order of [`HydraulicSystem::parameters`].
    pub values: Vec<f64>,
    pub laws: Laws,
    /// Names of the cylinders.
    names: Vec<String>,
}

impl Parameters {
    pub fn new(mut system: HydraulicSystem) -> Self {
        let mut values = Vec::new();
        system.parameters(&mut |_, value| values.push(*value));
        let names = system.cylinders.names().into_iter().map(str::to_owned).collect();
        Self { laws: Laws::new(&system), system, values, names }
    }

    /// Write the values into the definition.
    pub fn update(&mut self) {
        let mut values = self.values.iter();
        self.system.parameters(&mut |_, value| *value = values.next().copied().unwrap_or(*value));
        self.laws = Laws::new(&self.system);
    }

    pub fn setting<'a>(&'a self, inputs: &'a Inputs) -> Setting<'a> {
        Setting { laws: &self.laws, solver: &self.system.solver, inputs, names: &self.names }
    }
}
