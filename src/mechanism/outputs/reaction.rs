//! The reaction of a joint in a state.
//!
//! In: its reaction to each load of unit size, the sizes of the loads. Out: force x, force y, moment. It must not know
//! how the sizes are found.
use crate::mechanism::linkage::Freedom;
use crate::mechanism::outputs::cache::PresentLoads;
use crate::mechanism::outputs::evaluator::{Kinematics, OutputError, finite, spring_force};
use crate::mechanism::outputs::view::{Reading, View};
use crate::mechanism::reactions::Reaction;
use crate::numerics::table::{Table, Unresolved};

/// Reaction of one joint to sigma_ddot = 1, sigma_dot^2 = 1, then to each load of unit size.
struct UnitReactions<'a> {
    joint: usize,
    /// Force x and force y; of a joint that is not revolute also the moment.
    parts: usize,
    table: Result<&'a Table, &'a Unresolved>,
    /// From the exact evaluator, where the reaction grows without bound somewhere, so that no table holds it.
    exact: Vec<Reaction>,
}

impl<N: Reading> View<'_, N> {
    /// Force x, force y [N] and moment [N.m] that a joint transmits.
    pub fn find_reaction(&mut self, joint: usize) -> Result<[N; 3], OutputError> {
        let forces = self.forces()?;
        let (reduced, sigma, sigma_dot) = (self.reduced, self.sigma(), self.sigma_dot());
        let loading = reduced.loading();
        let sized = reduced.components().sized;
        let state_loads = self.state_loads();
        // The state decides the delivered force of a drive with an efficiency or a circuit.
        let decided = state_loads.map_or(&[][..], |s| &s.drives);
        let table = reduced.reaction(joint);
        let exact = match table {
            // The exact evaluator has no derivative along sigma.
            Err(at) if !sigma.is_constant() => return Err(at.into()),
            Err(_) => reduced.exact_reaction(joint, self.state.sigma),
            Ok(_) => Vec::new(),
        };
        let parts = if reduced.linkage().joints[joint].freedom == Freedom::Revolute { 2 } else { 3 };
        let mut value = [N::constant(0.0); 3];
        let square = sigma_dot * sigma_dot;
        if let Ok(table) = table {
            let columns = 2 + loading.base();
            let PresentLoads { sizes, reactions } = &mut *self.loads;
            let sizes = sizes[..sized].iter().enumerate();
            let sizes = sizes.map(|(load, size)| if decided.contains(&load) { 0.0 } else { *size });
            let panel = &mut reactions[joint];
            if !panel.holds(self.state.sigma) {
                panel.enter((table, reduced.is_stretch()), self.state.sigma, (parts, columns), sizes);
            }
            let x = panel.x(sigma);
            for (part, value) in value.iter_mut().enumerate().take(parts) {
                let unit = |column: usize| Self::polynomial(table.series(panel.panel, part * columns + column), x);
                let applied = Self::polynomial(&panel.applied[part], x);
                *value = applied + forces.acceleration * unit(0) + square * unit(1);
            }
        }
        let units = UnitReactions { joint, parts, table, exact };
        if units.table.is_err() {
            self.add(&units, 0, forces.acceleration, &mut value)?;
            self.add(&units, 1, square, &mut value)?;
        }
        if N::CARRIES || units.table.is_err() {
            for load in (0..sized).filter(|load| !decided.contains(load)) {
                let size = self.size(load);
                // The polynomials have the values.
                let size = if units.table.is_ok() { size - N::constant(size.value()) } else { size };
                self.add(&units, 2 + load, size, &mut value)?;
            }
        }
        for &load in decided {
            self.add(&units, 2 + load, self.delivered(load), &mut value)?;
        }
        for (index, spring) in loading.springs.iter().enumerate() {
            let force = spring_force(self, loading, index)?;
            self.add(&units, 2 + spring.load, -force, &mut value)?;
        }
        for (k, &load) in state_loads.map_or(&[][..], |s| &s.loads).iter().enumerate() {
            self.add(&units, 2 + load, self.cache.scratch.evaluator.loads[k], &mut value)?;
        }
        if let Some(place) = forces.held {
            if let Some(end) = self.state.travel.rigid[place.side].filter(|_| forces.by_stop) {
                let force = self.stop_force(end.stop)?;
                self.add(&units, 2 + loading.stops[end.stop].load, force, &mut value)?;
            }
            let outward = place.outward();
            for lock in 0..loading.locks.len() {
                let force = self.lock_force(lock)?;
                if force.value() != 0.0 || !force.is_constant() {
                    let unit = reduced.lock_reaction(lock, self.state.sigma, joint);
                    for (part, sum) in value.iter_mut().enumerate().take(parts) {
                        *sum = *sum + force * (outward * part_of(&unit, part));
                    }
                }
            }
        }
        let value = value.map(finite);
        self.cache.reactions[joint] = Some(value);
        self.cache.has_reactions = true;
        self.cache.computed.reactions += 1;
        Ok(value)
    }

    /// Add the reaction to a column of this size. Loads that the state sizes come last, in a table of their own, which
    /// is built when one of them acts.
    fn add(&self, units: &UnitReactions, column: usize, size: N, value: &mut [N; 3]) -> Result<(), OutputError> {
        if size.value() == 0.0 && size.is_constant() {
            return Ok(());
        }
        let loading = self.reduced.loading();
        let applied = 2 + loading.base();
        let (table, own, columns) = match column.checked_sub(applied) {
            None => (units.table, column, applied),
            Some(own) => (self.reduced.state_reaction(units.joint), own, loading.loads.len() - loading.base()),
        };
        let position = table.map(|table| (table, table.position(self.state.sigma)));
        for (part, sum) in value.iter_mut().enumerate().take(units.parts) {
            let unit = match position {
                Ok((table, position)) => self.component(table, position, part * columns + own),
                Err(at) if !self.sigma().is_constant() => return Err(at.into()),
                Err(_) => N::constant(match units.exact.get(column) {
                    Some(unit) => part_of(unit, part),
                    // Loads that the state sizes have a table of their own.
                    None => part_of(&self.reduced.exact_reaction(units.joint, self.state.sigma)[column], part),
                }),
            };
            *sum = *sum + size * unit;
        }
        Ok(())
    }
}

/// Force x, force y or moment.
fn part_of(reaction: &Reaction, part: usize) -> f64 {
    [reaction.force.x, reaction.force.y, reaction.moment][part]
}
