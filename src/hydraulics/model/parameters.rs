//! The definition of a model as read, and its present parameters.
//!
//! In: a definition, values of its parameters. Out: the laws that follow from them, the start. It must not know steps.
use crate::format::Range;
use crate::hydraulics::circuit::Equations;
use crate::hydraulics::definition::{HydraulicActuator, Role, check_pressure};
use crate::hydraulics::error::HydraulicsError;
use crate::hydraulics::inputs::{Input, Inputs};
use crate::hydraulics::interface::Quantity;
use crate::hydraulics::state::{Setting, State};
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
    pub actuator: HydraulicActuator,
    /// Numeric parameters, in the order of [`HydraulicActuator::parameters`].
    pub values: Vec<f64>,
    pub laws: Equations,
}

impl Parameters {
    pub fn new(mut actuator: HydraulicActuator) -> Self {
        let mut values = Vec::new();
        actuator.parameters(&mut |_, value| values.push(*value));
        Self { laws: Equations::new(&actuator.circuit), actuator, values }
    }

    /// Write the values into the definition.
    pub fn update(&mut self) {
        let mut values = self.values.iter();
        self.actuator.parameters(&mut |_, value| *value = values.next().copied().unwrap_or(*value));
        self.laws = Equations::new(&self.actuator.circuit);
    }

    pub fn setting<'a>(&'a self, inputs: &'a Inputs) -> Setting<'a> {
        let HydraulicActuator { circuit, solver, .. } = &self.actuator;
        Setting { laws: &self.laws, circuit, solver, inputs, watches: false }
    }

    /// The next step of the host [s]: that of the input; without one as the last step, at first that of the experiment.
    pub fn horizon(&self, inputs: &Inputs, state: &State) -> f64 {
        match inputs.get(Input::Horizon) {
            0.0 => state.next_step(self.actuator.experiment.step_size),
            told => told,
        }
    }

    /// Check the parameters, and the pressures of the ports, which are relative to the ambient pressure, a parameter.
    ///
    /// # Errors
    /// The first number out of range, with its name, its value and what is allowed.
    pub fn check(&self, inputs: &Inputs) -> Result<(), HydraulicsError> {
        self.actuator.check()?;
        for (name, input) in [("supply.pressure", Input::Supply), ("tank.pressure", Input::Tank)] {
            check_pressure(name, inputs.get(input), self.actuator.circuit.fluid.ambient_pressure)?;
        }
        Ok(())
    }

    /// The start under these parameters and inputs.
    pub fn start(&self, inputs: &Inputs) -> State {
        State::at_start(&self.laws, &self.actuator.circuit, inputs.get(Input::Supply))
    }
}
