//! Why an output or a derivative has no value in a legal state.
//!
//! In: a reference. Out: the reason in the host's words, None if there is a value. It must not know any law.
use super::{Formulation, Model};
use crate::mechanism::outputs::OutputError;
use crate::mechanism::quantity::{Output, Quantity};
use crate::variables::Reference;

/// Size of an input [SI] beyond which what it is multiplied with may overflow.
const HUGE: f64 = 1e100;

impl Model {
    /// Why an output has no value in the present state under the present inputs; None if it has one, for what is no
    /// Real output, and for `energy.drift` in model exchange but the first time. Costs as much as the output.
    #[cold]
    pub fn undefined(&mut self, reference: Reference) -> Option<String> {
        if let Some(Quantity::State(_) | Quantity::Indicator(_)) = self.original.variables.quantity(reference) {
            return self.undefined_exchange(reference);
        }
        let output = self.real_output(reference)?;
        if self.exchange.is_some() && output == Output::Drift {
            // In no state is there one: a line at each read would say nothing new.
            let is_new = !std::mem::replace(&mut self.lacks_drift, true);
            return is_new.then(|| {
                "model exchange does not record the work done since the start, so the output is NaN during the whole \
                    run; this warning appears once"
                    .into()
            });
        }
        let (state, reduced) = (self.state.as_mut()?, self.reduced.as_ref()?);
        let value = match state {
            Formulation::Reduced(motion) => motion.output(reduced, &self.inputs, output),
            Formulation::RigidFem(motion) => motion.output(reduced, &self.inputs, output),
        };
        self.reason_of(output, value)
    }

    /// Why an output has no derivative in the direction of the last call of [`Self::directional_derivative`] or
    /// [`Self::output_derivative`]; None if it has one.
    #[cold]
    pub fn undefined_derivative(&mut self, reference: Reference) -> Option<String> {
        let output = self.real_output(reference)?;
        let Some(Formulation::Reduced(motion)) = &mut self.state else { return None };
        let derivative = motion.derivative(self.reduced.as_ref()?, &self.inputs, output);
        self.reason_of(output, derivative)
    }

    /// Why the mechanism cannot set off from its start under the present inputs, if friction locks it there.
    #[cold]
    pub fn start_warning(&mut self) -> Option<String> {
        let (state, reduced) = (self.state.as_mut()?, self.reduced.as_ref()?);
        reduced.loading().friction.as_ref().filter(|friction| friction.acting().next().is_some())?;
        let linkage = reduced.linkage();
        let output = match linkage.bodies.iter().position(|body| body.angle_coordinate.is_some()) {
            Some(body) => Output::Angle { body, order: 2 },
            None => Output::JointPosition { coordinate: linkage.angles, order: 2 },
        };
        let Formulation::Reduced(motion) = state else { return None };
        match motion.output(reduced, &self.inputs, output) {
            Err(error @ (OutputError::Locked | OutputError::SelfLocking(_))) => {
                self.reason(Err(error)).map(|reason| format!("at the start, {reason}"))
            }
            _ => None,
        }
    }

    fn real_output(&self, reference: Reference) -> Option<Output> {
        match self.original.variables.quantity(reference) {
            Some(Quantity::Output(output)) => Some(output),
            _ => None,
        }
    }

    /// Why this is no value of an output.
    fn reason_of(&self, output: Output, value: Result<f64, OutputError>) -> Option<String> {
        let reason = self.reason(value)?;
        let (state, reduced) = (self.state.as_ref()?.along_curve(), self.reduced.as_ref()?);
        match output {
            Output::OneElement { drive, .. } if reduced.loading().loads[drive].is_idle() => {
                let (s, size) = (state.displacement(reduced, drive), reduced.linkage().size);
                let (words, _) = reduced.loading().loads[drive].idle_words(s, size);
                Some(format!("{words}, so the drive cannot move the mechanism"))
            }
            _ => Some(reason),
        }
    }

    /// Why this is no value.
    pub(super) fn reason(&self, value: Result<f64, OutputError>) -> Option<String> {
        let (state, reduced) = (self.state.as_ref()?.along_curve(), self.reduced.as_ref()?);
        Some(match value {
            Ok(value) if value.is_finite() => return None,
            Ok(value) if value.is_nan() && !self.inputs.reals.iter().any(|input| input.abs() > HUGE) => {
                format!(
                    "the value of the output is indeterminate at {}, because this position is a dead centre, or two \
                     motions are possible from this position",
                    state.describe(reduced)
                )
            }
            Ok(_) => {
                "the value of the output is larger than the largest number with the present inputs and parameters: \
                 check the values of inputs and parameters"
                    .into()
            }
            Err(OutputError::Table(at)) => {
                format!(
                    "near {}, the output is not a smooth function of the position of the mechanism",
                    reduced.curve().describe(at.sigma, state.revolutions)
                )
            }
            Err(OutputError::Locked) => format!(
                "friction locks the mechanism near {} under the present inputs, mainly in {}: the joint forces cause \
                 more friction than any load can overcome; reduce the coefficients or pin radii, or add a stop \
                 before this position",
                state.describe(reduced),
                reduced.locking_joint(state.sigma)
            ),
            Err(OutputError::SelfLocking(drive)) => format!(
                "friction locks the mechanism against the drive {} near {}: however large the force of this drive \
                 is, the friction that the force causes is larger",
                reduced.loading().drives[drive].name,
                state.describe(reduced)
            ),
            Err(OutputError::Unstable) => format!(
                "the loads do not return the mechanism to {}: small motions about this position are not oscillations",
                state.describe(reduced)
            ),
            Err(OutputError::Dead(drive)) => format!(
                "the drive {} is at a dead centre near {}, where no force of this drive can produce the prescribed \
                 motion",
                reduced.loading().drives[drive].name,
                state.describe(reduced)
            ),
            Err(OutputError::Motion(text)) => text,
            Err(OutputError::RigidFem(error)) => format!("solver.method = \"rigid_fem\": {error}"),
        })
    }
}
