//! Outputs of one state, read one after the other.
//!
//! In: a view of the state. Out: values, NaN where an output has none. It must not know references.
use crate::mechanism::loads::resolved::Loading;
use crate::mechanism::outputs::evaluator::{OutputError, evaluate};
use crate::mechanism::outputs::view::View;
use crate::mechanism::quantity::Output;
use std::mem::MaybeUninit;

/// Outputs of one state.
pub struct Outputs<'a> {
    view: View<'a, f64>,
    loading: &'a Loading,
}

impl<'a> Outputs<'a> {
    #[inline]
    pub(super) fn new(view: View<'a, f64>, loading: &'a Loading) -> Self {
        Self { view, loading }
    }

    /// Value of an output; NaN where it has none.
    #[inline]
    pub fn value(&mut self, output: &Output) -> f64 {
        if self.is_misplaced() { f64::NAN } else { number(value_of(&mut self.view, self.loading, output)) }
    }

    /// [`Self::value`] of as many outputs as there is memory for values, with the functions that they are derivatives
    /// of; whether each of them has one.
    // Not inlined, so that the loop has the registers for itself.
    #[inline(never)]
    pub fn fill(&mut self, (outputs, functions): (&[Output], &[usize]), values: &mut [MaybeUninit<f64>]) -> bool {
        if self.is_misplaced() {
            values.fill(MaybeUninit::new(f64::NAN));
            return values.is_empty();
        }
        self.view.find_functions(functions);
        let (mut sum, mut outputs) = (0.0, outputs.iter());
        for value in values {
            let Some(output) = outputs.next() else { break };
            let number = evaluate(&mut self.view, self.loading, output).unwrap_or_else(without_value);
            // 0 for a finite number, else NaN.
            let nothing = 0.0 * number;
            sum += nothing;
            value.write(number + nothing);
        }
        sum == 0.0
    }

    /// [`Self::value`] of several outputs.
    #[inline]
    pub fn values(&mut self, outputs: &[Output], mut give: impl FnMut(f64)) {
        if self.is_misplaced() {
            return outputs.iter().for_each(|_| give(f64::NAN));
        }
        for output in outputs {
            give(number(evaluate(&mut self.view, self.loading, output)));
        }
    }

    /// Whether the mechanism is not where its motion is prescribed to be.
    #[inline]
    fn is_misplaced(&self) -> bool {
        self.view.loads.undriven.is_some() && self.view.check_placed().is_err()
    }
}

/// The value of an output; NaN where it has none.
#[inline(always)]
fn number(value: Result<f64, OutputError>) -> f64 {
    match value {
        Ok(value) if value.is_finite() => value,
        Ok(_) => f64::NAN,
        Err(error) => without_value(error),
    }
}

/// NaN for an output without a value. The reason is dropped here, so that the other outputs need no code for it.
#[cold]
fn without_value(_reason: OutputError) -> f64 {
    f64::NAN
}

/// [`evaluate`] as a function of its own, for one output.
#[inline(never)]
pub(super) fn value_of(view: &mut View<f64>, loading: &Loading, output: &Output) -> Result<f64, OutputError> {
    evaluate(view, loading, output)
}
