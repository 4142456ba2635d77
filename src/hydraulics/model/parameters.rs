//! What follows from the present parameters of a model.
//!
//! In: a definition with its laws, inputs. Out: the setting of a step. It must not know steps.
use super::Parameters;
use crate::definition::HydraulicActuator;
use crate::inputs::{Input, Inputs};
use crate::state::{Setting, State};

impl Parameters {
    pub fn setting<'a>(&'a self, inputs: &'a Inputs) -> Setting<'a> {
        let HydraulicActuator { circuit, solver, .. } = &self.definition;
        Setting { laws: &self.laws, circuit, solver, inputs, watches: false }
    }

    /// The next step of the host [s]: that of the input; without one as the last step, at first that of the experiment.
    pub fn horizon(&self, inputs: &Inputs, state: &State) -> f64 {
        match inputs.get(Input::Horizon) {
            0.0 => state.next_step(self.definition.experiment.step_size),
            told => told,
        }
    }
}
