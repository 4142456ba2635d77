//! Inputs that a host sets, with their derivatives in time.
//!
//! In: values and derivatives from the host. Out: the same, ready for a step, and their record. It must not know what
//! they act on.
use foundation::codec::record::{Damaged, Record};
use std::fmt::Debug;

/// Largest order of the derivatives of the speed.
pub const SPEED_ORDER: usize = 4;

/// Derivatives of an input of the orders 1 to 4.
type Rates = [f64; SPEED_ORDER];

/// Values and time derivatives of inputs. FMI 2.0.5, 4.2.1: derivatives are set with respect to the beginning of a
/// communication step. They hold for one step, at the end of which the inputs keep their values there; the derivatives
/// at the end are kept for the derivatives of outputs, until the input is set.
pub trait HostInputs: Clone + Debug + Send + Sync {
    /// Constant inputs.
    fn constant(values: &[f64]) -> Self;
    /// Values, derivatives, and whether the derivatives apply to the next step.
    fn parts(&self) -> (&[f64], &[Rates], bool);
    /// [`Self::parts`], to change them.
    fn parts_mut(&mut self) -> (&mut [f64], &mut [Rates], &mut bool);

    /// Present values.
    #[inline]
    fn values(&self) -> &[f64] {
        self.parts().0
    }

    /// Set a value.
    fn set(&mut self, input: usize, value: f64) {
        let (values, rates, ahead) = self.parts_mut();
        values[input] = value;
        if !*ahead {
            rates[input] = [0.0; SPEED_ORDER];
        }
    }

    /// Set a derivative for the next step.
    fn set_rate(&mut self, input: usize, order: usize, value: f64) {
        let (_, rates, ahead) = self.parts_mut();
        if !*ahead {
            rates.fill([0.0; SPEED_ORDER]);
            *ahead = true;
        }
        rates[input][order - 1] = value;
    }

    /// Become the same as others of this model, without allocation.
    fn copy_from(&mut self, other: &Self) {
        let ((values, rates, ahead), other) = (self.parts_mut(), other.parts());
        values.copy_from_slice(other.0);
        rates.copy_from_slice(other.1);
        *ahead = other.2;
    }

    /// All fields, written or read.
    fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        let (values, rates, ahead) = self.parts_mut();
        record.length("inputs", values.len())?;
        record.all_finite("input", values)?;
        rates.iter_mut().try_for_each(|rates| record.all_finite("derivative of an input", rates))?;
        record.flag("time derivatives of the inputs in the next step", ahead)
    }
}
