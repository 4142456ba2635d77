//! Exact values where no table resolves a function, or without tables, at one position after another.
//!
//! In: the reduced model, a sigma. Out: what the equation of motion reads, the reactions of all joints, from the exact
//! evaluator. It must not know states or inputs.
use super::Reduced;
use super::source::{Source, SpringLoad};
use super::state_loads::{self, StateLoads};
use crate::mechanism::curve::{Configuration, Scratch};
use crate::mechanism::reactions::{Columns, Reaction};

/// Values of [`Reduced::exact_motion`] with the scratch for them, for the state loads of one model.
#[derive(Debug, Default)]
pub struct ExactMotion {
    curve: Scratch,
    c: Configuration,
    loads: Option<state_loads::Scratch>,
    springs: Vec<SpringLoad>,
    values: Vec<f64>,
    /// Values on one side of a position where branches cross to the last digit.
    before: Vec<f64>,
}

/// Reactions of all joints at the sigma asked for last, with the scratch for them, of one model.
#[derive(Debug, Default)]
pub struct ExactReactions {
    curve: Scratch,
    c: Configuration,
    columns: Columns,
    sigma: Option<f64>,
}

// Scratch of a copy is made when it is needed.
impl Clone for ExactMotion {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl Clone for ExactReactions {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl ExactMotion {
    /// The values found last.
    pub fn values(&self) -> &[f64] {
        &self.values
    }
}

impl ExactReactions {
    /// The reactions found last, as [`Reduced::exact_reactions`] returns them.
    pub fn reactions(&self) -> &[Reaction] {
        self.columns.reactions()
    }
}

impl Reduced {
    /// Find the values at sigma of the functions that the equation of motion reads: those in the table of the state
    /// loads, or without state loads those of [`Self::influence`].
    ///
    /// Where branches cross to the last digit, reactions are the mean of those on both sides: their limit if they have
    /// one.
    pub fn exact_motion(&self, state_loads: Option<&StateLoads>, sigma: f64, exact: &mut ExactMotion) {
        /// Distance of both sides, relative to the scale: the error of the mean is as large as its rounding.
        const ASIDE: f64 = 1e-4;
        self.curve().configure(sigma, &mut exact.curve, &mut exact.c);
        if exact.c.factors().is_some() {
            return self.fill_exactly(state_loads, exact);
        }
        let h = ASIDE * self.scale();
        self.curve().configure(sigma - h, &mut exact.curve, &mut exact.c);
        self.fill_exactly(state_loads, exact);
        exact.before.clone_from(&exact.values);
        self.curve().configure(sigma + h, &mut exact.curve, &mut exact.c);
        self.fill_exactly(state_loads, exact);
        exact.values.iter_mut().zip(&exact.before).for_each(|(after, before)| *after = 0.5 * (before + *after));
    }

    /// [`Self::exact_motion`] at the present configuration.
    fn fill_exactly(&self, state_loads: Option<&StateLoads>, exact: &mut ExactMotion) {
        let Source { loading, components, .. } = &self.source;
        let ExactMotion { c, loads, springs, values, .. } = exact;
        values.clear();
        values.resize(state_loads.map_or(components.count, |s| s.table.components()), 0.0);
        if let Some(state_loads) = state_loads {
            state_loads.fill(&self.source, c, loads.get_or_insert_with(|| state_loads.scratch(loading)), values);
        } else {
            self.source.spring_loads(c, springs);
            components.fill(springs, |load| loading.loads[load].influence(self.linkage(), c), values);
        }
    }

    /// The reactions of all joints at sigma, for reactions that no table resolves because they are unbounded somewhere:
    /// joint by joint for sigma_ddot = 1, then for sigma_dot^2 = 1, then for each load = 1.
    pub fn exact_reactions<'a>(&self, sigma: f64, exact: &'a mut ExactReactions) -> &'a [Reaction] {
        let ExactReactions { curve, c, columns, sigma: known } = exact;
        if *known != Some(sigma) {
            *known = Some(sigma);
            self.curve().configure(sigma, curve, c);
            columns.fill(&self.curve().closure, c, &self.loading().loads, 0);
        }
        exact.reactions()
    }
}
