//! Designs: what follows from a set of parameters alone, kept for the sets that were present last.
//!
//! In: a set of parameters. Out: its reduced model and its start: found by the values, or made with as much of the kept
//! ones as does not change. What is kept equals what would be made anew, to the bit. It must not know inputs or time.
use super::definition::{Range, Role};
use super::error::ModelError;
use super::motion::state::Start;
use super::parameters::ParameterValues;
use super::reduced::{Reduced, ReductionError};
use std::sync::Arc;

/// Most designs that are kept besides the definition as read.
const KEPT: usize = 4;

/// Parameters with what follows from them.
#[derive(Clone, Debug)]
struct Design {
    values: Arc<ParameterValues>,
    reduced: Arc<Reduced>,
    /// The start, once it was needed.
    start: Option<Arc<Start>>,
}

/// The definition as read and the designs used last, each of these with a reduced model of its own.
#[derive(Clone, Debug)]
pub struct Designs {
    original: Design,
    /// The last one first.
    recent: Vec<Design>,
}

/// Range and role of each numeric parameter.
type Ranges = [(Range, Role)];

/// Whether parameters with this role decide a reduced model. `is_part`: whether the start decides which part of the
/// curve it is on.
pub fn decides_reduced(role: Role, is_part: bool) -> bool {
    match role {
        Role::Geometry | Role::Inertia | Role::Load | Role::Law | Role::Scale | Role::Circuit => true,
        Role::StartPosition => is_part,
        Role::StartSpeed | Role::Elasticity | Role::Tolerance | Role::Step | Role::CircuitStart | Role::Named => false,
    }
}

/// Whether a set of parameters has the reduced model of another set.
#[inline]
pub fn shares_reduced(own: &ParameterValues, reduced: &Reduced, values: &ParameterValues, ranges: &Ranges) -> bool {
    std::ptr::eq(own, values) || agree(own, values, ranges, |role| decides_reduced(role, reduced.is_part()))
}

/// Whether two sets of parameters agree to the bit in all roles that count.
#[cold]
fn agree(a: &ParameterValues, b: &ParameterValues, ranges: &Ranges, counts: impl Fn(Role) -> bool) -> bool {
    let mut both = ranges.iter().zip(a.parameters.iter().zip(&b.parameters));
    a.flags == b.flags && both.all(|((_, role), (a, b))| a.to_bits() == b.to_bits() || !counts(*role))
}

impl Designs {
    /// The definition as read alone.
    pub fn new(values: Arc<ParameterValues>, reduced: Arc<Reduced>) -> Self {
        Self { original: Design { values, reduced, start: None }, recent: Vec::new() }
    }

    fn all(&self) -> impl Iterator<Item = &Design> {
        self.recent.iter().chain([&self.original])
    }

    /// Settle parameters: share a kept set of the same values, or write them into their mechanism.
    pub fn settle(&self, values: &mut Arc<ParameterValues>) {
        if !values.is_settled() {
            let known = self.all().map(|design| &design.values).find(|known| known.has_same_bits(values));
            match known {
                Some(known) => *values = Arc::clone(known),
                None => ParameterValues::settle(values),
            }
        }
    }

    /// The reduced model for settled parameters, kept or new.
    ///
    /// # Errors
    /// The parameters give no mechanism.
    pub fn reduced(&self, values: &ParameterValues, ranges: &Ranges) -> Result<Arc<Reduced>, ReductionError> {
        if let Some(reduced) = self.find(values, ranges) {
            return Ok(Arc::clone(reduced));
        }
        let kept: Vec<&Reduced> = self.all().map(|design| &*design.reduced).collect();
        Reduced::renewed(&kept, values.mechanism()).map(Arc::new)
    }

    /// The reduced model for these parameters, if it is kept.
    pub fn find(&self, values: &ParameterValues, ranges: &Ranges) -> Option<&Arc<Reduced>> {
        let has = |design: &&Design| shares_reduced(&design.values, &design.reduced, values, ranges);
        self.all().find(has).map(|design| &design.reduced)
    }

    /// The reduced model has been used with these settled parameters: keep both.
    pub fn keep(&mut self, values: &Arc<ParameterValues>, reduced: &Arc<Reduced>) {
        if Arc::ptr_eq(values, &self.original.values) {
            return;
        }
        let known = self.recent.iter().position(|design| Arc::ptr_eq(&design.reduced, reduced));
        let design = match known {
            Some(0) => return,
            Some(index) => self.recent.remove(index),
            None => Design { values: Arc::clone(values), reduced: Arc::clone(reduced), start: None },
        };
        self.recent.truncate(KEPT - 1);
        self.recent.insert(0, design);
    }

    /// The start under settled parameters with their reduced model, kept or new.
    ///
    /// # Errors
    /// As [`Start::new`].
    pub fn start(
        &mut self,
        values: &Arc<ParameterValues>,
        reduced: &Arc<Reduced>,
        ranges: &Ranges,
    ) -> Result<&Start, ModelError> {
        self.keep(values, reduced);
        let design = match self.recent.first_mut() {
            Some(design) if !Arc::ptr_eq(values, &self.original.values) => design,
            _ => &mut self.original,
        };
        let same = Arc::ptr_eq(values, &design.values)
            || agree(values, &design.values, ranges, |role| matches!(role, Role::StartPosition | Role::StartSpeed));
        let start = match design.start.take().filter(|_| same) {
            Some(start) => start,
            None => Arc::new(Start::new(reduced, values.mechanism())?),
        };
        if !Arc::ptr_eq(values, &design.values) {
            design.values = Arc::clone(values);
        }
        Ok(design.start.insert(start))
    }
}
