//! Gravity in the tables: the sum of what 1 m/s2 along x and along y cause.
//!
//! In: tables with the displacements and influences under both. Out: those under the gravity of a definition. It must
//! not know how tables are made.
use super::Tables;
use crate::mechanism::loads::resolved::Loading;
use crate::mechanism::loads::unit_load::Load;
use crate::numerics::plane::Vec2;
use crate::numerics::table::Unresolved;
use std::sync::OnceLock;

/// Gravity as the sum of its two components, each a load of its own.
pub(super) struct Weight {
    /// Index of gravity among the loads.
    pub(super) load: usize,
    /// Gravity of 1 m/s2 along x and along y.
    pub(super) units: [Load; 2],
    /// Their components in the table of influences.
    components: [usize; 2],
}

impl Weight {
    /// `count`: number of components of the influences.
    pub(super) fn new(load: usize, count: usize) -> Self {
        Self { load, units: [Vec2::x(), Vec2::y()].map(Load::Gravity), components: [count, count + 1] }
    }
}

impl Tables {
    /// Set the influence and the displacement of gravity. `count`: number of components of the influences.
    pub(super) fn weigh(&mut self, loading: &Loading, count: usize) {
        let (Some(load), Some(weights)) = (loading.gravity, &self.weights) else { return };
        let Load::Gravity(acceleration) = loading.loads[load] else { return };
        let factors = [acceleration.x, acceleration.y];
        self.influence.set_sum(load, Weight::new(load, count).components, factors);
        let sum = weights.as_ref().map(|weights| weights.sums(3, factors));
        let at = |at: &Unresolved| Unresolved { component: at.component % 3, ..*at };
        self.displacements[load] = OnceLock::from(sum.map_err(at));
    }

    /// These tables but for those of reactions, which hold the reactions to gravity.
    pub(super) fn without_gravity(&self) -> Self {
        Self {
            influence: self.influence.clone(),
            coordinates: self.coordinates.clone(),
            displacements: self.displacements.clone(),
            weights: self.weights.clone(),
            gapped: self.gapped.clone(),
            markers: self.markers.clone(),
            origins: self.origins.clone(),
            bodies: self.bodies.clone(),
            reactions: self.reactions.unmade(),
            state_reactions: self.state_reactions.clone(),
        }
    }
}
