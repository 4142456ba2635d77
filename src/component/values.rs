//! Setting of several values together.
//!
//! In: references and values. Out: the component with all of these values, or with none. Must not know: the host.
use super::{Component, Refused};
use crate::variables::Reference;

impl Component {
    /// Largest number of Reals in one call of [`Self::set_reals`]. Reals of a mechanism are set together, because the
    /// value of an expression may depend on several of them. Reals of a hydraulic model are set one by one, because the
    /// check of a value may depend on the values before it.
    pub fn most_together(&self) -> usize {
        match self {
            Self::Mechanism(_) => usize::MAX,
            Self::Hydraulic(_) => 1,
        }
    }

    /// Sets Reals. After an error, no value has changed.
    ///
    /// # Errors
    /// The model rejects one of the values, or a value that is calculated from them.
    pub fn set_reals(&mut self, references: &[Reference], values: &[f64]) -> Result<(), Refused> {
        let all = || references.iter().zip(values);
        all().try_for_each(|(&reference, &value)| self.check_real(reference, value))?;
        self.check_together(references, values)?;
        all().try_for_each(|(&reference, &value)| self.take_real(reference, value))
    }
}
