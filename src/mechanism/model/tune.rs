//! Parameters that a host changes between two steps.
//!
//! In: parameters of laws and of the integration with new values, each in its range. Out: the same state of motion
//! under the laws with these values, or a refusal that changes nothing. It must not know any law.
use super::{Formulation, Model, ModelError};
use crate::mechanism::designs::{decides_reduced, shares_reduced};
use crate::mechanism::parameters::ParameterValues;
use crate::mechanism::quantity::{Output, Quantity};
use crate::variables::Reference;
use std::sync::Arc;

/// The laws of the last step, where parameters have changed since.
#[derive(Clone, Debug)]
pub struct Untuned {
    /// The parameters, settled.
    pub values: Arc<ParameterValues>,
    /// The energy that the balance referred to [J].
    pub reference: f64,
}

impl Model {
    /// Give tunable parameters these values, which [`Self::check_real`] and [`Self::check_together`] accept, and leave
    /// the motion as it is. The reduced model keeps the curve and all tables that the values do not change. Energy that
    /// the change stores, as in a bumper that is pressed and becomes stiffer, is work from outside. Values that are set
    /// back before the next step leave no trace. Before there is a state they are set as parameters are.
    ///
    /// # Errors
    /// The values together give no law, or `solver.method` = "`rigid_fem`"; nothing has changed.
    pub fn tune(&mut self, references: &[Reference], values: &[f64]) -> Result<(), ModelError> {
        if self.state.is_none() {
            return references.iter().zip(values).try_for_each(|(&reference, &value)| self.take_real(reference, value));
        }
        let mut tuned = Arc::clone(&self.parameter_values);
        let mut decides = false;
        for (&reference, &value) in references.iter().zip(values) {
            let Some(Quantity::Parameter(i)) = self.original.variables.quantity(reference) else { continue };
            if tuned.parameters[i].to_bits() != value.to_bits() {
                let ranges = &self.original.ranges;
                let changed = |i: usize| decides |= decides_reduced(ranges[i].1, false);
                Arc::make_mut(&mut tuned).set(i, value, changed);
            }
        }
        self.designs.settle(&mut tuned);
        if !decides {
            self.parameter_values = tuned;
            return Ok(());
        }
        let Some(state) = &mut self.state else { return Err(ModelError::NotInitialised) };
        let Formulation::Reduced(motion) = state else {
            let reason = "with solver.method = \"rigid_fem\" tunable parameters are fixed during a run; choose \
                          solver.method = \"reduced\"";
            return Err(ModelError::Derivative { what: "tunable parameters".into(), reason: reason.into() });
        };
        let ranges = &self.original.ranges;
        let untuned = self.untuned.clone().unwrap_or_else(|| Untuned {
            values: Arc::clone(&self.parameter_values),
            reference: motion.state.reference,
        });
        let old = self.designs.reduced(&untuned.values, ranges)?;
        let mut before = motion.retuned(&old, &self.inputs, untuned.reference)?;
        if shares_reduced(&tuned, &old, &untuned.values, ranges) {
            **motion = before;
            (self.reduced, self.parameter_values, self.untuned) = (Some(old), tuned, None);
            return Ok(());
        }
        let reduced = self.designs.reduced(&tuned, ranges)?;
        let mut retuned = before.retuned(&reduced, &self.inputs, untuned.reference)?;
        // The balance of energy goes on without a jump.
        let before = before.output(&old, &self.inputs, Output::Drift);
        let after = retuned.output(&reduced, &self.inputs, Output::Drift);
        if let (Ok(before), Ok(after)) = (before, after) {
            let jump = after - before;
            // A trial state of model exchange may be so fast that its energy overflows.
            if jump.is_finite() {
                retuned.state.reference += jump;
            }
        }
        self.designs.keep(&tuned, &reduced);
        **motion = retuned;
        (self.reduced, self.parameter_values, self.untuned) =
            (Some(reduced), tuned, self.exchange.is_none().then_some(untuned));
        Ok(())
    }
}
