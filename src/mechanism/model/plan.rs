//! The array of outputs that a host reads again and again, resolved once.
//!
//! In: value references. Out: their outputs, found by comparing the references. It must not know how a value is found.
use crate::mechanism::quantity::{Output, Quantity};
use crate::variables::{Reference, Variables};

/// Value references of outputs that were read together, and the outputs.
#[derive(Clone, Debug, Default)]
pub(super) struct Plan {
    references: Vec<Reference>,
    outputs: Vec<Output>,
}

impl Plan {
    /// Fewest outputs that are worth it.
    const FEWEST: usize = 4;

    /// The outputs of these references, if they are those that were resolved.
    #[inline]
    pub fn of(&self, references: &[Reference]) -> Option<&[Output]> {
        (self.references == references).then_some(&self.outputs)
    }

    /// Make room for so many outputs.
    pub fn reserve(&mut self, count: usize) {
        self.references.reserve(count);
        self.outputs.reserve(count);
    }

    /// Resolve references that were read, if all are outputs. The longest array is kept, so that shorter ones that are
    /// read in turn with it do not replace it.
    #[inline]
    pub fn learn(&mut self, references: &[Reference], variables: &Variables<Quantity>) {
        if references.len() >= Self::FEWEST && references.len() > self.references.len() {
            self.resolve(references, variables);
        }
    }

    #[cold]
    fn resolve(&mut self, references: &[Reference], variables: &Variables<Quantity>) {
        let output = |reference: &Reference| variables.quantity_of(*reference).and_then(Quantity::output);
        if references.iter().all(|reference| output(reference).is_some()) {
            self.references.clear();
            self.references.extend_from_slice(references);
            self.outputs.clear();
            self.outputs.extend(references.iter().filter_map(output));
        }
    }
}
