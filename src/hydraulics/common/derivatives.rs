//! Derivatives as a host asks for them: of outputs by inputs, of outputs in time, and those of inputs that it sets.
//!
//! In: references, orders, seeds. Out: derivatives by the outputs' laws with dual numbers, or a refusal by name. It
//! must not know any law.
use super::{HostInputs, Kind, Model, Quantity};
use crate::error::HydraulicsError;
use foundation::variables::{self, Causality, Reference, Variability};

/// Order of the derivatives of outputs in time.
pub const OUTPUT_ORDER: i32 = 1;
/// Largest order of the derivatives of inputs in time: that of the speed; 2 of the others.
pub const INPUT_ORDER: i32 = 4;

/// A kind of model whose outputs have derivatives.
pub trait Differentiable: Kind {
    /// A direction in which the inputs change, by their indices, 0 at first.
    type Along: AsMut<[f64]>;

    /// Largest order of the derivatives in time of an input.
    fn order(laws: &Self::Laws, input: usize) -> usize;
    /// A derivative of an input is set.
    fn rate_set(model: &mut Model<Self>, input: usize);
    /// No direction.
    fn along(laws: &Self::Laws) -> Self::Along;
    /// Call `report` with each output's derivative along a direction, for a model that has a state.
    fn derivatives(
        model: &mut Model<Self>,
        along: &Self::Along,
        outputs: &mut dyn Iterator<Item = (usize, Self::Output)>,
        report: &mut dyn FnMut(usize, f64),
    ) -> Result<(), HydraulicsError>;
    /// Rate of an output in time, for a model that has a state.
    fn rate(model: &mut Model<Self>, output: Self::Output) -> Result<f64, HydraulicsError>;
    /// Whether an output is the acceleration at one instant of the next step, which has no rate.
    fn is_instant(output: Self::Output) -> bool;
}

impl<K: Differentiable> Model<K> {
    /// Directional derivatives of outputs at the present state: for each unknown the sum over the knowns of dy / du
    /// times the seed. `report` is called once for each unknown, with its index; with NaN for one that has no
    /// derivative in this state, for which [`Self::undefined_derivative`] has the reason.
    ///
    /// # Errors
    /// An unknown that is no continuous output, a known that is no continuous input, a seed that is not finite.
    pub fn directional_derivative(
        &mut self,
        unknowns: &[Reference],
        knowns: &[Reference],
        seeds: &[f64],
        report: &mut dyn FnMut(usize, f64),
    ) -> Result<(), HydraulicsError> {
        for &known in knowns {
            self.continuous(
                known,
                Causality::Input,
                "a known (the variable to differentiate by) must be a continuous input",
            )?;
        }
        for &unknown in unknowns {
            self.continuous(
                unknown,
                Causality::Output,
                "an unknown (the variable to differentiate) must be a continuous output",
            )?;
        }
        let mut along = K::along(&self.parameters.laws);
        for (known, seed) in knowns.iter().zip(seeds) {
            if !seed.is_finite() {
                let name = self.name_of(*known);
                return Err(HydraulicsError::Value {
                    name,
                    value: *seed,
                    allowed: "finite, because this value is the seed of a directional derivative".into(),
                });
            }
            // Inputs come first: the reference of an input is its index.
            along.as_mut()[*known as usize] += seed;
        }
        self.started()?;
        let original = self.original.clone();
        let mut outputs = unknowns.iter().enumerate().filter_map(|(index, &unknown)| {
            let Some(Quantity::Output(output)) = original.variables.quantity(unknown) else { return None };
            Some((index, output))
        });
        K::derivatives(self, &along, &mut outputs, &mut |index, derivative| {
            report(index, if derivative.is_finite() { derivative } else { f64::NAN });
        })
    }

    /// Rate of a continuous output in time, under inputs that change at the rates set by
    /// [`Self::set_input_derivative`], and under the speed and the acceleration of the inputs; where the latter is 0
    /// and a reduced mass is told, under the acceleration of this mass. Outputs of the foreseen motion belong to the
    /// next step: the rate of `preview.force` is that of the line, `preview.force_mean` and `preview.force_rate` are
    /// constant, `preview.length` and `preview.speed` have the speed and the acceleration at the end of the step; the
    /// accelerations have no rate.
    ///
    /// # Errors
    /// No continuous output has this reference, or another order than 1.
    pub fn output_derivative(&mut self, reference: Reference, order: i32) -> Result<f64, HydraulicsError> {
        self.continuous(reference, Causality::Output, "derivatives are available for continuous outputs only")?;
        if order != OUTPUT_ORDER {
            let what = format!("time derivative of order {order} of {}", self.name_of(reference));
            let reason = "only order 1 is available (maxOutputDerivativeOrder is 1)".into();
            return Err(HydraulicsError::Derivative { what, reason });
        }
        self.started()?;
        let Some(Quantity::Output(output)) = self.original.variables.quantity(reference) else {
            return Ok(f64::NAN);
        };
        let rate = K::rate(self, output)?;
        Ok(if rate.is_finite() { rate } else { f64::NAN })
    }

    /// Why an output has no derivative where the last call gave NaN.
    #[cold]
    pub fn undefined_derivative(&mut self, reference: Reference) -> Option<String> {
        let Quantity::Output(output) = self.original.variables.quantity(reference)? else { return None };
        Some(match K::is_instant(output) {
            true => "the acceleration at one instant of the next step has no time derivative".to_owned(),
            false => {
                "the derivative exceeds the largest number, 1.8e308: check the inputs and the parameters".to_owned()
            }
        })
    }

    /// Whether [`Self::set_input_derivative`] would accept this; changes nothing.
    ///
    /// # Errors
    /// No continuous input has this reference, the order is not one of those that count, the value is not finite.
    pub fn check_input_derivative(&self, reference: Reference, order: i32, value: f64) -> Result<(), HydraulicsError> {
        self.continuous(reference, Causality::Input, "derivatives can be set for continuous inputs only")?;
        let most = K::order(&self.parameters.laws, reference as usize);
        if !(1..=most as i32).contains(&order) {
            let what = format!("time derivative of order {order} of {}", self.name_of(reference));
            let reason = format!("only the orders 1 to {most} can be set");
            return Err(HydraulicsError::Derivative { what, reason });
        }
        if !value.is_finite() {
            let name = format!("time derivative of order {order} of {}", self.name_of(reference));
            return Err(HydraulicsError::Value { name, value, allowed: "finite".into() });
        }
        Ok(())
    }

    /// Set a derivative of an input in time at the beginning of the next step; it holds for one step. Those of lengths
    /// are not used: within a step a length is its value at the beginning plus the integral of the speed.
    ///
    /// # Errors
    /// As [`Self::check_input_derivative`].
    pub fn set_input_derivative(
        &mut self,
        reference: Reference,
        order: i32,
        value: f64,
    ) -> Result<(), HydraulicsError> {
        self.check_input_derivative(reference, order, value)?;
        self.inputs.set_rate(reference as usize, order as usize, value);
        K::rate_set(self, reference as usize);
        Ok(())
    }

    /// Refuse a variable that is not a continuous Real of this causality.
    fn continuous(&self, reference: Reference, causality: Causality, rule: &str) -> Result<(), HydraulicsError> {
        let is_real = |v: &variables::Variable| v.kind == variables::Kind::Real;
        match self.original.variables.get(reference) {
            Some(v) if v.causality == causality && is_real(v) && v.variability == Variability::Continuous => Ok(()),
            Some(v) => {
                let what = format!("{} (value reference {reference})", v.name);
                Err(HydraulicsError::Derivative { what, reason: rule.into() })
            }
            None => Err(self.no_such(reference, "Real")),
        }
    }
}
