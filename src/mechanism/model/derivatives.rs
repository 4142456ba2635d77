//! Derivatives as a host asks for them: of outputs by inputs, of outputs in time, and those of inputs that it sets.
//!
//! In: references, orders, seeds. Out: derivatives by the outputs' sensitivity, or a refusal by name. It must not know
//! any law.
use super::{Formulation, Model, ModelError};
use crate::mechanism::definition::{MOST_STATES, Method};
use crate::mechanism::quantity::Quantity;
use crate::variables::{Causality, Kind, Reference};

/// Order of the derivatives of outputs in time.
pub const OUTPUT_ORDER: i32 = 1;
/// Largest order of the derivatives of inputs in time.
pub const INPUT_ORDER: i32 = 2;

impl Model {
    /// Directional derivatives of outputs at the present state: for each unknown the sum over the knowns of dy / du
    /// times the seed. `report` is called once for each unknown, with its index; with NaN for one that has no
    /// derivative in this state, of which [`Self::undefined_derivative`] tells why.
    ///
    /// # Errors
    /// An unknown that is no continuous output, a known that is no continuous input, `solver.method` = "`rigid_fem`".
    pub fn directional_derivative(
        &mut self,
        unknowns: &[Reference],
        knowns: &[Reference],
        seeds: &[f64],
        report: &mut dyn FnMut(usize, f64),
    ) -> Result<(), ModelError> {
        for &known in knowns {
            if self.known_state(known).is_none() {
                self.continuous(
                    known,
                    Causality::Input,
                    "a known (the variable to differentiate by) must be a continuous input",
                )?;
            }
        }
        for &unknown in unknowns {
            if self.unknown_rate(unknown).is_none() {
                self.continuous(
                    unknown,
                    Causality::Output,
                    "an unknown (the variable to differentiate) must be a continuous output",
                )?;
            }
        }
        if let Some((seed, known)) = seeds.iter().zip(knowns).find(|(seed, _)| !seed.is_finite()) {
            let name = self.name_of(*known);
            return Err(ModelError::Value {
                name,
                value: *seed,
                allowed: "finite, because this value is the seed of a derivative".into(),
            });
        }
        self.reducible("providesDirectionalDerivative")?;
        // The reference of an input is its index: inputs come first.
        let sum = |input: usize| -> f64 {
            knowns.iter().zip(seeds).filter(|(known, _)| **known as usize == input).map(|(_, seed)| seed).sum()
        };
        let mut along = [0.0; MOST_STATES];
        for (&known, seed) in knowns.iter().zip(seeds) {
            if let Some(order) = self.known_state(known) {
                along[order] += seed;
            }
        }
        if let (Some(Formulation::Reduced(motion)), Some(reduced)) = (&mut self.state, &self.reduced) {
            motion.head_for(reduced, &self.inputs, along, &sum);
        }
        let changes_state = along != [0.0; MOST_STATES];
        let is_exchanged = self.exchange.is_some() && self.is_prescribed();
        for (index, &unknown) in unknowns.iter().enumerate() {
            if is_exchanged && self.unknown_rate(unknown) == Some(0) {
                // The rate of the state x is the state v.
                report(index, along[1]);
                continue;
            }
            let dependencies = &self.original.variables.list()[unknown as usize].dependencies;
            let depends = changes_state || knowns.iter().any(|known| dependencies.contains(known));
            report(index, if depends { self.derivative(unknown)? } else { 0.0 });
        }
        Ok(())
    }

    /// Rate of a continuous output in time, under inputs that change at the rates set by
    /// [`Self::set_input_derivative`]. NaN for an output that has no rate in this state, of which
    /// [`Self::undefined_derivative`] tells why.
    ///
    /// # Errors
    /// No continuous output has this reference, another order than 1, `solver.method` = "`rigid_fem`".
    pub fn output_derivative(&mut self, reference: Reference, order: i32) -> Result<f64, ModelError> {
        self.continuous(reference, Causality::Output, "derivatives are available for continuous outputs only")?;
        if order != OUTPUT_ORDER {
            let what = format!("time derivative of order {order} of {}", self.name_of(reference));
            return Err(ModelError::Derivative {
                what,
                reason: "only order 1 is available (maxOutputDerivativeOrder is 1)".into(),
            });
        }
        self.reducible("maxOutputDerivativeOrder")?;
        let Self { state: Some(Formulation::Reduced(motion)), reduced: Some(reduced), inputs, .. } = self else {
            return Err(ModelError::NotInitialised);
        };
        motion.head_for_time(reduced, inputs);
        self.derivative(reference)
    }

    /// Whether [`Self::set_input_derivative`] would accept this; changes nothing.
    ///
    /// # Errors
    /// No continuous input has this reference, the order is not 1 or 2, the value is not finite, `solver.method` =
    /// "`rigid_fem`".
    pub fn check_input_derivative(&self, reference: Reference, order: i32, value: f64) -> Result<(), ModelError> {
        self.continuous(reference, Causality::Input, "derivatives can be set for continuous inputs only")?;
        if !(1..=INPUT_ORDER).contains(&order) {
            let what = format!("time derivative of order {order} of {}", self.name_of(reference));
            return Err(ModelError::Derivative { what, reason: "only the orders 1 and 2 can be set".into() });
        }
        if !value.is_finite() {
            let name = format!("time derivative of order {order} of {}", self.name_of(reference));
            return Err(ModelError::Value { name, value, allowed: "finite".into() });
        }
        let first = self.original.reduced.loading().motion.as_ref().and_then(|drive| drive.first_input);
        if let (Some(first), Some(Quantity::Input(input))) = (first, self.original.variables.quantity(reference))
            && (first..first + 2).contains(&input)
        {
            let what = format!("the derivative of {}", self.name_of(reference));
            let next = self.name_of(reference + 1);
            return Err(ModelError::Derivative {
                what,
                reason: format!(
                    "this derivative is an input, so it cannot be \
                set as a derivative; set the input {next}"
                ),
            });
        }
        self.not_rigid_fem("canInterpolateInputs")
    }

    /// Set a derivative of an input in time at the beginning of the next step; it holds for one step.
    ///
    /// # Errors
    /// As [`Self::check_input_derivative`].
    pub fn set_input_derivative(&mut self, reference: Reference, order: i32, value: f64) -> Result<(), ModelError> {
        self.check_input_derivative(reference, order, value)?;
        if let Some(Quantity::Input(i)) = self.original.variables.quantity(reference) {
            self.inputs.signal.set(i, if order == 1 { 1 } else { 2 }, value);
        }
        Ok(())
    }

    /// Refuse a step at the end of which an input is not finite.
    ///
    /// # Errors
    /// [`ModelError::Value`].
    pub(super) fn check_inputs_at(&self, h: f64) -> Result<(), ModelError> {
        for (i, value) in self.inputs.reals.iter().enumerate() {
            let end = self.inputs.signal.at(i, *value, h);
            if !end.is_finite() {
                let name = format!("{} at the end of the step", self.name_of(i as Reference));
                return Err(ModelError::Value { name, value: end, allowed: "finite".into() });
            }
        }
        Ok(())
    }

    /// Derivative of an output in the direction last headed for; NaN if it has none.
    fn derivative(&mut self, reference: Reference) -> Result<f64, ModelError> {
        let output = match self.original.variables.quantity(reference) {
            Some(Quantity::Output(output)) => output,
            Some(Quantity::State(order @ 1..=2)) => return self.derivative_of_motion(order - 1),
            _ => return Err(self.no_such(reference, "Real")),
        };
        let Self { state: Some(Formulation::Reduced(motion)), reduced: Some(reduced), inputs, .. } = self else {
            return Err(ModelError::NotInitialised);
        };
        let derivative = motion.derivative(reduced, inputs, output);
        Ok(derivative.ok().filter(|derivative| derivative.is_finite()).unwrap_or(f64::NAN))
    }

    /// Derivative of sigma_dot (0) or sigma_ddot (1) in the direction last headed for; NaN if it has none.
    fn derivative_of_motion(&mut self, index: usize) -> Result<f64, ModelError> {
        let Self { state: Some(Formulation::Reduced(motion)), reduced: Some(reduced), inputs, .. } = self else {
            return Err(ModelError::NotInitialised);
        };
        let derivatives = motion.derivatives_of_motion(reduced, inputs);
        Ok(derivatives.map(|of| of[index]).ok().filter(|derivative| derivative.is_finite()).unwrap_or(f64::NAN))
    }

    /// Refuse a variable that is not a Real of this causality.
    fn continuous(&self, reference: Reference, causality: Causality, rule: &str) -> Result<(), ModelError> {
        match self.original.variables.get(reference) {
            Some(v) if v.causality == causality && v.kind == Kind::Real => Ok(()),
            Some(v) => {
                let what = format!("{} (value reference {reference})", v.name);
                Err(ModelError::Derivative { what, reason: rule.into() })
            }
            None => Err(self.no_such(reference, "Real")),
        }
    }

    /// Refuse the finite elements, and put the mechanism at its start if it has no state yet.
    #[inline]
    fn reducible(&mut self, capability: &str) -> Result<(), ModelError> {
        self.not_rigid_fem(capability)?;
        self.state().map(|_| ())
    }

    fn not_rigid_fem(&self, capability: &str) -> Result<(), ModelError> {
        let rigid_fem = match &self.state {
            Some(state) => matches!(state, Formulation::RigidFem(_)),
            None => self.parameter_values.method() == Method::RigidFem,
        };
        if rigid_fem {
            let reason = "solver.method = \"rigid_fem\" does not support derivatives; choose solver.method = \
                          \"reduced\""
                .into();
            return Err(ModelError::Derivative { what: capability.into(), reason });
        }
        Ok(())
    }
}
