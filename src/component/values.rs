//! Several values that are set together.
//!
//! In: references and values. Out: the component with all of these values, or with none. It must not know the host.
use super::{Component, Refused};
use crate::variables::Reference;

impl Component {
    /// Most Reals that are set in one call of [`Self::set_reals`]. Those of a mechanism are set together, as a number
    /// by an expression may follow from several. Those of a hydraulic model are set one after the other, as the check
    /// of a value may depend on a value before it.
    pub fn most_together(&self) -> usize {
        match self {
            Self::Mechanism(_) => usize::MAX,
            Self::Hydraulic(_) => 1,
        }
    }

    /// Set Reals, all or none.
    ///
    /// # Errors
    /// The model refuses one of them, or what follows from them.
    pub fn set_reals(&mut self, references: &[Reference], values: &[f64]) -> Result<(), Refused> {
        let all = || references.iter().zip(values);
        all().try_for_each(|(&reference, &value)| self.check_real(reference, value))?;
        self.check_together(references, values)?;
        all().try_for_each(|(&reference, &value)| self.take_real(reference, value))
    }
}
