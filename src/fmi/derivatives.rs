//! Directional derivatives and time derivatives of the variables of an instance.
//!
//! In: value references, seeds, orders. Out: derivatives, or a refusal that leaves the instance unchanged. Must not
//! know: pointers to instances, how a derivative is found.

use super::access::of_kind;
use super::instance::Instance;
use super::phase::Phase;
use super::refusal::Refusal;
use crate::component::Component;
use crate::numerics::decimal::Decimal;
use crate::variables::{Kind, Reference};
use std::mem::MaybeUninit;

/// Reason why a directional derivative is NaN. In such a state, the time derivative may still be a number.
fn why_undefined(component: &mut Component, unknown: Reference) -> Option<String> {
    let reason = component.undefined_derivative(unknown);
    reason.or_else(|| Some("the partial derivative is not finite in this state".to_owned()))
}

impl Instance {
    /// Rejects references without a variable. For a variable without derivatives, the component returns the error.
    #[inline]
    fn must_exist<'a>(&self, mut references: impl Iterator<Item = &'a Reference>) -> Result<(), Refusal> {
        let interface = self.component.interface();
        let missing = references.find(|&&reference| interface.get(reference).is_none());
        missing.map_or(Ok(()), |&reference| of_kind(self, reference, Kind::Real).map(drop))
    }

    /// For each unknown, the sum over the knowns of partial derivative times seed. An unknown whose derivative does not
    /// exist in this state gets NaN, with a warning.
    pub fn directional_derivative(
        &mut self,
        unknowns: &[Reference],
        knowns: &[Reference],
        seeds: &[f64],
        values: &mut [MaybeUninit<f64>],
    ) -> Result<(), Refusal> {
        self.must_exist(unknowns.iter().chain(knowns))?;
        let mut undefined = Vec::new();
        let mut report = |index: usize, value: f64| {
            values[index].write(value);
            if value.is_nan() {
                undefined.push(unknowns[index]);
            }
        };
        let is_initial = self.phase == Phase::Initialization;
        self.component.directional_derivative(is_initial, unknowns, knowns, seeds, &mut report)?;
        match undefined[..] {
            [] => Ok(()),
            _ => self.warn(&undefined, "derivative", why_undefined),
        }
    }

    /// For each known, the sum over the unknowns of seed times partial derivative. The result is NaN, with a warning,
    /// if a partial derivative does not exist in this state or if the sum overflows. Every seed must be finite.
    pub fn adjoint_derivative(
        &mut self,
        unknowns: &[Reference],
        knowns: &[Reference],
        seeds: &[f64],
        values: &mut [MaybeUninit<f64>],
    ) -> Result<(), Refusal> {
        self.must_exist(unknowns.iter().chain(knowns))?;
        if let Some((seed, unknown)) = seeds.iter().zip(unknowns).find(|(seed, _)| !seed.is_finite()) {
            let name = self.described(*unknown).map_or("", |(name, _)| name);
            return Err(Refusal::error(format!("seed of {name} = {}: must be finite", Decimal(*seed))));
        }
        let (mut undefined, mut overflow) = (Vec::new(), None);
        for (known, value) in knowns.iter().zip(values) {
            let mut sum = 0.0_f64;
            let mut add = |index: usize, derivative: f64| {
                sum += seeds[index] * derivative;
                if derivative.is_nan() && !undefined.contains(&unknowns[index]) {
                    undefined.push(unknowns[index]);
                }
            };
            let (is_initial, known_alone) = (self.phase == Phase::Initialization, std::slice::from_ref(known));
            self.component.directional_derivative(is_initial, unknowns, known_alone, &[1.0], &mut add)?;
            overflow = overflow.or_else(|| (!sum.is_finite()).then_some(*known));
            value.write(if sum.is_finite() { sum } else { f64::NAN });
        }
        match undefined[..] {
            [] => overflow.map_or(Ok(()), |known| {
                let name = self.described(known).map_or("", |(name, _)| name);
                Err(Refusal::warning(format!(
                    "the adjoint derivative with respect to {name} is larger than the largest number, so the result \
                     is NaN; pass smaller seeds"
                )))
            }),
            _ => self.warn(&undefined, "derivative", why_undefined),
        }
    }

    /// Time derivatives of outputs, each of its order. A derivative that does not exist in this state is NaN, with a
    /// warning. After an error, the array may be partly filled.
    pub fn output_derivatives(
        &mut self,
        references: &[Reference],
        orders: &[i32],
        values: &mut [MaybeUninit<f64>],
    ) -> Result<(), Refusal> {
        self.must_exist(references.iter())?;
        let mut undefined = false;
        for ((&reference, &order), value) in references.iter().zip(orders).zip(values) {
            let rate = self.component.output_derivative(reference, order)?;
            undefined |= rate.is_nan();
            value.write(rate);
        }
        if undefined { self.warn(references, "derivative", Component::undefined_derivative) } else { Ok(()) }
    }

    /// Sets time derivatives of inputs, each of its order. After an error, no derivative has changed.
    pub fn set_input_derivatives(
        &mut self,
        references: &[Reference],
        orders: &[i32],
        values: &[f64],
    ) -> Result<(), Refusal> {
        self.must_exist(references.iter())?;
        if self.usage.model_exchange {
            return Err(Refusal::error(
                "derivatives of inputs are available in co-simulation only; in model exchange set the input values \
                 at each time",
            ));
        }
        for ((&reference, &order), &value) in references.iter().zip(orders).zip(values) {
            self.component.check_input_derivative(reference, order, value)?;
        }
        for ((&reference, &order), &value) in references.iter().zip(orders).zip(values) {
            self.component.set_input_derivative(reference, order, value)?;
        }
        Ok(())
    }
}
