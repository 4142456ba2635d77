//! The array of outputs that a host reads again and again, resolved once.
//!
//! In: value references. Out: their outputs, found by comparing the references. It must not know how a value is found.
use crate::mechanism::outputs::Together;
use crate::mechanism::quantity::Quantity;
use crate::mechanism::reduced::Reduced;
use crate::variables::{Reference, Variables};

/// Value references of outputs that were read together, and the outputs.
#[derive(Clone, Debug, Default)]
pub(super) struct Plan {
    references: Vec<Reference>,
    together: Together,
}

impl Plan {
    /// Fewest outputs that are worth it.
    const FEWEST: usize = 4;

    /// The outputs of these references, if they are those that were resolved.
    #[inline]
    pub fn of(&self, references: &[Reference]) -> Option<&Together> {
        (self.references == references).then_some(&self.together)
    }

    /// Make room for so many outputs in all.
    pub fn reserve(&mut self, count: usize) {
        self.references.reserve_exact(count.saturating_sub(self.references.len()));
        self.together.reserve(count);
    }

    /// Resolve references that were read, if all are outputs and there is room. The longest array is kept, so that
    /// shorter ones that are read in turn with it do not replace it.
    #[inline]
    pub fn learn(&mut self, references: &[Reference], variables: &Variables<Quantity>, reduced: &Reduced) {
        let has_room = references.len() <= self.references.capacity().min(self.together.capacity());
        if has_room && references.len() >= Self::FEWEST && references.len() > self.references.len() {
            self.resolve(references, variables, reduced);
        }
    }

    #[cold]
    fn resolve(&mut self, references: &[Reference], variables: &Variables<Quantity>, reduced: &Reduced) {
        let output = |reference: &Reference| variables.quantity_of(*reference).and_then(Quantity::output);
        if references.iter().all(|reference| output(reference).is_some()) {
            self.references.clear();
            self.references.extend_from_slice(references);
            self.together.replace(references.iter().filter_map(output), reduced);
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use crate::mechanism::quantity::Quantity;
    use crate::mechanism::{GEAR, Model};

    /// The room is made in the initialisation, so that the first get of all outputs can be kept.
    #[test]
    fn the_first_get_of_all_outputs_is_kept() {
        let mut model = Model::from_json(GEAR).unwrap();
        model.initialize().unwrap();
        let variables = &model.original.variables;
        let is_output = |r: &u32| variables.quantity_of(*r).and_then(Quantity::output).is_some();
        let outputs: Vec<u32> = (0..variables.list().len() as u32).filter(is_output).collect();
        model.reals(&outputs, |_| {}).unwrap();
        assert!(outputs.len() > 50 && model.plan.of(&outputs).is_some());
    }
}
