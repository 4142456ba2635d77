//! Inputs: what the host sets between steps.
//!
//! In: values from the host. Out: sizes of loads, their derivatives, engaged locks. It must not know what they act on.
use super::input_polynomial::{Change, InputPolynomial};
use crate::codec::record::{Damaged, Record};
use crate::mechanism::reduced::Reduced;
use crate::numerics::bits::become_same;

/// Inputs of a mechanism.
#[derive(Clone, Debug, PartialEq)]
pub struct Inputs {
    /// Sizes of loads, then demanded accelerations of the drives, then the airspeed if there is air.
    pub reals: Vec<f64>,
    /// Whether each lock is engaged.
    pub locks: Vec<bool>,
    /// Time derivatives of the Reals.
    pub signal: InputPolynomial,
}

impl Inputs {
    /// Input derivatives for the next step; None if all inputs are constant.
    #[inline]
    pub fn change(&self, reduced: &Reduced) -> Option<Change<'_>> {
        let loading = reduced.loading();
        self.signal.change(loading.inputs.len(), loading.air.is_some())
    }

    /// All fields, written or read.
    ///
    /// # Errors
    /// A number is read that is not finite.
    pub fn record(&mut self, record: &mut Record) -> Result<(), Damaged> {
        record.length("inputs", self.reals.len())?;
        record.all_finite("input", &mut self.reals)?;
        self.signal.record(record)?;
        record.length("locks", self.locks.len())?;
        self.locks.iter_mut().try_for_each(|lock| record.flag("lock", lock))
    }

    /// Become the same as other inputs of the same mechanism, without allocation.
    #[inline]
    pub fn copy_from(&mut self, other: &Self) {
        become_same(&mut self.reals, &other.reals);
        self.copy_rest(other);
    }

    /// [`Self::copy_from`] without the values of the Reals.
    #[inline]
    pub fn copy_rest(&mut self, other: &Self) {
        for (own, other) in self.locks.iter_mut().zip(&other.locks) {
            if own != other {
                *own = *other;
            }
        }
        self.signal.copy_from(&other.signal);
    }
}
